//! The JSON Schema of the format, printed from the declarations of its things.

use serde_json::{Map, Value, json};

use crate::{
    scene::{
        format::{
            animation::{CHANGING, Interpolation},
            field::{Field, FieldKind, Range},
            scene::Model,
            thing::{Needs, Object, OneOf, Set, Thing, Type, Variant},
        },
        new::new_scene,
    },
    text::syntax::Syntax,
};

/// The URL of the JSON Schema of this version, for the `$schema` of a scene.
pub const SCHEMA_URL: &str = concat!(
    env!("CARGO_PKG_REPOSITORY"),
    "/raw/v",
    env!("CARGO_PKG_VERSION"),
    "/schemas/scene.schema.json"
);

/// Returns the JSON Schema (draft 2020-12) of the scene format, with which an editor completes and
/// checks JSON scenes.
///
/// It covers names, types, ranges and required fields. The checks between fields and the warnings
/// are those of [`crate::Document`].
///
/// # Examples
///
/// ```
/// let schema: serde_json::Value = serde_json::from_str(&strahl::scene::schema())?;
/// assert_eq!(schema["title"], "Scene");
/// # Ok::<(), serde_json::Error>(())
/// ```
pub fn schema() -> String {
    let mut printer = Printer::default();
    let mut schema = printer.inline(Model::of_type());
    a_mesh_is_given(&mut printer.definitions);
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("Scene");
    schema["$defs"] = json!(printer.definitions);
    let example: Value = serde_json::from_str(new_scene(Syntax::Json)).unwrap_or_default();
    schema["examples"] = json!([example]);
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}

/// Requires a mesh in a file, or its vertices and triangles; `null` counts as missing.
fn a_mesh_is_given(definitions: &mut Map<String, Value>) {
    let (some, none) = (json!({"not": {"type": "null"}}), json!({"type": "null"}));
    let variants = definitions["Geometry"]["oneOf"].as_array_mut();
    let mut properties = variants.into_iter().flatten();
    let mesh = properties.find_map(|variant| variant["properties"].get_mut("Mesh"));
    if let Some(mesh) = mesh {
        mesh["anyOf"] = json!([
            {
                "required": ["file"],
                "properties": {"file": some, "vertices": none, "triangles": none},
            },
            {
                "required": ["vertices", "triangles"],
                "properties": {
                    "file": none, "vertices": some, "triangles": some, "color_by": none,
                },
                "anyOf": [
                    given("color", &some), given("texture", &some), given("material", &some),
                ],
            },
        ]);
    }
}

/// Requires a field with such a value.
fn given(field: &str, value: &Value) -> Value {
    json!({"required": [field], "properties": {field: value}})
}

/// Prints types, with the definitions that they refer to.
#[derive(Default)]
struct Printer {
    definitions: Map<String, Value>,
}

impl Printer {
    fn of(&mut self, of: Type) -> Value {
        match of {
            Type::Flag => json!({"type": "boolean"}),
            Type::Value(kind) => self.value(kind),
            Type::Whole(all) => {
                let (mut node, all) = (json!({"type": "integer", "minimum": 0}), all());
                if !all.is_empty() {
                    node["enum"] = json!(all);
                }
                node
            }
            Type::Text => json!({"type": "string"}),
            Type::Name | Type::NameOfGeometry => json!({"type": "string", "minLength": 1}),
            Type::NameOfMaterial => json!({
                "type": "string",
                "description": "The name of one of the scene's `materials`.",
            }),
            Type::File(endings) => json!({"type": "string", "pattern": pattern(endings)}),
            Type::Matrix => self.defined("Matrix", |_| {
                json!({
                    "description": "Three rows of four numbers.",
                    "type": "array",
                    "items": numbers(4),
                    "minItems": 3,
                    "maxItems": 3,
                })
            }),
            Type::Tuple(item, count) => {
                let item = self.of(item());
                json!({"type": "array", "items": item, "minItems": count, "maxItems": count})
            }
            Type::List(item, least) => {
                let mut node = json!({"type": "array", "items": self.of(item())});
                if least > 0 {
                    node["minItems"] = json!(least);
                }
                node
            }
            Type::Map(value, pattern) => {
                let value = self.of(value());
                let mut node = json!({"type": "object", "additionalProperties": value});
                if let Some(pattern) = pattern {
                    node["propertyNames"] = json!({"pattern": pattern});
                }
                node
            }
            Type::Tracks => self.tracks(),
            Type::Object(object, _) => self.defined(object.name, |it| it.inline(of)),
            Type::OneOf(one_of) => self.defined(one_of.name, |it| it.one_of(one_of)),
        }
    }

