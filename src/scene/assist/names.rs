//! The names of a scene: where they are given, and where they are used.

use std::ops::Range;

use super::spot::Finder;
use crate::{
    diagnostic::{Code, Diagnostic, error::Error, named::named, path::Step},
    scene::{
        assist::completion::Hover,
        format::{
            cameras::fault_of_name,
            geometry::inside::FIELD_NAMES,
            scene::Model,
            thing::{Thing, Type},
        },
        locate::{Typed, content},
        path::{self, PathPart},
    },
    text::{
        edit::Edit,
        nearest::quote,
        syntax::{self, NodeId, NodeKind, Syntax},
    },
};

/// The longest definition that is shown.
const LONGEST: usize = 400;

named! {
    /// The kind of a thing with a name.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum NameKind {
        /// One of `materials`.
        Material = "material",
        /// One of `cameras`.
        Camera = "camera",
        /// A light.
        Light = "light",
        /// A geometry.
        Geometry = "geometry",
    }
}

impl NameKind {
    /// Returns the kind of the things in a field of the scene.
    fn of_field(name: &str) -> Option<Self> {
        match Model::of_type().value(name)? {
            of_type @ (Type::List(..) | Type::Map(..)) => Self::of_type(of_type),
            _ => None,
        }
    }

    /// Returns the kind of the things that a type holds in the end.
    fn of_type(of_type: Type) -> Option<Self> {
        match &*of_type.noun() {
            "solid" => Some(Self::Geometry),
            noun => Self::of_name(noun),
        }
    }
}

/// A name at a place of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// The kind of the thing.
    pub kind: NameKind,
    /// The name.
    pub name: String,
    /// The range of the name, without quotes.
    pub range: Range<usize>,
    /// The range of the thing where it is given its name; `None` where the name is used.
    pub definition: Option<Range<usize>>,
    /// The range of the string that it is in.
    string: Range<usize>,
    /// The place in a path, if it is in one.
    part: Option<Box<InPath>>,
}

/// A name in a path.
#[derive(Clone, Debug, PartialEq, Eq)]
struct InPath {
    path: String,
    /// The end of the step before it.
    before: usize,
    part: PathPart,
}

impl Name {
    /// Returns the same name in another text, where each range is as given by `place`.
    #[must_use]
    pub(super) fn moved(mut self, place: impl Fn(&Range<usize>) -> Range<usize>) -> Self {
        self.shift(place);
        self
    }

    /// Replaces each range.
    pub(super) fn shift(&mut self, place: impl Fn(&Range<usize>) -> Range<usize>) {
        self.range = place(&self.range);
        self.definition = self.definition.as_ref().map(&place);
        self.string = place(&self.string);
    }

    /// Returns true if both are names of one thing.
    pub(super) fn is_of(&self, other: &Self) -> bool {
        (self.kind, &self.name) == (other.kind, &other.name)
    }
}

/// Returns the name at an offset.
pub(super) fn at(finder: &Finder, offset: usize) -> Option<Name> {
    let is_around = |range: &Range<usize>| range.start <= offset && offset <= range.end;
    let mut names = Names::of(finder, &is_around).into_iter();
    names.find(|name| is_around(&name.range))
}

/// Returns all names, in the order of the text.
pub(super) fn all(finder: &Finder) -> impl Iterator<Item = Name> {
    Names::of(finder, &|_| true).into_iter()
}

/// The names of a text, in its order.
struct Names<'f, 'a> {
    finder: &'f Finder<'a>,
    /// Returns true for the ranges that are searched.
    is_wanted: &'f dyn Fn(&Range<usize>) -> bool,
    found: Vec<Name>,
}

impl<'f, 'a> Names<'f, 'a> {
    fn of(finder: &'f Finder<'a>, is_wanted: &'f dyn Fn(&Range<usize>) -> bool) -> Vec<Name> {
        let mut names = Self {
            finder,
            is_wanted,
            found: Vec::new(),
        };
        if let Some(root) = finder.tree.root() {
            names.add((root, Some(Model::of_type())), None);
        }
        names.found
    }

