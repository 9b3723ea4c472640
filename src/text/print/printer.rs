//! Walks the tree and prints the text.

use std::ops::Range;

use crate::text::{
    print::comments::Comments,
    syntax::{Comment, CommentKind, NodeId, NodeKind, Syntax, Tree},
};

/// Maximum line length in characters.
const WIDTH: usize = 100;
const INDENT: usize = 4;

pub(super) struct Printer<'a> {
    text: &'a str,
    tree: &'a Tree,
    line_end: &'static str,
    comments: Comments<'a>,
    /// Width of each node on one line; `None` if it must break.
    widths: Vec<Option<u8>>,
    out: String,
    indent: usize,
    /// The offset in the text up to which everything has been printed.
    done: usize,
    /// The kind of the last thing printed.
    last: Last,
}

/// The last thing printed on a line.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Last {
    /// An opening bracket.
    Bracket,
    /// A line comment; nothing can follow it on its line.
    LineComment,
    BlockComment,
    Other,
}

impl<'a> Printer<'a> {
    pub(super) fn new(text: &'a str, tree: &'a Tree, line_end: &'static str) -> Self {
        Self {
            text,
            tree,
            line_end,
            comments: Comments::new(text, tree),
            widths: widths(text, tree),
            out: String::with_capacity(text.len() + text.len() / 4),
            indent: 0,
            done: 0,
            last: Last::Other,
        }
    }

    pub(super) fn print(mut self) -> String {
        self.head();
        if let Some(root) = self.tree.root() {
            self.leading(self.tree.node(root).range().start);
            self.value(root, 0);
        }
        let end = self.text.len();
        self.trailing(end);
        self.leading_comments(end);
        self.out.push_str(self.line_end);
        self.out
    }

    /// Prints the attributes and the comments before and between them.
    fn head(&mut self) {
        let root = self.tree.root().map(|root| self.tree.node(root).range());
        let attributes = self.tree.attributes();
        let nexts = attributes.iter().skip(1).chain(&root);
        for (attribute, next) in attributes.iter().zip(nexts) {
            self.leading(attribute.start);
            // The string in an attribute is never read, so it needs no special case.
            self.push_lines(attribute.clone());
            self.last = Last::Other;
            // Comments inside the attribute have been printed with it.
            self.comments.skip_before(attribute.end);
            self.trailing(next.start);
        }
    }

    /// Prints the comments in front of `start` and moves to the place of the item that starts
    /// there.
    fn leading(&mut self, start: usize) {
        self.leading_comments(start);
        self.place(start);
    }

    /// Prints the comments in front of `end` that don't trail an earlier item.
    fn leading_comments(&mut self, end: usize) {
        while let Some(comment) = self.comments.next_before(end) {
            self.place(comment.range().start);
            self.comment(comment);
        }
    }

    /// Moves to the place of an item or comment that starts at `start`: after the block comment in
    /// front of it on the same line, or else on its own line, keeping one blank line if there are
    /// any.
    fn place(&mut self, start: usize) {
        let between = self.text.get(self.done..start).unwrap_or("");
        if self.out.is_empty() {
        } else if self.last == Last::BlockComment && !between.contains(['\n', ',']) {
            self.out.push(' ');
        } else {
            // A line with only a comma is not blank.
            let mut lines = between.split('\n').skip(1).peekable();
            let mut blank = false;
            while let Some(line) = lines.next() {
                blank |= lines.peek().is_some() && line.trim().is_empty();
            }
            self.new_line(blank && self.last != Last::Bracket);
        }
    }

    fn new_line(&mut self, blank: bool) {
        for _ in 0..=usize::from(blank) {
            self.out.push_str(self.line_end);
        }
        self.out.extend(std::iter::repeat_n(' ', self.indent));
        self.last = Last::Other;
    }

    /// Prints the comments that trail the last item, up to `end`.
    fn trailing(&mut self, end: usize) {
        for comment in self.comments.trailing(self.done, end) {
            self.out.push(' ');
            self.comment(comment);
        }
    }

    /// Prints the comments between a key or a name and `end`; returns true if there are any.
    fn inner_comments(&mut self, end: usize) -> bool {
        let mut any = false;
        while let Some(comment) = self.comments.next_before(end) {
            self.space();
            self.comment(comment);
            any = true;
        }
        any
    }

    /// Prints a space, or starts an indented line if the current one ends with a line comment.
    fn space(&mut self) {
        if self.last == Last::LineComment {
            self.indent += INDENT;
            self.new_line(false);
            self.indent -= INDENT;
        } else {
            self.out.push(' ');
        }
    }

    fn comment(&mut self, comment: &Comment) {
        self.push_lines(comment.range());
        self.last = match comment.kind {
            CommentKind::Line => Last::LineComment,
            CommentKind::Block => Last::BlockComment,
        };
    }

    /// Prints lines without trailing white space.
    fn push_lines(&mut self, range: Range<usize>) {
        let text = self.text.get(range.clone()).unwrap_or("");
        for (index, line) in text.lines().enumerate() {
            if index > 0 {
                self.out.push_str(self.line_end);
            }
            self.out.push_str(line.trim_end());
        }
        self.done = range.end;
    }

    fn push(&mut self, range: Range<usize>) {
        self.out
            .push_str(self.text.get(range.clone()).unwrap_or(""));
        self.last = Last::Other;
        self.done = range.end;
    }

    /// Prints an opening bracket that ends at `end` in the text.
    fn open(&mut self, bracket: char, end: usize) {
        self.out.push(bracket);
        self.last = Last::Bracket;
        self.done = end;
    }

