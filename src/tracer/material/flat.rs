//! A surface without shading.

use crate::tracer::{
    color::Color,
    material::{emissive::Emissive, lobes::Lobes},
};

pub(super) const EQUATION: &str = "lin(color)";

pub(super) const fn lobes(color: &Color) -> Lobes<'_> {
    Lobes {
        emission: Some(Emissive::one(*color)),
        ..Lobes::NONE
    }
}
