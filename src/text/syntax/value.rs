//! Values: handles the tokens found where a value is expected.

use super::fault::{Habit, cure};
use super::frame::Layout;
use super::lexer::{Bracket, TokenKind, shorten};
use super::number;
use super::parser::{Parser, State};
use super::tree::NodeKind;
use crate::text::edit::Edit;

impl Parser<'_> {
    pub(crate) fn value(&mut self) -> State {
        let token = self.token;
        match token.kind {
            TokenKind::Number => self.leaf(NodeKind::Number),
            TokenKind::String if self.at_key() && self.in_field() => self.missing_value(),
            TokenKind::String => self.leaf(NodeKind::String),
            TokenKind::Char => self.leaf(NodeKind::Char),
            TokenKind::Bytes => self.leaf(NodeKind::Bytes),
            TokenKind::Open(bracket) => {
                let layout = match bracket {
                    Bracket::Round => Layout::Undecided,
                    Bracket::Square => Layout::List,
                    Bracket::Curly => Layout::Map,
                };
                if bracket == Bracket::Round && !self.ron() {
                    self.tell_ron();
                }
                self.open(token.start, 0, token, bracket, layout);
                self.advance();
                State::Item
            }
            TokenKind::Name => self.name(),
            TokenKind::Unknown => {
                let next = self.peek();
                let glued = next.start == token.end
                    && matches!(
                        next.kind,
                        TokenKind::Number
                            | TokenKind::String
                            | TokenKind::Name
                            | TokenKind::Open(_)
                    );
                if glued {
                    self.advance();
                    return State::Value;
                }
                if ends_value(next.kind) {
                    self.lexer.faults.blame_value(token.start);
                }
                self.leaf(NodeKind::Error)
            }
            TokenKind::Colon | TokenKind::Equals => {
                self.expected("a value", "remove it");
                self.advance();
                State::Value
            }
            TokenKind::Close(_) | TokenKind::Comma | TokenKind::Semicolon | TokenKind::End => {
                self.missing_value()
            }
        }
    }

    /// Returns true if the expected value is that of a field; a key in its place means that the
    /// value is missing.
    fn in_field(&self) -> bool {
        self.frames
            .last()
            .is_some_and(|frame| frame.keyed() && !frame.key_pending)
    }

    /// Reads a value that starts with a name.
    fn name(&mut self) -> State {
        let token = self.token;
        let text = self.lexer.slice(token.range());
        let next = self.peek();
        if next.kind == TokenKind::Colon && self.in_field() {
            return self.missing_value();
        }
        if !self.ron() {
            return self.json_word(text);
        }
        match next.kind {
            TokenKind::Open(Bracket::Round) => {
                self.advance();
                self.open(
                    token.start,
                    token.end - token.start,
                    next,
                    Bracket::Round,
                    Layout::Undecided,
                );
                self.advance();
                return State::Item;
            }
            // ron accepts `Some 5` for `Some(5)`; the scene format has no `Some`.
            TokenKind::Open(_)
            | TokenKind::Name
            | TokenKind::Number
            | TokenKind::String
            | TokenKind::Char
            | TokenKind::Bytes
                if text == "Some" =>
            {
                self.expected("a value", "write the value itself, without `Some`");
                self.advance();
                return State::Value;
            }
            TokenKind::Open(bracket) if !next.fresh => {
                return self.missing_parenthesis(token, next, bracket);
            }
            TokenKind::Name
                if is_variant(text)
                    && !is_literal(text)
                    && (!next.fresh || next.indent > token.indent)
                    && self.key_ahead() =>
            {
                return self.missing_parenthesis(token, next, Bracket::Round);
            }
            _ => {}
        }
        self.leaf(match text {
            "true" => NodeKind::Bool(true),
            "false" => NodeKind::Bool(false),
            "None" => NodeKind::Null,
            _ if number::ron_word(text).is_some() => NodeKind::Number,
            _ => NodeKind::Name,
        })
    }

    fn json_word(&mut self, text: &str) -> State {
        let kind = match text {
            "null" => NodeKind::Null,
            "true" => NodeKind::Bool(true),
            "false" => NodeKind::Bool(false),
            _ => NodeKind::Error,
        };
        if kind == NodeKind::Error {
            if let TokenKind::Open(bracket) = self.peek().kind {
                // `Sphere(…)`: the node of the bracket represents the variant.
                self.tell_ron();
                let (token, at) = (self.token, self.peek());
                self.advance();
                let layout = match bracket {
                    Bracket::Round => Layout::Undecided,
                    Bracket::Square => Layout::List,
                    Bracket::Curly => Layout::Map,
                };
                self.open(token.start, token.end - token.start, at, bracket, layout);
                self.advance();
                return State::Item;
            }
            let (help, written) = match text.to_ascii_lowercase().as_str() {
                "true" => ("JSON writes `true`", Some("true".to_owned())),
                "false" => ("JSON writes `false`", Some("false".to_owned())),
                "none" | "nil" | "undefined" => ("JSON writes `null`", Some("null".to_owned())),
                "nan" | "inf" | "infinity" => ("JSON only supports finite numbers", None),
                _ => (
                    "strings are written in double quotes",
                    Some(format!("\"{text}\"")),
                ),
            };
            if !self.lexer.faults.reported(Habit::Ron) {
                let token = self.token.bytes();
                let fault = self.expected("a value", help);
                cure(fault, written.map(|written| Edit::replace(token, written)));
            }
            self.lexer.cut_off |= self.token.end as usize == self.lexer.text.len();
        }
        self.leaf(kind)
    }

    /// Reports RON syntax in a JSON file.
    fn tell_ron(&mut self) {
        if self.nodes.is_empty() && !self.lexer.faults.reported(Habit::Ron) {
            // Comments at the start are part of the same mistake.
            self.lexer.faults.clear();
        }
        let message = format!("expected a JSON value, found {}", self.found(self.token));
        let help = "this looks like RON: give the file the extension `.ron`, or convert it";
        self.lexer
            .faults
            .add_once(Habit::Ron, self.token.range(), message, help, None);
    }

    fn missing_value(&mut self) -> State {
        let Some(frame) = self.frames.last().copied() else {
            self.expected("a scene", "a scene starts with an opening bracket");
            return self.give_up();
        };
        let key = self.nodes.get(self.nodes.len().wrapping_sub(1)).copied();
        let key = key
            .filter(|node| frame.keyed() && node.end > node.start)
            .map(|node| self.lexer.slice(node.start..node.end));
        if (!self.token.fresh || !self.ron()) && self.at_key() {
            // `"Sphere": "center": …`, `camera: Perspectiveeye: …`
            let found = self.lexer.slice(self.token.range());
            if [key.unwrap_or(""), found]
                .into_iter()
                .any(|text| is_variant(text.trim_start_matches('"')))
            {
                return self.missing_bracket();
            }
        }
        match key {
            Some(key) => self.expected(
                &format!("a value for `{}`", shorten(key)),
                "write the value after the colon",
            ),
            None => self.expected("a value", "write a value here"),
        };
        self.push_hole();
        // A key without a comma before it is part of the same slip.
        if self.at_key() {
            State::Item
        } else {
            self.after_value()
        }
    }
}

/// Returns true for what follows a whole value.
pub(super) fn ends_value(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Comma | TokenKind::Close(_))
}

pub(super) fn starts_value(kind: TokenKind) -> bool {
    use TokenKind::{Bytes, Char, Name, Number, Open, String, Unknown};
    matches!(
        kind,
        Open(_) | Name | Number | String | Char | Bytes | Unknown
    )
}

/// Returns true if a RON word is a value by itself.
fn is_literal(word: &str) -> bool {
    matches!(word, "true" | "false" | "None") || number::ron_word(word).is_some()
}

/// Returns true if a name is spelled like a variant: `Sphere`, not `radius`.
pub(super) fn is_variant(name: &str) -> bool {
    name.chars().next().is_some_and(char::is_uppercase)
}
