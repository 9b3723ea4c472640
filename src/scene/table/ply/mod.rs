//! The vertices of a PLY file: text, or binary in either byte order.
//!
//! The format is Greg Turk's (The PLY Polygon File Format, 1994) with the type names of later
//! tools. From the element `vertex`, the properties x, y, z, radius and red, green, blue are read.
//! All else is skipped but parsed, so that a file that ends too early or too late is reported.

pub(crate) mod ascii;
mod binary;
pub(crate) mod header;

use std::io::Read;

use header::{Element, Encoding, Header, Type};

use crate::{
    scene::table::{
        Fault, ReadError, Request, Table,
        bytes::Reading,
        layout::{COLORS, Columns, Endian, Scalar},
        select::{self, Known, Names},
    },
    text::nearest::quote,
};

/// The element that is read.
pub(crate) const VERTEX: &str = "vertex";

/// The properties of a vertex.
pub(super) const KNOWN: Known = Known {
    columns: [
        Some("x"),
        Some("y"),
        Some("z"),
        None,
        None,
        None,
        Some("radius"),
        Some("red"),
        Some("green"),
        Some("blue"),
    ],
    hex: None,
    columns_word: "properties",
    missing: "the element `vertex` has no property",
    rotation: &[],
};

pub(super) fn read(reader: impl Read, length: u64, request: &Request) -> Result<Table, ReadError> {
    request.refuse_columns("the header of a PLY file names its properties")?;
    let length = usize::try_from(length).map_err(|_| Fault::new("the file is too large"))?;
    let mut file = Reading::new(reader, length)?;
    file.more()?;
    let mut header = Header::parse(file.bytes())?;
    if header.is_none() {
        // The header is long, or has no end.
        while file.more()? {}
        header = Header::parse(file.bytes())?;
    }
    let header = header.ok_or_else(Header::endless)?;
    let selection = Selection::new(header.vertex()?, request)?;
    let endian = match header.encoding {
        Encoding::Ascii => {
            return ascii::read(&file.finish()?, &header, &selection, &request.defaults);
        }
        Encoding::BinaryLittleEndian => Endian::Little,
        Encoding::BinaryBigEndian => Endian::Big,
    };
    binary::read(file, &header, endian, &selection, &request.defaults)
}

/// A property that is read: its index, its type and the divisor of its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Selected {
    pub(crate) index: usize,
    scalar: Scalar,
    pub(crate) divisor: f64,
}

/// The properties that are read.
pub(crate) struct Selection {
    pub(crate) columns: Columns<Option<Selected>>,
    pub(crate) names: Names,
}

impl Selection {
    pub(crate) fn new(vertex: &Element, request: &Request) -> Result<Self, Fault> {
        let names: Vec<_> = vertex
            .properties
            .iter()
            .map(|each| each.name.as_str())
            .collect();
        let selection = select::Selection::new(&names, &KNOWN, request)?;
        let mut columns = [None; _];
        for (at, (column, place)) in columns.iter_mut().zip(selection.places).enumerate() {
            let property = place.and_then(|index| Some((index, vertex.properties.get(index)?)));
            let Some((index, property)) = property else {
                continue;
            };
            let Type::Scalar(scalar) = property.kind else {
                let name = quote(&property.name);
                let message = format!("the property {name} is a list, expected a number");
                return Err(Fault::new(message));
            };
            let selected = Selected {
                index,
                scalar,
                divisor: 1.0,
            };
            *column = Some(match COLORS.contains(&at) {
                true => channel(selected)?,
                false => selected,
            });
        }
        // Vertices have normals, texture coordinates and more, which spheres do not need.
        let names = Names {
            unused: [].into(),
            ..selection.names
        };
        Ok(Self { columns, names })
    }

    /// The properties in the order of the columns.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Selected> {
        self.columns.iter().flatten()
    }

    /// Returns which columns there are.
    pub(crate) fn has(&self) -> Columns<bool> {
        self.columns.map(|selected| selected.is_some())
    }
}

/// Sets the divisor of a channel: 255 for bytes.
fn channel(selected: Selected) -> Result<Selected, Fault> {
    match selected.scalar {
        Scalar::U8 => Ok(Selected {
            divisor: 255.0,
            ..selected
        }),
        Scalar::F32 | Scalar::F64 => Ok(selected),
        _ => {
            let message = "the type of the color does not determine its range";
            Err(Fault::new(message).help("channels are `uchar`, 0 to 255, or `float`, 0 to 1"))
        }
    }
}

/// Formats the place of a row for the start of a message.
fn row_of(element: &Element, row: usize) -> String {
    if element.name == VERTEX {
        format!("row {row}")
    } else {
        format!("element {}, row {row}", quote(&element.name))
    }
}
