//! The emitters that paths aim at, and the choice of one at a point.

use std::{collections::HashMap, f64::consts::PI, sync::Arc};

use glam::DVec3;
use smallvec::SmallVec;

use crate::{
    accel::lanes::{dot, splat3, sub},
    integrator::path::emitter_tree::{EmitterTree, PlacedEmitter},
    simd::{F64x8, Mask, Simd},
    tracer::{
        contact::Departure,
        geometry::Geometry,
        light::{
            Light,
            environment::Environment,
            falloff::{END, Falloff},
            source::{LightSize, Source},
        },
        radiance::Radiance,
        ray::Ray,
        sampling::UnitPair,
        shape::{
            face::{FaceId, Leaving},
            target::{AimedAt, ConeOfDirections, Target, to_ball},
        },
        vector::unit,
        world::World,
    },
};

/// The number of emitters whose sums need no memory of their own.
const FEW: usize = 16;
/// The number of emitters whose weights and probabilities are told.
const SHOWN: usize = 8;
/// The part of the way to a curved face by which the point that a ray meets may lie before the one that it
/// was aimed at: 2⁻²⁰.
const NEAR: f64 = 1.0 / (1 << 20) as f64;

/// Everything that paths aim at: lights, in file order, then faces that shine.
#[derive(Clone, Debug, Default)]
pub(crate) struct Emitters {
    all: Vec<Emitter>,
    /// The numbers of those that are not in the tree, in ascending order.
    listed: Vec<usize>,
    tree: Option<Arc<EmitterTree>>,
    /// The numbers of the emitters that faces are.
    faces: HashMap<FaceId, usize>,
    /// The numbers of the lights that rays pass.
    passed: Vec<usize>,
    /// The number of the surroundings.
    environment: Option<usize>,
}

/// The weights of all emitters at a point.
pub(super) struct EmitterWeights<'a> {
    emitters: &'a Emitters,
    point: DVec3,
    /// The weights of those that are listed, and that of the tree last, with their sums in this order.
    all: SmallVec<[[f64; 2]; FEW]>,
}

/// Something that paths aim at.
#[derive(Clone, Debug)]
pub(super) enum Emitter {
    /// A light, which may have a size.
    Light(Light),
    /// The surroundings, and the mean of the largest channel of their light.
    Environment(Environment, f64),
    /// Faces that shine: one, or all of a capsule.
    Faces {
        target: Target,
        first: FaceId,
        count: u64,
        /// The largest channel of their light.
        brightest: f64,
        /// Their light, if it is the same everywhere.
        light: Option<Radiance>,
    },
}

/// What an emitter is in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmittedBy {
    /// The light of this index.
    Light(usize),
    /// A face that shines.
    Face(FaceId),
}

/// An emitter, and how likely paths aim at it from a point.
#[derive(Clone, Copy, Debug)]
pub struct EmitterChance {
    /// The emitter.
    pub emitter: EmittedBy,
    /// W: an estimate of the irradiance that it brings, without shadows.
    pub weight: f64,
    /// P: the probability that it is chosen.
    pub probability: f64,
}

/// A direction to an emitter, and its light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aimed {
    /// The unit vector.
    pub(super) l: DVec3,
    /// The light that comes along it: radiance, or that of [`Light::arriving`] without a size.
    pub(super) light: Radiance,
    /// The ray of its shadows, if it casts any.
    pub(super) shadow: Option<(DVec3, f64)>,
    /// The density of the direction; `None` without a size.
    pub(super) density: Option<f64>,
    /// True if rays that are not aimed may find it, too.
    pub(super) is_found: bool,
}

/// An emitter that a ray meets, and its light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passing {
    pub(super) number: usize,
    pub(super) light: Radiance,
    /// The density of the direction from the point that paths aim from.
    pub(super) density: f64,
}

