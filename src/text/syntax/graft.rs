//! A tree that is put together from two others, so that an edit of a long list costs no parsing of
//! all of it.

use std::ops::Range;

use super::tree::{Comment, NONE, Node, NodeId, NodeKind, Tree};

/// Elements of a list that were left out of a text.
pub(crate) struct OmittedElements {
    /// The offset where they were left out: that of the next element.
    pub(crate) at: usize,
    pub(crate) elements: Vec<Element>,
}

/// An element of an older text.
pub(crate) struct Element {
    /// Its node in the tree of the older text.
    pub(crate) node: NodeId,
    /// Its range there, up to the next element.
    pub(crate) old: Range<usize>,
    /// Its offset in the whole text.
    pub(crate) start: usize,
}

impl Element {
    /// Returns a place in the whole text of one in the older text.
    fn place(&self, [start, end]: [u32; 2]) -> [u32; 2] {
        [start, end].map(|at| (at as usize - self.old.start + self.start) as u32)
    }
}

impl Tree {
    /// Returns the tree of a whole text from `self`, that of the text without some parts, and `old`,
    /// the tree of an older text with their elements; `outer` returns the range in the whole text of
    /// one in the text without the parts. `None` if what was left out may change the rest: if there
    /// are faults, or if a comment or a string goes on behind a part.
    pub(crate) fn graft(
        &self,
        old: &Self,
        parts: &[OmittedElements],
        outer: impl Fn(&Range<usize>) -> Range<usize>,
    ) -> Option<Self> {
        if !self.faults.is_empty() {
            return None;
        }
        let outer = |[start, end]: [u32; 2]| {
            let range = outer(&(start as usize..end as usize));
            [range.start as u32, range.end as u32]
        };
        // The node that each part is in front of, and the number of new nodes up to there.
        let mut fronts: Vec<(u32, u32)> = Vec::new();
        let mut added = 0;
        for part in parts {
            let front = self
                .nodes
                .partition_point(|node| (node.start as usize) < part.at);
            let next = self.nodes.get(front)?;
            let list = self.node(next.parent()?);
            if next.start as usize != part.at || list.kind != NodeKind::List {
                return None;
            }
            let counts = part.elements.iter();
            added += counts
                .map(|one| old.node(one.node).after - one.node.0)
                .sum::<u32>();
            fronts.push((front as u32, added));
        }
        let added_until = |is_until: &dyn Fn(u32) -> bool| {
            let count = fronts.partition_point(|(front, _)| is_until(*front));
            count
                .checked_sub(1)
                .and_then(|last| fronts.get(last))
                .map_or(0, |(_, added)| *added)
        };
        let moved = |id: u32| match id {
            NONE => NONE,
            id => id + added_until(&|front| front <= id),
        };
        let mut nodes = Vec::with_capacity(self.nodes.len() + added as usize);
        let mut comments: Vec<Comment> = Vec::new();
        let mut next = fronts.iter().zip(parts).peekable();
        for (id, node) in self.nodes.iter().enumerate() {
            if let Some((_, part)) = next.next_if(|((front, _), _)| *front as usize == id) {
                for one in &part.elements {
                    let (first, base) = (one.node.0, nodes.len() as u32);
                    let inside = old
                        .nodes
                        .get(first as usize..old.node(one.node).after as usize)?;
                    nodes.extend(inside.iter().map(|inner| {
                        let [start, end] = one.place([inner.start, inner.end]);
                        Node {
                            start,
                            end,
                            parent: inner.parent.wrapping_sub(first).wrapping_add(base),
                            after: inner.after - first + base,
                            ..*inner
                        }
                    }));
                    if let Some(element) = nodes.get_mut(base as usize) {
                        element.parent = moved(node.parent);
                    }
                    comments.extend(old.comments_in(one.old.clone()).iter().map(|comment| {
                        let [start, end] = one.place([comment.start, comment.end]);
                        Comment {
                            start,
                            end,
                            ..*comment
                        }
                    }));
                }
            }
            let [start, end] = outer([node.start, node.end]);
            let has_children = node.after as usize > id + 1;
            if !has_children && end - start != node.end - node.start {
                return None;
            }
            nodes.push(Node {
                start,
                end,
                parent: moved(node.parent),
                // The next sibling may be new.
                after: node.after + added_until(&|front| front < node.after),
                ..*node
            });
        }
        for comment in &self.comments {
            let [start, end] = outer([comment.start, comment.end]);
            if end - start != comment.end - comment.start {
                return None;
            }
            comments.push(Comment {
                start,
                end,
                ..*comment
            });
        }
        comments.sort_by_key(|comment| comment.start);
        Some(Self {
            syntax: self.syntax,
            nodes,
            comments,
            attributes: self.attributes.clone(),
            faults: Vec::new(),
        })
    }
}
