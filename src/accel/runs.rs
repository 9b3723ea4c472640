//! Runs of indices of geometries.

use std::ops::Range;

use crate::tracer::{geometry::Geometry, world::World};

/// Splits runs into pieces of at most this length.
pub(super) fn pieces(runs: &[Range<usize>], length: usize) -> impl Iterator<Item = Range<usize>> {
    runs.iter().flat_map(move |run| {
        let starts = run.clone().step_by(length);
        starts.map(move |start| start..run.end.min(start + length))
    })
}

/// Returns the geometries in runs with their indices.
pub(crate) fn geometries<'a>(
    world: &'a World,
    runs: &'a [Range<usize>],
) -> impl Iterator<Item = (usize, &'a Geometry)> {
    runs.iter()
        .cloned()
        .flat_map(|run| run.clone().zip(&world.geometries()[run]))
}

/// Returns the number of geometries in runs.
pub(super) fn count(runs: &[Range<usize>]) -> usize {
    runs.iter().map(Range::len).sum()
}
