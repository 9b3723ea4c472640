//! The table of cylinders of a scene file.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::{
    color::ColorModel,
    color_by::ColorByModel,
    field::{Name, fields, rules},
    material::MaterialModel,
};

/// Many cylinders from a table, a file beside the scene: one in each row, such as the bonds of a molecule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Cylinders", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct CylindersModel {
    /// The table: a path from the folder of the scene to a file .csv, .npy or .npz, with `/` between
    /// its parts. Its columns `x1`, `y1` and `z1` are the middle of the first end, `x2`, `y2` and `z2`
    /// that of the other.
    #[schemars(regex(pattern = r"\.([cC][sS][vV]|[nN][pP][yYzZ])$"))]
    pub file: Box<str>,
    /// The names of the columns of a table without names: an array of numbers, or a CSV file whose
    /// first line is a row. A name that begins with `_` stands for a column to skip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub columns: Option<Vec<Box<str>>>,
    /// The array of an .npz file whose rows are read; required where several have rows of columns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub array: Option<Box<str>>,
    /// The radius of rows that have none, above 0; required where the table has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// True if the ends are closed; the default. Otherwise each is open, and seen from both sides.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = true))]
    pub capped: Option<bool>,
    /// The color of rows that have none; required where the table has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<ColorModel>,
    /// Colors by the values of a column, instead of those of the rows. Give at most one of this and
    /// `color`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color_by: Option<ColorByModel>,
    /// The material of all rows; the color of a row replaces its first color. Give at most one of this
    /// and `color`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Arc<MaterialModel>>,
    /// The name of the table: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

fields! {
    CylindersModel {
        radius: Positive = 0.0,
        color: Color = ColorModel::BLACK,
    } fixed {
        file,
        columns,
        array,
        capped,
        color_by,
        material,
        name,
    }
}
