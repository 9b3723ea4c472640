//! The rows of a rectangle of samples, as runs of samples that hit the same geometry.

/// The runs of all rows.
#[derive(Default)]
pub(super) struct Runs {
    runs: Vec<Run>,
    /// The index of the first run of each row, and that behind the last row.
    firsts: Vec<usize>,
}

/// Neighboring samples of a row that hit the same geometry.
#[derive(Clone, Copy)]
struct Run {
    /// The place in the row behind its last sample.
    end: usize,
    id: u32,
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
                    end += run.len();
                    Run { end, id: run[0] }
                }));
        }
        all.firsts.push(all.runs.len());
        all
    }

    /// Calls `see` with the geometry of each run near a place in a row, and the distance to its nearest
    /// sample: below 0 to the left. It goes on in each direction while `see` returns true.
    pub(super) fn around(&self, row: usize, place: usize, mut see: impl FnMut(i64, u32) -> bool) {
        let row = match self.firsts.get(row..row + 2) {
            Some([start, end]) => &self.runs[*start..*end],
            _ => return,
        };
        let own = row.partition_point(|run| run.end <= place);
        let (left, right) = row.split_at(own);
        let apart = |at: usize| at as i64 - place as i64;
        let mut before = left.iter().rev();
        let _ = before.all(|run| see(apart(run.end - 1), run.id));
        let mut start = place;
        let _ = right.iter().all(|run| {
            let is_on = see(apart(start), run.id);
            start = run.end;
            is_on
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_seen_from_near_to_far_on_each_side() {
        let runs = Runs::new(&[[7, 7, 1, 1, 1, 2, 2, 7], [3; 8]].concat(), 8);
        let seen = |row, place, most: i64| {
            let mut seen = Vec::new();
            runs.around(row, place, |apart, id| {
                seen.push((apart, id));
                apart.abs() < most
            });
            seen
        };
        assert_eq!(seen(0, 3, 9), [(-2, 7), (0, 1), (2, 2), (4, 7)]);
        assert_eq!(seen(0, 3, 1), [(-2, 7), (0, 1), (2, 2)]);
        assert_eq!(seen(0, 0, 9), [(0, 7), (2, 1), (5, 2), (7, 7)]);
        assert_eq!(seen(1, 7, 9), [(0, 3)]);
        assert_eq!(seen(2, 0, 9), []);
    }
}
