//! The parts of a text that an excerpt leaves out.

use std::ops::Range;

use crate::diagnostic::{Code, Diagnostic, path::Step};

/// The parts of a text that an [`Excerpt`](super::Excerpt) leaves out. It converts places, and tells
/// what the diagnostics of the excerpt say of the whole text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cuts(Vec<Cut>);

/// A part that was left out.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Cut {
    /// The offset in the excerpt.
    at: usize,
    /// The number of bytes.
    removed: usize,
}

impl Cuts {
    /// Adds a number of bytes behind the others, at an offset in the excerpt.
    pub(super) fn push(&mut self, at: usize, removed: usize) {
        match self.0.last_mut() {
            Some(last) if last.at == at => last.removed += removed,
            _ => self.0.push(Cut { at, removed }),
        }
    }

    /// Returns the offset in the excerpt from which on parts are left out.
    pub(super) fn first(&self) -> usize {
        self.0.first().map_or(usize::MAX, |cut| cut.at)
    }

    /// Returns the offset in the excerpt of one in the whole text.
    pub fn inner(&self, offset: usize) -> usize {
        let mut removed = 0;
        for cut in &self.0 {
            let start = cut.at + removed;
            if offset <= start {
                break;
            }
            removed += cut.removed.min(offset - start);
        }
        offset - removed
    }

    /// Returns the range in the whole text of one in the excerpt.
    pub fn outer(&self, range: &Range<usize>) -> Range<usize> {
        let removed = |is_before: &dyn Fn(usize) -> bool| {
            let cuts = self.0.iter().take_while(|cut| is_before(cut.at));
            cuts.map(|cut| cut.removed).sum::<usize>()
        };
        let start = range.start + removed(&|at| at <= range.start);
        // A range that ends at a cut ends before it.
        let end = range.end + removed(&|at| at < range.end);
        start..end.max(start)
    }

    /// Returns each part: its offset in the excerpt, and its range in the whole text.
    pub(super) fn parts(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        let mut before = 0;
        self.0.iter().map(move |cut| {
            let start = cut.at + before;
            before += cut.removed;
            (cut.at, start..start + cut.removed)
        })
    }

    /// Returns true if an offset of the whole text is in one of the parts.
    pub(super) fn leave_out(&self, offset: usize) -> bool {
        self.parts().any(|(_, part)| part.contains(&offset))
    }

    /// Returns the diagnostics of the whole text as far as the excerpt tells: what is wrong with
    /// single values of it is new. `found` are the diagnostics of the excerpt, and `last` those of
    /// the last check of the whole text, [moved](Diagnostic::moved) with the edits since.
    pub fn diagnostics(&self, found: &[Diagnostic], last: &[Diagnostic]) -> Vec<Diagnostic> {
        let found = found.iter().cloned();
        let found = found.map(|fault| fault.moved(|range| self.outer(range)));
        let mut found: Vec<_> = found.collect();
        // A text with syntax faults has no others, except for those of values.
        let is_alone =
            |fault: &Diagnostic| fault.code == Code::Syntax && fault.path.steps().is_empty();
        if found.iter().any(is_alone) {
            return found;
        }
        found.retain(|fault| !depends_on_others(fault));
        let is_left_out = |fault: &&Diagnostic| self.leave_out(fault.range.start);
        let last = last.iter();
        let last = last.filter(|fault| depends_on_others(fault) || is_left_out(fault));
        found.extend(last.cloned());
        found.sort_by_key(|fault| (fault.range.start, fault.range.end, fault.code));
        found
    }
}

/// Returns true if geometries that are left out may cause or prevent a fault. A track may name any
/// of them.
fn depends_on_others(fault: &Diagnostic) -> bool {
    let field = fault.path.steps().first().and_then(Step::name);
    fault.code.depends_on_others() || field == Some("animation")
}