    /// Prints the closing bracket of a node.
    fn close(&mut self, bracket: char, id: NodeId) {
        self.out.push(bracket);
        self.last = Last::Other;
        self.done = self.tree.node(id).range().end;
    }

    /// Returns the length of the current line in characters.
    fn column(&self) -> usize {
        let line = self.out.rfind('\n').map_or(0, |end| end + 1);
        self.out.get(line..).unwrap_or("").chars().count()
    }

    /// Prints a value, reserving `behind` characters after it on its line.
    fn value(&mut self, id: NodeId, behind: usize) {
        let node = self.tree.node(id);
        if !is_container(node.kind()) {
            return self.push(node.range());
        }
        let width = self.widths.get(id.index()).copied().flatten();
        if width.is_some_and(|width| self.column() + usize::from(width) + behind <= WIDTH) {
            self.flat(id);
        } else {
            self.broken(id);
        }
    }

    fn flat(&mut self, id: NodeId) {
        let node = self.tree.node(id);
        if !is_container(node.kind()) {
            return self.push(node.range());
        }
        if let Some(name) = node.name() {
            self.push(name);
        }
        let (open, close) = brackets(node.kind());
        self.open(open, node.range().start);
        let keyed = is_keyed(node.kind());
        for (index, child) in self.tree.children(id).enumerate() {
            if keyed && index % 2 == 1 {
                self.out.push_str(": ");
            } else if index > 0 {
                self.out.push_str(", ");
            }
            self.flat(child);
        }
        self.close(close, id);
    }

    fn broken(&mut self, id: NodeId) {
        let node = self.tree.node(id);
        let (open, close) = brackets(node.kind());
        let mut start = node.range().start;
        if let Some(name) = node.name() {
            self.push(name.clone());
            start = self
                .tree
                .bracket_after(self.text, name.end, node.range().end);
            if self.inner_comments(start) {
                match self.last {
                    Last::LineComment => self.new_line(false),
                    _ => self.out.push(' '),
                }
            }
        }
        self.open(open, start + open.len_utf8());
        self.indent += INDENT;
        self.items(id);
        self.indent -= INDENT;
        self.new_line(false);
        self.close(close, id);
    }

    fn items(&mut self, id: NodeId) {
        let node = self.tree.node(id);
        let end = node.range().end - 1;
        let mut children = self.tree.children(id).peekable();
        let first = children
            .peek()
            .map_or(end, |child| self.tree.node(*child).range().start);
        self.trailing(first);
        let keyed = is_keyed(node.kind());
        while let Some(child) = children.next() {
            self.leading(self.tree.node(child).range().start);
            let value = if keyed { children.next() } else { None };
            let next = children
                .peek()
                .map(|child| self.tree.node(*child).range().start);
            self.item(child, value);
            if next.is_some() || self.tree.syntax() == Syntax::Ron {
                self.out.push(',');
            }
            self.trailing(next.unwrap_or(end));
        }
        self.leading_comments(end);
    }

    /// Prints an element, or a key with its value.
    fn item(&mut self, first: NodeId, value: Option<NodeId>) {
        const COMMA: usize = 1;
        const COLON: usize = 1;
        let Some(value) = value else {
            return self.value(first, COMMA);
        };
        self.value(first, COLON);
        self.out.push(':');
        self.inner_comments(self.tree.node(value).range().start);
        let deeper = if self.last == Last::LineComment {
            INDENT
        } else {
            0
        };
        self.space();
        self.indent += deeper;
        self.value(value, COMMA);
        self.indent -= deeper;
    }
}

fn is_container(kind: NodeKind) -> bool {
    matches!(
        kind,
        NodeKind::Unit | NodeKind::Tuple | NodeKind::Struct | NodeKind::List | NodeKind::Map
    )
}

fn is_keyed(kind: NodeKind) -> bool {
    matches!(kind, NodeKind::Struct | NodeKind::Map)
}

fn brackets(kind: NodeKind) -> (char, char) {
    match kind {
        NodeKind::List => ('[', ']'),
        NodeKind::Map => ('{', '}'),
        _ => ('(', ')'),
    }
}

/// How long each node is on one line; `None` for those that cannot or shall not stand on one. What
/// does not fit in a byte is longer than any line.
fn widths(text: &str, tree: &Tree) -> Vec<Option<u8>> {
    let mut widths = vec![None; tree.len()];
    // A parent comes before its children, so the reverse order visits children first.
    for id in tree.ids().rev() {
        let width = width(text, tree, &widths, id);
        if let Some(place) = widths.get_mut(id.index()) {
            *place = width;
        }
    }
    widths
}

fn width(text: &str, tree: &Tree, widths: &[Option<u8>], id: NodeId) -> Option<u8> {
    const SEPARATOR: usize = 2;
    let node = tree.node(id);
    let length = |range: Range<usize>| text.get(range).map_or(0, |text| text.chars().count());
    if !is_container(node.kind()) {
        let written = text.get(node.range()).unwrap_or("");
        return u8::try_from(written.chars().count())
            .ok()
            .filter(|_| !written.contains('\n'));
    }
    let mut children = tree.children(id).peekable();
    let is_root = node.parent().is_none();
    if (is_root && children.peek().is_some()) || !tree.comments_in(node.range()).is_empty() {
        return None;
    }
    let mut width = node.name().map_or(0, length) + SEPARATOR;
    for (index, child) in children.enumerate() {
        let kind = tree.node(child).kind();
        let is_struct = is_keyed(kind) || tree.node(child).name().is_some();
        if node.kind() == NodeKind::List && is_struct {
            return None;
        }
        let separator = if index > 0 { SEPARATOR } else { 0 };
        width += separator + usize::from(widths.get(child.index()).copied().flatten()?);
    }
    u8::try_from(width).ok()
}
