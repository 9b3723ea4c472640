//! The light that a ray brings back from a lit world, without noise: each light shines on a surface
//! directly, and mirrors and glass send the ray on.
//!
//! This file is the definition, from the camera's ray to linear light. It asks three questions of a
//! world, [`Queries`]. The plain loops of [`World`] define the answers; `accel/` finds the same ones
//! sooner. What happens where surfaces meet is that of [`contact`](crate::tracer::contact).

use std::{cell::OnceCell, f64::consts::PI, ops::Add, sync::Arc};

use glam::DVec3;

use crate::{
    accel::few::Few,
    film::parts::LightParts,
    integrator::{
        Integrate,
        path::emitters::EmitterChance,
        queue::{Lanes, Queue, Seen},
        surface::{AtGlass, Onward, Path, Shadow, Surface},
    },
    simd::isa::Isa,
    tracer::{
        color::Color,
        contact::{Contact, Crossed, Departure, Interface},
        light::{Arriving, Light, ShadowRay},
        material::{
            bsdf::{Bsdf, LobeColors},
            glass::Glass,
            lobes::{Highlight, Lobes},
        },
        radiance::Radiance,
        ray::Ray,
        sampling::LocalFrame,
        shape::face::{Crossing, FaceId},
        tone::Tone,
        world::{Lighting, World},
    },
};

/// The smallest light of a pixel, after exposure, for which a ray is traced: a sixteenth of the step
/// between two bytes.
const LEAST: f64 = 1.0 / 4096.0;

/// The questions that the evaluation of light asks of a world.
pub(crate) trait Queries {
    /// Returns [`World::nearest`]. If it is not known on how many faces the ray begins, and there are several,
    /// returns them instead.
    fn nearest(
        &self,
        ray: &Ray,
        start: Option<&Departure>,
    ) -> Result<Option<(usize, Crossing)>, Contact>;

    /// Returns where rays begin that a face sends back where a ray has arrived at `t`.
    fn start(&self, own: FaceId, arriving: &Ray, t: f64) -> Departure {
        self.known(&Departure::unknown(own, arriving, t))
    }

    /// Returns a start once all faces are known that it lies on.
    fn known(&self, start: &Departure) -> Departure {
        match start.arrival() {
            Some((ray, hit)) => start.with(self.contact(&ray, hit).map(Arc::new)),
            None => start.clone(),
        }
    }

    /// Returns [`World::contact_among_all`].
    fn contact(&self, ray: &Ray, hit: (usize, Crossing)) -> Option<Contact>;

    /// Returns [`World::transmission`].
    fn transmission(&self, ray: &Ray, t_max: f64, start: &Departure) -> Radiance;

    /// Returns [`World::brightest`].
    fn brightest(&self) -> f64;

    /// Returns the geometries if they are few, so that eight rays are best tested with all of them.
    fn few(&self) -> Option<Few<'_>> {
        None
    }

    /// Returns the instructions to use.
    fn isa(&self) -> Isa {
        Isa::best()
    }

    /// Prepares for many questions.
    fn prepare(&self) {}

    /// True if steps are told. Only to an [explanation](crate::integrator::explain).
    const LISTENS: bool = false;

    /// Receives each step of the evaluation, for one that listens.
    #[inline(always)]
    fn tell(&self, _: Step) {}
}

/// A step of the evaluation of light.
pub(crate) enum Step<'a> {
    /// A ray arrives along a path.
    Ray(&'a Path),
    /// It is not traced: too little of its light arrives at the camera.
    Faint,
    /// It is not traced: it is deeper than `max_depth`.
    TooDeep,
    /// It meets a surface.
    Surface(&'a Surface<'a>),
    /// A light of this number shines on the surface.
    Light(usize, &'a Light),
    /// The light before shadows, if any arrives.
    Arriving(Option<Arriving>),
    /// A term of the light, or of the material once all lights are summed up: its name in data, its
    /// symbol on paper, its value.
    Term(&'static str, &'static str, Value),
    /// The surface is turned away from the light.
    FacesAway,
    /// The light on a shadow ray, up to a `t`, that comes through.
    Shadow(&'a Ray, f64, &'a Departure, Radiance),
    /// A path aims at this emitter.
    Emitter(EmitterChance),
    /// One of the first emitters.
    OtherEmitter(EmitterChance),
    /// A path brings this light.
    Adds(Radiance),
    /// All lights are summed up.
    Summed,
    /// The light of the ray.
    Brings(Shaded),
}

/// The value of a term.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Value {
    Number(f64),
    Vector(DVec3),
    Light(Radiance),
}

