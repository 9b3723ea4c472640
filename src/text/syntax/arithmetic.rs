//! Arithmetic in the place of a number, such as `1/2`: it is not evaluated, but its value is told.

use super::fault::{Habit, cure};
use super::language::Syntax;
use super::lexer::{Lexer, shorten};
use crate::text::edit::Edit;

/// The maximum length of an expression, so that a long line is not scanned at each of its numbers.
const LONGEST: usize = 200;

impl Lexer<'_> {
    /// Returns true if the text from here on may continue a number as arithmetic.
    #[inline]
    pub(super) fn sees_operator(&self) -> bool {
        let blanks = usize::from(self.byte(self.pos) == Some(b' '));
        matches!(
            self.byte(self.pos + blanks),
            Some(b'*' | b'/' | b'+' | b'-')
        )
    }

    /// Consumes and reports the expression that begins at an offset, if there is one.
    #[cold]
    pub(super) fn arithmetic(&mut self, start: usize) -> bool {
        let Some((length, value)) = evaluate(self.rest_of(start, self.text.len())) else {
            return false;
        };
        self.pos = start + length;
        self.cut_off = self.rest().is_empty();
        if self.syntax == Syntax::Json && self.faults.reported(Habit::Ron) {
            return true;
        }
        let source = self.rest_of(start, self.pos);
        let message = format!("expected a number, found `{}`", shorten(source));
        let range = start as u32..self.pos as u32;
        let written = format!("{value:?}");
        let written = written.strip_suffix(".0").unwrap_or(&written);
        if value.is_finite() {
            let help = format!("arithmetic is not evaluated; write `{written}`");
            let fault = self.faults.add(range, message, &help);
            cure(fault, [Edit::replace(start..start + length, written)]);
        } else {
            let help = "arithmetic is not evaluated, and this has no value";
            self.faults.add(range, message, help);
        }
        true
    }
}

/// Evaluates the expression at the start of a text: numbers with at least one of `+`, `-`, `*` and `/`
/// between them. Returns its length and its value.
fn evaluate(text: &str) -> Option<(usize, f64)> {
    let line = text.as_bytes();
    let line = line.get(..LONGEST).unwrap_or(line);
    let (mut end, first) = number(line, 0)?;
    let (mut sum, mut product) = (0.0, first);
    let mut is_one = false;
    while let Some((operator, at)) = operator(line, end) {
        let Some((after, value)) = number(line, at) else {
            break;
        };
        match operator {
            b'*' => product *= value,
            b'/' => product /= value,
            _ => {
                sum += product;
                product = if operator == b'-' { -value } else { value };
            }
        }
        (end, is_one) = (after, true);
    }
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b"_.+-*/^(".contains(byte);
    let goes_on = line.get(end).is_some_and(is_part) && operator(line, end).is_none();
    (is_one && !goes_on).then_some((end, sum + product))
}

/// Returns the operator at an offset, with blanks on both sides or on none, and the offset after it.
fn operator(line: &[u8], at: usize) -> Option<(u8, usize)> {
    let blanks = |at: usize| {
        let rest = line.get(at..).unwrap_or_default();
        rest.iter().take_while(|byte| **byte == b' ').count()
    };
    let before = blanks(at);
    let operator = *line.get(at + before)?;
    let next = at + before + 1;
    let after = blanks(next);
    // `1 -2` are two numbers, and `//` starts a comment.
    let is_one = match operator {
        b'*' => true,
        b'/' => !matches!(line.get(next), Some(b'/' | b'*')),
        b'+' | b'-' => (before == 0) == (after == 0),
        _ => false,
    };
    is_one.then_some((operator, next + after))
}

/// Returns the end of the decimal number at an offset, and its value.
fn number(line: &[u8], start: usize) -> Option<(usize, f64)> {
    let digits = |at: usize| {
        let rest = line.get(at..).unwrap_or_default();
        at + rest.iter().take_while(|byte| byte.is_ascii_digit()).count()
    };
    let is = |at: usize, bytes: &[u8]| line.get(at).is_some_and(|byte| bytes.contains(byte));
    let mut end = digits(start + usize::from(is(start, b"-")));
    if is(end, b".") {
        end = digits(end + 1);
    }
    if is(end, b"eE") {
        let exponent = end + 1 + usize::from(is(end + 1, b"+-"));
        let after = digits(exponent);
        end = if after > exponent { after } else { end };
    }
    let source = str::from_utf8(line.get(start..end)?).ok()?;
    Some((end, source.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::syntax::parse;

    #[test]
    fn expressions_have_values() {
        for (text, expected) in [
            ("1/2, 3", Some((3, 0.5))),
            ("0.5*2)", Some((5, 1.0))),
            ("1 + 2 * 3", Some((9, 7.0))),
            ("8-2-1.5", Some((7, 4.5))),
            ("-6*0.5 ", Some((6, -3.0))),
            ("2*-3", Some((4, -6.0))),
            ("1e-3/2", Some((6, 0.0005))),
            ("1/0", Some((3, f64::INFINITY))),
            ("1", None),
            ("1 -2", None),
            ("1 // half", None),
            ("1 /* half */", None),
            ("1/x", None),
            ("2**3", None),
            ("1/2m", None),
            ("1-2.3.4", None),
        ] {
            assert_eq!(evaluate(text), expected, "{text}");
        }
    }

    #[test]
    fn one_fault_with_its_value() {
        for (text, syntax, fixed) in [
            (
                "(radius: 1/2, fov: 90)",
                Syntax::Ron,
                "(radius: 0.5, fov: 90)",
            ),
            ("(1 + 2, -6*0.5)", Syntax::Ron, "(3, -3)"),
            ("{\"radius\": 0.5*2}", Syntax::Json, "{\"radius\": 1}"),
        ] {
            let tree = parse(text, syntax);
            let edits: Vec<_> = tree.faults().iter().map(|fault| &*fault.fix).collect();
            assert_eq!(crate::text::edit::apply(text, edits).0, fixed);
        }
    }
}
