//! The disc of a scene file.

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
        shape::{Shape, disc::Disc},
    },
};

/// A round piece of a plane, seen from both sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Disc", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct DiscModel {
    /// The center.
    // Discs are few: boxed, so that no geometry needs more memory than a sphere.
    pub center: Box<Triple>,
    /// The direction that the disc is perpendicular to, of any length.
    pub normal: Box<Triple>,
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

impl Kind for DiscModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let (center, normal) = (DVec3::from(*self.center), DVec3::from(*self.normal));
        Some(Disc::new(center, normal, self.radius).map(Shape::from))
    }
}

fields! {
    DiscModel {
        center: Point,
        normal: Direction,
        radius: Positive,
        color: Color,
    } fixed {
        material,
        name,
    }
}
