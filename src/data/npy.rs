//! The header of a numpy array, in Python syntax; the bare numbers follow.
//!
//! The format is that of numpy's `numpy.lib.format`, versions 1.0, 2.0 and 3.0.

use std::io::Read;

use crate::{
    data::{
        bytes::read_bytes,
        fault::{Fault, ReadError},
        table::layout::{Endian, Scalar},
    },
    text::{
        literal::{Literal, Value},
        nearest::quote,
    },
};

/// The start of every file.
pub(crate) const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// The maximum length of a header; numpy itself stops at 10,000.
const LONGEST_HEADER: usize = 1 << 16;

/// The contents of a header.
#[derive(Debug, PartialEq)]
pub(crate) struct Header {
    pub(crate) descr: Descr,
    /// True if the first index varies fastest.
    pub(crate) fortran_order: bool,
    pub(crate) shape: Vec<usize>,
}

/// The type of an element.
#[derive(Debug, PartialEq)]
pub(crate) enum Descr {
    /// A number, or anything else that has no fields.
    Bare(String),
    /// Fields with their names, types and offsets, and the size of all of them.
    Fields(Vec<(String, String, usize)>, usize),
}

impl Header {
    /// Reads a header; returns its end as well.
    pub(crate) fn read(reader: &mut impl Read, length: u64) -> Result<(Self, u64), ReadError> {
        let mut at = 0;
        let mut take = |count: usize| {
            at += count as u64;
            if at > length {
                return Err(ReadError::from(Fault::new("the header is cut off")));
            }
            read_bytes(reader.by_ref(), count)
        };
        if length < MAGIC.len() as u64 || take(MAGIC.len())? != MAGIC {
            let fault = Fault::new("not a numpy array");
            return Err(fault.help("`numpy.save` writes one").into());
        }
        let version = take(2)?;
        let size = match version.as_slice() {
            [1, 0] => take(2)?,
            [2 | 3, 0] => take(4)?,
            other => {
                let numbers: Vec<_> = other.iter().map(u8::to_string).collect();
                let version = numbers.join(".");
                let message =
                    format!("version `{version}` of the format, expected 1.0, 2.0 or 3.0");
                return Err(Fault::new(message).into());
            }
        };
        let little_endian = size.iter().rev();
        let size = little_endian.fold(0, |size, byte| (size << 8) | usize::from(*byte));
        if size > LONGEST_HEADER {
            let message = format!("a header of {size} bytes, the maximum is {LONGEST_HEADER}");
            return Err(Fault::new(message).into());
        }
        let header = take(size)?;
        let text = match version.as_slice() {
            [3, _] => {
                String::from_utf8(header).map_err(|_| Fault::new("the header is not UTF-8"))?
            }
            // Latin-1, whose bytes are the first characters of Unicode.
            _ => header.into_iter().map(char::from).collect(),
        };
        Ok((Self::parse(&text)?, at))
    }

    fn parse(text: &str) -> Result<Self, Fault> {
        let mut reader = Literal::new(text);
        let entries = reader.dictionary().filter(|_| reader.is_at_end());
        let entries = entries.ok_or_else(|| {
            let shown = quote(text.trim_end());
            Fault::new(format!("the header {shown} is not a Python dictionary"))
        })?;
        let entry = |name: &str| {
            let mut all = entries.iter();
            let found = all.find(|(key, _)| key == name).map(|(_, value)| value);
            found.ok_or_else(|| Fault::new(format!("the header has no `{name}`")))
        };
        let descr = match entry("descr")? {
            Value::Text(descr) => Descr::Bare(descr.clone()),
            Value::List(fields) => fields_of(fields)?,
            _ => return Err(Fault::new("`descr` is neither a type nor a list of fields")),
        };
        let Value::Flag(fortran_order) = entry("fortran_order")? else {
            return Err(Fault::new("`fortran_order` is neither True nor False"));
        };
        let Value::Shape(shape) = entry("shape")? else {
            return Err(Fault::new("`shape` is not a tuple of whole numbers"));
        };
        Ok(Self {
            descr,
            fortran_order: *fortran_order,
            shape: shape.clone(),
        })
    }
}

