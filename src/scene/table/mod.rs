//! Tables of spheres or cylinders: the contents of a CSV, NPY, NPZ, PLY, XYZ or PDB file, and access
//! to its rows.
//!
//! A table keeps the bytes of a binary file as they are and decodes them in blocks on each access:
//! a row takes no more memory than in the file, and reading is little more than copying. Numbers
//! are checked while they are read. It opens no files; `scene/tables.rs` does.

mod atoms;
pub(crate) mod bytes;
mod check;
mod csv;
mod extent;
pub(crate) mod layout;
mod npy;
mod npz;
pub(crate) mod ply;
mod select;
#[cfg(test)]
mod tests;
mod values;

use std::{
    fmt,
    io::{self, Read},
    sync::Arc,
};

use glam::DVec3;

pub(crate) use check::{Bad, Kind};
pub(crate) use layout::Row;
pub(crate) use select::Names;
pub(crate) use values::Values;

use crate::{
    diagnostic::path::Path,
    parallel::Pool,
    scene::{
        format::{color_by::ColorByModel, geometry::table::RowKind},
        table::{
            bytes::{Bytes, Reading},
            check::Check,
            extent::Extent,
            layout::{Block, COLORS, Column, Columns, Endian, Layout, RADIUS, Scalar, VALUE},
            select::{ColumnNames, Known},
        },
    },
    text::nearest::{list, quote},
    tracer::{error::GeometryError, shape::instances::Rows as TransformRows},
};

/// The file format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Comma-separated values with a header.
    Csv,
    /// A numpy array.
    Npy,
    /// Numpy arrays with names, in a zip file.
    Npz,
    /// The Stanford polygon format; only its vertices are read.
    Ply,
    /// Atoms, one per line.
    Xyz,
    /// Atoms of the Protein Data Bank, in fixed columns.
    Pdb,
}

/// Each format with its file extension.
const ENDINGS: [(&str, Format); 6] = [
    (".csv", Format::Csv),
    (".npy", Format::Npy),
    (".npz", Format::Npz),
    (".ply", Format::Ply),
    (".xyz", Format::Xyz),
    (".pdb", Format::Pdb),
];

impl Format {
    /// Returns the format for a file extension, in either case.
    pub(crate) fn of_name(name: &str) -> Option<Self> {
        let (_, ending) = name.rsplit_once('.')?;
        let is_it = |known: &str| known[1..].eq_ignore_ascii_case(ending);
        let mut all = ENDINGS.into_iter();
        all.find_map(|(known, format)| is_it(known).then_some(format))
    }

    /// Returns true if a file of the format may hold rows of a kind.
    pub(crate) const fn holds(self, kind: RowKind) -> bool {
        match self {
            Self::Csv | Self::Npy | Self::Npz => true,
            Self::Ply | Self::Xyz | Self::Pdb => matches!(kind, RowKind::Sphere),
        }
    }

    /// Returns the file extensions of the formats for rows of a kind, as text.
    pub(crate) fn endings(kind: RowKind) -> String {
        let all = ENDINGS.into_iter().filter(|(_, format)| format.holds(kind));
        let all: Vec<_> = all.map(|(ending, _)| ending).collect();
        match all.split_last() {
            Some((last, [])) => (*last).to_owned(),
            Some((last, others)) => format!("{} or {last}", others.join(", ")),
            None => String::new(),
        }
    }

    /// Returns the names of the columns, without the value; `None` for one that rows of this kind
    /// never have.
    pub(crate) const fn columns(self, kind: RowKind) -> ColumnNames {
        match self {
            Self::Csv | Self::Npy | Self::Npz | Self::Xyz | Self::Pdb => select::columns(kind),
            Self::Ply => ply::KNOWN.columns,
        }
    }

    /// Returns the names of all columns that rows of a kind may have, without the value.
    pub(crate) fn column_names(self, kind: RowKind) -> impl Iterator<Item = &'static str> {
        let columns = self.columns(kind).into_iter().flatten();
        columns.chain(select::rotation_of(kind).iter().copied())
    }

    /// Returns the names of the columns of colors.
    pub(crate) fn color_names(self, kind: RowKind) -> impl Iterator<Item = &'static str> {
        let hex = Known::of_csv(kind).hex.filter(|_| self == Self::Csv);
        let channels = self.columns(kind).into_iter().skip(COLORS.start).flatten();
        channels.chain(hex)
    }

    /// Returns the name of a column, by its place among all.
    pub(crate) fn column(self, kind: RowKind, at: usize) -> Option<&'static str> {
        match (kind, self.columns(kind).get(at)) {
            (RowKind::Copy, None | Some(None)) => select::rotation(at),
            (_, name) => name.copied().flatten(),
        }
    }

    /// Returns true if the rows are atoms, whose elements have radii and colors.
    pub(crate) const fn is_atoms(self) -> bool {
        matches!(self, Self::Xyz | Self::Pdb)
    }
}

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
    const fn kind(&self) -> RowKind {
        self.defaults.kind
    }

    /// Rejects names of columns for a table that has its own.
    fn refuse_columns(&self, has_names: &str) -> Result<(), Fault> {
        if self.columns.is_none() {
            return Ok(());
        }
        let fault = Fault::new(format!("`columns` is given, but {has_names}"));
        Err(fault.help("remove `columns`").at(Blamed::Columns))
    }

    /// Rejects the name of an array for a file that has no named arrays.
    fn refuse_array(&self) -> Result<(), Fault> {
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

/// The reason why a table cannot be read.
#[derive(Debug)]
pub(crate) enum ReadError {
    /// An error of the disk.
    Io(io::Error),
    /// A fault in the file.
    Invalid(Fault),
}

/// A fault of a table: one line, lower case, without a full stop.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fault {
    pub(crate) message: String,
    pub(crate) help: Option<String>,
    /// The field of the scene that is at fault.
    pub(crate) blamed: Blamed,
}

