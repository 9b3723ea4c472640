//! Spheres as a table: what stands in a CSV, NPY or PLY file, and how its rows are read.
//!
//! A table keeps the bytes of a binary file as they are and decodes them in blocks, each time they
//! are asked for: a row takes no more memory than in the file, and reading is little more than
//! copying. It opens no file; `scene/tables.rs` does.

mod check;
mod csv;
mod npy;
mod ply;
#[cfg(test)]
mod tests;

use std::{
    fmt,
    io::{self, Read},
    ops::Range,
    sync::Arc,
};

pub(crate) use check::{Bad, Kind};

use crate::scene::nearest::quote;

/// What a table is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Comma-separated values with a header.
    Csv,
    /// An array of numpy.
    Npy,
    /// The Stanford polygon format, of which the vertices are read.
    Ply,
}

impl Format {
    /// The format that the ending of a name tells, in either case.
    pub(crate) fn of_name(name: &str) -> Option<Self> {
        let (_, ending) = name.rsplit_once('.')?;
        match ending.to_ascii_lowercase().as_str() {
            "csv" => Some(Self::Csv),
            "npy" => Some(Self::Npy),
            "ply" => Some(Self::Ply),
            _ => None,
        }
    }

    /// What the columns x, y, z, radius, red, green and blue are called.
    pub(crate) const fn columns(self) -> [&'static str; 7] {
        match self {
            Self::Csv | Self::Npy => ["x", "y", "z", "radius", "r", "g", "b"],
            Self::Ply => ["x", "y", "z", "radius", "red", "green", "blue"],
        }
    }
}

/// What the scene says for rows, or whole tables, that do not say it themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Defaults {
    pub(crate) radius: Option<f64>,
    pub(crate) color: Option<[f64; 3]>,
}

/// Why a table is not read.
#[derive(Debug)]
pub(crate) enum ReadError {
    /// The disk.
    Io(io::Error),
    /// What stands in the file.
    Invalid(Fault),
}

/// What is wrong with a table: one line, lower case, without a full stop.
#[derive(Debug, PartialEq)]
pub(crate) struct Fault {
    pub(crate) message: String,
    pub(crate) help: Option<String>,
}

impl Fault {
    fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: None,
        }
    }

    fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
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

/// The place of a cell as a message begins with it. Rows count from 0, as every index does; lines
/// of a text from 1, as editors do.
pub(crate) fn cell(row: usize, line: Option<u64>, column: &str) -> String {
    let line = line.map_or_else(String::new, |line| format!(" (line {line})"));
    format!("row {row}{line}, column {}", quote(column))
}

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number that `bytes` begin with; each of these types fits into an f64 exactly.
    #[inline(always)]
    fn number(self, bytes: &[u8], endian: Endian) -> Option<f64> {
        macro_rules! number {
            ($type:ty) => {{
                let bytes = *bytes.first_chunk()?;
                f64::from(match endian {
                    Endian::Little => <$type>::from_le_bytes(bytes),
                    Endian::Big => <$type>::from_be_bytes(bytes),
                })
            }};
        }
        Some(match self {
            Self::I8 => number!(i8),
            Self::U8 => number!(u8),
            Self::I16 => number!(i16),
            Self::U16 => number!(u16),
            Self::I32 => number!(i32),
            Self::U32 => number!(u32),
            Self::F32 => number!(f32),
            Self::F64 => number!(f64),
        })
    }
}

/// The order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Endian {
    Little,
    Big,
}

/// Where the numbers of a column are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Column {
    /// In the bytes of the table.
    Stored {
        scalar: Scalar,
        endian: Endian,
        /// The place of the first number.
        start: usize,
        /// From one number to the next.
        step: usize,
        /// What the numbers are divided by.
        divisor: f64,
    },
    /// One number for all rows.
    Constant(f64),
}

/// Spheres in rows; a copy of it shares the bytes.
#[derive(Clone)]
pub(crate) struct Table {
    bytes: Arc<Vec<u8>>,
    rows: usize,
    /// x, y, z.
    center: [Column; 3],
    /// `None` where neither the table nor the scene says it.
    radius: Option<Column>,
    /// `None` where neither the table nor the scene says it.
    color: Option<[Column; 3]>,
    /// The rows that leave their radius or color empty: what is stored there are the defaults.
    empty: Arc<Empty>,
    /// The line of the first row, in a text in which every row has a line of its own.
    first_line: Option<u64>,
}

/// Rows of a table that leave something empty.
#[derive(Clone, Default)]
struct Empty {
    radius: Vec<usize>,
    color: Vec<usize>,
}

