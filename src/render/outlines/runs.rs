//! The rows of a rectangle of samples, as runs of samples that hit the same geometry.

use std::ops::Range;

/// The runs of all rows.
#[derive(Default)]
pub(super) struct Runs {
    runs: Vec<Run>,
    /// The index of the first run of each row, and that behind the last row.
    firsts: Vec<usize>,
}

/// Neighboring samples of a row that hit the same geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    start: u32,
    end: u32,
    pub(super) id: u32,
}

impl Run {
    pub(super) const fn columns(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    /// Returns those of some columns that are in the run.
    pub(super) fn part_of(&self, columns: &Range<usize>) -> Range<usize> {
        let own = self.columns();
        own.start.max(columns.start)..own.end.min(columns.end)
    }

    /// Returns those of some columns that are at most this far from a sample of the run.
    pub(super) fn near(&self, most: usize, columns: &Range<usize>) -> Range<usize> {
        let own = self.columns();
        columns.start.max(own.start.saturating_sub(most))..columns.end.min(own.end + most)
    }
}

impl Runs {
    /// Returns the number of bytes that the runs of some samples take at most, while they grow.
    pub(super) const fn bytes(samples: u64) -> u64 {
        samples.saturating_mul(2 * size_of::<Run>() as u64)
    }

    /// Creates the runs of rows of this width.
    pub(super) fn new(ids: &[u32], width: usize) -> Self {
        let mut all = Self::default();
        for row in ids.chunks(width.max(1)) {
            all.firsts.push(all.runs.len());
            let mut end = 0;
            all.runs
                .extend(row.chunk_by(|one, next| one == next).map(|run| {
                    let start = end;
                    end += run.len() as u32;
                    Run {
                        start,
                        end,
                        id: run[0],
                    }
                }));
        }
        all.firsts.push(all.runs.len());
        all
    }

    /// Returns the runs of a row; none outside of the rectangle.
    pub(super) fn row(&self, row: usize) -> &[Run] {
        match self.firsts.get(row..row.saturating_add(2)) {
            Some([start, end]) => &self.runs[*start..*end],
            _ => &[],
        }
    }
}
