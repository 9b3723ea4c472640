//! The vertices of a PLY file as spheres.
//!
//! From the element `vertex`, the properties x, y, z, radius and red, green, blue are read. All else
//! is skipped but parsed, so that a file that ends too early or too late is reported.

mod ascii;
mod binary;

use std::io::{Cursor, Read};

use crate::{
    data::{
        bytes::{Reading, read_bytes},
        fault::ReadError,
        ply::{
            header::{Element, Encoding, Header, Type, VERTEX},
            selection::Selection,
        },
        table::{Table, request::Request, row_cells::RowCells},
    },
    text::nearest::quote,
};

/// Size of the start of a file that contains the header, except for long ones.
const HEAD: usize = if cfg!(test) { 318 } else { 1 << 16 };

pub(super) fn read(
    mut reader: impl Read,
    length: usize,
    request: &Request,
) -> Result<Table, ReadError> {
    request.refuse_columns("the header of a PLY file names its properties")?;
    let (header, head) = read_header(&mut reader, length)?;
    let selection = Selection::of_spheres(header.vertex()?, request)?;
    let file = Reading::new(head.chain(reader), length)?;
    match header.encoding {
        Encoding::Ascii => ascii::read(&file.finish()?, &header, &selection, &request.defaults),
        Encoding::Binary(endian) => {
            binary::read(file, &header, endian, &selection, &request.defaults)
        }
    }
}

/// Reads the cells of a row, with the names of their columns.
pub(super) fn row_cells(
    reader: impl Read,
    length: usize,
    row: usize,
) -> Result<RowCells, ReadError> {
    let bytes = read_bytes(reader, length)?;
    let header = Header::parse(&bytes)?.ok_or_else(Header::endless)?;
    let texts = match header.encoding {
        Encoding::Ascii => ascii::texts(&bytes, &header, row)?,
        Encoding::Binary(endian) => binary::texts(&bytes, &header, endian, row)?,
    };
    let properties = &header.vertex()?.properties;
    let cells = properties.iter().zip(texts).map(|(property, text)| {
        let text = match property.kind {
            Type::Scalar(_) => text,
            Type::List { .. } => format!("a list of {text}"),
        };
        (&property.name, text)
    });
    Ok(RowCells::new(properties.len(), cells))
}

/// Reads the header of a file of this length, and returns it with all bytes that were read.
fn read_header(
    reader: &mut impl Read,
    length: usize,
) -> Result<(Header, Cursor<Vec<u8>>), ReadError> {
    let mut head = Vec::new();
    while head.len() < length {
        let piece = HEAD.max(head.len()).min(length - head.len());
        head.append(&mut read_bytes(&mut *reader, piece)?);
        if let Some(header) = Header::parse(&head)? {
            return Ok((header, Cursor::new(head)));
        }
    }
    Err(Header::endless().into())
}

/// Formats the place of a row for the start of a message.
fn row_of(element: &Element, row: usize) -> String {
    if element.name == VERTEX {
        format!("row {row}")
    } else {
        format!("element {}, row {row}", quote(&element.name))
    }
}
