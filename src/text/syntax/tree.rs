//! The syntax tree: an arena of nodes in document order. Nothing in it is nested, so nothing has to
//! be dropped recursively.

use std::ops::Range;

use super::{fault::Fault, language::Syntax};

/// The index of a node. Ids grow in document order; a parent comes before its children.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct NodeId(pub(super) u32);

impl NodeId {
    /// Returns the id as an index into a table with [`Tree::len`] rows.
    #[must_use]
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// The kind of a node. Its value is the text at its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NodeKind {
    /// JSON `null`, RON `None`.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// A number; in RON also `inf`, `NaN`, `0x5A`, `90f64`, `b'x'`. Parsed by
    /// [`float`](super::float) and [`integer`](super::integer).
    Number,
    /// A string, quotes included; decoded by [`string`](super::string).
    String,
    /// RON `'c'`.
    Char,
    /// RON `b".."` and `br".."`.
    Bytes,
    /// A bare RON identifier: a field name, or a variant without fields.
    Name,
    /// RON `()`.
    Unit,
    /// RON `(a, b)`, `Name(a, b)`, `Name()`. Its children are the items.
    Tuple,
    /// RON `(k: v)`, `Name(k: v)`. Its children are key, value, key, value, …
    Struct,
    /// `[a, b]`. Its children are the items.
    List,
    /// RON `{k: v}`, JSON `{"k": v}`. Its children are key, value, key, value, …
    Map,
    /// A hole: an expected key or value that is missing (its range is empty) or unreadable.
    Error,
}

/// One node of a [`Tree`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(super) start: u32,
    pub(super) end: u32,
    /// `NONE` for the root.
    pub(super) parent: u32,
    /// The id after the last descendant: the next sibling, if there is one.
    pub(super) after: u32,
    pub(super) name_len: u32,
    pub(super) kind: NodeKind,
}

pub(super) const NONE: u32 = u32::MAX;

impl Node {
    /// Returns the byte range of the node. A container extends from its name or bracket to its
    /// closing bracket, or, if unclosed, to the end of its last token.
    #[must_use]
    pub(crate) fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    /// Returns the kind of the node.
    #[must_use]
    pub(crate) fn kind(&self) -> NodeKind {
        self.kind
    }

    /// Returns the container of the node; `None` for the root. The parent of a key and of its value
    /// is their struct or map.
    #[must_use]
    pub(crate) fn parent(&self) -> Option<NodeId> {
        (self.parent != NONE).then_some(NodeId(self.parent))
    }

    /// Returns the range of the name before a container's bracket: `Sphere` in `Sphere(radius: 1)`.
    #[must_use]
    pub(crate) fn name(&self) -> Option<Range<usize>> {
        (self.name_len > 0).then(|| self.start as usize..(self.start + self.name_len) as usize)
    }
}

/// The kind of a comment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CommentKind {
    /// `// …`
    Line,
    /// `/* … */`, including nested comments.
    Block,
}

/// A comment. JSON does not allow comments; one in a JSON file is kept and reported as a fault.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Comment {
    pub(super) start: u32,
    pub(super) end: u32,
    /// The kind.
    pub(crate) kind: CommentKind,
}

impl Comment {
    /// Returns its byte range, including the comment markers but not the line ending.
    #[must_use]
    pub(crate) fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// The result of parsing: nodes, comments, attributes and faults.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(super) syntax: Syntax,
    pub(super) nodes: Vec<Node>,
    pub(super) comments: Vec<Comment>,
    pub(super) attributes: Vec<Range<usize>>,
    pub(super) faults: Vec<Fault>,
}

/// The node returned for an id of another tree.
static STRANGER: Node = Node {
    start: 0,
    end: 0,
    parent: NONE,
    after: 0,
    name_len: 0,
    kind: NodeKind::Error,
};

impl Tree {
    /// Returns the syntax of the text.
    #[must_use]
    pub(crate) fn syntax(&self) -> Syntax {
        self.syntax
    }