    /// Adds the names in a value; `thing` is what the value is a field of, and its kind.
    fn add(&mut self, (value, of_type): Typed, thing: Option<(NameKind, NodeId)>) {
        let (finder, tree) = (self.finder, self.finder.tree);
        let is_string = |id| tree.node(id).kind() == NodeKind::String;
        if !(self.is_wanted)(&tree.node(value).range()) {
            return;
        }
        let own = of_type.and_then(|of_type| match of_type {
            Type::OneOf(_) => Some((NameKind::of_type(of_type)?, value)),
            _ => None,
        });
        let thing = own.or(thing);
        let (inside, of_type) = content(finder.text, tree, (value, of_type));
        match of_type {
            Some(Type::Name) if is_string(inside) => {
                self.found.extend(thing.map(|(kind, thing)| {
                    plain(finder, inside, kind, Some(tree.node(thing).range()))
                }))
            }
            Some(Type::NameOfMaterial) if is_string(inside) => {
                self.found
                    .push(plain(finder, inside, NameKind::Material, None));
            }
            Some(Type::NameOfGeometry) if is_string(inside) => {
                self.found
                    .push(plain(finder, inside, NameKind::Geometry, None));
            }
            Some(of_type @ (Type::List(..) | Type::Tuple(..))) => {
                for item in tree.children(inside) {
                    self.add((item, of_type.element()), thing);
                }
            }
            Some(of_type) => {
                for (key, value) in tree.fields(inside) {
                    let whole = tree.node(key).range().start..tree.node(value).range().end;
                    match of_type {
                        _ if !(self.is_wanted)(&whole) => continue,
                        Type::Map(..) if is_string(key) => {
                            let kind = NameKind::of_type(of_type);
                            let name = kind.map(|kind| plain(finder, key, kind, Some(whole)));
                            self.found.extend(name);
                        }
                        Type::Tracks if is_string(key) => self.found.extend(in_path(finder, key)),
                        _ => {}
                    }
                    // A stray bracket has no name; more of the fields are in it.
                    let of_value = match tree.node(key).kind() {
                        NodeKind::Error => Some(of_type),
                        _ => of_type.value(&finder.name(key)),
                    };
                    self.add((value, of_value), thing);
                }
            }
            None => {}
        }
    }
}

fn plain(finder: &Finder, id: NodeId, kind: NameKind, definition: Option<Range<usize>>) -> Name {
    let string = finder.tree.node(id).range();
    let name = finder.name(id).into_owned();
    let token = finder.at(string.clone());
    let end = string.start + offset_in(token, finder.tree.syntax(), name.len());
    Name {
        kind,
        range: string.start + offset_in(token, finder.tree.syntax(), 0)..end,
        name,
        definition,
        string,
        part: None,
    }
}

/// Returns the names in the path of a track.
fn in_path(finder: &Finder, id: NodeId) -> Vec<Name> {
    let string = finder.tree.node(id).range();
    let path = finder.name(id).into_owned();
    let parts = path::parts(&path).unwrap_or_default();
    let pairs = parts.iter().zip(parts.iter().skip(1)).enumerate();
    let lists = pairs.filter_map(|(index, (list, part))| {
        let field = list.name()?;
        let kind = match index {
            0 => NameKind::of_field(field),
            _ => FIELD_NAMES.contains(&field).then_some(NameKind::Geometry),
        };
        step(finder, &string, &path, kind?, list, part)
    });
    lists.collect()
}

/// Returns the name that a step of a path is.
fn step(
    finder: &Finder,
    string: &Range<usize>,
    path: &str,
    kind: NameKind,
    list: &PathPart,
    part: &PathPart,
) -> Option<Name> {
    let name = part.name()?.to_owned();
    let inner = match part.step {
        // The quotes in the brackets are not of the name.
        Step::Key(_) => part.range.start + 1..part.range.end - 1,
        Step::Field(_) | Step::Index(_) => part.range.clone(),
    };
    let token = finder.at(string.clone());
    let [start, end] = [inner.start, inner.end]
        .map(|at| string.start + offset_in(token, finder.tree.syntax(), at));
    let part = InPath {
        before: list.range.end,
        part: part.clone(),
        path: path.to_owned(),
    };
    Some(Name {
        kind,
        name,
        range: start..end,
        definition: None,
        string: string.clone(),
        part: Some(part.into()),
    })
}

/// Returns the offset in a string as it is written of an offset in its value.
fn offset_in(token: &str, syntax: Syntax, offset: usize) -> usize {
    let raw = token.strip_prefix('r').unwrap_or("");
    let hashes = raw.len() - raw.trim_start_matches('#').len();
    let (open, close) = match token.starts_with('r') {
        true => (2 + hashes, format!("\"{}", "#".repeat(hashes))),
        false => (1, "\"".to_owned()),
    };
    let most = token.len().saturating_sub(close.len()).max(open);
    let decoded = |end: usize| {
        let part = token.get(..end)?.to_owned() + &close;
        syntax::string(&part, syntax).map(|value| value.len())
    };
    // Names are short.
    let found = (open..=most).find(|end| decoded(*end).is_some_and(|length| length >= offset));
    found.unwrap_or(most)
}

