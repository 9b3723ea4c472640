//! The steps of the evaluation of light, for readers who want to check them by hand.
//!
//! Nothing is computed here: [`direct`](crate::integrator::direct) and
//! [`path`](crate::integrator::path) report each value as they use it.

use std::cell::RefCell;

use glam::DVec3;

use crate::{
    film::parts::LightParts,
    integrator::{
        Integrate, Integrator,
        direct::{Queries, Shaded, Step, Value},
        surface::Surface,
    },
    tracer::{
        color::Color,
        contact::{Contact, Departure, Passed},
        light::{Arriving, Light},
        material::parameters::Parameter,
        radiance::Radiance,
        ray::Ray,
        shape::{
            face::{Crossing, FaceId},
            working::Term,
        },
        tone::Tone,
        world::World,
    },
};

/// A ray and the light that it brings.
#[derive(Clone, Debug)]
pub struct TracedRay {
    /// The ray.
    pub ray: Ray,
    /// The face that it leaves.
    pub own: Option<FaceId>,
    /// The number of reflections and refractions before it.
    pub depth: u32,
    /// The part of its light that arrives at the camera.
    pub factor: Radiance,
    /// Its end.
    pub end: RayEnd,
    /// Its light.
    pub parts: LightParts,
}

/// The end of a ray.
#[derive(Clone, Debug)]
pub enum RayEnd {
    /// It meets nothing.
    Background,
    /// It is not traced and brings black: its factor is too small.
    Faint,
    /// It is not traced and brings the background: it is too deep.
    TooDeep,
    /// It meets a surface.
    Surface(Box<Shading>),
}

/// A surface and its light.
#[derive(Clone, Debug)]
pub struct Shading {
    /// The id of the geometry.
    pub id: usize,
    /// The ray parameter.
    pub t: f64,
    /// The point.
    pub point: DVec3,
    /// The unit vector to the viewer.
    pub v: DVec3,
    /// The unit normal on the side of the viewer.
    pub n: DVec3,
    /// The kind of material.
    pub material: &'static str,
    /// The equation of its light.
    pub equation: &'static str,
    /// Each light, if the material scatters any.
    pub lights: Vec<ShiningLight>,
    /// The parameters of the material and the terms of its equation.
    pub terms: Vec<Term>,
    /// The rays that the surface sends on.
    pub onward: Vec<TracedRay>,
    /// True once all lights are summed up.
    is_summed: bool,
}

/// A light that shines on a surface.
#[derive(Clone, Debug)]
pub struct ShiningLight {
    /// The index in the list of lights.
    pub index: usize,
    /// The kind of light.
    pub kind: &'static str,
    /// The terms of its equation.
    pub terms: Vec<Term>,
    /// The geometries in its way: id, `t` and the part of the light that comes through.
    pub crossings: Vec<(usize, f64, Radiance)>,
    /// Why it brings no light, if so.
    pub dark: Option<&'static str>,
}

/// Returns the steps of [`World::radiance`] in a lit world, for a picture with this tone; `None` in a flat
/// one.
pub fn explain(world: &World, ray: &Ray, tone: Tone) -> Option<TracedRay> {
    let recorder = StepRecorder {
        world,
        open: RefCell::default(),
    };
    let tell = |step: Step| recorder.note(step);
    let listener = Listener { world, tell: &tell };
    Integrator::new(world, &listener, tone, false).trace(ray);
    recorder.open.into_inner().pop()
}

/// A world that tells each step to a function.
pub(super) struct Listener<'a> {
    pub(super) world: &'a World,
    pub(super) tell: &'a dyn Fn(Step),
}

impl Queries for Listener<'_> {
    fn nearest(
        &self,
        ray: &Ray,
        start: Option<&Departure>,
    ) -> Result<Option<(usize, Crossing)>, Contact> {
        Queries::nearest(self.world, ray, start)
    }

    fn contact(&self, ray: &Ray, hit: (usize, Crossing)) -> Option<Contact> {
        Queries::contact(self.world, ray, hit)
    }

    fn brightest(&self) -> f64 {
        self.world.brightest()
    }

    fn transmission(&self, ray: &Ray, t_max: f64, start: &Departure) -> Radiance {
        let transmission = self.world.transmission(ray, t_max, start);
        self.tell(Step::Shadow(ray, t_max, start, transmission));
        transmission
    }

    const LISTENS: bool = true;

    fn tell(&self, step: Step) {
        (self.tell)(step);
    }
}

