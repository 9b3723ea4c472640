//! A row of an element of a PLY file.

use std::io::{self, Read};

use crate::{
    data::{
        fault::ReadError,
        mesh::{Flaw, stream::Stream},
        table::{
            layout::Endian,
            ply::{
                ascii::number,
                header::{Element, Type},
            },
        },
    },
    text::nearest::quote,
};

/// The wanted values of a row, as numbers.
#[derive(Default)]
pub(super) struct Row {
    numbers: Vec<f64>,
    /// The index of the first number of each property.
    starts: Vec<usize>,
}

impl Row {
    fn clear(&mut self) {
        self.numbers.clear();
        self.starts.clear();
    }

    /// The number of a property.
    pub(super) fn number(&self, property: usize) -> f64 {
        self.list(property).first().copied().unwrap_or_default()
    }

    /// The numbers of a property.
    pub(super) fn list(&self, property: usize) -> &[f64] {
        let start = self.starts.get(property).copied().unwrap_or_default();
        let end = self.starts.get(property + 1).copied();
        let end = end.unwrap_or(self.numbers.len());
        self.numbers.get(start..end).unwrap_or_default()
    }

    /// Reads a row of a text; returns the fault if it is not one.
    pub(super) fn parse(
        &mut self,
        text: &[u8],
        element: &Element,
        wanted: &[bool],
    ) -> Result<(), (Flaw, String)> {
        self.clear();
        let text = str::from_utf8(text);
        let text = text.map_err(|_| (Flaw::Line, "this is not text".to_owned()))?;
        let mut words = text.split_ascii_whitespace();
        let short = || (Flaw::Length, "too few numbers".to_owned());
        let number = |word, scalar| {
            let unlike = || {
                let word = quote(word);
                (Flaw::Number, format!("{word} is not a number of its type"))
            };
            number(word, scalar).ok_or_else(unlike)
        };
        for (property, wanted) in element.properties.iter().zip(wanted) {
            self.starts.push(self.numbers.len());
            let word = words.next().ok_or_else(short)?;
            match property.kind {
                Type::Scalar(scalar) if *wanted => self.numbers.push(number(word, scalar)?),
                Type::Scalar(_) => {}
                Type::List { item, .. } => {
                    let length: usize = word.parse().map_err(|_| {
                        let word = quote(word);
                        let message = format!("{word} is not the length of a list");
                        (Flaw::Length, message)
                    })?;
                    if *wanted {
                        for _ in 0..length {
                            let word = words.next().ok_or_else(short)?;
                            self.numbers.push(number(word, item)?);
                        }
                    } else if length > 0 {
                        words.nth(length - 1).ok_or_else(short)?;
                    }
                }
            }
        }
        match words.next() {
            Some(_) => Err((Flaw::Length, "too many numbers".to_owned())),
            None => Ok(()),
        }
    }

    /// Reads a row of bytes; returns false if the file ends before, or a list has no length.
    #[inline(always)]
    pub(super) fn read(
        &mut self,
        file: &mut Stream<impl Read>,
        element: &Element,
        endian: Endian,
        wanted: &[bool],
    ) -> Result<bool, ReadError> {
        loop {
            match self.decode(file.bytes(), element, endian, wanted)? {
                Decoded::Row(size) => {
                    file.skip(size, 0);
                    return Ok(true);
                }
                Decoded::Part(needed) if needed as u64 > file.remaining() => return Ok(false),
                Decoded::Part(_) if file.more()? => {}
                Decoded::Part(_) => return Ok(false),
            }
        }
    }

    /// Decodes the row at the start of `bytes`.
    fn decode(
        &mut self,
        bytes: &[u8],
        element: &Element,
        endian: Endian,
        wanted: &[bool],
    ) -> io::Result<Decoded> {
        self.clear();
        let mut at = 0;
        for (property, wanted) in element.properties.iter().zip(wanted) {
            self.starts.push(self.numbers.len());
            let (scalar, end) = match property.kind {
                Type::Scalar(scalar) => (scalar, at + scalar.size()),
                Type::List { length, item } => {
                    let start = at + length.size();
                    let Some(count) = bytes.get(at..start) else {
                        return Ok(Decoded::Part(start));
                    };
                    let count = length.number(count, endian).unwrap_or_default();
                    if count < 0.0 {
                        return Ok(Decoded::Part(usize::MAX));
                    }
                    at = start;
                    let size = (count as usize).saturating_mul(item.size());
                    (item, start.saturating_add(size))
                }
            };
            let Some(cells) = bytes.get(at..end) else {
                return Ok(Decoded::Part(end));
            };
            if *wanted {
                let cells = cells.chunks_exact(scalar.size());
                self.numbers.try_reserve(cells.len())?;
                let number = |cell| scalar.number(cell, endian).unwrap_or_default();
                self.numbers.extend(cells.map(number));
            }
            at = end;
        }
        Ok(Decoded::Row(at))
    }
}

/// The result of decoding a row.
enum Decoded {
    /// The number of bytes of the row.
    Row(usize),
    /// The number of bytes that the row has at least, more than there are.
    Part(usize),
}
