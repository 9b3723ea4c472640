//! Where in the text a place of the model stands.

use std::{borrow::Cow, cell::RefCell, collections::HashMap, ops::Range};

use crate::{
    diagnostic::{
        Diagnostic, Fix,
        path::{Path, Step},
    },
    scene::{
        mend::{Repairs, fix::removal, name_of},
        problem::{Cure, Focus, Place, Problem},
    },
    text::{
        edit::Edit,
        syntax::{Kind, NodeId, Syntax, Tree},
    },
};

/// Finds places in the tree of a text.
pub(crate) struct Locator<'a> {
    text: &'a str,
    tree: &'a Tree,
    repairs: &'a Repairs,
    /// The children of the nodes whose elements have been asked for: a list of a million is gone
    /// through once.
    lists: RefCell<HashMap<NodeId, Vec<NodeId>>>,
    /// The fields of the structs that have been asked for.
    structs: RefCell<HashMap<NodeId, Fields<'a>>>,
}

/// Key and value of each field by its name.
type Fields<'a> = HashMap<Cow<'a, str>, (NodeId, NodeId)>;

impl<'a> Locator<'a> {
    /// `repairs` says what of the model does not stand in the text as it is.
    pub(crate) fn new(text: &'a str, tree: &'a Tree, repairs: &'a Repairs) -> Self {
        Self {
            text,
            tree,
            repairs,
            lists: RefCell::default(),
            structs: RefCell::default(),
        }
    }