impl Emitters {
    /// Lists the emitters of a world.
    pub(crate) fn new(world: &World) -> Self {
        let lights = aimed_at(world).map(|(_, light)| Emitter::of_light(light));
        let mut emitters = Self {
            all: lights.collect(),
            ..Self::default()
        };
        for (number, emitter) in emitters.all.iter().enumerate() {
            match emitter {
                Emitter::Light(light) if light.size() != LightSize::None && light.shadows() => {
                    emitters.passed.push(number);
                }
                Emitter::Environment(..) => emitters.environment = Some(number),
                Emitter::Light(_) | Emitter::Faces { .. } => {}
            }
        }
        for (index, geometry) in world.geometries().iter().enumerate() {
            emitters.add(world, index, geometry);
        }
        let all = emitters.all.iter().enumerate();
        let placed = all.filter_map(|(number, emitter)| emitter.placed(number));
        emitters.tree = EmitterTree::new(placed.collect()).map(Arc::new);
        let numbers = 0..emitters.all.len();
        let tree = emitters.tree.as_ref();
        let is_listed = |number: &usize| !tree.is_some_and(|tree| tree.has(*number));
        emitters.listed = numbers.filter(is_listed).collect();
        emitters
    }

    /// Adds the faces of a geometry that shine.
    fn add(&mut self, world: &World, geometry: usize, of: &Geometry) {
        if of.materials().all(|material| material.lamp().is_none()) {
            return;
        }
        of.shape().each_target(&mut |face, count, target| {
            let first = FaceId { geometry, face };
            // Where the vertices of a mesh determine colors, the middle counts.
            let normal = target.normal().unwrap_or(DVec3::X);
            let ray = Ray::new(target.middle() + normal, -normal);
            let material = world.hit_on(&ray, 1.0, first).material();
            let light = material.lamp().map(|lamp| lamp.radiance().max_channel());
            let Some(brightest) = light.filter(|light| *light > 0.0) else {
                return;
            };
            for face in face..face + count {
                self.faces.insert(FaceId { geometry, face }, self.all.len());
            }
            self.all.push(Emitter::Faces {
                target,
                first,
                count,
                brightest,
                light: of
                    .only_material()
                    .and_then(|material| Some(material.lamp()?.radiance())),
            });
        });
    }

    /// All, in the order of their numbers.
    pub(super) fn all(&self) -> &[Emitter] {
        &self.all
    }

    /// The tree of most of them, if they are many.
    pub(super) fn tree(&self) -> Option<&EmitterTree> {
        self.tree.as_deref()
    }

