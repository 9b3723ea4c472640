//! Syntax faults, and the list that limits their number.

use std::ops::Range;

use super::tree::NodeId;
use crate::text::edit::Edit;

/// One syntax fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    /// Its range, see [the module](super); empty only at the end of the text.
    pub(crate) range: Range<usize>,
    /// The message, one line: what was expected and what was found.
    pub(crate) message: String,
    /// The suggested fix, in words.
    pub(crate) help: Option<String>,
    /// A second range and its relation to the fault.
    pub(crate) label: Option<(Range<usize>, String)>,
    /// The fix as edits, if it is certain.
    pub(crate) fix: Vec<Edit>,
    /// The first value of a variant whose values lack the names of their fields, if that is the fault.
    pub(crate) nameless: Option<NodeId>,
    /// True if only a value is broken: an error node stands for it, and all else is in the tree.
    pub(crate) is_of_value: bool,
    /// The habit, if the fault occurs throughout the file.
    pub(super) habit: Option<Habit>,
}

/// Adds edits to a fault if it was recorded.
pub(super) fn cure(fault: Option<&mut Fault>, edits: impl IntoIterator<Item = Edit>) {
    if let Some(fault) = fault {
        fault.fix.extend(edits);
    }
}

/// Returns the maximum number of faults of a text with this many bytes. A file of another format has
/// countless faults, and each may take 2 KB of memory.
pub(crate) fn max_faults(length: usize) -> usize {
    (length / 512).max(1000)
}

/// Maximum number of edits per fault; the rest is reported once these are applied.
const MAX_EDITS: usize = 10_000;

/// A habit carried over from another syntax. It occurs throughout a file, so it is reported once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Habit {
    Comment = 1,
    UnquotedKey = 2,
    SingleQuotes = 4,
    QuotedField = 8,
    OddSpace = 16,
    Ron = 32,
}

/// The faults found so far.
pub(super) struct Faults {
    list: Vec<Fault>,
    max: usize,
    reported: u8,
    /// Set once the following text can no longer be judged.
    quiet: bool,
}

/// A state to return to after looking ahead.
#[derive(Clone, Copy)]
pub(super) struct Mark(usize, u8, bool);

impl Faults {
    /// Creates an empty list for a text with this many bytes.
    pub(super) fn new(length: usize) -> Self {
        Self {
            list: Vec::new(),
            max: max_faults(length),
            reported: 0,
            quiet: false,
        }
    }

    /// Adds a fault, unless the last one is about the same start.
    pub(crate) fn add(
        &mut self,
        range: Range<u32>,
        message: String,
        help: &str,
    ) -> Option<&mut Fault> {
        self.add_labelled(range, message, help.to_owned(), None)
    }

    pub(crate) fn add_labelled(
        &mut self,
        range: Range<u32>,
        message: String,
        help: String,
        label: Option<(Range<u32>, &str)>,
    ) -> Option<&mut Fault> {
        if self.quiet || self.list.len() >= self.max || self.ends_at(range.start) {
            return None;
        }
        self.list.push(Fault {
            range: range.start as usize..range.end as usize,
            message,
            help: (!help.is_empty()).then_some(help),
            label: label.map(|(r, l)| (r.start as usize..r.end as usize, l.to_owned())),
            fix: Vec::new(),
            nameless: None,
            is_of_value: false,
            habit: None,
        });
        self.list.last_mut()
    }

    /// Notes that only a value is broken, by the start of its fault.
    pub(crate) fn blame_value(&mut self, start: u32) {
        let start = start as usize;
        let last = self.list.iter_mut().rev();
        let mut last = last.take_while(|fault| fault.range.start >= start);
        if let Some(fault) = last.find(|fault| fault.range.start == start) {
            fault.is_of_value = true;
        }
    }

    /// Returns true if the last fault or its label starts at an offset.
    pub(crate) fn ends_at(&self, start: u32) -> bool {
        self.list.last().is_some_and(|last| {
            let label = last.label.as_ref().map(|(label, _)| label.start);
            last.range.start == start as usize || label == Some(start as usize)
        })
    }

    /// Adds a fault that occurs throughout the file once, and its fix at every occurrence.
    pub(crate) fn add_once(
        &mut self,
        habit: Habit,
        range: Range<u32>,
        message: String,
        help: &str,
        fix: impl IntoIterator<Item = Edit>,
    ) {
        // RON in a JSON file has been reported; it includes all other habits.
        if self.reported(Habit::Ron) {
            return;
        }
        let fault = if self.reported(habit) {
            self.list
                .iter_mut()
                .find(|fault| fault.habit == Some(habit))
        } else {
            self.reported |= habit as u8;
            self.add(range, message, help)
        };
        if let Some(fault) = fault {
            fault.habit = Some(habit);
            if fault.fix.len() < MAX_EDITS {
                fault.fix.extend(fix);
            }
        }
    }

    pub(crate) fn reported(&self, habit: Habit) -> bool {
        self.reported & habit as u8 != 0
    }

    pub(crate) fn hush(&mut self) {
        self.quiet = true;
    }

    pub(crate) fn clear(&mut self) {
        self.list.clear();
    }

    pub(crate) fn mark(&self) -> Mark {
        Mark(self.list.len(), self.reported, self.quiet)
    }

    pub(crate) fn reset(&mut self, mark: Mark) {
        self.list.truncate(mark.0);
        (self.reported, self.quiet) = (mark.1, mark.2);
    }

    /// Returns the faults in text order, keeping only the first at each start.
    pub(crate) fn into_sorted(mut self) -> Vec<Fault> {
        self.list.sort_by_key(|fault| fault.range.start);
        self.list.dedup_by_key(|fault| fault.range.start);
        // Lookahead adds edits twice.
        for fault in &mut self.list {
            fault.fix.sort_by_key(|edit| edit.range.start);
            fault.fix.dedup();
        }
        self.list
    }
}
