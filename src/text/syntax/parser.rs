//! The parser: a state machine over a stack of open brackets. Misplaced tokens are handled in
//! `recover` and `close`.

use std::ops::Range;

use super::frame::{Closed, Frame, Layout, Suspect};
use super::lexer::{Bracket, Lexer, Token, TokenKind, shorten};
use super::trivia;
use super::value::{ends_value, starts_value};
use super::{
    MAX_DEPTH, attribute,
    fault::{Fault, cure},
};
use super::{
    language::Syntax,
    tree::{NONE, Node, NodeKind, Tree},
};
use crate::text::edit::Edit;

/// With more open brackets, the rest of the text is not read: a frame takes fifty times the memory
/// of its bracket.
const MOST_FRAMES: usize = 10_000;

/// The expected next element.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    /// An item, a key, or the closing bracket.
    Item,
    /// A value, after a colon or as the root.
    Value,
    /// The colon after a key that was read as a value.
    Colon,
    /// A comma or the closing bracket.
    Comma,
    /// The end of the text.
    Trailing,
    Done,
}

pub(super) struct Parser<'t> {
    pub(crate) lexer: Lexer<'t>,
    pub(crate) token: Token,
    pub(crate) ahead: Option<Token>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) frames: Vec<Frame>,
    /// Indices of the frames with keys, to find the innermost one without a search.
    pub(crate) keyed: Vec<u32>,
    /// Indices of the frames for each kind of bracket.
    pub(crate) by_bracket: [Vec<u32>; 3],
    /// The end of the previous token.
    pub(crate) previous_end: u32,
    pub(crate) last_closed: Option<Closed>,
    /// The last closing bracket that closed a container.
    pub(crate) previous_close: Option<Token>,
    pub(crate) suspect: Option<Suspect>,
    told_depth: bool,
}

impl<'t> Parser<'t> {
    pub(crate) fn new(text: &'t str, syntax: Syntax) -> Self {
        let lexer = Lexer::new(text, syntax);
        let start = lexer.pos as u32;
        Parser {
            lexer,
            token: Token {
                kind: TokenKind::End,
                fresh: false,
                start,
                end: start,
                line: 0,
                indent: 0,
            },
            ahead: None,
            nodes: Vec::new(),
            frames: Vec::new(),
            keyed: Vec::new(),
            by_bracket: Default::default(),
            previous_end: start,
            last_closed: None,
            previous_close: None,
            suspect: None,
            told_depth: false,
        }
    }

    /// Parses the text; returns a partial tree once `stop` returns true.
    pub(crate) fn run(mut self, stop: impl Fn() -> bool) -> Tree {
        /// Number of steps between two calls of `stop`.
        const STEPS: u32 = 1 << 16;
        let syntax = self.lexer.syntax;
        if self.lexer.text.len() >= NONE as usize {
            let message = "the file is too large: 4 GiB or more".to_owned();
            let faults = vec![Fault {
                range: 0..0,
                message,
                help: None,
                label: None,
                fix: Vec::new(),
                nameless: None,
                is_of_value: false,
                habit: None,
            }];
            return Tree {
                syntax,
                nodes: Vec::new(),
                comments: Vec::new(),
                attributes: Vec::new(),
                faults,
            };
        }
        let attributes = if syntax == Syntax::Ron {
            attribute::read(&mut self.lexer)
        } else {
            Vec::new()
        };
        self.token = self.lexer.next();
        let mut state = if self.token.kind == TokenKind::End {
            self.empty()
        } else if self.at_key() {
            self.bare_fields()
        } else {
            State::Value
        };
        let mut steps = 0_u32;
        while state != State::Done {
            steps = steps.wrapping_add(1);
            if steps.is_multiple_of(STEPS) && stop() {
                break;
            }
            state = match state {
                State::Item => self.item(),
                State::Value => self.value(),
                State::Colon => self.colon(),
                State::Comma => self.comma(),
                State::Trailing => self.trailing(),
                State::Done => break,
            };
        }
        let Lexer {
            text,
            comments,
            faults,
            ..
        } = self.lexer;
        let mut faults = faults.into_sorted();
        if let Some(fault) = faults.iter_mut().find(|fault| fault.range.is_empty()) {
            trivia::blame_carriage_return(text, &comments, fault);
        }
        Tree {
            syntax,
            nodes: self.nodes,
            comments,
            attributes,
            faults,
        }
    }

