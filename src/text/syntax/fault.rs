//! Faults, and the list that keeps them few.

use std::ops::Range;

use crate::text::edit::Edit;

/// One syntax fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    /// Its place, see [the module](super); empty at the end of the text and nowhere else.
    pub(crate) range: Range<usize>,
    /// One line: what was expected, what was found.
    pub(crate) message: String,
    /// The cure.
    pub(crate) help: Option<String>,
    /// A second place, and what it has to do with the fault.
    pub(crate) label: Option<(Range<usize>, String)>,
    /// The cure as edits, if it is certain.
    pub(crate) fix: Vec<Edit>,
    /// What runs through the whole file, if that is the fault.
    pub(super) habit: Option<Habit>,
}

/// Adds the cure of a fault, if the fault is told.
pub(super) fn cure(fault: Option<&mut Fault>, edits: impl IntoIterator<Item = Edit>) {
    if let Some(fault) = fault {
        fault.fix.extend(edits);
    }
}

/// Nobody reads more of them, and a large file of another kind has no end of them.
pub(crate) const MAX_FAULTS: usize = 1000;

/// The most edits of one fault; what is left is told once they are made.
const MAX_EDITS: usize = 10_000;

/// What people carry over from another syntax. It runs through a whole file, so it is told once.
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
#[derive(Default)]
pub(super) struct Faults {
    list: Vec<Fault>,
    told: u8,
    /// Set where what follows cannot be judged any more.
    quiet: bool,
}

/// A state to go back to after looking ahead.
#[derive(Clone, Copy)]
pub(super) struct Mark(usize, u8, bool);

impl Faults {
    /// Adds a fault, unless another is told in its place.
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
        if self.quiet
            || self.list.len() >= MAX_FAULTS
            || self
                .list
                .last()
                .is_some_and(|last| last.range.start == range.start as usize)
        {
            return None;
        }
        self.list.push(Fault {
            range: range.start as usize..range.end as usize,
            message,
            help: (!help.is_empty()).then_some(help),
            label: label.map(|(r, l)| (r.start as usize..r.end as usize, l.to_owned())),
            fix: Vec::new(),
            habit: None,
        });
        self.list.last_mut()
    }

    /// Adds a fault that runs through the file, with its cure at each place where it is found.
    pub(crate) fn add_once(
        &mut self,
        habit: Habit,
        range: Range<u32>,
        message: String,
        help: &str,
        fix: impl IntoIterator<Item = Edit>,
    ) {
        // Who writes RON in a JSON file was told so: it has all the other habits as well.
        if self.told(Habit::Ron) {
            return;
        }
        let fault = if self.told(habit) {
            self.list
                .iter_mut()
                .find(|fault| fault.habit == Some(habit))
        } else {
            self.told |= habit as u8;
            self.add(range, message, help)
        };
        if let Some(fault) = fault {
            fault.habit = Some(habit);
            if fault.fix.len() < MAX_EDITS {
                fault.fix.extend(fix);
            }
        }
    }

    pub(crate) fn told(&self, habit: Habit) -> bool {
        self.told & habit as u8 != 0
    }

    pub(crate) fn hush(&mut self) {
        self.quiet = true;
    }

    pub(crate) fn clear(&mut self) {
        self.list.clear();
    }

    pub(crate) fn mark(&self) -> Mark {
        Mark(self.list.len(), self.told, self.quiet)
    }

    pub(crate) fn reset(&mut self, mark: Mark) {
        self.list.truncate(mark.0);
        (self.told, self.quiet) = (mark.1, mark.2);
    }

    /// The list in the order of the text, the first of several at one place.
    pub(crate) fn into_sorted(mut self) -> Vec<Fault> {
        self.list.sort_by_key(|fault| fault.range.start);
        self.list.dedup_by_key(|fault| fault.range.start);
        // What was looked at ahead comes twice.
        for fault in &mut self.list {
            fault.fix.sort_by_key(|edit| edit.range.start);
            fault.fix.dedup();
        }
        self.list
    }
}
