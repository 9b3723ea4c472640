//! Recognition of scenes among the files in a folder.

use std::{borrow::Cow, iter, ops::Range};

use crate::{
    scene::{format::scene::Model, recover::text::name_of, source::Source},
    text::{
        nearest::nearest,
        stamp,
        syntax::{NodeId, Syntax},
    },
};

/// Fields that are common in files other than scenes.
const COMMON: &[&str] = &["$schema", "version"];

impl Source {
    /// Returns true if the text is a scene, or may become one: it has no more than one name yet.
    pub fn may_be_scene(&self) -> bool {
        self.is_scene() || self.stamp().is_none() && self.names().count() <= 1
    }

    /// Returns the names at the root with their nodes.
    fn names(&self) -> impl Iterator<Item = (NodeId, Cow<'_, str>)> {
        let (text, tree) = (self.text(), self.tree());
        let fields = tree.root().into_iter().flat_map(|root| tree.fields(root));
        fields.map(move |(key, _)| (key, name_of(text, tree, key)))
    }

    /// Returns the place of the stamp that starts every JSON object written by this program, if
    /// there is one.
    pub(crate) fn stamp(&self) -> Option<Range<usize>> {
        if self.tree().syntax() != Syntax::Json {
            return None;
        }
        let mut names = self.names();
        let (key, _) = names.find(|(_, name)| name == stamp::KEY)?;
        Some(self.tree().node(key).range())
    }

    /// Returns true if the text is a scene or was meant to be one: it is empty, it is broken and
    /// may have been a scene, or it has a name at its root that is, or resembles, one of a scene.
    pub fn is_scene(&self) -> bool {
        if self.stamp().is_some() {
            return false;
        }
        let names = Model::FIELDS.iter().map(|field| field.name);
        let known: Vec<_> = names.filter(|name| !COMMON.contains(name)).collect();
        let is_near = |name: &str| known.contains(&name) || nearest(name, &known).is_some();
        let is_broken = !self.tree().faults().is_empty();
        self.is_empty()
            || is_broken && self.tree().syntax() == Syntax::Ron
            || self.names().any(|(_, name)| is_near(&name))
            || is_broken && known.iter().any(|name| self.has_key(name))
    }

    /// Returns true if there is only white space and comments.
    fn is_empty(&self) -> bool {
        let end = self.text().len();
        let comments = self.tree().comments().iter().map(|comment| comment.range());
        let starts = iter::once(0).chain(comments.clone().map(|comment| comment.end));
        let ends = comments.map(|comment| comment.start).chain([end]);
        let blank = |letter: char| letter.is_whitespace() || letter == '\u{feff}';
        let mut between = starts
            .zip(ends)
            .map(|(start, end)| self.text().get(start..end));
        between.all(|text| text.is_none_or(|text| text.chars().all(blank)))
    }

    /// Returns true if a quoted name comes before a colon anywhere.
    fn has_key(&self, name: &str) -> bool {
        ['"', '\''].iter().any(|quote| {
            let quoted = format!("{quote}{name}{quote}");
            let mut behind = self.text().split(&quoted).skip(1);
            behind.any(|text| text.trim_start().starts_with(':'))
        })
    }
}
