//! Rejection of input that ron and serde_json accept but the format does not.
//!
//! A [`Strict`] deserializer wraps theirs and forwards everything, except that
//! - a struct cannot be read from a sequence, which serde's derive allows in JSON,
//! - RON has no unknown names before a bracket (ron skips any name before a color), no list in the
//!   place of a tuple, and no `Some`.

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, MapAccess, SeqAccess, Unexpected,
    VariantAccess, Visitor,
};

use crate::text::syntax::block_comment;

/// The start of a value, where the inner deserializer does not report it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Start {
    /// Determined by the type alone.
    Plain,
    /// Starts with `Some`.
    Some,
    /// Starts with another name and a bracket.
    Name,
    /// Starts with `[`.
    List,
}

/// Forwards to a deserializer, and rejects slightly more.
pub(crate) struct Strict<'de, D> {
    inner: D,
    context: Context<'de>,
}

#[derive(Clone, Copy)]
struct Context<'de> {
    /// The text of a RON file.
    ron: Option<&'de str>,
    start: Start,
}

impl<'de, D> Strict<'de, D> {
    /// Wraps a JSON deserializer.
    pub(crate) fn json(inner: D) -> Self {
        let context = Context {
            ron: None,
            start: Start::Plain,
        };
        Self { inner, context }
    }

    /// Wraps a RON deserializer, which must borrow its keys from `text`.
    pub(crate) fn ron(inner: D, text: &'de str) -> Self {
        let context = Context {
            ron: Some(text),
            start: Start::Plain,
        };
        Self { inner, context }
    }
}

/// Carries the context along with everything that serde passes on.
struct Wrap<'de, T> {
    inner: T,
    context: Context<'de>,
    /// True if a sequence is allowed here.
    sequence: bool,
    /// True if keys are values of their own, not names of fields.
    map: bool,
}

impl<'de> Context<'de> {
    fn wrap<T>(self, inner: T) -> Wrap<'de, T> {
        let context = Self {
            start: Start::Plain,
            ..self
        };
        Wrap {
            inner,
            context,
            sequence: true,
            map: false,
        }
    }

    fn wrap_struct<T>(self, inner: T) -> Wrap<'de, T> {
        Wrap {
            sequence: false,
            ..self.wrap(inner)
        }
    }

    /// Returns the start of the value after `key`.
    fn start_after(&self, key: &str) -> Start {
        let Some(text) = self.ron else {
            return Start::Plain;
        };
        let end = (key.as_ptr() as usize + key.len()).checked_sub(text.as_ptr() as usize);
        let value = end
            .and_then(|end| text.get(end..))
            .and_then(|rest| skip_blank(rest).strip_prefix(':'))
            .map_or("", skip_blank);
        match value.bytes().next() {
            Some(b'[') => Start::List,
            Some(b'A'..=b'Z' | b'a'..=b'z' | b'_' | 128..) => start_of_name(value),
            _ => Start::Plain,
        }
    }
}

fn start_of_name(value: &str) -> Start {
    // A raw name may hold more.
    let (raw, more) = match value.strip_prefix("r#") {
        Some(raw) => (raw, ".+-"),
        None => (value, ""),
    };
    let end = raw.find(|c: char| !unicode_ident::is_xid_continue(c) && !more.contains(c));
    let (name, rest) = raw.split_at(end.unwrap_or(raw.len()));
    if name == "Some" {
        Start::Some
    } else if skip_blank(rest).starts_with('(') {
        Start::Name
    } else {
        Start::Plain
    }
}

/// Skips white space and comments, which ron has validated.
fn skip_blank(mut text: &str) -> &str {
    loop {
        text = text.trim_start_matches(|c: char| {
            c.is_whitespace() || matches!(c, '\u{200e}' | '\u{200f}')
        });
        if let Some(comment) = text.strip_prefix("//") {
            text = comment.split_once('\n').map_or("", |(_, rest)| rest);
        } else if text.starts_with("/*") {
            let end = block_comment(text.as_bytes(), 0).unwrap_or(text.len());
            text = text.get(end..).unwrap_or("");
        } else {
            return text;
        }
    }
}

