//! Faults between the fields of a geometry that are valid alone.

use glam::DVec3;

use crate::{diagnostic::Code, scene::format::field::Triple, tracer::vector::is_direction};

/// A fault between the fields of a geometry.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Clash {
    pub(crate) code: Code,
    /// The field that it is reported at, and the indices that lead to the value in it.
    pub(crate) field: &'static str,
    pub(crate) indices: Vec<usize>,
    pub(crate) message: String,
    pub(crate) help: String,
}

impl Clash {
    pub(super) fn new(
        code: Code,
        field: &'static str,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        let (message, help) = (message.into(), help.into());
        Self {
            code,
            field,
            indices: Vec::new(),
            message,
            help,
        }
    }

    /// Reports it at one value of the field.
    pub(super) fn at(mut self, indices: impl Into<Vec<usize>>) -> Self {
        self.indices = indices.into();
        self
    }

    /// Returns the fault of two points that are the ends of a shape, if they are too close.
    pub(super) fn of_axis([from, to]: [&Triple; 2], shape: &str) -> Vec<Self> {
        let [from, to] = [from, to].map(|point| DVec3::from(*point));
        let is_wrong = from.is_finite() && to.is_finite() && !is_direction(to - from);
        let clash = is_wrong.then(|| {
            let what = if from == to {
                "are the same point"
            } else {
                "have a squared distance that is 0 or not finite in an f64"
            };
            let message = format!("`from` and `to` {what}: the {shape} has no length");
            Self::new(Code::ZeroVector, "to", message, "give two different points")
        });
        Vec::from_iter(clash)
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
