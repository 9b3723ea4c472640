//! The part of a long scene that help at a place needs, so that no keystroke costs a tree of the
//! whole text.

use std::{ops::Range, sync::Arc};

use super::{complete, cuts::Cuts, names, paths, spot::Finder};
use crate::{
    diagnostic::error::Error,
    scene::{
        assist::{
            completion::{Completions, Hover},
            names::{Name, NameKind},
        },
        format::scene::Model,
        options::ReadOptions,
        source::Source,
    },
    text::{
        edit::Edit,
        syntax::{
            NodeId, Syntax, Tree,
            graft::{Element, OmittedElements},
        },
    },
};

/// The number of elements that are kept at the start of the list, and on each side of a place.
const AROUND: usize = 20;

/// The elements of the list of geometries that were not edited since they were found, except the
/// last one.
///
/// # Examples
///
/// ```
/// use strahl::{
///     ReadOptions, Syntax,
///     scene::{Elements, Source},
/// };
///
/// let spheres = "Sphere(radius: 1), ".repeat(100_000);
/// let mut text = format!("(geometries: [{spheres}])");
/// let mut elements = Elements::new(&Source::new(text.as_str(), Syntax::Ron));
/// let at = text.find("radius").unwrap();
/// text.insert_str(at, "ce");
/// elements.replace(at..at, 2);
/// let excerpt = elements.around(&text, Syntax::Ron, at + 2);
/// assert!(excerpt.source().text().len() < 2000);
/// let found = excerpt.completions(at + 2, &ReadOptions::new());
/// assert_eq!(found.range, at..at + 8);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Elements {
    /// Each from its start to that of the next one.
    ranges: Vec<Range<usize>>,
    /// For each, its node in the tree of the text in which it was found, and its start there.
    found: Vec<(NodeId, usize)>,
    tree: Option<Arc<Tree>>,
    /// The names in them.
    names: Vec<Name>,
}

impl Elements {
    /// Finds the elements.
    pub fn new(source: &Source) -> Self {
        let (finder, tree) = (Finder::new(source), source.tree());
        let list = tree.root().and_then(|root| finder.field(root, Model::LONG));
        let items = list.into_iter().flat_map(|list| tree.children(list));
        let items = items.map(|item| (item, tree.node(item).range().start));
        let mut found: Vec<_> = items.collect();
        let pairs = found.iter().zip(found.iter().skip(1));
        let ranges: Vec<_> = pairs.map(|(item, next)| item.1..next.1).collect();
        // Without the last, JSON would end with a comma.
        found.pop();
        let all =
            found.first().map_or(0, |first| first.1)..ranges.last().map_or(0, |last| last.end);
        let mut found = Self {
            names: names::all(&finder)
                .filter(|name| all.contains(&name.range.start))
                .collect(),
            ranges,
            found,
            tree: Some(source.shared_tree()),
        };
        // What is broken is always kept.
        for fault in tree.faults() {
            let at = fault.range.start;
            found.replace(at..at, 0);
        }
        found
    }

    /// Returns the number of bytes of the elements.
    pub fn bytes(&self) -> usize {
        self.ranges.iter().map(ExactSizeIterator::len).sum()
    }

    /// Follows the replacement of a range of the text by `inserted` bytes.
    pub fn replace(&mut self, range: Range<usize>, inserted: usize) {
        let first = self.ranges.partition_point(|one| one.end < range.start);
        let behind = self.ranges.partition_point(|one| one.start <= range.end);
        self.found.drain(first..behind.max(first));
        let edited = self.ranges.drain(first..behind.max(first));
        let edited = edited.fold(range.clone(), |all, one| {
            all.start.min(one.start)..all.end.max(one.end)
        });
        let start = |name: &Name| name.range.start;
        let [first_name, name_behind] = [edited.start, edited.end]
            .map(|at| self.names.partition_point(|name| start(name) < at));
        self.names.drain(first_name..name_behind);
        let moved = |one: &Range<usize>| {
            let moved = |at: usize| at - range.end + range.start + inserted;
            moved(one.start)..moved(one.end)
        };
        for one in self.ranges.iter_mut().skip(first) {
            *one = moved(one);
        }
        for name in self.names.iter_mut().skip(first_name) {
            name.shift(moved);
        }
    }

    /// Gives a text its tree, if that is possible without parsing all of it; otherwise it is built
    /// on first use.
    pub fn give_tree(&self, source: &Source) {
        let (Some(old), false) = (&self.tree, self.ranges.is_empty()) else {
            return;
        };
        source.set_tree(|| {
            let (near, cuts) = self.around(source.text(), source.syntax(), 0).into_parts();
            let parts = cuts.parts().map(|(at, part)| {
                let [first, behind] = [part.start, part.end]
                    .map(|end| self.ranges.partition_point(|one| one.start < end));
                let elements = self.ranges.iter().zip(&self.found);
                let elements = elements.take(behind).skip(first);
                let elements = elements.map(|(range, (node, old))| Element {
                    node: *node,
                    old: *old..old + range.len(),
                    start: range.start,
                });
                OmittedElements {
                    at,
                    elements: elements.collect(),
                }
            });
            let parts: Vec<_> = parts.collect();
            near.tree().graft(old, &parts, |range| cuts.outer(range))
        });
    }

