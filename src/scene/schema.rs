//! The JSON Schema of the format, generated from the model's types.

use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

use crate::{
    scene::{
        format::{
            geometry::solid::{COMBINED, SOLIDS},
            scene::Model,
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
    let generator = SchemaSettings::draft2020_12().into_generator();
    let mut schema = generator.into_root_schema_for::<Model>().to_value();
    one_of(&mut schema, "Camera", ["gaze", "look_at"], &[]);
    one_of(&mut schema, "Light", ["direction", "look_at"], &[]);
    operands(&mut schema);
    let surface = ["color", "material"];
    let with_less = [&["Mesh", "Spheres", "Cylinders"][..], COMBINED].concat();
    one_of(&mut schema, "Geometry", surface, &with_less);
    one_of(&mut schema, "Solid", surface, SOLIDS);
    a_mesh_is_given(&mut schema);
    a_camera_is_given(&mut schema);
    something_moves(&mut schema);
    tidy(&mut schema);
    let example: Value = serde_json::from_str(new_scene(Syntax::Json)).unwrap_or_default();
    schema["examples"] = json!([example]);
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}

/// The description of all solids.
const SOLID: &str =
    "A solid, inside of another one. Its color or material may be that of the solid around it.";

/// Allows only solids inside of solids: they are geometries of a definition of their own.
fn operands(schema: &mut Value) {
    let is_solid = |variant: &Value| {
        let mut solids = SOLIDS.iter();
        solids.any(|solid| !variant["properties"][solid].is_null())
    };
    let definitions = &mut schema["$defs"];
    let variants = definitions["Geometry"]["oneOf"].as_array_mut();
    for variant in variants.into_iter().flatten() {
        for name in COMBINED {
            let Some(fields) = variant["properties"].get_mut(name) else {
                continue;
            };
            let solid = json!("#/$defs/Solid");
            if *name == "Difference" {
                fields["properties"]["of"]["$ref"] = solid.clone();
                fields["properties"]["minus"]["items"]["$ref"] = solid;
            } else {
                fields["properties"]["of"]["items"]["$ref"] = solid;
            }
        }
    }
    let mut solid = definitions["Geometry"].clone();
    if let Some(variants) = solid["oneOf"].as_array_mut() {
        variants.retain(is_solid);
    }
    solid["description"] = json!(SOLID);
    definitions["Solid"] = solid;
}

/// Requires exactly one of two fields in the variants of a definition that have both; `null` counts as
/// missing. Those of `at_most` may have neither.
fn one_of(schema: &mut Value, definition: &str, pair: [&str; 2], at_most: &[&str]) {
    let some = json!({"not": {"type": "null"}});
    let given = pair.map(|field| json!({"required": [field], "properties": {field: some}}));
    let variants = schema["$defs"][definition]["oneOf"].as_array_mut();
    let properties = variants.into_iter().flatten();
    let properties = properties.filter_map(|variant| variant["properties"].as_object_mut());
    for (name, variant) in properties.flatten() {
        if pair
            .iter()
            .any(|field| variant["properties"][field].is_null())
        {
            continue;
        }
        if at_most.contains(&name.as_str()) {
            variant["not"] = json!({"allOf": given});
        } else {
            variant["oneOf"] = json!(given);
        }
    }
}

/// Requires a mesh in a file, or its vertices and triangles; `null` counts as missing.
fn a_mesh_is_given(schema: &mut Value) {
    let (some, none) = (json!({"not": {"type": "null"}}), json!({"type": "null"}));
    let variants = schema["$defs"]["Geometry"]["oneOf"].as_array_mut();
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
                    {"required": ["color"], "properties": {"color": some}},
                    {"required": ["material"], "properties": {"material": some}},
                ],
            },
        ]);
    }
}

/// Requires a camera, with or without a name; `null` counts as missing.
fn a_camera_is_given(schema: &mut Value) {
    let some = json!({"type": "object", "minProperties": 1});
    let given = |field: &str| json!({"required": [field], "properties": {field: some}});
    schema["anyOf"] = json!([given("camera"), given("cameras")]);
}

/// Requires tracks or an orbit in an animation; `null` counts as missing.
fn something_moves(schema: &mut Value) {
    let some = json!({"type": "object"});
    let given = |field: &str| json!({"required": [field], "properties": {field: some}});
    schema["$defs"]["Animation"]["anyOf"] = json!([given("tracks"), given("orbit")]);
}

/// Removes parts that editors do not show well: line breaks inside of sentences, and formats that
/// only name Rust's types.
fn tidy(schema: &mut Value) {
    match schema {
        Value::Object(fields) => {
            fields.remove("format");
            if let Some(Value::String(description)) = fields.get_mut("description") {
                *description = description.replace('\n', " ");
            }
            fields.values_mut().for_each(tidy);
        }
        Value::Array(items) => items.iter_mut().for_each(tidy),
        _ => {}
    }
}
