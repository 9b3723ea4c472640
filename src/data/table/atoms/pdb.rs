//! The PDB format of the Protein Data Bank: the records `ATOM` and `HETATM`, in fixed columns.
//!
//! The columns are those of the Protein Data Bank Contents Guide, version 3.3, 2011. Of several
//! models, which end with `ENDMDL` or `END`, the first is read. All alternate locations are atoms.

use std::{io::Read, ops::Range};

use super::{Atoms, Column, Own, lines, names};
use crate::{
    data::{
        bytes::read_bytes,
        fault::{At, Fault, LinePart, ReadError, Wrong},
        table::{Table, request::Request, row_cells::RowCells, rows::Rows},
    },
    text::nearest::quote,
};

/// The places of x, y and z in a line, from 0.
const CENTER: [(&str, Range<usize>); 3] = [("x", 30..38), ("y", 38..46), ("z", 46..54)];
/// The places of further numbers. A serial of more than five digits begins early or ends late.
const MORE: [(&str, Range<usize>); 4] = [
    ("serial", 4..12),
    ("residue", 22..26),
    ("occupancy", 54..60),
    ("b_factor", 60..66),
];
/// The place of the atom's name.
const NAME: Range<usize> = 12..16;
/// The place of the residue's name; the guide has three columns for it, simulation programs four.
const RESIDUE: Range<usize> = 17..21;
/// The place of the element's symbol.
const ELEMENT: Range<usize> = 76..78;

/// Records, or their starts, with numbers where those of atoms are.
const OTHERS: [&str; 9] = [
    "REMARK", "SIGATM", "SIGUIJ", "ANISOU", "ORIGX", "SCALE", "MTRIX", "TVECT", "USER",
];

/// What a line is.
#[derive(Debug, PartialEq)]
enum Record<'a> {
    Atom,
    /// The start or the end of a model.
    End,
    /// A line that was meant to be an atom, with the place of its record.
    Nearly(&'a [u8]),
    Other,
}

pub(in super::super) fn read(
    reader: impl Read,
    length: usize,
    request: &Request,
) -> Result<Table, ReadError> {
    request.refuse_columns("the columns of a PDB file have names")?;
    let text = read_bytes(reader, length)?;
    let more = MORE.iter().map(|(name, _)| *name);
    let mut atoms = Atoms::new(request, Own::default(), more);
    let mut found = false;
    for (line, bytes) in lines(&text) {
        match Record::of(bytes) {
            Record::Atom => found = true,
            Record::End if found => break,
            Record::End | Record::Other => continue,
            Record::Nearly(name) => {
                found = true;
                atoms.rows.note(Wrong::Record, "", || nearly(line, name));
                continue;
            }
        }
        let (symbol, place) = symbol(bytes);
        let kind = atoms.kind(&symbol, &|row| at_columns(row, line, &place));
        let number = |rows: &mut Rows, (name, range): &(&str, Range<usize>), optional| {
            let text = number_at(bytes, range);
            if text.is_empty() && optional {
                return f64::NAN;
            }
            let at = |row| at_columns(row, line, range);
            if bytes.len() < range.end && !optional && !text.is_empty() {
                return Atoms::cut_number(rows, name, at, &text);
            }
            let number = text.parse();
            number.unwrap_or_else(|_| {
                let help = || (!optional).then(|| shifted(bytes)).flatten();
                Atoms::bad_number(rows, name, at, &text, help)
            })
        };
        let center = CENTER
            .each_ref()
            .map(|column| number(&mut atoms.rows, column, false));
        let more = |rows: &mut Rows, column| match column {
            Column::Radius | Column::Color(_) => None,
            Column::More(index) => Some(number(rows, MORE.get(index)?, true)),
        };
        atoms.push(center, kind, line, more)?;
    }
    if !found {
        let message = "there is no `ATOM` or `HETATM` record";
        return Err(Fault::new(message).into());
    }
    Ok(atoms.into_table())
}

/// Reads the cells of an atom, with the names of their columns.
pub(in super::super) fn row_cells(
    reader: impl Read,
    length: usize,
    row: usize,
) -> Result<RowCells, ReadError> {
    let text = read_bytes(reader, length)?;
    let mut atoms = lines(&text).filter(|(_, line)| Record::of(line) == Record::Atom);
    let (_, line) = atoms.nth(row).unwrap_or_default();
    let texts = [
        ("name", NAME),
        ("residue name", RESIDUE),
        ("element", ELEMENT),
    ];
    let mut columns: Vec<_> = texts.into_iter().chain(CENTER).chain(MORE).collect();
    columns.sort_by_key(|(_, range)| range.start);
    let cells = columns
        .iter()
        .map(|(name, range)| (*name, number_at(line, range)));
    Ok(RowCells::new(columns.len(), cells))
}

