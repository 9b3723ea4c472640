//! What the checks find.

use crate::{
    parallel::Cancel,
    scene::problem::{Problem, Tally},
};

/// Collects problems. The functions are called for each of a million values, so paths are built
/// only for faults.
pub(super) struct Found {
    pub(super) list: Vec<Problem>,
    pub(super) tally: Tally,
    /// True if lights may fall on the scene.
    pub(super) is_lit: bool,
    /// True if light may follow paths.
    pub(super) follows_paths: bool,
    pub(super) cancel: Option<Cancel>,
}

impl Found {
    /// Keeps at most this many problems of each code.
    pub(super) fn new(most: usize) -> Self {
        Self {
            list: Vec::new(),
            tally: Tally::new(most),
            is_lit: false,
            follows_paths: false,
            cancel: None,
        }
    }

    /// Returns true if the checks should end. Every long loop asks.
    #[inline]
    pub(super) fn is_cancelled(&self) -> bool {
        self.cancel.as_ref().is_some_and(Cancel::is_cancelled)
    }

    pub(super) fn push(&mut self, problem: Problem) {
        if self.tally.keeps(problem.code()) {
            self.list.push(problem);
        }
    }

    pub(super) fn extend(&mut self, problems: impl IntoIterator<Item = Problem>) {
        for problem in problems {
            self.push(problem);
        }
    }

    pub(super) fn has_errors(&self) -> bool {
        self.list.iter().any(Problem::is_error)
    }
}
