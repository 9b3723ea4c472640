//! What each kind of geometry tells of itself. Defaults are what holds for most.

use crate::{
    scene::format::{
        geometry::{GeometryModel, clash::Clash, nesting::Inside, table::TableModel},
        transform::TransformModel,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, solid::Operation},
    },
};

/// The largest number of fields with geometries.
pub(super) const FIELDS: usize = 2;

/// A kind of geometry.
pub(super) trait GeometryKind {
    /// Returns the shape; `None` for a table, a part, a group, and a mesh whose file is not read.
    #[inline]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        None
    }

    /// Returns the faults between fields that are valid alone.
    #[inline]
    fn clashes(&self) -> Vec<Clash> {
        Vec::new()
    }

    /// Calls `see` with each number of the shape that is not the value of a field.
    #[inline]
    fn more_numbers(&self, see: &mut dyn FnMut(f64)) {
        if self.operation().is_some()
            && let Some(Ok(shape)) = self.shape()
        {
            shape.each_number(see);
        }
    }

    /// Returns its fields with geometries, in the order of the file.
    #[inline]
    fn inside(&self) -> [Option<Inside<'_>>; FIELDS] {
        [None; FIELDS]
    }

    /// The same geometries, writable.
    #[inline]
    fn inside_mut(&mut self) -> [&mut [GeometryModel]; FIELDS] {
        [&mut [], &mut []]
    }

    /// Returns what is done with the solids inside, if it is put together from some.
    #[inline]
    fn operation(&self) -> Option<Operation> {
        None
    }

    /// The table that it names.
    #[inline]
    fn table(&self) -> Option<TableModel<'_>> {
        None
    }

    /// Its transform.
    #[inline]
    fn transform(&self) -> Option<&TransformModel> {
        None
    }
}
