//! Tables of spheres or cylinders: the contents of a CSV, NPY, NPZ, PLY, XYZ or PDB file, and access
//! to its rows.
//!
//! A table keeps the bytes of a binary file as they are and decodes them in blocks on each access:
//! a row takes no more memory than in the file, and reading is little more than copying. Numbers
//! are checked while they are read. It opens no files.

mod atoms;
mod check;
mod cloud;
mod csv;
mod extent;
mod format;
pub(crate) mod kind;
pub(crate) mod layout;
pub(crate) mod left_out;
mod npy;
mod npz;
mod ply;
mod read;
pub(crate) mod request;
pub(crate) mod row_cells;
mod rows;
pub(crate) mod select;
#[cfg(test)]
mod tests;
mod values;

use std::{fmt, io::Read, sync::Arc};

use glam::DVec3;

pub(crate) use check::{Bad, BadKind};
pub(crate) use cloud::Cloud;
pub(crate) use format::Format;
pub(crate) use layout::Row;
pub(crate) use request::{Defaults, Request};
pub(crate) use select::Names;
pub(crate) use values::Values;

use crate::{
    data::{
        bytes::{Bytes, Reading},
        fault::{BadRows, Fault, ReadError, Wrong},
        table::{
            check::Check,
            extent::Extent,
            layout::{Block, COLORS, Column, Layout, RADIUS, Scalar, VALUE},
            left_out::LeftOut,
            rows::Empty,
        },
    },
    tracer::{error::GeometryError, shape::instances::Rows as TransformRows, transform::Transform},
};

/// Spheres or cylinders in rows; clones share the bytes.
#[derive(Clone)]
pub(crate) struct Table {
    bytes: Arc<Bytes>,
    layout: Layout,
    /// The faults of the numbers in the file; those from the scene for all rows are not checked.
    pub(crate) bad: Vec<Bad>,
    /// The rows with a fault that was found before their numbers were checked.
    pub(crate) bad_rows: Vec<BadRows>,
    extent: Extent,
    values: Values,
    /// The names of the columns.
    pub(crate) names: Names,
    /// The rows with an empty radius or color, where the defaults are stored.
    empty: Arc<Empty>,
    /// The line of the first row, in a text with one line per row.
    first_line: Option<u64>,
    /// The format that the table was read in.
    pub(crate) format: Format,
    /// The rows of the file that are not in the table.
    pub(crate) left_out: Option<Arc<LeftOut>>,
    /// The warning about a file that goes on behind its last row.
    pub(crate) behind: Option<Fault>,
}

impl fmt::Debug for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Table").field("rows", &self.rows()).finish()
    }
}

impl Table {
    /// Reads the rest of a file and checks its numbers on the way.
    fn read_file(
        mut file: Reading<impl Read>,
        layout: Layout,
        names: Names,
    ) -> Result<Self, ReadError> {
        let mut check = Check::new(layout);
        while file.more()? {
            check.look(file.bytes());
        }
        Ok(Self::new(file.finish()?, check, names))
    }

    /// Creates a table from all bytes and the check, which has covered some of them.
    fn new(bytes: Bytes, mut check: Check, names: Names) -> Self {
        check.look(&bytes);
        Self {
            bytes: bytes.into(),
            layout: check.layout,
            bad: check.found,
            bad_rows: Vec::new(),
            extent: check.extent,
            values: check.values,
            names,
            empty: Arc::default(),
            first_line: None,
            format: Format::Csv,
            left_out: None,
            behind: None,
        }
    }

    /// Returns true if some rows could not be read, so that the table must not be used.
    pub(crate) fn has_unread_rows(&self) -> bool {
        self.bad_rows.iter().any(BadRows::is_error)
    }

    /// Returns true if rows could not be read because no row has a number in the column of the values.
    pub(crate) fn has_no_numbers(&self, bad: &BadRows, value: &str) -> bool {
        let is_of_value = bad.wrong == Wrong::Number && bad.column == value;
        is_of_value && self.values().is_some_and(|values| values.range().is_none())
    }

    /// Returns the values that determine the colors; `None` if the table has no such column.
    pub(crate) fn values(&self) -> Option<&Values> {
        self.layout.columns[VALUE].map(|_| &self.values)
    }

    /// The number of rows.
    pub(crate) const fn rows(&self) -> usize {
        self.layout.rows
    }

