//! Quoted tokens: strings, raw strings, bytes and characters, and the likely end of a string
//! without a closing quote.

use std::ops::Range;

use super::fault::{Habit, cure};
use super::language::Syntax;
use super::lexer::{Lexer, TokenKind, is_raw_name};
use super::text::{self, Quote};
use crate::text::edit::Edit;

const ADD_QUOTE: &str = "add the closing quote `\"`";

/// The end of a string's content.
struct StringEnd {
    at: usize,
    /// True if a closing quote is there.
    closed: bool,
    /// The first unescaped line break in the content.
    line: Option<usize>,
}

impl Lexer<'_> {
    /// Reads a string. The current position is the opening quote, or the prefix of `prefix` bytes
    /// (RON's `b`) before it.
    pub(super) fn string(&mut self, prefix: usize) -> TokenKind {
        let start = self.pos;
        let content = start + prefix + 1;
        let StringEnd { at, closed, line } = self.string_end(start, content);
        if !closed || (line.is_some() && !self.may_follow(at + 1)) {
            self.single_line_until = self.single_line_until.max(at);
            return self.unclosed(start, content, line.unwrap_or(at));
        }
        if at == content && prefix == 0 && self.is_glued(at + 1) && start >= self.whole_until {
            // `""text"`: the second quote opens the string.
            self.whole_until = at;
            self.extra_quote(start);
            self.pos = at;
            return self.string(0);
        }
        if line.is_none() && start >= self.whole_until && self.is_glued(at + 1) {
            let inside = self.rest_of(content, at);
            if let Some(word) = leading_word(inside) {
                self.whole_until = at;
                self.pos = content + word;
                self.lost_quote(start);
                return TokenKind::String;
            }
        }
        self.pos = at + 1;
        if self.byte(at + 1) == Some(b'"')
            && self
                .byte(at + 2)
                .is_none_or(|b| b" \t\r\n,:)]}".contains(&b))
            && at > content
        {
            self.extra_quote(at + 1);
            self.pos += 1;
        }
        let inside = self.rest_of(content, at);
        if let Some(last) = inside.rfind('\n') {
            self.new_line(content + last + 1);
        }
        let quote = match (self.syntax, prefix) {
            (Syntax::Json, _) => Quote::Json,
            (Syntax::Ron, 0) => Quote::Ron,
            (Syntax::Ron, _) => Quote::RonBytes,
        };
        match control_character(inside).filter(|_| quote == Quote::Json) {
            Some(control) => self.forbidden_control(content + control),
            None if inside.contains('\\') => self.check_escapes(content, at, quote),
            None => {}
        }
        if prefix == 0 {
            TokenKind::String
        } else {
            TokenKind::Bytes
        }
    }

    /// Finds the end of the string whose content starts at `content`.
    fn string_end(&self, start: usize, content: usize) -> StringEnd {
        let one_line = self.syntax == Syntax::Json || start < self.single_line_until;
        let (mut at, mut line) = (content, None);
        let closed = loop {
            match self.byte(at) {
                Some(b'"') => break true,
                Some(b'\\') => at = (at + 2).min(self.text.len()),
                Some(b'\n') => {
                    line = line.or(Some(at));
                    if one_line {
                        break false;
                    }
                    at += 1;
                }
                Some(_) => at += 1,
                None => break false,
            }
        };
        StringEnd { at, closed, line }
    }

    /// Reports a control character in a JSON string.
    fn forbidden_control(&mut self, at: usize) {
        let code = self.byte(at).unwrap_or(0);
        self.faults.add(
            at as u32..at as u32 + 1,
            format!("control character U+{code:04X} in a string"),
            "write it as an escape: `\\t`, `\\u0000`",
        );
    }

    fn check_escapes(&mut self, content: usize, end: usize, quote: Quote) {
        if let Err(bad) = text::unescape(self.rest_of(content, end), quote) {
            let range = content + bad.range.start..content + bad.range.end;
            let message = format!(
                "invalid escape `{}`",
                super::lexer::shorten(self.rest_of(range.start, range.end))
            );
            self.faults
                .add(range.start as u32..range.end as u32, message, bad.help);
        }
    }

    /// Returns true if the text at `at` may follow a RON string. Any `/` is assumed to start a
    /// comment.
    fn may_follow(&self, at: usize) -> bool {
        let rest = self.text.get(at..).unwrap_or("");
        let rest = rest
            .trim_start_matches(|c: char| c.is_whitespace() || super::confusables::is_ron_space(c));
        rest.is_empty() || rest.starts_with([',', ':', ')', ']', '}', '/'])
    }

    /// Returns true if a value starts directly after a closing quote: that quote is likely an
    /// opening one.
    fn is_glued(&self, at: usize) -> bool {
        self.byte(at)
            .is_some_and(|b| b == b'#' || b == b'_' || b.is_ascii_alphanumeric() || b == b'$')
    }

    /// Ends a string without a closing quote: in front of the closing brackets on its line if there
    /// are any, or else at the end of the line.
    fn unclosed(&mut self, start: usize, content: usize, line_end: usize) -> TokenKind {
        let line = self.rest_of(content, line_end);
        self.pos = content
            + if start < self.whole_until {
                before_closers(line)
            } else {
                likely_end(line)
            };
        self.whole_until = line_end;
        self.cut_off = self.rest().bytes().all(|b| b.is_ascii_whitespace());
        self.lost_quote(start);
        TokenKind::String
    }

    /// Returns true if the current character is a quote that can only close a string; the string
    /// was then never opened.
    pub(super) fn at_closing_quote(&self) -> bool {
        self.byte(self.pos) == Some(b'"')
            && self
                .byte(self.pos + 1)
                .is_none_or(|b| b" \t\r\n,:)]}".contains(&b))
    }

    /// Reads a word that starts at `start` and ends with a closing quote as a string.
    pub(super) fn unopened(&mut self, start: usize) -> TokenKind {
        self.pos += 1;
        let token = super::lexer::shorten(self.rest_of(start, self.pos));
        let fault = self.faults.add(
            start as u32..self.pos as u32,
            format!("expected `\"`, found `{token}`"),
            "add the opening quote `\"`",
        );
        cure(fault, [Edit::insert(start, "\"")]);
        TokenKind::String
    }

    fn extra_quote(&mut self, at: usize) {
        let fault = self.faults.add(
            at as u32..at as u32 + 1,
            "unexpected `\"`".into(),
            "remove it",
        );
        cure(fault, [Edit::remove(at..at + 1)]);
    }

    fn lost_quote(&mut self, start: usize) {
        let fault = self.faults.add(
            start as u32..self.pos as u32,
            "unterminated string".into(),
            ADD_QUOTE,
        );
        cure(fault, [Edit::insert(self.pos, "\"")]);
    }

    /// Reads RON's `r".."`, `r#name`, `b".."`, `br".."` and `b'.'`; returns `None` for an ordinary
    /// word.
    pub(super) fn prefixed(&mut self) -> Option<TokenKind> {
        let start = self.pos;
        let rest = self.rest();
        if rest.starts_with("b\"") {
            return Some(self.string(1));
        }
        if let Some(byte) = rest.strip_prefix("b'") {
            return Some(self.quoted(start, 2, byte, Quote::RonByte));
        }
        let (letters, hashed) = match rest.strip_prefix("br") {
            Some(hashed) => (2, hashed),
            None => (1, rest.strip_prefix('r')?),
        };
        let hashes = hashed.bytes().take_while(|&b| b == b'#').count();
        let content = start + letters + hashes + 1;
        if hashed.as_bytes().get(hashes) == Some(&b'"') {
            let ending = format!("\"{}", "#".repeat(hashes));
            let found = (start >= self.single_line_until)
                .then(|| self.text.get(content..)?.find(&ending))
                .flatten();
            let Some(length) = found else {
                self.single_line_until = self.text.len();
                let line = self.text.get(content..).unwrap_or("");
                let line = content + line.find('\n').unwrap_or(line.len());
                return Some(self.unclosed(start, content, line));
            };
            self.pos = content + length + ending.len();
            if let Some(last) = self.rest_of(content, content + length).rfind('\n') {
                self.new_line(content + last + 1);
            }
            return Some(if letters == 1 {
                TokenKind::String
            } else {
                TokenKind::Bytes
            });
        }
        if hashes == 0 {
            return None;
        }
        let name = start + letters + hashes;
        self.pos = self.run_end(name, true);
        if letters == 1 && hashes == 1 && self.rest_of(name, self.pos).starts_with(is_raw_name) {
            return Some(TokenKind::Name);
        }
        self.cut_off = self.rest().is_empty();
        let message = format!(
            "expected a name or a raw string, found `{}`",
            super::lexer::shorten(self.rest_of(start, self.pos))
        );
        self.faults.add(
            start as u32..self.pos as u32,
            message,
            "write `r#name` or `r#\"text\"#`",
        );
        Some(TokenKind::Unknown)
    }

    /// Reads a token that starts with `'`: a RON character, or a string with the wrong quotes.
    pub(super) fn single_quote(&mut self) -> TokenKind {
        let start = self.pos;
        let inside = self.text.get(start + 1..).unwrap_or("");
        if self.syntax == Syntax::Ron {
            return self.quoted(start, 1, inside, Quote::RonChar);
        }
        self.in_single_quotes(start, start + 1, "a double quote")
    }

    /// Reads a string with the wrong quotes, whose content starts at `content`.
    fn in_single_quotes(&mut self, start: usize, content: usize, expected: &str) -> TokenKind {
        self.pos = content + single_quoted(self.text.get(content..).unwrap_or(""));
        let token = super::lexer::shorten(self.rest_of(start, self.pos));
        self.faults.add_once(
            Habit::SingleQuotes,
            start as u32..self.pos as u32,
            format!("expected {expected}, found `{token}`"),
            "strings are written in double quotes",
            in_double_quotes(self.text, start..self.pos),
        );
        TokenKind::String
    }

    /// Reads `'c'` or `b'c'`; `inside` is the text after the opening quote, `prefix` bytes after
    /// `start`.
    fn quoted(&mut self, start: usize, prefix: usize, inside: &str, quote: Quote) -> TokenKind {
        let content = start + prefix;
        let mut chars = inside.char_indices();
        let length = match chars.next() {
            Some((_, '\\')) => {
                chars.next();
                chars.next();
                // The character after the backslash may itself be a quote.
                inside
                    .get(2..)
                    .and_then(|rest| rest.find(['\'', '\n', ',']))
                    .map(|at| at + 2)
            }
            Some((_, c)) => Some(c.len_utf8()),
            None => None,
        };
        if let Some(length) = length.filter(|&n| inside.as_bytes().get(n) == Some(&b'\'')) {
            self.pos = content + length + 1;
            let bytes = inside.get(..length).unwrap_or("");
            match text::unescape(bytes, quote) {
                Ok(bytes) if quote == Quote::RonByte && bytes.len() > 1 => {
                    let message = format!(
                        "expected an ASCII character, found `{}`",
                        inside.get(..length).unwrap_or("")
                    );
                    self.faults.add(
                        start as u32..self.pos as u32,
                        message,
                        "a byte is ASCII or an escape: `b'\\xff'`",
                    );
                }
                Ok(_) => {}
                Err(_) => self.check_escapes(content, content + length, quote),
            }
            return if quote == Quote::RonByte {
                TokenKind::Number
            } else {
                TokenKind::Char
            };
        }
        self.in_single_quotes(start, content, "one character in single quotes")
    }
}

