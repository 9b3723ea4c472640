//! The table of cylinders of a scene file.

use std::sync::Arc;

use crate::scene::format::{
    color::ColorModel, color_by::ColorByModel, geometry::kind::geometry, material::MaterialModel,
    thing::Type,
};

geometry! {
    /// Many cylinders from a table, a file beside the scene: one in each row, such as the bonds of a molecule.
    pub struct CylindersModel = "Cylinders" {
        /// The table: a path from the folder of the scene to a file .csv, .npy or .npz, with `/` between
        /// its parts. Its columns `x1`, `y1` and `z1` are the middle of the first end, `x2`, `y2` and `z2`
        /// that of the other.
        file | csv | table | path: File { &["csv", "npy", "npz"] }(Box<str>),
        /// The names of the columns of a table without names: an array of numbers, or a CSV file whose
        /// first line is a row. A name that begins with `_` stands for a column to skip.
        columns: Other { Type::List(|| Type::Text, 0) }(Vec<Box<str>>)?,
        /// The array of an .npz file whose rows are read; required where several have rows of columns.
        array: Text(Box<str>)?,
        /// The radius of rows that have none, above 0; required where the table has none.
        radius | r: Positive ?= 0.0,
        /// True if the ends are closed; the default. Otherwise each is open, and seen from both sides.
        capped: Flag = true,
        /// The color of rows that have none; required where the table has none.
        color: Color ?= ColorModel::BLACK,
        /// Colors by the values of a column, instead of those of the rows. Give at most one of this and
        /// `color`.
        color_by: Thing(ColorByModel)?,
        /// The material of all rows; the color of a row replaces its first color. Give at most one of this
        /// and `color`.
        material: Thing(Arc<MaterialModel>)?,
    } at most one of color, material
}