impl Queries for World {
    fn nearest(
        &self,
        ray: &Ray,
        start: Option<&Departure>,
    ) -> Result<Option<(usize, Crossing)>, Contact> {
        let left = start.map_or(&[][..], Departure::left);
        Ok(World::nearest(self, ray, f64::INFINITY, left))
    }

    fn contact(&self, ray: &Ray, hit: (usize, Crossing)) -> Option<Contact> {
        self.contact_among_all(ray, hit)
    }

    fn transmission(&self, ray: &Ray, t_max: f64, start: &Departure) -> Radiance {
        World::transmission(self, ray, t_max, start)
    }

    fn brightest(&self) -> f64 {
        World::brightest(self)
    }
}

/// The light of a ray, by what the first surface does with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Shaded {
    pub(crate) parts: LightParts,
    /// The part of the light of a transparent background that comes along the ray.
    pub(crate) behind: Radiance,
}

impl Shaded {
    pub(crate) fn direct(direct: Radiance) -> Self {
        let others = LightParts::default();
        Self {
            parts: LightParts { direct, ..others },
            behind: Radiance::BLACK,
        }
    }

    /// Returns the light that a surface reflects or lets through of this.
    pub(super) fn sent_on(self, factor: Radiance) -> Self {
        let (specular, others) = (factor * self.parts.sum(), LightParts::default());
        Self {
            parts: LightParts { specular, ..others },
            behind: factor * self.behind,
        }
    }
}

impl Add for Shaded {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            parts: self.parts + other.parts,
            behind: self.behind + other.behind,
        }
    }
}

/// The direct lighting of a world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direct<'a, Q> {
    pub(super) world: &'a World,
    lighting: &'a Lighting,
    pub(super) queries: &'a Q,
    tone: Tone,
    /// The light of a ray that meets nothing; `None` if it depends on the ray.
    background: Option<Shaded>,
}

/// The light that a surface sends along its path by itself; or, where surfaces meet, the ray that goes straight on,
/// no deeper than the path, in place of all light there.
pub(super) type Sent = Result<Shaded, Box<Onward>>;

impl<Q: Queries> Integrate for Direct<'_, Q> {
    fn trace(&self, ray: &Ray) -> Shaded {
        self.follow(Path::new(*ray))
    }

    fn shade<'s>(
        &self,
        seen: impl Iterator<Item = Seen<'s>>,
        (queue, lanes): (&mut Queue, Lanes),
        set: impl FnMut(usize, Shaded),
    ) {
        queue.shade(self, seen, lanes, set);
    }
}

impl<'a, Q: Queries> Direct<'a, Q> {
    /// Creates the direct lighting of a world, whose background may be transparent, for a picture with
    /// this tone.
    pub(crate) fn new(
        world: &'a World,
        lighting: &'a Lighting,
        queries: &'a Q,
        tone: Tone,
        is_transparent: bool,
    ) -> Self {
        Self {
            world,
            lighting,
            queries,
            tone,
            background: match (is_transparent, world.backdrop()) {
                (true, _) => Some(Shaded {
                    behind: Radiance::WHITE,
                    ..Shaded::default()
                }),
                (false, None) => Some(Shaded::direct(world.background().to_linear())),
                (false, Some(_)) => None,
            },
        }
    }

    /// Returns the light of a ray that meets nothing.
    fn behind(&self, ray: &Ray) -> Shaded {
        let by_ray = || Shaded::direct(self.world.behind(ray));
        self.background.unwrap_or_else(by_ray)
    }

