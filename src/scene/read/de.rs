//! A reader as a serde deserializer: the types of the model remain the only definition of the
//! format.

use std::iter;

use serde::{
    Deserializer,
    de::{
        DeserializeSeed, EnumAccess, MapAccess, SeqAccess, VariantAccess, Visitor,
        value::{BorrowedStrDeserializer, SeqDeserializer},
    },
};

use super::{
    list,
    reader::{Brackets, Misfit, Reader, Result},
};
use crate::scene::format::scene::Model;

/// The largest number of enums in each other. All types that hold themselves do so by way of an enum,
/// with up to three brackets each, so that this reader accepts no more than the tree's 127.
const DEEPEST: u32 = 32;

/// Rejects types that the format does not have.
macro_rules! unknown {
    ($($method:ident($($argument:ty),*))*) => {
        $(fn $method<V: Visitor<'de>>(self, $(_: $argument,)* _visitor: V) -> Result<V::Value> {
            Err(Misfit)
        })*
    };
}

macro_rules! unsigned {
    ($($method:ident)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
            visitor.visit_u64(self.number()?.unsigned().ok_or(Misfit)?)
        })*
    };
}

impl<'de, const RON: bool> Reader<'de, RON> {
    /// Reads a number where most have a string or a tuple. Inlined, it would slow those down.
    #[cold]
    #[inline(never)]
    fn rare_number<V: Visitor<'de>>(&mut self, visitor: V) -> Result<V::Value> {
        self.deserialize_f64(visitor)
    }
}

impl<'de, const RON: bool> Deserializer<'de> for &mut Reader<'de, RON> {
    type Error = Misfit;

    /// Reads a string or a tuple, or a number or a tuple: the only choices in the format.
    #[inline]
    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        if self.sees(b'"') {
            self.deserialize_str(visitor)
        } else if self.sees(Reader::<RON>::TUPLE.0) {
            self.sequence(Reader::<RON>::TUPLE, visitor)
        } else {
            self.rare_number(visitor)
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        if self.take_word("true") {
            visitor.visit_bool(true)
        } else if self.take_word("false") {
            visitor.visit_bool(false)
        } else {
            Err(Misfit)
        }
    }

    unsigned! { deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64 }

    #[inline]
    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        let number = self.number()?;
        visitor.visit_f64(number.float(self.text).ok_or(Misfit)?)
    }

    #[inline]
    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        visitor.visit_borrowed_str(self.string()?)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        self.deserialize_str(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        if self.take_word(if RON { "None" } else { "null" }) {
            visitor.visit_none()
        } else {
            visitor.visit_some(self)
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        if self.apart.is_some() && self.key == Model::LONG {
            self.apart = Some(list::geometries(self)?);
            return visitor.visit_seq(SeqDeserializer::new(iter::empty::<()>()));
        }
        self.sequence(Reader::<RON>::LIST, visitor)
    }

    #[inline]
    fn deserialize_tuple<V: Visitor<'de>>(self, _length: usize, visitor: V) -> Result<V::Value> {
        self.sequence(Reader::<RON>::TUPLE, visitor)
    }

    #[inline]
    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _length: usize,
        visitor: V,
    ) -> Result<V::Value> {
        self.sequence(Reader::<RON>::TUPLE, visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        if RON && !self.sees(Reader::<RON>::STRUCT.0) && !self.take_word(name) {
            return Err(Misfit);
        }
        self.fields(Reader::<RON>::STRUCT, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value> {
        self.fields(Reader::<RON>::MAP, visitor)
    }

    #[inline]
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value> {
        if !RON && self.sees(b'"') {
            return visitor.visit_enum(BorrowedStrDeserializer::new(self.string()?));
        }
        if self.depth == DEEPEST {
            return Err(Misfit);
        }
        self.depth += 1;
        if RON {
            // As it is: taking the value out of the result would copy every geometry.
            let value = visitor.visit_enum(Variant(&mut *self));
            self.depth -= 1;
            return value;
        }
        self.expect(Reader::<RON>::STRUCT.0)?;
        let value = visitor.visit_enum(Variant(&mut *self))?;
        self.expect(Reader::<RON>::STRUCT.1)?;
        self.depth -= 1;
        Ok(value)
    }

    unknown! {
        deserialize_i8() deserialize_i16() deserialize_i32() deserialize_i64() deserialize_f32()
        deserialize_char() deserialize_bytes() deserialize_byte_buf() deserialize_unit()
        deserialize_unit_struct(&'static str) deserialize_newtype_struct(&'static str)
        deserialize_identifier() deserialize_ignored_any()
    }
}

impl<'de, const RON: bool> Reader<'de, RON> {
    /// Returns true if a string or a list follows the next byte, a bracket.
    #[inline]
    fn begins_value(&self) -> bool {
        matches!(self.text.as_bytes().get(self.at + 1), Some(b'"' | b'['))
    }

    /// Reads one value between brackets, as in `Named("gold")` and `Colors(["#000", "#fff"])`.
    fn in_brackets<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value> {
        self.expect(Self::TUPLE.0)?;
        let value = seed.deserialize(&mut *self)?;
        self.take(b',');
        self.expect(Self::TUPLE.1)?;
        Ok(value)
    }

    /// The values between two brackets.
    #[inline(always)]
    fn sequence<V: Visitor<'de>>(
        &mut self,
        (open, close): Brackets,
        visitor: V,
    ) -> Result<V::Value> {
        self.expect(open)?;
        let mut items = Items::new(self, close);
        let value = visitor.visit_seq(&mut items)?;
        items.end()?;
        Ok(value)
    }

    /// Reads the fields of a struct, or the entries of a map, between two brackets.
    #[inline]
    fn fields<V: Visitor<'de>>(&mut self, (open, close): Brackets, visitor: V) -> Result<V::Value> {
        self.expect(open)?;
        let mut items = Items::new(self, close);
        let value = visitor.visit_map(&mut items)?;
        items.end()?;
        Ok(value)
    }
}

