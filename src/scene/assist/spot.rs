//! The place of a cursor in a scene that may be broken.

use std::{borrow::Cow, ops::Range};

use crate::{
    scene::{
        format::{
            scene::Model,
            thing::{Thing, Type},
        },
        locate::parts,
        source::Source,
    },
    text::syntax::{self, NodeId, NodeKind, Syntax, Tree},
};

/// The place of a cursor.
#[derive(Debug)]
pub(super) struct Spot<'a> {
    /// The word at the cursor, with its quotes.
    pub(super) range: Range<usize>,
    /// The part of the word that a completion replaces: up to the cursor and the rest of the word.
    pub(super) word: &'a str,
    pub(super) place: Fitting<'a>,
}

/// What fits at the place.
#[derive(Debug)]
pub(super) enum Fitting<'a> {
    /// A key of a struct, or of a JSON variant.
    Key {
        owner: Type,
        /// The keys that are already there.
        given: Vec<Cow<'a, str>>,
        /// True if a colon follows.
        has_colon: bool,
    },
    /// A value.
    Value {
        value: Type,
        /// The field that it is of.
        field: Option<(Type, Cow<'a, str>)>,
    },
    /// The path of a track.
    Path {
        /// True if a colon follows.
        has_colon: bool,
    },
}

/// A bracket around the cursor, with the type of its contents.
struct Around<'a> {
    node: NodeId,
    content: Type,
    /// The field that it is the value of.
    field: Option<(Type, Cow<'a, str>)>,
}

pub(super) struct Finder<'a> {
    pub(super) text: &'a str,
    pub(super) tree: &'a Tree,
}

const fn is_word(character: char) -> bool {
    character.is_ascii_alphanumeric() || matches!(character, '_' | '#' | '.' | '-' | '+')
}

impl<'a> Finder<'a> {
    pub(super) fn new(source: &'a Source) -> Self {
        let (text, tree) = (source.text(), source.tree());
        Self { text, tree }
    }

