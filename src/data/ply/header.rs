//! The header of a PLY file: elements, each with its properties, in the order of the file.

use std::ops::Range;

use crate::{
    data::{
        bytes::BYTE_ORDER_MARK,
        fault::{At, Fault},
        table::layout::{Endian, Scalar},
    },
    text::nearest::quote,
};

/// The element of the points.
pub(crate) const VERTEX: &str = "vertex";

/// The encoding of the elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ascii,
    Binary(Endian),
}

/// The type of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Type {
    Scalar(Scalar),
    /// A list with its own length in each row.
    List {
        length: Scalar,
        item: Scalar,
    },
}

impl Type {
    /// The type of the first number of a value, which is the length of a list.
    pub(crate) const fn first(self) -> Scalar {
        match self {
            Self::Scalar(scalar) | Self::List { length: scalar, .. } => scalar,
        }
    }

    /// Returns the type and the place of the numbers of a value at the start of `bytes`, or the number
    /// of bytes that it has at least if there are fewer.
    #[inline(always)]
    pub(crate) fn numbers(
        self,
        bytes: &[u8],
        endian: Endian,
    ) -> Result<(Scalar, Range<usize>), usize> {
        let (scalar, place) = match self {
            Self::Scalar(scalar) => (scalar, 0..scalar.size()),
            Self::List { length, item } => {
                let start = length.size();
                let count = bytes.get(..start).ok_or(start)?;
                let count = length.number(count, endian).unwrap_or_default();
                if count < 0.0 {
                    return Err(usize::MAX);
                }
                let size = (count as usize).saturating_mul(item.size());
                (item, start..start.saturating_add(size))
            }
        };
        match place.end <= bytes.len() {
            true => Ok((scalar, place)),
            false => Err(place.end),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Property {
    pub(crate) name: String,
    pub(crate) kind: Type,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Element {
    pub(crate) name: String,
    pub(crate) rows: usize,
    pub(crate) properties: Vec<Property>,
}

impl Element {
    /// Returns the number of bytes in a row, if all rows have the same.
    pub(crate) fn stride(&self) -> Option<usize> {
        let mut properties = self.properties.iter();
        let is_plain = properties.all(|property| matches!(property.kind, Type::Scalar(_)));
        is_plain.then(|| self.smallest_row())
    }

    /// Returns the number of bytes of a row with empty lists.
    pub(crate) fn smallest_row(&self) -> usize {
        let properties = self.properties.iter();
        properties
            .map(|property| property.kind.first().size())
            .sum()
    }
}

/// The help for a file that goes on behind its end.
const BEHIND: &str = "are the numbers of rows in the header right?";

/// The longest header.
const LONGEST: usize = 1 << 20;

#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Header {
    pub(crate) encoding: Encoding,
    pub(crate) elements: Vec<Element>,
    /// The start of the elements.
    pub(crate) end: usize,
    /// The number of lines.
    pub(crate) lines: u64,
    /// The last character of a line.
    pub(crate) line_end: char,
}

impl Header {
    /// The fault of a binary file that has more bytes than rows.
    pub(crate) fn bytes_behind(count: u64) -> Fault {
        let fault = Fault::new(format!("bytes after the last row are not read: {count}"));
        fault.help(BEHIND)
    }

    /// The fault of a text that has more lines than rows.
    pub(crate) fn text_behind(line: u64) -> Fault {
        let fault = At::line(line).fault("text after the last row is not read");
        fault.help(BEHIND)
    }

    /// Returns the element that every file has.
    pub(crate) fn vertex(&self) -> Result<&Element, Fault> {
        let mut elements = self.elements.iter();
        let vertex = elements.find(|element| element.name == VERTEX);
        vertex.ok_or_else(|| Fault::new("there is no element `vertex`"))
    }

    /// The fault of a file without the last line of the header.
    pub(crate) fn endless() -> Fault {
        Fault::new("the header has no end: there is no line `end_header`")
    }

    /// The fault of a file whose header goes on and on.
    fn longer() -> Fault {
        Fault::new("the header is longer than 1 MiB: there is no line `end_header` in it")
    }

    /// Parses the lines up to `end_header`; `None` if these bytes, the first of a file, do not contain
    /// it.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Option<Self>, Fault> {
        let mut lines = Lines::new(bytes);
        if lines.next().is_none_or(|line| line != b"ply") {
            let fault = Fault::new("not a PLY file");
            return Err(fault.help("its first line is `ply`"));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            let Some(line) = lines.next() else {
                return match bytes.len() {
                    0..LONGEST => Ok(None),
                    _ => Err(Self::longer()),
                };
            };
            let number = lines.count;
            if is_comment(line) {
                continue;
            }
            let line = str::from_utf8(line).map_err(|_| {
                let line = quote(&String::from_utf8_lossy(line));
                At::line(number).fault(format!("{line} is not UTF-8"))
            })?;
            let wrong = || {
                let line = quote(line);
                At::line(number).fault(format!("{line} is not a header line"))
            };
            let words: Vec<_> = line.split_ascii_whitespace().collect();
            match words.as_slice() {
                ["end_header"] => break,
                ["format", name, "1.0"] if encoding.is_none() => {
                    encoding = Some(match *name {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::Binary(Endian::Little),
                        "binary_big_endian" => Encoding::Binary(Endian::Big),
                        _ => return Err(wrong()),
                    });
                }
                ["element", name, rows] => {
                    if elements.iter().any(|element| element.name == *name) {
                        let name = quote(name);
                        return Err(Fault::new(format!("the element {name} is given twice")));
                    }
                    elements.push(Element {
                        name: (*name).to_owned(),
                        rows: rows.parse().map_err(|_| wrong())?,
                        properties: Vec::new(),
                    });
                }
                ["property", kind @ .., name] => {
                    let kind = match *kind {
                        [kind] => scalar(kind).map(Type::Scalar),
                        ["list", length, item] => list(length, item),
                        _ => None,
                    };
                    let element = elements.last_mut().ok_or_else(wrong)?;
                    if element
                        .properties
                        .iter()
                        .any(|property| property.name == *name)
                    {
                        let (name, element) = (quote(name), quote(&element.name));
                        let message = format!("the property {name} of {element} is given twice");
                        return Err(Fault::new(message));
                    }
                    element.properties.push(Property {
                        name: (*name).to_owned(),
                        kind: kind.ok_or_else(wrong)?,
                    });
                }
                _ => return Err(wrong()),
            }
        }
        let encoding = encoding.ok_or_else(|| Fault::new("the header has no line `format`"))?;
        Ok(Some(Self {
            encoding,
            elements,
            end: lines.at,
            lines: lines.count,
            line_end: char::from(lines.line_end),
        }))
    }
}

fn scalar(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return None,
    })
}