/// A field of a geometry that names a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Blamed {
    File,
    Columns,
    Array,
    /// The column whose values determine the colors.
    Value,
}

impl Blamed {
    /// Returns the path of the field, given that of the geometry.
    pub(crate) fn path_in(self, variant: &Path) -> Path {
        match self {
            Self::File => variant.field("file"),
            Self::Columns => variant.field("columns"),
            Self::Array => variant.field("array"),
            Self::Value => variant.field("color_by").field("column"),
        }
    }
}

impl Fault {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: None,
            blamed: Blamed::File,
        }
    }

    const fn at(mut self, blamed: Blamed) -> Self {
        self.blamed = blamed;
        self
    }

    /// Blames the choice of a column whose values are not numbers; `others` are those to choose from.
    pub(crate) fn blame_value(self, others: &[&str]) -> Self {
        let help = format!("choose another column: {}", list(others));
        self.help(help).at(Blamed::Value)
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// A fault in a row of a text, found before its numbers are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wrong {
    Length,
    Empty,
    Number,
    Color,
    Element,
    End,
}

/// Rows that have the same fault in the same column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BadRows {
    wrong: Wrong,
    column: String,
    /// The first row, followed by its fault.
    pub(crate) row: usize,
    pub(crate) fault: Fault,
    /// The total number of such rows.
    pub(crate) count: usize,
}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<Fault> for ReadError {
    fn from(fault: Fault) -> Self {
        Self::Invalid(fault)
    }
}

/// Formats the place of a row for the start of a message. Rows count from 0, as every index does;
/// lines of a text from 1, as in editors.
pub(crate) fn row(row: usize, line: Option<u64>) -> String {
    let line = line.map_or_else(String::new, |line| format!(" (line {line})"));
    format!("row {row}{line}")
}

/// The same for a cell.
pub(crate) fn cell(index: usize, line: Option<u64>, column: &str) -> String {
    format!("{}, column {}", row(index, line), quote(column))
}

/// Spheres or cylinders in rows; clones share the bytes.
#[derive(Clone)]
pub(crate) struct Table {
    bytes: Arc<Bytes>,
    layout: Layout,
    bad: Vec<Bad>,
    bad_rows: Vec<BadRows>,
    extent: Extent,
    values: Values,
    names: Names,
    /// The rows with an empty radius or color, where the defaults are stored.
    empty: Arc<Empty>,
    /// The line of the first row, in a text with one line per row.
    first_line: Option<u64>,
}

/// The rows of a table with empty cells.
#[derive(Clone, Default)]
struct Empty {
    radius: Vec<usize>,
    color: Vec<usize>,
}

impl fmt::Debug for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Table").field("rows", &self.rows()).finish()
    }
}