impl fmt::Debug for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Table").field("rows", &self.rows).finish()
    }
}

/// How many rows are decoded at once: few enough that they stay in the nearest cache.
const BLOCK: usize = 512;

/// Some rows of a table, decoded: each column by itself.
pub(crate) struct Block {
    /// The index of the first row.
    pub(crate) first: usize,
    pub(crate) center: [Vec<f64>; 3],
    pub(crate) radius: Vec<f64>,
    pub(crate) color: [Vec<f64>; 3],
}

impl Block {
    /// Center, radius and color of each row.
    pub(crate) fn spheres(&self) -> impl Iterator<Item = ([f64; 3], f64, [f64; 3])> {
        let [x, y, z] = &self.center;
        let [r, g, b] = &self.color;
        let centers = x.iter().zip(y).zip(z).map(|((x, y), z)| [*x, *y, *z]);
        let colors = r.iter().zip(g).zip(b).map(|((r, g), b)| [*r, *g, *b]);
        let rows = centers.zip(&self.radius).zip(colors);
        rows.map(|((center, radius), color)| (center, *radius, color))
    }
}

impl Table {
    /// Reads a table of `length` bytes; nothing larger is asked of the memory before the file is
    /// known to be as large.
    pub(crate) fn read(
        reader: impl Read,
        length: u64,
        format: Format,
        defaults: &Defaults,
    ) -> Result<Self, ReadError> {
        if length == 0 {
            return Err(Fault::new("the file is empty").into());
        }
        match format {
            Format::Csv => csv::read(reader, length, defaults),
            Format::Npy => npy::read(reader, length, defaults),
            Format::Ply => ply::read(reader, length, defaults),
        }
    }

    /// How many rows there are.
    pub(crate) const fn rows(&self) -> usize {
        self.rows
    }

    /// The line that a row stands in, where that is known.
    pub(crate) fn line(&self, row: usize) -> Option<u64> {
        self.first_line.map(|first| first + row as u64)
    }

    /// Takes other defaults than those that the table has been read with.
    pub(crate) fn set_defaults(&mut self, defaults: &Defaults) {
        if let (Some(Column::Constant(radius)), Some(given)) = (&mut self.radius, defaults.radius) {
            *radius = given;
        }
        let color = self.color.iter_mut().flatten();
        for (column, given) in color.zip(defaults.color.into_iter().flatten()) {
            if let Column::Constant(channel) = column {
                *channel = given;
            }
        }
        let empty = Arc::clone(&self.empty);
        if let (Some(radius), Some(given)) = (self.radius, defaults.radius) {
            self.store(radius, &empty.radius, given);
        }
        if let (Some(color), Some(given)) = (self.color, defaults.color) {
            for (channel, given) in color.into_iter().zip(given) {
                self.store(channel, &empty.color, given);
            }
        }
    }

    /// Stores a number in some rows of a column of f64.
    fn store(&mut self, column: Column, rows: &[usize], number: f64) {
        let Column::Stored { start, step, .. } = column else {
            return;
        };
        if rows.is_empty() {
            return;
        }
        let bytes = Arc::make_mut(&mut self.bytes);
        for row in rows {
            let at = start + row * step;
            if let Some(cell) = bytes.get_mut(at..at + Scalar::F64.size()) {
                cell.copy_from_slice(&number.to_le_bytes());
            }
        }
    }

    /// Whether a radius is given, by the table or by the scene.
    pub(crate) const fn has_radius(&self) -> bool {
        self.radius.is_some()
    }

    /// Whether a color is given, by the table or by the scene.
    pub(crate) const fn has_color(&self) -> bool {
        self.color.is_some()
    }

    /// Calls `each` for all rows in their order, a block at a time. What is not given is 0.
    pub(crate) fn each_block(&self, mut each: impl FnMut(&Block)) {
        self.any_block(|block| {
            each(block);
            false
        });
    }

    /// Whether `is_it` says so of any block; those behind it are not decoded.
    pub(crate) fn any_block(&self, mut is_it: impl FnMut(&Block) -> bool) -> bool {
        let column = || Vec::with_capacity(BLOCK.min(self.rows));
        let mut block = Block {
            first: 0,
            center: [column(), column(), column()],
            radius: column(),
            color: [column(), column(), column()],
        };
        let missing = Column::Constant(0.0);
        let radius = self.radius.unwrap_or(missing);
        let color = self.color.unwrap_or([missing; 3]);
        while block.first < self.rows {
            let rows = block.first..self.rows.min(block.first + BLOCK);
            for (column, numbers) in self.center.iter().zip(&mut block.center) {
                self.decode(*column, &rows, numbers);
            }
            self.decode(radius, &rows, &mut block.radius);
            for (column, numbers) in color.iter().zip(&mut block.color) {
                self.decode(*column, &rows, numbers);
            }
            if is_it(&block) {
                return true;
            }
            block.first = rows.end;
        }
        false
    }

