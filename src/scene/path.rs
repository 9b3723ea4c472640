//! Parser of written paths, with the place of each step.

use std::ops::Range;

use crate::{
    diagnostic::path::Step,
    text::syntax::{Syntax, string},
};

/// A step of a path and its place in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PathPart {
    pub(crate) step: Step,
    pub(crate) range: Range<usize>,
}

impl PathPart {
    /// Returns the name, if the step is one.
    pub(crate) fn name(&self) -> Option<&str> {
        self.step.name()
    }

    /// Returns the index, if the step is one.
    pub(crate) const fn index(&self) -> Option<usize> {
        match self.step {
            Step::Index(index) => Some(index),
            Step::Field(_) | Step::Key(_) => None,
        }
    }
}

/// Returns the steps of a whole path, or the description of the expected token.
pub(crate) fn parts(text: &str) -> Result<Vec<PathPart>, &'static str> {
    match parts_before(text)? {
        (parts, "") => Ok(parts),
        _ => Err("`.` or `[` between the parts of the path"),
    }
}

/// Returns the steps of the path at the start of a text, and the rest of the text.
pub(crate) fn parts_before(text: &str) -> Result<(Vec<PathPart>, &str), &'static str> {
    let mut reader = Reader { text, at: 0 };
    let parts = reader.parts()?;
    Ok((parts, reader.rest()))
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Reader<'t> {
    /// Skips blanks and returns the unread text.
    fn rest(&mut self) -> &'t str {
        let rest = self.text[self.at..].trim_start();
        self.at = self.text.len() - rest.len();
        rest
    }

    /// Consumes a character if it comes next; returns true if it did.
    fn take(&mut self, character: char) -> bool {
        let found = self.rest().starts_with(character);
        self.at += usize::from(found);
        found
    }

    /// Reads up to one of these characters.
    fn until(&mut self, ends: &[char]) -> (&'t str, PathPart) {
        let rest = self.rest();
        let length = rest.find(ends).unwrap_or(rest.len());
        let found = rest[..length].trim_end();
        let range = self.at..self.at + found.len();
        self.at += length;
        let step = Step::Field(found.to_owned().into());
        (found, PathPart { step, range })
    }

    /// Reads names separated by dots, each with its brackets.
    fn parts(&mut self) -> Result<Vec<PathPart>, &'static str> {
        let mut parts = Vec::new();
        loop {
            parts.push(self.name()?);
            while self.take('[') {
                parts.push(self.in_brackets()?);
            }
            if !self.take('.') {
                return Ok(parts);
            }
        }
    }

    fn name(&mut self) -> Result<PathPart, &'static str> {
        match self.until(&['.', '[', '=']) {
            ("", _) => Err("the name of a field"),
            (_, part) => Ok(part),
        }
    }

    /// An index, or a name in quotes.
    fn in_brackets(&mut self) -> Result<PathPart, &'static str> {
        let part = if self.rest().starts_with('"') {
            self.quoted()?
        } else {
            let (digits, part) = self.until(&[']']);
            if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
                return Err("an index or a name in quotes after `[`");
            }
            let Ok(index) = digits.parse() else {
                return Err("a valid index");
            };
            PathPart {
                step: Step::Index(index),
                ..part
            }
        };
        if self.take(']') { Ok(part) } else { Err("`]`") }
    }

    fn quoted(&mut self) -> Result<PathPart, &'static str> {
        let rest = self.rest();
        let mut is_escaped = true;
        let end = rest.find(|character| {
            let ends = character == '"' && !is_escaped;
            is_escaped = character == '\\' && !is_escaped;
            ends
        });
        let source = end.and_then(|end| rest.get(..=end));
        match source.and_then(|source| Some((source, string(source, Syntax::Ron)?))) {
            None => Err("a quote after the name"),
            Some((source, name)) => {
                let range = self.at..self.at + source.len();
                self.at = range.end;
                let step = Step::Key((*name).into());
                Ok(PathPart { step, range })
            }
        }
    }
}
