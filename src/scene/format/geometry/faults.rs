//! Faults between the fields of a geometry that are valid alone.

use glam::DVec3;

use crate::{
    diagnostic::{Code, path::Path},
    scene::{format::numbers::Triple, problem::Problem},
    tracer::vector::{is_direction, why_no_axis},
};

/// Returns the path from a geometry to a value in one of its fields.
pub(super) fn value(field: &'static str, indices: impl IntoIterator<Item = usize>) -> Path {
    let first = Path::ROOT.field(field);
    indices
        .into_iter()
        .fold(first, |path, index| path.index(index))
}

/// Returns the fault of a number that is not finite.
pub(super) fn not_finite(field: &'static str, indices: [usize; 2]) -> Problem {
    let place = value(field, indices);
    let problem = Problem::of_value(Code::NotFinite, place, "expected a finite number");
    problem.help("numbers are finite 64-bit floats, up to about 1.8e308")
}

/// Returns the fault of two points that are the ends of a shape, if they are too close.
pub(super) fn of_axis([from, to]: [&Triple; 2], shape: &str) -> Vec<Problem> {
    let what = why_no_axis([from, to].map(|point| DVec3::from(*point)));
    let fault = what.map(|what| {
        let message = format!("`from` and `to` {what}: the {shape} has no length");
        let fault = Problem::of_field(Code::ZeroVector, "to", message);
        let fault = fault.help("give two different points");
        fault.beside("from", "the other end")
    });
    Vec::from_iter(fault)
}

/// The reason why two vectors span no area in f64.
pub(super) enum NoArea {
    Parallel,
    /// The square of the area is 0.
    TooSmall,
    /// The square of the area is not finite.
    TooLarge,
}

impl NoArea {
    /// Returns the reason for two vectors, if they span none.
    pub(super) fn of([u, v]: [DVec3; 2]) -> Option<Self> {
        /// The sine of the smallest angle between directions that are not parallel.
        const ALMOST_PARALLEL: f64 = 1e-9;
        let across = u.cross(v);
        if is_direction(across) {
            return None;
        }
        // A factor first: the squares of very long and very short ones do not fit into an f64.
        let direction = |v: DVec3| {
            let v = v / v.abs().max_element();
            v / v.length()
        };
        let sine = direction(u).cross(direction(v)).length();
        Some(if !u.is_finite() || !v.is_finite() {
            Self::TooLarge
        } else if sine.is_nan() || sine <= ALMOST_PARALLEL {
            Self::Parallel
        } else if across.dot(across) == 0.0 {
            Self::TooSmall
        } else {
            Self::TooLarge
        })
    }

    /// Returns the fault of two sides, by their cross product as people write it; `None` for parallel
    /// ones.
    pub(super) fn fault(&self, field: &'static str, sides: &str, across: &str) -> Option<Problem> {
        let (length, is) = match self {
            Self::Parallel => return None,
            Self::TooSmall => ("short", "0"),
            Self::TooLarge => ("long", "not finite"),
        };
        let message = format!(
            "the {sides} are too {length}: the squared length of {across} is {is} in an f64"
        );
        let help = "write lengths in another unit, in the whole scene";
        Some(Problem::of_field(Code::ZeroVector, field, message).help(help))
    }
}

/// Returns a vector as it is written in a scene.
pub(super) fn shown(vector: [f64; 3]) -> String {
    let [x, y, z] = vector.map(number);
    format!("({x}, {y}, {z})")
}

/// Returns a number as it is written in a scene.
pub(super) fn number(number: f64) -> String {
    let text = format!("{number:?}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}