/// Calls `see` with the geometries in the way of a light: id, `t` and the part of the light that comes through.
pub(super) fn each_crossing(
    world: &World,
    (ray, t_max, start): (&Ray, f64, &Departure),
    mut see: impl FnMut((usize, f64, Radiance)),
) {
    world.each_in_the_way(ray, t_max, start, |passed| {
        let Passed {
            face, t, factor, ..
        } = passed;
        see((world.id_of(face.geometry, face.face), t, factor));
    });
}

/// What is recorded.
struct StepRecorder<'a> {
    world: &'a World,
    /// The rays that are being followed, each sent by the one before it.
    open: RefCell<Vec<TracedRay>>,
}

impl StepRecorder<'_> {
    fn note(&self, step: Step) {
        match step {
            Step::Ray(path) => self.open.borrow_mut().push(TracedRay {
                ray: path.ray,
                own: path.start.as_ref().map(Departure::own),
                depth: path.depth,
                factor: path.factor,
                end: RayEnd::Background,
                parts: LightParts::default(),
            }),
            Step::Faint => self.end(RayEnd::Faint),
            Step::TooDeep => self.end(RayEnd::TooDeep),
            Step::Surface(surface) => {
                self.end(RayEnd::Surface(Box::new(Shading::new(
                    surface,
                    self.world.id_of(surface.index, surface.hit.face),
                ))));
            }
            Step::Light(index, light) => {
                self.at_surface(|surface| surface.lights.push(ShiningLight::new(index, light)));
            }
            Step::Arriving(arriving) => self.at_light(|light| light.arriving(arriving)),
            Step::Term(name, symbol, value) => self.at_surface(|surface| {
                let term = term(name, symbol, value);
                match surface.lights.last_mut() {
                    Some(light) if !surface.is_summed => light.terms.push(term),
                    _ => surface.terms.push(term),
                }
            }),
            Step::FacesAway => self.at_light(|light| light.dark = Some("the surface faces away")),
            Step::Shadow(ray, t_max, start, transmission) => self.at_light(|light| {
                each_crossing(self.world, (ray, t_max, start), |crossing| {
                    light.crossings.push(crossing);
                });
                light.terms.extend([
                    Term::vector("shadow_direction", "shadow ray", ray.direction()),
                    Term::number("t_max", "t_max", t_max),
                    term("transmission", "transmission", Value::Light(transmission)),
                ]);
                light.dark = (transmission == Radiance::BLACK).then_some("it is in shadow");
            }),
            Step::Emitter(_) | Step::OtherEmitter(_) | Step::Adds(_) => {}
            Step::Summed => self.at_surface(|surface| surface.is_summed = true),
            Step::Brings(shaded) => self.close(shaded),
        }
    }

    fn end(&self, end: RayEnd) {
        if let Some(ray) = self.open.borrow_mut().last_mut() {
            ray.end = end;
        }
    }

    /// Closes the last open ray and gives it to the surface that sent it.
    fn close(&self, light: Shaded) {
        let mut open = self.open.borrow_mut();
        let Some(mut ray) = open.pop() else {
            return;
        };
        ray.parts = light.parts;
        match open.last_mut().map(|ray| &mut ray.end) {
            Some(RayEnd::Surface(surface)) => surface.onward.push(ray),
            _ => open.push(ray),
        }
    }

    fn at_surface(&self, change: impl FnOnce(&mut Shading)) {
        let mut open = self.open.borrow_mut();
        if let Some(RayEnd::Surface(surface)) = open.last_mut().map(|ray| &mut ray.end) {
            change(surface);
        }
    }

    fn at_light(&self, change: impl FnOnce(&mut ShiningLight)) {
        self.at_surface(|surface| {
            if let Some(light) = surface.lights.last_mut() {
                change(light);
            }
        });
    }
}