/// Finds the first control character in a string's content that is not preceded by a backslash.
fn control_character(inside: &str) -> Option<usize> {
    let mut escaped = false;
    inside.bytes().position(|byte| {
        let is_control = byte < b' ' && !escaped;
        escaped = byte == b'\\' && !escaped;
        is_control
    })
}

/// Replaces single quotes with double quotes; `None` if the text contains a double quote or a
/// backslash.
fn in_double_quotes(text: &str, range: Range<usize>) -> Option<Edit> {
    let token = text.get(range.clone())?.strip_prefix('\'')?;
    let inside = token.strip_suffix(['\'', '"']).unwrap_or(token);
    (!inside.contains(['"', '\\'])).then(|| Edit::replace(range, format!("\"{inside}\"")))
}

/// Returns the length of the word at the start of a text if a separator or a closing bracket
/// follows; a `'` in between is part of the word.
fn leading_word(line: &str) -> Option<usize> {
    let mut word = line
        .find(|c: char| !(c.is_alphanumeric() || "#_$-".contains(c)))
        .unwrap_or(line.len());
    if word > 0 && line.as_bytes().get(word) == Some(&b'\'') {
        word += 1;
    }
    let rest = line.get(word..)?.trim_start();
    let separated = rest.starts_with([',', ')', ']', '}'])
        || rest
            .strip_prefix(':')
            .is_some_and(|value| !value.is_empty() && !value.starts_with('/'));
    (word > 0 && separated).then_some(word)
}

/// Returns the length of the text after a single quote, up to and including the closing quote.
fn single_quoted(inside: &str) -> usize {
    let end = inside.find(['\'', '"', '\n']).unwrap_or(inside.len());
    match inside.as_bytes().get(end) {
        Some(b'\'' | b'"') => end + 1,
        _ => likely_end(inside.get(..end).unwrap_or("")),
    }
}

/// Guesses where the content of a string ends if its line has no closing quote.
pub(super) fn likely_end(line: &str) -> usize {
    leading_word(line).unwrap_or_else(|| before_closers(line))
}

fn before_closers(line: &str) -> usize {
    line.trim_end_matches([' ', '\t', '\r', ',', ')', ']', '}'])
        .len()
}