impl Table {
    /// Reads a table of `length` bytes. No more memory is allocated before the file is known to be
    /// that large. `pool` returns the threads that read a text of a given length.
    pub(crate) fn read(
        reader: impl Read + Send,
        length: u64,
        format: Format,
        request: &Request,
        pool: impl FnOnce(usize) -> Pool,
    ) -> Result<Self, ReadError> {
        if length == 0 {
            return Err(Fault::new("the file is empty").into());
        }
        if format != Format::Npz {
            request.refuse_array()?;
        }
        match format {
            Format::Csv => csv::read(reader, length, request, pool),
            Format::Npy => npy::read(reader, length, request),
            Format::Npz => npz::read(reader, length, request),
            Format::Ply => ply::read(reader, length, request),
            Format::Xyz => atoms::read_xyz(reader, length, request),
            Format::Pdb => atoms::read_pdb(reader, length, request),
        }
    }

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
        }
    }

    /// Returns the faults of the numbers in the file; those from the scene for all rows are not
    /// checked.
    pub(crate) fn bad(&self) -> &[Bad] {
        &self.bad
    }

    /// Returns the rows that could not be read; if there are any, the table must not be used.
    pub(crate) fn bad_rows(&self) -> &[BadRows] {
        &self.bad_rows
    }

    /// Returns true if rows could not be read because no row has a number in the column of the values.
    pub(crate) fn has_no_numbers(&self, bad: &BadRows, by: &ColorByModel) -> bool {
        let is_of_value = bad.wrong == Wrong::Number && *bad.column == *by.column;
        is_of_value && self.values().is_some_and(|values| values.range().is_none())
    }

    /// Returns the names of the columns.
    pub(crate) const fn names(&self) -> &Names {
        &self.names
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

    /// Returns the line of a row, if known.
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
    /// The index of the first row whose transform cannot be inverted in f64.
    pub(crate) fn transforms(&self) -> Result<Arc<Vec<TransformRows>>, (usize, GeometryError)> {
        let mut all = Vec::with_capacity(self.rows());
        let mut refused = None;
        self.any_block(|block| {
            for transform in block.transforms() {
                match transform {
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

/// The rows of a table that is not kept as is, such as a text: f64, row by row.
struct Rows {
    bytes: Vec<u8>,
    rows: usize,
    empty: Empty,
    bad: Vec<BadRows>,
    first_line: Option<u64>,
}

/// The substitute for a number that could not be read: valid as a coordinate, radius or channel, and
/// hardly ever the number of another cell.
const UNREAD: f64 = 0.618_033_988_749_894_9;

/// Returns the substitute for the number in a column: the two ends of a cylinder that could not be read
/// are not the same point.
fn unread(column: usize) -> f64 {
    UNREAD / (column + 1) as f64
}

impl Rows {
    const fn new() -> Self {
        Self {
            bytes: Vec::new(),
            rows: 0,
            empty: Empty {
                radius: Vec::new(),
                color: Vec::new(),
            },
            bad: Vec::new(),
            first_line: None,
        }
    }

    /// Notes a fault in the next row. Only the first such row is reported, the others are counted.
    /// Returns the substitute for the number.
    fn note(&mut self, wrong: Wrong, column: &str, fault: impl FnOnce() -> Fault) -> f64 {
        let mut all = self.bad.iter_mut();
        match all.find(|bad| bad.wrong == wrong && bad.column == column) {
            Some(bad) => bad.count += 1,
            None => self.bad.push(BadRows {
                wrong,
                column: column.to_owned(),
                row: self.rows,
                fault: fault(),
                count: 1,
            }),
        }
        UNREAD
    }

    /// Adds a row; all rows have equally many numbers.
    fn push(&mut self, numbers: &[f64], line: Option<u64>) -> io::Result<()> {
        if self.rows == 0 {
            self.first_line = line;
        }
        // After a skipped line, the row no longer determines its line.
        self.first_line = self
            .first_line
            .filter(|first| Some(first + self.rows as u64) == line);
        self.reserve(numbers.len() * Scalar::F64.size())?;
        for number in numbers {
            self.bytes.extend_from_slice(&number.to_le_bytes());
        }
        self.rows += 1;
        Ok(())
    }

    /// Adds encoded rows; `empty` lists those with empty cells.
    fn append(&mut self, bytes: &[u8], rows: usize, empty: &Empty) -> io::Result<()> {
        self.reserve(bytes.len())?;
        self.bytes.extend_from_slice(bytes);
        let first = self.rows;
        let behind = |row: &usize| first + row;
        self.empty.radius.extend(empty.radius.iter().map(behind));
        self.empty.color.extend(empty.color.iter().map(behind));
        self.rows += rows;
        Ok(())
    }

    /// Reserves space: more rows than the memory holds are an error and not an abort.
    fn reserve(&mut self, size: usize) -> io::Result<()> {
        if self.bytes.capacity() - self.bytes.len() < size {
            self.bytes
                .try_reserve(size.max(self.bytes.len()).max(1 << 16))?;
        }
        Ok(())
    }

    /// Creates the table of these rows, which have the given columns.
    fn into_table(self, has: Columns<bool>, names: Names, defaults: &Defaults) -> Table {
        let count = has.into_iter().filter(|has| *has).count();
        let column = |index: usize| Column::Stored {
            scalar: Scalar::F64,
            endian: Endian::Little,
            start: index * Scalar::F64.size(),
            step: count * Scalar::F64.size(),
            divisor: 1.0,
        };
        let layout = Layout::some(self.rows, has, defaults, column);
        Table {
            empty: self.empty.into(),
            bad_rows: self.bad,
            first_line: self.first_line,
            ..Table::new(Bytes::Rows(self.bytes), Check::new(layout), names)
        }
    }
}

impl Defaults {
    fn numbers(&self) -> Columns<Option<f64>> {
        let [r, g, b] = self.color.map_or([None; 3], |color| color.map(Some));
        let [x, y, z, to_x, to_y, to_z, value] = [None; 7];
        [x, y, z, to_x, to_y, to_z, self.radius, r, g, b, value]
    }
}
