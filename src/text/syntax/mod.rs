//! One error-tolerant reader for RON and JSON text.
//!
//! [`parse`] turns any text into a [`Tree`] with a byte range on every node, the comments, and the list of syntax faults. It never fails,
//! never recurses and takes time linear in the text. It decides what is well-formed: it takes what `ron` and `serde_json` take, which
//! random texts hold it to.
//!
//! # Where a fault is put
//!
//! On the token that was found in the place of what was expected: a missing comma on the first token of the next value, a missing closing
//! bracket on the token before which it should have stood. At the end of the text that is the empty range behind the last token. A fault
//! inside a token (an escape, a number) covers the part that is wrong. Two faults never start at the same byte, and they come in the
//! order of their places.
//!
//! Habits of the other syntax (comments or unquoted keys in JSON, quoted field names in RON) are reported at their first place only.

mod attribute;
mod close;
mod decimal;
mod fault;
mod frame;
mod item;
mod lexer;
mod lookalike;
mod number;
mod parser;
mod quote;
mod recover;
#[cfg(test)]
pub(crate) mod tests;
mod text;
mod tree;
mod trivia;
mod unusual;
mod value;
mod which;

pub(crate) use decimal::Decimal;
pub(crate) use fault::{Fault, MAX_FAULTS};
pub(crate) use number::{NumberError, float, integer};
pub(crate) use text::{name, string};
pub(crate) use tree::{Children, Comment, CommentKind, Kind, NodeId, Tree};
pub(crate) use trivia::{block_comment, line_comment};
pub use which::Syntax;

/// How many brackets may be open at once: what `serde_json` allows; `ron` gives up earlier, how much depends on the types.
pub(crate) const MAX_DEPTH: usize = 127;

/// Reads a text of any content.
///
/// A byte order mark at its head is skipped; offsets count from the start of `text` as given. A text of 4 GiB or more is not read: its
/// tree is empty and has one fault.
#[must_use]
pub(crate) fn parse(text: &str, syntax: Syntax) -> Tree {
    parse_until(text, syntax, || false)
}

/// The same; once `stop` says so, it ends early with a part of the tree.
pub(crate) fn parse_until(text: &str, syntax: Syntax, stop: impl Fn() -> bool) -> Tree {
    parser::Parser::new(text, syntax).run(stop)
}
