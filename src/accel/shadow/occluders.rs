//! Some geometries that may cast a shadow at the end of rays.

use std::ops::Range;

use glam::DVec3;

use crate::{
    accel::{
        bvh::build::Builder,
        shadow::{
            casters::{Casters, Toward},
            frame::{Frame, Survey, both},
            lists::Lists,
        },
    },
    tracer::world::World,
};

/// Some geometries that may cast a shadow at the end of rays.
#[derive(Debug)]
pub(crate) struct Occluders {
    pub(super) is_empty: bool,
    pub(super) planes: Vec<u32>,
    /// Other shapes, with numbers that are too extreme for bounds.
    pub(super) odd: Vec<u32>,
    /// The corners of the box around all others.
    pub(super) corners: [DVec3; 2],
    /// `None` if there are no bounds at all.
    pub(super) lists: Option<Lists>,
}

/// The largest number of shapes without bounds, which are tested against every point.
const ODD: usize = 8;

/// The number of times that tiles are enlarged until their shapes fit into memory.
const STEPS: i32 = 12;

impl Occluders {
    /// The corners of the box around nothing.
    pub(super) const NOWHERE: [DVec3; 2] = [DVec3::INFINITY, DVec3::NEG_INFINITY];

    /// Finds those among some geometries that cast shadows, on points around them and in a box, and far around
    /// another box.
    pub(super) fn new(
        (world, runs): (&World, &[Range<usize>]),
        (casters, toward): (Casters, Toward),
        (around, others): (Option<[DVec3; 2]>, [DVec3; 2]),
        builder: Builder<'_>,
    ) -> Self {
        let mut survey = Survey::new(world, runs, casters, builder.pool);
        let is_empty = survey.is_empty();
        around.into_iter().for_each(|around| survey.reach(around));
        let whole = both(survey.corners, others);
        let frame =
            (!is_empty && survey.odd.len() <= ODD).then(|| Frame::new(toward, &survey, whole));
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
