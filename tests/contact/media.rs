//! Glass by the solids that hold a ray: crossings that are nearly equal are one, and what is on both
//! sides of it is found from points between the crossings.

use strahl::{
    Color, Geometry, Lighting, Radiance, Ray, Vec3, World,
    light::{Ambient, Light},
    material::{Glass, Material},
};

use crate::{
    form::Form,
    line::Line,
    support::{Tally, example, sun, unit},
};

/// What a form is made of. Colors are gray.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stuff {
    Glass { ior: f64, color: f64 },
    Matte(f64),
    Flat(f64),
}

/// A scene with glass.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) items: Vec<(Form, Stuff)>,
    pub(crate) background: f64,
    pub(crate) ambient: f64,
    /// The direction to the sun, if there is one.
    pub(crate) sun: Option<Vec3>,
    pub(crate) max_depth: u32,
    /// Crossings that are nearer to each other are one.
    pub(crate) touch: f64,
    /// Where others are nearer to each other, the right value is not known.
    pub(crate) doubt: f64,
}

/// Clear glass.
pub(crate) const CLEAR: Stuff = Stuff::Glass {
    ior: 1.5,
    color: 1.0,
};

/// Clear water.
pub(crate) const WATER: Stuff = Stuff::Glass {
    ior: 1.33,
    color: 1.0,
};

/// The light of a pixel below which a ray is not traced.
const LEAST: f64 = 1.0 / 4096.0;

/// A crossing with an item.
#[derive(Clone, Copy, Debug)]
struct Event {
    t: f64,
    item: usize,
    n: Vec3,
}

/// Crossings that are one.
struct Joint {
    t: f64,
    /// The end of the last of them.
    end: f64,
    /// An opaque item with its normal.
    opaque: Option<(usize, Vec3)>,
    /// The first solid of glass that is left, and the first that is entered.
    left: Option<usize>,
    entered: Option<usize>,
    pane: Option<usize>,
    n: Vec3,
}

fn linear(display: f64) -> f64 {
    Color::new(display, display, display).to_linear().r()
}

/// Returns the reflected part at an angle whose cosine is given, and that of the refracted ray.
pub(crate) fn fresnel(cosine: f64, eta: f64) -> (f64, f64) {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt() / eta;
    if sine >= 1.0 {
        return (1.0, 0.0);
    }
    let refracted = (1.0 - sine * sine).sqrt();
    let s = (cosine - eta * refracted) / (cosine + eta * refracted);
    let p = (eta * cosine - refracted) / (eta * cosine + refracted);
    ((s * s + p * p) / 2.0, refracted)
}

impl Scene {
    /// A scene with a white background and no sun.
    pub(crate) fn new(items: Vec<(Form, Stuff)>) -> Self {
        Self {
            items,
            background: 1.0,
            ambient: 0.5,
            sun: None,
            max_depth: 8,
            touch: 1e-10,
            doubt: 1e-7,
        }
    }

    /// Returns the same scene with other items.
    pub(crate) fn with(&self, items: Vec<(Form, Stuff)>) -> Self {
        Self {
            items,
            ..self.clone()
        }
    }

    /// Returns the world of the library.
    pub(crate) fn world(&self) -> World {
        let gray = |value: f64| Color::new(value, value, value);
        let geometries = self.items.iter().map(|(form, stuff)| {
            let material: Material = match *stuff {
                Stuff::Glass { ior, color } => Glass::new(gray(color), ior).unwrap().into(),
                Stuff::Matte(color) => gray(color).into(),
                Stuff::Flat(color) => Material::Flat(gray(color)),
            };
            Geometry::new(form.shape(), material)
        });
        let ambient = Ambient::new(Color::WHITE, self.ambient).unwrap();
        let mut lights = vec![Light::from(ambient)];
        lights.extend(self.sun.map(|l| sun(-l)));
        let background = Color::from_linear(Radiance::WHITE * self.background);
        let lighting = Lighting {
            max_depth: self.max_depth,
            ..Lighting::new(lights)
        };
        World::new(geometries.collect(), background).lit(lighting)
    }

    /// Returns the light of a camera's ray, if it is known.
    pub(crate) fn light(&self, ray: &Ray) -> Option<f64> {
        self.follow(ray.origin(), ray.direction(), (0, 1.0))
    }

