//! Rows without a point: all of their coordinates are NaN, as depth cameras and the Point Cloud Library
//! write them where nothing was seen.

use std::{io, sync::Arc};

use crate::data::{
    fault::most_listed,
    table::{
        Table,
        check::BadKind,
        kind::RowKind,
        layout::Column,
        request::Defaults,
        rows::{Empty, Rows},
    },
};

/// The rows of a file that are not those of its table.
#[derive(Debug)]
pub(crate) struct LeftOut {
    /// The row in the file of each row of the table.
    kept: Vec<u32>,
    /// The first rows that were left out: as many as are listed.
    pub(crate) listed: Vec<usize>,
    /// The number of rows that were left out.
    pub(crate) count: usize,
}

impl LeftOut {
    /// Returns the row in the file of a row of the table.
    pub(crate) fn row_in_file(&self, row: usize) -> usize {
        self.kept.get(row).map_or(row, |kept| *kept as usize)
    }
}

impl Table {
    /// Leaves out the rows of points whose coordinates are all NaN, unless there are no others.
    pub(super) fn without_missing(self, defaults: &Defaults) -> io::Result<Self> {
        let is_of_x = |kind: BadKind, column: usize| kind == BadKind::NotFinite && column == 0;
        let mut bad = self.bad.iter();
        if self.layout.kind != RowKind::Sphere || !bad.any(|bad| is_of_x(bad.kind, bad.column)) {
            return Ok(self);
        }
        let columns = self.layout.columns;
        let has = columns.map(|column| matches!(column, Some(Column::Stored { .. })));
        let (mut rows, mut kept, mut numbers) = (Rows::default(), Vec::new(), Vec::new());
        // Without lines, all rows have the same place.
        let most = self.first_line.map_or(1, |_| most_listed(false));
        let (mut listed, mut count) = (Vec::new(), 0);
        let mut result = Ok(());
        self.any_block(|block| {
            for (at, point) in block.points().enumerate() {
                let row = block.first + at;
                if point.to_array().into_iter().all(f64::is_nan) {
                    if listed.len() < most {
                        listed.push(row);
                    }
                    count += 1;
                    continue;
                }
                let stored = block.columns.iter().zip(has).filter(|(_, has)| *has);
                numbers.clear();
                numbers.extend(stored.filter_map(|(numbers, _)| numbers.get(at)));
                let reserved = kept.try_reserve(1).map_err(io::Error::from);
                if let Err(error) = reserved.and_then(|()| rows.push(&numbers, None)) {
                    result = Err(error);
                    return true;
                }
                // Fits: a table has fewer rows.
                kept.push(row as u32);
            }
            false
        });
        result?;
        if count == 0 || kept.is_empty() || u32::try_from(self.rows()).is_err() {
            return Ok(self);
        }
        let still = |rows: &[usize]| {
            let rows = rows.iter();
            rows.filter_map(|row| kept.binary_search(&(*row as u32)).ok())
                .collect()
        };
        rows.empty = Empty {
            radius: still(&self.empty.radius),
            color: still(&self.empty.color),
        };
        let left_out = LeftOut {
            kept,
            listed,
            count,
        };
        let mut table = rows.into_table(has, self.names, defaults);
        for bad in &mut table.bad {
            bad.row = left_out.row_in_file(bad.row);
        }
        Ok(Self {
            bad_rows: self.bad_rows,
            first_line: self.first_line,
            left_out: Some(Arc::new(left_out)),
            behind: self.behind,
            ..table
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        data::{
            fault::ReadError,
            table::{Format, Request},
        },
        parallel::Pool,
    };

    fn read(text: &str, radius: f64) -> Table {
        let request = Request {
            defaults: Defaults {
                radius: Some(radius),
                color: Some([1.0; 3]),
                ..Defaults::default()
            },
            ..Request::default()
        };
        let length = text.len() as u64;
        let table = Table::read(text.as_bytes(), length, Format::Csv, &request, |_| {
            Pool::Calling
        });
        match table {
            Ok(table) => table,
            Err(ReadError::Invalid(fault)) => panic!("{}", fault.message),
            Err(ReadError::Io(error)) => panic!("{error}"),
        }
    }

    fn radii(table: &Table) -> Vec<f64> {
        let mut radii = Vec::new();
        table.any_block(|block| {
            let [.., radius, _, _, _, _] = &block.columns;
            radii.extend_from_slice(radius);
            false
        });
        radii
    }

    #[test]
    fn rows_without_a_point_are_left_out() {
        let text = "x,y,z,radius\nnan,nan,nan,1\n1,2,3,\nnan,nan,nan,\n4,5,6,3\n7,8,9,\n";
        let mut table = read(text, 2.0);
        assert_eq!(radii(&table), [2.0, 3.0, 2.0]);
        let left_out = table.left_out.clone().unwrap();
        assert_eq!((&*left_out.listed, left_out.count), (&[0, 2][..], 2));
        let rows = [0, 1, 2].map(|row| left_out.row_in_file(row));
        assert_eq!(rows, [1, 3, 4]);
        assert_eq!(table.line(3), Some(5));
        assert!(table.bad.is_empty() && !table.has_every_radius());
        // Empty cells stay empty.
        table.set_defaults(&Defaults {
            radius: Some(5.0),
            ..Defaults::default()
        });
        assert_eq!(radii(&table), [5.0, 3.0, 5.0]);
    }

    #[test]
    fn a_row_with_some_coordinates_is_wrong() {
        let table = read("x,y,z\nnan,nan,nan\n1,2,3\nnan,5,6\n", 1.0);
        let bad = &table.bad;
        assert_eq!((bad.len(), bad[0].row, bad[0].count), (1, 2, 1));
        assert_eq!(table.rows(), 2);
        // Nothing would be left.
        let none = read("x,y,z\nnan,nan,nan\n", 1.0);
        assert_eq!((none.rows(), none.bad.len()), (1, 3));
    }
}
