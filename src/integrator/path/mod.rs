//! The light that a ray brings back by paths: from surface to surface, in directions that the numbers of a
//! sample choose, to all that shines (J. Kajiya, The rendering equation, 1986). At each surface that
//! scatters, light comes from an emitter that is aimed at, and from what the next ray meets; both are
//! weighted by the power heuristic (E. Veach, Robust Monte Carlo methods for light transport simulation,
//! 1997, section 9.2).
//!
//! This file is the definition, sample by sample. It asks the questions of
//! [`direct`](crate::integrator::direct), and meets glass and contact as that does.

mod eight;
mod emitter_tree;
pub(crate) mod emitters;
pub(crate) mod explain;
mod glass;
mod light;
pub(crate) mod sampler;
#[cfg(test)]
mod tests;

use std::{cell::OnceCell, sync::Arc};

use glam::DVec3;

use self::{
    emitters::Emitters,
    sampler::{Purpose, Sampler},
};
use crate::{
    film::size::Size,
    integrator::{
        Integrate,
        direct::{Queries, Shaded, Step, Value},
        queue::{Lanes, Queue, Seen},
        surface::{Path, Surface},
    },
    tracer::{
        camera::Camera,
        color::Color,
        contact::{Crossed, Departure, Interface},
        geometry::Geometry,
        light::{source::Source, transport::PathOptions},
        material::{
            bsdf::{Bsdf, LobeColors, Onto, Scattering},
            rough_glass::RoughGlass,
        },
        radiance::Radiance,
        ray::Ray,
        sampling::LocalFrame,
        shape::{
            face::{Crossing, FaceId},
            mesh::Mesh,
        },
        world::{Lighting, World},
    },
};

/// The vertex from which a path may end by roulette.
const ROULETTE: u32 = 3;
/// The largest probability of a path to go on there.
const MOST_LIKELY: f64 = 0.95;

/// The largest number of geometries whose colors are kept in linear light.
const MOST_COLORS: usize = 1 << 12;

/// The number of panes that a path goes straight through beyond its depth, so that it ends.
const MOST_PANES: u32 = 1024;

/// A world whose light follows paths.
#[derive(Clone, Debug)]
pub(crate) struct PathTracer<'a, Q> {
    world: &'a World,
    queries: &'a Q,
    max_depth: u32,
    options: PathOptions,
    emitters: Arc<Emitters>,
    /// The light that the diffuse lobes of surfaces get along every ray that hits nothing.
    ambient: Radiance,
    /// The light of all headlights.
    headlight: Radiance,
    /// The colors of each geometry in linear light, if it has one material and there are not too many.
    colors: Arc<[Option<LobeColors>]>,
    /// The factor of the cosine in what these scatter, if they do so evenly to all sides and in no other way.
    matte: Arc<[Option<Radiance>]>,
    /// True if some glass stops shadow rays: solid glass unless these go through it, and rough glass.
    stops_at_glass: bool,
    /// True if all light may get through some glass.
    has_clear_glass: bool,
    is_transparent: bool,
}

/// Returns the colors of each geometry of one material; none if there are too many.
fn colors_of(world: &World) -> Vec<Option<LobeColors>> {
    let geometries = world.geometries();
    let colors = |geometry: &Geometry| {
        let material = geometry.only_material()?;
        Some(LobeColors::new(&world.lobes(material)))
    };
    let few = Some(geometries).filter(|all| all.len() <= MOST_COLORS);
    few.into_iter().flatten().map(colors).collect()
}

/// Returns what geometries of these colors scatter, if they are matte and reflect any light.
fn matte_of(world: &World, colors: &[Option<LobeColors>]) -> Vec<Option<Radiance>> {
    let matte = |(geometry, colors): (&Geometry, &Option<LobeColors>)| {
        if geometry.shape().mesh().is_some_and(Mesh::is_smooth) {
            return None;
        }
        let lobes = world.lobes(geometry.only_material()?);
        Bsdf::evenly(&lobes, colors.as_ref()?)
    };
    std::iter::zip(world.geometries(), colors)
        .map(matte)
        .collect()
}

