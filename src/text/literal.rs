//! Python literals, limited to those in `NumPy` array headers.

use std::str::Chars;

/// A value in the header.
#[derive(Debug, PartialEq)]
pub(crate) enum Value {
    Text(String),
    Flag(bool),
    Shape(Vec<usize>),
    /// Any other tuple.
    Tuple(Vec<Self>),
    List(Vec<Self>),
}

/// The number of brackets in brackets that are parsed.
const DEEPEST: usize = 16;

/// A parser for the Python literals in array headers.
pub(crate) struct Literal<'a> {
    rest: &'a str,
    /// The number of open brackets.
    depth: usize,
}

impl<'a> Literal<'a> {
    pub(crate) const fn new(text: &'a str) -> Self {
        Self {
            rest: text,
            depth: 0,
        }
    }

    pub(crate) fn is_at_end(&self) -> bool {
        self.rest.trim_ascii().is_empty()
    }

    /// Consumes `piece` and the white space before it; returns false if it does not come next.
    fn take(&mut self, piece: &str) -> bool {
        let rest = self.rest.trim_ascii_start().strip_prefix(piece);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    pub(crate) fn dictionary(&mut self) -> Option<Vec<(String, Value)>> {
        let mut entries = Vec::new();
        if !self.take("{") {
            return None;
        }
        while !self.take("}") {
            let key = self.text()?;
            if !self.take(":") || entries.iter().any(|(other, _)| *other == key) {
                return None;
            }
            entries.push((key, self.value()?));
            if !self.take(",") {
                return self.take("}").then_some(entries);
            }
        }
        Some(entries)
    }

    fn value(&mut self) -> Option<Value> {
        if self.take("True") {
            return Some(Value::Flag(true));
        }
        if self.take("False") {
            return Some(Value::Flag(false));
        }
        if self.take("(") {
            let rest = self.rest;
            if let Some(shape) = self.shape() {
                return Some(Value::Shape(shape));
            }
            self.rest = rest;
            return self.values(")").map(Value::Tuple);
        }
        if self.take("[") {
            return self.values("]").map(Value::List);
        }
        self.text().map(Value::Text)
    }

    /// Parses a quoted string with the escapes that Python writes.
    fn text(&mut self) -> Option<String> {
        let mut letters = self.rest.trim_ascii_start().chars();
        let quote = letters.next().filter(|quote| matches!(quote, '\'' | '"'))?;
        let mut text = String::new();
        loop {
            let letter = letters.next()?;
            text.push(match letter {
                '\\' => escaped(&mut letters)?,
                letter if letter == quote => break,
                letter => letter,
            });
        }
        self.rest = letters.as_str();
        Some(text)
    }

    /// Parses the rest of a tuple of integers.
    fn shape(&mut self) -> Option<Vec<usize>> {
        let mut shape = Vec::new();
        while !self.take(")") {
            shape.push(self.digits()?.parse().ok()?);
            // Python 2 wrote long integers with an `L` suffix.
            self.take("L");
            if !self.take(",") {
                return self.take(")").then_some(shape);
            }
        }
        Some(shape)
    }

    fn digits(&mut self) -> Option<&'a str> {
        let rest = self.rest.trim_ascii_start();
        let end = rest
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(rest.len());
        let (digits, rest) = rest.split_at_checked(end)?;
        self.rest = rest;
        Some(digits)
    }

    /// Parses the rest of a tuple or a list.
    fn values(&mut self, end: &str) -> Option<Vec<Value>> {
        let mut values = Vec::new();
        self.depth += 1;
        while self.depth <= DEEPEST && !self.take(end) {
            values.push(self.value()?);
            if !self.take(",") && !self.rest.trim_ascii_start().starts_with(end) {
                return None;
            }
        }
        self.depth -= 1;
        (self.depth < DEEPEST).then_some(values)
    }
}

/// Parses an escape after its backslash.
fn escaped(letters: &mut Chars<'_>) -> Option<char> {
    let digits = match letters.next()? {
        'n' => return Some('\n'),
        'r' => return Some('\r'),
        't' => return Some('\t'),
        letter @ ('\\' | '\'' | '"') => return Some(letter),
        'x' => 2,
        'u' => 4,
        'U' => 8,
        _ => return None,
    };
    let (code, rest) = letters.as_str().split_at_checked(digits)?;
    *letters = rest.chars();
    char::from_u32(u32::from_str_radix(code, 16).ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_are_those_that_python_writes() {
        for (text, expected) in [
            (r"'a'", Some("a")),
            (r#""it's""#, Some("it's")),
            (r#"'a\'b"'"#, Some("a'b\"")),
            (r"'$\\sigma$'", Some(r"$\sigma$")),
            (
                r"'\t\xb0\u03c3\U0001f600'",
                Some("\t\u{b0}\u{3c3}\u{1f600}"),
            ),
            ("'\u{b0}'", Some("\u{b0}")),
            (r"'\u03c'", None),
            (r"'\q'", None),
            (r"'open\'", None),
        ] {
            let found = Literal::new(text).text();
            assert_eq!(found.as_deref(), expected, "{text}");
        }
    }
}