    /// Returns a reference to a definition, which is added.
    fn defined(&mut self, name: &str, print: impl FnOnce(&mut Self) -> Value) -> Value {
        if !self.definitions.contains_key(name) {
            // It may refer to itself.
            self.definitions.insert(name.to_owned(), Value::Null);
            let node = print(self);
            self.definitions.insert(name.to_owned(), node);
        }
        json!({"$ref": format!("#/$defs/{name}")})
    }

    fn value(&mut self, kind: FieldKind) -> Value {
        let mut node = match kind {
            FieldKind::Color => return self.defined("Color", |_| color()),
            FieldKind::Scale => return self.defined("Scale", |_| scale()),
            FieldKind::Point => numbers(3),
            FieldKind::Direction | FieldKind::Edge => {
                let mut node = numbers(3);
                node["not"] = json!({"const": [0, 0, 0]});
                node
            }
            FieldKind::Interval => numbers(2),
            FieldKind::Count { .. } | FieldKind::Natural { .. } => json!({"type": "integer"}),
            _ => json!({"type": "number"}),
        };
        if let Some(range) = kind.range() {
            for (key, _, bound) in bounds(range) {
                node[key] = bound;
            }
            if let Range::ZeroOr(low, _) = range {
                node["anyOf"] = json!([{"const": 0}, {"minimum": low}]);
            }
        }
        node
    }

    /// Prints a type in its place, without a definition if it is an object.
    fn inline(&mut self, of: Type) -> Value {
        match of {
            Type::Object(object, is_operand) => self.object(object, is_operand),
            other => self.of(other),
        }
    }

    /// Prints an object; one inside of a solid may take the color and the material of that.
    fn object(&mut self, object: &Object, is_operand: bool) -> Value {
        let mut node = json!({
            "type": "object",
            "description": object.docs,
            "additionalProperties": false,
        });
        let properties = object.fields.iter();
        let properties = properties.map(|field| (field.name.to_owned(), self.field(field)));
        let properties: Map<_, _> = properties.collect();
        if !properties.is_empty() {
            node["properties"] = json!(properties);
        }
        let required = object.fields.iter().filter(|field| field.is_required);
        let required: Vec<_> = required.map(|field| field.name).collect();
        if !required.is_empty() {
            node["required"] = json!(required);
        }
        for set in object.sets {
            let given = given_of(set, object);
            match set.needs {
                Needs::One if !is_operand => node["oneOf"] = given,
                Needs::One | Needs::AtMostOne => node["not"] = json!({"allOf": given}),
                Needs::Any => node["anyOf"] = given,
            }
        }
        node
    }

    fn field(&mut self, field: &Field) -> Value {
        let mut node = self.of((field.of_type)());
        if !field.is_required {
            node = or_null(node);
        }
        node["description"] = json!(field.docs);
        if let Some(default) = field.default {
            node["default"] = whole(default());
        }
        node
    }

