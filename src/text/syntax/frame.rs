//! Open brackets, and brackets closed in a suspicious place.

use std::ops::Range;

use super::lexer::{Bracket, Token};

/// The content of a bracket.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// `(` with nothing in it yet.
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
    /// The bracket, or the name in front of it if the bracket is missing; `line` is the line it is
    /// on.
    pub(crate) open: u32,
    pub(crate) open_end: u32,
    pub(crate) line: u32,
    pub(crate) indent: u32,
    pub(crate) bracket: Bracket,
    pub(crate) layout: Layout,
    /// True while the value being read is a map key.
    pub(crate) key_pending: bool,
    /// Set once the form of its items has been reported wrong; not reported again.
    pub(crate) blamed: bool,
    /// True if the bracket is a slip; any closing bracket matches it.
    pub(crate) lenient: bool,
    /// True if it was reopened because its closing bracket came too early; it may stay open.
    pub(crate) reopened: bool,
    /// The start of the comma after the last item, plus one.
    pub(crate) comma: u32,
    /// The first item indented no deeper than the line of the bracket; it may belong to an outer
    /// container.
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

/// The last closed container with keys, kept in case its bracket came too early.
#[derive(Clone, Copy)]
pub(super) struct Closed {
    pub(crate) frame: Frame,
    pub(crate) at: Token,
    /// Number of nodes when it was closed; `depth` is the number of brackets around it.
    pub(crate) nodes: usize,
    pub(crate) depth: usize,
}

/// A container whose items from some point on, or whose closing bracket, are indented like those of
/// an outer container.
#[derive(Clone, Copy)]
pub(super) struct Suspect {
    pub(crate) frame: Frame,
    pub(crate) from: Token,
}
