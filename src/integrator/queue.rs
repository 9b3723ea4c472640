//! The light of many hits at once. The rays that their surfaces send on wait for others of the same depth, so that what
//! these meet is shaded eight at a time. The light is that of [`direct`](crate::integrator::direct), added up in the
//! same order.

use std::{
    mem,
    ops::{Add, Range},
};

use crate::{
    accel::shadow::Shadows,
    integrator::{
        batch::{Cache, HitRow, OnwardRow, Others, ShadeRow},
        direct::{Direct, Queries, Sent, Shaded},
        surface::{Onward, Path, Shadow, Surface},
    },
    simd::isa::Isa,
    tracer::{radiance::Radiance, ray::Ray, shape::face::FaceId},
};

/// The number of hits whose rays wait together. Tests use fewer.
const TOGETHER: usize = if cfg!(test) { 24 } else { 1 << 10 };
/// The number of rays of these hits from which on the others are followed one by one, so that memory is bounded.
/// Tests use less.
const MOST: usize = if cfg!(test) { 500 } else { 1 << 16 };

/// A hit of a camera's ray.
pub(crate) struct Seen<'a> {
    /// Its number in a row.
    pub(crate) place: usize,
    pub(crate) ray: Ray,
    pub(crate) t: f64,
    pub(crate) id: FaceId,
    /// The shadow of each light.
    pub(crate) shadows: &'a [Shadow],
}

/// What rows of hits are shaded with.
pub(crate) struct Lanes<'a> {
    pub(crate) isa: Isa,
    /// The shadows of each light, unless it casts none.
    pub(crate) shadows: &'a [Option<Shadows<'a>>],
    pub(crate) known: &'a mut Cache,
}

/// The memory of rays and of their light.
#[derive(Default)]
pub(crate) struct Queue {
    lights: PathLights,
    /// The rays of a depth.
    rays: Vec<Onward>,
    hits: Hits,
    /// The light of these hits by channel.
    light: [Vec<f64>; 3],
    /// The hits that are to be shaded one by one.
    others: Others,
}

/// The light of paths.
#[derive(Default)]
struct PathLights {
    /// That of the hits, then that of all rays, those of lower depth first.
    all: Vec<PathLight>,
    /// The rays of the next depth, whose light follows.
    next: Vec<Onward>,
}

/// The light of a path.
struct PathLight {
    /// That of the surface.
    shaded: Shaded,
    /// The rays whose light is added.
    onward: Range<usize>,
    /// The part of it that is sent on.
    factor: Radiance,
}

/// The rays of a depth that meet a surface.
#[derive(Default)]
struct Hits {
    /// The numbers of their light.
    numbers: Vec<usize>,
    /// The origins and the directions, by axis.
    vectors: [[Vec<f64>; 3]; 2],
    t: Vec<f64>,
    /// The indices of the geometries.
    indices: Vec<u32>,
    faces: Vec<u64>,
}

impl PathLight {
    /// The light of a ray that has not been followed yet.
    fn later(factor: Radiance) -> Self {
        Self {
            shaded: Shaded::default(),
            onward: 0..0,
            factor,
        }
    }
}

impl PathLights {
    /// Notes the light of a surface, and the rays that it sends on.
    fn note(&mut self, number: usize, light_of: impl FnOnce(&mut Vec<Onward>) -> Sent) {
        let first = self.next.len();
        let sent = light_of(&mut self.next);
        let shaded = sent.unwrap_or_else(|straight| {
            self.next.truncate(first);
            self.next.push(*straight);
            Shaded::default()
        });
        let known = self.all.len();
        let light = &mut self.all[number];
        light.shaded = shaded;
        light.onward = known + first..known + self.next.len();
    }

    /// Adds the light of all rays to that of the surfaces that send it on.
    fn add_up(&mut self) {
        for number in (0..self.all.len()).rev() {
            let PathLight { shaded, onward, .. } = &self.all[number];
            let onward = self.all[onward.clone()].iter();
            let sent_on = onward.map(|light| light.shaded.sent_on(light.factor));
            self.all[number].shaded = sent_on.fold(*shaded, Add::add);
        }
    }
}

