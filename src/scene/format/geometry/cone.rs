//! The cone of a scene file.

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
        shape::{Shape, cone::Cone},
    },
};

/// A cone, or a part of one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Cone", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct ConeModel {
    /// The middle of the first end.
    pub from: Triple,
    /// The middle of the other end, or the tip.
    pub to: Triple,
    /// The radius of the first end, above 0.
    pub radius: f64,
    /// The radius of the other end, at least 0. The default is 0: a tip.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 0))]
    pub top_radius: Option<f64>,
    /// True if the ends are closed; the default. Otherwise it is open, and seen from both sides.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = true))]
    pub capped: Option<bool>,
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

impl Kind for ConeModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let (from, to) = (DVec3::from(self.from), DVec3::from(self.to));
        let (top, capped) = (self.top_radius.unwrap_or(0.0), self.capped.unwrap_or(true));
        Some(Cone::new(from, to, self.radius, top, capped).map(Shape::from))
    }

    fn more_numbers(&self, see: &mut dyn FnMut(f64)) {
        // It follows the other numbers, as if it were given.
        if self.top_radius.is_none() {
            see(0.0);
        }
        see(f64::from(u8::from(self.capped.unwrap_or(true))));
    }

    fn clashes(&self) -> Vec<Clash> {
        Clash::of_axis([&self.from, &self.to], "cone")
    }
}

fields! {
    ConeModel {
        from: Point,
        to: Point,
        radius: Positive,
        top_radius: Distance = 0.0,
        color: Color,
    } fixed {
        capped,
        material,
        name,
    }
}
