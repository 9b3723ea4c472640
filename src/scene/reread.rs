//! The table that rows come from, and its file, of which single rows are read again: a scene keeps only the
//! columns that it needs.

use std::{path::PathBuf, sync::Arc};

use crate::{
    data::table::{
        Defaults, Format, Request, Table, kind::RowKind, left_out::LeftOut, row_cells::RowCells,
    },
    parallel::{Cancel, reader::UntilCancelled},
    scene::files::{Files, Stamp},
};

/// The table that rows of a scene come from.
#[derive(Clone, Debug, Default)]
pub(crate) struct RowsOf {
    /// The names of the columns, also of those that are not used.
    pub(crate) columns: Arc<[String]>,
    left_out: Option<Arc<LeftOut>>,
    file: Option<Arc<TableFile>>,
}

impl RowsOf {
    pub(crate) fn new(table: &Table, file: Option<Arc<TableFile>>) -> Self {
        Self {
            columns: Arc::clone(&table.names.all),
            left_out: table.left_out.clone(),
            file,
        }
    }

    /// Returns the row in the file of a row of the table.
    pub(crate) fn row_in_file(&self, row: usize) -> usize {
        let left_out = self.left_out.as_ref();
        left_out.map_or(row, |left_out| left_out.row_in_file(row))
    }

    /// Reads the cells of a row of the table again; `None` if the file has changed since it was read, or
    /// cannot be read.
    pub(crate) fn cells(&self, row: usize, cancel: &Cancel) -> Option<RowCells> {
        self.file.as_ref()?.cells(self.row_in_file(row), cancel)
    }
}

/// The file of a table, and how it is read.
#[derive(Debug)]
pub(crate) struct TableFile {
    files: Arc<dyn Files>,
    path: PathBuf,
    stamp: Stamp,
    format: Format,
    kind: RowKind,
    columns: Option<Vec<Box<str>>>,
    array: Option<Box<str>>,
}

impl TableFile {
    /// Creates the file at a real path, before it is read: so every later change is noticed. `None` if it
    /// cannot be opened.
    pub(crate) fn new(
        path: PathBuf,
        format: Format,
        request: &Request<'_>,
        files: Arc<dyn Files>,
    ) -> Option<Self> {
        Some(Self {
            stamp: files.open(&path).ok()?.stamp()?,
            files,
            path,
            format,
            kind: request.defaults.kind,
            columns: request.columns.map(<[_]>::to_vec),
            array: request.array.map(Into::into),
        })
    }

    fn cells(&self, row: usize, cancel: &Cancel) -> Option<RowCells> {
        let content = self.files.open(&self.path).ok()?;
        let stamp = content.stamp().filter(|stamp| *stamp == self.stamp)?;
        let request = Request {
            defaults: Defaults {
                kind: self.kind,
                ..Defaults::default()
            },
            columns: self.columns.as_deref(),
            array: self.array.as_deref(),
            value: None,
        };
        let reader = UntilCancelled::new(content, Some(cancel));
        RowCells::read(reader, stamp.length, self.format, &request, row).ok()
    }
}
