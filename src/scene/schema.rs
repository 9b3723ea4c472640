//! The JSON Schema of the format, generated from the model's types.

use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

use crate::{
    scene::{format::scene::Model, new::new_scene},
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
    one_of_gaze_and_look_at(&mut schema);
    a_camera_is_given(&mut schema);
    something_moves(&mut schema);
    tidy(&mut schema);
    let example: Value = serde_json::from_str(new_scene(Syntax::Json)).unwrap_or_default();
    schema["examples"] = json!([example]);
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}

/// Requires exactly one of `gaze` and `look_at` in every camera; `null` counts as missing.
fn one_of_gaze_and_look_at(schema: &mut Value) {
    let given =
        |field: &str| json!({"required": [field], "properties": {field: {"type": "array"}}});
    let variants = schema["$defs"]["Camera"]["oneOf"].as_array_mut();
    for variant in variants.into_iter().flatten() {
        let properties = variant["properties"].as_object_mut();
        for camera in properties
            .into_iter()
            .flat_map(|properties| properties.values_mut())
        {
            camera["oneOf"] = json!([given("gaze"), given("look_at")]);
        }
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
