//! The fields that every table of a scene file has.

use std::sync::Arc;

use crate::{
    data::table::kind::RowKind,
    scene::format::{
        color::ColorModel,
        color_by::ColorByModel,
        geometry::kind::{GeometryKind, SeveralWords, TableModel, geometry},
        material::MaterialModel,
        texture::TextureModel,
        thing::Type,
    },
};

/// Defines the table that a geometry names.
macro_rules! table {
    ($model:ident, $all:literal, $table:ident => $kind:expr) => {
        impl GeometryKind for $model {
            #[inline]
            fn table(&self) -> Option<TableModel<'_>> {
                let $table = self;
                Some(TableModel {
                    kind: $kind,
                    file: &self.file,
                    columns: self.columns.as_deref(),
                    array: self.array.as_deref(),
                    radius: self.radius,
                    color: self.color.as_ref(),
                    color_by: self.color_by.as_ref(),
                    texture: self.texture.as_deref(),
                    material: self.material.as_deref(),
                })
            }

            fn words(&self) -> Option<SeveralWords> {
                Some(SeveralWords {
                    whole: "a table",
                    all: $all,
                    one: "in this table",
                })
            }
        }
    };
}

table!(SpheresModel, "spheres of this table", _table => RowKind::Sphere);
table!(CylindersModel, "cylinders of this table", table => RowKind::Cylinder { capped: table.capped() });

geometry! {
    /// Many spheres from a table, a file beside the scene: one in each row.
    pub struct SpheresModel = "Spheres" {
        /// The table: a path from the folder of the scene to a file .csv, .npy, .npz, .ply, .xyz or
        /// .pdb, with `/` between its parts.
        file | csv | table | path: File { &["csv", "npy", "npz", "ply", "xyz", "pdb"] }(Box<str>),
        /// The names of the columns of a table without names: an array of numbers, or a CSV file whose
        /// first line is a row. A name that begins with `_` stands for a column to skip.
        columns: Other { Type::List(|| Type::Text, 0) }(Vec<Box<str>>)?,
        /// The array of an .npz file whose rows are read; required where several have rows of columns.
        array: Text(Box<str>)?,
        /// The radius of rows that have none, above 0; required where the table has none. Of atoms, the
        /// radius of all of them.
        radius | r: Positive ?= 0.0,
        /// The color of rows that have none; required where the table has none. Of atoms, the color of
        /// all of them.
        color: Color ?= ColorModel::BLACK,
        /// Colors by the values of a column, instead of those of the rows. Give at most one of this and
        /// `color`.
        color_by: Thing(ColorByModel)?,
        /// A texture of all rows, which their colors are multiplied by; white is the default of `color` with
        /// it. A `material` has its own.
        texture: Thing(Arc<TextureModel>)?,
        /// The material of all rows; the color of a row replaces its first color. Give at most one of this
        /// and `color`.
        material: Thing(Arc<MaterialModel>)?,
    } at most one of color + texture, material not solid
}

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
        /// A texture of all rows, which their colors are multiplied by; white is the default of `color` with
        /// it. A `material` has its own.
        texture: Thing(Arc<TextureModel>)?,
        /// The material of all rows; the color of a row replaces its first color. Give at most one of this
        /// and `color`.
        material: Thing(Arc<MaterialModel>)?,
    } at most one of color + texture, material not solid
}