impl Shading {
    pub(super) fn new(surface: &Surface, id: usize) -> Self {
        let material = &*surface.hit.material();
        let mut terms = Vec::new();
        material.each_parameter(|parameter| {
            terms.push(match parameter {
                Parameter::Color(name, color) => linear(name, color),
                Parameter::Number(name, number) => Term::number(name, name, number),
            });
        });
        Self {
            id,
            t: surface.hit.t,
            point: surface.hit.point,
            v: surface.v,
            n: surface.n,
            material: material.kind(),
            equation: material.equation(),
            lights: Vec::new(),
            terms,
            onward: Vec::new(),
            is_summed: false,
        }
    }
}

impl ShiningLight {
    fn new(index: usize, light: &Light) -> Self {
        let glow = light.glow();
        Self {
            index,
            kind: light.kind(),
            terms: vec![
                Term::number("intensity", "intensity", glow.intensity()),
                linear("color", glow.color()),
            ],
            crossings: Vec::new(),
            dark: None,
        }
    }

    fn arriving(&mut self, arriving: Option<Arriving>) {
        let Some(Arriving { radiance, from }) = arriving else {
            self.dark = Some("the light lies on the point, or too far away");
            return;
        };
        if let Some(from) = from {
            self.terms.extend([
                Term::vector("l", "l", from.l),
                Term::number("falloff", "falloff", from.falloff),
                Term::number("cone", "cone", from.cone),
            ]);
        }
        let arriving = "(falloff·cone)·(intensity·lin(color))";
        self.terms
            .push(term("arriving", arriving, Value::Light(radiance)));
    }
}

fn linear(name: &'static str, color: Color) -> Term {
    let light = DVec3::from_array(color.to_linear().channels);
    Term::vector(name, format!("lin({name})"), light)
}

