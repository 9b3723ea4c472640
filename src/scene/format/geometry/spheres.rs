//! The table of spheres of a scene file.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::{
    color::ColorModel,
    field::{Name, fields, rules},
    material::MaterialModel,
};

/// Many spheres from a table, a file beside the scene: one in each row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Spheres", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct SpheresModel {
    /// The table: a path from the folder of the scene to a file .csv, .npy or .ply, with `/`
    /// between its parts.
    #[schemars(regex(pattern = r"\.([cC][sS][vV]|[nN][pP][yY]|[pP][lL][yY])$"))]
    pub file: Box<str>,
    /// The radius of rows that have none, above 0; required where the table has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// The color of rows that have none; required where the table has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<ColorModel>,
    /// The material of all rows; a color column replaces its first color. Give at most one of this
    /// and `color`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Arc<MaterialModel>>,
    /// The name of the table: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

fields! {
    SpheresModel {
        radius: Positive = 0.0,
        color: Color = ColorModel::BLACK,
    } fixed {
        file,
        material,
        name,
    }
}
