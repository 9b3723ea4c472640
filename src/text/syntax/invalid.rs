//! Characters that cannot start a token in either syntax.

use unicode_ident::is_xid_start;

use super::confusables;
use super::fault::cure;
use super::lexer::{Lexer, TokenKind, shorten};
use crate::text::edit::Edit;

impl Lexer<'_> {
    #[cold]
    pub(crate) fn invalid(&mut self, byte: u8) -> TokenKind {
        let start = self.pos;
        let Some(c) = self.rest().chars().next() else {
            return TokenKind::End;
        };
        if byte >= 0x80 {
            if is_xid_start(c) {
                return self.word();
            }
            if let Some((ascii, meant)) = confusables::punctuation(c) {
                return self.confusable(c, ascii, meant);
            }
        }
        if c.is_control() {
            let message = format!("unexpected control character U+{:04X}", u32::from(c));
            self.faults.add(
                start as u32..(start + c.len_utf8()) as u32,
                message,
                "a scene is text; is this another file?",
            );
            self.faults.hush();
            self.pos = self.text.len();
            return TokenKind::End;
        }
        if c == '<'
            && let Some(end) = self.rest().find(['>', '\n'])
            && self.byte(start + end) == Some(b'>')
        {
            self.pos += end + 1;
            let help = "group numbers with brackets: \
                        `(0, 0, 0)` in RON, `[0, 0, 0]` in JSON";
            let range = start as u32..start as u32 + 1;
            self.faults.add(range, "unexpected `<`".into(), help);
            return TokenKind::Unknown;
        }
        let help = match c {
            '#' if self.rest().starts_with("#!") => "attributes belong at the start of a file",
            '#' => "a color is a string: put it in quotes",
            '…' => "write every value out",
            '/' | '*' | '^' if self.follows_value(start) => {
                "arithmetic is not evaluated: write the value"
            }
            '%' if self.follows_value(start) => {
                "percentages are not evaluated: write the number; a color is `\"#rrggbb\"` or three \
                 numbers in 0..1"
            }
            '/' => "a comment starts with `//` or `/*`",
            '*' => "no comment is open here",
            _ => "remove it",
        };
        self.pos += c.len_utf8();
        if self.rest_of(start, start + 2) == "#!" {
            self.pos += self.rest().find(['\n', ']']).unwrap_or(self.rest().len());
            self.pos += usize::from(self.byte(self.pos) == Some(b']'));
        } else if c == '#' || c == '$' {
            self.pos = self.run_end(self.pos, false);
            if self.pos > start + 1 && self.at_closing_quote() {
                return self.unopened(start);
            }
        } else {
            let more = |c: char| {
                (c.is_ascii_punctuation() && "!$%&*<>?@\\^`|~/".contains(c))
                    || (!c.is_ascii() && is_stray(c))
            };
            self.pos += self
                .rest()
                .find(|c| !more(c) || confusables::punctuation(c).is_some())
                .unwrap_or(self.rest().len());
        }
        self.cut_off = self.rest().is_empty();
        let token = shorten(self.rest_of(start, self.pos));
        let is_color = c == '#' && token.len() > 1 && !token.starts_with("#!");
        let quoted = is_color.then(|| {
            let range = start..self.pos;
            let text = format!("\"{}\"", self.rest_of(range.start, range.end));
            Edit::replace(range, text)
        });
        let fault = self.faults.add(
            start as u32..self.pos as u32,
            format!("unexpected `{token}`"),
            help,
        );
        cure(fault, quoted);
        if "*/%^".contains(c) && self.follows_value(start) {
            self.pos = self.expression_end().unwrap_or(self.pos);
        }
        TokenKind::Unknown
    }

    /// Returns true if a number, a name or a closing bracket ends before an offset of this line.
    fn follows_value(&self, at: usize) -> bool {
        let before = self.rest_of(self.line, at).trim_end_matches(' ');
        before.ends_with(|c: char| c.is_ascii_alphanumeric() || c == ')')
    }

    fn confusable(&mut self, c: char, ascii: u8, meant: &str) -> TokenKind {
        let start = self.pos;
        let width = c.len_utf8();
        let fault = (
            start as u32..(start + width) as u32,
            format!("unexpected character `{c}`"),
            format!("write {meant}"),
        );
        let plain = Edit::replace(start..start + width, char::from(ascii));
        match ascii {
            b'"' => {
                self.pos += width;
                let rest = self.rest();
                let quote = |c: char| {
                    c == '"' || confusables::punctuation(c).is_some_and(|(ascii, _)| ascii == b'"')
                };
                let end = rest.find(|c| c == '\n' || quote(c)).unwrap_or(rest.len());
                let found = rest
                    .get(end..)
                    .and_then(|rest| rest.chars().next())
                    .filter(|&c| c != '\n');
                self.pos += match found {
                    Some(c) => end + c.len_utf8(),
                    None => super::quote::likely_end(rest.get(..end).unwrap_or("")),
                };
                let mut edits = vec![plain];
                if let Some(c) = found.filter(|&c| c != '"') {
                    edits.push(Edit::replace(self.pos - c.len_utf8()..self.pos, "\""));
                }
                cure(self.faults.add(fault.0, fault.1, &fault.2), edits);
                TokenKind::String
            }
            b'-' => {
                self.pos = self.run_end(start + width, true);
                cure(self.faults.add(fault.0, fault.1, &fault.2), [plain]);
                TokenKind::Unknown
            }
            _ => {
                cure(self.faults.add(fault.0, fault.1, &fault.2), [plain]);
                let kind = self.scan(ascii);
                self.pos = start + width;
                kind
            }
        }
    }
}

/// Returns true if a non-ASCII character cannot start a token.
fn is_stray(c: char) -> bool {
    !is_xid_start(c) && !confusables::is_odd_space(c) && !c.is_control()
}
