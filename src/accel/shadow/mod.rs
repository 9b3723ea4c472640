//! The shadows of points that a camera sees, in one light, eight at a time.
//!
//! [`frame`] projects points and shapes as the light sees them and divides that picture into tiles.
//! [`lists`] finds the shapes that may shadow the points of a tile. [`meet`] tests these shapes, by
//! the equations of the format.

mod frame;
mod lists;
mod meet;
#[cfg(test)]
mod tests;

use std::{ops::Range, sync::Arc};

use glam::DVec3;

use crate::{
    accel::{
        bvh::build::Builder,
        kept::{WorldOfFrame, built},
        shadow::{
            frame::{Frame, Survey},
            lists::Lists,
            meet::MANY,
        },
    },
    film::colors::NOTHING,
    simd::{LANES, Simd},
    tracer::{
        geometry::Geometry,
        light::{Light, Source, falloff::END},
        ray::Ray,
        shape::{Extent, plane::Plane},
        world::World,
    },
};

/// The end of all shadow rays of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Toward {
    /// They end at this point.
    Point(DVec3),
    /// All have this direction and no end.
    Direction(DVec3),
}

impl Toward {
    /// Returns the end of a light's shadow rays; `None` if it casts no shadows.
    pub(crate) fn of(light: &Light) -> Option<Self> {
        let toward = match light.source() {
            Source::Everywhere | Source::Viewer => return None,
            Source::Direction(to_light) => Self::Direction(to_light),
            Source::Point { position, .. } => Self::Point(position),
        };
        light.shadows().then_some(toward)
    }

    /// Returns the shadow ray of a point.
    pub(crate) fn ray(self, point: DVec3) -> Ray {
        match self {
            Self::Point(light) => Ray::new(point, light - point),
            Self::Direction(direction) => Ray::new(point, direction),
        }
    }

    /// Returns the end of the rays as a `t`.
    pub(crate) const fn t_max(self) -> f64 {
        match self {
            Self::Point(_) => END,
            Self::Direction(_) => f64::INFINITY,
        }
    }
}

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

/// The geometries that cast shadows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Casters {
    /// Those without any glass.
    Opaque,
    /// Those that are glass, or partly so.
    Glass,
}

impl Casters {
    /// Returns true for a geometry that casts shadows.
    #[inline(always)]
    pub(super) fn hold(self, geometry: &Geometry) -> bool {
        geometry.has_glass() == (self == Self::Glass)
    }
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

/// Some geometries that may cast a shadow at the end of rays.
#[derive(Debug)]
pub(crate) struct Occluders {
    is_empty: bool,
    planes: Vec<u32>,
    /// Other shapes, with numbers that are too extreme for bounds.
    odd: Vec<u32>,
    /// The corners of the box around all others.
    corners: [DVec3; 2],
    /// `None` if there are no bounds at all.
    lists: Option<Lists>,
}

/// The largest number of shapes without bounds, which are tested against every point.
const ODD: usize = 8;
/// The number of times that tiles are enlarged until their shapes fit into memory.
const STEPS: i32 = 12;

impl Occluders {
    /// Finds those among some geometries that cast shadows, on points around them and in a box.
    fn new(
        (world, runs): (&World, &[Range<usize>]),
        (casters, toward): (Casters, Toward),
        around: Option<[DVec3; 2]>,
        builder: Builder<'_>,
    ) -> Self {
        let mut survey = Survey::new(world, runs, casters, builder.pool);
        let is_empty = survey.is_empty();
        around.into_iter().for_each(|around| survey.reach(around));
        let frame = (!is_empty && survey.odd.len() <= ODD).then(|| Frame::new(toward, &survey));
        let lists = frame.flatten().and_then(|frame| {
            let mut coarser = (0..STEPS).map(|step| frame.coarser(step));
            coarser.find_map(|frame| {
                Lists::new(world, runs, casters, frame, builder.pool, builder.isa)
            })
        });
        Self {
            is_empty,
            planes: survey.planes,
            odd: survey.odd,
            corners: survey.corners,
            lists,
        }
    }
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
