//! Rows of hits, eight of which are in the lanes of vectors.

use glam::DVec3;

use super::surfaces::{Cache, Surfaces};
use crate::{
    accel::{
        lanes::{dot, splat3, sub, unit},
        pow::pow,
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{camera::Camera, ray::Ray, world::World},
};

/// A row of samples and their hits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleRow<'a> {
    pub(crate) camera: &'a Camera,
    /// The parts of the rays that columns share, by axis.
    pub(crate) columns: [&'a [f64]; 3],
    /// The part that the row shares.
    pub(crate) row: DVec3,
    pub(crate) ids: &'a [u32],
    pub(crate) t: &'a [f64],
}

/// Rays that begin anywhere, and their hits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnwardRow<'a> {
    /// By axis.
    pub(crate) origins: [&'a [f64]; 3],
    pub(crate) directions: [&'a [f64]; 3],
    /// The indices of the geometries.
    pub(crate) indices: &'a [u32],
    pub(crate) faces: &'a [u64],
    pub(crate) t: &'a [f64],
}

/// Hits to be shaded.
#[derive(Clone, Copy, Debug)]
pub(crate) enum HitRow<'a> {
    Samples(SampleRow<'a>),
    Onward(OnwardRow<'a>),
}

/// Eight hits.
pub(super) struct Hits<S: Simd> {
    /// The indices of the geometries.
    pub(super) indices: [u32; LANES],
    pub(super) faces: [u64; LANES],
    pub(super) point: [S::F64; 3],
    /// The rays that arrived there: their origins and directions, and the `t` of the hits.
    pub(super) rays: ([[S::F64; 3]; 2], S::F64),
    /// The unit vector to the viewer, if it is asked for.
    pub(super) v: [S::F64; 3],
    /// The unit normal, and that on the side of the viewer.
    normal: [S::F64; 3],
    pub(super) n: [S::F64; 3],
    pub(super) surfaces: Surfaces<S>,
}

impl<'a> SampleRow<'a> {
    /// Returns the indices of the geometries hit from `start` on. Lanes behind the end repeat the last sample.
    #[inline(always)]
    fn indices(&self, world: &World, start: usize) -> [u32; LANES] {
        let ids = lanes(self.ids, start);
        match world.has_copies() {
            true => ids.map(|id| world.index_of(id as usize) as u32),
            false => ids,
        }
    }

    /// Returns the rays from `start` on: their origins and directions, and the `t` of the hits.
    #[inline(always)]
    fn rays<S: Simd>(&self, simd: S, start: usize) -> ([[S::F64; 3]; 2], S::F64) {
        let sum = add(load_row(simd, self.columns, start), splat3(simd, self.row));
        let rays = match self.camera {
            Camera::Perspective(camera) => [splat3(simd, camera.basis.eye), unit(sum)],
            Camera::Orthographic(camera) => [sum, splat3(simd, -camera.basis.w)],
        };
        (rays, load(simd, self.t, start))
    }
}

impl HitRow<'_> {
    pub(super) const fn len(&self) -> usize {
        match self {
            Self::Samples(row) => row.ids.len(),
            Self::Onward(row) => row.indices.len(),
        }
    }

    /// Returns the indices of the geometries hit from `start` on. Lanes behind the end repeat the last ray.
    #[inline(always)]
    pub(super) fn indices(&self, world: &World, start: usize) -> [u32; LANES] {
        match self {
            Self::Samples(row) => row.indices(world, start),
            Self::Onward(row) => lanes(row.indices, start),
        }
    }

    /// Returns the hits of these geometries from `start` on, with `v` if a light needs it or a surface.
    #[inline(always)]
    pub(super) fn hits<S: Simd>(
        &self,
        simd: S,
        world: &World,
        (indices, mut surfaces): ([u32; LANES], Surfaces<S>),
        (start, needs_v): (usize, bool),
    ) -> Hits<S> {
        let (rays, t) = match self {
            Self::Samples(row) => row.rays(simd, start),
            Self::Onward(row) => {
                let origins = load_row(simd, row.origins, start);
                let directions = load_row(simd, row.directions, start);
                ([origins, directions], load(simd, row.t, start))
            }
        };
        let [o, d] = rays;
        let faces = match (surfaces.others, self) {
            (0, _) => [0; LANES],
            (_, Self::Samples(_)) => surfaces.find_others(simd, world, &indices, (o, d, t), None),
            (_, Self::Onward(row)) => {
                let faces = lanes(row.faces, start);
                surfaces.find_others(simd, world, &indices, (o, d, t), Some(faces))
            }
        };
        let along = [t * d[0], t * d[1], t * d[2]];
        let normal = normal(simd, o, along, d, &surfaces);
        let is_front = dot(d, normal).le(simd.splat(0.0));
        Hits {
            indices,
            faces,
            point: add(o, along),
            rays: (rays, t),
            v: match needs_v || surfaces.kinds.glossy != 0 {
                true => negate(unit(d)),
                false => d,
            },
            normal,
            n: select(is_front, normal, negate(normal)),
            surfaces,
        }
    }
}

impl<S: Simd> Hits<S> {
    /// Returns `max(0, r·v)^exponent` in some lanes, given the unit vector to a light and its product with
    /// the normal; 0 in all others.
    #[inline(always)]
    pub(super) fn highlight(&self, simd: S, lanes: u8, l: [S::F64; 3], cosine: S::F64) -> S::F64 {
        let twice = simd.splat(2.0) * cosine;
        let [x, y, z] = self.n;
        let r = sub([twice * x, twice * y, twice * z], l);
        let (zero, mut cosines) = (simd.splat(0.0), [0.0; LANES]);
        let cosine = dot(r, self.v).max(zero);
        S::F64::select(simd.mask(lanes), cosine, zero).store(&mut cosines);
        let (_, exponents) = &self.surfaces.highlight;
        simd.load(&pow(&cosines, exponents))
    }
}

/// Returns rays and the `t` of their hits in memory.
#[inline(always)]
pub(super) fn stored<V: F64x8>(
    (rays, t): &([[V; 3]; 2], V),
) -> ([[[f64; LANES]; 3]; 2], [f64; LANES]) {
    let (mut stored, mut of_t) = ([[[0.0; LANES]; 3]; 2], [0.0; LANES]);
    for (to, from) in stored
        .as_flattened_mut()
        .iter_mut()
        .zip(rays.as_flattened())
    {
        from.store(to);
    }
    t.store(&mut of_t);
    (stored, of_t)
}

pub(super) fn ray_of([origins, directions]: &[[[f64; LANES]; 3]; 2], lane: usize) -> Ray {
    let [origin, direction] =
        [origins, directions].map(|vectors| DVec3::from(vectors.map(|axis| axis[lane])));
    Ray::new(origin, direction)
}

/// Returns eight numbers; those behind the end are the last.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, from: &[f64], start: usize) -> S::F64 {
    match from[start..].first_chunk() {
        Some(lanes) => simd.load(lanes),
        None => simd.load(&last_lanes(from, start)),
    }
}

/// Returns eight vectors; those behind the end are the last.
#[inline(always)]
pub(super) fn load_row<S: Simd>(simd: S, [x, y, z]: [&[f64]; 3], start: usize) -> [S::F64; 3] {
    [
        load(simd, x, start),
        load(simd, y, start),
        load(simd, z, start),
    ]
}

/// Stores eight numbers; those behind the end are left out.
#[inline(always)]
pub(super) fn store<V: F64x8>(lanes: V, to: &mut [f64]) {
    match to.first_chunk_mut() {
        Some(to) => lanes.store(to),
        None => {
            let mut all = [0.0; LANES];
            lanes.store(&mut all);
            store_some(&all, to);
        }
    }
}

/// Stores fewer than eight numbers. The program is smaller if this is not inlined.
#[cold]
#[inline(never)]
pub(super) fn store_some(lanes: &[f64; LANES], to: &mut [f64]) {
    to.copy_from_slice(&lanes[..to.len()]);
}

/// Returns eight values; those behind the end are the last.
#[inline(always)]
pub(super) fn lanes<T: Copy>(from: &[T], start: usize) -> [T; LANES] {
    match from[start..].first_chunk() {
        Some(lanes) => *lanes,
        None => last_lanes(from, start),
    }
}

/// Returns the last values, and the last one for all that are behind it. The program is smaller if this is
/// not inlined.
#[cold]
#[inline(never)]
pub(super) fn last_lanes<T: Copy>(from: &[T], start: usize) -> [T; LANES] {
    std::array::from_fn(|lane| from[(start + lane).min(from.len() - 1)])
}

/// Returns the stored normals: those of spheres as
/// [`Sphere::normal_at`](crate::Sphere::normal_at) does.
#[inline(always)]
pub(super) fn normal<S: Simd>(
    simd: S,
    o: [S::F64; 3],
    along: [S::F64; 3],
    d: [S::F64; 3],
    surfaces: &Surfaces<S>,
) -> [S::F64; 3] {
    if surfaces.is_sphere.bits() == 0 {
        return surfaces.vector;
    }
    let outward = add(sub(o, surfaces.vector), along);
    let has_direction = is_direction(simd, dot(outward, outward));
    let outward = select(has_direction, outward, negate(d));
    select(surfaces.is_sphere, unit(outward), surfaces.vector)
}

/// Returns true for squared lengths of vectors that have a direction.
#[inline(always)]
pub(super) fn is_direction<S: Simd>(simd: S, squared: S::F64) -> S::Mask {
    simd.splat(0.0).lt(squared) & squared.lt(simd.splat(f64::INFINITY))
}

#[inline(always)]
pub(super) fn add<V: F64x8>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn negate<V: F64x8>(v: [V; 3]) -> [V; 3] {
    [-v[0], -v[1], -v[2]]
}

#[inline(always)]
pub(super) fn select<V: F64x8>(mask: V::Mask, yes: [V; 3], no: [V; 3]) -> [V; 3] {
    [
        V::select(mask, yes[0], no[0]),
        V::select(mask, yes[1], no[1]),
        V::select(mask, yes[2], no[2]),
    ]
}

/// The places of eight hits: 0 for none, and an infinite distance.
#[derive(Clone, Default)]
pub(crate) struct Places {
    pub(crate) point: [[f64; LANES]; 3],
    pub(crate) normal: [[f64; LANES]; 3],
    /// The distances along the view axis.
    pub(crate) z: [f64; LANES],
}

/// Finds the places of the hits of a row.
pub(crate) struct LocateRow<'a> {
    pub(crate) world: &'a World,
    pub(crate) row: SampleRow<'a>,
    pub(crate) known: &'a mut Cache,
    /// The places of eight neighbors each; those behind the end of the row become any.
    pub(crate) places: &'a mut [Places],
}

impl Kernel for LocateRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (zero, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
        let eye = splat3(simd, self.row.camera.eye());
        let forward = splat3(simd, -self.row.camera.w());
        for (start, places) in (0..).step_by(LANES).zip(self.places) {
            let indices = self.row.indices(self.world, start);
            let surfaces = Surfaces::new(simd, self.world, self.known, &indices);
            let row = HitRow::Samples(self.row);
            let hits = row.hits(simd, self.world, (indices, surfaces), (start, false));
            let missed = infinity.le(hits.rays.1);
            let point = select(missed, [zero; 3], hits.point);
            let numbers = [point, select(missed, [zero; 3], hits.normal)];
            let to = [&mut places.point, &mut places.normal];
            for (to, numbers) in to.into_iter().zip(numbers) {
                for (to, number) in to.iter_mut().zip(numbers) {
                    number.store(to);
                }
            }
            let z = dot(sub(hits.point, eye), forward);
            S::F64::select(missed, infinity, z).store(&mut places.z);
        }
    }
}
