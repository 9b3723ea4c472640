//! The plane of a scene file.

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
        shape::{Shape, plane::Plane},
    },
};

/// An infinite plane, seen from both sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Plane", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct PlaneModel {
    /// A point of the plane.
    pub point: Triple,
    /// The direction that the plane is perpendicular to, of any length.
    // Planes are few: boxed, so that no geometry needs more memory than a sphere.
    pub normal: Box<Triple>,
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

impl Kind for PlaneModel {
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        Some(Plane::new(DVec3::from(self.point), DVec3::from(*self.normal)).map(Shape::from))
    }
}

fields! {
    PlaneModel {
        point: Point,
        normal: Direction,
        color: Color,
    } fixed {
        material,
        name,
    }
}
