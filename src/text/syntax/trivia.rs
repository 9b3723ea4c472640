//! White space and comments.

use super::confusables;
use super::fault::{Fault, Habit};
use super::lexer::Lexer;
use super::{
    language::Syntax,
    tree::{Comment, CommentKind},
};
use crate::text::edit::Edit;

/// The run of spaces skipped in one step.
const BLANK: &[u8; 32] = &[b' '; 32];

impl Lexer<'_> {
    /// Skips white space and comments.
    #[inline]
    pub(crate) fn skip_trivia(&mut self) {
        while let Some(byte) = self.byte(self.pos) {
            match byte {
                b' ' if self.rest().as_bytes().starts_with(BLANK) => self.pos += BLANK.len(),
                b' ' | b'\t' | b'\r' => self.pos += 1,
                b'\n' => {
                    self.pos += 1;
                    self.new_line(self.pos);
                }
                b'/' if matches!(self.byte(self.pos + 1), Some(b'/' | b'*')) => self.comment(),
                0x0b | 0x0c if self.syntax == Syntax::Ron => self.pos += 1,
                b'#' | b'-' | b'<' | b'=' | b'>' | b'|' | b'`' if self.foreign_line() => {}
                0x80.. if self.odd_space() => {}
                _ => return,
            }
        }
    }

    /// Skips the rest of a line that is not part of a scene: a shell or SQL comment, a merge
    /// conflict marker, a Markdown fence. The line has no tokens and is reported as one fault.
    fn foreign_line(&mut self) -> bool {
        /// Maximum length of a marker; only lines of `#` may be longer.
        const LONGEST: usize = 8;
        let rest = self.rest();
        let bytes = rest.as_bytes();
        let first = bytes.first().copied().unwrap_or_default();
        let run = bytes
            .iter()
            .take(LONGEST)
            .take_while(|byte| **byte == first)
            .count();
        let ends = matches!(bytes.get(run), None | Some(b' ' | b'\t' | b'\r' | b'\n'));
        let at_start = self.fresh && self.rest_of(self.line, self.pos).trim().is_empty();
        // In an attribute, white space and comments may follow the `#`.
        let is_attribute = || rest[run..].trim_start().starts_with(['!', '/', '[']);
        let comment = match self.syntax {
            Syntax::Ron => "a comment starts with `//`",
            Syntax::Json => "JSON does not support comments",
        };
        let help = match first {
            b'#' if (ends || self.fresh) && !is_attribute() => comment,
            b'-' if run == 2 && self.fresh && ends => comment,
            b'<' | b'=' | b'>' | b'|' if run == 7 && at_start && ends => {
                "resolve the merge conflict"
            }
            b'`' if run >= 3 && at_start => "remove the fence",
            _ => return false,
        };
        let marker = &rest[..run];
        let range = self.pos as u32..(self.pos + run) as u32;
        self.faults
            .add(range, format!("unexpected `{marker}`"), help);
        self.pos += rest.find('\n').unwrap_or(rest.len());
        self.cut_off |= self.rest().is_empty();
        true
    }

    #[cold]
    fn odd_space(&mut self) -> bool {
        let Some(c) = self
            .rest()
            .chars()
            .next()
            .filter(|&c| confusables::is_odd_space(c))
        else {
            return false;
        };
        let start = self.pos as u32;
        self.pos += c.len_utf8();
        if self.syntax == Syntax::Json || !confusables::is_ron_space(c) {
            let message = format!(
                "unexpected character U+{:04X}, which only looks like white space",
                u32::from(c)
            );
            self.faults.add_once(
                Habit::OddSpace,
                start..self.pos as u32,
                message,
                "replace it with an ordinary space",
                [Edit::replace(start as usize..self.pos, " ")],
            );
        }
        true
    }

    #[cold]
    fn comment(&mut self) {
        let start = self.pos;
        let kind = if self.byte(start + 1) == Some(b'/') {
            CommentKind::Line
        } else {
            CommentKind::Block
        };
        let end;
        let bytes = self.text.as_bytes();
        if kind == CommentKind::Line {
            self.pos = line_comment(bytes, start);
            end = start + self.rest_of(start, self.pos).trim_end_matches('\r').len();
        } else {
            let close = block_comment(bytes, start);
            end = close.unwrap_or(bytes.len());
            if let Some(line) = self.rest_of(start, end).rfind('\n') {
                self.new_line(start + line + 1);
            }
            self.pos = end;
            self.cut_off |= close.is_none();
            if close.is_none() && self.syntax == Syntax::Ron {
                self.faults.add(
                    start as u32..start as u32 + 2,
                    "unclosed block comment".into(),
                    "add `*/` where it ends",
                );
            }
        }
        self.comments.push(Comment {
            start: start as u32,
            end: end as u32,
            kind,
        });
        if self.syntax == Syntax::Json {
            let found = if kind == CommentKind::Line {
                "//"
            } else {
                "/*"
            };
            let message = format!("unexpected comment `{found}`");
            self.faults.add_once(
                Habit::Comment,
                start as u32..end as u32,
                message,
                "JSON does not support comments",
                None,
            );
        }
    }
}

/// Explains a fault at the end of a text by a comment that goes on to there: as in `ron`, a carriage
/// return alone does not end it.
pub(super) fn blame_carriage_return(text: &str, comments: &[Comment], fault: &mut Fault) {
    let comment = |comment: &Comment| text.get(comment.start as usize..comment.end as usize);
    let mut after = comments
        .iter()
        .filter(|comment| comment.kind == CommentKind::Line)
        .filter(|comment| comment.start as usize >= fault.range.start)
        .filter_map(|found| Some((found.start as usize, comment(found)?)));
    if let Some((start, comment)) = after.find(|(_, comment)| comment.contains('\r')) {
        let range = start..start + comment.len();
        let help = "save the file with the line ends LF or CRLF; CR alone does not end a comment";
        fault.message = "the rest of the file is a comment".to_owned();
        fault.help = Some(help.to_owned());
        fault.label = None;
        fault.fix = vec![Edit::replace(range, comment.replace('\r', "\n"))];
        fault.range = start..start + "//".len();
    }
}

/// Returns the end of the line comment that starts at `start`: the end of its line.
pub(crate) fn line_comment(text: &[u8], start: usize) -> usize {
    let rest = text.get(start..).unwrap_or_default();
    let length = rest.iter().position(|byte| *byte == b'\n');
    start + length.unwrap_or(rest.len())
}

/// Returns the end of the block comment that starts at `start`, including nested comments; `None`
/// if it is not closed.
pub(crate) fn block_comment(text: &[u8], start: usize) -> Option<usize> {
    let mut at = start;
    let mut depth = 0;
    loop {
        match (text.get(at)?, text.get(at + 1)) {
            (b'/', Some(b'*')) => (depth, at) = (depth + 1, at + 2),
            (b'*', Some(b'/')) => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return Some(at);
        }
    }
}
