//! The shadows of points that a camera sees, in one light, eight at a time.
//!
//! [`frame`] projects points and shapes as the light sees them and divides that picture into tiles.
//! [`lists`] finds the shapes that may shadow the points of a tile. [`meet`] tests these shapes, by
//! the equations of the format. [`casters`] are what shadows, and the light that they shadow from;
//! [`occluders`] are those among some geometries of a world.

pub(crate) mod casters;
mod frame;
mod lists;
mod meet;
pub(crate) mod occluders;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::DVec3;

use crate::{
    accel::{
        bvh::build::Builder,
        kept::{WorldOfFrame, built},
        lanes::abs,
        near_faces::NearFaces,
        shadow::{
            casters::{Casters, Toward},
            frame::both,
            meet::MANY,
            occluders::Occluders,
        },
    },
    film::colors::NOTHING,
    simd::{F64x8, LANES, Simd},
    tracer::{
        ray::Ray,
        shape::{Extent, Shape, contact::REACH, plane::Plane},
        world::World,
    },
};

/// Eight points of surfaces.
pub(crate) struct Points<'a, S: Simd> {
    /// Their coordinates.
    pub(crate) at: [S::F64; 3],
    /// The geometries that they lie on.
    pub(crate) own: &'a [u32; LANES],
    /// The faces that they lie on.
    pub(crate) faces: &'a [u64; LANES],
    /// The centers of the spheres that they lie on.
    pub(crate) center: [S::F64; 3],
    /// The points that lie on spheres.
    pub(crate) is_sphere: S::Mask,
    /// The rays that arrived there: their origins and directions, and the `t` of the points.
    pub(crate) rays: ([[S::F64; 3]; 2], S::F64),
    /// The points whose shadows are asked for; all others may be anything. Each lies on no other face of its
    /// geometry.
    pub(crate) asked: u8,
    /// The largest coordinate of those and of the origins of their rays.
    pub(crate) most: f64,
}

/// The part of the coordinates of a point by which it may lie beside a face that it lies on, or more.
const BESIDE: f64 = 1.0 / (1 << 28) as f64;

/// The part of the numbers of an equation by which it may be wrong at a point on the face, or more.
pub(in crate::accel) const WRONG: f64 = 1.0 / (1_u64 << 44) as f64;

impl<'a, S: Simd> Points<'a, S> {
    /// Returns the largest coordinate of vectors in the lanes that are asked for.
    #[inline(always)]
    pub(crate) fn most_of(simd: S, asked: u8, vectors: [[S::F64; 3]; 2]) -> f64 {
        let zero = simd.splat(0.0);
        let all = vectors.as_flattened().iter();
        let most = all.fold(zero, |most, x| most.max(abs(*x)));
        S::F64::select(simd.mask(asked), most, zero).largest()
    }

    /// Returns by how much the equation of a ball of some radius may be off 0 at a point on it, or more.
    #[inline(always)]
    fn slack_of_ball(&self, radius: f64) -> f64 {
        let most = self.most + radius;
        2.0 * BESIDE * self.most * radius + 0.25 * WRONG * (most * most)
    }

    /// The same for a plane.
    #[inline(always)]
    fn slack_of_plane(&self, plane: &Plane) -> f64 {
        let far = plane.point().abs().max_element();
        (BESIDE * self.most + WRONG * far) * plane.normal().abs().element_sum()
    }

    /// Returns the points that may lie on a shape which is not the one that was hit, given the points in
    /// memory.
    #[inline(always)]
    fn near(&self, simd: S, (at, lanes): (&[[f64; LANES]; 3], u8), shape: &Shape) -> u8 {
        lanes
            & simd.call(NearFaces {
                shape,
                at,
                lanes,
                reach: REACH * self.most,
                except: None,
            })
    }

    /// Returns the points on a geometry.
    #[inline(always)]
    fn on(&self, index: u32) -> u8 {
        (0..LANES).fold(0, |own, lane| {
            own | u8::from(self.own[lane] == index) << lane
        })
    }

    /// Returns the ray that arrived at a point, and its `t`.
    fn ray(&self, lane: usize) -> (Ray, f64) {
        let at = |numbers: S::F64| {
            let mut lanes = [0.0; LANES];
            numbers.store(&mut lanes);
            lanes[lane]
        };
        let (vectors, t) = self.rays;
        let [origin, direction] = vectors.map(|vector| DVec3::from(vector.map(at)));
        (Ray::new(origin, direction), at(t))
    }
}

/// The shadows on eight points, lane i as bit i.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FoundShadows {
    /// The points in shadow.
    pub(crate) dark: u8,
    /// The points of which nothing is known; all others are not in shadow.
    pub(crate) open: u8,
}

