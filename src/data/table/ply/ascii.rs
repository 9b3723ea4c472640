//! The elements as text, one line per row.

use std::{iter::Enumerate, str::Split};

use crate::{
    data::{
        fault::{At, Fault, LinePart, ReadError, Wrong},
        ply::{
            header::{Element, Header, VERTEX},
            row::{self, Unlike, number},
            selection::{Selected, Selection},
        },
        table::{Table, ply::row_of, request::Defaults, rows::Rows},
    },
    text::nearest::quote,
};

pub(super) fn read(
    bytes: &[u8],
    header: &Header,
    selection: &Selection,
    defaults: &Defaults,
) -> Result<Table, ReadError> {
    let mut lines = Text::of(bytes, header)?;
    let mut rows = Rows::default();
    'elements: for element in &header.elements {
        // A row of an element without properties is empty.
        if element.properties.is_empty() {
            continue;
        }
        for row in 0..element.rows {
            let Some((line, text)) = lines.next() else {
                rows.note(Wrong::End, "", || {
                    let (name, count) = (quote(&element.name), element.rows);
                    Fault::new(format!(
                        "the file is cut off: {row} of {count} rows of {name}"
                    ))
                });
                break 'elements;
            };
            let words = words(element, row, line, text)
                .map_err(|fault| rows.note(Wrong::Length, &element.name, || fault));
            if element.name == VERTEX {
                let numbers = match words {
                    Ok(words) => numbers(element, selection, &words, row, line, &mut rows),
                    Err(unread) => selection.iter().map(|_| unread).collect(),
                };
                rows.push(&numbers, Some(line))?;
            }
        }
    }
    let behind = lines.next().map(|(line, _)| Header::text_behind(line));
    Ok(Table {
        behind,
        ..rows.into_table(selection.has(), selection.names.clone(), defaults)
    })
}

/// Returns the properties of a vertex as text; of lists, their lengths.
pub(super) fn texts(bytes: &[u8], header: &Header, row: usize) -> Result<Vec<String>, Fault> {
    let mut lines = Text::of(bytes, header)?;
    let all = header.elements.iter();
    let all = all.filter(|element| !element.properties.is_empty());
    let before = all.take_while(|element| element.name != VERTEX);
    let before: usize = before.map(|element| element.rows).sum();
    for _ in 0..before.saturating_add(row) {
        lines.next();
    }
    let (line, text) = lines.next().unwrap_or_default();
    let words = words(header.vertex()?, row, line, text)?;
    Ok(words.into_iter().map(str::to_owned).collect())
}

/// The nonempty lines with their numbers.
struct Text<'a> {
    lines: Enumerate<Split<'a, char>>,
    before: u64,
}

impl<'a> Text<'a> {
    /// Creates the lines behind a header.
    fn of(bytes: &'a [u8], header: &Header) -> Result<Self, Fault> {
        let body = bytes.get(header.end..).unwrap_or_default();
        let body = std::str::from_utf8(body).map_err(|error| {
            let at = header.end + error.valid_up_to();
            Fault::new(format!(
                "the byte at {at} is not text, although the header says `ascii`"
            ))
        })?;
        Ok(Self {
            lines: body.split(header.line_end).enumerate(),
            before: header.lines + 1,
        })
    }

    fn next(&mut self) -> Option<(u64, &'a str)> {
        let is_text = |(_, text): &(usize, &str)| !text.trim_ascii().is_empty();
        let (index, text) = self.lines.find(is_text)?;
        Some((self.before + index as u64, text))
    }
}

/// Returns the first word of each property.
fn words<'a>(
    element: &Element,
    row: usize,
    line: u64,
    text: &'a str,
) -> Result<Vec<&'a str>, Fault> {
    let mut words = Vec::with_capacity(element.properties.len());
    let read = row::words(element, text, |property, word, _| {
        if words.len() == property {
            words.push(word);
        }
        Ok(())
    });
    match read {
        Ok(()) => Ok(words),
        Err(unlike) => {
            let place = At::new(format!("{} (line {line})", row_of(element, row)), line);
            let place = match unlike {
                Unlike::Length(word) => place.word(word),
                _ => place,
            };
            Err(place.fault(unlike))
        }
    }
}

fn numbers(
    element: &Element,
    selection: &Selection,
    words: &[&str],
    row: usize,
    line: u64,
    rows: &mut Rows,
) -> Vec<f64> {
    let number = |selected: &Selected| {
        let word = words.get(selected.index).copied().unwrap_or_default();
        let number = number(word, selected.scalar).map(|number| selected.number(number));
        number.unwrap_or_else(|| {
            let property = element.properties.get(selected.index);
            let name = property.map_or("", |property| &property.name);
            rows.note(Wrong::Number, name, || {
                let (at, of) = (selected.index, element.properties.len());
                let cell = At::cell(row, Some(line), name).part(LinePart::Cell { at, of });
                cell.fault(Unlike::Number(word))
            })
        })
    };
    selection.iter().map(number).collect()
}
