//! What is wrong with a model, before anybody knows where in the text that is.

use std::{collections::BTreeMap, mem, ops::Range};

use crate::{
    diagnostic::{Code, Diagnostic, Fix, Label, path::Path},
    text::{nearest::quote, syntax::Fault},
};

/// Counts faults by their codes, so that of each code only so many are kept: a file may have one in
/// every other byte.
#[derive(Debug)]
pub(crate) struct Tally {
    most: usize,
    /// How many of each code are kept, and how many are not.
    counts: BTreeMap<Code, (usize, usize)>,
}

impl Tally {
    /// Keeps so many of each code, and at least one.
    pub(crate) fn new(most: usize) -> Self {
        Self {
            most: most.max(1),
            counts: BTreeMap::new(),
        }
    }

    /// Counts a fault; whether it is kept.
    pub(crate) fn keeps(&mut self, code: Code) -> bool {
        let (kept, more) = self.counts.entry(code).or_default();
        let keeps = *kept < self.most;
        *(if keeps { kept } else { more }) += 1;
        keeps
    }

    /// Whether a fault is only counted, as there are enough of its code: then it is.
    pub(crate) fn only_counts(&mut self, code: Code) -> bool {
        let most = self.most;
        let count = self.counts.get_mut(&code);
        count.is_some_and(|(kept, more)| {
            let is_full = *kept == most;
            *more += usize::from(is_full);
            is_full
        })
    }

    /// Counts faults that are not kept.
    pub(crate) fn pass(&mut self, code: Code, count: usize) {
        self.counts.entry(code).or_default().1 += count;
    }

    /// How many of each code are not kept.
    pub(crate) fn more(&self) -> impl Iterator<Item = (Code, usize)> {
        self.counts.iter().map(|(code, (_, more))| (*code, *more))
    }
}

/// What the place of a problem points at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Focus {
    /// The value.
    Value,
    /// The key in front of the value.
    Key,
    /// The name of the variant that the value is.
    Name,
    /// The bracket that opens the struct around the value, which is not there.
    Bracket,
}

/// A place in a scene, before anybody knows where in the text it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) path: Path,
    pub(crate) focus: Focus,
}

/// The cure of a problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Cure {
    /// Something else in the place of the value.
    Write(String),
    /// Something else in the place of the tuple around the value.
    WriteAround(String),
    /// Nothing in the place of the value.
    Remove,
}

/// A [`crate::diagnostic::Diagnostic`] without its place in the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Problem {
    pub(crate) code: Code,
    pub(crate) place: Place,
    pub(crate) message: String,
    pub(crate) help: Option<String>,
    /// The cure, if it is certain.
    pub(crate) cure: Option<Cure>,
    pub(crate) labels: Vec<(Place, String)>,
    /// Whether the message is to end with the value as it is written.
    pub(crate) shows_value: bool,
}

impl Problem {
    pub(crate) fn new(code: Code, path: Path, focus: Focus, message: impl Into<String>) -> Self {
        Self {
            code,
            place: Place { path, focus },
            message: message.into(),
            help: None,
            cure: None,
            labels: Vec::new(),
            shows_value: false,
        }
    }

    /// A problem of a value that the message ends with.
    pub(crate) fn of_value(code: Code, path: Path, message: impl Into<String>) -> Self {
        Self {
            shows_value: true,
            ..Self::new(code, path, Focus::Value, message)
        }
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    pub(crate) fn cure(mut self, cure: impl Into<Option<Cure>>) -> Self {
        self.cure = cure.into();
        self
    }

    pub(crate) fn label(mut self, path: Path, focus: Focus, message: impl Into<String>) -> Self {
        self.labels.push((Place { path, focus }, message.into()));
        self
    }
    /// With its place in a text; `locate` finds others in the same text.
    pub(crate) fn placed(
        self,
        mut range: Range<usize>,
        text: &str,
        locate: impl Fn(&Place) -> Option<Range<usize>>,
    ) -> Diagnostic {
        let mut labels: Vec<Label> = Vec::new();
        for (place, message) in self.labels {
            if let Some(range) = locate(&place) {
                labels.push(Label { range, message });
            }
        }
        // Which of two keys is the later one only the text knows.
        if self.code == Code::GazeOrLookAt
            && let Some(label) = labels.first_mut()
            && label.range.start > range.start
        {
            mem::swap(&mut label.range, &mut range);
        }
        let mut message = self.message;
        if self.shows_value {
            // As it is written: 1e999 has become infinite, and 5e-324 would have 324 digits.
            let source = text.get(range.clone()).unwrap_or_default();
            message = format!("{message}, found {}", quote(source));
        }
        Diagnostic {
            severity: self.code.severity(),
            code: self.code,
            range,
            message,
            help: self.help,
            fix: None,
            path: self.place.path,
            labels,
        }
    }
}

/// A fault that the tree of a text has.
pub(crate) fn syntax_fault(fault: &Fault) -> Diagnostic {
    let mut diagnostic = Diagnostic::new(Code::Syntax, fault.range.clone(), &*fault.message);
    diagnostic.help.clone_from(&fault.help);
    if !fault.fix.is_empty() {
        diagnostic.fix = Some(Fix::safe(&*fault.fix));
    }
    match &fault.label {
        Some((range, message)) => diagnostic.with_label(range.clone(), &**message),
        None => diagnostic,
    }
}
