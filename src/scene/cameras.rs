//! The cameras of a scene that have names: a map that keeps the order of its file.

use std::{borrow::Cow, collections::HashSet, fmt};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{Error as _, MapAccess, Visitor},
};

use crate::scene::model::CameraModel;

/// Cameras by their names, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CamerasModel(pub(crate) Vec<(Box<str>, CameraModel)>);

/// What the name of a camera must not hold: it becomes a part of the names of files, on any system.
const NOT_OF_A_FILE: &[char] = &['/', '\\', ':', '*', '?', '"', '<', '>', '|'];

/// Why a string cannot be the name of a camera, if it cannot.
pub(crate) fn fault_of_name(name: &str) -> Option<String> {
    let is_no_part = |letter: &char| letter.is_control() || NOT_OF_A_FILE.contains(letter);
    match name {
        "" => Some("an empty string is not a name".to_owned()),
        // What begins with a dot may be a folder, and is hidden.
        _ if name.starts_with('.') => {
            Some("the name of a camera does not begin with `.`".to_owned())
        }
        _ => name.chars().find(is_no_part).map(|letter| {
            let letter = letter.escape_default();
            format!("the name of a camera cannot have `{letter}` in it")
        }),
    }
}

impl Serialize for CamerasModel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, camera)| (name, camera)))
    }
}

impl<'de> Deserialize<'de> for CamerasModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct CamerasVisitor;

        impl<'de> Visitor<'de> for CamerasVisitor {
            type Value = CamerasModel;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("cameras by their names")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<CamerasModel, A::Error> {
                let mut cameras: Vec<(Box<str>, CameraModel)> = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    cameras.push(entry);
                }
                let mut names = HashSet::new();
                match cameras.iter().find(|(name, _)| !names.insert(name)) {
                    Some((name, _)) => {
                        Err(A::Error::custom(format_args!("`{name}` is given twice")))
                    }
                    None => Ok(CamerasModel(cameras)),
                }
            }
        }

        deserializer.deserialize_map(CamerasVisitor)
    }
}

impl JsonSchema for CamerasModel {
    fn schema_name() -> Cow<'static, str> {
        "Cameras".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let camera = generator.subschema_for::<CameraModel>();
        json_schema!({
            "type": "object",
            "additionalProperties": camera,
            "propertyNames": {
                "pattern": "^[^./\\\\:*?\"<>|\\u0000-\\u001f\\u007f-\\u009f][^/\\\\:*?\"<>|\\u0000-\\u001f\\u007f-\\u009f]*$",
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parts_of_names_of_files() {
        for name in ["front", "Front 2", "a.b", "vorn-links", "前", "{camera}"] {
            assert_eq!(fault_of_name(name), None);
        }
        for name in [
            "", ".", "..", ".a", "a/b", "a\\b", "a\0", "c:", "a\n", "\u{85}",
        ] {
            assert!(fault_of_name(name).is_some(), "{name:?}");
        }
    }
}
