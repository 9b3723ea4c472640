//! Walks the tree and writes the text anew.

use std::ops::Range;

use crate::scene::{
    fmt::comments::Comments,
    syntax::{Comment, CommentKind, Kind, NodeId, Syntax, Tree},
};

/// How long a line may be, in characters.
const WIDTH: usize = 100;
const INDENT: usize = 4;

pub(super) struct Printer<'a> {
    text: &'a str,
    tree: &'a Tree,
    comments: Comments<'a>,
    /// How long each node is on one line; `None` where it cannot stand on one.
    widths: Vec<Option<usize>>,
    out: String,
    indent: usize,
    /// The offset in the text up to which everything has been written.
    done: usize,
    /// Whether the line ends with a line comment, so that nothing can follow on it.
    line_is_full: bool,
}

impl<'a> Printer<'a> {
    pub(super) fn new(text: &'a str, tree: &'a Tree) -> Self {
        Self {
            text,
            tree,
            comments: Comments::new(text, tree),
            widths: widths(text, tree),
            out: String::with_capacity(text.len() + text.len() / 4),
            indent: 0,
            done: 0,
            line_is_full: false,
        }
    }

    pub(super) fn print(mut self) -> String {
        self.head();
        if let Some(root) = self.tree.root() {
            self.leading(self.tree.node(root).range().start);
            self.value(root, 0);
        }
        let end = self.text.len();
        while let Some(comment) = self.comments.next_trailing(self.done, end) {
            self.trailing(comment);
        }
        self.own_lines(end);
        self.out.push('\n');
        self.out
    }

    /// Attributes and the comments before and between them.
    fn head(&mut self) {
        for attribute in self.tree.attributes() {
            self.leading(attribute.start);
            self.push(attribute.clone());
            let next = self.text.len();
            while let Some(comment) = self.comments.next_trailing(self.done, next) {
                self.trailing(comment);
            }
        }
    }

    /// Goes to a line for what starts at `start`, with the comments in front of it.
    fn leading(&mut self, start: usize) {
        while let Some(comment) = self.comments.next_before(start) {
            self.place(comment.range().start);
            self.comment(comment);
        }
        self.place(start);
    }

    /// Writes comments that nothing follows, each on its line.
    fn own_lines(&mut self, end: usize) {
        while let Some(comment) = self.comments.next_before(end) {
            self.place(comment.range().start);
            self.comment(comment);
        }
    }

    /// Goes to where something that starts at `start` belongs: behind a comment that stands in
    /// front of it on its line, else on a line of its own, after one blank line if there are any.
    fn place(&mut self, start: usize) {
        let between = self.text.get(self.done..start).unwrap_or("");
        let behind_comment = self.out.ends_with("*/") && !between.contains('\n');
        if self.out.is_empty() {
        } else if behind_comment && !between.contains(',') && !self.line_is_full {
            self.out.push(' ');
        } else {
            let opened = self.out.ends_with(['(', '[', '{']);
            let blank = between.matches('\n').count() > 1;
            self.new_line(blank && !opened);
        }
    }

    fn new_line(&mut self, blank: bool) {
        self.out.push_str(if blank { "\n\n" } else { "\n" });
        self.out.extend(std::iter::repeat_n(' ', self.indent));
        self.line_is_full = false;
    }

    fn trailing(&mut self, comment: &Comment) {
        self.out.push(' ');
        self.comment(comment);
    }

    fn comment(&mut self, comment: &Comment) {
        let range = comment.range();
        let text = self.text.get(range.clone()).unwrap_or("");
        for (index, line) in text.lines().enumerate() {
            if index > 0 {
                self.out.push('\n');
            }
            self.out.push_str(line.trim_end());
        }
        self.line_is_full = comment.kind == CommentKind::Line;
        self.done = range.end;
    }

    fn push(&mut self, range: Range<usize>) {
        let text = self.text.get(range.clone()).unwrap_or("");
        if text.contains('\r') {
            self.out.push_str(&text.replace("\r\n", "\n"));
        } else {
            self.out.push_str(text);
        }
        self.done = range.end;
    }

    /// How many characters stand on the line.
    fn column(&self) -> usize {
        let line = self.out.rfind('\n').map_or(0, |end| end + 1);
        self.out.get(line..).unwrap_or("").chars().count()
    }

