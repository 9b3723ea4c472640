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
        shadow::{
            casters::{Casters, Toward},
            meet::MANY,
            occluders::Occluders,
        },
    },
    film::colors::NOTHING,
    simd::{LANES, Simd},
    tracer::{
        geometry::Geometry,
        shape::{Extent, plane::Plane},
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
    /// The points whose shadows are asked for; all others may be anything.
    pub(crate) asked: u8,
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
    geometries: &'a [Geometry],
    casters: Casters,
    toward: Toward,
    /// The planes, and their indices.
    planes: Vec<(u32, &'a Plane)>,
    occluders: Vec<Arc<Occluders>>,
}

impl<'a> Casting<'a> {
    /// Prepares a light with this number; `None` if nothing casts shadows.
    fn new(
        world: WorldOfFrame<'a>,
        casters: Casters,
        (number, toward): (usize, Toward),
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
                Some(Occluders::new((world.0, runs), light, around, builder))
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
            geometries,
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
        let casting = |casters| Casting::new(world, casters, light, builder);
        Self {
            opaque: casting(Casters::Opaque),
            glass: casting(Casters::Glass),
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
        if let Some(opaque) = &self.opaque {
            let found = opaque.meet(simd, &points, &mut last.0[0]);
            shadowed.dark = found.dark;
            shadowed.open = found.open;
        }
        points.asked &= !shadowed.dark;
        if let Some(glass) = &self.glass
            && points.asked != 0
        {
            let found = glass.meet(simd, &points, &mut last.0[1]);
            shadowed.glass = found.dark & !shadowed.open;
            shadowed.open |= found.open;
        }
        shadowed
    }
}
