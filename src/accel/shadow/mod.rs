//! The shadows of many points at once: those that the camera sees, in one light.
//!
//! [`frame`] projects points and shapes as the light sees them and divides that picture into tiles.
//! [`place`] finds the tiles of points, [`bins`] sorts the points by tile and finds the shapes that may shadow one of a tile's points.
//! [`meet`] tests these shapes, by the equations of the format.

mod bins;
mod frame;
mod meet;
mod place;
#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::{
    accel::shadow::{
        bins::Bins,
        frame::{Frame, Survey},
        meet::Meet,
    },
    parallel::Pool,
    simd::Isa,
    tracer::{
        geometry::Geometry,
        light::{Light, falloff::END},
        ray::Ray,
        shape::plane::Plane,
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
        let toward = match light {
            Light::Ambient(_) | Light::Headlight(_) => return None,
            Light::Directional(light) => Self::Direction(-light.direction()),
            Light::Point(light) => Self::Point(light.position()),
            Light::Spot(light) => Self::Point(light.position()),
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

/// Points of surfaces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Points<'a> {
    /// Their coordinates, by axis.
    pub(crate) at: [&'a [f64]; 3],
    /// The geometry that each lies on; [`NOTHING`](crate::film::colors::NOTHING) for a point that is
    /// not asked for.
    pub(crate) own: &'a [u32],
}

/// The shadows on some points, which are named by their places.
#[derive(Debug, Default)]
pub(crate) struct Shadowed {
    /// The points in shadow.
    pub(crate) dark: Vec<u32>,
    /// The points of which nothing is known, unless they are in shadow; all others are not.
    pub(crate) open: Vec<u32>,
}

/// The geometries that cast shadows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Casters {
    /// All but those of glass.
    Opaque,
    /// Those of glass.
    Glass,
}

impl Casters {
    /// Returns true for a geometry that casts shadows.
    #[inline(always)]
    pub(super) fn hold(self, geometry: &Geometry) -> bool {
        geometry.material().glass().is_some() == (self == Self::Glass)
    }
}

/// A light and everything that may cast a shadow in it.
#[derive(Debug)]
pub(crate) struct Casting<'a> {
    world: &'a World,
    casters: Casters,
    toward: Toward,
    /// The planes, and their indices.
    planes: Vec<(u32, &'a Plane)>,
    /// Other shapes, with numbers that are too extreme for bounds.
    odd: Vec<u32>,
    /// `None` if there are no bounds at all.
    frame: Option<Frame>,
}

/// The largest number of shapes without bounds, which are tested against every point.
const ODD: usize = 8;

impl<'a> Casting<'a> {
    /// Prepares a light; `None` if nothing casts shadows.
    pub(crate) fn new(
        world: &'a World,
        casters: Casters,
        toward: Toward,
        pool: &Pool,
    ) -> Option<Self> {
        let survey = Survey::new(world, casters, pool);
        if survey.is_empty() {
            return None;
        }
        let frame = (survey.odd.len() <= ODD).then(|| Frame::new(toward, &survey));
        Some(Self {
            world,
            casters,
            toward,
            planes: survey.planes,
            odd: survey.odd,
            frame: frame.flatten(),
        })
    }

    /// Returns the points in shadow. A point is dark exactly if its shadow ray, as
    /// [`World::transmission`] defines it, crosses one of the casters.
    pub(crate) fn cast(&self, points: Points, pool: &Pool, isa: Isa) -> Vec<Shadowed> {
        let bins = self.frame.as_ref().and_then(|frame| {
            // Fewer tiles, until their shapes fit into memory.
            let mut coarser = (0..8).map(|step| frame.coarser(step));
            coarser.find_map(|frame| Bins::new(self, frame, points, pool, isa))
        });
        let Some(bins) = bins else {
            let asked = (0..).zip(points.own);
            let asked = asked.filter(|(_, own)| (**own as usize) < self.world.geometries().len());
            return vec![Shadowed {
                dark: Vec::new(),
                open: asked.map(|(place, _)| place).collect(),
            }];
        };
        let mut found = pool.map(bins.tasks(pool.threads()), |task| {
            isa.run(Meet {
                casting: self,
                points,
                bins: &bins,
                task,
            })
        });
        found.push(Shadowed {
            dark: Vec::new(),
            open: bins.open,
        });
        found
    }
}
