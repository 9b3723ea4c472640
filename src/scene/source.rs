//! A text with its tree.

use std::sync::{Arc, OnceLock};

use crate::text::{
    print,
    syntax::{self, Syntax, Tree},
};

/// A text with its tree, which is built on first use. Nothing is checked: it offers what an editor
/// needs of the newest text, however broken.
///
/// # Examples
///
/// ```
/// use strahl::{ReadOptions, Syntax, scene::Source};
///
/// let source = Source::new("(camera: Perspective(fo", Syntax::Ron);
/// let found = source.completions(source.text().len(), &ReadOptions::new());
/// assert!(found.items.iter().any(|item| item.insert == "fov: "));
/// ```
#[derive(Debug)]
pub struct Source {
    text: String,
    syntax: Syntax,
    tree: OnceLock<Arc<Tree>>,
}

impl Source {
    /// Creates the source of a text.
    pub fn new(text: impl Into<String>, syntax: Syntax) -> Self {
        Self {
            text: text.into(),
            syntax,
            tree: OnceLock::new(),
        }
    }

    /// Returns the text, and drops the tree.
    pub fn into_text(self) -> String {
        self.text
    }

    /// Returns the text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the syntax.
    pub const fn syntax(&self) -> Syntax {
        self.syntax
    }

    /// Returns the text in the canonical format; `None` if it has syntax faults.
    pub fn format(&self) -> Option<String> {
        let is_clean = self.tree().faults().is_empty();
        is_clean.then(|| {
            let mut formatted = print::format(&self.text, self.tree());
            if self.text.starts_with('\u{feff}') {
                formatted.insert(0, '\u{feff}');
            }
            formatted
        })
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
        self.shared_until(stop)
    }

    fn shared_until(&self, stop: impl Fn() -> bool) -> &Arc<Tree> {
        self.tree
            .get_or_init(|| syntax::parse_until(&self.text, self.syntax, stop).into())
    }

    /// Returns the tree, to keep it longer than the source.
    pub(crate) fn shared_tree(&self) -> Arc<Tree> {
        Arc::clone(self.shared_until(|| false))
    }

    pub(crate) fn has_tree(&self) -> bool {
        self.tree.get().is_some()
    }

    /// Gives the source its tree, if it has none yet and `build` knows it.
    pub(crate) fn set_tree(&self, build: impl FnOnce() -> Option<Tree>) {
        if !self.has_tree()
            && let Some(tree) = build()
        {
            // Another thread may have been faster, with the same tree.
            let _ = self.tree.set(tree.into());
        }
    }
}