    /// Returns the light that arrives along a path.
    pub(super) fn follow(&self, mut path: Path) -> Shaded {
        let (mut factors, mut onward) = (Vec::new(), Vec::new());
        let shaded = loop {
            self.queries.tell(Step::Ray(&path));
            match self.step(&path, &mut onward) {
                Ok(shaded) => break shaded,
                Err(straight) => {
                    onward.clear();
                    path = straight.path;
                    factors.push(straight.factor);
                }
            }
        };
        let mut shaded = self.with_light(shaded, onward);
        self.queries.tell(Step::Brings(shaded));
        for factor in factors.into_iter().rev() {
            shaded = shaded.sent_on(factor);
            self.queries.tell(Step::Brings(shaded));
        }
        shaded
    }

    /// Returns light with that of the rays that a surface sends on.
    fn with_light(&self, shaded: Shaded, onward: Vec<Onward>) -> Shaded {
        let light = |Onward { path, factor }| self.follow(path).sent_on(factor);
        onward.into_iter().map(light).fold(shaded, Shaded::add)
    }

    /// Returns the light of the first surface on a path, and adds the rays whose light it sends on, in the order in
    /// which that is added.
    fn step(&self, path: &Path, onward: &mut Vec<Onward>) -> Sent {
        match self.meet(path, onward) {
            Ok((t, id)) => self.light_of(&Surface::new(self.world, path, t, id), onward),
            Err(sent) => sent,
        }
    }

    /// Returns where a path meets a surface beyond its start; or else the light that arrives along it.
    pub(super) fn meet(
        &self,
        path: &Path,
        onward: &mut Vec<Onward>,
    ) -> Result<(f64, FaceId), Sent> {
        if self.is_faint(path.factor) {
            self.queries.tell(Step::Faint);
            return Err(Ok(Shaded::default()));
        }
        if path.depth > self.lighting.max_depth {
            self.queries.tell(Step::TooDeep);
            return Err(Ok(self.behind(&path.ray)));
        }
        if let Some(start) = &path.start {
            let surface = |id| Surface {
                start: OnceCell::from(start.on(id)),
                ..Surface::new(self.world, path, 0.0, id)
            };
            match start.crossed(self.world, path.ray.direction()) {
                Crossed::Nothing => {}
                Crossed::Opaque(id) => return Err(self.light_of(&surface(id), onward)),
                Crossed::Glass(interface) => {
                    let surface = surface(interface.face);
                    return Err(self.interface(&surface, &interface, onward));
                }
            }
        }
        match self.queries.nearest(&path.ray, path.start.as_ref()) {
            Ok(None) => Err(Ok(self.behind(&path.ray))),
            Ok(Some((geometry, Crossing { t, face }))) => Ok((t, FaceId { geometry, face })),
            Err(contact) => {
                let contact = Some(Arc::new(contact));
                let start = path.start.as_ref().map(|start| start.with(contact));
                let path = Path {
                    start,
                    ..path.clone()
                };
                self.meet(&path, onward)
            }
        }
    }

    /// Returns true if light of which this part arrives at the camera does not show in the picture, even if
    /// it is the brightest of all.
    #[inline]
    fn is_faint(&self, factor: Radiance) -> bool {
        let part = self.tone.expose(factor).max_channel();
        part < LEAST && part * self.queries.brightest() < LEAST
    }

    /// Returns the light that a surface sends along its path, and adds the rays whose light it sends on: the sum of
    /// its lobes.
    pub(super) fn light_of(&self, surface: &Surface, onward: &mut Vec<Onward>) -> Sent {
        self.queries.tell(Step::Surface(surface));
        let material = surface.hit.material();
        let lobes = material.lobes();
        let Lobes {
            emission,
            diffuse,
            highlight,
            layered,
            mirror,
            interface,
        } = lobes;
        let mut shaded = Shaded::default();
        if let Some(emission) = emission {
            shaded.parts.direct = emission.radiance();
        }
        if layered.is_some() {
            shaded.parts.direct = self.layered(surface, &lobes, onward);
        } else if lobes.scatters() {
            let scattered = self.scattered(surface, diffuse, highlight);
            shaded.parts.direct = shaded.parts.direct + scattered;
        }
        if let Some(color) = mirror {
            self.reflect(surface, color.to_linear(), onward);
        }
        if let Some(glass) = interface {
            shaded = shaded + self.glass(surface, *glass, onward)?;
        }
        Ok(shaded)
    }