    fn one_of(&mut self, one_of: &'static OneOf) -> Value {
        let variants = one_of.variants.iter();
        if variants.clone().all(|one| one.docs.is_empty()) {
            let names: Vec<_> = variants.map(|one| one.name).collect();
            return json!({"description": one_of.docs, "enum": names});
        }
        let variants: Vec<_> = variants
            .map(|one| self.variant(one, Type::OneOf(one_of)))
            .collect();
        json!({"description": one_of.docs, "oneOf": variants})
    }

    fn variant(&mut self, variant: &Variant, of: Type) -> Value {
        let (name, docs) = (variant.name, variant.docs);
        let Some(content) = of.content(variant) else {
            return json!({"type": "string", "description": docs, "const": name});
        };
        json!({
            "type": "object",
            "description": docs,
            "properties": {name: self.inline(content)},
            "required": [name],
            "additionalProperties": false,
        })
    }

    /// Prints tracks, by the kinds of what their paths lead to.
    fn tracks(&mut self) -> Value {
        let all = [
            ("NumberKey", "a number", FieldKind::Number),
            ("ScaleKey", "a number or three numbers", FieldKind::Scale),
            ("VectorKey", "a point or a direction", FieldKind::Point),
            ("RangeKey", "a range", FieldKind::Interval),
            ("ColorKey", "a color", FieldKind::Color),
        ];
        let mut keys = Map::new();
        for (name, what, value) in all {
            let key = self.defined(name, |it| it.key(what, value));
            let list = json!({"type": "array", "minItems": 1, "items": key});
            let is_it = |kind: FieldKind| match value {
                FieldKind::Number => kind.is_number(),
                FieldKind::Point => kind.is_vector(),
                value => kind == value,
            };
            if value == FieldKind::Number {
                let element = paths(FieldKind::has_elements, "\\[\\s*[0-9]+\\s*\\]\\s*");
                keys.insert(element, list.clone());
            }
            keys.insert(paths(is_it, ""), list);
        }
        json!({"type": "object", "patternProperties": keys, "additionalProperties": false})
    }

    /// Prints a key; `what` describes its value in a few words.
    fn key(&mut self, what: &str, value: FieldKind) -> Value {
        let value = self.value(value);
        let step = self.of(Interpolation::of_type());
        json!({
            "description": format!(
                "A key: seconds from 0, {what}, and maybe how the value gets here from the key \
                 before."
            ),
            "type": "array",
            "prefixItems": [{"type": "number", "minimum": 0}, value, step],
            "minItems": 2,
            "maxItems": 3,
        })
    }
}

/// Returns what each list of fields of a set requires; `null` counts as missing.
fn given_of(set: &Set, object: &Object) -> Value {
    let given_field = |name: &&str| {
        let field = object.fields.iter().find(|field| field.name == *name);
        let some = match (set.needs, field.map(|field| (field.of_type)())) {
            (Needs::One | Needs::AtMostOne, _) => json!({"not": {"type": "null"}}),
            (Needs::Any, Some(Type::Map(..) | Type::OneOf(_))) => {
                json!({"type": "object", "minProperties": 1})
            }
            (Needs::Any, Some(Type::Object(..))) => json!({"type": "object"}),
            (Needs::Any, _) => json!({"not": {"type": "null"}}),
        };
        given(name, &some)
    };
    let given = set.fields.iter().map(|list| match list {
        [name] => given_field(name),
        list => json!({"anyOf": list.iter().map(given_field).collect::<Vec<_>>()}),
    });
    given.collect()
}

/// Returns the pattern of the paths to the fields of some kinds. Of what lies between the first and
/// the last name it knows nothing.
fn paths(is_it: impl Fn(FieldKind) -> bool, end: &str) -> String {
    let roots = CHANGING.iter().filter_map(|(root, fields)| {
        let names = fields.iter().filter(|field| is_it(field.kind));
        let names: Vec<_> = names.map(|field| field.name).collect();
        let way = match (root.of_type)() {
            _ if names.is_empty() => return None,
            Type::Value(_) => return Some(root.name.to_owned()),
            Type::Object(..) => "\\s*",
            _ => "\\b.*",
        };
        Some(format!("{}{way}\\.\\s*({})", root.name, names.join("|")))
    });
    let roots: Vec<_> = roots.collect();
    format!("^\\s*({})\\s*{end}$", roots.join("|"))
}

