//! Recovery from misplaced keys and values: finds the wrong bracket before them, so that one slip
//! gives one fault.

use super::fault::cure;
use super::frame::{Frame, Layout};
use super::lexer::{Bracket, Token, TokenKind, shorten};
use super::parser::{Parser, State};
use super::tree::{NodeId, NodeKind};
use super::value::{is_variant, starts_value};
use crate::text::edit::Edit;

impl Parser<'_> {
    /// Returns the three tokens after the current one without consuming them.
    pub(crate) fn look(&mut self) -> [Token; 3] {
        let first = self.peek();
        let place = self.lexer.place();
        let second = self.lexer.next();
        let third = self.lexer.next();
        self.lexer.reset(place);
        [first, second, third]
    }

    /// Returns true if the token after the current one is a key with its colon.
    pub(crate) fn key_ahead(&mut self) -> bool {
        let [first, second, _] = self.look();
        matches!(first.kind, TokenKind::Name | TokenKind::String) && second.kind == TokenKind::Colon
    }

    /// Handles a value or a key where a comma was expected: the comma is missing, or a closing
    /// bracket before it.
    pub(crate) fn missing_comma(&mut self) -> State {
        let token = self.token;
        let Some(top) = self.frames.last().copied() else {
            return State::Trailing;
        };
        let key = self.at_key();
        if key && top.keyed() {
            let mut depth = self.frames.len();
            // A key indented no deeper than the line of the bracket belongs to an outer container.
            while let [.., outer, inner] = self.keyed.as_slice()
                && token.fresh
                && self
                    .frames
                    .get(*inner as usize)
                    .is_some_and(|f| f.line != token.line && token.indent <= f.indent)
            {
                depth = *outer as usize + 1;
                self.keyed.pop();
            }
            if depth < self.frames.len() {
                self.close_unclosed(depth);
                return State::Item;
            }
        } else if key {
            return self.stray_key();
        } else if self.ends_inner_containers(top) {
            return State::Item;
        }
        if !top.blamed {
            let end = self.previous_end as usize;
            let fault = self.expected_separator("add a comma after the value before it");
            cure(fault, [Edit::insert(end, ",")]);
        }
        if top.keyed() && !key && !starts_value(self.peek().kind) {
            self.blame();
        }
        State::Item
    }

    /// Handles a variant in the place of a key inside an outer list: the containers open inside
    /// that list are unclosed.
    pub(crate) fn ends_inner_containers(&mut self, top: Frame) -> bool {
        if top.bracket == Bracket::Square || (top.layout == Layout::Map && self.ron()) {
            return false;
        }
        let variant = match self.token.kind {
            TokenKind::Name => {
                let open = TokenKind::Open(Bracket::Round);
                is_variant(self.lexer.slice(self.token.range())) && self.peek().kind == open
            }
            TokenKind::Open(Bracket::Curly) => !self.ron(),
            _ => false,
        };
        let list = self
            .by_bracket(Bracket::Square)
            .last()
            .map(|&index| index as usize + 1);
        match list {
            Some(depth) if variant => {
                self.close_unclosed(depth);
                true
            }
            _ => false,
        }
    }

    /// Handles a key in a list or tuple.
    pub(crate) fn stray_key(&mut self) -> State {
        let token = self.token;
        let Some(top) = self.frames.last().copied() else {
            return State::Trailing;
        };
        if top.layout == Layout::Tuple && (top.blamed || self.colon_lost(top)) {
            return self.drop_key();
        }
        let dedented = token.fresh && token.indent <= top.indent;
        if top.layout == Layout::Tuple && !dedented && self.names_lost(top) {
            return self.drop_key();
        }
        let text = self.lexer.slice(token.range()).trim_start_matches('"');
        if is_variant(text) && (self.ron() || top.bracket == Bracket::Square) {
            return self.missing_bracket();
        }
        if top.layout == Layout::List && !dedented && self.nodes.len() == top.node as usize + 1 {
            return self.list_with_keys(top);
        }
        if !dedented && self.reopen() {
            return State::Item;
        }
        if let Some(&index) = self.keyed.last() {
            self.close_unclosed(index as usize + 1);
            return State::Item;
        }
        if !top.blamed {
            self.expected("a value", "field names stand in `(..)`, not in a list");
        }
        self.drop_key()
    }

    /// Handles `[radius: 1)`: the opening bracket is wrong, whichever closes it.
    fn list_with_keys(&mut self, top: Frame) -> State {
        let (wanted, layout) = if self.ron() {
            ("(", Layout::Struct)
        } else {
            ("{", Layout::Map)
        };
        let message = format!("expected `{wanted}`, found `[`");
        self.lexer
            .faults
            .add(top.opener(), message, "a list has no field names");
        self.decide(layout);
        if let Some(frame) = self.frames.last_mut() {
            frame.lenient = true;
        }
        State::Item
    }

    /// Skips a key that has no place in the tree.
    pub(crate) fn drop_key(&mut self) -> State {
        self.advance();
        self.advance();
        State::Value
    }

    /// Handles `Sphere(center (0, 0, 0), radius: 1)`: the apparent tuple has fields, and the first
    /// one lacks its colon.
    fn colon_lost(&mut self, top: Frame) -> bool {
        let Some(first) = self.nodes.get(top.node as usize + 1).copied() else {
            return false;
        };
        let name = first.start..first.start + first.name_len;
        let text = self.lexer.slice(name.clone());
        if text.is_empty() || is_variant(text) || first.parent != top.node {
            return false;
        }
        let message = format!("expected `:` after `{}`", shorten(text));
        self.lexer
            .faults
            .add(name, message, "a key has a colon and a value");
        self.blame();
        true
    }

    /// Handles `Union([…], color: …)`: the values before the key lack the names of their fields. In
    /// `Named("gold", color: …` it is the closing bracket that is missing.
    fn names_lost(&mut self, top: Frame) -> bool {
        let Some(owner) = self.nodes.get(top.node as usize).copied() else {
            return false;
        };
        let Some(first) = self.nodes.get(top.node as usize + 1).copied() else {
            return false;
        };
        let name = self.lexer.slice(owner.start..owner.start + owner.name_len);
        let is_string = first.kind == NodeKind::String && first.after as usize == self.nodes.len();
        // A value behind the bracket, and a key on a later line: the bracket is not closed.
        let before = self.lexer.slice(top.open_end..first.start);
        let is_later = self.token.line != top.line && !before.contains('\n');
        if !is_variant(name) || is_string || is_later || self.closes_two(top.bracket) {
            return false;
        }
        let key = self.lexer.slice(self.token.range());
        let text = self.lexer.slice(first.start..first.end);
        let message = format!("expected a field name, found `{}`", shorten(text));
        let label = format!("`{}` has a name", shorten(key));
        let fault = self.lexer.faults.add_labelled(
            first.start..first.end,
            message,
            "every value here has a name: `name: value`".to_owned(),
            Some((self.token.range(), &label)),
        );
        if let Some(fault) = fault {
            fault.nameless = Some(NodeId(top.node + 1));
        }
        self.blame();
        true
    }

    /// Reverts the last closing bracket if it closed a container with keys and only a comma has
    /// followed.
    fn reopen(&mut self) -> bool {
        let Some(closed) = self.last_closed.take() else {
            return false;
        };
        if closed.nodes != self.nodes.len() || closed.depth != self.frames.len() {
            return false;
        }
        if !closed.frame.blamed {
            let message = format!("unexpected {}", self.found(closed.at));
            let label = Some((closed.frame.opener(), "closes this, but more of it follows"));
            self.lexer
                .faults
                .add_labelled(closed.at.range(), message, "remove it".into(), label);
        }
        let index = self.frames.len() as u32;
        self.keyed.push(index);
        self.by_bracket(closed.frame.bracket).push(index);
        self.frames.push(Frame {
            reopened: true,
            comma: 0,
            ..closed.frame
        });
        true
    }

    /// Handles the text after the root value.
    pub(crate) fn trailing(&mut self) -> State {
        match self.token.kind {
            TokenKind::End => return State::Done,
            TokenKind::Close(_) => {
                let message = format!("unexpected {}", self.found(self.token));
                self.lexer.faults.add(
                    self.token.range(),
                    message,
                    "remove it: every bracket is closed already",
                );
                return State::Done;
            }
            _ => {}
        }
        let more = self.at_key() || (self.token.kind == TokenKind::Comma && self.key_ahead());
        if more && self.reopen() {
            return if self.token.kind == TokenKind::Comma {
                State::Comma
            } else {
                State::Item
            };
        }
        self.expected("the end of the file", "a file holds one scene");
        State::Done
    }
}
