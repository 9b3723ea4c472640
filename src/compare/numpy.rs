//! The arrays in NPY and NPZ files of `NumPy`.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use crate::{
    compare::{
        layers::Layer,
        limit::{self, PictureOptions},
    },
    data::{
        fault::ReadError,
        npy::{self, Descr, Header},
        table::layout::{Endian, Scalar},
    },
    diagnostic::error::Error,
    film::size::Size,
    text::{members, nearest::quote},
};

/// The name given to the array of an NPY file, which has none.
pub(super) const ARRAY: &str = "array";

pub(super) fn is_npy(file: &[u8]) -> bool {
    file.starts_with(npy::MAGIC)
}

pub(super) fn is_npz(file: &[u8]) -> bool {
    file.starts_with(b"PK\x03\x04")
}

fn broken(what: impl std::fmt::Display) -> Error {
    limit::broken("an array of numpy", what)
}

/// Reads the array of an NPY file.
pub(super) fn npy(file: &[u8], options: &PictureOptions) -> Result<Vec<Layer>, Error> {
    let length = file.len() as u64;
    Ok(vec![array(ARRAY, (file, length), options, &mut 0)?])
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
        let length = entry.size();
        let layer = array(name, (entry, length), options, &mut numbers);
        layers.push(layer.map_err(|error| broken(format!("`{name}`: {error}")))?);
    }
    Ok(layers)
}

/// Reads as much as the header declares and no more, whatever the length of the file. `numbers`
/// counts the values in all arrays of a file.
fn array(
    name: &str,
    (mut reader, length): (impl Read, u64),
    options: &PictureOptions,
    numbers: &mut u64,
) -> Result<Layer, Error> {
    let read = Header::read(&mut reader, length).map_err(|error| match error {
        ReadError::Io(error) => broken(error),
        ReadError::Invalid(fault) => broken(fault.message),
    });
    let (header, _) = read?;
    let Descr::Bare(descr) = &header.descr else {
        return Err(broken("it is not an array of bare numbers"));
    };
    let (kind, endian) = match npy::scalar(descr) {
        Some((Scalar::Bool, endian)) => (Scalar::U8, endian),
        Some(found) => found,
        None => {
            return Err(broken(format!(
                "the type is `{descr}`, expected f2, f4, f8, u1 to u8 and i1 to i8"
            )));
        }
    };
    let (height, width, count) = match *header.shape {
        [height, width] => (height, width, 1),
        [height, width, count] if count > 0 => (height, width, count),
        _ => {
            return Err(broken(
                "its shape is neither (rows, columns) nor (rows, columns, numbers)",
            ));
        }
    };
    let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
    let size = options.size(side(width), side(height))?;
    *numbers += size.pixels() * count as u64;
    options.check_numbers(*numbers)?;
    let expected = size.pixels() * (count * kind.size()) as u64;
    let mut bytes = Vec::new();
    let mut elements = reader.take(expected + 1);
    match elements.read_to_end(&mut bytes).map_err(broken)? as u64 {
        found if found < expected => return Err(broken("the file is cut off")),
        found if found > expected => {
            return Err(broken("there are bytes after the last number"));
        }
        _ => {}
    }
    if endian == Endian::Big {
        bytes
            .chunks_exact_mut(kind.size())
            .for_each(<[u8]>::reverse);
    }
    if header.fortran_order {
        bytes = by_rows(&bytes, size, count, kind.size());
    }
    Ok(Layer {
        name: name.to_owned(),
        size,
        count,
        kind,
        bytes,
    })
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