    /// Returns the weights of all emitters at a point.
    pub(super) fn weights(&self, point: DVec3) -> EmitterWeights<'_> {
        let mut sum = 0.0;
        let listed = self
            .listed
            .iter()
            .map(|number| self.all[*number].weight(point));
        let tree = self.tree.iter().map(|tree| tree.weight(point));
        let with_sum = |weight: f64| {
            sum += weight;
            [weight, sum]
        };
        EmitterWeights {
            emitters: self,
            point,
            all: listed.chain(tree).map(with_sum).collect(),
        }
    }

    /// Returns the weight of one emitter at a point.
    fn of_one(&self, point: DVec3) -> impl Fn(usize) -> f64 + '_ {
        move |number| self.all[number].weight(point)
    }

    /// Returns the probability of an emitter at a point, given the sum of all weights there.
    pub(super) fn probability(&self, (point, sum): (DVec3, f64), number: usize) -> f64 {
        if sum <= 0.0 {
            return 0.0;
        }
        match self.tree.as_ref().filter(|tree| tree.has(number)) {
            Some(tree) => {
                let of_tree = tree.weight(point) / sum;
                of_tree * tree.probability(point, number, self.of_one(point))
            }
            None => self.all[number].weight(point) / sum,
        }
    }

    /// Returns true if an emitter is a face that is not flat.
    pub(super) fn is_curved(&self, number: usize) -> bool {
        match &self.all[number] {
            Emitter::Faces { target, .. } => target.normal().is_none(),
            Emitter::Light(_) | Emitter::Environment(..) => false,
        }
    }

    /// Returns a direction from a surface to an emitter, given all faces that rays leave there if it is curved.
    pub(super) fn aim(
        &self,
        world: &World,
        number: usize,
        (point, start): (DVec3, &Departure),
        pair: UnitPair,
    ) -> Option<Aimed> {
        match &self.all[number] {
            Emitter::Light(light) => aim_at_light(light, point, pair),
            Emitter::Environment(environment, _) => {
                let (l, density) = environment.sample(pair);
                Some(Aimed {
                    l,
                    light: environment.radiance(l),
                    shadow: Some((l, f64::INFINITY)),
                    density: Some(density),
                    is_found: true,
                })
            }
            Emitter::Faces {
                target,
                first,
                count,
                light,
                ..
            } => {
                let AimedAt {
                    l,
                    distance,
                    density,
                } = target.sample(point, pair)?;
                let ray = Ray::new(point, l);
                let mut id = *first;
                let t_max = match target {
                    Target::Flat(_) => distance * END,
                    Target::Ball { .. } | Target::Side { .. } | Target::Capsule { .. } => {
                        let shape = world.geometries()[first.geometry].shape();
                        let leaving = Leaving::of(start.left(), first.geometry);
                        let met = shape.meet(&ray, leaving, f64::INFINITY)?;
                        let is_it = (first.face..first.face + count).contains(&met.face);
                        if !is_it || (met.t - distance).abs() > NEAR * distance {
                            return None;
                        }
                        id.face = met.face;
                        met.t
                    }
                };
                let light = light.or_else(|| {
                    let material = world.hit_on(&ray, distance, id).material();
                    Some(material.lamp()?.radiance())
                })?;
                Some(Aimed {
                    l,
                    light,
                    shadow: Some((l, t_max)),
                    density: Some(density),
                    is_found: true,
                })
            }
        }
    }

    /// Returns the emitter that a face is, and the density of the direction from a point to one on it.
    pub(super) fn of_face(
        &self,
        face: FaceId,
        (at, normal): (DVec3, DVec3),
        from: DVec3,
    ) -> Option<(usize, f64)> {
        let number = *self.faces.get(&face)?;
        match &self.all[number] {
            Emitter::Faces { target, .. } => Some((number, target.density(from, at, normal))),
            Emitter::Light(_) | Emitter::Environment(..) => None,
        }
    }

    /// Returns what an emitter is in the scene.
    pub(super) fn emitted_by(&self, world: &World, number: usize) -> Option<EmittedBy> {
        if let Emitter::Faces { first, .. } = self.all.get(number)? {
            return Some(EmittedBy::Face(*first));
        }
        let mut lights = aimed_at(world).map(|(index, _)| EmittedBy::Light(index));
        lights.nth(number)
    }

    /// Returns an emitter that is chosen for a point with a probability, and its weight.
    pub(super) fn chance(
        &self,
        world: &World,
        point: DVec3,
        (number, probability): (usize, f64),
    ) -> Option<EmitterChance> {
        Some(EmitterChance {
            emitter: self.emitted_by(world, number)?,
            weight: self.all[number].weight(point),
            probability,
        })
    }

    /// Returns the first emitters, with their weights and probabilities at a point.
    pub(super) fn first_chances(
        &self,
        world: &World,
        point: DVec3,
    ) -> impl Iterator<Item = EmitterChance> {
        let first = 0..self.all.len().min(SHOWN);
        let sum = self.weights(point).sum();
        first.filter_map(move |number| {
            let probability = self.probability((point, sum), number);
            self.chance(world, point, (number, probability))
        })
    }

    /// Returns the surroundings and their number.
    pub(super) fn environment(&self) -> Option<(&Environment, usize)> {
        let number = self.environment?;
        match &self.all[number] {
            Emitter::Environment(environment, _) => Some((environment, number)),
            Emitter::Light(_) | Emitter::Faces { .. } => None,
        }
    }

    /// Returns the lanes of rays that pass a light before a distance, given their origins and unit vectors along them:
    /// those for which [`Emitters::each_passed`] finds one, and maybe others.
    #[inline(always)]
    pub(super) fn passed_by<S: Simd>(
        &self,
        simd: S,
        [origin, l]: [[S::F64; 3]; 2],
        distance: S::F64,
    ) -> u8 {
        let (zero, mut passed) = (simd.splat(0.0), 0);
        for number in &self.passed {
            let Emitter::Light(light) = &self.all[*number] else {
                continue;
            };
            match (light.size(), light.source()) {
                (LightSize::Ball(radius), Source::Point { position, .. }) => {
                    let to = sub(splat3(simd, position), origin);
                    let along = dot(to, l);
                    let across = [
                        to[0] - along * l[0],
                        to[1] - along * l[1],
                        to[2] - along * l[2],
                    ];
                    let half = simd.splat(radius * radius) - dot(across, across);
                    let is_near = zero.le(half) & (along - half.sqrt()).lt(distance);
                    passed |= (is_near & zero.lt(along)).bits();
                }
                (LightSize::Disc(sin_squared), Source::Direction(to_light)) => {
                    let cosine = dot(splat3(simd, unit(to_light)), l);
                    // At the edge, rounding errors decide.
                    let least = (1.0 - sin_squared).sqrt() - NEAR;
                    let is_inside = simd.splat(least).le(cosine);
                    passed |= (is_inside & !distance.lt(simd.splat(f64::INFINITY))).bits();
                }
                _ => passed = u8::MAX,
            }
        }
        passed
    }

    /// Calls `see` with each light of a size that a ray passes before a distance; paths aim at it from a
    /// point.
    pub(super) fn each_passed(
        &self,
        ray: &Ray,
        (from, distance): (DVec3, f64),
        mut see: impl FnMut(Passing),
    ) {
        for number in self.passed.iter().copied() {
            let Emitter::Light(light) = &self.all[number] else {
                continue;
            };
            let Some((size, radiance)) = light_of_size(light, from) else {
                continue;
            };
            let l = unit(ray.direction());
            let is_passed = match size {
                LightExtent::Ball(center, radius) => {
                    let to = center - ray.origin();
                    let along = to.dot(l);
                    let across = to - along * l;
                    let half = radius * radius - across.dot(across);
                    let is_outside = to.dot(to) > radius * radius;
                    is_outside && along > 0.0 && half >= 0.0 && along - half.sqrt() < distance
                }
                LightExtent::Cone(cone) => distance == f64::INFINITY && cone.holds(l),
            };
            if is_passed {
                let density = size.cone(from).map_or(0.0, |cone| cone.density());
                see(Passing {
                    number,
                    light: radiance,
                    density,
                });
            }
        }
    }
}