    /// Returns the text without the elements that are far from an offset. Elements with a name are
    /// kept if a completion may offer it.
    pub fn around<'a>(&'a self, text: &'a str, syntax: Syntax, offset: usize) -> Excerpt<'a> {
        let place_of = |at: usize| self.ranges.partition_point(|one| one.end <= at);
        let near = self.ranges.partition_point(|one| one.end < offset);
        let named = self
            .names
            .iter()
            .filter(|name| name.kind == NameKind::Geometry && name.definition.is_some());
        let named = named
            .take(paths::MOST)
            .map(|name| place_of(name.range.start));
        let mut named = named.peekable();
        let mut kept = String::new();
        let mut cuts = Cuts::default();
        let mut at = 0;
        for (index, one) in self.ranges.iter().enumerate() {
            // Several names may be in one element.
            let mut is_named = false;
            while named.next_if_eq(&index).is_some() {
                is_named = true;
            }
            if is_named || index < AROUND || index.abs_diff(near) <= AROUND {
                continue;
            }
            kept += text.get(at..one.start).unwrap_or_default();
            cuts.push(kept.len(), one.len());
            at = one.end;
        }
        kept += text.get(at..).unwrap_or_default();
        Excerpt {
            source: Source::new(kept, syntax),
            cuts,
            elements: self,
            text,
        }
    }
}

/// A text without some of its elements, and what is known of these. It offers the same help as a
/// [`Source`], at the offsets of the whole text.
#[derive(Debug)]
pub struct Excerpt<'a> {
    source: Source,
    cuts: Cuts,
    elements: &'a Elements,
    /// The whole text.
    text: &'a str,
}

impl Excerpt<'_> {
    /// Returns the text that is left.
    pub const fn source(&self) -> &Source {
        &self.source
    }

    /// Returns the text that is left, and the parts that are not.
    pub fn into_parts(self) -> (Source, Cuts) {
        (self.source, self.cuts)
    }

    fn finder(&self) -> Finder<'_> {
        Finder::new(&self.source)
    }

    /// Returns the texts that fit at an offset, as [`Source::completions`].
    pub fn completions(&self, offset: usize, options: &ReadOptions) -> Completions {
        let (inner, first_cut) = (self.cuts.inner(offset), self.cuts.first());
        let found = complete::complete(&self.finder(), inner, first_cut, options);
        Completions {
            range: self.cuts.outer(&found.range),
            ..found
        }
    }

    /// Returns the meaning of the name or value at an offset, as [`Source::hover`].
    pub fn hover(&self, offset: usize) -> Option<Hover> {
        let of_name = self.name_at(offset).and_then(|name| {
            let places = self.places_of(&name);
            names::hover(name, places, self.text, self.source.syntax())
        });
        if of_name.is_some() {
            return of_name;
        }
        let found = complete::hover(&self.finder(), self.cuts.inner(offset))?;
        Some(Hover {
            range: self.cuts.outer(&found.range),
            ..found
        })
    }

    /// Returns the name at an offset, as [`Source::name_at`].
    pub fn name_at(&self, offset: usize) -> Option<Name> {
        let name = names::at(&self.finder(), self.cuts.inner(offset))?;
        Some(name.moved(|range| self.cuts.outer(range)))
    }

    /// Returns some of the names of the whole text, in its order.
    fn names(&self, is_wanted: impl Fn(&Name) -> bool) -> Vec<Name> {
        let far = self.elements.names.iter();
        let far = far.filter(|name| is_wanted(name) && self.cuts.leave_out(name.range.start));
        let finder = self.finder();
        let near = names::all(&finder).filter(|name| is_wanted(name));
        let near = near.map(|name| name.moved(|range| self.cuts.outer(range)));
        let mut names: Vec<_> = near.chain(far.cloned()).collect();
        names.sort_by_key(|name| name.range.start);
        names
    }

    /// Returns the places of a name, in the order of the text.
    pub fn places_of(&self, name: &Name) -> Vec<Name> {
        self.names(|place| place.is_of(name))
    }

    /// Returns the edits that give a thing another name everywhere.
    ///
    /// # Errors
    ///
    /// Fails if the new name is not valid, or if another thing of the kind has it.
    pub fn rename(&self, name: &Name, new: &str) -> Result<Vec<Edit>, Error> {
        let names = self.names(|other| other.kind == name.kind);
        names::rename(&names, name, new, self.source.syntax())
    }

    /// Returns the number of spaces at the start of the line that begins at an offset, as
    /// [`Source::indentation`].
    pub fn indentation(&self, line: usize) -> Option<usize> {
        self.source.indentation(self.cuts.inner(line))
    }
}
