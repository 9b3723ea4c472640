//! An error-tolerant parser for RON and JSON.
//!
//! [`parse`] turns any text into a [`Tree`] with a byte range for every node, the comments, and the
//! list of syntax faults. It never fails, never recurses, and takes time linear in the text. It
//! decides what is well-formed: it accepts what `ron` and `serde_json` accept, as tests with random
//! texts verify.
//!
//! # Fault positions
//!
//! A fault is placed on the token found instead of the expected one: a missing comma on the first
//! token of the next value, a missing closing bracket on the token before which it should be, or on
//! its opening bracket if that is on an earlier line. At the end of the text it is the empty range after the last token. A fault inside a token (an
//! escape, a number) covers the part that is wrong. Two faults never start at the same byte, and
//! faults are sorted by position.
//!
//! Habits of the other syntax (comments or unquoted keys in JSON, quoted field names in RON) are
//! reported at their first occurrence only.

mod arithmetic;
mod attribute;
mod close;
mod confusables;
mod decimal;
mod fault;
mod frame;
pub(crate) mod graft;
mod invalid;
mod item;
mod language;
mod lexer;
mod number;
mod parser;
mod quote;
mod recover;
#[cfg(test)]
pub(crate) mod tests;
mod text;
mod tree;
mod trivia;
mod value;

pub(crate) use decimal::Decimal;
pub(crate) use fault::{Fault, max_faults};
pub use language::Syntax;
pub(crate) use number::{NumberError, float, whole};
pub(crate) use text::{name, string};
pub(crate) use tree::{Children, Comment, CommentKind, NodeId, NodeKind, Tree};
pub(crate) use trivia::{block_comment, line_comment};

/// Maximum number of open brackets, as in `serde_json`; the limit of `ron` is lower and depends on
/// the types.
pub(crate) const MAX_DEPTH: usize = 127;

/// Parses any text.
///
/// A byte order mark at the start is skipped; offsets count from the start of `text` as given. A
/// text of 4 GiB or more is not read: its tree is empty and has one fault.
#[must_use]
pub(crate) fn parse(text: &str, syntax: Syntax) -> Tree {
    parse_until(text, syntax, || false)
}

/// Like [`parse`], but ends early with a partial tree once `stop` returns true.
pub(crate) fn parse_until(text: &str, syntax: Syntax, stop: impl Fn() -> bool) -> Tree {
    parser::Parser::new(text, syntax).run(stop)
}
