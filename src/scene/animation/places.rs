//! The frames in which what moves may be farthest out.
//!
//! Between two keys a number only rises or only falls, and straight lines add up to straight lines.
//! The points of a shape that such tracks move or scale are on straight lines as well, so in every
//! direction it is farthest out at an end: next to a key. Frames between two keys matter where a
//! shape turns, or where several curves meet.

use std::{collections::BTreeMap, iter, ops::Range};

use super::{
    frames::Frames,
    target::{Aspect, Target},
};
use crate::scene::format::{
    animation::{Interpolation, Track},
    field::FieldKind,
    geometry::GeometryModel,
    numbers::ScaleModel,
    scene::Model,
};

/// The number of places of geometries, each in a frame, that are looked at.
const MOST_PLACES: usize = 1 << 18;
/// The number of frames that are looked at, however many geometries move.
const LEAST_FRAMES: usize = 1 << 10;
/// The number of frames of an orbit that are looked at.
const MOST_TURNS: usize = 1 << 14;

impl Frames {
    /// Returns the frames to look at for the extremes of `count` geometries that move, in ascending
    /// order. If there are too many, evenly spaced ones.
    pub(crate) fn places(&self, model: &Model, count: usize) -> Vec<u32> {
        let most = (MOST_PLACES / count.max(1)).max(LEAST_FRAMES);
        match self.orbit_cameras() {
            true => evenly(iter::once(0..self.count()), most.min(MOST_TURNS)),
            false => {
                let mut ranges = self.ranges(model);
                ranges.sort_unstable_by_key(|range| range.start);
                let mut from = 0;
                let ranges = ranges.into_iter().map(|range| {
                    let start = range.start.max(from);
                    from = from.max(range.end);
                    start..range.end
                });
                evenly(ranges.collect::<Vec<_>>(), most)
            }
        }
    }

    /// Returns all frames or, if there are too many, evenly spaced ones.
    pub(crate) fn sample(&self, model: &Model) -> Vec<u32> {
        let count = self.targets().count().max(model.all_cameras().count());
        let most = (MOST_PLACES / count.max(1)).max(LEAST_FRAMES);
        evenly(iter::once(0..self.count()), most)
    }

    /// Returns ranges of those frames, in any order.
    fn ranges(&self, model: &Model) -> Vec<Range<u32>> {
        let last = self.count() - 1;
        let near = |time: f64| {
            // Beyond all frames, the last counts.
            let number = ((time * self.fps()) as u32).min(last);
            // Rounding may move a frame across the time of a key.
            number.saturating_sub(2)..number.saturating_add(3).min(last + 1)
        };
        let mut ranges = vec![0..1, last..last + 1];
        let mut movers: BTreeMap<usize, Vec<(&Target, &Track)>> = BTreeMap::new();
        for (target, track) in self.tracks() {
            if let Some(at) = target.moved_geometry() {
                movers.entry(at.index).or_default().push((target, track));
            }
        }
        for tracks in movers.values() {
            let is_straight = self.copies_nothing() && go_straight(model, tracks);
            for (_, track) in tracks {
                let times = track.times();
                ranges.extend(times.iter().map(|(time, _)| near(*time)));
                for pair in times.windows(2).filter(|_| !is_straight) {
                    if let [(from, _), (to, step)] = pair
                        && *step != Interpolation::Step
                    {
                        ranges.push(near(*from).start..near(*to).end);
                    }
                }
            }
        }
        ranges
    }
}

/// Returns true if each point of what these tracks move goes straight from key to key: if they are
/// of one thing, and go along straight lines or are a single number.
fn go_straight(model: &Model, tracks: &[(&Target, &Track)]) -> bool {
    let bends = |track: &Track| match track {
        Track::Numbers(_) | Track::Scales(_) | Track::Points(_) => {
            let mut times = track.times().into_iter();
            times.any(|(_, step)| step == Interpolation::Smooth)
        }
        _ => true,
    };
    let is_number = |track: &Track| match track {
        Track::Numbers(_) => true,
        Track::Scales(keys) => {
            let mut keys = keys.iter();
            keys.all(|key| matches!(key.value, ScaleModel::Uniform(_)))
        }
        _ => false,
    };
    let mut all = tracks.iter();
    let moves_straight = |target: &Target| match (target.aspect, target.geometry) {
        (Aspect::Geometry, Some(at)) => model.geometry(at).is_some_and(|geometry| {
            matches!(geometry, GeometryModel::Sphere(_)) || geometry.table().is_some()
        }),
        (Aspect::Transform, _) => matches!(target.kind, FieldKind::Point | FieldKind::Scale),
        _ => false,
    };
    let Some((first, track)) = tracks.first() else {
        return true;
    };
    let is_single = tracks.len() == 1 && is_number(track);
    all.all(|(target, track)| {
        target.owner == first.owner && moves_straight(target) && (is_single || !bends(track))
    })
}

/// Returns the numbers of ascending ranges, or `most` that are evenly spaced.
fn evenly(ranges: impl IntoIterator<Item = Range<u32>> + Clone, most: usize) -> Vec<u32> {
    let count: usize = ranges.clone().into_iter().map(|range| range.len()).sum();
    let step = count.div_ceil(most.max(1)).max(1);
    let last = ranges.clone().into_iter().flatten().last();
    let mut all: Vec<_> = ranges.into_iter().flatten().step_by(step).collect();
    if all.last() != last.as_ref() {
        all.extend(last);
    }
    all
}
