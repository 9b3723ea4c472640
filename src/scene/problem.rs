//! Problems of a model, not yet located in the text.

use std::{collections::BTreeMap, mem, ops::Range};

use crate::{
    data::fault::Spot,
    diagnostic::{Code, Diagnostic, Fix, Label, Severity, path::Path},
    text::{
        nearest::{nearest, quote},
        syntax::Fault,
    },
};

/// Counts faults by code, so that only a limited number of each code is kept: a file may have one
/// in every other byte.
#[derive(Debug)]
pub(crate) struct Tally {
    most: usize,
    /// The number of kept faults of each code, and the number of others.
    counts: BTreeMap<Code, (usize, usize)>,
}

impl Tally {
    /// Creates a tally that keeps this many of each code, at least one.
    pub(crate) fn new(most: usize) -> Self {
        Self {
            most: most.max(1),
            counts: BTreeMap::new(),
        }
    }

    /// Counts a fault. Returns true if it is kept.
    pub(crate) fn keeps(&mut self, code: Code) -> bool {
        let (kept, more) = self.counts.entry(code).or_default();
        let keeps = *kept < self.most;
        *(if keeps { kept } else { more }) += 1;
        keeps
    }

    /// Counts a fault if no more of its code are kept. Returns true if it was counted.
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

    /// Returns the number of faults of each code that are not kept.
    pub(crate) fn more(&self) -> impl Iterator<Item = (Code, usize)> {
        self.counts.iter().map(|(code, (_, more))| (*code, *more))
    }
}

/// The part of a value that a problem points at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Focus {
    /// The value.
    Value,
    /// The key before the value.
    Key,
    /// The name of the value's variant.
    Name,
    /// The opening bracket of the struct that lacks the value.
    Bracket,
    /// The value in a variant.
    Content,
}

/// The fix of a problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Cure {
    /// Replaces the value.
    Write(String),
    /// Replaces the tuple around the value.
    WriteAround(String),
    /// Removes the value.
    Remove,
    /// Exchanges the values of each pair.
    Exchange(Vec<[Path; 2]>),
}

/// A [`Diagnostic`] that is not yet located in the text: in place of ranges it has paths.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Problem {
    /// The diagnostic without its range, its fix and its labels.
    pub(crate) diagnostic: Diagnostic,
    pub(crate) focus: Focus,
    /// The fix, if it is certain.
    pub(crate) cure: Option<Cure>,
    pub(crate) labels: Vec<(Path, Focus, String)>,
    /// True if the message ends with the value as written.
    pub(crate) shows_value: bool,
    /// The place in the file that the scene names, if it is a text, and the message without its name.
    pub(crate) in_file: Option<Box<(Spot, String)>>,
}

impl Problem {
    pub(crate) fn new(code: Code, path: Path, focus: Focus, message: impl Into<String>) -> Self {
        Self {
            diagnostic: Diagnostic::new(code, 0..0, message).with_path(path),
            focus,
            cure: None,
            labels: Vec::new(),
            shows_value: false,
            in_file: None,
        }
    }

    /// Creates the problem of a field of a thing, with the path from there.
    pub(crate) fn of_field(code: Code, field: &'static str, message: impl Into<String>) -> Self {
        Self::new(code, Path::ROOT.field(field), Focus::Value, message)
    }

    /// Adds a label at another field of the thing.
    pub(crate) fn beside(self, field: &'static str, message: impl Into<String>) -> Self {
        self.label(Path::ROOT.field(field), Focus::Value, message)
    }

    /// Converts the paths from a thing to those from the root, given that of the thing.
    pub(crate) fn inside(mut self, around: &Path) -> Self {
        let labels = self.labels.iter_mut().map(|(path, ..)| path);
        let exchanged = match &mut self.cure {
            Some(Cure::Exchange(pairs)) => pairs.as_flattened_mut(),
            _ => &mut [],
        };
        let paths = labels.chain(exchanged).chain([&mut self.diagnostic.path]);
        paths.for_each(|path| *path = around.join(path.steps()));
        self
    }