/// Returns the edits that rename a thing; `names` are all names of the text.
pub(super) fn rename(
    names: &[Name],
    name: &Name,
    new: &str,
    syntax: Syntax,
) -> Result<Vec<Edit>, Error> {
    let refused = |message: String| {
        let fault = Diagnostic::new(Code::InvalidName, 0..new.len(), message);
        Err(Error::usage(fault))
    };
    let fault = match name.kind {
        NameKind::Camera => fault_of_name(new),
        _ => new
            .is_empty()
            .then(|| "an empty string is not a name".to_owned()),
    };
    if let Some(fault) = fault {
        return refused(fault);
    }
    let is_taken =
        |place: &Name| place.definition.is_some() && (place.kind, &*place.name) == (name.kind, new);
    if new != name.name && names.iter().any(is_taken) {
        let (kind, new) = (name.kind.name(), quote(new));
        return refused(format!("the scene has another {kind} {new}"));
    }
    let places = names.iter().filter(|place| place.is_of(name));
    let edits = places.map(|place| {
        let value = match &place.part {
            Some(part) => part.renamed(new),
            None => new.to_owned(),
        };
        Edit::replace(place.string.clone(), written(&value, syntax))
    });
    Ok(edits.collect())
}

impl InPath {
    /// Returns the path with another name.
    fn renamed(&self, new: &str) -> String {
        let Range { start, end } = self.part.range;
        let [before, behind] = [self.before, end].map(|at| self.path.split_at(at));
        let is_plain = new.trim() == new && !new.contains(['.', '[', '=']);
        match self.part.step {
            Step::Field(_) if is_plain => [&self.path[..start], new, behind.1].concat(),
            Step::Field(_) => format!("{}[{new:?}]{}", before.0, behind.1),
            Step::Key(_) | Step::Index(_) => format!("{}{new:?}{}", &self.path[..start], behind.1),
        }
    }
}

/// Returns a string as it is written.
pub(super) fn written(value: &str, syntax: Syntax) -> String {
    match syntax {
        Syntax::Ron => format!("{value:?}"),
        Syntax::Json => serde_json::Value::from(value).to_string(),
    }
}