    /// The range of a place; `None` where a repair stands there.
    pub(crate) fn range(&self, place: &Place) -> Option<Range<usize>> {
        let mut node = self.tree.root()?;
        let mut key = None;
        let steps = match (place.focus, place.path.steps()) {
            (Focus::Bracket, [around @ .., _]) => around,
            (_, steps) => steps,
        };
        for step in steps {
            if self.is_replaced(node) {
                return None;
            }
            match step.name() {
                None => node = self.element(node, step)?,
                Some(name) if self.tree.node(node).kind() == Kind::List => {
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
        if place.focus == Focus::Key {
            return key.map(|key| self.tree.node(key).range());
        }
        let is_named = place.focus == Focus::Name;
        let body = body(self.tree, node).filter(|_| is_named);
        if self.is_replaced(node) || body.is_some_and(|body| self.is_replaced(body)) {
            return None;
        }
        let whole = self.tree.node(node);
        Some(match place.focus {
            Focus::Bracket => self.bracket(node),
            // In JSON the name is the one key of an object, in RON it stands before the bracket.
            Focus::Name => match self.tree.fields(node).next().filter(|_| body.is_some()) {
                Some((name, _)) => self.tree.node(name).range(),
                None => whole.name().unwrap_or_else(|| whole.range()),
            },
            Focus::Value | Focus::Key => whole.range(),
        })
    }

    /// The cure of a problem as an edit, unless a comment would be lost.
    pub(crate) fn fix(&self, problem: &Problem) -> Option<Fix> {
        let cure = problem.cure.as_ref()?;
        let path = match cure {
            Cure::WriteAround(_) => problem.place.path.parent(),
            Cure::Write(_) | Cure::Remove => problem.place.path.clone(),
        };
        let focus = Focus::Value;
        let range = self.range(&Place { path, focus })?;
        let edit = match cure {
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

    /// A problem that stands at a range.
    pub(crate) fn placed(&self, problem: Problem, range: Range<usize>) -> Diagnostic {
        let fix = self.fix(&problem);
        let placed = problem.placed(range, self.text, |place| self.range(place));
        placed.with_fix(fix)
    }

    fn is_replaced(&self, node: NodeId) -> bool {
        self.repairs.replaced.contains(&node)
    }

    /// The bracket that opens a struct.
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
            // Of a field that is given twice, the first is read.
            fields.entry(name).or_insert((key, value));
        }
        fields
    }

    /// The indices of those elements of a list of the scene that have been replaced.
    pub(crate) fn replaced(&self, list: &'static str) -> Vec<usize> {
        let list = self.tree.root().and_then(|root| self.field(root, list));
        let elements = list
            .into_iter()
            .flat_map(|(_, list)| self.tree.children(list));
        let replaced = elements.enumerate();
        replaced
            .filter_map(|(index, id)| self.repairs.replaced.contains(&id).then_some(index))
            .collect()
    }

    fn element(&self, owner: NodeId, index: &Step) -> Option<NodeId> {
        let Step::Index(index) = index else {
            return None;
        };
        if !matches!(self.tree.node(owner).kind(), Kind::List | Kind::Tuple) {
            return None;
        }
        let mut lists = self.lists.borrow_mut();
        let children = lists
            .entry(owner)
            .or_insert_with(|| self.tree.children(owner).collect());
        children.get(*index).copied()
    }

    /// The element of a list that has a name.
    fn named(&self, list: NodeId, name: &str) -> Option<NodeId> {
        self.tree.children(list).find(|item| {
            let fields = body(self.tree, *item).unwrap_or(*item);
            let fields = self.fields_of(fields);
            let given = fields.get("name");
            given.is_some_and(|(_, value)| name_of(self.text, self.tree, *value) == name)
        })
    }
}

/// What stands in a variant of JSON, if this may be one: an object with one key.
fn body(tree: &Tree, node: NodeId) -> Option<NodeId> {
    let mut fields = tree.fields(node);
    match (tree.syntax(), fields.next(), fields.next()) {
        (Syntax::Json, Some((_, body)), None) => Some(body),
        _ => None,
    }
}

/// The path of the innermost value of a tree at an offset.
pub(crate) fn path_at(text: &str, tree: &Tree, offset: usize) -> Path {
    let mut path = Path::ROOT;
    let Some(mut node) = tree.root() else {
        return path;
    };
    let holds = |from: NodeId, to: NodeId| {
        let range = tree.node(from).range().start..=tree.node(to).range().end;
        range.contains(&offset)
    };
    loop {
        let found = match tree.node(node).kind() {
            Kind::Struct | Kind::Map => {
                let mut fields = tree.fields(node);
                fields
                    .find(|(key, value)| holds(*key, *value))
                    .map(|(key, value)| {
                        let name = name_of(text, tree, key);
                        if is_variant(tree, node, &name, &path) {
                            return (value, None);
                        }
                        let is_map = tree.syntax() == Syntax::Ron
                            && tree.node(node).kind() == Kind::Map
                            || has_names(&path);
                        let step = match is_map {
                            true => Step::Key(name.into()),
                            false => Step::Field(name.into_owned().into()),
                        };
                        (value, Some(step))
                    })
            }
            Kind::List | Kind::Tuple => {
                let mut items = tree.children(node).enumerate();
                let item = items.find(|(_, item)| holds(*item, *item));
                item.map(|(index, item)| (item, Some(Step::Index(index))))
            }
            _ => None,
        };
        let Some((value, step)) = found else {
            return path;
        };
        path = step.map_or_else(|| path.clone(), |step| path.then(step));
        node = value;
    }
}

/// Whether an object is a map of names that the scene gives, and not of fields.
fn has_names(path: &Path) -> bool {
    let last = path.steps().last();
    matches!(last, Some(Step::Field(name)) if matches!(&**name, "cameras" | "tracks"))
}

/// Whether an object of JSON is a variant: its one key is the name, which starts with a capital as no
/// field does.
fn is_variant(tree: &Tree, node: NodeId, name: &str, path: &Path) -> bool {
    tree.syntax() == Syntax::Json
        && tree.fields(node).count() == 1
        && name.starts_with(|first: char| first.is_ascii_uppercase())
        && !has_names(path)
}

/// The range of the value that steps from the root lead to.
pub(crate) fn range_of(text: &str, tree: &Tree, steps: &[Step]) -> Option<Range<usize>> {
    let repairs = Repairs::default();
    Locator::new(text, tree, &repairs).range(&Place {
        path: steps.into(),
        focus: Focus::Value,
    })
}