impl<'a> Record<'a> {
    fn of(line: &'a [u8]) -> Self {
        let name = line.get(..6).unwrap_or(line);
        let is_atom = match name.strip_prefix(b"ATOM") {
            // A long serial begins in the last two of these columns.
            Some(rest) => rest.iter().all(|byte| matches!(byte, b' ' | b'0'..=b'9')),
            None => name == b"HETATM",
        };
        if is_atom {
            return Self::Atom;
        }
        let mut words = line.trim_ascii_start().split(u8::is_ascii_whitespace);
        let upper = words.next().unwrap_or_default().to_ascii_uppercase();
        if ["END", "ENDMDL", "MODEL"]
            .iter()
            .any(|end| upper == end.as_bytes())
        {
            return Self::End;
        }
        let resembles = upper.starts_with(b"ATOM") || upper.starts_with(b"HETAT");
        let is_other = OTHERS
            .iter()
            .any(|other| upper.starts_with(other.as_bytes()));
        if resembles || !is_other && has_center(line) {
            return Self::Nearly(name);
        }
        Self::Other
    }
}

/// Returns true if three numbers with a point are where those of an atom are.
fn has_center(line: &[u8]) -> bool {
    CENTER.iter().all(|(_, range)| {
        let text = line.get(range.clone()).unwrap_or_default();
        text.contains(&b'.') && number_at(line, range).parse::<f64>().is_ok()
    })
}

#[cold]
fn nearly(line: u64, name: &[u8]) -> Fault {
    let name = String::from_utf8_lossy(name.trim_ascii_end());
    let fault = At::line(line).fault(format!("{} is not a record", quote(&name)));
    fault.help("write `ATOM` or `HETATM`, in capitals from the first column")
}

/// Returns the help for a line whose coordinates stand in other columns than they must, if it is one.
fn shifted(line: &[u8]) -> Option<String> {
    let (start, mut ends) = (RESIDUE.end, Vec::new());
    let mut at = start;
    for word in line.get(start..)?.split(|byte| *byte == b' ') {
        at += word.len();
        let number = str::from_utf8(word).ok()?.parse::<f64>();
        if word.contains(&b'.') && number.is_ok() {
            ends.push(at);
        }
        at += 1;
    }
    let &[x, y, z, ..] = &*ends else { return None };
    let is_right = CENTER
        .iter()
        .zip([x, y, z])
        .all(|((_, range), end)| range.end == end);
    (!is_right).then(|| {
        let [right_x, right_y, right_z] = CENTER.each_ref().map(|(_, range)| range.end);
        format!(
            "the columns are shifted: x, y and z end in columns {right_x}, {right_y} and {right_z}, \
             here in {x}, {y} and {z}"
        )
    })
}

/// Returns the trimmed text in some columns of a line.
fn at(line: &[u8], range: &Range<usize>) -> String {
    let end = range.end.min(line.len());
    let text = line.get(range.start..end).unwrap_or_default();
    String::from_utf8_lossy(text.trim_ascii()).into_owned()
}

/// Returns the text of a number. The last letters of the record's name may be before a serial.
fn number_at(line: &[u8], range: &Range<usize>) -> String {
    let text = at(line, range);
    match line.strip_prefix(b"HETATM") {
        Some(_) if range.start < 6 => at(line, &(6..range.end)),
        _ => text,
    }
}

/// Returns the symbol of an atom's element, and its place. In files without one it follows from the
/// name of the atom.
fn symbol(line: &[u8]) -> (String, Range<usize>) {
    let symbol = at(line, &ELEMENT);
    // Before 1996, these columns had the number of the line.
    if !symbol.is_empty() && !symbol.contains(|letter: char| letter.is_ascii_digit()) {
        return (symbol, ELEMENT);
    }
    let name = line.get(NAME.start..NAME.end.min(line.len()));
    let name = String::from_utf8_lossy(name.unwrap_or_default());
    (names::symbol(&name, &at(line, &RESIDUE)), NAME)
}

/// Returns the place of a fault; columns count from 1, as in the description of the format.
fn at_columns(row: usize, line: u64, range: &Range<usize>) -> At {
    let (first, last) = (range.start + 1, range.end);
    let words = format!("row {row} (line {line}, columns {first}-{last})");
    At::new(words, line).part(LinePart::Bytes(range.clone()))
}
