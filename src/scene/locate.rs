//! Lookup of the place of a model's value in the text.

use std::{borrow::Cow, cell::RefCell, collections::HashMap, ops::Range};

use crate::{
    diagnostic::{
        Diagnostic, Fix,
        path::{Path, Step},
    },
    scene::{
        format::{
            geometry::{GeometryModel, inside::FIELD_NAMES, ordinal::Ordinal},
            scene::Model,
            thing::{Thing, Type},
        },
        problem::{Cure, Focus, Problem},
        recover::{
            fix::removal,
            text::{Repairs, VariantText, name_of},
        },
    },
    text::{
        edit::Edit,
        syntax::{NodeId, NodeKind, Syntax, Tree},
    },
};

/// Finds places in the tree of a text.
pub(crate) struct Locator<'a> {
    text: &'a str,
    tree: &'a Tree,
    repairs: &'a Repairs,
    /// The children of the nodes whose elements were requested: a list of a million is traversed
    /// once.
    lists: RefCell<HashMap<NodeId, Vec<NodeId>>>,
    /// The fields of the structs that were requested.
    structs: RefCell<HashMap<NodeId, Fields<'a>>>,
}

/// The key and value of each field by its name.
type Fields<'a> = HashMap<Cow<'a, str>, (NodeId, NodeId)>;

impl<'a> Locator<'a> {
    /// Creates a locator; `repairs` lists the parts of the model that differ from the text.
    pub(crate) fn new(text: &'a str, tree: &'a Tree, repairs: &'a Repairs) -> Self {
        Self {
            text,
            tree,
            repairs,
            lists: RefCell::default(),
            structs: RefCell::default(),
        }
    }

    /// Returns the range of a part of the value at a path; `None` if it was repaired.
    pub(crate) fn range(&self, path: &Path, focus: Focus) -> Option<Range<usize>> {
        let mut node = self.tree.root()?;
        let mut key = None;
        let steps = match (focus, path.steps()) {
            (Focus::Bracket, [around @ .., _]) => around,
            (_, steps) => steps,
        };
        for step in steps {
            if self.is_replaced(node) {
                return None;
            }
            match step.name() {
                None => node = self.element(node, step)?,
                Some(name) if self.tree.node(node).kind() == NodeKind::List => {
                    node = self.named(node, name)?;
                }
                Some(name) => {
                    let (found, value) = self.field(node, name).or_else(|| {
                        let body = body(self.tree, node).filter(|body| !self.is_replaced(*body));
                        self.field(body?, name)
                    })?;
                    key = Some(found);
                    node = value;
                }
            }
        }
        if focus == Focus::Key {
            return key.map(|key| self.tree.node(key).range());
        }
        let is_named = focus == Focus::Name;
        let body = body(self.tree, node).filter(|_| is_named);
        if self.is_replaced(node) || body.is_some_and(|body| self.is_replaced(body)) {
            return None;
        }
        let whole = self.tree.node(node);
        Some(match focus {
            Focus::Bracket => self.bracket(node),
            // In JSON the name is the only key of an object, in RON it precedes the bracket.
            Focus::Name => VariantText::of(self.text, self.tree, node)
                .map_or_else(|| whole.range(), |written| written.place),
            Focus::Content => self.tree.node(self.content(node)?).range(),
            Focus::Value | Focus::Key => whole.range(),
        })
    }

    /// Returns the value in a variant, as in `Named("gold")`.
    fn content(&self, node: NodeId) -> Option<NodeId> {
        match self.tree.syntax() {
            Syntax::Ron => self.tree.children(node).next(),
            Syntax::Json => body(self.tree, node),
        }
    }

    /// Returns the fix of a problem as an edit, unless a comment would be lost.
    pub(crate) fn fix(&self, problem: &Problem) -> Option<Fix> {
        let cure = problem.cure.as_ref()?;
        if let Cure::Exchange(pairs) = cure {
            let mut edits = Vec::new();
            for pair in pairs {
                let [one, other] = pair.each_ref().map(|path| self.range(path, Focus::Value));
                let (one, other) = (one?, other?);
                let source = |range: &Range<usize>| self.text.get(range.clone());
                edits.push(Edit::replace(one.clone(), source(&other)?));
                edits.push(Edit::replace(other.clone(), source(&one)?));
            }
            edits.sort_by_key(|edit| edit.range.start);
            return Some(Fix::safe(edits));
        }
        let path = match cure {
            Cure::WriteAround(_) => &problem.diagnostic.path.parent(),
            Cure::Write(_) | Cure::Remove | Cure::Exchange(_) => &problem.diagnostic.path,
        };
        let focus = match problem.focus {
            Focus::Content => Focus::Content,
            Focus::Value | Focus::Key | Focus::Name | Focus::Bracket => Focus::Value,
        };
        let range = self.range(path, focus)?;
        let edit = match cure {
            Cure::Exchange(_) => return None,
            Cure::Remove => removal(self.text, self.tree, range)?,
            Cure::Write(text) | Cure::WriteAround(text) => {
                if !self.tree.comments_in(range.clone()).is_empty() {
                    return None;
                }
                Edit::replace(range, text)
            }
        };
        Some(Fix::safe([edit]))
    }

