//! The arrays in NPY and NPZ files of `NumPy`.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use crate::{
    compare::{
        layers::{Layer, NumberKind},
        limit::{self, PictureOptions},
    },
    diagnostic::error::Error,
    film::size::Size,
    text::{
        literal::{Literal, Value},
        members,
        nearest::quote,
    },
};

/// The name given to the array of an NPY file, which has none.
pub(super) const ARRAY: &str = "array";
const MAGIC: &[u8; 6] = b"\x93NUMPY";
const LONGEST_HEADER: u64 = 1 << 16;

pub(super) fn is_npy(file: &[u8]) -> bool {
    file.starts_with(MAGIC)
}

pub(super) fn is_npz(file: &[u8]) -> bool {
    file.starts_with(b"PK\x03\x04")
}

fn broken(what: impl std::fmt::Display) -> Error {
    limit::broken("an array of numpy", what)
}

/// Reads the array of an NPY file.
pub(super) fn npy(file: &[u8], options: &PictureOptions) -> Result<Vec<Layer>, Error> {
    let mut numbers = 0;
    Ok(vec![array(ARRAY, file, options, &mut numbers)?])
}

/// Reads the arrays of an NPZ file.
pub(super) fn npz(file: &[u8], options: &PictureOptions) -> Result<Vec<Layer>, Error> {
    let mut archive = ZipArchive::new(Cursor::new(file)).map_err(broken)?;
    if let Some(name) = members::repeated(file, archive.central_directory_start()) {
        return Err(broken(format!(
            "several arrays have the name {}",
            quote(&name)
        )));
    }
    let mut layers = Vec::new();
    let mut numbers = 0;
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(broken)?;
        let name = entry.name().map_err(broken)?.into_owned();
        let name = name.strip_suffix(".npy").unwrap_or(&name);
        let layer = array(name, entry, options, &mut numbers);
        layers.push(layer.map_err(|error| broken(format!("`{name}`: {error}")))?);
    }
    Ok(layers)
}

/// Reads as much as the header declares and no more, whatever the length of the file. `numbers`
/// counts the values in all arrays of a file.
fn array(
    name: &str,
    mut reader: impl Read,
    options: &PictureOptions,
    numbers: &mut u64,
) -> Result<Layer, Error> {
    let mut take = |count: u64| {
        let mut bytes = Vec::new();
        let read = reader.by_ref().take(count).read_to_end(&mut bytes);
        match read {
            Ok(read) if read as u64 == count => Ok(bytes),
            Ok(_) => Err(broken("the file is cut off")),
            Err(error) => Err(broken(error)),
        }
    };
    let start = take(8)?;
    let wide = match start.split_at(6) {
        (magic, [1, 0]) if magic == MAGIC => 2,
        (magic, [2 | 3, 0]) if magic == MAGIC => 4,
        _ => return Err(broken("the version is not 1, 2 or 3")),
    };
    let length = take(wide)?
        .iter()
        .rev()
        .fold(0, |sum, byte| sum << 8 | u64::from(*byte));
    if length > LONGEST_HEADER {
        return Err(broken("the header is too long"));
    }
    let text = String::from_utf8(take(length)?).map_err(broken)?;
    let Header {
        kind,
        is_big,
        is_fortran,
        size,
        count,
    } = header(&text, options)?;
    *numbers += size.pixels() * count as u64;
    options.check_numbers(*numbers)?;
    let mut bytes = take(size.pixels() * (count * kind.bytes()) as u64)?;
    if !take_nothing(&mut reader)? {
        return Err(broken("there are bytes after the last number"));
    }
    if is_big {
        bytes
            .chunks_exact_mut(kind.bytes())
            .for_each(<[u8]>::reverse);
    }
    if is_fortran {
        bytes = by_rows(&bytes, size, count, kind.bytes());
    }
    Ok(Layer {
        name: name.to_owned(),
        size,
        count,
        kind,
        bytes,
    })
}

fn take_nothing(reader: &mut impl Read) -> Result<bool, Error> {
    let mut one = [0];
    reader.read(&mut one).map(|read| read == 0).map_err(broken)
}

/// Converts numbers whose first index varies fastest to pixel order.
fn by_rows(bytes: &[u8], size: Size, count: usize, one: usize) -> Vec<u8> {
    let (width, height) = (size.width() as usize, size.height() as usize);
    let mut sorted = Vec::with_capacity(bytes.len());
    for y in 0..height {
        for x in 0..width {
            for number in 0..count {
                let at = ((number * width + x) * height + y) * one;
                sorted.extend(&bytes[at..at + one]);
            }
        }
    }
    sorted
}

struct Header {
    kind: NumberKind,
    is_big: bool,
    is_fortran: bool,
    size: Size,
    /// Number of values per pixel.
    count: usize,
}

fn header(text: &str, options: &PictureOptions) -> Result<Header, Error> {
    let mut literal = Literal::new(text);
    let entries = literal.dictionary().filter(|_| literal.is_at_end());
    let entries = entries.ok_or_else(|| broken("the header is not a Python dictionary"))?;
    let entry = |name: &str| {
        let mut all = entries.iter();
        all.find(|(key, _)| key == name).map(|(_, value)| value)
    };
    let (Some(Value::Text(descr)), Some(Value::Flag(is_fortran)), Some(Value::Shape(shape))) =
        (entry("descr"), entry("fortran_order"), entry("shape"))
    else {
        return Err(broken("it is not an array of bare numbers"));
    };
    let (order, kind) = descr.split_at_checked(1).unwrap_or_default();
    let kind = match kind {
        "f2" => NumberKind::F16,
        "f4" => NumberKind::F32,
        "f8" => NumberKind::F64,
        "u1" | "b1" => NumberKind::Unsigned(1),
        "u2" => NumberKind::Unsigned(2),
        "u4" => NumberKind::Unsigned(4),
        "u8" => NumberKind::Unsigned(8),
        "i1" => NumberKind::Signed(1),
        "i2" => NumberKind::Signed(2),
        "i4" => NumberKind::Signed(4),
        "i8" => NumberKind::Signed(8),
        _ => {
            return Err(broken(format!(
                "the type is `{descr}`, expected f2, f4, f8, u1 to u8 and i1 to i8"
            )));
        }
    };
    let (height, width, count) = match **shape {
        [height, width] => (height, width, 1),
        [height, width, count] if count > 0 => (height, width, count),
        _ => {
            return Err(broken(
                "its shape is neither (rows, columns) nor (rows, columns, numbers)",
            ));
        }
    };
    let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
    Ok(Header {
        kind,
        is_big: order == ">",
        is_fortran: *is_fortran,
        size: options.size(side(width), side(height))?,
        count,
    })
}
