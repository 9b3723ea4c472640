//! The fields that every table of a scene file has.

use crate::{
    data::table::kind::RowKind,
    scene::format::{
        color::ColorModel,
        color_by::ColorByModel,
        geometry::{cylinders::CylindersModel, kind::GeometryKind, spheres::SpheresModel},
        material::MaterialModel,
    },
};

/// A geometry that names a table, whatever its rows stand for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TableModel<'a> {
    pub(crate) kind: RowKind,
    pub(crate) file: &'a str,
    pub(crate) columns: Option<&'a [Box<str>]>,
    pub(crate) array: Option<&'a str>,
    pub(crate) radius: Option<f64>,
    pub(crate) color: Option<&'a ColorModel>,
    pub(crate) color_by: Option<&'a ColorByModel>,
    pub(crate) material: Option<&'a MaterialModel>,
}

/// Defines the table that a geometry names.
macro_rules! table {
    ($model:ident, $table:ident => $kind:expr) => {
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
                    material: self.material.as_deref(),
                })
            }
        }
    };
}

table!(SpheresModel, _table => RowKind::Sphere);
table!(CylindersModel, table => RowKind::Cylinder { capped: table.capped() });
