//! Faults between the fields of a geometry that are valid alone.

use glam::DVec3;

use crate::{
    diagnostic::{Code, path::Path},
    scene::format::field::Triple,
    tracer::vector::{is_direction, why_no_axis},
};

/// A fault between the fields of a geometry.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Clash {
    pub(crate) code: Code,
    /// The value that it is reported at.
    pub(crate) place: ValuePlace,
    pub(crate) message: String,
    pub(crate) help: String,
    /// True if the message ends with the value as written.
    pub(crate) shows_value: bool,
    /// The values that it clashes with, each with a label: a setting of one of them is at fault.
    pub(crate) others: Vec<(ValuePlace, &'static str)>,
    /// The values that are in each other's places, if that is the fault.
    pub(crate) exchanged: Vec<[ValuePlace; 2]>,
}

/// A value of a geometry: the field, and the indices that lead to the value in it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ValuePlace {
    field: &'static str,
    indices: Vec<usize>,
}

impl ValuePlace {
    fn new(field: &'static str, indices: impl Into<Vec<usize>>) -> Self {
        let indices = indices.into();
        Self { field, indices }
    }

    /// Returns the path of the value, given that of the geometry.
    pub(crate) fn path(&self, geometry: &Path) -> Path {
        let field = geometry.field(self.field);
        let indices = self.indices.iter();
        indices.fold(field, |path, index| path.index(*index))
    }
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
            place: ValuePlace::new(field, []),
            message,
            help,
            shows_value: false,
            others: Vec::new(),
            exchanged: Vec::new(),
        }
    }

    /// Returns the fault of a number that is not finite.
    pub(super) fn not_finite(field: &'static str, indices: impl Into<Vec<usize>>) -> Self {
        let help = "numbers are finite 64-bit floats, up to about 1.8e308";
        let clash = Self::new(Code::NotFinite, field, "expected a finite number", help);
        Self {
            shows_value: true,
            ..clash.at(indices)
        }
    }

    /// Reports it at one value of the field.
    pub(super) fn at(mut self, indices: impl Into<Vec<usize>>) -> Self {
        self.place.indices = indices.into();
        self
    }

    /// Adds a value that it clashes with.
    pub(super) fn with(
        mut self,
        field: &'static str,
        indices: impl Into<Vec<usize>>,
        label: &'static str,
    ) -> Self {
        self.others.push((ValuePlace::new(field, indices), label));
        self
    }

    /// Adds elements of two fields that are in each other's places.
    pub(super) fn exchanging(
        mut self,
        elements: impl IntoIterator<Item = (&'static str, &'static str, usize)>,
    ) -> Self {
        let pairs = elements.into_iter();
        let place = |field, index| ValuePlace::new(field, [index]);
        self.exchanged
            .extend(pairs.map(|(one, other, index)| [place(one, index), place(other, index)]));
        self
    }

    /// Returns the fault of two points that are the ends of a shape, if they are too close.
    pub(super) fn of_axis([from, to]: [&Triple; 2], shape: &str) -> Vec<Self> {
        let what = why_no_axis([from, to].map(|point| DVec3::from(*point)));
        let clash = what.map(|what| {
            let message = format!("`from` and `to` {what}: the {shape} has no length");
            Self::new(Code::ZeroVector, "to", message, "give two different points").with(
                "from",
                [],
                "the other end",
            )
        });
        Vec::from_iter(clash)
    }
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
    pub(super) fn clash(&self, field: &'static str, sides: &str, across: &str) -> Option<Clash> {
        let (length, is) = match self {
            Self::Parallel => return None,
            Self::TooSmall => ("short", "0"),
            Self::TooLarge => ("long", "not finite"),
        };
        let message = format!(
            "the {sides} are too {length}: the squared length of {across} is {is} in an f64"
        );
        let help = "write lengths in another unit, in the whole scene";
        Some(Clash::new(Code::ZeroVector, field, message, help))
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
