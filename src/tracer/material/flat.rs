//! A surface without shading.

use crate::tracer::{color::Color, material::lobes::Lobes};

pub(super) const EQUATION: &str = "lin(color)";

pub(super) const fn lobes(color: &Color) -> Lobes<'_> {
    Lobes::shown(*color)
}
