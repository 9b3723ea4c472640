//! The pixels around which no line is: all samples near them hit one geometry, and are even.

use glam::DVec3;

use crate::{film::Outlines, render::hits::Hits};

/// What all samples of some pixels have in common.
#[derive(Clone, Copy)]
pub(super) struct Common {
    /// The geometry that all of them hit.
    id: u32,
    /// The smallest and the largest t of the hits.
    t: [f64; 2],
    /// The lower and upper corners of a box around their normals.
    normals: [DVec3; 2],
}

impl Common {
    fn with(self, other: Self) -> Option<Self> {
        let ([low, high], [lower, higher]) = (self.t, other.t);
        let ([from, to], [start, end]) = (self.normals, other.normals);
        (self.id == other.id).then(|| Self {
            id: self.id,
            t: [low.min(lower), high.max(higher)],
            normals: [from.min(start), to.max(end)],
        })
    }

    /// Returns true if no two of the samples make a line between them.
    fn is_even(&self, outlines: &Outlines, crease: f64) -> bool {
        let ([near, far], [low, high]) = (self.t, self.normals);
        let is_near = outlines.depth.is_none_or(|depth| far <= near + depth);
        // Of unit vectors, a·b = 1 - |a - b|² / 2. The rest is for rounding.
        let least = 1.0 - (high - low).length_squared() / 2.0 - 1e-9;
        is_near && (outlines.creases.is_none() || least >= crease)
    }
}

/// Returns for each pixel of a rectangle if no line is near it. `crease` is the cosine of the angle of a
/// crease.
pub(super) fn amid(
    hits: &Hits,
    normals: &[DVec3],
    side: u32,
    outlines: &Outlines,
    crease: f64,
) -> Vec<bool> {
    let side = side as usize;
    let width = hits.columns.len();
    let of_sample = |place: usize| {
        let normal = normals.get(place).copied().unwrap_or_default();
        Common {
            id: hits.ids[place],
            t: [hits.t[place]; 2],
            normals: [normal; 2],
        }
    };
    let of_pixel = |row: usize, column: usize| {
        let rows = row..row + side;
        let places = rows.flat_map(|row| (column..column + side).map(move |x| row * width + x));
        all(places.map(|place| Some(of_sample(place))))
    };
    let (across, down) = (width / side, hits.rows.len() / side);
    let pixels = (0..down).flat_map(|row| (0..across).map(move |column| [row, column]));
    let own: Vec<_> = pixels
        .clone()
        .map(|[row, column]| of_pixel(row * side, column * side))
        .collect();
    let margin = outlines.margin() as usize;
    let around = |at: usize, most: usize| at.saturating_sub(margin)..(at + margin + 1).min(most);
    let in_rows: Vec<_> = pixels
        .clone()
        .map(|[row, column]| all(own[row * across..][around(column, across)].iter().copied()))
        .collect();
    let in_squares = pixels
        .map(|[row, column]| all(around(row, down).map(|row| in_rows[row * across + column])));
    let is_even = |common: Option<Common>| common.is_some_and(|all| all.is_even(outlines, crease));
    in_squares.map(is_even).collect()
}

/// Returns what all have in common; `None` if they are of several geometries.
fn all(mut each: impl Iterator<Item = Option<Common>>) -> Option<Common> {
    let first = each.next()??;
    each.try_fold(first, |all, one| all.with(one?))
}
