//! The elements as bytes, kept as they are if all rows up to the last vertex have the same size.

use std::io::Read;

use crate::{
    data::{
        bytes::Reading,
        fault::{Fault, ReadError},
        table::{
            Defaults, Table,
            check::Check,
            layout::{Column, Endian, Layout, VALUE},
            ply::{
                BEHIND, Selected, Selection, VERTEX,
                header::{Element, Header, Type},
                row_of,
            },
            rows::Rows,
        },
    },
    text::nearest::quote,
};

/// The largest row in bytes that is kept as is: the size of x, y, z, radius and color as f64.
const LARGEST_ROW: usize = 7 * 8;

pub(super) fn read(
    mut file: Reading<impl Read>,
    header: &Header,
    endian: Endian,
    selection: &Selection,
    defaults: &Defaults,
) -> Result<Table, ReadError> {
    let mut check = layout(header, endian, selection, defaults).map(Check::new);
    while file.more()? {
        if let Some(check) = &mut check {
            check.look(file.bytes());
        }
    }
    let bytes = file.finish()?;
    let mut walk = Walk {
        bytes: &bytes,
        endian,
        at: header.end,
    };
    // The vertices: their number, their start and the start of the next element.
    let mut vertices = (0, 0..0);
    for element in &header.elements {
        let start = walk.at;
        walk.skip(element)?;
        if element.name == VERTEX {
            vertices = (element.rows, start..walk.at);
        }
    }
    let behind = bytes.len() - walk.at;
    let behind = (behind > 0).then(|| {
        let message = format!("bytes after the last row are not read: {behind}");
        Fault::new(message).help(BEHIND)
    });
    let (rows, range) = vertices;
    if let Some(check) = check {
        // The bytes after the vertices are not needed.
        let bytes = if range.end < bytes.len() {
            let vertices = bytes.get(..range.end).unwrap_or_default();
            Reading::new(vertices, range.end)?.finish()?
        } else {
            bytes
        };
        return Ok(Table {
            behind,
            ..Table::new(bytes, check, selection.names.clone())
        });
    }
    let mut packed = Rows::new();
    let vertex = header
        .elements
        .iter()
        .find(|element| element.name == VERTEX);
    let properties = vertex.map_or(&[][..], |element| &element.properties);
    let mut walk = Walk {
        bytes: &bytes,
        endian,
        at: range.start,
    };
    let mut places = Vec::with_capacity(properties.len());
    let mut numbers = Vec::with_capacity(VALUE + 1);
    for _ in 0..rows {
        places.clear();
        for property in properties {
            places.push(walk.at);
            // Cannot fail: all values were skipped once before.
            walk.skip_value(property.kind);
        }
        numbers.clear();
        numbers.extend(selection.iter().map(|selected| {
            let at = places.get(selected.index).copied().unwrap_or_default();
            let number = selected
                .scalar
                .number(bytes.get(at..).unwrap_or_default(), endian);
            selected.number(number.unwrap_or_default())
        }));
        packed.push(&numbers, None)?;
    }
    Ok(Table {
        behind,
        ..packed.into_table(selection.has(), selection.names.clone(), defaults)
    })
}

/// Returns the properties of a vertex as text; of lists, their lengths.
pub(super) fn texts(
    bytes: &[u8],
    header: &Header,
    endian: Endian,
    row: usize,
) -> Result<Vec<String>, Fault> {
    let at = header.end.min(bytes.len());
    let mut walk = Walk { bytes, endian, at };
    for element in &header.elements {
        if element.name == VERTEX {
            break;
        }
        walk.skip(element)?;
    }
    let vertex = header.vertex()?;
    let before = Element {
        rows: row,
        ..vertex.clone()
    };
    walk.skip(&before)?;
    let texts = vertex.properties.iter().map(|property| {
        let (Type::Scalar(scalar) | Type::List { length: scalar, .. }) = property.kind;
        let text = scalar.text(bytes.get(walk.at..)?, endian)?;
        walk.skip_value(property.kind)?;
        Some(text)
    });
    Ok(texts.map(Option::unwrap_or_default).collect())
}

/// Returns the layout of the vertices, if it is known before any row is read and the rows are not
/// too large.
fn layout(
    header: &Header,
    endian: Endian,
    selection: &Selection,
    defaults: &Defaults,
) -> Option<Layout> {
    let mut elements = header.elements.iter();
    let mut start = header.end;
    let vertex = loop {
        let element = elements.next()?;
        if element.name == VERTEX {
            break element;
        }
        let size = element.rows.checked_mul(element.stride()?)?;
        start = start.checked_add(size)?;
    };
    let stride = vertex.stride().filter(|stride| *stride <= LARGEST_ROW)?;
    start.checked_add(stride)?;
    if selection.iter().any(|selected| selected.shift.is_some()) {
        return None;
    }
    let column = |selected: Selected| {
        let before = vertex.properties.iter().take(selected.index);
        let offset = before.map(|property| match property.kind {
            Type::Scalar(scalar) => scalar.size(),
            Type::List { .. } => 0,
        });
        Column::Stored {
            scalar: selected.scalar,
            endian,
            start: start + offset.sum::<usize>(),
            step: stride,
            divisor: selected.divisor,
        }
    };
    let columns = selection.columns.map(|selected| selected.map(column));
    Some(Layout::new(vertex.rows, columns, defaults))
}

/// A cursor over the bytes.
struct Walk<'a> {
    bytes: &'a [u8],
    endian: Endian,
    at: usize,
}

impl Walk<'_> {
    /// Skips an element.
    fn skip(&mut self, element: &Element) -> Result<(), Fault> {
        let left = self.bytes.len() - self.at;
        if let Some(stride) = element.stride() {
            let size = element.rows.checked_mul(stride);
            let size = size.filter(|size| *size <= left).ok_or_else(|| {
                let (rows, name) = (element.rows, quote(&element.name));
                Fault::new(format!(
                    "the file is cut off: {rows} rows of {name} of {stride} bytes, found {left} \
                     bytes"
                ))
            })?;
            self.at += size;
            return Ok(());
        }
        for row in 0..element.rows {
            for property in &element.properties {
                if self.skip_value(property.kind).is_none() {
                    let place = row_of(element, row);
                    let message = format!("{place}: the file is cut off, or a list has no length");
                    return Err(Fault::new(message));
                }
            }
        }
        Ok(())
    }

    /// Skips a value; `None` if it is incomplete.
    fn skip_value(&mut self, kind: Type) -> Option<()> {
        let size = match kind {
            Type::Scalar(scalar) => scalar.size(),
            Type::List { length, item } => {
                let count = length.number(self.bytes.get(self.at..)?, self.endian)?;
                // At most 32 bits, so only negative numbers do not fit.
                let count = (count >= 0.0).then_some(count as usize)?;
                length.size() + count.checked_mul(item.size())?
            }
        };
        let end = self.at.checked_add(size)?;
        self.at = (end <= self.bytes.len()).then_some(end)?;
        Some(())
    }
}