    /// Counts rays through the scene, which should see `right`.
    pub(crate) fn count(&self, tally: &mut Tally, rays: &[Ray], right: &Self, tolerance: f64) {
        let world = self.world();
        for ray in rays {
            let found = world.radiance(ray).r();
            tally.count([found, tolerance], right.light(ray), || {
                example(&self.items, ray, "")
            });
        }
    }

    fn follow(&self, o: Vec3, d: Vec3, (depth, factor): (u32, f64)) -> Option<f64> {
        if factor < LEAST {
            return Some(0.0);
        }
        if depth > self.max_depth {
            return Some(self.background);
        }
        let line = Line { o, d };
        let joints = Joints::new(self, line);
        let Some(joint) = joints.after(if depth == 0 && factor == 1.0 {
            0.0
        } else {
            self.touch
        })?
        else {
            return Some(self.background);
        };
        let point = line.at(joint.t);
        if let Some((item, n)) = joint.opaque {
            return self.opaque(item, point, unit(n) * -n.dot(d).signum());
        }
        let n = unit(joint.n) * -joint.n.dot(d).signum();
        let cosine = -n.dot(unit(d));
        let onward = |d, next| self.follow(point, d, next);
        let reflected = d - 2.0 * d.dot(n) * n;
        if joint.left.is_none() && joint.entered.is_none() {
            let Some(pane) = joint.pane else {
                return onward(d, (depth, factor));
            };
            let (ior, color) = self.glass(pane);
            let (f, _) = fresnel(cosine, ior);
            let through = color * (1.0 - f);
            let mirrored = onward(reflected, (depth + 1, factor * f))?;
            return Some(f * mirrored + through * onward(d, (depth + 1, factor * through))?);
        }
        let air = (1.0, 1.0);
        let (before, left) = joint.left.map_or(air, |item| self.glass(item));
        let (behind, entered) = joint.entered.map_or(air, |item| self.glass(item));
        let color = left * entered;
        if before == behind {
            return Some(color * onward(d, (depth, factor * color))?);
        }
        let eta = behind / before;
        let (f, cos_refracted) = fresnel(cosine, eta);
        let mirrored = onward(reflected, (depth + 1, factor * f))?;
        let through = color * (1.0 - f);
        let refracted = unit(d) / eta + (cosine / eta - cos_refracted) * n;
        Some(f * mirrored + through * onward(refracted, (depth + 1, factor * through))?)
    }

    /// Returns the light of an opaque item.
    fn opaque(&self, item: usize, point: Vec3, n: Vec3) -> Option<f64> {
        let color = match self.items[item].1 {
            Stuff::Flat(color) => return Some(linear(color)),
            Stuff::Matte(color) | Stuff::Glass { color, .. } => linear(color),
        };
        let sun = match self.sun {
            Some(l) if n.dot(l) > 0.0 => n.dot(unit(l)) * self.transmission(point, l)?,
            _ => 0.0,
        };
        Some(color * (self.ambient + sun))
    }

    /// Returns the part of the sun that comes through to a point.
    fn transmission(&self, point: Vec3, l: Vec3) -> Option<f64> {
        let joints = Joints::new(self, Line { o: point, d: l });
        let mut light = 1.0;
        let mut from = self.touch;
        while let Some(joint) = joints.after(from)? {
            if joint.opaque.is_some() {
                return Some(0.0);
            }
            from = joint.end * l.length() + self.touch;
            let cosine = (joint.n.dot(l) / (joint.n.length() * l.length())).abs();
            let of = |item: Option<usize>| item.map_or((1.0, 1.0), |item| self.glass(item));
            if joint.left.is_none() && joint.entered.is_none() {
                if let Some(pane) = joint.pane {
                    let (ior, color) = self.glass(pane);
                    light *= color * (1.0 - fresnel(cosine, ior).0);
                }
                continue;
            }
            let [(a, left), (b, entered)] = [of(joint.left), of(joint.entered)];
            let reflected = match (joint.left, joint.entered) {
                _ if a == b => 0.0,
                // As from outside.
                (Some(_), None) => fresnel(cosine, a).0,
                (None, _) => fresnel(cosine, b).0,
                _ => fresnel(cosine, a.max(b) / a.min(b)).0,
            };
            light *= left * entered * (1.0 - reflected);
        }
        Some(light)
    }