    fn empty(&mut self) -> State {
        if !self.lexer.cut_off {
            let help = "a scene has at least `camera` and `geometries`";
            let at = self.previous_end..self.previous_end;
            self.lexer
                .faults
                .add(at, "expected a scene, found an empty file".into(), help);
        }
        State::Done
    }

    /// Handles a file of fields without brackets around them.
    fn bare_fields(&mut self) -> State {
        let (what, bracket, layout) = match self.lexer.syntax {
            Syntax::Ron => ("`(`", Bracket::Round, Layout::Struct),
            Syntax::Json => ("`{`", Bracket::Curly, Layout::Map),
        };
        self.expected(what, "a scene is written in brackets");
        self.open(self.token.start, 0, self.token, bracket, layout);
        if let Some(frame) = self.frames.last_mut() {
            frame.reopened = true;
        }
        State::Item
    }

    pub(crate) fn ron(&self) -> bool {
        self.lexer.syntax == Syntax::Ron
    }

    pub(crate) fn advance(&mut self) {
        self.previous_end = self.token.end;
        self.token = match self.ahead.take() {
            Some(token) => token,
            None => self.lexer.next(),
        };
    }

    /// Returns the token after the current one.
    pub(crate) fn peek(&mut self) -> Token {
        match self.ahead {
            Some(token) => token,
            None => *self.ahead.insert(self.lexer.next()),
        }
    }

    /// Returns true if the current token is a key with its colon.
    pub(crate) fn at_key(&mut self) -> bool {
        matches!(self.token.kind, TokenKind::Name | TokenKind::String)
            && self.peek().kind == TokenKind::Colon
    }

    pub(crate) fn push_node(&mut self, range: Range<u32>, kind: NodeKind) -> u32 {
        let id = self.nodes.len() as u32;
        let parent = self.frames.last().map_or(NONE, |frame| frame.node);
        let node = Node {
            start: range.start,
            end: range.end,
            parent,
            after: id + 1,
            name_len: 0,
            kind,
        };
        self.nodes.push(node);
        id
    }

    /// Adds a hole where a node is missing.
    pub(crate) fn push_hole(&mut self) {
        self.push_node(self.previous_end..self.previous_end, NodeKind::Error);
    }

    pub(crate) fn leaf(&mut self, kind: NodeKind) -> State {
        self.push_node(self.token.range(), kind);
        self.advance();
        self.after_value()
    }

    pub(crate) fn after_value(&mut self) -> State {
        match self.frames.last_mut() {
            None => State::Trailing,
            Some(frame) if frame.key_pending => {
                frame.key_pending = false;
                State::Colon
            }
            Some(_) => State::Comma,
        }
    }

    /// Opens a container that starts at `start` and whose bracket is `at`.
    pub(crate) fn open(
        &mut self,
        start: u32,
        name_len: u32,
        at: Token,
        bracket: Bracket,
        layout: Layout,
    ) {
        if self.frames.len() >= MAX_DEPTH && !self.told_depth {
            self.told_depth = true;
            let message = format!("nested too deep: more than {MAX_DEPTH} open brackets");
            self.lexer.faults.add(
                at.range(),
                message,
                "nest less, or put what is inside into a file of its own",
            );
        }
        if self.frames.len() >= MOST_FRAMES {
            self.ahead = None;
            self.lexer.pos = self.lexer.text.len();
            self.lexer.cut_off = true;
        }
        let kind = match layout {
            Layout::List => NodeKind::List,
            Layout::Map => NodeKind::Map,
            Layout::Struct => NodeKind::Struct,
            Layout::Undecided | Layout::Tuple => NodeKind::Tuple,
        };
        let node = self.push_node(start..at.end, kind);
        if let Some(node) = self.nodes.get_mut(node as usize) {
            node.name_len = name_len;
        }
        let index = self.frames.len() as u32;
        self.by_bracket(bracket).push(index);
        if matches!(layout, Layout::Map | Layout::Struct) {
            self.keyed.push(index);
        }
        self.frames.push(Frame {
            node,
            open: at.start,
            open_end: at.end,
            line: at.line,
            indent: at.indent,
            bracket,
            layout,
            key_pending: false,
            blamed: false,
            lenient: bracket == Bracket::Round && self.lexer.syntax == Syntax::Json,
            reopened: false,
            comma: 0,
            dedent: None,
        });
    }

