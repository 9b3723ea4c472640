//! Arithmetic in the place of a number, such as `1/2`: it is not evaluated, but its value is told.

use super::fault::{Habit, cure};
use super::language::Syntax;
use super::lexer::{Lexer, shorten};
use super::value::is_variant;
use crate::text::edit::Edit;
use std::f64::consts::PI;

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

    /// Returns true if the parenthesis at the position may start arithmetic, such as `(1 + 2) / 3`,
    /// where a value is expected. A tuple is ruled out at its first comma.
    #[inline]
    pub(super) fn begins_expression(&self) -> bool {
        let rest = self.rest().as_bytes();
        let rest = rest.get(..LONGEST).unwrap_or(rest);
        let after = rest
            .iter()
            .find(|byte| !byte.is_ascii_digit() && !b"(-. ".contains(byte));
        let before = || self.rest_of(0, self.pos).trim_ascii_end();
        after.is_some_and(|byte| b"*/+)eEpP".contains(byte))
            && before().ends_with([':', ',', '(', '[', '{'])
    }

    /// Returns true if a text is all that a function has in its parentheses, as in `sqrt(1/2)`.
    fn is_argument(&self, start: usize) -> bool {
        let before = self.rest_of(0, start).trim_ascii_end().strip_suffix('(');
        let name = before.and_then(|before| before.rsplit(|c: char| !c.is_alphanumeric()).next());
        name.is_some_and(|name| !is_variant(name))
            && self.rest().trim_ascii_start().starts_with(')')
    }

    /// Returns the end of an expression that goes on here, if a comma or a closing bracket is behind it.
    pub(super) fn expression_end(&self) -> Option<usize> {
        let rest = self.rest().as_bytes();
        let mut depth = 0_usize;
        for (at, byte) in rest.iter().enumerate().take(LONGEST) {
            match byte {
                b'(' => depth += 1,
                b')' if depth > 0 => depth -= 1,
                b',' if depth > 0 => {}
                b',' | b')' | b']' | b'}' => return (depth == 0).then_some(self.pos + at),
                b'/' if matches!(rest.get(at + 1), Some(b'/' | b'*')) => return None,
                _ if byte.is_ascii_alphanumeric() || b"_.+-*/%^ ".contains(byte) => {}
                _ => return None,
            }
        }
        None
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
            let edit = (!self.is_argument(start)).then(|| Edit::replace(start..self.pos, written));
            cure(self.faults.add(range, message, &help), edit);
        } else {
            let help = "arithmetic is not evaluated, and this has no value";
            self.faults.add(range, message, help);
        }
        true
    }
}

/// Evaluates the expression at the start of a text: numbers, `pi` and parentheses with at least one
/// of `+`, `-`, `*` and `/` between them. Returns its length and its value.
fn evaluate(text: &str) -> Option<(usize, f64)> {
    let all = text.as_bytes();
    let line = all.get(..LONGEST).unwrap_or(all);
    let (end, value, is_one) = sum(line, 0)?;
    let rest = all.get(end..)?;
    let next = rest.trim_ascii_start();
    let is_comment = next.starts_with(b"//") || next.starts_with(b"/*");
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b"_.(".contains(byte);
    let goes_on = rest.first().is_some_and(is_part)
        || next.first().is_some_and(|byte| b"+-*/^%".contains(byte)) && !is_comment;
    (is_one && !goes_on && end < LONGEST).then_some((end, value))
}

/// Evaluates the sum at an offset. Returns its end, its value, and true if it has an operator.
fn sum(line: &[u8], start: usize) -> Option<(usize, f64, bool)> {
    let (mut end, first, mut is_one) = factor(line, start)?;
    let (mut sum, mut product) = (0.0, first);
    while let Some((operator, at)) = operator(line, end) {
        let Some((after, value, _)) = factor(line, at) else {
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
    Some((end, sum + product, is_one))
}

/// Evaluates the number, `pi` or parentheses at an offset, as [`sum`] does.
fn factor(line: &[u8], start: usize) -> Option<(usize, f64, bool)> {
    if let Some((end, value)) = number(line, start) {
        return Some((end, value, false));
    }
    let is_negative = line.get(start) == Some(&b'-');
    let at = start + usize::from(is_negative);
    let signed = |value: f64| if is_negative { -value } else { value };
    if line.get(at) == Some(&b'(') {
        let (end, value, is_one) = sum(line, at + 1 + blanks(line, at + 1))?;
        let end = end + blanks(line, end);
        return (line.get(end) == Some(&b')')).then_some((end + 1, signed(value), is_one));
    }
    let is_pi = line.get(at..at + 2)?.eq_ignore_ascii_case(b"pi");
    is_pi.then_some((at + 2, signed(PI), false))
}

/// Counts the blanks at an offset.
fn blanks(line: &[u8], at: usize) -> usize {
    let rest = line.get(at..).unwrap_or_default();
    rest.iter().take_while(|byte| **byte == b' ').count()
}

/// Returns the operator at an offset, with blanks on both sides or on none, and the offset after it.
fn operator(line: &[u8], at: usize) -> Option<(u8, usize)> {
    let before = blanks(line, at);
    let operator = *line.get(at + before)?;
    let next = at + before + 1;
    let after = blanks(line, next);
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
            ("(1+2)/3, 4", Some((7, 1.0))),
            ("2*( 1 + 2 )", Some((11, 6.0))),
            ("-((1+2)*2))", Some((10, -6.0))),
            ("pi/2", Some((4, PI / 2.0))),
            ("-2 * PI // a turn", Some((7, -2.0 * PI))),
            ("(1)", None),
            ("(1+2", None),
            ("(1+2, 3)", None),
            ("(1+2)x", None),
            ("1/2/x", None),
            ("1/2 -1", None),
            ("1/2 % 3", None),
            ("2(1+2)", None),
            ("pixel/2", None),
            ("pi", None),
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
            ("{\"fov\": (1+2)/3}", Syntax::Json, "{\"fov\": 1}"),
            ("(fov: ((1+2)/3)*2)", Syntax::Ron, "(fov: 2)"),
            ("(fov: -(1+2))", Syntax::Ron, "(fov: -3)"),
            ("((1 + 2), (3/2))", Syntax::Ron, "(3, 1.5)"),
            ("(1/2, (pi*2))", Syntax::Ron, "(0.5, 6.283185307179586)"),
            ("(fov: Some(1/2))", Syntax::Ron, "(fov: Some(0.5))"),
        ] {
            let tree = parse(text, syntax);
            let edits: Vec<_> = tree.faults().iter().map(|fault| &*fault.fix).collect();
            assert_eq!(crate::text::edit::apply(text, edits).0, fixed);
        }
    }

    #[test]
    fn no_fix_leaves_a_fault() {
        for text in [
            "(fov: sqrt(1/2))",
            "(fov: 1/2/x)",
            "(fov: (1+2)/x)",
            "(fov: 1/0)",
            "(fov: 1/2 -1)",
        ] {
            let tree = parse(text, Syntax::Ron);
            assert!(!tree.faults().is_empty(), "{text}");
            for fault in tree.faults() {
                assert_eq!(fault.fix, [], "{text}");
            }
        }
    }
}
