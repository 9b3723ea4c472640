//! The PDB format of the Protein Data Bank: the records `ATOM` and `HETATM`, in fixed columns.
//!
//! The columns are those of the Protein Data Bank Contents Guide, version 3.3, 2011. Of several
//! models, the first is read. All alternate locations are atoms.

use std::{io::Read, ops::Range};

use super::{Atoms, Column, elements::Element, lines, text};
use crate::scene::table::{Fault, ReadError, Request, Table, rows::Rows};

/// The places of x, y and z in a line, from 0.
const CENTER: [(&str, Range<usize>); 3] = [("x", 30..38), ("y", 38..46), ("z", 46..54)];
/// The places of further numbers.
const MORE: [(&str, Range<usize>); 4] = [
    ("serial", 6..11),
    ("residue", 22..26),
    ("occupancy", 54..60),
    ("b_factor", 60..66),
];
/// The place of the atom's name.
const NAME: Range<usize> = 12..16;
/// The place of the element's symbol.
const ELEMENT: Range<usize> = 76..78;

pub(in super::super) fn read(
    reader: impl Read,
    length: u64,
    request: &Request,
) -> Result<Table, ReadError> {
    request.refuse_columns("the columns of a PDB file have names")?;
    let text = text(reader, length)?;
    let mut atoms = Atoms::new(request, MORE.iter().map(|(name, _)| *name));
    for (line, bytes) in lines(&text) {
        match bytes.get(..6).unwrap_or(bytes) {
            b"ATOM  " | b"HETATM" => {}
            b"ENDMDL" => break,
            _ => continue,
        }
        let symbol = symbol(bytes);
        let place = if at(bytes, &ELEMENT).is_empty() {
            NAME
        } else {
            ELEMENT
        };
        let element = atoms.element(&symbol, &place_of(line, &place));
        let number = |rows: &mut Rows, (name, range): &(&str, Range<usize>), optional| {
            let text = at(bytes, range);
            if text.is_empty() && optional {
                return f64::NAN;
            }
            if bytes.len() < range.end && !optional && !text.is_empty() {
                return Atoms::cut_number(rows, name, &place_of(line, range), &text);
            }
            let number = text.parse();
            number.unwrap_or_else(|_| Atoms::bad_number(rows, name, &place_of(line, range), &text))
        };
        let center = CENTER
            .each_ref()
            .map(|column| number(&mut atoms.rows, column, false));
        let more = |rows: &mut Rows, column| match column {
            Column::Radius => None,
            Column::More(index) => Some(number(rows, MORE.get(index)?, true)),
        };
        atoms.push(center, element, line, more)?;
    }
    if atoms.rows.rows == 0 {
        let message = "there is no `ATOM` or `HETATM` record";
        return Err(Fault::new(message).into());
    }
    Ok(atoms.into_table())
}

/// Returns the trimmed text in some columns of a line.
fn at(line: &[u8], range: &Range<usize>) -> String {
    let end = range.end.min(line.len());
    let text = line.get(range.start..end).unwrap_or_default();
    String::from_utf8_lossy(text.trim_ascii()).into_owned()
}

/// Returns the symbol of an atom's element. Files without one have it in the name of the atom: in
/// its first two columns, right-aligned, so that `CA` is calcium and ` CA ` a carbon. Names of four
/// letters may begin one column early.
fn symbol(line: &[u8]) -> String {
    let symbol = at(line, &ELEMENT);
    if !symbol.is_empty() {
        return symbol;
    }
    let name = at(line, &NAME);
    let letters =
        |text: String| -> String { text.chars().filter(char::is_ascii_alphabetic).collect() };
    let two = letters(at(line, &(NAME.start..NAME.start + 2)));
    let is_full = name.len() == NAME.len();
    if Element::of(&two).is_some() && !(is_full && two.starts_with(['H', 'D'])) {
        return two;
    }
    letters(name.clone()).get(..1).map_or(name, str::to_owned)
}

/// Returns the place of a fault; columns count from 1, as in the description of the format.
fn place_of(line: u64, range: &Range<usize>) -> String {
    format!(" (line {line}, columns {}-{})", range.start + 1, range.end)
}
