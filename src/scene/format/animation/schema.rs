//! JSON Schema of tracks and keys.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Value, json};

use super::{CHANGING, Interpolation, Key, TracksModel};
use crate::scene::format::{
    color::ColorModel,
    field::{Interval, Kind, Triple},
    thing::Type,
    transform::ScaleModel,
};

impl JsonSchema for TracksModel {
    fn schema_name() -> Cow<'static, str> {
        "Tracks".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let numbers = generator.subschema_for::<Key<f64>>();
        let scales = generator.subschema_for::<Key<ScaleModel>>();
        let vectors = generator.subschema_for::<Key<Triple>>();
        let ranges = generator.subschema_for::<Key<Interval>>();
        let colors = generator.subschema_for::<Key<ColorModel>>();
        let keys = |key: &Schema| json!({"type": "array", "minItems": 1, "items": key});
        json_schema!({
            "type": "object",
            "patternProperties": {
                (paths(Kind::has_elements, "\\[\\s*[0-9]+\\s*\\]\\s*")): keys(&numbers),
                (paths(Kind::is_number, "")): keys(&numbers),
                (paths(|kind| kind == Kind::Scale, "")): keys(&scales),
                (paths(Kind::is_vector, "")): keys(&vectors),
                (paths(|kind| kind == Kind::Interval, "")): keys(&ranges),
                (paths(|kind| kind == Kind::Color, "")): keys(&colors),
            },
            "additionalProperties": false,
        })
    }
}

/// Returns the pattern of the paths to the fields of some kinds. Of what lies between the first and
/// the last name it knows nothing.
fn paths(is_it: fn(Kind) -> bool, end: &str) -> String {
    let roots = CHANGING.iter().filter_map(|(root, fields)| {
        let names = fields.iter().filter(|field| is_it(field.kind));
        let names: Vec<_> = names.map(|field| field.name).collect();
        let way = match root.thing.map(|of_type| of_type()) {
            _ if names.is_empty() => return None,
            None => return Some(root.name.to_owned()),
            Some(Type::Object(_)) => "\\s*",
            Some(_) => "\\b.*",
        };
        Some(format!("{}{way}\\.\\s*({})", root.name, names.join("|")))
    });
    let roots: Vec<_> = roots.collect();
    format!("^\\s*({})\\s*{end}$", roots.join("|"))
}

/// Returns the schema of a key from that of its value; `what` describes the value in a few words.
fn key(what: &str, value: &Schema, generator: &mut SchemaGenerator) -> Schema {
    let step = generator.subschema_for::<Interpolation>();
    json_schema!({
        "description": format!(
            "A key: seconds from 0, {what}, and maybe how the value gets here from the key before."
        ),
        "type": "array",
        "prefixItems": [{"type": "number", "minimum": 0}, value, step],
        "minItems": 2,
        "maxItems": 3,
    })
}

macro_rules! keys {
    ($($type:ty, $name:literal, $what:literal;)*) => {
        $(impl JsonSchema for Key<$type> {
            fn schema_name() -> Cow<'static, str> {
                $name.into()
            }

            fn json_schema(generator: &mut SchemaGenerator) -> Schema {
                let value = generator.subschema_for::<$type>();
                key($what, &value, generator)
            }
        })*
    };
}

keys! {
    f64, "NumberKey", "a number";
    ScaleModel, "ScaleKey", "a number or three numbers";
    Triple, "VectorKey", "a point or a direction";
    Interval, "RangeKey", "a range";
    ColorModel, "ColorKey", "a color";
}

impl JsonSchema for Interpolation {
    fn schema_name() -> Cow<'static, str> {
        "Interpolation".into()
    }

    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        let all = [Self::Step, Self::Linear, Self::Smooth];
        let names: Vec<Value> = all.iter().map(|step| json!(step)).collect();
        json_schema!({
            "description": "How a value gets from the key before to this one: it stays and jumps, \
                            goes at constant speed, or along a smooth curve that never overshoots. \
                            `Linear` is the default.",
            "enum": names,
        })
    }
}