/// Returns the definition of a name as its meaning; `places` are those of the name in the text.
pub(super) fn hover(name: Name, places: Vec<Name>, text: &str, syntax: Syntax) -> Option<Hover> {
    let definition = places.into_iter().find_map(|place| place.definition)?;
    let text = text.get(definition).unwrap_or_default();
    let docs = match text.len() <= LONGEST {
        true => format!("```{}\n{text}\n```", syntax.name()),
        false => String::new(),
    };
    Some(Hover {
        title: format!("{} {}", name.kind.name(), quote(&name.name)),
        range: name.range,
        docs,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        scene::{assist::Symbol, source::Source},
        text::edit::apply,
    };

    const RON: &str = r##"(
    cameras: {"front": Perspective(fov: 60), "top view": Orthographic(scale: 1)},
    lights: [Point(name: "key")],
    materials: {"gold": Mirror(color: "#fff"), "gold 2": Named("gold")},
    geometries: [Plane(material: Named("gold")), Sphere(name: "ball", material: Named("gold 2"))],
    animation: (frames: 2, tracks: {
        "materials.gold.color": [],
        "materials[\"gold 2\"].color": [],
        r#"cameras["top view"].scale"#: [],
        "cameras.front.fov": [],
        "lights.key.intensity": [],
        "geometries[\"ball\"].radius": [],
    }),
)"##;

    fn renamed(text: &str, marked: &str, new: &str) -> String {
        let source = Source::new(text, Syntax::of_text(text));
        let at = text.find(&marked.replace('|', "")).unwrap() + marked.find('|').unwrap();
        let name = source.name_at(at).unwrap();
        assert_eq!(text[name.range.clone()].replace('\\', ""), name.name);
        let edits = source.rename(&name, new).unwrap();
        apply(text, edits.iter().map(std::slice::from_ref)).0
    }

    #[test]
    fn names_change_everywhere() {
        let expected = RON
            .replace("\"gold\"", "\"brass\"")
            .replace("materials.gold", "materials.brass");
        assert_eq!(renamed(RON, "Named(\"go|ld\")", "brass"), expected);
        assert_eq!(renamed(RON, "materials.|gold", "brass"), expected);
        let expected = RON
            .replace("\"gold\"", "\"a.b\"")
            .replace("materials.gold", "materials[\\\"a.b\\\"]");
        assert_eq!(renamed(RON, "{\"|gold", "a.b"), expected);
        let expected = RON
            .replace("\"gold 2\"", "\"g\"")
            .replace("\\\"gold 2\\\"", "\\\"g\\\"");
        assert_eq!(renamed(RON, "[\\\"gold| 2", "g"), expected);
        let expected = RON.replace("\"top view\": O", "\"t\": O").replace(
            "r#\"cameras[\"top view\"].scale\"#",
            "\"cameras[\\\"t\\\"].scale\"",
        );
        assert_eq!(renamed(RON, "cameras[\"top| view", "t"), expected);
        assert_eq!(
            renamed(RON, "name: \"k|ey", "sun"),
            RON.replace("key", "sun")
        );
        assert_eq!(renamed(RON, "name: \"ball|", "b"), RON.replace("ball", "b"));
    }

    // As after typing one bracket.
    #[test]
    fn names_behind_a_stray_bracket_are_found() {
        let broken = RON.replace("Sphere(name", "Sphere(center: (0, 0, 0), (name");
        let found = renamed(&broken, "(\"gold| 2\")", "g");
        assert!(found.contains("Named(\"g\")"), "{found}");
    }

    #[test]
    fn names_in_groups() {
        let ron = r#"(geometries: [Group(name: "chair", geometries: [
                Sphere(name: "leg"), Group(geometries: [Sphere(name: "foot")])])],
            animation: (tracks: {"geometries.leg.radius": [], "geometries.chair.geometries.leg.color": [],
                "geometries[0].geometries[1].geometries.foot.color": []}))"#;
        let json = r#"{"geometries": [{"Group": {"name": "chair", "geometries": [
                {"Sphere": {"name": "leg"}}, {"Group": {"geometries": [{"Sphere": {"name": "foot"}}]}}]}}],
            "animation": {"tracks": {"geometries.leg.radius": [], "geometries.chair.geometries.leg.color": [],
                "geometries[0].geometries[1].geometries.foot.color": []}}}"#;
        for text in [ron, json] {
            let source = Source::new(text, Syntax::of_text(text));
            for name in ["leg", "foot", "chair"] {
                let expected = text.replace(name, "other");
                for (at, _) in text.match_indices(name) {
                    let found = source.name_at(at + 1).unwrap();
                    assert_eq!(&text[found.range.clone()], name);
                    let edits = source.rename(&found, "other").unwrap();
                    let new = apply(text, edits.iter().map(std::slice::from_ref)).0;
                    assert_eq!(new, expected);
                }
            }
            let [list, _] = &source.symbols()[..] else {
                panic!("there are two fields");
            };
            let names = |symbols: &[Symbol]| {
                let names = symbols.iter().map(|symbol| symbol.name.clone());
                names.collect::<Vec<_>>()
            };
            assert_eq!(names(&list.children), ["chair"]);
            assert_eq!(names(&list.children[0].children), ["leg", "[1]"]);
            assert_eq!(names(&list.children[0].children[1].children), ["foot"]);
        }
    }

    #[test]
    fn copies_name_what_they_are_of() {
        let text =
            r#"(geometries: [Instances(of: "tree"), Group(geometries: [Sphere(name: "tree")])])"#;
        let expected = text.replace("tree", "bush");
        assert_eq!(renamed(text, "of: \"|tree", "bush"), expected);
        assert_eq!(renamed(text, "name: \"|tree", "bush"), expected);
        let solid = r#"(geometries: [Difference(of: Sphere(name: "tree"))])"#;
        assert_eq!(
            renamed(solid, "name: \"|tree", "bush"),
            solid.replace("tree", "bush")
        );
    }

    #[test]
    fn json_names() {
        let text = r#"{"materials": {"a\u0062c": {"Mirror": {}}}, "geometries": [
            {"Plane": {"material": {"Named": "abc"}, "name": "floor"}}],
            "animation": {"frames": 2, "tracks": {"geometries.floor.point": [], "materials[\"abc\"].color": []}}}"#;
        let new = renamed(text, "Named\": \"|abc", "x\"y");
        assert!(new.contains(r#"{"x\"y": {"Mirror"#), "{new}");
        assert!(new.contains(r#"materials[\"x\\\"y\"].color"#), "{new}");
        assert_eq!(
            renamed(text, "name\": \"flo|or", "ground"),
            text.replace("floor", "ground")
        );
    }

    #[test]
    fn invalid_names_are_refused() {
        let source = Source::new(RON, Syntax::Ron);
        let name = |marked: &str| source.name_at(RON.find(marked).unwrap()).unwrap();
        assert!(source.rename(&name("gold"), "gold 2").is_err());
        assert!(source.rename(&name("gold"), "").is_err());
        assert!(source.rename(&name("front"), "a/b").is_err());
        assert!(source.rename(&name("front"), "a b").is_ok());
        assert_eq!(source.name_at(RON.find("#fff").unwrap()), None);
    }
}
