//! The names of the root's fields, as serde knows them.

use std::fmt;

use serde::{Deserialize, Deserializer, de, de::Visitor, forward_to_deserialize_any};

use crate::scene::format::scene::Model;

/// Fields that many files have which are no scenes.
const COMMON: &[&str] = &["$schema", "version"];

/// The fields by which a scene can be told from any other file.
pub(crate) fn telling() -> impl Iterator<Item = &'static str> {
    let fields = of::<Model>().iter();
    fields.copied().filter(|field| !COMMON.contains(field))
}

/// The fields of a struct.
pub(crate) fn of<'de, T: Deserialize<'de>>() -> &'static [&'static str] {
    match T::deserialize(Asked) {
        Err(Answer(fields)) => fields,
        Ok(_) => &[],
    }
}

/// Asks a type for the names of its fields; the answer is the error.
struct Asked;

#[derive(Debug)]
struct Answer(&'static [&'static str]);

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.0)
    }
}

impl std::error::Error for Answer {}

impl de::Error for Answer {
    fn custom<T: fmt::Display>(_message: T) -> Self {
        Self(&[])
    }
}

impl<'de> Deserializer<'de> for Asked {
    type Error = Answer;

    fn deserialize_any<V: Visitor<'de>>(self, _visitor: V) -> Result<V::Value, Answer> {
        Err(Answer(&[]))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        _visitor: V,
    ) -> Result<V::Value, Answer> {
        Err(Answer(fields))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_tells_its_fields() {
        let fields: Vec<_> = telling().collect();
        assert_eq!(
            fields,
            [
                "image",
                "camera",
                "cameras",
                "background",
                "geometries",
                "animation",
                "allow"
            ]
        );
    }
}
