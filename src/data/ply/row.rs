//! A row of an element of a PLY file.

use std::{fmt, io};

use crate::{
    data::{
        ply::header::{Element, Type},
        table::layout::{Endian, Scalar},
    },
    text::nearest::quote,
};

/// The reason why a line is not a row.
pub(crate) enum Unlike<'t> {
    Short,
    Long,
    /// A word that is not the length of a list.
    Length(&'t str),
    /// A word that is not a number of the type of its property.
    Number(&'t str),
}

impl fmt::Display for Unlike<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short => f.write_str("too few numbers"),
            Self::Long => f.write_str("too many numbers"),
            Self::Length(word) => write!(f, "{} is not the length of a list", quote(word)),
            Self::Number(word) => write!(f, "{} is not a number of its type", quote(word)),
        }
    }
}

/// Calls `take` with each word of a line, the index of its property, and its type, if it is not the
/// length of a list.
#[inline(always)]
pub(crate) fn words<'t>(
    element: &Element,
    text: &'t str,
    mut take: impl FnMut(usize, &'t str, Option<Scalar>) -> Result<(), Unlike<'t>>,
) -> Result<(), Unlike<'t>> {
    let mut words = text.split_ascii_whitespace();
    for (index, property) in element.properties.iter().enumerate() {
        let word = words.next().ok_or(Unlike::Short)?;
        match property.kind {
            Type::Scalar(scalar) => take(index, word, Some(scalar))?,
            Type::List { item, .. } => {
                let length: usize = word.parse().map_err(|_| Unlike::Length(word))?;
                take(index, word, None)?;
                for _ in 0..length {
                    take(index, words.next().ok_or(Unlike::Short)?, Some(item))?;
                }
            }
        }
    }
    words.next().map_or(Ok(()), |_| Err(Unlike::Long))
}

/// The wanted values of a row, as numbers.
#[derive(Default)]
pub(crate) struct PlyRow {
    numbers: Vec<f64>,
    /// The index of the first number of each property.
    starts: Vec<usize>,
}

impl PlyRow {
    fn clear(&mut self) {
        self.numbers.clear();
        self.starts.clear();
    }

    /// The number of a property.
    pub(crate) fn number(&self, property: usize) -> f64 {
        self.list(property).first().copied().unwrap_or_default()
    }

    /// The numbers of a property.
    pub(crate) fn list(&self, property: usize) -> &[f64] {
        let start = self.starts.get(property).copied().unwrap_or_default();
        let end = self.starts.get(property + 1).copied();
        let end = end.unwrap_or(self.numbers.len());
        self.numbers.get(start..end).unwrap_or_default()
    }

    /// Parses a row of a text.
    pub(crate) fn parse<'t>(
        &mut self,
        text: &'t str,
        element: &Element,
        wanted: &[bool],
    ) -> Result<(), Unlike<'t>> {
        self.clear();
        words(element, text, |property, word, scalar| {
            if self.starts.len() == property {
                self.starts.push(self.numbers.len());
            }
            if let Some(scalar) = scalar
                && wanted.get(property) == Some(&true)
            {
                let number = number(word, scalar).ok_or(Unlike::Number(word))?;
                self.numbers.push(number);
            }
            Ok(())
        })
    }

    /// Decodes the row at the start of `bytes`. Returns its size, or the number of bytes that it has at
    /// least if there are fewer.
    pub(crate) fn decode(
        &mut self,
        bytes: &[u8],
        element: &Element,
        endian: Endian,
        wanted: &[bool],
    ) -> io::Result<Result<usize, usize>> {
        self.clear();
        let mut at = 0;
        for (property, wanted) in element.properties.iter().zip(wanted) {
            self.starts.push(self.numbers.len());
            let rest = bytes.get(at..).unwrap_or_default();
            let (scalar, place) = match property.kind.numbers(rest, endian) {
                Ok(found) => found,
                Err(needed) => return Ok(Err(at.saturating_add(needed))),
            };
            at += place.end;
            if *wanted {
                let cells = rest.get(place).unwrap_or_default();
                let cells = cells.chunks_exact(scalar.size());
                self.numbers.try_reserve(cells.len())?;
                let number = |cell| scalar.number(cell, endian).unwrap_or_default();
                self.numbers.extend(cells.map(number));
            }
        }
        Ok(Ok(at))
    }
}

/// Parses a number as the type in the header: a `float` has the same value as in a binary file.
pub(crate) fn number(word: &str, scalar: Scalar) -> Option<f64> {
    fn parse<T: std::str::FromStr + Into<f64>>(word: &str) -> Option<f64> {
        word.parse::<T>().ok().map(Into::into)
    }
    match scalar {
        Scalar::I8 => parse::<i8>(word),
        Scalar::U8 => parse::<u8>(word),
        Scalar::I16 => parse::<i16>(word),
        Scalar::U16 => parse::<u16>(word),
        Scalar::I32 => parse::<i32>(word),
        Scalar::U32 => parse::<u32>(word),
        Scalar::F32 => parse::<f32>(word),
        // A PLY file has no other types.
        Scalar::F64 | Scalar::I64 | Scalar::U64 | Scalar::F16 | Scalar::Bool => parse::<f64>(word),
    }
}
