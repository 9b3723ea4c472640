//! The vertices of a PLY file: text, or binary in either byte order.
//!
//! The format is Greg Turk's (The PLY Polygon File Format, 1994) with the type names of later
//! tools. From the element `vertex`, the properties x, y, z, radius and red, green, blue are read.
//! All else is skipped but parsed, so that a file that ends too early or too late is reported.

pub(crate) mod ascii;
mod binary;
pub(crate) mod header;

use std::io::{Cursor, Read};

use header::{Element, Encoding, Header, Type};

use crate::{
    scene::table::{
        Fault, ReadError, Request, Table,
        bytes::{Reading, read_bytes},
        layout::{COLORS, Columns, Endian, Scalar, VALUE},
        select::{self, Known, Names},
    },
    text::nearest::quote,
};

/// The element that is read.
pub(crate) const VERTEX: &str = "vertex";

/// Size of the start of a file that contains the header, except for long ones.
const HEAD: usize = if cfg!(test) { 318 } else { 1 << 16 };

/// The properties of a vertex that is a sphere.
pub(super) const KNOWN: Known = known(Some("radius"), COLOR);

/// The channels of the color of a vertex.
const COLOR: [Option<&str>; 3] = [Some("red"), Some("green"), Some("blue")];

/// Returns the properties of a vertex with or without a radius and a color.
const fn known(radius: Option<&'static str>, color: [Option<&'static str>; 3]) -> Known {
    let [red, green, blue] = color;
    Known {
        columns: [
            Some("x"),
            Some("y"),
            Some("z"),
            None,
            None,
            None,
            radius,
            red,
            green,
            blue,
        ],
        hex: None,
        columns_word: "properties",
        missing: "the element `vertex` has no property",
        rotation: &[],
    }
}

pub(super) fn read(
    mut reader: impl Read,
    length: u64,
    request: &Request,
) -> Result<Table, ReadError> {
    request.refuse_columns("the header of a PLY file names its properties")?;
    let length = usize::try_from(length).map_err(|_| Fault::new("the file is too large"))?;
    let (header, head) = read_header(&mut reader, length)?;
    let selection = Selection::of_spheres(header.vertex()?, request)?;
    let file = Reading::new(head.chain(reader), length)?;
    let endian = match header.encoding {
        Encoding::Ascii => {
            return ascii::read(&file.finish()?, &header, &selection, &request.defaults);
        }
        Encoding::BinaryLittleEndian => Endian::Little,
        Encoding::BinaryBigEndian => Endian::Big,
    };
    binary::read(file, &header, endian, &selection, &request.defaults)
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
    /// Selects the properties of spheres.
    fn of_spheres(vertex: &Element, request: &Request) -> Result<Self, Fault> {
        Self::new(vertex, &KNOWN, request)
    }

    /// Selects the properties of the corners of triangles: their colors if these are wanted, and the
    /// property whose values determine the colors.
    pub(crate) fn of_corners(
        vertex: &Element,
        has_colors: bool,
        value: Option<&str>,
    ) -> Result<Self, Fault> {
        let color = if has_colors { COLOR } else { [None; 3] };
        let request = Request {
            value,
            ..Request::default()
        };
        Self::new(vertex, &known(None, color), &request)
    }

    fn new(vertex: &Element, known: &Known, request: &Request) -> Result<Self, Fault> {
        let names: Vec<_> = vertex
            .properties
            .iter()
            .map(|each| each.name.as_str())
            .collect();
        let selection = select::Selection::new(&names, known, request)?;
        let mut columns = [None; _];
        for (at, (column, place)) in columns.iter_mut().zip(selection.places).enumerate() {
            let property = place.and_then(|index| Some((index, vertex.properties.get(index)?)));
            let Some((index, property)) = property else {
                continue;
            };
            let Type::Scalar(scalar) = property.kind else {
                let name = quote(&property.name);
                let message = format!("the property {name} is a list, expected a number");
                let fault = Fault::new(message);
                return Err(match at {
                    VALUE => fault.blame_value(&names_of_numbers(vertex)),
                    _ => fault,
                });
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

fn names_of_numbers(vertex: &Element) -> Vec<&str> {
    let properties = vertex.properties.iter();
    let numbers = properties.filter(|property| matches!(property.kind, Type::Scalar(_)));
    numbers.map(|property| property.name.as_str()).collect()
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