    /// The numbers of a column.
    fn decode(&self, column: Column, rows: &Range<usize>, numbers: &mut Vec<f64>) {
        numbers.clear();
        let (scalar, endian, start, step, divisor) = match column {
            Column::Constant(number) => return numbers.resize(rows.len(), number),
            Column::Stored {
                scalar,
                endian,
                start,
                step,
                divisor,
            } => (scalar, endian, start, step, divisor),
        };
        let start = start + rows.start * step;
        let bytes = self.bytes.get(start..).unwrap_or_default();
        let cells = bytes.chunks_exact(step).take(rows.len());
        // The type and the order are constants to each of these loops.
        macro_rules! decode {
            ($scalar:ident) => {{
                let number =
                    |cell, endian| Scalar::$scalar.number(cell, endian).unwrap_or_default();
                match endian {
                    Endian::Little => {
                        numbers.extend(cells.map(|cell| number(cell, Endian::Little)))
                    }
                    Endian::Big => numbers.extend(cells.map(|cell| number(cell, Endian::Big))),
                }
                // Behind the last cell of the table there need not be as much as between two.
                if numbers.len() < rows.len() {
                    let last = bytes.get(numbers.len() * step..).unwrap_or_default();
                    numbers.push(number(last, endian));
                }
            }};
        }
        match scalar {
            Scalar::I8 => decode!(I8),
            Scalar::U8 => decode!(U8),
            Scalar::I16 => decode!(I16),
            Scalar::U16 => decode!(U16),
            Scalar::I32 => decode!(I32),
            Scalar::U32 => decode!(U32),
            Scalar::F32 => decode!(F32),
            Scalar::F64 => decode!(F64),
        }
        if divisor != 1.0 {
            numbers.iter_mut().for_each(|number| *number /= divisor);
        }
    }
}

/// The rows of a table that is not kept as it is, such as a text: f64, one row after another.
struct Rows {
    bytes: Vec<u8>,
    rows: usize,
    empty: Empty,
    first_line: Option<u64>,
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
            first_line: None,
        }
    }

    /// Adds a row; each has as many numbers.
    fn push(&mut self, numbers: &[f64], line: Option<u64>) -> io::Result<()> {
        if self.rows == 0 {
            self.first_line = line;
        }
        // Where lines are skipped, a row does not tell its line any more.
        self.first_line = self
            .first_line
            .filter(|first| Some(first + self.rows as u64) == line);
        let size = numbers.len() * Scalar::F64.size();
        if self.bytes.capacity() - self.bytes.len() < size {
            // More rows than the memory holds are an error and no abort.
            self.bytes.try_reserve(self.bytes.len().max(1 << 16))?;
        }
        for number in numbers {
            self.bytes.extend_from_slice(&number.to_le_bytes());
        }
        self.rows += 1;
        Ok(())
    }

    /// The table of these rows: x, y and z, then the radius and the color where they are stored.
    fn into_table(self, has_radius: bool, has_color: bool, defaults: &Defaults) -> Table {
        let count = 3 + usize::from(has_radius) + 3 * usize::from(has_color);
        let column = |index: usize| Column::Stored {
            scalar: Scalar::F64,
            endian: Endian::Little,
            start: index * Scalar::F64.size(),
            step: count * Scalar::F64.size(),
            divisor: 1.0,
        };
        Table {
            bytes: self.bytes.into(),
            rows: self.rows,
            empty: self.empty.into(),
            center: [0, 1, 2].map(column),
            radius: has_radius.then(|| column(3)).or_else(|| defaults.radius()),
            color: has_color
                .then(|| [3, 2, 1].map(|back| column(count - back)))
                .or_else(|| defaults.color()),
            first_line: self.first_line,
        }
    }
}

impl Defaults {
    fn radius(&self) -> Option<Column> {
        self.radius.map(Column::Constant)
    }

    fn color(&self) -> Option<[Column; 3]> {
        self.color.map(|color| color.map(Column::Constant))
    }
}

/// Reads exactly `length` bytes, which the file is known to have.
fn read_bytes(reader: impl Read, length: usize) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length).map_err(io::Error::from)?;
    reader.take(length as u64).read_to_end(&mut bytes)?;
    if bytes.len() < length {
        return Err(Fault::new("the file became shorter while it was read").into());
    }
    Ok(bytes)
}