    pub(crate) fn by_bracket(&mut self, bracket: Bracket) -> &mut Vec<u32> {
        let [round, square, curly] = &mut self.by_bracket;
        match bracket {
            Bracket::Round => round,
            Bracket::Square => square,
            Bracket::Curly => curly,
        }
    }

    /// Sets the layout of the innermost bracket.
    pub(crate) fn decide(&mut self, layout: Layout) {
        let index = self.frames.len() as u32;
        if let Some(frame) = self.frames.last_mut() {
            frame.layout = layout;
            let kind = match layout {
                Layout::Struct => NodeKind::Struct,
                Layout::Map => NodeKind::Map,
                _ => return,
            };
            self.keyed.push(index - 1);
            if let Some(node) = self.nodes.get_mut(frame.node as usize) {
                node.kind = kind;
            }
        }
    }

    fn colon(&mut self) -> State {
        match self.token.kind {
            TokenKind::Colon => {
                self.advance();
                return State::Value;
            }
            TokenKind::Equals => {
                self.expected("`:`", "write `:` between a key and its value");
                self.advance();
                return State::Value;
            }
            _ => {}
        }
        let blamed = self
            .frames
            .last_mut()
            .is_some_and(|frame| std::mem::replace(&mut frame.blamed, true));
        if !blamed {
            self.expected("`:`", "a map has a key, a colon and a value for each entry");
        }
        if starts_value(self.token.kind) && !self.token.fresh {
            return State::Value;
        }
        self.push_hole();
        State::Comma
    }

    fn comma(&mut self) -> State {
        let token = self.token;
        match token.kind {
            TokenKind::Comma => {
                if let Some(frame) = self.frames.last_mut() {
                    frame.comma = token.start + 1;
                }
                self.advance();
                State::Item
            }
            TokenKind::Close(bracket) => self.close(bracket, State::Comma),
            TokenKind::End => self.end_of_text(),
            TokenKind::Semicolon => {
                let fault = self.expected_separator("values are separated by commas");
                cure(fault, [Edit::replace(token.bytes(), ",")]);
                self.advance();
                State::Item
            }
            TokenKind::Unknown => {
                self.spoil_value();
                self.advance();
                if starts_value(self.token.kind) && !self.token.fresh {
                    self.blame();
                    return State::Item;
                }
                State::Comma
            }
            TokenKind::Colon | TokenKind::Equals => {
                // `1color: …`: the unreadable token before the colon was a key.
                if self
                    .nodes
                    .last()
                    .is_none_or(|node| node.kind != NodeKind::Error)
                {
                    self.expected_separator("a field has one colon");
                }
                if let Some(frame) = self.frames.last_mut() {
                    frame.blamed = true;
                }
                self.advance();
                State::Item
            }
            _ => self.missing_comma(),
        }
    }

    /// Takes an unreadable token behind a value without brackets as a part of it, if nothing else
    /// follows.
    fn spoil_value(&mut self) {
        let token = self.token;
        let is_last = !token.fresh && ends_value(self.peek().kind);
        let end = self.previous_end;
        if is_last
            && let Some(node) = self.nodes.last_mut()
            && node.end == end
            && !matches!(
                node.kind,
                NodeKind::Struct | NodeKind::Map | NodeKind::Tuple | NodeKind::List
            )
        {
            (node.kind, node.end) = (NodeKind::Error, token.end);
            self.lexer.faults.blame_value(token.start);
        }
    }

    /// Describes a token for a message.
    pub(crate) fn found(&self, token: Token) -> String {
        match token.kind {
            TokenKind::End => "the end of the file".to_owned(),
            _ => format!("`{}`", shorten(self.lexer.slice(token.range()))),
        }
    }

    /// Returns the range of a fault about a token.
    pub(crate) fn place(&self, token: Token) -> Range<u32> {
        if token.kind == TokenKind::End {
            self.previous_end..self.previous_end
        } else {
            token.range()
        }
    }

    /// Reports the current token where `what` was expected.
    pub(crate) fn expected(&mut self, what: &str, help: &str) -> Option<&mut Fault> {
        if self.token.kind == TokenKind::End && self.lexer.cut_off {
            return None;
        }
        let message = format!("expected {what}, found {}", self.found(self.token));
        self.lexer.faults.add(self.place(self.token), message, help)
    }

    pub(crate) fn expected_separator(&mut self, help: &str) -> Option<&mut Fault> {
        let closer = self.frames.last().map_or(')', Frame::closer);
        self.expected(&format!("`,` or `{closer}`"), help)
    }
}
