//! The types of the JSON Schema.

use std::sync::OnceLock;

use serde_json::Value;

use crate::{scene::schema::schema, text::syntax::Syntax};

/// A type of the schema: a node without references and `null`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Type(&'static Value);

/// A field of a struct.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field {
    pub(super) name: &'static str,
    pub(super) value: Type,
    /// The node that holds the description and the default.
    about: &'static Value,
    pub(super) is_required: bool,
    /// True if it is required, or the first of several of which one is.
    is_needed: bool,
}

/// A variant of an enum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Variant {
    pub(super) name: &'static str,
    /// The contents; `None` for a bare name.
    pub(super) content: Option<Type>,
    about: Option<&'static Value>,
}

fn root() -> &'static Value {
    static SCHEMA: OnceLock<Value> = OnceLock::new();
    SCHEMA.get_or_init(|| serde_json::from_str(&schema()).unwrap_or_default())
}

fn description(about: &'static Value) -> &'static str {
    about["description"].as_str().unwrap_or_default()
}

/// The samples of the points of a struct, in its order.
const POINTS: [[i8; 3]; 3] = [[0, 0, 0], [1, 1, 1], [1, 0, 0]];
/// That of a direction.
const SIGHT: [[i8; 3]; 1] = [[0, 0, -1]];
/// Those of several.
const EDGES: [[i8; 3]; 2] = [[1, 0, 0], [0, 1, 0]];
/// That of a list of three directions.
const AXES: [[i8; 3]; 3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

fn list(value: &'static Value) -> impl Iterator<Item = &'static Value> {
    value.as_array().into_iter().flatten()
}

/// Returns true for a node that describes values, and does not only restrict those of its parent.
fn is_type(node: &Value) -> bool {
    let keys = ["type", "$ref", "const", "enum", "pattern", "oneOf"];
    keys.iter().any(|key| !node[key].is_null()) && node["type"] != "null"
}

impl Type {
    /// The type of a scene.
    pub(super) fn scene() -> Self {
        Self(root())
    }

    /// Follows references, and leaves out `null`.
    fn of(node: &'static Value) -> Self {
        let mut node = node;
        loop {
            if let Some(name) = node["$ref"].as_str() {
                node = &root()["$defs"][name.rsplit('/').next().unwrap_or_default()];
                continue;
            }
            let mut types = list(&node["anyOf"]).filter(|node| is_type(node));
            match (types.next(), types.next()) {
                (Some(only), None) if node["type"].is_null() => node = only,
                _ => return Self(node),
            }
        }
    }

    /// Returns the types that a value may have.
    fn choices(self) -> impl Iterator<Item = &'static Value> {
        let choices = list(&self.0["oneOf"]).chain(list(&self.0["anyOf"]));
        choices.filter(|node| is_type(node))
    }

    pub(super) fn docs(self) -> &'static str {
        description(self.0)
    }

    pub(super) fn is_color(self) -> bool {
        std::ptr::eq(self.0, &root()["$defs"]["Color"])
    }

    fn allows(self, kind: &str) -> bool {
        let kinds = &self.0["type"];
        kinds == kind || list(kinds).any(|other| other == kind)
    }

    /// Returns the fields of a struct, those that are needed first.
    pub(super) fn fields(self) -> Vec<Field> {
        let required = |name: &str| list(&self.0["required"]).any(|other| other == name);
        let choices = list(&self.0["oneOf"]).chain(list(&self.0["anyOf"]));
        let choice = choices
            .filter_map(|choice| choice["required"][0].as_str())
            .next();
        let properties = self.0["properties"].as_object().into_iter().flatten();
        let fields = properties.map(|(name, about)| Field {
            name,
            value: Self::of(about),
            about,
            is_required: required(name),
            is_needed: required(name) || choice == Some(name),
        });
        let mut fields: Vec<_> = fields.collect();
        fields.sort_by_key(|field| (!field.is_needed, !field.is_required));
        fields
    }

    /// Returns a field of a struct.
    pub(super) fn field(self, name: &str) -> Option<Field> {
        self.fields().into_iter().find(|field| field.name == name)
    }

    /// Returns the type of a value of a struct, a map or an enum, by its name.
    pub(super) fn value(self, name: &str) -> Option<Self> {
        let of_field = self.field(name).map(|field| field.value);
        let of_variant = || self.variant(name)?.content;
        let others = &self.0["additionalProperties"];
        let of_map = || others.is_object().then(|| Self::of(others));
        // The values of all tracks are lists; their paths are not looked at.
        of_field.or_else(of_variant).or_else(of_map)
    }

    /// Returns the type of an element of a list or a tuple.
    pub(super) fn element(self, index: usize) -> Option<Self> {
        let of_tuple = self.0["prefixItems"].get(index);
        let found = of_tuple.or_else(|| self.0.get("items"));
        let of_choice = || self.choices().find_map(|node| node.get("items"));
        found.or_else(of_choice).map(Self::of)
    }

    /// Returns the variants of an enum.
    pub(super) fn variants(self) -> Vec<Variant> {
        let bare = |about: Option<&'static Value>, name: &'static Value| {
            Some(Variant {
                name: name.as_str()?,
                content: None,
                about,
            })
        };
        let of_choice = |node: &'static Value| {
            let named = node["properties"].as_object().into_iter().flatten();
            let named = named.map(move |(name, content)| Variant {
                name,
                content: Some(Self::of(content)),
                about: Some(node),
            });
            let constant = node.get("const").and_then(|name| bare(Some(node), name));
            let names = list(&node["enum"]).filter_map(move |name| bare(None, name));
            named.chain(constant).chain(names).collect::<Vec<_>>()
        };
        let names = list(&self.0["enum"]).filter_map(|name| bare(None, name));
        names.chain(self.choices().flat_map(of_choice)).collect()
    }

    pub(super) fn variant(self, name: &str) -> Option<Variant> {
        self.variants().into_iter().find(|found| found.name == name)
    }

    pub(super) fn is_struct(self) -> bool {
        self.0["properties"].is_object()
    }

    /// Returns true for any text.
    pub(super) fn is_text(self) -> bool {
        self.allows("string") && !self.is_color() && self.variants().is_empty()
    }

    /// Returns true for a map whose keys are paths of values in the scene.
    pub(super) fn has_paths(self) -> bool {
        self.0["patternProperties"].is_object()
    }

    pub(super) fn is_list(self) -> bool {
        self.allows("array") && self.0["maxItems"].is_null()
    }

    /// Returns true if a file with this name has one of the endings of a pattern such as
    /// `\.([rR][oO][nN])$`.
    pub(super) fn is_ending_of(self, name: &str) -> bool {
        let pattern = self.0["pattern"].as_str().unwrap_or_default();
        let endings = pattern.strip_prefix(r"\.(");
        let endings = endings.and_then(|endings| endings.strip_suffix(")$"));
        let (Some(endings), Some((_, ending))) = (endings, name.rsplit_once('.')) else {
            return false;
        };
        endings.split('|').any(|known| {
            let letters = known
                .split(['[', ']'])
                .filter(|letters| !letters.is_empty());
            let letters: Vec<_> = letters.collect();
            let mut pairs = letters.iter().zip(ending.chars());
            letters.len() == ending.chars().count()
                && pairs.all(|(letters, letter)| letters.contains(letter))
        })
    }

    pub(super) fn is_flag(self) -> bool {
        self.allows("boolean")
    }

    /// Returns the type in a few words.
    pub(super) fn words(self) -> String {
        let number = |key: &str| self.0[key].as_f64();
        let kind = match () {
            () if self.is_color() => return "color".to_owned(),
            () if self.is_flag() => return "true or false".to_owned(),
            () if self.is_list() => return "list".to_owned(),
            () if self.allows("array") => match self.0["maxItems"].as_u64() {
                Some(count) => return format!("{count} numbers"),
                None => return "tuple".to_owned(),
            },
            () if self.allows("integer") => "integer",
            () if self.allows("number") => "number",
            () if !self.variants().is_empty() => {
                let names: Vec<_> = self.variants().iter().map(|one| one.name).collect();
                return match names.len() {
                    0..=6 => names.join(" | "),
                    _ => "one of several".to_owned(),
                };
            }
            () if self.allows("string") => return "string".to_owned(),
            () => return String::new(),
        };
        let bounds = [
            number("exclusiveMinimum").map(|least| format!("above {least}")),
            number("minimum").map(|least| format!("at least {least}")),
            number("exclusiveMaximum").map(|most| format!("below {most}")),
            number("maximum").map(|most| format!("at most {most}")),
        ];
        let bounds: Vec<_> = bounds.into_iter().flatten().collect();
        match bounds.is_empty() {
            true => kind.to_owned(),
            false => format!("{kind}, {}", bounds.join(", ")),
        }
    }

    /// Returns true for three numbers.
    fn is_triple(self) -> bool {
        self.0["maxItems"] == 3 && self.0["items"]["type"] == "number" && !self.is_color()
    }

    /// Returns true for three numbers that are not all 0.
    fn is_direction(self) -> bool {
        self.is_triple() && self.0["not"].is_object()
    }

    /// Returns a value of the type as text, with all that is required.
    pub(super) fn sample(self, syntax: Syntax) -> String {
        let tuple = |parts: &[String]| match syntax {
            Syntax::Ron => format!("({})", parts.join(", ")),
            Syntax::Json => format!("[{}]", parts.join(", ")),
        };
        if self.is_color() {
            return "\"#808080\"".to_owned();
        }
        if let Some(variant) = self.variants().first() {
            return variant.sample(syntax);
        }
        if self.is_struct() {
            let fields = self.fields().into_iter();
            let mut needed: Vec<_> = fields.filter(|field| field.is_needed).collect();
            // Those that are always required come first, in the order of the manual.
            let place = |name: &str| list(&self.0["required"]).position(|other| other == name);
            needed.sort_by_key(|field| place(field.name).unwrap_or(usize::MAX));
            let directions = needed.iter().filter(|field| field.value.is_direction());
            // Not a box without a size, nor edges along one line.
            let mut directions = if directions.count() > 1 {
                &EDGES[..]
            } else {
                &SIGHT
            }
            .iter();
            let mut points = POINTS.iter();
            let fields = needed.into_iter().map(|field| {
                let point = match field.value {
                    value if value.is_direction() => directions.next(),
                    value if value.is_triple() => points.next(),
                    _ => None,
                };
                let value = match point {
                    Some(point) => tuple(&point.map(|number| number.to_string())),
                    None => field.value.sample(syntax),
                };
                format!("{}{value}", key(field.name, syntax))
            });
            let fields: Vec<_> = fields.collect();
            return match syntax {
                Syntax::Ron => format!("({})", fields.join(", ")),
                Syntax::Json => format!("{{{}}}", fields.join(", ")),
            };
        }
        match self.0["maxItems"].as_u64() {
            Some(3) if self.0["items"]["maxItems"].is_u64() => {
                let axes = AXES.map(|axis| tuple(&axis.map(|number| number.to_string())));
                format!("[{}]", axes.join(", "))
            }
            Some(count) => tuple(&vec!["0".to_owned(); count as usize]),
            None if self.allows("array") => match self.element(0) {
                Some(element) if self.0["minItems"].is_u64() => {
                    format!("[{}]", element.sample(syntax))
                }
                _ => "[]".to_owned(),
            },
            None if self.is_flag() => "true".to_owned(),
            None if self.allows("number") || self.allows("integer") => "1".to_owned(),
            None => "\"\"".to_owned(),
        }
    }
}