/// A path as far as it is known.
#[derive(Clone, Debug, Default)]
struct PathState {
    /// The part of its light by what the first surface does: that which its diffuse lobe scatters.
    direct: Radiance,
    /// The part of the light along the ray that a diffuse lobe scatters.
    diffuse: Radiance,
    /// Where the ray was scattered; `None` if it is that of the camera, a mirror or smooth glass.
    last: Option<Scattered>,
    /// The sum of the weights of all emitters at the last point that aimed at one.
    weights: f64,
    /// True once a surface has scattered light, other than a mirror or smooth glass.
    has_scattered: bool,
    /// True if mirrors and solid glass are all that it has met since.
    is_caustic: bool,
    /// The number of scatterings by diffuse lobes.
    diffuse_depth: u32,
    /// The light at its first vertex, and that at all others, if this is limited.
    light: [Shaded; 2],
    /// True if the light of emitters that are aimed at waits for its shadow to be known.
    waits: bool,
    /// That of the last surface, if it waits.
    aimed: Option<BeforeShadow>,
    /// The first face, and the first color of the first surface other than a mirror or smooth glass.
    first: Option<FaceId>,
    color: Option<Color>,
}

/// Light that a surface scatters if nothing is in its way.
#[derive(Clone, Debug)]
struct BeforeShadow {
    /// The ray to the emitter, and the `t` before which it ends.
    ray: Ray,
    t_max: f64,
    start: Departure,
    /// What arrives at the camera of the light: β · f · L.
    light: Radiance,
    weight: AimedWeight,
    /// The number of its sum, and the part of it that counts as direct there.
    limited: usize,
    direct: Radiance,
}

/// The weight of light that a surface aimed at.
#[derive(Clone, Copy, Debug)]
enum AimedWeight {
    /// No ray finds the emitter by chance: it was chosen with this probability.
    Chosen(f64),
    /// The density of the direction as it was aimed at, and as the lobes choose it.
    Shared(f64, f64),
}

/// Where a ray was scattered.
#[derive(Clone, Copy, Debug)]
struct Scattered {
    point: DVec3,
    /// The density of its direction.
    density: f64,
    /// The sum of the weights of all emitters there.
    weights: f64,
}

/// A sample of a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathSample {
    pub(crate) light: Shaded,
    /// The face that the camera's ray hits.
    pub(crate) first: Option<FaceId>,
    /// The first color of the first surface other than a mirror or smooth glass.
    pub(crate) color: Option<Color>,
}

/// The first face on a path.
struct FirstFace {
    t: f64,
    id: FaceId,
    /// Where rays begin that it sends back, if the path itself begins there.
    start: Option<Departure>,
    /// The glass there, if the path begins at it.
    interface: Option<Box<Interface>>,
}

impl PathState {
    /// Creates the state of a camera's ray.
    fn new() -> Self {
        Self {
            direct: Radiance::WHITE,
            ..Self::default()
        }
    }
}

impl FirstFace {
    fn surface<'a>(&self, world: &'a World, path: &'a Path) -> Surface<'a> {
        let start = self.start.clone();
        Surface {
            start: start.map_or_else(OnceCell::new, OnceCell::from),
            ..Surface::new(world, path, self.t, self.id)
        }
    }
}

/// A point of a surface that scatters light.
struct PathVertex<'v, 'a> {
    surface: &'v Surface<'a>,
    frame: LocalFrame,
    lobes: VertexLobes,
}

/// What scatters the light.
enum VertexLobes {
    Opaque(Bsdf),
    Glass(RoughGlass),
}

impl PathVertex<'_, '_> {
    /// Returns the light that comes from the direction of a unit vector: none if the face lies between, whose
    /// normal for shading may be another.
    fn from(&self, l: DVec3) -> Scattering {
        let Surface { hit, v, n, .. } = self.surface;
        let on_side = |normal: DVec3| (normal.dot(l) > 0.0) == (normal.dot(*v) > 0.0);
        let flat = hit.geometry.shape().flat_normal(hit.face);
        if flat.is_some_and(|flat| on_side(flat) != on_side(*n)) {
            return Scattering::NONE;
        }
        let local = self.frame.inward(l);
        match &self.lobes {
            VertexLobes::Opaque(bsdf) => bsdf.from(local),
            VertexLobes::Glass(glass) => glass.from(local),
        }
    }
}

