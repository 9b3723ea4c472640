//! Checks the numbers of a table in one pass.

use std::ops::RangeInclusive;

use glam::DVec3;

use crate::{
    data::{
        fault::most_listed,
        table::{
            extent::Extent,
            kind::RowKind,
            layout::{Block, COLORS, Column, Layout, OTHER_END, RADIUS, VALUE},
            values::Values,
        },
    },
    tracer::vector::why_no_axis,
};

/// A fault of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BadKind {
    NotFinite,
    NotAboveZero,
    Clamped,
    /// The ends of a cylinder are too close or too far apart, for this reason, or the axis of a copy has
    /// no direction.
    NoAxis(&'static str),
}

/// Numbers of a column that have the same fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bad {
    pub(crate) kind: BadKind,
    /// The column, from 0, among those of `Columns`.
    pub(crate) column: usize,
    /// The first row, followed by its value.
    pub(crate) row: usize,
    pub(crate) value: f64,
    /// The number of such rows that are listed before.
    pub(crate) before: usize,
    /// The number of rows, this one included: of those that are not listed on their own.
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
        if layout.columns[OTHER_END.start].is_some() {
            look_at_ends(layout.kind, block, found);
        }
        let columns = layout.columns.iter().zip(&block.columns).enumerate();
        for (column, (place, numbers)) in columns {
            if !matches!(place, Some(Column::Stored { .. })) {
                continue;
            }
            let (range, other) = match column {
                // Values may be anything, but the angles of copies.
                VALUE if layout.kind != RowKind::Copy => continue,
                RADIUS => (SMALLEST..=f64::MAX, BadKind::NotAboveZero),
                _ if COLORS.contains(&column) => (0.0..=1.0, BadKind::Clamped),
                _ => (f64::MIN..=f64::MAX, BadKind::NotFinite),
            };
            // One pass finds out if there is anything to report, which is rare.
            if lie_in(numbers, &range) {
                continue;
            }
            for wanted in [BadKind::NotFinite, other] {
                for (row, value) in (block.first..).zip(numbers) {
                    let kind = match value.is_finite() {
                        true => other,
                        false => BadKind::NotFinite,
                    };
                    if kind == wanted && !range.contains(value) {
                        note(found, (kind, column), row, *value);
                    }
                }
                if wanted == other {
                    break;
                }
            }
        }
    }
}

/// The smallest number above 0.
const SMALLEST: f64 = f64::from_bits(1);

/// Returns true if all numbers are in the range, without a branch for each.
fn lie_in(numbers: &[f64], range: &RangeInclusive<f64>) -> bool {
    let (low, high) = (*range.start(), *range.end());
    let numbers = numbers.iter();
    numbers.fold(true, |all, number| {
        all & (low <= *number) & (*number <= high)
    })
}

/// Looks for cylinders whose ends are too close or too far apart, and for copies whose axis has no
/// direction.
fn look_at_ends(kind: RowKind, block: &Block, found: &mut Vec<Bad>) {
    let ends = block.points().zip(block.other_ends());
    for (row, (from, to)) in (block.first..).zip(ends) {
        let from = match kind {
            RowKind::Copy => DVec3::ZERO,
            RowKind::Sphere | RowKind::Cylinder { .. } => from,
        };
        if let Some(why) = why_no_axis([from, to]) {
            let column = OTHER_END.start;
            note(found, (BadKind::NoAxis(why), column), row, to.x);
        }
    }
}

/// Notes a fault: the first of its kind in a column are kept, the others are counted with the last
/// of these.
fn note(found: &mut Vec<Bad>, (kind, column): (BadKind, usize), row: usize, value: f64) {
    let mut all = found.iter_mut();
    let last = all.rfind(|bad| (bad.kind, bad.column) == (kind, column));
    let before = last.as_ref().map_or(0, |bad| bad.before + 1);
    let most = most_listed(kind != BadKind::Clamped);
    match last.filter(|_| before >= most) {
        Some(last) => last.count += 1,
        None => found.push(Bad {
            kind,
            column,
            row,
            value,
            before,
            count: 1,
        }),
    }
}
