//! The rows of a table that is read row by row, such as a text.

use std::io;

use crate::data::{
    bytes::Bytes,
    fault::{BadRows, Fault, Wrong},
    table::{
        Table,
        check::Check,
        layout::{Column, Columns, Endian, Layout, Scalar},
        request::Defaults,
        select::Names,
    },
};

/// The rows of a table that is not kept as is, such as a text: f64, row by row.
#[derive(Default)]
pub(super) struct Rows {
    bytes: Vec<u8>,
    pub(super) rows: usize,
    pub(super) empty: Empty,
    bad: Vec<BadRows>,
    /// The line of the first row, if each row has one line.
    pub(super) first_line: Option<u64>,
}

/// The substitute for a number that could not be read: valid as a coordinate, radius or channel, and
/// hardly ever the number of another cell.
const UNREAD: f64 = 0.618_033_988_749_894_9;

/// Returns the substitute for the number in a column: the two ends of a cylinder that could not be read
/// are not the same point.
pub(super) fn unread(column: usize) -> f64 {
    UNREAD / (column + 1) as f64
}

impl Rows {
    /// Notes a fault in the next row. The first such rows are reported, the others are counted with
    /// the last of these. Returns the substitute for the number.
    pub(super) fn note(
        &mut self,
        wrong: Wrong,
        column: &str,
        fault: impl FnOnce() -> Fault,
    ) -> f64 {
        let mut all = self.bad.iter_mut();
        let last = all.rfind(|bad| bad.wrong == wrong && bad.column == column);
        let before = last.as_ref().map_or(0, |bad| bad.before + 1);
        match last.filter(|_| before >= wrong.most_listed()) {
            Some(bad) => bad.count += 1,
            None => self.bad.push(BadRows {
                wrong,
                column: column.to_owned(),
                row: self.rows,
                before,
                fault: fault(),
                count: 1,
            }),
        }
        UNREAD
    }

    /// Adds a row; all rows have equally many numbers.
    pub(super) fn push(&mut self, numbers: &[f64], line: Option<u64>) -> io::Result<()> {
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
    pub(super) fn append(&mut self, bytes: &[u8], rows: usize, empty: &Empty) -> io::Result<()> {
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
    pub(super) fn into_table(self, has: Columns<bool>, names: Names, defaults: &Defaults) -> Table {
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

/// The rows of a table with empty cells.
#[derive(Clone, Default)]
pub(super) struct Empty {
    pub(super) radius: Vec<usize>,
    pub(super) color: Vec<usize>,
}
