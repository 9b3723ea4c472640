//! What a scene wants from a table.

use crate::data::{
    fault::{Blamed, Fault},
    table::{kind::RowKind, layout::Columns},
};

/// What a scene wants from a table.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Request<'a> {
    pub(crate) defaults: Defaults,
    /// The name of the column whose values determine the colors.
    pub(crate) value: Option<&'a str>,
    /// The names of the columns of a table without names.
    pub(crate) columns: Option<&'a [Box<str>]>,
    /// The array among several.
    pub(crate) array: Option<&'a str>,
}

impl Request<'_> {
    /// Returns what a row stands for.
    pub(super) const fn kind(&self) -> RowKind {
        self.defaults.kind
    }

    /// Rejects names of columns for a table that has its own.
    pub(super) fn refuse_columns(&self, has_names: &str) -> Result<(), Fault> {
        if self.columns.is_none() {
            return Ok(());
        }
        let fault = Fault::new(format!("`columns` is given, but {has_names}"));
        Err(fault.help("remove `columns`").at(Blamed::Columns))
    }

    /// Rejects the name of an array for a file that has no named arrays.
    pub(super) fn refuse_array(&self) -> Result<(), Fault> {
        if self.array.is_none() {
            return Ok(());
        }
        let fault = Fault::new("`array` is given, but only .npz files have named arrays");
        Err(fault.help("remove `array`").at(Blamed::Array))
    }
}

/// The values from the scene for rows, or whole tables, without their own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Defaults {
    /// What a row stands for.
    pub(crate) kind: RowKind,
    pub(crate) radius: Option<f64>,
    pub(crate) color: Option<[f64; 3]>,
}

impl Defaults {
    pub(super) fn numbers(&self) -> Columns<Option<f64>> {
        let [r, g, b] = self.color.map_or([None; 3], |color| color.map(Some));
        let [x, y, z, to_x, to_y, to_z, value] = [None; 7];
        [x, y, z, to_x, to_y, to_z, self.radius, r, g, b, value]
    }
}
