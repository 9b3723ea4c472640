//! Text processing, mainly for RON and JSON: lines, syntax trees with byte ranges, and the
//! canonical format. Independent of scenes.

pub(crate) mod edit;
pub(crate) mod line_starts;
pub(crate) mod lines;
pub(crate) mod literal;
pub(crate) mod members;
pub(crate) mod nearest;
pub(crate) mod print;
pub(crate) mod sanitize;
pub(crate) mod stamp;
pub(crate) mod syntax;

pub use edit::Edit;
pub use line_starts::LineStarts;
pub use lines::{Columns, Lines, Position};
pub use sanitize::sanitize;
pub use stamp::{Stamp, Stamped};
