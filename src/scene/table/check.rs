//! Checks the numbers of a table in one pass; each fault is reported once per column.

use std::ops::RangeInclusive;

use crate::scene::table::{
    extent::Extent,
    layout::{Block, Column, Layout, RADIUS, VALUE},
    values::Values,
};

/// A fault of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    NotFinite,
    NotAboveZero,
    Clamped,
}

/// Numbers of a column that have the same fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bad {
    pub(crate) kind: Kind,
    /// The column, from 0, among x, y, z, radius, red, green and blue.
    pub(crate) column: usize,
    /// The first row, followed by its value.
    pub(crate) row: usize,
    pub(crate) value: f64,
    /// The total number of such rows.
    pub(crate) count: usize,
}

/// Checks the rows of a table, each once.
pub(super) struct Check {
    pub(super) layout: Layout,
    /// The last rows checked.
    block: Block,
    pub(super) found: Vec<Bad>,
    pub(super) extent: Extent,
    pub(super) values: Values,
}

impl Check {
    pub(super) const fn new(layout: Layout) -> Self {
        Self {
            layout,
            block: Block::new(),
            found: Vec::new(),
            extent: Extent::NONE,
            values: Values::NONE,
        }
    }

    /// Checks the new rows that are complete in `bytes`, which are all the bytes of the table or
    /// the first of them.
    pub(super) fn look(&mut self, bytes: &[u8]) {
        while self.layout.next(bytes, &mut self.block) {
            self.look_at_block();
            self.extent.add(&self.block);
            self.values.add(self.block.values());
        }
    }

    fn look_at_block(&mut self) {
        let Self {
            layout,
            block,
            found,
            ..
        } = self;
        let columns = layout.columns.iter().zip(&block.columns).enumerate();
        for (column, (place, numbers)) in columns {
            if !matches!(place, Some(Column::Stored { .. })) {
                continue;
            }
            let mut look = Look {
                found,
                column,
                first: block.first,
                numbers,
            };
            // One pass finds out if there is anything to report, which is rare.
            match column {
                0..RADIUS if !look.lie_in(f64::MIN..=f64::MAX) => {
                    look.look_for(Kind::NotFinite, |number| !number.is_finite());
                }
                RADIUS if !look.lie_in(SMALLEST..=f64::MAX) => {
                    look.look_for(Kind::NotFinite, |number| !number.is_finite());
                    let is_bad = |number: f64| number.is_finite() && number <= 0.0;
                    look.look_for(Kind::NotAboveZero, is_bad);
                }
                4..VALUE if !look.lie_in(0.0..=1.0) => {
                    look.look_for(Kind::NotFinite, |number| !number.is_finite());
                    let is_channel = |number: f64| (0.0..=1.0).contains(&number);
                    let is_bad = |number: f64| number.is_finite() && !is_channel(number);
                    look.look_for(Kind::Clamped, is_bad);
                }
                _ => {}
            }
        }
    }
}

/// The smallest number above 0.
const SMALLEST: f64 = f64::from_bits(1);

/// The numbers of a column in a block, and the list of their faults.
struct Look<'a> {
    found: &'a mut Vec<Bad>,
    column: usize,
    first: usize,
    numbers: &'a [f64],
}

impl Look<'_> {
    /// Returns true if all numbers are in the range, without a branch for each.
    fn lie_in(&self, range: RangeInclusive<f64>) -> bool {
        let (low, high) = range.into_inner();
        let numbers = self.numbers.iter();
        numbers.fold(true, |all, number| {
            all & (low <= *number) & (*number <= high)
        })
    }

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