impl EmitterWeights<'_> {
    /// Their sum.
    pub(super) fn sum(&self) -> f64 {
        self.all.last().map_or(0.0, |[_, sum]| *sum)
    }

    /// Chooses an emitter by a number: it and its probability, which is in proportion to the irradiance that it
    /// may bring. `None` if none brings any.
    pub(super) fn choose(&self, u: f64) -> Option<(usize, f64)> {
        let Self {
            emitters,
            point,
            all,
        } = self;
        let sum = Some(self.sum()).filter(|sum| *sum > 0.0)?;
        let at = u * sum;
        let place = all.partition_point(|[_, before]| *before <= at);
        let [weight, until] = *all.get(place)?;
        if let Some(number) = emitters.listed.get(place) {
            return Some((*number, weight / sum));
        }
        let (tree, of_one) = (emitters.tree.as_ref()?, emitters.of_one(*point));
        let (number, probability) =
            tree.choose(*point, (at - (until - weight)) / weight, of_one)?;
        Some((number, weight / sum * probability))
    }
}

/// Returns the lights that paths aim at, and their indices.
fn aimed_at(world: &World) -> impl Iterator<Item = (usize, &Light)> {
    let lights = world.lights().iter().enumerate();
    lights.filter(|(_, light)| match light.source() {
        Source::Everywhere | Source::Viewer => false,
        Source::Surroundings | Source::Direction(_) | Source::Point { .. } => true,
    })
}

/// The extent of a light of a size.
#[derive(Clone, Copy, Debug)]
pub(super) enum LightExtent {
    Ball(DVec3, f64),
    Cone(ConeOfDirections),
}