impl<Q: Queries> Integrate for PathTracer<'_, Q> {
    /// Returns the mean of the samples of the pixel at the bottom left, whatever their place in it.
    fn trace(&self, ray: &Ray) -> Shaded {
        let sampler = |sample| Sampler::new([0, 0], sample, self.options.seed);
        let samples = (0..self.samples()).map(|sample| self.sample(*ray, &sampler(sample)).light);
        let sum = samples.fold(Shaded::default(), |sum, sample| sum + sample);
        let count = f64::from(self.samples());
        Shaded {
            parts: sum.parts.map(|part| part / count),
            behind: sum.behind / count,
        }
    }

    fn shade<'s>(
        &self,
        seen: impl Iterator<Item = Seen<'s>>,
        _: (&mut Queue, Lanes),
        mut set: impl FnMut(usize, Shaded),
    ) {
        seen.for_each(|seen| set(seen.place, self.trace(&seen.ray)));
    }
}

impl<'a, Q: Queries> PathTracer<'a, Q> {
    /// Creates the light by paths of a world, whose background may be transparent.
    pub(crate) fn new(
        world: &'a World,
        lighting: &Lighting,
        options: PathOptions,
        queries: &'a Q,
        is_transparent: bool,
    ) -> Self {
        let sum = |is_it: fn(Source) -> bool| {
            let lights = lighting.lights.iter().filter(|light| is_it(light.source()));
            let light = lights.map(|light| light.glow().radiance());
            light.fold(Radiance::BLACK, |sum, light| sum + light)
        };
        let colors = colors_of(world);
        Self {
            world,
            queries,
            max_depth: lighting.max_depth,
            options,
            emitters: Emitters::new(world).into(),
            matte: matte_of(world, &colors).into(),
            colors: colors.into(),
            ambient: sum(|source| matches!(source, Source::Everywhere)),
            headlight: sum(|source| matches!(source, Source::Viewer)),
            has_clear_glass: world.has_clear_glass(),
            stops_at_glass: options.caustics && world.has_solid_glass() || world.has_rough_glass(),
            is_transparent,
        }
    }

    /// The number of samples of a pixel.
    pub(crate) fn samples(&self) -> u32 {
        self.options.samples()
    }

    /// The limit of the noise of a part of a picture.
    pub(crate) fn noise(&self) -> Option<f64> {
        self.options.noise
    }

