//! The tree: an arena of nodes in document order, so that nothing in it nests and nothing has to be dropped recursively.

use std::ops::Range;

use super::{fault::Fault, which::Syntax};

/// The index of a node. Ids grow in document order; a parent comes before its children.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct NodeId(pub(super) u32);

impl NodeId {
    /// The id as an index into a table with [`Tree::len`] rows.
    #[must_use]
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// What a node is. What it says stands in the text at its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// JSON `null`, RON `None`.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// A number; RON: also `inf`, `NaN`, `0x5A`, `90f64`, `b'x'`. [`float`](super::float) and [`integer`](super::integer) read it.
    Number,
    /// A string, quotes included; [`string`](super::string) decodes it.
    String,
    /// RON `'c'`.
    Char,
    /// RON `b".."` and `br".."`.
    Bytes,
    /// A bare RON identifier: a field's name, a variant without fields.
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
    /// A hole: a key or a value was expected, and there is none (its range is empty) or it is unreadable.
    Error,
}

/// One node of a [`Tree`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(super) start: u32,
    pub(super) end: u32,
    /// `NONE` for the root.
    pub(super) parent: u32,
    /// The id behind the last descendant: the next sibling, if there is one.
    pub(super) after: u32,
    pub(super) name_len: u32,
    pub(super) kind: Kind,
}

pub(super) const NONE: u32 = u32::MAX;

impl Node {
    /// The bytes of the text that the node covers: a container from its name or bracket to its closing bracket; one that is not closed to
    /// the end of its last token.
    #[must_use]
    pub(crate) fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    /// What the node is.
    #[must_use]
    pub(crate) fn kind(&self) -> Kind {
        self.kind
    }

    /// The container around the node; `None` for the root. The parent of a key and of its value is their struct or map.
    #[must_use]
    pub(crate) fn parent(&self) -> Option<NodeId> {
        (self.parent != NONE).then_some(NodeId(self.parent))
    }

    /// The range of the name before a container's bracket: `Sphere` in `Sphere(radius: 1)`.
    #[must_use]
    pub(crate) fn name(&self) -> Option<Range<usize>> {
        (self.name_len > 0).then(|| self.start as usize..(self.start + self.name_len) as usize)
    }
}

/// Whether a comment ends with its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CommentKind {
    /// `// …`
    Line,
    /// `/* … */`, nested ones included.
    Block,
}

/// A comment. JSON has none; one that stands there all the same is kept and a fault.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Comment {
    pub(super) start: u32,
    pub(super) end: u32,
    /// Its kind.
    pub(crate) kind: CommentKind,
}

impl Comment {
    /// Its bytes, marks included, the line's end not.
    #[must_use]
    pub(crate) fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// What was read: nodes, comments, attributes, faults.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(super) syntax: Syntax,
    pub(super) nodes: Vec<Node>,
    pub(super) comments: Vec<Comment>,
    pub(super) attributes: Vec<Range<usize>>,
    pub(super) faults: Vec<Fault>,
}

/// Stands in for an id of another tree.
static STRANGER: Node = Node {
    start: 0,
    end: 0,
    parent: NONE,
    after: 0,
    name_len: 0,
    kind: Kind::Error,
};

impl Tree {
    /// The syntax it was read as.
    #[must_use]
    pub(crate) fn syntax(&self) -> Syntax {
        self.syntax
    }

    /// The outermost value; `None` where the text has no value at all.
    #[must_use]
    pub(crate) fn root(&self) -> Option<NodeId> {
        (!self.nodes.is_empty()).then_some(NodeId(0))
    }

    /// The number of nodes.
    #[must_use]
    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// A node of this tree; an id of another tree may give a node [`Kind::Error`].
    #[must_use]
    pub(crate) fn node(&self, id: NodeId) -> &Node {
        self.nodes.get(id.index()).unwrap_or(&STRANGER)
    }

    /// All nodes in document order, parents first.
    pub(crate) fn ids(&self) -> impl DoubleEndedIterator<Item = NodeId> + use<> {
        (0..self.nodes.len() as u32).map(NodeId)
    }

    /// The children of a node in document order; keys and values take turns in structs and maps. A step costs constant time.
    #[must_use]
    pub(crate) fn children(&self, id: NodeId) -> Children<'_> {
        Children {
            tree: self,
            next: id.0.saturating_add(1),
            end: self.node(id).after,
        }
    }

    /// Key and value of each field of a struct or map; nothing for another node.
    pub(crate) fn fields(&self, id: NodeId) -> impl Iterator<Item = (NodeId, NodeId)> + '_ {
        let keyed = matches!(self.node(id).kind, Kind::Struct | Kind::Map);
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

    /// Where the first bracket in a range opens that is in no comment: that of a container whose
    /// name ends where the range starts.
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

    /// The comments in the order of the text.
    #[must_use]
    pub(crate) fn comments(&self) -> &[Comment] {
        &self.comments
    }

    /// The comments that start inside a range of the text.
    #[must_use]
    pub(crate) fn comments_in(&self, range: Range<usize>) -> &[Comment] {
        let first = self
            .comments
            .partition_point(|c| (c.start as usize) < range.start);
        let rest = self.comments.get(first..).unwrap_or_default();
        rest.get(..rest.partition_point(|c| (c.start as usize) < range.end))
            .unwrap_or_default()
    }

    /// The attributes at the head of a RON file.
    #[must_use]
    pub(crate) fn attributes(&self) -> &[Range<usize>] {
        &self.attributes
    }

    /// The syntax faults in the order of their places; none: the text is well-formed.
    #[must_use]
    pub(crate) fn faults(&self) -> &[Fault] {
        &self.faults
    }
}

/// The iterator of [`Tree::children`].
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