/// The end of shadow rays, and everything of a kind that may cast a shadow there.
#[derive(Debug)]
struct Casting<'a> {
    world: &'a World,
    casters: Casters,
    toward: Toward,
    /// The planes, and their indices.
    planes: Vec<(u32, &'a Plane)>,
    occluders: Vec<Arc<Occluders>>,
}

impl<'a> Casting<'a> {
    /// Prepares a light with this number; `None` if nothing casts shadows. Others do in a box with some corners.
    fn new(
        world: WorldOfFrame<'a>,
        casters: Casters,
        (number, toward): (usize, Toward),
        others: [DVec3; 2],
        builder: Builder<'_>,
    ) -> Option<Self> {
        let key = ((number, casters), toward);
        let occluders = built(
            world,
            |kept| &kept.occluders,
            key,
            builder.cancel,
            |runs, still| {
                let around = still.map(|still| still.corners);
                let light = (casters, toward);
                Some(Occluders::new(
                    (world.0, runs),
                    light,
                    (around, others),
                    builder,
                ))
            },
        )?;
        let occluders = occluders.into_iter().filter(|some| !some.is_empty);
        let occluders: Vec<Arc<_>> = occluders.collect();
        let geometries = world.0.geometries();
        let plane = |index: u32| match geometries.get(index as usize)?.shape().extent() {
            Extent::Plane(plane) => Some((index, plane)),
            Extent::Ball(..) => None,
        };
        let planes = occluders
            .iter()
            .flat_map(|some| some.planes.iter().copied());
        let planes = planes.filter_map(plane).collect();
        (!occluders.is_empty()).then_some(Self {
            world: world.0,
            casters,
            toward,
            planes,
            occluders,
        })
    }

    /// Returns true if nothing may be known of some points that are no farther than `distance` from
    /// `eye`.
    fn leaves_open(&self, eye: DVec3, distance: f64) -> bool {
        self.occluders.iter().any(|some| {
            let lists = some.lists.as_ref();
            lists.is_none_or(|lists| lists.longest() > MANY || !lists.frame.reaches(eye, distance))
        })
    }
}

/// The shadows of a light.
#[derive(Debug)]
pub(crate) struct Shadows<'a> {
    opaque: Option<Casting<'a>>,
    glass: Option<Casting<'a>>,
}

/// What was found last, which is likely to be found again.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Last([u32; 2]);

impl Default for Last {
    fn default() -> Self {
        Self([NOTHING; 2])
    }
}

/// The shadows of a light on eight points, lane i as bit i.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shadowed {
    /// The points that opaque geometries shadow.
    pub(crate) dark: u8,
    /// The points that glass shadows, and nothing opaque.
    pub(crate) glass: u8,
    /// The points of which nothing is known.
    pub(crate) open: u8,
}

impl<'a> Shadows<'a> {
    /// Prepares a light with this number.
    pub(crate) fn new(
        world: WorldOfFrame<'a>,
        light: (usize, Toward),
        builder: Builder<'_>,
    ) -> Self {
        let opaque = Casting::new(world, Casters::Opaque, light, Occluders::NOWHERE, builder);
        let others = opaque.iter().flat_map(|opaque| &opaque.occluders);
        let others = others.map(|some| some.corners);
        let others = others.fold(Occluders::NOWHERE, both);
        Self {
            glass: Casting::new(world, Casters::Glass, light, others, builder),
            opaque,
        }
    }

    /// Returns true if nothing may be known of some points that are no farther than `distance` from
    /// `eye`.
    pub(crate) fn leaves_open(&self, eye: DVec3, distance: f64) -> bool {
        let mut both = self.opaque.iter().chain(&self.glass);
        both.any(|casting| casting.leaves_open(eye, distance))
    }

    /// Returns the shadows on points.
    #[inline(always)]
    pub(crate) fn on<S: Simd>(&self, simd: S, mut points: Points<S>, last: &mut Last) -> Shadowed {
        let mut shadowed = Shadowed::default();
        // A loop, because the test is inlined wherever it stands.
        for (number, last) in last.0.iter_mut().enumerate() {
            let is_glass = number == 1;
            let casting = if is_glass { &self.glass } else { &self.opaque };
            let Some(casting) = casting.as_ref().filter(|_| points.asked != 0) else {
                continue;
            };
            let found = casting.meet(simd, &points, last);
            match is_glass {
                true => shadowed.glass = found.dark & !shadowed.open,
                false => shadowed.dark = found.dark,
            }
            shadowed.open |= found.open;
            points.asked &= !found.dark;
        }
        shadowed
    }
}
