//! The capsule of a scene file.

use std::sync::Arc;

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{Name, Triple, fields, rules},
        geometry::{clash::Clash, kind::Kind},
        material::MaterialModel,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, capsule::Capsule},
    },
};

/// A round bar with round ends: all points at a distance from a line between two points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Capsule", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct CapsuleModel {
    /// The center of the first end.
    pub from: Triple,
    /// The center of the other end.
    pub to: Triple,
    /// The radius, above 0.
    pub radius: f64,
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

impl Kind for CapsuleModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let (from, to) = (DVec3::from(self.from), DVec3::from(self.to));
        Some(Capsule::new(from, to, self.radius).map(Shape::from))
    }

    fn clashes(&self) -> Vec<Clash> {
        Clash::of_axis([&self.from, &self.to], "capsule")
    }
}

fields! {
    CapsuleModel {
        from: Point,
        to: Point,
        radius: Positive,
        color: Color,
    } fixed {
        material,
        name,
    }
}
