//! A text with its tree.

use std::sync::OnceLock;

use crate::text::syntax::{self, Syntax, Tree};

/// A text with its tree, which is built on first use.
#[derive(Debug)]
pub(crate) struct Source {
    text: String,
    syntax: Syntax,
    tree: OnceLock<Tree>,
}

impl Source {
    pub(crate) const fn new(text: String, syntax: Syntax) -> Self {
        Self {
            text,
            syntax,
            tree: OnceLock::new(),
        }
    }

    pub(crate) fn into_text(self) -> String {
        self.text
    }

    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    pub(crate) const fn syntax(&self) -> Syntax {
        self.syntax
    }

    /// Drops the tree to save its memory; it is built again when it is needed.
    pub(crate) fn drop_tree(&mut self) {
        self.tree.take();
    }

    pub(crate) fn tree(&self) -> &Tree {
        self.tree_until(|| false)
    }

    /// Returns the tree. Once `stop` returns true, the tree is incomplete and must not be used.
    pub(crate) fn tree_until(&self, stop: impl Fn() -> bool) -> &Tree {
        self.tree
            .get_or_init(|| syntax::parse_until(&self.text, self.syntax, stop))
    }
}