/// Returns a list type; its length must be an integer.
fn list(length: &str, item: &str) -> Option<Type> {
    let length = scalar(length).filter(|length| length.is_integer())?;
    let item = scalar(item)?;
    Some(Type::List { length, item })
}

/// Returns true for a line that says nothing, which may have any encoding.
fn is_comment(line: &[u8]) -> bool {
    let mut words = line.split(u8::is_ascii_whitespace);
    let first = words.find(|word| !word.is_empty());
    matches!(first, None | Some(b"comment" | b"obj_info"))
}

/// The lines of a header, which may be followed by arbitrary bytes.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    count: u64,
    /// LF, or CR if the first line has no other end.
    line_end: u8,
}

impl<'a> Lines<'a> {
    /// Skips a byte order mark, and whatever is behind the longest header.
    fn new(bytes: &'a [u8]) -> Self {
        let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
        let line_end = match text {
            [b'p', b'l', b'y', b'\r', next, ..] if *next != b'\n' => b'\r',
            _ => b'\n',
        };
        Self {
            bytes: bytes.get(..LONGEST).unwrap_or(bytes),
            at: bytes.len() - text.len(),
            count: 0,
            line_end,
        }
    }

    /// Returns the next line, without its end; `None` if it is incomplete.
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.at..)?;
        let end = rest.iter().position(|byte| *byte == self.line_end)?;
        self.at += end + 1;
        self.count += 1;
        let line = rest.get(..end)?;
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }
}