    /// Converts a problem to a diagnostic at a range.
    pub(crate) fn placed(&self, problem: Problem, range: Range<usize>) -> Diagnostic {
        let fix = self.fix(&problem);
        let placed = problem.placed(range, self.text, |path, focus| self.range(path, focus));
        placed.with_fix(fix)
    }

    fn is_replaced(&self, node: NodeId) -> bool {
        self.repairs.replaced.contains(&node)
    }

    /// Returns the range of the bracket that opens a struct.
    fn bracket(&self, node: NodeId) -> Range<usize> {
        let node = self.tree.node(node);
        let start = node.name().map_or(node.range().start, |name| {
            let end = node.range().end;
            self.tree.bracket_after(self.text, name.end, end)
        });
        start..start + 1
    }

    fn field(&self, owner: NodeId, name: &str) -> Option<(NodeId, NodeId)> {
        let mut structs = self.structs.borrow_mut();
        let fields = structs
            .entry(owner)
            .or_insert_with(|| self.fields_of(owner));
        let given = fields
            .get(name)
            .or_else(|| self.repairs.renamed.get(&(owner, name)));
        given.copied()
    }

    fn fields_of(&self, owner: NodeId) -> Fields<'a> {
        let mut fields = HashMap::new();
        for (key, value) in self.tree.fields(owner) {
            let name = name_of(self.text, self.tree, key);
            // If a field is given twice, the first is read.
            fields.entry(name).or_insert((key, value));
        }
        fields
    }

    /// Returns the numbers of the geometries of a model that are replaced, in ascending order.
    pub(crate) fn stand_ins(&self, model: &Model) -> Vec<Ordinal> {
        let list = self
            .tree
            .root()
            .and_then(|root| self.field(root, Model::LONG));
        let nodes = list
            .into_iter()
            .flat_map(|(_, list)| self.tree.children(list));
        let mut found = Vec::new();
        for (index, (node, geometry)) in nodes.zip(&model.geometries).enumerate() {
            self.add_stand_ins(node, geometry, index.into(), &mut found);
        }
        found
    }

    /// Adds the numbers of a geometry and those inside of it that are replaced.
    fn add_stand_ins(
        &self,
        node: NodeId,
        geometry: &GeometryModel,
        at: Ordinal,
        found: &mut Vec<Ordinal>,
    ) {
        if self.is_replaced(node) {
            found.push(at);
            return;
        }
        let fields = body(self.tree, node).unwrap_or(node);
        for child in geometry.children() {
            let at = at.inside(child.number);
            let value = self.field(fields, child.inside.field);
            let node = value.and_then(|(_, value)| match child.inside.is_list {
                true => self.element(value, &Step::Index(child.index)),
                false => Some(value),
            });
            match node {
                Some(node) => self.add_stand_ins(node, child.geometry, at, found),
                // The field is missing.
                None => found.push(at),
            }
        }
    }

    fn element(&self, owner: NodeId, index: &Step) -> Option<NodeId> {
        let Step::Index(index) = index else {
            return None;
        };
        // The list in a variant, as in `Colors([…])`.
        let is_list = |node: &NodeId| self.tree.node(*node).kind() == NodeKind::List;
        let is_variant =
            self.tree.node(owner).kind() == NodeKind::Map || self.tree.node(owner).name().is_some();
        let inside = self
            .content(owner)
            .filter(|inside| is_variant && is_list(inside));
        let owner = inside.unwrap_or(owner);
        if !matches!(
            self.tree.node(owner).kind(),
            NodeKind::List | NodeKind::Tuple
        ) {
            return None;
        }
        let mut lists = self.lists.borrow_mut();
        let children = lists
            .entry(owner)
            .or_insert_with(|| self.tree.children(owner).collect());
        children.get(*index).copied()
    }

    /// Returns the element of a list with this name, or the geometry inside of an element.
    fn named(&self, list: NodeId, name: &str) -> Option<NodeId> {
        let mut items = items(self.tree, list).into_iter();
        items.find_map(|item| {
            let fields = body(self.tree, item).unwrap_or(item);
            let fields = self.fields_of(fields);
            let given = fields.get("name");
            if given.is_some_and(|(_, value)| name_of(self.text, self.tree, *value) == name) {
                return Some(item);
            }
            let mut lists = FIELD_NAMES.iter().filter_map(|field| fields.get(*field));
            lists.find_map(|(_, list)| self.named(*list, name))
        })
    }
}