    pub(super) fn at(&self, range: Range<usize>) -> &'a str {
        self.text.get(range).unwrap_or_default()
    }

    pub(super) fn name(&self, key: NodeId) -> Cow<'a, str> {
        let token = self.at(self.tree.node(key).range());
        match self.tree.node(key).kind() {
            NodeKind::String => syntax::string(token, self.tree.syntax()).unwrap_or(token.into()),
            _ => syntax::name(token).into(),
        }
    }

    /// Returns the value of a field of an object, or of an entry of a map.
    pub(super) fn field(&self, owner: NodeId, name: &str) -> Option<NodeId> {
        let mut fields = self.tree.fields(owner);
        let (_, value) = fields.find(|(key, _)| self.name(*key) == name)?;
        Some(value)
    }

    /// Returns the place at an offset; `None` in a comment, and where nothing fits.
    pub(super) fn find(&self, offset: usize) -> Option<Spot<'a>> {
        self.text.get(..offset)?;
        let mut comments = self.tree.comments().iter();
        if comments.any(|comment| comment.range().start < offset && offset <= comment.range().end) {
            return None;
        }
        let range = self.word(offset);
        let around = self.around(range.start)?;
        let word = self.at(range.clone());
        let word = word.strip_prefix('"').unwrap_or(word);
        let word = word.strip_suffix('"').unwrap_or(word);
        let place = self.place(&around, &range)?;
        Some(Spot { range, word, place })
    }

    /// Returns the range of the word around an offset, or of the string with its quotes.
    fn word(&self, offset: usize) -> Range<usize> {
        let before = self.at(0..offset);
        let after = self.at(offset..self.text.len());
        let rest = after.trim_start_matches(is_word).len();
        let end = self.text.len() - rest;
        let Some(start) = self.open_quote(offset) else {
            return before.trim_end_matches(is_word).len()..end;
        };
        // A string that is not closed ends with its word.
        let close = after.find(['"', '\n', ',', '(', ')', '[', ']', '{', '}']);
        match close.map(|at| offset + at) {
            Some(close) if self.at(close..close + 1) == "\"" => start..close + 1,
            _ => start..end,
        }
    }

    /// Returns the quote that opens the string around an offset, if there is one in its line.
    fn open_quote(&self, offset: usize) -> Option<usize> {
        let before = self.at(0..offset);
        let line = before.rfind('\n').map_or(0, |end| end + 1);
        let mut open = None;
        let mut is_escaped = false;
        for (at, byte) in before.bytes().enumerate().skip(line) {
            match byte {
                _ if is_escaped => is_escaped = false,
                b'\\' => is_escaped = open.is_some(),
                b'"' if open.is_some() => open = None,
                b'"' => open = Some(at),
                _ => {}
            }
        }
        open
    }

    /// Returns the innermost container whose brackets are around an offset.
    pub(super) fn container(&self, offset: usize) -> Option<NodeId> {
        let mut found = None;
        let mut next = self.tree.root().filter(|root| self.holds(*root, offset));
        while let Some(node) = next {
            found = next;
            let mut inner = self.tree.children(node);
            next = inner.find(|child| self.holds(*child, offset));
        }
        found
    }

    /// Returns the last character before an offset that is neither space nor in a comment, and the
    /// offset behind it.
    fn before(&self, offset: usize) -> Option<(char, usize)> {
        let mut end = offset;
        loop {
            end = self.at(0..end).trim_end().len();
            let mut comments = self.tree.comments().iter().rev();
            match comments.find(|comment| comment.range().end == end) {
                Some(comment) => end = comment.range().start,
                None => break,
            }
        }
        Some((self.at(0..end).chars().next_back()?, end))
    }

    /// Returns the innermost bracket around an offset.
    fn around(&self, offset: usize) -> Option<Around<'a>> {
        let mut around = Around {
            node: self.tree.root()?,
            content: Model::of_type(),
            field: None,
        };
        if !self.holds(around.node, offset) {
            return None;
        }
        self.enter(&mut around);
        while let Some(inner) = self.inner(&around, offset) {
            around = inner;
            self.enter(&mut around);
        }
        Some(around)
    }

    /// Steps from the value of an enum to the contents of its variant, which RON writes in front of
    /// the bracket.
    fn enter(&self, around: &mut Around<'a>) {
        let Some(name) = self.tree.node(around.node).name() else {
            return;
        };
        let variant = around.content.variant(syntax::name(self.at(name)));
        if let Some(content) = variant.and_then(|variant| around.content.content(&variant)) {
            around.content = content;
        }
    }

    fn inner(&self, around: &Around<'a>, offset: usize) -> Option<Around<'a>> {
        let outer = (around.node, Some(around.content));
        let mut parts = parts(self.text, self.tree, outer);
        let (key, (node, content)) = parts.find(|(_, (value, _))| self.holds(*value, offset))?;
        Some(match key {
            Some(key) => Around {
                node,
                content: content?,
                field: Some((around.content, self.name(key))),
            },
            None => Around {
                node,
                // The only item of a tuple may be the content of a variant.
                content: content.unwrap_or(around.content),
                field: around.field.clone(),
            },
        })
    }

    /// Returns true if an offset is between the brackets of a container, or behind one that is not
    /// closed.
    fn holds(&self, id: NodeId, offset: usize) -> bool {
        let node = self.tree.node(id);
        let range = node.range();
        if !matches!(
            node.kind(),
            NodeKind::Struct | NodeKind::Map | NodeKind::List | NodeKind::Tuple | NodeKind::Unit
        ) {
            return false;
        }
        let open = match node.name() {
            Some(name) => self.tree.bracket_after(self.text, name.end, range.end),
            None => range.start,
        };
        if offset <= open {
            return false;
        }
        let last = self.tree.children(id).last();
        let last = last.map_or(open + 1, |last| self.tree.node(last).range().end);
        let is_closed = range.end > last && self.at(last..range.end).ends_with([')', ']', '}']);
        match is_closed {
            true => offset < range.end,
            // Behind a container that is not closed, up to what follows it.
            false => self
                .before(offset)
                .is_some_and(|(_, end)| end <= range.end.max(last) || end == offset),
        }
    }

    fn place(&self, around: &Around<'a>, range: &Range<usize>) -> Option<Fitting<'a>> {
        let (before, end) = self.before(range.start)?;
        let (content, kind) = (around.content, self.tree.node(around.node).kind());
        if before == ':' {
            let key = self.key_before(end - 1)?;
            return Some(Fitting::Value {
                value: content.value(&key)?,
                field: Some((content, key)),
            });
        }
        if !matches!(before, '(' | '[' | '{' | ',') {
            return None;
        }
        if matches!(content, Type::Tracks) && kind == NodeKind::Map {
            let after = self.at(range.end..self.text.len());
            let has_colon = after.trim_start().starts_with(':');
            return Some(Fitting::Path { has_colon });
        }
        let has_keys = matches!(content, Type::Object(..))
            || self.tree.syntax() == Syntax::Json && kind == NodeKind::Map;
        if has_keys && kind != NodeKind::List {
            let after = self.at(range.end..self.text.len());
            let given = self.tree.fields(around.node).map(|(key, _)| key);
            let given = given.filter(|key| !overlaps(&self.tree.node(*key).range(), range));
            return Some(Fitting::Key {
                owner: content,
                given: given.map(|key| self.name(key)).collect(),
                has_colon: after.trim_start().starts_with(':'),
            });
        }
        Some(Fitting::Value {
            value: content.element().unwrap_or(content),
            field: around.field.clone(),
        })
    }

    /// Returns the key whose colon is at an offset.
    fn key_before(&self, colon: usize) -> Option<Cow<'a, str>> {
        let (_, end) = self.before(colon)?;
        let before = self.at(0..end);
        match before.strip_suffix('"') {
            Some(quoted) => quoted.rsplit('"').next().map(Cow::from),
            None => Some(self.at(before.trim_end_matches(is_word).len()..end).into()),
        }
    }
}

fn overlaps(one: &Range<usize>, other: &Range<usize>) -> bool {
    one.start < other.end && other.start < one.end || one == other
}