impl LightExtent {
    /// Returns the directions to it from a point.
    fn cone(&self, point: DVec3) -> Option<ConeOfDirections> {
        match self {
            Self::Ball(center, radius) => ConeOfDirections::of_ball(point, *center, *radius),
            Self::Cone(cone) => Some(*cone),
        }
    }
}

/// Returns the extent of a light and its radiance for a point; `None` without a size, and inside of it.
pub(super) fn light_of_size(light: &Light, point: DVec3) -> Option<(LightExtent, Radiance)> {
    let arriving = light.arriving(point, DVec3::Z)?.radiance;
    match (light.size(), light.source()) {
        (LightSize::Ball(radius), Source::Point { position, .. }) => {
            let to = position - point;
            let squared = to.dot(to) / (radius * radius);
            (squared > 1.0).then_some((LightExtent::Ball(position, radius), arriving * squared))
        }
        (LightSize::Disc(sin_squared), Source::Direction(to_light)) => {
            let cone = ConeOfDirections::new(unit(to_light), sin_squared);
            Some((LightExtent::Cone(cone), arriving / sin_squared))
        }
        _ => None,
    }
}

/// Returns a direction to a light.
fn aim_at_light(light: &Light, point: DVec3, pair: UnitPair) -> Option<Aimed> {
    if light.size() == LightSize::None {
        let arriving = light.arriving(point, DVec3::Z)?;
        let from = arriving.from?;
        return Some(Aimed {
            l: from.l,
            light: arriving.radiance,
            shadow: from.shadow.map(|ray| (ray.direction, ray.t_max)),
            density: None,
            is_found: false,
        });
    }
    let (size, radiance) = light_of_size(light, point)?;
    let cone = size.cone(point)?;
    let density = Some(cone.density()).filter(|density| density.is_finite())?;
    let l = cone.sample(pair);
    let t_max = match size {
        LightExtent::Ball(center, radius) => to_ball((center - point, radius), l) * END,
        LightExtent::Cone(_) => f64::INFINITY,
    };
    Some(Aimed {
        l,
        light: radiance,
        shadow: light.shadows().then_some((l, t_max)),
        density: Some(density),
        is_found: light.shadows(),
    })
}

impl Emitter {
    fn of_light(light: &Light) -> Self {
        match light {
            Light::Environment(environment) => {
                Self::Environment(environment.clone(), environment.mean())
            }
            other => Self::Light(other.clone()),
        }
    }

    /// Returns its place and its power for a tree, if its light weakens with the square of the distance.
    fn placed(&self, number: usize) -> Option<PlacedEmitter> {
        let (middle, power) = match self {
            Self::Light(light) => match light.source() {
                Source::Point {
                    position,
                    falloff: Falloff::InverseSquare,
                    ..
                } => (position, PI * light.glow().radiance().max_channel()),
                _ => return None,
            },
            Self::Environment(..) => return None,
            Self::Faces {
                target, brightest, ..
            } => (target.middle(), brightest * target.power()),
        };
        Some(PlacedEmitter {
            number,
            middle,
            power,
        })
    }

    /// Returns an estimate of the irradiance that it brings to a point, without shadows: its largest
    /// channel.
    pub(super) fn weight(&self, point: DVec3) -> f64 {
        let weight = match self {
            Self::Light(light) => {
                let is_inside = match (light.size(), light.source()) {
                    (LightSize::Ball(radius), Source::Point { position, .. }) => {
                        let to = position - point;
                        to.dot(to) <= radius * radius
                    }
                    _ => false,
                };
                let arriving = light.arriving(point, DVec3::Z).filter(|_| !is_inside);
                arriving.map_or(0.0, |arriving| PI * arriving.radiance.max_channel())
            }
            Self::Environment(_, mean) => PI * mean,
            Self::Faces {
                target, brightest, ..
            } => brightest * target.weight(point),
        };
        match weight.is_finite() {
            true => weight,
            false => 0.0,
        }
    }
}
