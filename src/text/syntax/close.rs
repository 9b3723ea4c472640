//! Closing brackets: matching, mismatched, and missing at the end.

use super::fault::{Habit, cure};
use super::frame::{Closed, Frame, Layout, Suspect};
use super::lexer::{Bracket, Token, TokenKind};
use super::parser::{Parser, State};
use super::tree::NodeKind;
use crate::text::edit::Edit;

impl Parser<'_> {
    /// Pops the innermost container off the stack; it ends at `end`.
    fn finish(&mut self, end: u32) -> Option<Frame> {
        self.complete_entry();
        let mut frame = self.frames.pop()?;
        let index = self.frames.len() as u32;
        self.by_bracket(frame.bracket).pop();
        if self.keyed.last() == Some(&index) {
            self.keyed.pop();
        }
        let after = self.nodes.len() as u32;
        if let Some(node) = self.nodes.get_mut(frame.node as usize) {
            node.end = end;
            node.after = after;
            if frame.layout == Layout::Undecided && node.name_len == 0 {
                node.kind = NodeKind::Unit;
            }
        }
        if frame.layout == Layout::Undecided {
            frame.layout = Layout::Tuple;
        }
        Some(frame)
    }

    /// Pops all containers above the stack's `depth` as unclosed: the current token shows that they
    /// end here.
    pub(crate) fn close_unclosed(&mut self, depth: usize) {
        if let Some(innermost) = self.frames.last().copied() {
            let missing: String = self
                .frames
                .get(depth..)
                .unwrap_or_default()
                .iter()
                .rev()
                .take(16)
                .map(Frame::closer)
                .collect();
            self.unclosed(innermost, self.token, &missing);
        }
        while self.frames.len() > depth {
            self.finish(self.previous_end);
        }
        self.complete_entry();
        // The container that continues here has its comma, or the comma is missing as part of the
        // same slip.
        if let Some(frame) = self.frames.last_mut() {
            frame.comma = 0;
        }
    }

    /// Gives the last key of a map a value if its colon was never reached.
    fn complete_entry(&mut self) {
        if self
            .frames
            .last_mut()
            .is_some_and(|frame| std::mem::take(&mut frame.key_pending))
        {
            self.push_hole();
        }
    }

    /// Handles a closing bracket where one is allowed.
    pub(crate) fn close(&mut self, bracket: Bracket, state: State) -> State {
        match self.frames.last() {
            Some(top) if top.bracket == bracket && !top.blamed => self.close_top(),
            Some(_) => self.close_mismatched(bracket, state),
            None => State::Trailing,
        }
    }

    #[cold]
    fn close_mismatched(&mut self, bracket: Bracket, state: State) -> State {
        let token = self.token;
        let Some(top) = self.frames.last().copied() else {
            return State::Trailing;
        };
        let surplus =
            top.blamed && !token.fresh && (top.line != token.line || !self.closes_two(bracket));
        if top.bracket == bracket && surplus {
            // Its opening bracket has been reported missing.
            self.advance();
            return State::Comma;
        }
        if top.bracket == bracket || top.lenient {
            return self.close_top();
        }
        let enclosing = self.by_bracket(bracket).last().map(|&index| index as usize);
        let next = self.look();
        let depth = self.frames.len();
        let typo_fits = self.fits(depth.checked_sub(2), &next);
        let unclosed_fits = enclosing.is_some_and(|index| self.fits(index.checked_sub(1), &next));
        let opener = enclosing.and_then(|index| self.frames.get(index).copied());
        let here = |frame: Frame| token.fresh && frame.indent == token.indent;
        let inner_line = opener.is_some_and(|opener| opener.line != top.line);
        let doubled = self
            .previous_close
            .is_some_and(|close| close.kind == token.kind && close.end == token.start)
            && self.fits(depth.checked_sub(1), &next);
        let outer = match opener {
            Some(opener) if here(opener) && !here(top) => true,
            // An opening bracket is missing here; this is its closing bracket.
            _ if top.blamed || doubled => false,
            Some(_) if here(top) && inner_line && typo_fits => false,
            Some(_) if unclosed_fits && !typo_fits => true,
            Some(_) if unclosed_fits && top.line == token.line => {
                !inner_line && self.closes_two(bracket)
            }
            Some(_) if unclosed_fits => true,
            // Any other bracket missing at the end is reported there.
            Some(_) if next[0].kind == TokenKind::End => !typo_fits,
            _ => false,
        };
        match (enclosing, outer) {
            (Some(index), true) => {
                self.close_unclosed(index + 1);
                self.close_top()
            }
            _ if !top.blamed
                && !doubled
                && (typo_fits || (here(top) && top.line != token.line)) =>
            {
                let message = format!("expected `{}`, found {}", top.closer(), self.found(token));
                let help = format!("write `{}`", top.closer());
                self.lexer.faults.add_labelled(
                    token.range(),
                    message,
                    help,
                    Some((top.opener(), "opened here")),
                );
                self.close_top()
            }
            _ => {
                if !top.blamed {
                    let message = format!("unexpected {}", self.found(token));
                    self.lexer.faults.add(
                        token.range(),
                        message,
                        "remove it: it closes no bracket that is open here",
                    );
                }
                self.advance();
                // Without the bracket, the comma after it separates the values on both sides.
                if self.token.kind == TokenKind::Comma {
                    State::Comma
                } else {
                    state
                }
            }
        }
    }

    /// Returns true if the brackets on the rest of the line balance better when the current token
    /// closes an outer container opened on this line than when it is a mistyped closing bracket of
    /// the innermost.
    pub(crate) fn closes_two(&self, bracket: Bracket) -> bool {
        let rest = self.lexer.text.get(self.token.end as usize..).unwrap_or("");
        // The scan is limited: in a file on a single line, each misplaced bracket would scan all of
        // it.
        let line = rest.bytes().take(4096).take_while(|&b| b != b'\n');
        let (opener, closer) = (bracket.opener() as u8, bracket.closer() as u8);
        let closing = line.fold(0, |n, b| {
            n + isize::from(b == closer) - isize::from(b == opener)
        });
        let here = |frame: &&Frame| frame.line == self.token.line;
        let open = self
            .frames
            .iter()
            .rev()
            .take_while(here)
            .filter(|frame| frame.bracket == bracket)
            .take(4096)
            .count();
        closing < open as isize
    }

    fn close_top(&mut self) -> State {
        let token = self.token;
        if !self.ron() {
            self.check_trailing_comma();
        }
        if let Some(frame) = self.finish(token.end) {
            let early = token.fresh && token.indent < frame.indent && token.line != frame.line;
            if let (Some(from), None) = (frame.dedent.or(early.then_some(token)), &self.suspect) {
                self.suspect = Some(Suspect { frame, from });
            }
            self.previous_close = Some(token);
            if frame.keyed() {
                self.last_closed = Some(Closed {
                    frame,
                    at: token,
                    nodes: self.nodes.len(),
                    depth: self.frames.len(),
                });
            }
        }
        self.advance();
        self.after_value()
    }

    fn check_trailing_comma(&mut self) {
        let comma = self.frames.last().map_or(0, |frame| frame.comma);
        if comma > 0 && !self.lexer.faults.reported(Habit::Ron) {
            let message = format!(
                "expected a value after `,`, found {}",
                self.found(self.token)
            );
            let fault = self.lexer.faults.add(
                comma - 1..comma,
                message,
                "remove the comma: JSON does not allow one after the last value",
            );
            cure(fault, [Edit::remove(comma as usize - 1..comma as usize)]);
        }
    }

    /// Returns true if the tokens `next` can follow a value of the container `parent`.
    fn fits(&self, parent: Option<usize>, next: &[Token; 3]) -> bool {
        let [first, second, third] = next;
        let Some(parent) = parent.and_then(|index| self.frames.get(index)) else {
            return first.kind == TokenKind::End;
        };
        match first.kind {
            TokenKind::Close(bracket) => bracket == parent.bracket,
            TokenKind::Comma => match second.kind {
                TokenKind::Close(bracket) => bracket == parent.bracket,
                TokenKind::End => false,
                TokenKind::Name | TokenKind::String => {
                    (third.kind == TokenKind::Colon) == parent.keyed()
                }
                _ => !parent.keyed(),
            },
            _ => false,
        }
    }

    /// Handles the end of the text inside open brackets.
    pub(crate) fn end_of_text(&mut self) -> State {
        let token = self.token;
        let indented = self
            .frames
            .first()
            .is_some_and(|root| root.dedent.is_none());
        let only_reopened = self.frames.iter().all(|frame| frame.reopened);
        match (self.suspect, self.frames.last().copied()) {
            _ if only_reopened || self.lexer.cut_off => {}
            (Some(Suspect { frame, from }), Some(_)) if indented => match from.kind {
                TokenKind::Close(bracket) if bracket == frame.bracket => {
                    let closer = frame.closer();
                    self.lexer.faults.add_labelled(
                        from.range(),
                        format!("expected two `{closer}`, found one"),
                        format!("add `{closer}` before it"),
                        Some((frame.opener(), "opened here")),
                    );
                }
                _ => self.unclosed(frame, from, &frame.closer().to_string()),
            },
            (_, Some(innermost)) => {
                let missing: String = self
                    .frames
                    .iter()
                    .rev()
                    .take(16)
                    .map(Frame::closer)
                    .collect();
                self.unclosed(innermost, token, &missing);
            }
            (_, None) => {}
        }
        self.give_up()
    }

    /// Reports a bracket that a token shows to be unclosed: at the token, or at the bracket if it is on
    /// an earlier line. `missing` are the closing brackets of all containers that end here.
    fn unclosed(&mut self, frame: Frame, token: Token, missing: &str) {
        let closer = frame.closer();
        let is_bracket = matches!(self.lexer.slice(frame.opener()), "(" | "[" | "{");
        let is_end = token.kind == TokenKind::End;
        let (place, opener) = (self.place(token), frame.opener());
        if frame.line == token.line || is_end || !is_bracket {
            let found = self.found(token);
            let before = if is_end { "" } else { " before it" };
            self.lexer.faults.add_labelled(
                place,
                format!("expected `{closer}`, found {found}"),
                format!("add `{missing}`{before}"),
                Some((opener, "opened here")),
            );
            return;
        }
        if self.lexer.faults.ends_at(place.start) {
            return;
        }
        let found = self.found(token);
        self.lexer.faults.add_labelled(
            opener,
            format!("`{}` is not closed", frame.bracket.opener()),
            format!("add `{missing}` before {found}"),
            Some((place, "it must be closed before this")),
        );
    }

    /// Closes all containers and stops.
    pub(crate) fn give_up(&mut self) -> State {
        while !self.frames.is_empty() {
            self.finish(self.previous_end);
        }
        State::Done
    }
}
