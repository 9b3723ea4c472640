//! The vertices of a PLY file: text, or binary in either byte order.
//!
//! The format is Greg Turk's (The PLY Polygon File Format, 1994) with the type names of later
//! tools. From the element `vertex`, the properties x, y, z, radius and red, green, blue are read.
//! All else is skipped but parsed, so that a file that ends too early or too late is reported.

mod ascii;
mod binary;
mod header;

use std::io::Read;

use header::{Element, Encoding, Header, Type};

use crate::{
    scene::table::{
        Defaults, Fault, ReadError, Table,
        bytes::Reading,
        layout::{Columns, Endian, Scalar},
    },
    text::nearest::quote,
};

/// The element that is read.
const VERTEX: &str = "vertex";

pub(super) fn read(
    reader: impl Read,
    length: u64,
    defaults: &Defaults,
) -> Result<Table, ReadError> {
    let length = usize::try_from(length).map_err(|_| Fault::new("the file is too large"))?;
    let mut file = Reading::new(reader, length)?;
    file.more()?;
    let mut header = Header::parse(file.bytes())?;
    if header.is_none() {
        // The header is long, or has no end.
        while file.more()? {}
        header = Header::parse(file.bytes())?;
    }
    let header =
        header.ok_or_else(|| Fault::new("the header has no end: there is no line `end_header`"))?;
    let vertex = header
        .elements
        .iter()
        .find(|element| element.name == VERTEX);
    let vertex = vertex.ok_or_else(|| Fault::new("there is no element `vertex`"))?;
    let selection = selection(vertex)?;
    let endian = match header.encoding {
        Encoding::Ascii => return ascii::read(&file.finish()?, &header, &selection, defaults),
        Encoding::BinaryLittleEndian => Endian::Little,
        Encoding::BinaryBigEndian => Endian::Big,
    };
    binary::read(file, &header, endian, &selection, defaults)
}

/// A property that is read: its index, its type and the divisor of its values.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Selected {
    index: usize,
    scalar: Scalar,
    divisor: f64,
}

/// The properties that are read.
type Selection = Columns<Option<Selected>>;

fn selection(vertex: &Element) -> Result<Selection, Fault> {
    let find = |name: &str| -> Result<Option<Selected>, Fault> {
        let mut properties = vertex.properties.iter().enumerate();
        let Some((index, property)) = properties.find(|(_, other)| other.name == name) else {
            return Ok(None);
        };
        match property.kind {
            Type::Scalar(scalar) => Ok(Some(Selected {
                index,
                scalar,
                divisor: 1.0,
            })),
            Type::List { .. } => {
                let name = quote(name);
                let message = format!("the property {name} is a list, expected a number");
                Err(Fault::new(message))
            }
        }
    };
    let needed = |name: &str| {
        find(name)?.ok_or_else(|| {
            let message = format!("the element `vertex` has no property {}", quote(name));
            Fault::new(message)
        })
    };
    let color = [find("red")?, find("green")?, find("blue")?];
    if color.contains(&None) && color != [None; 3] {
        let message = "of the properties `red`, `green` and `blue` only some are given";
        return Err(Fault::new(message).help("give all three, or none"));
    }
    let [r, g, b] = color.map(|selected| selected.map(channel).transpose());
    let (r, g, b) = (r?, g?, b?);
    let (x, y, z) = (needed("x")?, needed("y")?, needed("z")?);
    Ok([Some(x), Some(y), Some(z), find("radius")?, r, g, b])
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