impl Field {
    pub(super) fn docs(self) -> &'static str {
        description(self.about)
    }

    /// Returns the type and the default in a few words.
    pub(super) fn words(self) -> String {
        let words = self.value.words();
        let words = match &self.about["default"] {
            Value::Null => words,
            default => format!("{words}, default {default}"),
        };
        match self.is_required {
            true => format!("{words}, required"),
            false => words,
        }
    }
}

impl Variant {
    pub(super) fn docs(self) -> &'static str {
        let content = self.content.map(Type::docs).unwrap_or_default();
        self.about.map_or(content, description)
    }

    /// Returns the variant as text, with all that is required.
    pub(super) fn sample(self, syntax: Syntax) -> String {
        let content = self.content.map(|content| {
            let text = content.sample(syntax);
            match syntax {
                // A struct has brackets of its own.
                Syntax::Ron if content.is_struct() => text,
                Syntax::Ron => format!("({text})"),
                Syntax::Json => text,
            }
        });
        match (syntax, content) {
            (Syntax::Ron, content) => self.name.to_owned() + &content.unwrap_or_default(),
            (Syntax::Json, None) => format!("\"{}\"", self.name),
            (Syntax::Json, Some(content)) => format!("{{\"{}\": {content}}}", self.name),
        }
    }
}

/// Returns a key with the colon behind it.
pub(super) fn key(name: &str, syntax: Syntax) -> String {
    match syntax {
        Syntax::Ron => format!("{name}: "),
        Syntax::Json => format!("\"{name}\": "),
    }
}