fn numbers(count: usize) -> Value {
    json!({"type": "array", "items": {"type": "number"}, "minItems": count, "maxItems": count})
}

fn color() -> Value {
    json!({
        "description": "Three numbers in 0..1 (red, green, blue; display values, sRGB), or a string \
                        \"#rrggbb\" or \"#rgb\".",
        "anyOf": [
            numbers(3),
            {"type": "string", "pattern": "^#([0-9A-Fa-f]{3}|[0-9A-Fa-f]{6})$"},
        ],
        "examples": ["#ff8000", [1, 0.5, 0]],
    })
}

fn scale() -> Value {
    json!({
        "description": "The factor of all lengths, or the factors along x, y and z.",
        "anyOf": [{"type": "number", "not": {"const": 0}}, numbers(3)],
        "examples": [2, [1, 1, 0.5]],
    })
}

/// Returns the bounds of a range, each with its key and in words.
pub(crate) fn bounds(range: Range) -> Vec<(&'static str, &'static str, Value)> {
    let least = |least: Value| ("minimum", "at least", least);
    let above = |least: u32| ("exclusiveMinimum", "above", json!(least));
    let most = |most: Value| ("maximum", "at most", most);
    let below = |most: Value| ("exclusiveMaximum", "below", most);
    match range {
        Range::Above(low) => vec![above(low)],
        Range::Degrees(low, high) => vec![above(low), below(json!(high))],
        Range::From(low, high) => vec![least(json!(low)), most(json!(high))],
        Range::Within(low, high) => vec![least(json!(low)), most(json!(high))],
        // What lies between is excluded beside these.
        Range::ZeroOr(_, high) => vec![least(json!(0)), most(json!(high))],
        Range::AboveUpTo(low, high) => vec![above(low), most(json!(high))],
        Range::AtLeast(low) => vec![least(json!(low))],
        Range::FromToBelow(low, high) => vec![least(json!(low)), below(json!(high))],
    }
}

/// Returns the pattern of the names with some endings, in either case.
fn pattern(endings: &[&str]) -> String {
    let either = |letter: char| format!("{letter}{}", letter.to_ascii_uppercase());
    let groups = endings.chunk_by(|one, other| one.get(..2) == other.get(..2));
    let groups = groups.map(|group| {
        let Some(first) = group.first() else {
            return String::new();
        };
        // Endings that differ in the last letter only are one.
        let places = first.char_indices().map(|(at, letter)| {
            let mut letters: Vec<_> = group
                .iter()
                .filter_map(|one| one[at..].chars().next())
                .collect();
            letters.dedup();
            match letters.len() {
                1 => format!("[{}]", either(letter)),
                _ => format!("[{}]", letters.into_iter().map(either).collect::<String>()),
            }
        });
        places.collect()
    });
    let groups: Vec<String> = groups.collect();
    format!("\\.({})$", groups.join("|"))
}

/// Allows `null` as well.
fn or_null(mut node: Value) -> Value {
    if !node["$ref"].is_null() {
        return json!({"anyOf": [node, {"type": "null"}]});
    }
    node["type"] = json!([node["type"], "null"]);
    if let Some(all) = node.get_mut("enum").and_then(Value::as_array_mut) {
        all.push(Value::Null);
    }
    node
}

/// Writes whole numbers without a fraction.
pub(crate) fn whole(value: Value) -> Value {
    match value {
        Value::Array(items) => items.into_iter().map(whole).collect(),
        Value::Number(number) => match number.as_f64() {
            Some(float) if float == float.trunc() && float.abs() < 1e15 => json!(float as i64),
            _ => Value::Number(number),
        },
        other => other,
    }
}
