//! Help with writing a scene: what fits at a place, what something means, and where the colors are.
//! All of it derives from the types of the format and the tree of the text, which may be broken.

mod colors;
mod complete;
pub(crate) mod completion;
mod cuts;
mod excerpt;
mod files;
mod folds;
pub(crate) mod names;
mod paths;
mod sample;
mod source;
mod spot;
mod symbols;
#[cfg(test)]
mod tests;

pub use cuts::Cuts;
pub use excerpt::{Elements, Excerpt};
pub use files::FileLink;
pub use folds::Fold;
pub use symbols::{Symbol, SymbolKind};