    /// Writes a value, with room for `behind` characters on its line.
    fn value(&mut self, id: NodeId, behind: usize) {
        let node = self.tree.node(id);
        let width = self.widths.get(id.index()).copied().flatten();
        let fits = width.is_some_and(|width| self.column() + width + behind <= WIDTH);
        let is_leaf = !is_container(node.kind());
        // `()` is one, unless a comment stands inside.
        if is_leaf && !Comments::any_in(self.tree, node.range()) {
            self.push(node.range());
        } else if fits {
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
        self.out.push(open);
        let keyed = is_keyed(node.kind());
        for (index, child) in self.tree.children(id).enumerate() {
            if keyed && index % 2 == 1 {
                self.out.push_str(": ");
            } else if index > 0 {
                self.out.push_str(", ");
            }
            self.flat(child);
        }
        self.out.push(close);
        self.done = node.range().end;
    }

    fn broken(&mut self, id: NodeId) {
        let node = self.tree.node(id);
        let (open, close) = brackets(node.kind());
        if let Some(name) = node.name() {
            let end = node.range().end;
            self.push(name.clone());
            // Comments between the name and its bracket.
            let rest = self.bracket_after(name.end, end);
            let mut commented = false;
            while let Some(comment) = self.comments.next_before(rest) {
                self.trailing(comment);
                commented = true;
            }
            match (commented, self.line_is_full) {
                (true, true) => self.new_line(false),
                (true, false) => self.out.push(' '),
                (false, _) => {}
            }
            self.done = rest;
        } else {
            self.done = node.range().start;
        }
        self.out.push(open);
        self.done += open.len_utf8();
        self.indent += INDENT;
        self.items(id);
        self.indent -= INDENT;
        self.new_line(false);
        self.out.push(close);
        self.done = node.range().end;
    }

    /// Where the bracket behind a name opens: behind white space and comments.
    fn bracket_after(&self, mut at: usize, end: usize) -> usize {
        for comment in self.tree.comments_in(at..end) {
            let range = comment.range();
            let between = self.text.get(at..range.start).unwrap_or("");
            if let Some(open) = between.find(['(', '[', '{']) {
                return at + open;
            }
            at = range.end;
        }
        let rest = self.text.get(at..end).unwrap_or("");
        at + rest.find(['(', '[', '{']).unwrap_or(0)
    }

    fn items(&mut self, id: NodeId) {
        let node = self.tree.node(id);
        let end = node.range().end - 1;
        let mut children = self.tree.children(id).peekable();
        let first = children
            .peek()
            .map_or(end, |child| self.tree.node(*child).range().start);
        while let Some(comment) = self.comments.next_trailing(self.done, first) {
            self.trailing(comment);
        }
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
            while let Some(comment) = self.comments.next_trailing(self.done, next.unwrap_or(end)) {
                self.trailing(comment);
            }
        }
        self.own_lines(end);
    }

    /// An element, or a key with its value.
    fn item(&mut self, first: NodeId, value: Option<NodeId>) {
        const COMMA: usize = 1;
        let Some(value) = value else {
            return self.value(first, COMMA);
        };
        self.push(self.tree.node(first).range());
        self.out.push(':');
        let start = self.tree.node(value).range().start;
        while let Some(comment) = self.comments.next_before(start) {
            if self.line_is_full {
                self.indent += INDENT;
                self.new_line(false);
                self.indent -= INDENT;
                self.comment(comment);
            } else {
                self.trailing(comment);
            }
        }
        if self.line_is_full {
            self.indent += INDENT;
            self.new_line(false);
            self.value(value, COMMA);
            self.indent -= INDENT;
        } else {
            self.out.push(' ');
            self.value(value, COMMA);
        }
    }
}

fn is_container(kind: Kind) -> bool {
    matches!(kind, Kind::Tuple | Kind::Struct | Kind::List | Kind::Map)
}

fn is_keyed(kind: Kind) -> bool {
    matches!(kind, Kind::Struct | Kind::Map)
}

fn brackets(kind: Kind) -> (char, char) {
    match kind {
        Kind::List => ('[', ']'),
        Kind::Map => ('{', '}'),
        _ => ('(', ')'),
    }
}

/// How long each node is on one line; `None` for those that cannot or shall not stand on one.
fn widths(text: &str, tree: &Tree) -> Vec<Option<usize>> {
    let mut widths = vec![None; tree.len()];
    // A parent comes before its children.
    for id in tree.ids().rev() {
        let width = width(text, tree, &widths, id);
        if let Some(place) = widths.get_mut(id.index()) {
            *place = width;
        }
    }
    widths
}

fn width(text: &str, tree: &Tree, widths: &[Option<usize>], id: NodeId) -> Option<usize> {
    const SEPARATOR: usize = 2;
    let node = tree.node(id);
    let length = |range: Range<usize>| text.get(range).map_or(0, |text| text.chars().count());
    if !is_container(node.kind()) && !Comments::any_in(tree, node.range()) {
        let written = text.get(node.range()).unwrap_or("");
        return (!written.contains('\n')).then(|| length(node.range()));
    }
    let mut children = tree.children(id).peekable();
    let is_root = node.parent().is_none();
    if (is_root && children.peek().is_some()) || Comments::any_in(tree, node.range()) {
        return None;
    }
    let mut width = node.name().map_or(0, length) + SEPARATOR;
    for (index, child) in children.enumerate() {
        let kind = tree.node(child).kind();
        let is_struct = is_keyed(kind) || tree.node(child).name().is_some();
        if node.kind() == Kind::List && is_struct {
            return None;
        }
        let separator = if index > 0 { SEPARATOR } else { 0 };
        width += separator + widths.get(child.index()).copied().flatten()?;
    }
    Some(width)
}
