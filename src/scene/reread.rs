//! The file of a table, of which single rows are read again: a scene keeps only the columns that it needs.

use std::{path::PathBuf, sync::Arc};

use crate::{
    parallel::Cancel,
    scene::{
        files::{Files, Stamp},
        format::geometry::table::RowKind,
        options::{ReadOptions, UntilCancelled},
        table::{Defaults, Format, Request, RowCells},
    },
};

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
        options: &ReadOptions,
    ) -> Option<Self> {
        let files = options.shared_files();
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

    /// Reads the cells of a row, which counts from 0; `None` if the file has changed since it was read, or
    /// cannot be read.
    pub(crate) fn cells(&self, row: usize, cancel: &Cancel) -> Option<RowCells> {
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
        let reader = UntilCancelled::new(content, cancel);
        RowCells::read(reader, stamp.length, self.format, &request, row).ok()
    }
}
