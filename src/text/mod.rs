//! RON and JSON as text: its tree with a place on every node, its one layout, its lines. Knows no scene.

pub(crate) mod lines;
pub(crate) mod literal;
pub(crate) mod nearest;
pub(crate) mod print;
pub(crate) mod stamp;
pub(crate) mod syntax;
pub(crate) mod visible;
