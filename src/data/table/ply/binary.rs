//! The elements as bytes, kept as they are if all rows up to the last vertex have the same size.

use std::io::Read;

use crate::{
    data::{
        bytes::Reading,
        fault::{Fault, ReadError},
        ply::{
            header::{Element, Header, Type, VERTEX},
            row::PlyRow,
            selection::{Selected, Selection},
        },
        table::{
            Table,
            check::Check,
            layout::{Column, Endian, Layout, VALUE},
            ply::row_of,
            request::Defaults,
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
    let mut rest = bytes.get(header.end..).unwrap_or_default();
    let mut range = 0..0;
    for element in &header.elements {
        let start = bytes.len() - rest.len();
        skip(&mut rest, element, endian)?;
        if element.name == VERTEX {
            range = start..bytes.len() - rest.len();
        }
    }
    let behind = rest.len();
    let behind = (behind > 0).then(|| Header::bytes_behind(behind as u64));
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
    let mut packed = Rows::default();
    let vertex = header.vertex()?;
    let is_read = |index| selection.iter().any(|selected| selected.index == index);
    let wanted: Vec<_> = (0..vertex.properties.len()).map(is_read).collect();
    let mut row = PlyRow::default();
    let mut rest = bytes.get(range).unwrap_or_default();
    let mut numbers = Vec::with_capacity(VALUE + 1);
    for _ in 0..vertex.rows {
        // Has the row: all were skipped once before.
        let size = row.decode(rest, vertex, endian, &wanted)?;
        rest = rest.get(size.unwrap_or_default()..).unwrap_or_default();
        numbers.clear();
        let selected = selection.iter();
        numbers.extend(selected.map(|selected| selected.number(row.number(selected.index))));
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
    let mut rest = bytes.get(header.end..).unwrap_or_default();
    let vertex = header.vertex()?;
    let others = header.elements.iter();
    for element in others.take_while(|element| element.name != VERTEX) {
        skip(&mut rest, element, endian)?;
    }
    let before = Element {
        rows: row,
        ..vertex.clone()
    };
    skip(&mut rest, &before, endian)?;
    let texts = vertex.properties.iter().map(|property| {
        let text = property.kind.first().text(rest, endian)?;
        skip_value(&mut rest, property.kind, endian)?;
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
        let offset = before.map(|property| property.kind.first().size());
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

/// Removes an element from the start of `rest`.
fn skip(rest: &mut &[u8], element: &Element, endian: Endian) -> Result<(), Fault> {
    if let Some(stride) = element.stride() {
        let size = element.rows.checked_mul(stride);
        *rest = size.and_then(|size| rest.get(size..)).ok_or_else(|| {
            let (rows, name, left) = (element.rows, quote(&element.name), rest.len());
            Fault::new(format!(
                "the file is cut off: {rows} rows of {name} of {stride} bytes, found {left} bytes"
            ))
        })?;
        return Ok(());
    }
    for row in 0..element.rows {
        for property in &element.properties {
            skip_value(rest, property.kind, endian).ok_or_else(|| {
                let place = row_of(element, row);
                Fault::new(format!(
                    "{place}: the file is cut off, or a list has no length"
                ))
            })?;
        }
    }
    Ok(())
}

/// Removes a value; returns `None` if it is incomplete.
#[inline(always)]
fn skip_value(rest: &mut &[u8], kind: Type, endian: Endian) -> Option<()> {
    let (_, place) = kind.numbers(rest, endian).ok()?;
    *rest = rest.get(place.end..)?;
    Some(())
}