    /// Returns the outermost value; `None` if the text has no value.
    #[must_use]
    pub(crate) fn root(&self) -> Option<NodeId> {
        (!self.nodes.is_empty()).then_some(NodeId(0))
    }

    /// Returns the last node that starts at or before an offset.
    pub(crate) fn node_before(&self, offset: usize) -> Option<NodeId> {
        let count = self
            .nodes
            .partition_point(|node| node.start as usize <= offset);
        count.checked_sub(1).map(|index| NodeId(index as u32))
    }

    /// Returns the number of nodes.
    #[must_use]
    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Returns a node of this tree; an id of another tree may give a node of [`NodeKind::Error`].
    #[must_use]
    pub(crate) fn node(&self, id: NodeId) -> &Node {
        self.nodes.get(id.index()).unwrap_or(&STRANGER)
    }

    /// Returns all node ids in document order, parents first.
    pub(crate) fn ids(&self) -> impl DoubleEndedIterator<Item = NodeId> + use<> {
        (0..self.nodes.len() as u32).map(NodeId)
    }

    /// Returns the children of a node in document order; in structs and maps, keys and values
    /// alternate. Each step takes constant time.
    #[must_use]
    pub(crate) fn children(&self, id: NodeId) -> Children<'_> {
        Children {
            tree: self,
            next: id.0.saturating_add(1),
            end: self.node(id).after,
        }
    }

    /// Returns the key and value of each field of a struct or map; empty for other nodes.
    pub(crate) fn fields(&self, id: NodeId) -> impl Iterator<Item = (NodeId, NodeId)> + '_ {
        let keyed = matches!(self.node(id).kind, NodeKind::Struct | NodeKind::Map);
        let mut children = self.children(id);
        std::iter::from_fn(move || {
            if keyed {
                children.next().zip(children.next())
            } else {
                None
            }
        })
    }

    /// The value of a key of this tree: the node behind it.
    pub(crate) fn value(&self, key: NodeId) -> NodeId {
        NodeId(self.node(key).after)
    }

    /// Finds the first opening bracket in a range that is not in a comment: that of the container
    /// whose name ends at the start of the range.
    pub(crate) fn bracket_after(&self, text: &str, mut at: usize, end: usize) -> usize {
        let open = ['(', '[', '{'];
        for comment in self.comments_in(at..end) {
            let range = comment.range();
            let between = text.get(at..range.start).unwrap_or("");
            if let Some(open) = between.find(open) {
                return at + open;
            }
            at = range.end;
        }
        let rest = text.get(at..end).unwrap_or("");
        at + rest.find(open).unwrap_or(0)
    }

    /// Returns all comments in text order.
    #[must_use]
    pub(crate) fn comments(&self) -> &[Comment] {
        &self.comments
    }

    /// Returns the comments that start inside a range of the text.
    #[must_use]
    pub(crate) fn comments_in(&self, range: Range<usize>) -> &[Comment] {
        let first = self
            .comments
            .partition_point(|c| (c.start as usize) < range.start);
        let rest = self.comments.get(first..).unwrap_or_default();
        rest.get(..rest.partition_point(|c| (c.start as usize) < range.end))
            .unwrap_or_default()
    }

    /// Returns the ranges of the attributes at the start of a RON file.
    #[must_use]
    pub(crate) fn attributes(&self) -> &[Range<usize>] {
        &self.attributes
    }

    /// Returns the syntax faults sorted by position; empty if the text is well-formed.
    #[must_use]
    pub(crate) fn faults(&self) -> &[Fault] {
        &self.faults
    }
}

/// The iterator returned by [`Tree::children`].
#[derive(Clone, Debug)]
pub(crate) struct Children<'a> {
    tree: &'a Tree,
    next: u32,
    end: u32,
}

impl Iterator for Children<'_> {
    type Item = NodeId;

    fn next(&mut self) -> Option<NodeId> {
        (self.next < self.end).then(|| {
            let id = NodeId(self.next);
            self.next = self.tree.node(id).after.max(self.next + 1);
            id
        })
    }
}
