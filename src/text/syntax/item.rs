//! Items and fields: classifies the tokens inside a bracket as keys or values.

use super::fault::{Habit, cure};
use super::frame::Layout;
use super::lexer::{Bracket, Token, TokenKind, shorten};
use super::parser::{Parser, State};
use super::tree::NodeKind;
use super::value::{is_variant, starts_value};
use crate::text::edit::Edit;

impl Parser<'_> {
    /// An item, a key, or the closing bracket.
    pub(crate) fn item(&mut self) -> State {
        let token = self.token;
        let layout = match self.frames.last_mut() {
            Some(frame) => {
                if token.fresh
                    && token.indent <= frame.indent
                    && frame.line != token.line
                    && frame.dedent.is_none()
                {
                    frame.dedent = Some(token)
                        .filter(|t| !matches!(t.kind, TokenKind::Close(_) | TokenKind::End));
                }
                frame.layout
            }
            None => return State::Trailing,
        };
        match token.kind {
            TokenKind::Close(bracket) => return self.close(bracket, State::Item),
            TokenKind::End => return self.end_of_text(),
            TokenKind::Comma if token.fresh && self.frames.len() > 1 => {
                // A comma at the start of a line follows a closing bracket.
                self.close_unclosed(self.frames.len() - 1);
                return self.after_value();
            }
            TokenKind::Comma | TokenKind::Semicolon => {
                self.expected("a value", "remove it");
                self.advance();
                return State::Item;
            }
            _ => {}
        }
        if let Some(frame) = self.frames.last_mut() {
            frame.comma = 0;
        }
        if token.kind == TokenKind::Unknown && self.key_ahead() {
            self.advance();
            return State::Item;
        }
        match layout {
            Layout::Struct => self.field(),
            Layout::Map if self.ron() && !self.at_key() => {
                if let Some(frame) = self.frames.last_mut() {
                    frame.key_pending = true;
                }
                State::Value
            }
            Layout::Map => self.field(),
            Layout::Undecided => {
                let next = self.peek().kind;
                let word = token.kind == TokenKind::Name;
                let named = word && !is_variant(self.lexer.slice(token.range()));
                let keyed = self.at_key()
                    || matches!(token.kind, TokenKind::Colon | TokenKind::Equals)
                    || (word && next == TokenKind::Equals)
                    || (named
                        && next != TokenKind::Open(Bracket::Round)
                        && self.begins_value(next));
                self.decide(if keyed { Layout::Struct } else { Layout::Tuple });
                State::Item
            }
            Layout::Tuple | Layout::List => match token.kind {
                TokenKind::Colon | TokenKind::Equals => {
                    self.expected("a value", "remove it");
                    self.advance();
                    State::Item
                }
                _ if self.at_key() => self.stray_key(),
                _ => State::Value,
            },
        }
    }

    fn begins_value(&self, kind: TokenKind) -> bool {
        starts_value(kind) && kind != TokenKind::Unknown
    }

    /// Reads a key and the token after it.
    fn field(&mut self) -> State {
        let token = self.token;
        let next = self.peek().kind;
        let json = !self.ron();
        let name = if json { "a key" } else { "a field name" };
        match (token.kind, next) {
            (TokenKind::Number, TokenKind::Colon) => {
                let what = if json { "a string as key" } else { name };
                self.expected(what, "a name is written before the colon");
                self.key(NodeKind::Error)
            }
            (TokenKind::Unknown, TokenKind::Colon) => self.key(NodeKind::Error),
            (TokenKind::Unknown, _) => {
                self.advance();
                State::Item
            }
            (TokenKind::Colon | TokenKind::Equals, _) => {
                self.expected(name, "write a name before the colon");
                self.push_hole();
                self.advance();
                State::Value
            }
            (TokenKind::Name, TokenKind::Colon) => {
                if json {
                    self.tell_unquoted_key();
                }
                self.key(NodeKind::Name)
            }
            (TokenKind::String, TokenKind::Colon) => {
                let top = self.frames.last();
                if top.is_some_and(|frame| frame.layout == Layout::Struct) {
                    self.tell_quoted_field();
                }
                self.key(NodeKind::String)
            }
            (TokenKind::Name, TokenKind::Open(_))
                if is_variant(self.lexer.slice(token.range())) =>
            {
                self.misfit()
            }
            (TokenKind::Name, _) => self.key_without_colon(NodeKind::Name),
            (TokenKind::String, _) if json => self.key_without_colon(NodeKind::String),
            _ => self.misfit(),
        }
    }

    /// Reports a key without quotes in a JSON file.
    fn tell_unquoted_key(&mut self) {
        let token = self.token;
        let message = format!("expected a string as key, found {}", self.found(token));
        let key = self.lexer.slice(token.range());
        self.lexer.faults.add_once(
            Habit::UnquotedKey,
            token.range(),
            message,
            "JSON keys are written in double quotes",
            [Edit::replace(token.bytes(), format!("\"{key}\""))],
        );
    }

    /// Reports a field name with quotes in a RON file.
    fn tell_quoted_field(&mut self) {
        let token = self.token;
        let name = self.lexer.slice(token.range()).trim_matches('"');
        let help = format!("RON writes `{}:` without quotes", shorten(name));
        let is_name = !name.is_empty()
            && !name.starts_with(|first: char| first.is_ascii_digit())
            && name
                .bytes()
                .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        let bare = is_name.then(|| Edit::replace(token.bytes(), name));
        let message = format!("expected a field name, found {}", self.found(token));
        self.lexer
            .faults
            .add_once(Habit::QuotedField, token.range(), message, &help, bare);
    }

    /// Reads a key and its colon.
    fn key(&mut self, kind: NodeKind) -> State {
        self.push_node(self.token.range(), kind);
        self.drop_key()
    }

    /// Reads a key without a colon after it.
    fn key_without_colon(&mut self, kind: NodeKind) -> State {
        let key = self.token.range();
        self.push_node(key.clone(), kind);
        self.advance();
        let next = self.token;
        if next.kind == TokenKind::Equals {
            let fault = self.expected("`:`", "write `:` between a key and its value");
            cure(fault, [Edit::replace(next.bytes(), ":")]);
            self.advance();
            return State::Value;
        }
        if !self.frames.last().is_some_and(|frame| frame.blamed) {
            let what = format!("`:` after `{}`", shorten(self.lexer.slice(key)));
            self.expected(&what, "a key has a colon and a value");
        }
        if self.begins_value(next.kind) && (!next.fresh || matches!(next.kind, TokenKind::Open(_)))
        {
            return State::Value;
        }
        self.push_hole();
        if !self.ron() {
            // `{"a", "b"}`: every element has the same fault.
            self.blame();
        }
        if self.at_key() {
            State::Item
        } else {
            State::Comma
        }
    }

    pub(crate) fn blame(&mut self) {
        if let Some(frame) = self.frames.last_mut() {
            frame.blamed = true;
        }
    }

    /// Handles a token that is not a key where a key was expected.
    fn misfit(&mut self) -> State {
        let Some(top) = self.frames.last().copied() else {
            return State::Trailing;
        };
        let token = self.token;
        if token.kind == TokenKind::Open(top.bracket) && token.start == top.open_end && !self.ron()
        {
            self.lexer.faults.add(
                token.range(),
                format!("unexpected {}", self.found(token)),
                "remove it",
            );
            self.advance();
            return State::Item;
        }
        if self.ends_inner_containers(top) {
            return State::Item;
        }
        if !top.blamed {
            let what = if top.layout == Layout::Map {
                "a key"
            } else {
                "a field name"
            };
            let help = match self.token.kind {
                TokenKind::Number => "several numbers for one field stand in brackets",
                TokenKind::Name => "several values for one field stand in `[..]`",
                _ => "every value here has a name: `name: value`",
            };
            self.expected(what, help);
        }
        self.blame();
        self.push_hole();
        State::Value
    }

    /// Handles a key in the place of a value: the opening bracket before it is missing.
    pub(crate) fn missing_bracket(&mut self) -> State {
        let (bracket, layout) = match self.ron() {
            true => (Bracket::Round, Layout::Struct),
            false => (Bracket::Curly, Layout::Map),
        };
        self.expected(
            &format!("`{}`", bracket.opener()),
            "the fields of a variant stand in brackets",
        );
        self.open(self.token.start, 0, self.token, bracket, layout);
        State::Item
    }

    /// Handles `Sphere radius: 1)` and `Sphere{radius: 1}`.
    pub(crate) fn missing_parenthesis(
        &mut self,
        name: Token,
        next: Token,
        bracket: Bracket,
    ) -> State {
        self.advance();
        self.expected("`(`", "the fields of a variant stand in `(..)`");
        if let TokenKind::Open(_) = next.kind {
            self.open(
                name.start,
                name.end - name.start,
                next,
                bracket,
                Layout::Undecided,
            );
            self.advance();
            if let Some(frame) = self.frames.last_mut() {
                frame.lenient = true;
            }
        } else {
            self.open(
                name.start,
                name.end - name.start,
                name,
                bracket,
                Layout::Struct,
            );
        }
        State::Item
    }
}
