//! A numpy array: a header in Python syntax, then the bare numbers.
//!
//! The format is that of numpy's `numpy.lib.format`, versions 1.0, 2.0 and 3.0.

use std::io::Read;

use crate::{
    scene::table::{
        Defaults, Fault, ReadError, Table,
        bytes::{Reading, read_bytes},
        layout::{Column, Endian, Layout, Scalar},
    },
    text::{
        literal::{Literal, Value},
        nearest::quote,
    },
};

/// The start of every file.
const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// The maximum length of a header; numpy itself stops at 10,000.
const LONGEST_HEADER: usize = 1 << 16;

pub(super) fn read(
    mut reader: impl Read,
    length: u64,
    defaults: &Defaults,
) -> Result<Table, ReadError> {
    let (header, start) = header(&mut reader, length)?;
    let Header {
        scalar,
        endian,
        fortran_order,
        rows,
        columns,
    } = Header::parse(&header)?;
    let cells = rows.checked_mul(columns);
    let needed = cells.and_then(|cells| cells.checked_mul(scalar.size()));
    let found = length.saturating_sub(start);
    let needed = needed
        .filter(|needed| *needed as u64 <= found)
        .ok_or_else(|| {
            let size = columns * scalar.size();
            Fault::new(format!(
                "the file is cut off: {rows} rows of {size} bytes, found {found} bytes"
            ))
        })?;
    if needed as u64 != found {
        let behind = found - needed as u64;
        let fault = Fault::new(format!("bytes after the last row: {behind}"));
        return Err(fault.help("a file holds one array").into());
    }
    let size = scalar.size();
    let column = |index: usize| Column::Stored {
        scalar,
        endian,
        start: size * if fortran_order { index * rows } else { index },
        step: size * if fortran_order { 1 } else { columns },
        divisor: 1.0,
    };
    let (radius, color) = (matches!(columns, 4 | 7), matches!(columns, 6 | 7));
    let has = [true, true, true, radius, color, color, color];
    let layout = Layout::some(rows, has, defaults, column);
    Table::read_file(Reading::new(reader, needed)?, layout)
}

/// Reads the header and returns its text and its end.
fn header(reader: &mut impl Read, length: u64) -> Result<(String, u64), ReadError> {
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
            let message = format!("version `{version}` of the format, expected 1.0, 2.0 or 3.0");
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
    let text = String::from_utf8(header).map_err(|_| Fault::new("the header is not text"))?;
    Ok((text, at))
}

/// The contents of a header.
#[derive(Debug, PartialEq)]
struct Header {
    scalar: Scalar,
    endian: Endian,
    fortran_order: bool,
    rows: usize,
    columns: usize,
}

impl Header {
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
        let (scalar, endian) = match entry("descr")? {
            Value::Text(descr) => scalar(descr)?,
            _ => {
                let fault = Fault::new("the array has a structure, expected bare numbers");
                return Err(fault.help(STACK));
            }
        };
        let Value::Flag(fortran_order) = entry("fortran_order")? else {
            return Err(Fault::new("`fortran_order` is neither True nor False"));
        };
        let Value::Shape(shape) = entry("shape")? else {
            return Err(Fault::new("`shape` is not a tuple of whole numbers"));
        };
        let &[rows, columns @ (3 | 4 | 6 | 7)] = shape.as_slice() else {
            let numbers: Vec<_> = shape.iter().map(usize::to_string).collect();
            let fault = Fault::new(format!(
                "the shape is ({}), expected (N, 3), (N, 4) with radius, (N, 6) with r, g, b, or \
                 (N, 7) with both",
                numbers.join(", ")
            ));
            return Err(match shape.as_slice() {
                [3 | 4 | 6 | 7, _] => fault.help("a row is a sphere: save `array.T`"),
                _ => fault.help(STACK),
            });
        };
        Ok(Self {
            scalar,
            endian,
            fortran_order: *fortran_order,
            rows,
            columns,
        })
    }
}

/// The help for creating an array from columns.
const STACK: &str = "`numpy.column_stack((x, y, z, radius, r, g, b))` makes an array of columns";

fn scalar(descr: &str) -> Result<(Scalar, Endian), Fault> {
    Ok(match descr {
        "<f4" => (Scalar::F32, Endian::Little),
        ">f4" => (Scalar::F32, Endian::Big),
        "<f8" => (Scalar::F64, Endian::Little),
        ">f8" => (Scalar::F64, Endian::Big),
        other => {
            let fault = Fault::new(format!(
                "the type is {}, expected `<f4`, `<f8`, `>f4` or `>f8`",
                quote(other)
            ));
            return Err(fault.help("save `array.astype(\"f8\")`"));
        }
    })
}