    /// Creates a problem whose message ends with the value.
    pub(crate) fn of_value(code: Code, path: Path, message: impl Into<String>) -> Self {
        Self {
            shows_value: true,
            ..Self::new(code, path, Focus::Value, message)
        }
    }

    pub(crate) const fn code(&self) -> Code {
        self.diagnostic.code
    }

    /// Returns true if its code is that of an error.
    pub(crate) fn is_error(&self) -> bool {
        self.code().severity() == Severity::Error
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.diagnostic.help = Some(help.into());
        self
    }

    /// Takes over the help of another fault, if it has one.
    pub(crate) fn help_of(mut self, help: Option<String>) -> Self {
        self.diagnostic.help = help;
        self
    }

    /// Adds the known name that is probably meant, if there is one, as the help and the fix.
    pub(crate) fn meaning(mut self, name: &str, known: &[&str]) -> Self {
        self.diagnostic = self.diagnostic.meaning(name, known);
        match nearest(name, known) {
            Some(meant) => self.cure(Cure::Write(serde_json::Value::from(meant).to_string())),
            None => self,
        }
    }

    pub(crate) fn cure(mut self, cure: impl Into<Option<Cure>>) -> Self {
        self.cure = cure.into();
        self
    }

    pub(crate) fn label(mut self, path: Path, focus: Focus, message: impl Into<String>) -> Self {
        self.labels.push((path, focus, message.into()));
        self
    }

    /// Returns the diagnostic at a range of the text; `locate` finds the places of the labels.
    pub(crate) fn placed(
        self,
        mut range: Range<usize>,
        text: &str,
        locate: impl Fn(&Path, Focus) -> Option<Range<usize>>,
    ) -> Diagnostic {
        let mut labels: Vec<(Path, Label)> = Vec::new();
        for (path, focus, message) in self.labels {
            if let Some(range) = locate(&path, focus) {
                labels.push((path, Label { range, message }));
            }
        }
        let mut placed = self.diagnostic;
        // Only the text determines which of the two keys comes later.
        if matches!(placed.code, Code::GazeOrLookAt | Code::OneOf)
            && let Some((path, label)) = labels.first_mut()
            && label.range.start > range.start
        {
            mem::swap(&mut label.range, &mut range);
            mem::swap(path, &mut placed.path);
        }
        if self.shows_value {
            // As written: 1e999 has become infinite, and 5e-324 would have 324 digits.
            let source = text.get(range.clone()).unwrap_or_default();
            placed.message = format!("{}, found {}", placed.message, quote(source));
        }
        Diagnostic {
            range,
            labels: labels.into_iter().map(|(_, label)| label).collect(),
            ..placed
        }
    }
}

/// Converts a syntax fault of the tree to a diagnostic.
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

#[cfg(test)]
mod tests {
    use crate::{scene::document::Document, text::syntax::Syntax};

    #[test]
    fn of_two_fields_the_later_one_is_at_fault() {
        let sphere = |fields: &str| {
            format!("(camera: Fit(), geometries: [Sphere(center: (0, 0, 0), radius: 1, {fields})])")
        };
        let camera = |fields: &str| {
            format!("(camera: Orthographic(eye: (0, 0, 9), scale: 1, {fields}), geometries: [])")
        };
        let (color, material) = ("color: \"#fff\"", "material: Matte(color: \"#f00\")");
        let (gaze, look_at) = ("gaze: (0, 0, -1)", "look_at: (0, 0, 0)");
        for (text, expected) in [
            (sphere(&format!("{color}, {material}")), "material"),
            (sphere(&format!("{material}, {color}")), "color"),
            (camera(&format!("{gaze}, {look_at}")), "look_at"),
            (camera(&format!("{look_at}, {gaze}")), "gaze"),
        ] {
            let document = Document::from_text("a.ron", &*text, Syntax::Ron);
            let fault = &document.diagnostics()[0];
            assert_eq!(&text[fault.range.clone()], expected, "{text}");
            let path = fault.path.to_string();
            assert_eq!(path.rsplit_once('.').map(|(_, last)| last), Some(expected));
        }
    }
}
