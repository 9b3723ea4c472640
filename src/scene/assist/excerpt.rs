//! The part of a long scene that help at a place needs, so that no keystroke costs a tree of the
//! whole text.

use std::ops::Range;

use super::spot::Finder;
use crate::{
    scene::{format::scene::Model, source::Source},
    text::syntax::Syntax,
};

/// The number of elements on each side of a place that are kept.
const AROUND: usize = 20;

/// The elements of the list of geometries that were not edited since they were found.
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
/// assert!(excerpt.source().text().len() < 1000);
/// let found = excerpt.source().completions(excerpt.inner(at + 2), &ReadOptions::new());
/// assert_eq!(excerpt.outer(&found.range), at..at + 8);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Elements {
    /// Each from its start to that of the next one.
    ranges: Vec<Range<usize>>,
}

impl Elements {
    /// Finds the elements.
    pub fn new(source: &Source) -> Self {
        let (text, tree) = (source.text(), source.tree());
        let finder = Finder { text, tree };
        let mut fields = tree.root().into_iter().flat_map(|root| tree.fields(root));
        let list = fields.find(|(key, _)| finder.name(*key) == Model::LONG);
        let items = list.into_iter().flat_map(|(_, list)| tree.children(list));
        let items: Vec<_> = items.map(|item| tree.node(item).range()).collect();
        let next = items.iter().skip(1).map(|item| item.start);
        let ends = next.chain(items.last().map(|item| item.end));
        let ranges = items.iter().zip(ends).map(|(item, end)| item.start..end);
        let mut found = Self {
            ranges: ranges.collect(),
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
        self.ranges.drain(first..behind.max(first));
        for one in self.ranges.iter_mut().skip(first) {
            let moved = |at: usize| at - range.end + range.start + inserted;
            *one = moved(one.start)..moved(one.end);
        }
    }

    /// Returns the text without the elements that are far from an offset.
    pub fn around(&self, text: &str, syntax: Syntax, offset: usize) -> Excerpt {
        let near = self.ranges.partition_point(|one| one.end < offset);
        let far = |index: usize| index.abs_diff(near) > AROUND;
        let mut kept = String::new();
        let mut cuts: Vec<Cut> = Vec::new();
        let mut at = 0;
        let ranges = self.ranges.iter().enumerate();
        for (_, one) in ranges.filter(|(index, _)| far(*index)) {
            kept += text.get(at..one.start).unwrap_or_default();
            match cuts.last_mut() {
                Some(last) if at == one.start => last.removed += one.len(),
                _ => cuts.push(Cut {
                    at: kept.len(),
                    removed: one.len(),
                }),
            }
            at = one.end;
        }
        kept += text.get(at..).unwrap_or_default();
        Excerpt {
            source: Source::new(kept, syntax),
            cuts,
        }
    }
}

/// A text without some of its parts.
#[derive(Debug)]
pub struct Excerpt {
    source: Source,
    cuts: Vec<Cut>,
}

/// A part that was left out.
#[derive(Debug)]
struct Cut {
    /// The offset in the excerpt.
    at: usize,
    /// The number of bytes.
    removed: usize,
}

impl Excerpt {
    /// Returns the text that is left.
    pub const fn source(&self) -> &Source {
        &self.source
    }

    /// Returns the offset in the excerpt of one in the whole text.
    pub fn inner(&self, offset: usize) -> usize {
        let mut removed = 0;
        for cut in &self.cuts {
            let start = cut.at + removed;
            if offset <= start {
                break;
            }
            removed += cut.removed.min(offset - start);
        }
        offset - removed
    }

    /// Returns the range in the whole text of one in the excerpt.
    pub fn outer(&self, range: &Range<usize>) -> Range<usize> {
        let before = |offset: usize| {
            let cuts = self.cuts.iter().take_while(|cut| cut.at <= offset);
            cuts.map(|cut| cut.removed).sum::<usize>()
        };
        // A range never spans a cut near the place that was asked for.
        let removed = before(range.start);
        range.start + removed..range.end + removed
    }
}