/// Returns the fields of a structured array.
fn fields_of(list: &[Value]) -> Result<Descr, Fault> {
    let mut fields = Vec::new();
    let mut offset: usize = 0;
    for field in list {
        let Value::Tuple(parts) = field else {
            return Err(Fault::new("a field in `descr` is not a tuple"));
        };
        let name = match parts.first() {
            Some(Value::Text(name)) => name,
            // A title and a name.
            Some(Value::Tuple(names)) => match names.as_slice() {
                [_, Value::Text(name)] => name,
                _ => return Err(Fault::new("a field in `descr` has no name")),
            },
            _ => return Err(Fault::new("a field in `descr` has no name")),
        };
        let shown = quote(name);
        let descr = match &parts[1..] {
            [Value::Text(descr)] => descr,
            [Value::List(_), ..] => {
                let message = format!("the field {shown} has fields itself, expected a number");
                return Err(Fault::new(message).help(FLAT));
            }
            [Value::Text(_), Value::Shape(shape)] => {
                let count: Vec<_> = shape.iter().map(usize::to_string).collect();
                let count = count.join(" times ");
                let message =
                    format!("the field {shown} has {count} numbers in each row, expected one");
                return Err(Fault::new(message).help(FLAT));
            }
            _ => return Err(Fault::new(format!("the field {shown} has no type"))),
        };
        let size = size_of(descr).ok_or_else(|| not_numbers(&format!("field {shown}"), descr))?;
        // Nameless fields fill the space between aligned ones.
        if !name.is_empty() {
            fields.push((name.clone(), descr.clone(), offset));
        }
        offset = offset
            .checked_add(size)
            .ok_or_else(|| Fault::new("the fields are too large"))?;
    }
    Ok(Descr::Fields(fields, offset))
}

/// The help for fields that are not numbers.
const FLAT: &str =
    "give each number a field of its own, such as `numpy.dtype([(\"x\", \"f8\"), …])`";

pub(crate) fn not_numbers(what: &str, descr: &str) -> Fault {
    let message = format!(
        "the type of the {what} is {}, expected numbers",
        quote(descr)
    );
    Fault {
        help: remedy(descr).map(str::to_owned),
        ..Fault::new(message)
    }
}

/// Returns the help for an array of a type that is not one of numbers.
pub(crate) fn remedy(descr: &str) -> Option<&'static str> {
    Some(match descr.as_bytes() {
        [b'|', b'O', ..] => "these are Python objects: save `array.astype(\"f8\")`",
        [_, b'c', ..] => "complex numbers have two parts: save `array.real` or `abs(array)`",
        [_, b'U' | b'S', ..] => "this is text: save `array.astype(\"f8\")`",
        [_, b'M' | b'm', ..] => "these are times: save `array.astype(\"i8\").astype(\"f8\")`",
        _ => return None,
    })
}

/// Returns the type of numbers; `None` for anything else.
pub(crate) fn scalar(descr: &str) -> Option<(Scalar, Endian)> {
    let (order, kind) = descr.split_at_checked(1)?;
    let scalar = match kind {
        "i1" => Scalar::I8,
        "u1" => Scalar::U8,
        "i2" => Scalar::I16,
        "u2" => Scalar::U16,
        "i4" => Scalar::I32,
        "u4" => Scalar::U32,
        "i8" => Scalar::I64,
        "u8" => Scalar::U64,
        "f2" => Scalar::F16,
        "f4" => Scalar::F32,
        "f8" => Scalar::F64,
        "b1" => Scalar::Bool,
        _ => return None,
    };
    let endian = match order {
        "<" => Endian::Little,
        ">" => Endian::Big,
        "|" if scalar.size() == 1 => Endian::Little,
        _ => return None,
    };
    Some((scalar, endian))
}

/// Returns the size of any element in bytes; `None` for Python objects and unknown types.
pub(crate) fn size_of(descr: &str) -> Option<usize> {
    let (order, kind) = descr.split_at_checked(1)?;
    let (kind, count) = kind.split_at_checked(1)?;
    if !matches!(order, "<" | ">" | "|") {
        return None;
    }
    // Units of time follow in brackets.
    let count = count.split('[').next().unwrap_or_default();
    let count: usize = count.parse().ok()?;
    match kind {
        "U" => count.checked_mul(4),
        "b" | "c" | "f" | "i" | "m" | "M" | "S" | "u" | "V" => Some(count),
        _ => None,
    }
}
