//! What may be wrong with the numbers of a table: found in one pass, and told once for a column.

use crate::scene::table::{Column, Table};

/// What is wrong with a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    NotFinite,
    NotAboveZero,
    Clamped,
}

/// Numbers of a column that have the same fault.
#[derive(Debug, PartialEq)]
pub(crate) struct Bad {
    pub(crate) kind: Kind,
    /// Which of the columns x, y, z, radius, red, green and blue, from 0.
    pub(crate) column: usize,
    /// The first row, and what stands there.
    pub(crate) row: usize,
    pub(crate) value: f64,
    /// How many rows there are in all.
    pub(crate) count: usize,
}

impl Table {
    /// What is wrong with the numbers; those that the scene gives for all rows are not looked at.
    pub(crate) fn bad(&self) -> Vec<Bad> {
        let is_stored = |column: Option<Column>| matches!(column, Some(Column::Stored { .. }));
        let has_radius = is_stored(self.radius);
        let has_color = is_stored(self.color.map(|[red, ..]| red));
        let mut found = Vec::new();
        self.each_block(|block| {
            let [x, y, z] = &block.center;
            let [r, g, b] = &block.color;
            for (column, numbers) in [x, y, z, &block.radius, r, g, b].into_iter().enumerate() {
                let mut look = Look {
                    found: &mut found,
                    column,
                    first: block.first,
                    numbers,
                };
                let is_positive = |number: f64| number > 0.0 && number < f64::INFINITY;
                let is_channel = |number: f64| (0.0..=1.0).contains(&number);
                // One look finds whether there is anything to tell, which is seldom so.
                match column {
                    0..3 => look.look_for(Kind::NotFinite, |number| !number.is_finite()),
                    3 if has_radius && look.count(|number| !is_positive(number)) > 0 => {
                        look.look_for(Kind::NotFinite, |number| !number.is_finite());
                        let is_bad = |number: f64| number.is_finite() && number <= 0.0;
                        look.look_for(Kind::NotAboveZero, is_bad);
                    }
                    4.. if has_color && look.count(|number| !is_channel(number)) > 0 => {
                        look.look_for(Kind::NotFinite, |number| !number.is_finite());
                        let is_bad = |number: f64| number.is_finite() && !is_channel(number);
                        look.look_for(Kind::Clamped, is_bad);
                    }
                    _ => {}
                }
            }
        });
        found
    }
}

/// The numbers of a column in a block, and where to note what is wrong with them.
struct Look<'a> {
    found: &'a mut Vec<Bad>,
    column: usize,
    first: usize,
    numbers: &'a [f64],
}

impl Look<'_> {
    fn count(&self, is_bad: impl Fn(f64) -> bool) -> usize {
        self.numbers
            .iter()
            .filter(|number| is_bad(**number))
            .count()
    }

    fn look_for(&mut self, kind: Kind, is_bad: impl Fn(f64) -> bool) {
        let count = self.count(&is_bad);
        if count == 0 {
            return;
        }
        let mut all = self.found.iter_mut();
        if let Some(earlier) = all.find(|bad| (bad.kind, bad.column) == (kind, self.column)) {
            earlier.count += count;
            return;
        }
        let mut rows = self.numbers.iter().enumerate();
        if let Some((at, value)) = rows.find(|(_, number)| is_bad(**number)) {
            self.found.push(Bad {
                kind,
                column: self.column,
                row: self.first + at,
                value: *value,
                count,
            });
        }
    }
}