pub(super) fn term(name: &'static str, symbol: &'static str, value: Value) -> Term {
    match value {
        Value::Number(number) => Term::number(name, symbol, number),
        Value::Vector(vector) => Term::vector(name, symbol, vector),
        Value::Light(light) => Term::vector(name, symbol, DVec3::from_array(light.channels)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::{
        geometry::Geometry,
        light::{Directional, Falloff, Headlight, Point},
        material::{Glass, Material, Phong},
        shape::{plane::Plane, rectangle::Rectangle, sphere::Sphere},
        world::Lighting,
    };

    const GREY: Color = Color::new(0.5, 0.5, 0.5);

    fn world(max_depth: u32) -> World {
        let ball = |x: f64, material: Material| {
            let sphere = Sphere::new(DVec3::new(x, 0.0, -4.0), 1.0).unwrap();
            Geometry::new(sphere, material)
        };
        let floor = Plane::new(DVec3::new(0.0, -1.0, 0.0), DVec3::Y).unwrap();
        let phong = Phong::new(GREY, Color::WHITE, 20.0, GREY).unwrap();
        let geometries = vec![
            Geometry::new(floor, Color::WHITE),
            ball(-2.2, Glass::new(GREY, 1.5).unwrap().into()),
            ball(0.0, phong.into()),
            ball(2.2, Material::Mirror(GREY)),
        ];
        let position = DVec3::new(-6.0, 5.0, -2.0);
        let point = Point::new(position, Color::WHITE, 20.0, Falloff::InverseSquare, true);
        let sun = Directional::new(DVec3::new(0.1, -1.0, 0.0), GREY, 0.5, true);
        let lights = vec![
            Light::from(point.unwrap()),
            sun.unwrap().into(),
            Headlight::new(GREY, 0.3).unwrap().into(),
        ];
        let lighting = Lighting {
            max_depth,
            ..Lighting::new(lights)
        };
        World::new(geometries, GREY).lit(lighting)
    }

    fn rays() -> impl Iterator<Item = Ray> {
        let places = (-15..=15).flat_map(|x| (-10..=10).map(move |y| (x, y)));
        places.map(|(x, y)| {
            let direction = DVec3::new(f64::from(x) / 14.0, f64::from(y) / 14.0, -1.0);
            Ray::new(DVec3::ZERO, direction)
        })
    }

    fn vector(terms: &[Term], name: &str) -> Radiance {
        let term = terms.iter().find(|term| term.name == name).unwrap();
        let [r, g, b] = term.numbers[..] else {
            panic!("{term:?}")
        };
        Radiance::new(r, g, b)
    }

    fn light_of(terms: &[Term]) -> Option<Radiance> {
        let has_light = terms.iter().any(|term| term.name == "light");
        has_light.then(|| vector(terms, "light"))
    }

    /// Computes the light of a ray again, from the printed terms alone.
    fn again(ray: &TracedRay) -> Radiance {
        let RayEnd::Surface(surface) = &ray.end else {
            return ray.parts.direct;
        };
        let light = |name| vector(&surface.terms, name);
        let onward: Vec<_> = surface.onward.iter().map(again).collect();
        let sum = |lights: &[ShiningLight]| {
            let lights = lights.iter().filter_map(|light| light_of(&light.terms));
            lights.fold(Radiance::BLACK, |sum, light| sum + light)
        };
        for light in &surface.lights {
            let product = |product, (_, _, factor): &(_, _, Radiance)| product * *factor;
            let crossings = light.crossings.iter().fold(Radiance::WHITE, product);
            if light.terms.iter().any(|term| term.name == "transmission") {
                assert_eq!(crossings, vector(&light.terms, "transmission"));
            }
        }
        match surface.material {
            "matte" => light("color") * sum(&surface.lights),
            "phong" => {
                let direct = light("diffuse") * sum(&surface.lights)
                    + light("specular") * light("highlights");
                direct + light("reflection") * onward[0]
            }
            "mirror" => light("color") * onward[0],
            "glass" => light("reflected") * onward[0] + light("refracted") * onward[1],
            other => panic!("{other}"),
        }
    }

    #[test]
    fn the_steps_give_the_light_of_the_ray_in_every_bit() {
        for max_depth in [0, 1, 8] {
            let world = world(max_depth);
            for ray in rays() {
                let steps = explain(&world, &ray, Tone::default()).unwrap();
                assert_eq!(steps.parts.sum(), world.radiance(&ray));
                assert_eq!(again(&steps), world.radiance(&ray), "{steps:#?}");
            }
        }
    }

    // The mirrored ray crosses the pane where it begins.
    #[test]
    fn glass_at_the_start_of_a_ray_is_told() {
        let mirror = Plane::new(DVec3::ZERO, DVec3::Y).unwrap();
        let pane = Rectangle::new(DVec3::NEG_Z, DVec3::Y, DVec3::Z * 2.0).unwrap();
        let geometries = vec![
            Geometry::new(mirror, Material::Mirror(GREY)),
            Geometry::new(pane, Glass::new(GREY, 1.5).unwrap()),
        ];
        let world = World::new(geometries, GREY).lit(Lighting::new(vec![]));
        let ray = Ray::new(DVec3::new(1.0, 1.0, 0.0), DVec3::new(-1.0, -1.0, 0.0));
        let steps = explain(&world, &ray, Tone::default()).unwrap();
        assert_eq!(steps.parts.sum(), world.radiance(&ray));
        assert_eq!(again(&steps), world.radiance(&ray), "{steps:#?}");
        let ends = |ray: &TracedRay| match &ray.end {
            RayEnd::Surface(surface) => Some((surface.id, surface.t, surface.onward.clone())),
            _ => None,
        };
        let (id, _, onward) = ends(&steps).unwrap();
        assert_eq!((id, onward.len()), (0, 1));
        let (id, t, onward) = ends(&onward[0]).unwrap();
        assert_eq!((id, t, onward.len()), (1, 0.0, 2));
    }

    #[test]
    fn every_way_to_end_is_told() {
        fn count(ray: &TracedRay, counts: &mut [usize; 4]) {
            let place = match &ray.end {
                RayEnd::Background => 0,
                RayEnd::Faint => 1,
                RayEnd::TooDeep => 2,
                RayEnd::Surface(surface) => {
                    surface.onward.iter().for_each(|ray| count(ray, counts));
                    3
                }
            };
            counts[place] += 1;
        }
        let mut counts = [0; 4];
        for depth in [1, 20] {
            let world = world(depth);
            rays().for_each(|ray| {
                count(
                    &explain(&world, &ray, Tone::default()).unwrap(),
                    &mut counts,
                )
            });
        }
        assert!(counts.iter().all(|count| *count > 0), "{counts:?}");
        let flat = World::new(vec![], GREY);
        assert!(explain(&flat, &Ray::new(DVec3::ZERO, DVec3::Z), Tone::default()).is_none());
    }
}
