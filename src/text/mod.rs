//! Text, of RON and JSON above all: lines, a tree with places, one layout. Knows no scene.

pub(crate) mod edit;
pub(crate) mod lines;
pub(crate) mod literal;
pub(crate) mod nearest;
pub(crate) mod print;
pub(crate) mod sanitize;
pub(crate) mod stamp;
pub(crate) mod syntax;

pub use edit::Edit;
pub use lines::{Columns, Lines, Position};
pub use sanitize::sanitize;
pub use stamp::{Stamp, Stamped};
