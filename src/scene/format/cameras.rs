//! The named cameras of a scene.

use serde::de::MapAccess;

use crate::scene::format::{
    camera::CameraModel,
    map::{Entry, Map},
};

/// Cameras by their names, in the order of the file.
pub type CamerasModel = Map<CameraModel>;

/// Characters that the name of a camera must not contain: it becomes a part of file names, on any
/// system.
const NOT_OF_A_FILE: &[char] = &['/', '\\', ':', '*', '?', '"', '<', '>', '|'];

/// The pattern of the names of cameras.
pub(crate) const NAMES: &str = "^[^./\\\\:*?\"<>|\\u0000-\\u001f\\u007f-\\u009f][^/\\\\:*?\"<>|\\u0000-\\u001f\\u007f-\\u009f]*$";

/// Returns the reason why a string cannot name a camera, if it cannot.
pub(crate) fn fault_of_name(name: &str) -> Option<String> {
    let is_no_part = |letter: &char| letter.is_control() || NOT_OF_A_FILE.contains(letter);
    match name {
        "" => Some("an empty string is not a name".to_owned()),
        // A name that starts with a dot may be a folder, and is hidden.
        _ if name.starts_with('.') => Some("the name of a camera cannot begin with `.`".to_owned()),
        _ => name.chars().find(is_no_part).map(|letter| {
            let letter = letter.escape_default();
            format!("the name of a camera cannot contain `{letter}`")
        }),
    }
}

impl<'de> Entry<'de> for CameraModel {
    const WHAT: &'static str = "a map from names to cameras";

    fn read<A: MapAccess<'de>>(_name: &str, map: &mut A) -> Result<Self, A::Error> {
        map.next_value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_can_be_part_of_file_names() {
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