/// The items between two brackets, separated by commas.
struct Items<'r, 'de, const RON: bool> {
    reader: &'r mut Reader<'de, RON>,
    close: u8,
    is_first: bool,
}

impl<'r, 'de, const RON: bool> Items<'r, 'de, RON> {
    fn new(reader: &'r mut Reader<'de, RON>, close: u8) -> Self {
        Self {
            reader,
            close,
            is_first: true,
        }
    }

    /// Returns true if another item follows, and skips its comma.
    #[inline(always)]
    fn more(&mut self) -> Result<bool> {
        if self.is_first {
            self.is_first = false;
            return Ok(!self.reader.sees(self.close));
        }
        if self.reader.take(b',') {
            // JSON has no comma after the last item.
            Ok(!RON || !self.reader.sees(self.close))
        } else if self.reader.peek() == self.close {
            Ok(false)
        } else {
            Err(Misfit)
        }
    }

    /// Reads the closing bracket after the requested items.
    #[inline]
    fn end(self) -> Result<()> {
        if RON && !self.is_first {
            self.reader.take(b',');
        }
        self.reader.expect(self.close)
    }
}

impl<'de, const RON: bool> SeqAccess<'de> for &mut Items<'_, 'de, RON> {
    type Error = Misfit;

    #[inline(always)]
    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>> {
        if self.more()? {
            seed.deserialize(&mut *self.reader).map(Some)
        } else {
            Ok(None)
        }
    }
}

impl<'de, const RON: bool> MapAccess<'de> for &mut Items<'_, 'de, RON> {
    type Error = Misfit;

    #[inline]
    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>> {
        if !self.more()? {
            return Ok(None);
        }
        let name = if self.close == Reader::<RON>::MAP.1 {
            self.reader.string()?
        } else {
            self.reader.name()?
        };
        self.reader.expect(b':')?;
        self.reader.key = name;
        seed.deserialize(BorrowedStrDeserializer::new(name))
            .map(Some)
    }

    #[inline]
    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value> {
        seed.deserialize(&mut *self.reader)
    }
}

/// A variant with fields or, in RON, one without, which JSON writes as a string.
struct Variant<'r, 'de, const RON: bool>(&'r mut Reader<'de, RON>);

impl<'de, const RON: bool> EnumAccess<'de> for Variant<'_, 'de, RON> {
    type Error = Misfit;
    type Variant = Self;

    #[inline]
    fn variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<(T::Value, Self)> {
        let name = self.0.name()?;
        if !RON {
            self.0.expect(b':')?;
        }
        let variant = seed.deserialize(BorrowedStrDeserializer::new(name))?;
        Ok((variant, self))
    }
}

impl<'de, const RON: bool> VariantAccess<'de> for Variant<'_, 'de, RON> {
    type Error = Misfit;

    fn unit_variant(self) -> Result<()> {
        if RON { Ok(()) } else { Err(Misfit) }
    }

    #[inline]
    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value> {
        // The name of a variant is not followed by a struct name.
        if RON && !self.0.sees(Reader::<RON>::STRUCT.0) {
            return Err(Misfit);
        }
        if RON && self.0.begins_value() {
            return self.0.in_brackets(seed);
        }
        seed.deserialize(self.0)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _length: usize, _visitor: V) -> Result<V::Value> {
        Err(Misfit)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _fields: &'static [&'static str],
        _visitor: V,
    ) -> Result<V::Value> {
        Err(Misfit)
    }
}
