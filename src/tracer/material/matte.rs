//! A matte surface.

use crate::tracer::{color::Color, material::lobes::Lobes};

pub(super) const EQUATION: &str = "lin(color) · Σ I";

pub(super) const fn lobes(color: &Color) -> Lobes<'_> {
    Lobes {
        diffuse: Some(*color),
        ..Lobes::NONE
    }
}
