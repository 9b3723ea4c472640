//! The sphere of a scene file.

use std::sync::Arc;

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{Name, Triple, fields, rules},
        geometry::kind::Kind,
        material::MaterialModel,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, sphere::Sphere},
    },
};

/// A sphere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Sphere", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct SphereModel {
    /// The center.
    pub center: Triple,
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

impl Kind for SphereModel {
    #[inline]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        Some(Sphere::new(DVec3::from(self.center), self.radius).map(Shape::from))
    }
}

fields! {
    SphereModel {
        center: Point,
        radius: Positive,
        color: Color,
    } fixed {
        material,
        name,
    }
}