    /// Returns where rays begin that a surface sends back.
    fn start<'s>(&self, surface: &'s Surface) -> &'s Departure {
        let (own, ray) = (surface.own(), &surface.path.ray);
        let start = || self.queries.start(own, ray, surface.hit.t);
        surface.start.get_or_init(start)
    }

    /// Tells a term of the evaluation.
    #[inline(always)]
    fn term(&self, name: &'static str, symbol: &'static str, value: Value) {
        self.queries.tell(Step::Term(name, symbol, value));
    }

    /// Returns the light of all lights that a surface scatters.
    fn scattered(
        &self,
        surface: &Surface,
        diffuse: Option<Color>,
        highlight: Option<Highlight>,
    ) -> Radiance {
        let [irradiance, highlights] = self.irradiance(surface, highlight);
        let part = |color: Option<Color>, light| {
            color.map_or(Radiance::BLACK, |color| color.to_linear() * light)
        };
        let color = highlight.map(|highlight| highlight.color);
        part(diffuse, irradiance) + part(color, highlights)
    }

    /// Returns the light of all lights that metal or a coated surface scatters, and adds the ray whose light it reflects: a
    /// sharp one, with all of the light that arrives around its direction.
    fn layered(&self, surface: &Surface, lobes: &Lobes, onward: &mut Vec<Onward>) -> Radiance {
        let frame = LocalFrame::new(surface.n);
        let bsdf = Bsdf::new(lobes, &LobeColors::new(lobes), frame.inward(surface.v));
        let mut sum = Radiance::BLACK;
        for (number, light) in self.lighting.lights.iter().enumerate() {
            let Some((radiance, l)) = self.arriving(surface, number, light) else {
                continue;
            };
            let scattered = match l {
                None => bsdf.diffuse_part() * radiance,
                Some(l) => bsdf.from(frame.inward(l)).all * PI * radiance,
            };
            self.term("light", "π·f·I", Value::Light(scattered));
            sum = sum + scattered;
        }
        self.queries.tell(Step::Summed);
        self.term("scattered", "Σ π·f·I", Value::Light(sum));
        self.reflect(surface, bsdf.reflected_part(), onward);
        sum
    }

    /// Returns Σ I, the sum of the light that arrives from all lights, in the order of the file,
    /// and the same weighted by a highlight.
    fn irradiance(&self, surface: &Surface, highlight: Option<Highlight>) -> [Radiance; 2] {
        let mut sums = [Radiance::BLACK; 2];
        for (number, light) in self.lighting.lights.iter().enumerate() {
            let Some((radiance, l)) = self.arriving(surface, number, light) else {
                continue;
            };
            let Some(l) = l else {
                self.term("light", "I", Value::Light(radiance));
                sums[0] = sums[0] + radiance;
                continue;
            };
            let cosine = surface.n.dot(l);
            self.term("light", "I", Value::Light(radiance * cosine));
            sums[0] = sums[0] + radiance * cosine;
            if let Some(Highlight { exponent, .. }) = highlight {
                let r = 2.0 * cosine * surface.n - l;
                let highlight = libm::pow(r.dot(surface.v).max(0.0), exponent);
                self.term("r", "r", Value::Vector(r));
                self.term("r_dot_v", "r·v", Value::Number(r.dot(surface.v)));
                self.term(
                    "highlight",
                    "max(0, r·v)^exponent",
                    Value::Number(highlight),
                );
                self.term("highlight_light", "H", Value::Light(radiance * highlight));
                sums[1] = sums[1] + radiance * highlight;
            }
        }
        self.queries.tell(Step::Summed);
        self.term("irradiance", "Σ I", Value::Light(sums[0]));
        if highlight.is_some() {
            self.term("highlights", "Σ H", Value::Light(sums[1]));
        }
        sums
    }

    /// Returns the light that arrives from a light, after shadows, and the direction to it, unless
    /// that is every direction; `None` if the surface is turned away from it.
    fn arriving(
        &self,
        surface: &Surface,
        number: usize,
        light: &Light,
    ) -> Option<(Radiance, Option<DVec3>)> {
        self.queries.tell(Step::Light(number, light));
        let arriving = light.arriving(surface.hit.point, surface.v);
        self.queries.tell(Step::Arriving(arriving));
        let Arriving { radiance, from } = arriving?;
        let Some(from) = from else {
            return Some((radiance, None));
        };
        let cosine = surface.n.dot(from.l);
        self.term("n_dot_l", "n·l", Value::Number(cosine));
        let faces = cosine > 0.0;
        if !faces {
            self.queries.tell(Step::FacesAway);
            return None;
        }
        let radiance = match from.shadow {
            None => radiance,
            Some(shadow) => radiance * self.transmission(surface, number, shadow),
        };
        Some((radiance, Some(from.l)))
    }

    /// Returns the part of the light that comes through on a shadow ray.
    fn transmission(&self, surface: &Surface, number: usize, shadow: ShadowRay) -> Radiance {
        match surface.shadows.map(|shadows| shadows[number]) {
            Some(Shadow::Lit) => return Radiance::WHITE,
            Some(Shadow::Dark) => return Radiance::BLACK,
            Some(Shadow::Glass) | None => {}
        }
        let ShadowRay { direction, t_max } = shadow;
        let ray = Ray::new(surface.hit.point, direction);
        self.queries.transmission(&ray, t_max, self.start(surface))
    }

    /// Adds the ray whose light a surface reflects like a mirror, unless that is too faint.
    #[inline]
    fn reflect(&self, surface: &Surface, factor: Radiance, onward: &mut Vec<Onward>) {
        self.term("reflected", "reflected part", Value::Light(factor));
        // Many reflect nothing at all, and so ask nothing.
        if Q::LISTENS || !self.is_faint(surface.path.factor * factor) {
            let start = self.start(surface).clone();
            onward.push(surface.onward(surface.mirrored(), factor, start));
        }
    }

    /// Returns the light of glass, or of what meets it at its point.
    fn glass(&self, surface: &Surface, glass: Glass, onward: &mut Vec<Onward>) -> Sent {
        let start = self.queries.known(self.start(surface));
        match surface.at_glass(self.world, start, glass) {
            AtGlass::Interface(surface, interface) => self.interface(&surface, &interface, onward),
            AtGlass::Opaque(surface) => self.light_of(&surface, onward),
            AtGlass::Nothing(start) => Err(surface.straight(Radiance::WHITE, &start)),
        }
    }

    /// Tells the indices of refraction on both sides of an interface where several faces meet.
    fn tell_media(&self, start: &Departure, interface: &Interface) {
        if !start.is_alone() {
            let [before, behind] = interface.media();
            self.term("n_before", "n before", Value::Number(before));
            self.term("n_behind", "n behind", Value::Number(behind));
        }
    }

    /// Adds the rays whose light a surface between two media reflects and lets through.
    fn interface(
        &self,
        surface: &Surface,
        interface: &Interface,
        onward: &mut Vec<Onward>,
    ) -> Sent {
        // It may be another face than the one that was hit.
        self.queries.tell(Step::Surface(surface));
        let (start, color) = (self.start(surface), interface.color());
        if interface.is_joint() {
            self.tell_media(start, interface);
            return Err(surface.straight(color, start));
        }
        let fresnel = interface.fresnel(surface.n.dot(surface.v));
        let direction = if interface.is_pane {
            surface.path.ray.direction()
        } else {
            surface.refracted(&fresnel)
        };
        let reflected = Radiance::WHITE * fresnel.reflected;
        let refracted = color * (1.0 - fresnel.reflected);
        self.tell_media(start, interface);
        self.term("eta", "η", Value::Number(fresnel.eta));
        self.term("n_dot_v", "n·v", Value::Number(surface.n.dot(surface.v)));
        self.term(
            "cos_refracted",
            "cos of the refracted ray",
            Value::Number(fresnel.cos_refracted),
        );
        self.term("fresnel", "F", Value::Number(fresnel.reflected));
        self.term("refracted", "(1-F)·lin(color)", Value::Light(refracted));
        let through = start.through(surface.path.ray.direction());
        self.reflect(surface, reflected, onward);
        onward.push(surface.onward(direction, refracted, through));
        Ok(Shaded::default())
    }
}