    /// Returns the index of refraction of glass, and its color in linear light.
    fn glass(&self, item: usize) -> (f64, f64) {
        match self.items[item].1 {
            Stuff::Glass { ior, color } => (ior, linear(color)),
            _ => (1.0, 1.0),
        }
    }
}

/// What a line crosses in a scene.
struct Joints<'a> {
    scene: &'a Scene,
    line: Line,
    /// All crossings, from near to far.
    events: Vec<Event>,
}

impl<'a> Joints<'a> {
    fn new(scene: &'a Scene, line: Line) -> Self {
        let mut events = Vec::new();
        for (item, (form, _)) in scene.items.iter().enumerate() {
            let found = form.crossings(&line).into_iter();
            events.extend(found.map(|at| Event {
                t: at.t,
                item,
                n: at.n,
            }));
        }
        events.sort_by(|a, b| a.t.total_cmp(&b.t));
        Self {
            scene,
            line,
            events,
        }
    }

    /// Returns true for each solid that holds a point of the line.
    fn inside(&self, t: f64) -> Vec<bool> {
        let items = self.scene.items.iter();
        items
            .map(|(form, _)| {
                form.is_solid()
                    && form
                        .spans(&self.line)
                        .iter()
                        .any(|[from, to]| from.t < t && t < to.t)
            })
            .collect()
    }

    /// Returns the first joint behind a distance; `None` if it is not known.
    #[expect(clippy::option_option, reason = "unknown is not the same as none")]
    fn after(&self, distance: f64) -> Option<Option<Joint>> {
        let Scene {
            items,
            touch,
            doubt,
            ..
        } = self.scene;
        let length = self.line.d.length();
        let Some(first) = self.events.iter().position(|at| at.t * length > distance) else {
            return Some(None);
        };
        let start = self.events[first].t;
        let is_one = |at: &Event| {
            let slope = at.n.dot(self.line.d).abs() / (at.n.length() * length);
            (at.t - start) * length * slope <= *touch
        };
        let count = self.events[first..]
            .iter()
            .take_while(|at| is_one(at))
            .count();
        let joint = &self.events[first..first + count];
        let end = joint[count - 1].t;
        let next = self.events.get(first + count).map(|at| at.t);
        let before = match first.checked_sub(1) {
            Some(last) => self.events[last].t.max(0.0),
            None => 0.0,
        };
        let is_near = |from: f64, to: f64| (to - from) * length < *doubt;
        if is_near(before, start) || next.is_some_and(|next| is_near(end, next)) {
            return None;
        }
        let held = self.inside((before + start) / 2.0);
        let holds = self.inside(next.map_or(end + 1.0 / length, |next| (end + next) / 2.0));
        let is_changed = |item: usize| held[item] != holds[item];
        let is_glass = |item: usize| matches!(items[item].1, Stuff::Glass { .. });
        let is_thin = |item: usize| !items[item].0.is_solid();
        let first_of = |of: &dyn Fn(usize) -> bool| (0..items.len()).find(|item| of(*item));
        let is_met = |item: usize| joint.iter().any(|at| at.item == item);
        let opaque = first_of(&|item| {
            !is_glass(item) && is_met(item) && (is_thin(item) || is_changed(item))
        });
        let [left, entered] = [&held, &holds]
            .map(|of: &Vec<bool>| first_of(&|item| is_glass(item) && is_changed(item) && of[item]));
        let pane = first_of(&|item| is_glass(item) && is_thin(item) && is_met(item));
        let counts = |at: &&Event| is_thin(at.item) || is_changed(at.item);
        let mut normals = joint.iter().filter(counts).map(|at| at.n);
        let n = normals.next().unwrap_or(joint[0].n);
        let is_flat = normals.all(|m| m.cross(n).length() <= 1e-6 * m.length() * n.length());
        let normal_of = |item| joint.iter().find(|at| at.item == item).map(|at| at.n);
        is_flat.then(|| {
            Some(Joint {
                t: start,
                end,
                opaque: opaque.and_then(|item| Some((item, normal_of(item)?))),
                left,
                entered,
                pane,
                n,
            })
        })
    }
}