impl Queue {
    /// Passes on the light of hits.
    pub(super) fn shade<'a, Q: Queries>(
        &mut self,
        direct: &Direct<Q>,
        mut seen: impl Iterator<Item = Seen<'a>>,
        mut lanes: Lanes,
        mut set: impl FnMut(usize, Shaded),
    ) {
        loop {
            let seen: Vec<_> = seen.by_ref().take(TOGETHER).collect();
            if seen.is_empty() {
                return;
            }
            let lights = &mut self.lights;
            lights.all.clear();
            lights
                .all
                .resize_with(seen.len(), || PathLight::later(Radiance::WHITE));
            for (number, seen) in seen.iter().enumerate() {
                let path = Path::new(seen.ray);
                let hit = (seen.t, seen.id);
                let surface = Surface::shadowed(direct.world, &path, hit, seen.shadows);
                lights.note(number, |onward| direct.light_of(&surface, onward));
            }
            while !self.lights.next.is_empty() {
                mem::swap(&mut self.rays, &mut self.lights.next);
                self.lights.next.clear();
                self.follow(direct, &mut lanes);
            }
            self.lights.add_up();
            for (seen, light) in seen.iter().zip(&self.lights.all) {
                set(seen.place, light.shaded);
            }
        }
    }

    /// Follows the rays of a depth.
    fn follow<Q: Queries>(&mut self, direct: &Direct<Q>, lanes: &mut Lanes) {
        let (world, lights) = (direct.world, &mut self.lights);
        let first = lights.all.len();
        let later = self.rays.iter().map(|ray| PathLight::later(ray.factor));
        lights.all.extend(later);
        self.hits.clear();
        for (number, Onward { path, .. }) in (first..).zip(&self.rays) {
            if lights.all.len() > MOST {
                lights.all[number].shaded = direct.follow(path.clone());
                continue;
            }
            lights.note(number, |onward| {
                let (t, id) = match direct.meet(path, onward) {
                    Ok(hit) => hit,
                    Err(sent) => return sent,
                };
                if lanes.known.is_clear(world, id.geometry as u32) {
                    return direct.light_of(&Surface::new(world, path, t, id), onward);
                }
                self.hits.push(number, &path.ray, (t, id));
                Ok(Shaded::default())
            });
        }
        for light in &mut self.light {
            light.resize(self.hits.numbers.len(), 0.0);
        }
        self.others.clear();
        lanes.isa.run(ShadeRow {
            world,
            shadows: lanes.shadows,
            queries: direct.queries,
            row: HitRow::Onward(self.hits.row()),
            known: lanes.known,
            light: self.light.each_mut().map(Vec::as_mut_slice),
            others: &mut self.others,
        });
        for (place, number) in self.hits.numbers.iter().enumerate() {
            let [r, g, b] = self.light.each_ref().map(|light| light[place]);
            lights.all[*number].shaded = Shaded::direct(Radiance::new(r, g, b));
        }
        for (place, shadows) in self.others.each() {
            let number = self.hits.numbers[place];
            let path = &self.rays[number - first].path;
            let surface = Surface::shadowed(world, path, self.hits.hit(place), shadows);
            lights.note(number, |onward| direct.light_of(&surface, onward));
        }
    }
}

impl Hits {
    fn clear(&mut self) {
        self.numbers.clear();
        self.vectors
            .as_flattened_mut()
            .iter_mut()
            .for_each(Vec::clear);
        self.t.clear();
        self.indices.clear();
        self.faces.clear();
    }

    fn push(&mut self, number: usize, ray: &Ray, (t, id): (f64, FaceId)) {
        let vectors = [ray.origin(), ray.direction()].map(|vector| vector.to_array());
        let axes = self.vectors.as_flattened_mut().iter_mut();
        for (axis, number) in axes.zip(vectors.as_flattened()) {
            axis.push(*number);
        }
        self.numbers.push(number);
        self.t.push(t);
        self.indices.push(id.geometry as u32);
        self.faces.push(id.face);
    }

    fn row(&self) -> OnwardRow<'_> {
        let [origins, directions] = self
            .vectors
            .each_ref()
            .map(|axes| axes.each_ref().map(Vec::as_slice));
        OnwardRow {
            origins,
            directions,
            indices: &self.indices,
            faces: &self.faces,
            t: &self.t,
        }
    }

    fn hit(&self, place: usize) -> (f64, FaceId) {
        let (geometry, face) = (self.indices[place] as usize, self.faces[place]);
        (self.t[place], FaceId { geometry, face })
    }
}
