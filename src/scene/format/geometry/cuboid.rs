//! The box of a scene file.

use std::sync::Arc;

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    diagnostic::Code,
    scene::format::{
        color::ColorModel,
        field::{Name, Triple, fields, rules},
        geometry::clash::{Clash, number, shown},
        geometry::kind::Kind,
        material::MaterialModel,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, cuboid::Cuboid},
    },
};

/// A box along the axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Box", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct BoxModel {
    /// The corner with the smallest coordinates.
    pub min: Triple,
    /// The corner with the largest coordinates: each is above that of `min`.
    pub max: Triple,
    /// The color: a matte surface. Give this or `material`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<ColorModel>,
    /// The material. Give this or `color`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Arc<MaterialModel>>,
    /// The name of the geometry: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

impl Kind for BoxModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        Some(Cuboid::new(DVec3::from(self.min), DVec3::from(self.max)).map(Shape::from))
    }

    fn clashes(&self) -> Vec<Clash> {
        let (min, max) = (self.min, self.max);
        let is_finite = |axis: usize| min[axis].is_finite() && max[axis].is_finite();
        let is_empty = |axis: &usize| is_finite(*axis) && max[*axis] <= min[*axis];
        let mut empty = (0..3).filter(is_empty).peekable();
        if empty.peek().is_none() {
            return Vec::new();
        }
        let both = [0, 1, 2].map(|axis| [min[axis], max[axis]]);
        let ordered = |[low, high]: [f64; 2]| [low.min(high), low.max(high)];
        let sorted = both.map(ordered);
        let flat = ["x", "y", "z"]
            .into_iter()
            .zip(both)
            .find(|(_, [low, high])| low == high);
        let help = match flat {
            Some((axis, _)) => {
                format!("a box has a length above 0 along {axis}; a flat one is a `Rectangle`")
            }
            None => {
                let [low, high] = [0, 1].map(|end| shown(sorted.map(|ends| ends[end])));
                format!("write `min: {low}, max: {high}`")
            }
        };
        let clash = |axis: usize| {
            let (of_min, of_max) = (number(min[axis]), number(max[axis]));
            let message =
                format!("`max` must be above `min`, which is `{of_min}`, found `{of_max}`");
            Clash::new(Code::OutOfRange, "max", message, &*help)
                .at([axis])
                .with("min", [axis], "`min`")
        };
        empty.map(clash).collect()
    }
}

fields! {
    BoxModel {
        min: Point,
        max: Point,
        color: Color,
    } fixed {
        material,
        name,
    }
}