/// Returns the elements of a list; a value that is no list is its only one.
pub(crate) fn items(tree: &Tree, value: NodeId) -> Vec<NodeId> {
    match tree.node(value).kind() {
        NodeKind::List => tree.children(value).collect(),
        _ => vec![value],
    }
}

/// Returns the content of a JSON variant, if this may be one: an object with one key.
pub(crate) fn body(tree: &Tree, node: NodeId) -> Option<NodeId> {
    let mut fields = tree.fields(node);
    match (tree.syntax(), fields.next(), fields.next()) {
        (Syntax::Json, Some((_, body)), None) => Some(body),
        _ => None,
    }
}

/// A node of a text, and its type if the format has one for it.
pub(crate) type Typed = (NodeId, Option<Type>);

/// Returns the content of a variant, and any other value itself: what tells a variant from a map.
pub(crate) fn content(text: &str, tree: &Tree, (id, of_type): Typed) -> Typed {
    let Some(one_of @ Type::OneOf(_)) = of_type else {
        return (id, of_type);
    };
    let written = VariantText::of(text, tree, id);
    let Some(VariantText {
        name,
        body: Some(body),
        ..
    }) = written
    else {
        return (id, of_type);
    };
    let is_tuple = tree.syntax() == Syntax::Ron && tree.node(id).kind() == NodeKind::Tuple;
    let inside = tree.children(body).next().filter(|_| is_tuple);
    (inside.unwrap_or(body), one_of.value(&name))
}

/// Returns the fields of a struct, the entries of a map or the elements of a list: those of the first two
/// with their keys.
pub(crate) fn parts<'t>(
    text: &'t str,
    tree: &'t Tree,
    (id, of_type): Typed,
) -> impl Iterator<Item = (Option<NodeId>, Typed)> + use<'t> {
    let fields = tree.fields(id).map(move |(key, value)| {
        let of_value = of_type.and_then(|of_type| of_type.value(&name_of(text, tree, key)));
        (Some(key), (value, of_value))
    });
    let is_list = matches!(tree.node(id).kind(), NodeKind::List | NodeKind::Tuple);
    let items = is_list.then(|| tree.children(id)).into_iter().flatten();
    fields.chain(items.map(move |item| (None, (item, of_type.and_then(Type::element)))))
}

/// Returns the path of the innermost value at an offset.
pub(crate) fn path_at(text: &str, tree: &Tree, offset: usize) -> Path {
    let mut path = Path::ROOT;
    let Some(root) = tree.root() else {
        return path;
    };
    let mut typed = (root, Some(Model::of_type()));
    let holds = |from: NodeId, to: NodeId| {
        let range = tree.node(from).range().start..=tree.node(to).range().end;
        range.contains(&offset)
    };
    loop {
        let around = content(text, tree, typed);
        let mut parts = parts(text, tree, around).enumerate();
        let found = parts.find(|(_, (key, (value, _)))| holds(key.unwrap_or(*value), *value));
        let Some((index, (key, value))) = found else {
            return path;
        };
        path = path.then(match key.map(|key| name_of(text, tree, key)) {
            None => Step::Index(index),
            Some(name) => match around.1 {
                Some(Type::Map(..) | Type::Tracks) => Step::Key(name.into()),
                _ => Step::Field(name.into_owned().into()),
            },
        });
        typed = value;
    }
}

/// Returns the range of the value at the end of the steps from the root.
pub(crate) fn range_of(text: &str, tree: &Tree, steps: &[Step]) -> Option<Range<usize>> {
    let repairs = Repairs::default();
    Locator::new(text, tree, &repairs).range(&steps.into(), Focus::Value)
}
