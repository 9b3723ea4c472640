//! The open brackets, and those closed in an odd place.

use std::ops::Range;

use super::lexer::{Bracket, Token};

/// What a bracket holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// `(`, and nothing in it yet.
    Undecided,
    Tuple,
    Struct,
    List,
    Map,
}

/// An open bracket.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub(crate) node: u32,
    /// Its bracket (the name in front of it, if that is missing), and the line that this stands on.
    pub(crate) open: u32,
    pub(crate) open_end: u32,
    pub(crate) line: u32,
    pub(crate) indent: u32,
    pub(crate) bracket: Bracket,
    pub(crate) layout: Layout,
    /// The value being read is a key of a map.
    pub(crate) key_pending: bool,
    /// Told once that its items are of the wrong form: not again.
    pub(crate) blamed: bool,
    /// Its bracket is a slip, and any closing bracket will do.
    pub(crate) lenient: bool,
    /// Open again because its closing bracket came too early; it may stay open.
    pub(crate) reopened: bool,
    /// The start of the comma behind the last item, plus one.
    pub(crate) comma: u32,
    /// The first item that is indented no deeper than the line of the bracket: it may belong further out.
    pub(crate) dedent: Option<Token>,
}

impl Frame {
    pub(crate) fn keyed(&self) -> bool {
        matches!(self.layout, Layout::Struct | Layout::Map)
    }

    pub(crate) fn closer(&self) -> char {
        self.bracket.closer()
    }

    pub(crate) fn opener(&self) -> Range<u32> {
        self.open..self.open_end
    }
}

/// The container with keys that was closed last, in case its bracket came too early.
#[derive(Clone, Copy)]
pub(super) struct Closed {
    pub(crate) frame: Frame,
    pub(crate) at: Token,
    /// How many nodes there were, and how many brackets around it.
    pub(crate) nodes: usize,
    pub(crate) depth: usize,
}

/// A container whose items were, from one on, indented like those of a container further out, or its closing bracket was.
#[derive(Clone, Copy)]
pub(super) struct Suspect {
    pub(crate) frame: Frame,
    pub(crate) from: Token,
}