    pub(crate) const fn world(&self) -> &'a World {
        self.world
    }

    /// Returns the face that a sample of a pixel hits first.
    pub(crate) fn first_of(
        &self,
        (camera, size): (&Camera, Size),
        pixel: [u32; 2],
        number: u32,
    ) -> Option<FaceId> {
        let sampler = Sampler::new(pixel, number, self.options.seed);
        let ray = sampler.ray((camera, self.options.filter), size, pixel);
        self.meet(&mut Path::new(ray)).map(|met| met.id)
    }

    /// Returns a sample of a pixel, counted from the bottom left of a picture.
    pub(crate) fn sample_of(
        &self,
        (camera, size): (&Camera, Size),
        pixel: [u32; 2],
        number: u32,
    ) -> PathSample {
        let sampler = Sampler::new(pixel, number, self.options.seed);
        let ray = sampler.ray((camera, self.options.filter), size, pixel);
        self.sample(ray, &sampler)
    }

    /// Returns a sample along a camera's ray.
    pub(crate) fn sample(&self, ray: Ray, sampler: &Sampler) -> PathSample {
        let mut path = Path::new(ray);
        let mut state = PathState::new();
        while let Some(next) = self.step(&mut path, &mut state, sampler) {
            path = next;
        }
        self.sample_at_end(&state)
    }

    /// Returns the sample of a path that has ended.
    fn sample_at_end(&self, state: &PathState) -> PathSample {
        let [first, mut later] = state.light;
        if let Some(clamp) = self.options.clamp {
            let most = later.parts.sum().max_channel();
            if most > clamp {
                later.parts = later.parts.map(|part| part * (clamp / most));
            }
        }
        PathSample {
            light: first + later,
            first: state.first,
            color: state.color,
        }
    }

    /// Adds the light at the end of a ray, and returns how the path goes on.
    fn step(&self, path: &mut Path, state: &mut PathState, sampler: &Sampler) -> Option<Path> {
        if path.depth > self.max_depth + MOST_PANES {
            return None;
        }
        self.queries.tell(Step::Ray(path));
        let met = self.meet(path);
        self.arrive(path, met, state, sampler)
    }

    /// Adds the light at the end of a ray, and returns how the path goes on.
    fn arrive(
        &self,
        path: &Path,
        met: Option<FirstFace>,
        state: &mut PathState,
        sampler: &Sampler,
    ) -> Option<Path> {
        let Some(met) = met else {
            self.pass(path, f64::INFINITY, state);
            self.escape(path, state);
            return None;
        };
        self.pass(path, met.t * path.ray.direction().length(), state);
        let surface = met.surface(self.world, path);
        self.queries.tell(Step::Surface(&surface));
        state.first.get_or_insert(met.id);
        match met.interface {
            Some(interface) => self.interface(&surface, &interface, state, sampler),
            None => self.surface(&surface, state, sampler),
        }
    }

    /// Returns what a path meets first, once it is known on how many faces it begins.
    fn meet(&self, path: &mut Path) -> Option<FirstFace> {
        loop {
            if let Some(start) = &path.start {
                let (id, interface) = match start.crossed(self.world, path.ray.direction()) {
                    Crossed::Nothing => (None, None),
                    Crossed::Opaque(id) => (Some(id), None),
                    Crossed::Glass(interface) => (Some(interface.face), Some(Box::new(interface))),
                };
                if let Some(id) = id {
                    let start = Some(start.on(id));
                    return Some(FirstFace {
                        t: 0.0,
                        id,
                        start,
                        interface,
                    });
                }
            }
            match self.queries.nearest(&path.ray, path.start.as_ref()) {
                Ok(found) => {
                    let (geometry, Crossing { t, face }) = found?;
                    let id = FaceId { geometry, face };
                    return Some(FirstFace {
                        t,
                        id,
                        start: None,
                        interface: None,
                    });
                }
                Err(contact) => {
                    let contact = Some(Arc::new(contact));
                    path.start = path.start.as_ref().map(|start| start.with(contact));
                }
            }
        }
    }

    /// Tells a number.
    #[inline(always)]
    fn number(&self, name: &'static str, symbol: &'static str, number: f64) {
        self.queries
            .tell(Step::Term(name, symbol, Value::Number(number)));
    }

    /// Tells light, or a factor of light.
    #[inline(always)]
    fn radiance(&self, name: &'static str, symbol: &'static str, light: Radiance) {
        self.queries
            .tell(Step::Term(name, symbol, Value::Light(light)));
    }

    /// Tells a unit vector.
    #[inline(always)]
    fn direction(&self, name: &'static str, symbol: &'static str, direction: DVec3) {
        self.queries
            .tell(Step::Term(name, symbol, Value::Vector(direction)));
    }

    /// Returns true if a path shows only what surfaces emit.
    fn is_exhausted(&self, path: &Path, state: &PathState) -> bool {
        let diffuse_depth = self.options.diffuse_depth;
        path.depth >= self.max_depth
            || diffuse_depth.is_some_and(|depth| state.diffuse_depth > depth)
    }

    /// Adds the light of a surface, and returns how the path goes on.
    fn surface(&self, surface: &Surface, state: &mut PathState, sampler: &Sampler) -> Option<Path> {
        let path = surface.path;
        let material = surface.hit.material();
        let lobes = material.lobes();
        let known = self.colors.get(surface.index).and_then(Option::as_ref);
        let colors = known.copied().unwrap_or_else(|| LobeColors::new(&lobes));
        if lobes.emission.is_some() {
            state.color.get_or_insert_with(|| material.color());
            let is_lamp = material.lamp().is_some();
            if !(is_lamp && self.is_unseen(state)) {
                let weight = self.weight(state, |from| {
                    let at = (surface.hit.point, surface.n);
                    self.emitters.of_face(surface.own(), at, from)
                });
                self.add(state, path, path.factor * weight * colors.emission);
            }
            return None;
        }
        if let Some(glass) = lobes.interface {
            return self.glass(surface, *glass, state, sampler);
        }
        let frame = LocalFrame::new(surface.n);
        let bsdf = Bsdf::new(&lobes, &colors, frame.inward(surface.v));
        if !bsdf.is_mirror() {
            state.color.get_or_insert_with(|| material.color());
        }
        if self.is_exhausted(path, state) {
            return None;
        }
        let mirrored = |state: &mut PathState, factor| {
            self.sharpen(state, path);
            state.is_caustic |= state.has_scattered;
            let factor = path.factor * factor;
            let onward = || self.onward(surface, surface.mirrored(), factor);
            (factor != Radiance::BLACK).then(onward)
        };
        if bsdf.is_mirror() {
            return mirrored(state, bsdf.mirror());
        }
        let vertex = PathVertex {
            surface,
            frame,
            lobes: VertexLobes::Opaque(bsdf),
        };
        let [emitter, lobe] = sampler.at(path.depth, Purpose::Choice);
        self.shine(&vertex, emitter, state, sampler);
        self.number("lobe", "u of the lobe", lobe);
        match bsdf.sample(lobe, sampler.at(path.depth, Purpose::Direction)) {
            Onto::Mirror(factor) => mirrored(state, factor),
            Onto::Direction(l, is_diffuse) => {
                state.diffuse_depth += u32::from(is_diffuse);
                self.scatter(&vertex, l, state, sampler)
            }
        }
    }

    /// Returns how a path goes on in a direction that was chosen in the frame of a vertex.
    fn scatter(
        &self,
        vertex: &PathVertex,
        l: DVec3,
        state: &mut PathState,
        sampler: &Sampler,
    ) -> Option<Path> {
        let (surface, l) = (vertex.surface, vertex.frame.outward(l));
        let path = surface.path;
        let scattering = vertex.from(l);
        self.direction("next_l", "l, the next direction", l);
        self.radiance("next_f", "f, with the cosine", scattering.all);
        self.number("next_density", "q, its density", scattering.density);
        if scattering.density <= 0.0 {
            return None;
        }
        let mut factor = path.factor * scattering.all / scattering.density;
        if factor == Radiance::BLACK {
            return None;
        }
        if path.depth >= ROULETTE {
            let goes_on = factor.max_channel().min(MOST_LIKELY);
            let [u, _] = sampler.at(path.depth, Purpose::Roulette);
            self.number("roulette", "u of the roulette", u);
            self.number("goes_on", "s, the probability to go on", goes_on);
            if u >= goes_on {
                return None;
            }
            factor = factor / goes_on;
        }
        let share = scattering.diffuse_share();
        if path.depth == 0 {
            state.direct = share;
        }
        state.diffuse = share;
        state.last = Some(Scattered {
            point: surface.hit.point,
            density: scattering.density,
            weights: state.weights,
        });
        state.has_scattered = true;
        state.is_caustic = false;
        Some(Path {
            ray: Ray::new(surface.hit.point, l),
            start: Some(self.start_toward(vertex, l)),
            depth: path.depth + 1,
            factor,
        })
    }

    /// Returns where rays begin that leave a vertex in a direction.
    fn start_toward(&self, vertex: &PathVertex, l: DVec3) -> Departure {
        let start = self.start(vertex.surface);
        match l.dot(vertex.surface.n) > 0.0 {
            true => start.clone(),
            false => start.through(vertex.surface.path.ray.direction()),
        }
    }

    /// Returns where rays begin that a surface sends back.
    fn start<'s>(&self, surface: &'s Surface) -> &'s Departure {
        let (own, ray) = (surface.own(), &surface.path.ray);
        let start = || self.queries.start(own, ray, surface.hit.t);
        surface.start.get_or_init(start)
    }

    /// Returns the ray that a surface sends back, with the part of its light that arrives at the camera.
    fn onward(&self, surface: &Surface, direction: DVec3, factor: Radiance) -> Path {
        Path {
            ray: Ray::new(surface.hit.point, direction),
            start: Some(self.start(surface).clone()),
            depth: surface.path.depth + 1,
            factor,
        }
    }

    /// Notes that a mirror or smooth glass sends a path on.
    fn sharpen(&self, state: &mut PathState, path: &Path) {
        if path.depth == 0 {
            state.direct = Radiance::BLACK;
        }
        state.diffuse = Radiance::BLACK;
        state.last = None;
    }
}