macro_rules! forward {
    ($($method:ident)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
            self.inner.$method(self.context.wrap(visitor))
        })*
    };
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Strict<'de, D> {
    type Error = D::Error;

    forward! {
        deserialize_bool deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64
        deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64 deserialize_f32
        deserialize_f64 deserialize_char deserialize_str deserialize_string deserialize_bytes
        deserialize_byte_buf deserialize_unit deserialize_seq
        deserialize_identifier deserialize_ignored_any
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        match self.context.start {
            Start::Plain => self.inner.deserialize_any(self.context.wrap(visitor)),
            Start::List => Err(D::Error::invalid_type(Unexpected::Other("list"), &visitor)),
            Start::Some | Start::Name => {
                Err(D::Error::invalid_type(Unexpected::Other("name"), &visitor))
            }
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        if self.context.start == Start::Some {
            return Err(D::Error::invalid_type(Unexpected::Option, &visitor));
        }
        // The value inside of the option starts like the option.
        self.inner.deserialize_option(Wrap {
            inner: visitor,
            context: self.context,
            sequence: true,
            map: false,
        })
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = self.context.wrap(visitor);
        self.inner.deserialize_unit_struct(name, visitor)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = self.context.wrap(visitor);
        self.inner.deserialize_newtype_struct(name, visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = self.context.wrap(visitor);
        self.inner.deserialize_tuple(length, visitor)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = self.context.wrap(visitor);
        self.inner.deserialize_tuple_struct(name, length, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.inner.deserialize_map(Wrap {
            map: true,
            ..self.context.wrap(visitor)
        })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = self.context.wrap_struct(visitor);
        self.inner.deserialize_struct(name, fields, visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = self.context.wrap(visitor);
        self.inner.deserialize_enum(name, variants, visitor)
    }
}

macro_rules! forward_visits {
    ($($method:ident: $value:ty),*) => {
        $(fn $method<E: Error>(self, value: $value) -> Result<V::Value, E> {
            self.inner.$method(value)
        })*
    };
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Wrap<'de, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.inner.expecting(f)
    }

    forward_visits! {
        visit_bool: bool, visit_i64: i64, visit_u64: u64, visit_f32: f32, visit_f64: f64,
        visit_i8: i8, visit_i16: i16, visit_i32: i32, visit_u8: u8, visit_u16: u16,
        visit_u32: u32, visit_char: char, visit_str: &str, visit_borrowed_str: &'de str,
        visit_string: String, visit_bytes: &[u8], visit_borrowed_bytes: &'de [u8],
        visit_byte_buf: Vec<u8>
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        self.inner.visit_none()
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.inner.visit_unit()
    }

    fn visit_some<D: Deserializer<'de>>(self, inner: D) -> Result<V::Value, D::Error> {
        let context = self.context;
        self.inner.visit_some(Strict { inner, context })
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, inner: D) -> Result<V::Value, D::Error> {
        let context = self.context;
        self.inner.visit_newtype_struct(Strict { inner, context })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<V::Value, A::Error> {
        if self.sequence {
            self.inner.visit_seq(self.context.wrap(seq))
        } else {
            Err(A::Error::invalid_type(Unexpected::Seq, &self.inner))
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<V::Value, A::Error> {
        self.inner.visit_map(Wrap {
            map: self.map,
            ..self.context.wrap(map)
        })
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<V::Value, A::Error> {
        self.inner.visit_enum(self.context.wrap(data))
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Wrap<'de, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, inner: D) -> Result<S::Value, D::Error> {
        let context = self.context;
        self.inner.deserialize(Strict { inner, context })
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Wrap<'de, A> {
    type Error = A::Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, A::Error> {
        self.inner.next_element_seed(self.context.wrap(seed))
    }

    fn size_hint(&self) -> Option<usize> {
        self.inner.size_hint()
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Wrap<'de, A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, A::Error> {
        if self.map || self.context.ron.is_none() {
            return self.inner.next_key_seed(seed);
        }
        let mut start = Start::Plain;
        let key = Key {
            inner: seed,
            context: self.context,
            start: &mut start,
        };
        let key = self.inner.next_key_seed(key)?;
        self.context.start = start;
        Ok(key)
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, A::Error> {
        self.inner.next_value_seed(Wrap {
            inner: seed,
            context: self.context,
            sequence: true,
            map: false,
        })
    }
}

/// Reads a key, and notes the start of the value after it.
struct Key<'de, 'a, T> {
    inner: T,
    context: Context<'de>,
    start: &'a mut Start,
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Key<'de, '_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, inner: D) -> Result<S::Value, D::Error> {
        let Self {
            inner: seed,
            context,
            start,
        } = self;
        seed.deserialize(Key {
            inner,
            context,
            start,
        })
    }
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Key<'de, '_, D> {
    type Error = D::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        let Self {
            inner,
            context,
            start,
        } = self;
        inner.deserialize_identifier(Key {
            inner: visitor,
            context,
            start,
        })
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option
        unit unit_struct newtype_struct seq tuple tuple_struct map struct enum identifier
        ignored_any
    }
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Key<'de, '_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.inner.expecting(f)
    }

    fn visit_borrowed_str<E: Error>(self, key: &'de str) -> Result<V::Value, E> {
        *self.start = self.context.start_after(key);
        self.inner.visit_borrowed_str(key)
    }

    fn visit_str<E: Error>(self, key: &str) -> Result<V::Value, E> {
        self.inner.visit_str(key)
    }
}

impl<'de, A: EnumAccess<'de>> EnumAccess<'de> for Wrap<'de, A> {
    type Error = A::Error;
    type Variant = Wrap<'de, A::Variant>;

    fn variant_seed<T: DeserializeSeed<'de>>(
        self,
        seed: T,
    ) -> Result<(T::Value, Self::Variant), A::Error> {
        let (name, variant) = self.inner.variant_seed(seed)?;
        Ok((name, self.context.wrap(variant)))
    }
}

impl<'de, A: VariantAccess<'de>> VariantAccess<'de> for Wrap<'de, A> {
    type Error = A::Error;

    fn unit_variant(self) -> Result<(), A::Error> {
        self.inner.unit_variant()
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, A::Error> {
        self.inner.newtype_variant_seed(self.context.wrap(seed))
    }

    fn tuple_variant<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        self.inner.tuple_variant(length, self.context.wrap(visitor))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        let visitor = self.context.wrap_struct(visitor);
        self.inner.struct_variant(fields, visitor)
    }
}
