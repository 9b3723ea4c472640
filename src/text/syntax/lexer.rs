//! The lexer for both syntaxes; comments go to a separate list.

use std::ops::Range;

use unicode_ident::{is_xid_continue, is_xid_start};

use super::decimal::Decimal;
use super::fault::{Faults, Habit, Mark};
use super::number;
use super::{language::Syntax, tree::Comment};

/// The three kinds of brackets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bracket {
    Round,
    Square,
    Curly,
}

impl Bracket {
    pub(crate) fn opener(self) -> char {
        match self {
            Bracket::Round => '(',
            Bracket::Square => '[',
            Bracket::Curly => '{',
        }
    }

    pub(crate) fn closer(self) -> char {
        match self {
            Bracket::Round => ')',
            Bracket::Square => ']',
            Bracket::Curly => '}',
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TokenKind {
    Open(Bracket),
    Close(Bracket),
    Comma,
    Colon,
    Semicolon,
    Equals,
    Name,
    Number,
    String,
    Char,
    Bytes,
    /// Unreadable; the fault has been reported.
    Unknown,
    End,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Token {
    pub(crate) kind: TokenKind,
    /// True if it is the first token on its line.
    pub(crate) fresh: bool,
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// Start offset of its line.
    pub(crate) line: u32,
    /// Indentation of its line in bytes.
    pub(crate) indent: u32,
}

impl Token {
    pub(crate) fn range(&self) -> Range<u32> {
        self.start..self.end
    }

    /// Returns the same range as `usize` offsets.
    pub(crate) fn bytes(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

pub(super) struct Lexer<'t> {
    pub(crate) text: &'t str,
    pub(crate) syntax: Syntax,
    pub(crate) pos: usize,
    pub(crate) faults: Faults,
    pub(crate) comments: Vec<Comment>,
    pub(super) line: usize,
    indent: usize,
    /// True if only white space and comments came before on this line.
    pub(super) fresh: bool,
    /// Strings that start before this offset end with their line, because one of them has lost its
    /// closing quote.
    pub(super) single_line_until: usize,
    /// Strings that start before this offset are not cut to their first word: one around them was
    /// cut, and their end has been seen.
    pub(super) whole_until: usize,
    /// True if the last string or comment is not closed, so that the end of the text is not another
    /// fault.
    pub(crate) cut_off: bool,
}

/// A lexer position to return to.
pub(super) struct Checkpoint(usize, usize, usize, bool, bool, usize, Mark);

pub(super) fn is_raw_name(c: char) -> bool {
    matches!(c, '.' | '+' | '-') || is_xid_continue(c)
}

impl<'t> Lexer<'t> {
    pub(crate) fn new(text: &'t str, syntax: Syntax) -> Self {
        let pos = if text.starts_with('\u{feff}') {
            '\u{feff}'.len_utf8()
        } else {
            0
        };
        Lexer {
            text,
            syntax,
            pos,
            faults: Faults::new(text.len()),
            comments: Vec::new(),
            line: pos,
            indent: 0,
            fresh: true,
            single_line_until: 0,
            whole_until: 0,
            cut_off: false,
        }
    }

    pub(crate) fn place(&self) -> Checkpoint {
        let (marks, comments) = (self.faults.mark(), self.comments.len());
        Checkpoint(
            self.pos,
            self.line,
            self.indent,
            self.fresh,
            self.cut_off,
            comments,
            marks,
        )
    }

    /// Returns to a position, but keeps the knowledge about strings; otherwise each lookahead would
    /// scan them again.
    pub(crate) fn reset(&mut self, place: Checkpoint) {
        (self.pos, self.line, self.indent) = (place.0, place.1, place.2);
        (self.fresh, self.cut_off) = (place.3, place.4);
        self.comments.truncate(place.5);
        self.faults.reset(place.6);
    }

    pub(crate) fn slice(&self, range: Range<u32>) -> &'t str {
        self.text
            .get(range.start as usize..range.end as usize)
            .unwrap_or("")
    }

    #[inline]
    pub(crate) fn byte(&self, at: usize) -> Option<u8> {
        self.text.as_bytes().get(at).copied()
    }

    pub(crate) fn rest(&self) -> &'t str {
        self.text.get(self.pos..).unwrap_or("")
    }

    /// Starts a new line at `start`.
    pub(crate) fn new_line(&mut self, start: usize) {
        self.line = start;
        self.fresh = true;
    }

    #[inline]
    pub(crate) fn next(&mut self) -> Token {
        self.skip_trivia();
        let start = self.pos;
        let (fresh, line) = (self.fresh, self.line);
        if fresh {
            self.indent = start - line;
            self.fresh = false;
        }
        let indent = self.indent as u32;
        let kind = match self.byte(start) {
            Some(byte) => self.scan(byte),
            None => TokenKind::End,
        };
        if self.line != line && kind != TokenKind::End {
            // A token after a string over several lines is not the first on its line.
            self.fresh = false;
        }
        Token {
            kind,
            fresh,
            start: start as u32,
            end: self.pos as u32,
            line: line as u32,
            indent,
        }
    }

    #[inline]
    pub(crate) fn scan(&mut self, byte: u8) -> TokenKind {
        use TokenKind::*;
        let kind = match byte {
            b'(' if self.begins_expression() && self.arithmetic(self.pos) => return Unknown,
            b'(' => Open(Bracket::Round),
            b')' => Close(Bracket::Round),
            b'[' => Open(Bracket::Square),
            b']' => Close(Bracket::Square),
            b'{' => Open(Bracket::Curly),
            b'}' => Close(Bracket::Curly),
            b',' => Comma,
            b':' => Colon,
            b';' => Semicolon,
            b'=' => Equals,
            b'"' => return self.string(0),
            b'\'' => return self.single_quote(),
            b'0'..=b'9' | b'+' | b'-' | b'.' => return self.number(),
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => return self.word(),
            _ => return self.invalid(byte),
        };
        self.pos += 1;
        kind
    }

    pub(crate) fn rest_of(&self, start: usize, end: usize) -> &'t str {
        self.text.get(start..end).unwrap_or("")
    }

    /// Returns the end of a run of characters that names, raw names and numbers consist of.
    #[inline]
    pub(crate) fn run_end(&self, mut at: usize, raw: bool) -> usize {
        while let Some(byte) = self.byte(at) {
            match byte {
                b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'_' => at += 1,
                b'.' | b'+' | b'-' if raw => at += 1,
                0x80.. => match self.text.get(at..).and_then(|rest| rest.chars().next()) {
                    Some(c) if is_xid_continue(c) => at += c.len_utf8(),
                    _ => break,
                },
                _ => break,
            }
        }
        at
    }

    fn number(&mut self) -> TokenKind {
        let start = self.pos;
        // Two values are never adjacent, so the number is the longest run of any of its characters.
        self.pos = self.run_end(start, true);
        let token = self.rest_of(start, self.pos);
        if self.sees_operator() && self.arithmetic(start) {
            return TokenKind::Unknown;
        }
        if !is_plain(token)
            && let Err(help) = number::check(token, self.syntax)
        {
            if self.arithmetic(start) {
                return TokenKind::Unknown;
            }
            self.cut_off = self.rest().is_empty();
            let message = format!("unreadable number `{}`", shorten(token));
            if !(self.syntax == Syntax::Json && self.faults.reported(Habit::Ron)) {
                self.faults
                    .add(start as u32..self.pos as u32, message, help);
            }
            // A space between a sign and its number is one slip, not two.
            let spaces = self.rest().len() - self.rest().trim_start_matches(' ').len();
            if matches!(token, "-" | "+")
                && self
                    .byte(self.pos + spaces)
                    .is_some_and(|byte| byte.is_ascii_digit())
            {
                self.pos = self.run_end(self.pos + spaces, true);
            }
            return TokenKind::Unknown;
        }
        TokenKind::Number
    }

    /// Consumes the parts of a Rust path after `::`; they belong to the name.
    #[cold]
    fn path(&mut self) {
        let mark = self.pos as u32..self.pos as u32 + 2;
        let help = "write the last name alone";
        self.faults.add(mark, "unexpected `::`".into(), help);
        while self.is_path() {
            self.pos = self.run_end(self.pos + 2, false);
        }
    }

    fn is_path(&self) -> bool {
        let behind = self
            .rest()
            .strip_prefix("::")
            .and_then(|rest| rest.chars().next());
        behind.is_some_and(is_xid_start)
    }

    pub(crate) fn word(&mut self) -> TokenKind {
        let start = self.pos;
        if self.syntax == Syntax::Ron {
            let first = self.byte(start);
            if matches!(first, Some(b'r' | b'b'))
                && let Some(kind) = self.prefixed()
            {
                return kind;
            }
        }
        self.pos = self.run_end(start, false);
        if self.pos == start + "pi".len() && self.sees_operator() && self.arithmetic(start) {
            return TokenKind::Unknown;
        }
        if self.syntax == Syntax::Ron && self.is_path() {
            self.path();
        }
        if self.at_closing_quote() && self.rest_of(start, self.pos) != "Some" {
            return self.unopened(start);
        }
        // `Some` before a sign is a name: ron accepts `Some+5` for `Some(5)`.
        if matches!(self.byte(self.pos), Some(b'.' | b'+' | b'-'))
            && self.rest_of(start, self.pos) != "Some"
        {
            self.pos = self.run_end(self.pos, true);
            if self.at_closing_quote() {
                return self.unopened(start);
            }
            if self.syntax == Syntax::Ron {
                let token = shorten(self.rest_of(start, self.pos));
                self.cut_off = self.rest().is_empty();
                let help = format!("write a text in quotes: `\"{token}\"`");
                let message = format!("expected a name, found `{token}`");
                self.faults
                    .add(start as u32..self.pos as u32, message, &help);
            }
        }
        TokenKind::Name
    }
}

/// Returns true if a token is clearly a number in both syntaxes; a fast path for the common case
/// that skips the grammar.
#[inline]
fn is_plain(token: &str) -> bool {
    Decimal::scan(token, 0).is_some_and(|number| number.end == token.len())
}

/// Shortens a token for a message: its start, on one line.
pub(super) fn shorten(token: &str) -> String {
    let line = token.lines().next().unwrap_or("");
    let mut short: String = line
        .chars()
        .take(32)
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    if short.len() < token.len() {
        short.push('…');
    }
    short
}