    /// Returns true if a point may be inside of a shape; [`Table::any_row`] gives certainty.
    pub(crate) fn may_enclose(&self, point: DVec3) -> bool {
        self.extent.may_enclose(point)
    }

    /// Returns the line of a row of the file, if known.
    pub(crate) fn line(&self, row: usize) -> Option<u64> {
        self.first_line.map(|first| first + row as u64)
    }

    /// Replaces the defaults that the table was read with.
    pub(crate) fn set_defaults(&mut self, defaults: &Defaults) {
        if let Some(radius) = defaults.radius {
            self.extent.add_radius(radius);
        }
        let empty = Arc::clone(&self.empty);
        let Empty { radius, color } = &*empty;
        let empty = |column: usize| match column {
            RADIUS => &**radius,
            _ if COLORS.contains(&column) => color,
            _ => &[],
        };
        for (index, given) in defaults.numbers().into_iter().enumerate() {
            match (&mut self.layout.columns[index], given) {
                (Some(Column::Constant(number)), Some(given)) => *number = given,
                (Some(Column::Stored { start, step, .. }), Some(given)) => {
                    let places = (*start, *step);
                    self.store(places, empty(index), given);
                }
                _ => {}
            }
        }
    }

    /// Stores a number in some rows of a column of f64 with the given start and step.
    fn store(&mut self, (start, step): (usize, usize), rows: &[usize], number: f64) {
        if rows.is_empty() {
            return;
        }
        let Bytes::Rows(bytes) = Arc::make_mut(&mut self.bytes) else {
            return;
        };
        for row in rows {
            let at = start + row * step;
            if let Some(cell) = bytes.get_mut(at..at + Scalar::F64.size()) {
                cell.copy_from_slice(&number.to_le_bytes());
            }
        }
    }

    /// Returns true if the table or the scene gives a radius.
    pub(crate) const fn has_radius(&self) -> bool {
        self.layout.columns[RADIUS].is_some()
    }

    /// Returns true if the table or the scene gives a color.
    pub(crate) const fn has_color(&self) -> bool {
        self.layout.columns[COLORS.start].is_some()
    }

    /// Returns true if every row has its own radius, so that the scene's is unused.
    pub(crate) fn has_every_radius(&self) -> bool {
        self.has_every(RADIUS, &self.empty.radius)
    }

    /// Returns true if every row has its own color, so that the scene's is unused.
    pub(crate) fn has_every_color(&self) -> bool {
        self.has_every(COLORS.start, &self.empty.color)
    }

    fn has_every(&self, column: usize, empty: &[usize]) -> bool {
        let is_stored = matches!(self.layout.columns[column], Some(Column::Stored { .. }));
        is_stored && self.rows() > 0 && empty.is_empty()
    }

    /// Returns true if `is_it` does for any row; the blocks after it are not decoded. A missing
    /// radius or color is 0.
    #[inline]
    pub(crate) fn any_row(&self, mut is_it: impl FnMut(Row) -> bool) -> bool {
        self.any_block(|block| block.rows(self.layout.kind).any(&mut is_it))
    }

    /// Returns the rows of the transforms of copies.
    ///
    /// # Errors
    ///
    /// The index of the first row whose transform cannot be inverted in f64, alone or within the one
    /// around it.
    pub(crate) fn transforms(
        &self,
        around: Option<&Transform>,
    ) -> Result<Arc<Vec<TransformRows>>, (usize, GeometryError)> {
        let mut all = Vec::with_capacity(self.rows());
        let mut refused = None;
        self.any_block(|block| {
            for transform in block.transforms() {
                let placed = |inner: &Transform| around.map_or(Ok(*inner), |all| all.times(inner));
                match transform.and_then(|inner| placed(&inner).map(|_| inner)) {
                    Ok(transform) => all.push(transform.rows()),
                    Err(error) => refused = refused.take().or(Some((all.len(), error))),
                }
            }
            refused.is_some()
        });
        refused.map_or_else(|| Ok(all.into()), Err)
    }

    /// Returns true if `is_it` does for any block.
    #[inline]
    fn any_block(&self, mut is_it: impl FnMut(&Block) -> bool) -> bool {
        let mut block = Block::new();
        while self.layout.next(&self.bytes, &mut block) {
            if is_it(&block) {
                return true;
            }
        }
        false
    }
}
