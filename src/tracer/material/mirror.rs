//! A mirror.

use crate::tracer::{color::Color, material::lobes::Lobes};

pub(super) const EQUATION: &str = "lin(color) · L(mirror)";

pub(super) const fn lobes(color: &Color) -> Lobes<'_> {
    Lobes {
        mirror: Some(*color),
        ..Lobes::NONE
    }
}
