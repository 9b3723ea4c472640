//! The XYZ format: the number of atoms, a comment, then one atom per line: its element, x, y and z.
//!
//! The comment may name the columns, as in the extended XYZ format of libAtoms:
//! `Properties=species:S:1:pos:R:3:energy:R:1`; a `radius` and a `color` replace those of the element. Of
//! several frames, the first is read.

use std::{borrow::Cow, collections::HashSet, io::Read};

use super::{Atoms, COLUMNS, Column, Own, lines};
use crate::{
    data::{
        bytes::{LONGEST_LINE, read_bytes},
        fault::{At, Fault, LinePart, ReadError, Wrong},
        table::{Table, request::Request, row_cells::RowCells},
    },
    text::nearest::quote,
};

pub(in super::super) fn read(
    reader: impl Read,
    length: usize,
    request: &Request,
) -> Result<Table, ReadError> {
    request.refuse_columns("the columns of an XYZ file have names")?;
    let text = read_bytes(reader, length)?;
    let mut lines = lines(&text);
    let (_, first) = lines.next().unwrap_or_default();
    let first = String::from_utf8_lossy(first);
    let first = first.trim();
    let count: usize = first.parse().map_err(|_| {
        let message = format!("{} is not the number of atoms", quote(first));
        At::line(1)
            .fault(message)
            .help("the first lines are the number of atoms and a comment")
    })?;
    let layout = Layout::of(&mut lines, text.len().min(LONGEST_LINE))?;
    let own = Own {
        radius: layout.radius.is_some(),
        color: layout.color.is_some(),
    };
    let more = layout.more.iter().map(|(name, _)| name.as_str());
    let mut atoms = Atoms::new(request, own, more);
    if layout.species == Species::None && atoms.needs_elements {
        return Err(wrong("there is no `species:S:1`, `Z:I:1` or `type:I:1`").into());
    }
    let is_lettered = atoms.needs_elements && is_lettered(&lines, count, layout.species);
    for row in 0..count {
        let Some((line, bytes)) = lines.next() else {
            atoms.rows.note(Wrong::End, "", || {
                Fault::new(format!("the file is cut off: {row} of {count} atoms"))
            });
            break;
        };
        let words: Vec<_> = words(bytes).collect();
        let word = |at: usize| words.get(at).map_or("", |word| word);
        if words.len() < layout.width {
            let (found, expected) = (words.len(), layout.width);
            atoms.rows.note(Wrong::Length, "", || {
                let at = At::row(row, Some(line));
                at.fault(format!("{found} columns, expected {expected}"))
            });
        }
        let of = words.len();
        let row_at = |row: usize| At::row(row, Some(line));
        let cell = |at| move |row| row_at(row).part(LinePart::Cell { at, of });
        let kind = match layout.species {
            Species::Element(at) | Species::Type(at) if is_lettered => {
                atoms.lettered(word(at), &cell(at))
            }
            Species::Element(at) => atoms.kind(letters(word(at)), &cell(at)),
            Species::Type(at) => atoms.type_of(letters(word(at)), &cell(at)),
            Species::None => atoms.kind("", &row_at),
        };
        let center = [0, 1, 2].map(|axis| {
            let at = layout.position + axis;
            let text = word(at);
            text.parse().unwrap_or_else(|_| {
                let name = ["x", "y", "z"][axis];
                let place = |row| cell(at)(row).in_column(name);
                Atoms::bad_number(&mut atoms.rows, name, place, text, || None)
            })
        });
        let more = |rows: &mut _, column| {
            let (name, at) = match column {
                Column::Radius => (RADIUS, layout.radius?),
                Column::Color(channel) => (COLOR, layout.color? + channel),
                Column::More(index) => {
                    let (name, at) = layout.more.get(index)?;
                    (name.as_str(), *at)
                }
            };
            let text = word(at);
            Some(text.parse().unwrap_or_else(|_| {
                let place = |row| cell(at)(row).in_column(name);
                Atoms::bad_number(rows, name, place, text, || None)
            }))
        };
        atoms.push(center, kind, line, more)?;
    }
    // Further frames begin with their number of atoms, alone in its line.
    let next = lines.find(|(_, line)| !line.trim_ascii().is_empty());
    if let Some((line, bytes)) = next
        && String::from_utf8_lossy(bytes)
            .trim()
            .parse::<usize>()
            .is_err()
    {
        atoms.rows.note(Wrong::End, "", || {
            At::line(line).fault(format!("text after the last of {count} atoms"))
        });
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
    let mut lines = lines(&text).skip(1);
    let layout = Layout::of(&mut lines, text.len().min(LONGEST_LINE))?;
    let (_, line) = lines.nth(row).unwrap_or_default();
    let count = layout.properties.iter().map(|(_, count)| count).sum();
    Ok(RowCells::new(count, layout.names().zip(words(line))))
}

#[cold]
fn point() -> Fault {
    let fault = At::line(3).fault("three numbers, expected an element and three numbers");
    fault.help("a cloud of points has no number of atoms: remove the first line")
}

/// The properties that replace the radii and colors of the elements.
const RADIUS: &str = "radius";
const COLOR: &str = "color";

/// The property with the coordinates.
const POSITION: &str = "pos";

/// The place of the kind of an atom among the words of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Species {
    /// A symbol or an atomic number.
    Element(usize),
    /// A name, or a number that is not an atomic number.
    Type(usize),
    None,
}

/// The places of the columns among the words of a line.
struct Layout {
    species: Species,
    position: usize,
    radius: Option<usize>,
    /// The place of the first channel.
    color: Option<usize>,
    /// The names of all properties, with the numbers of their words.
    properties: Vec<(String, usize)>,
    /// The names and places of further numbers.
    more: Vec<(String, usize)>,
    /// The least number of words.
    width: usize,
}

fn wrong(what: &str) -> Fault {
    let fault = At::line(2).fault(format!("{what} in `Properties`"));
    fault.help("they are names, types and counts, such as `species:S:1:pos:R:3:energy:R:1`")
}

impl Layout {
    /// Reads the comment of a file with lines of up to `longest` bytes, which is the next line. The first atom
    /// follows.
    fn of<'a>(
        lines: &mut (impl Iterator<Item = (u64, &'a [u8])> + Clone),
        longest: usize,
    ) -> Result<Self, Fault> {
        let (_, comment) = lines.next().unwrap_or_default();
        let comment = String::from_utf8_lossy(comment);
        if let Some(properties) = properties(&comment) {
            return Self::named(&properties, longest);
        }
        let (_, first) = lines.clone().next().unwrap_or_default();
        let first: Vec<_> = words(first).collect();
        if first.len() == 3 && first.iter().all(|word| word.parse::<f64>().is_ok()) {
            return Err(point());
        }
        Ok(Self::usual(first.len(), &comment))
    }

    /// The layout without names, for lines of this many words.
    fn usual(words: usize, comment: &str) -> Self {
        let species = match comment.trim_start().starts_with(LAMMPS) {
            true => Species::Type(0),
            false => Species::Element(0),
        };
        let more = (4..words).map(|at| (format!("column{}", at + 1), at));
        let more: Vec<_> = more.collect();
        let properties = [("species".to_owned(), 1), (POSITION.to_owned(), 3)];
        let others = more.iter().map(|(name, _)| (name.clone(), 1));
        Self {
            species,
            position: 1,
            radius: None,
            color: None,
            properties: properties.into_iter().chain(others).collect(),
            more,
            width: 0,
        }
    }

    /// Returns the name of each word of a line.
    fn names(&self) -> impl Iterator<Item = String> {
        self.properties.iter().flat_map(|(name, count)| {
            let is_position = name.eq_ignore_ascii_case(POSITION);
            (0..*count).map(move |index| match ["x", "y", "z"].get(index) {
                Some(axis) if is_position => (*axis).to_owned(),
                _ if *count == 1 => name.clone(),
                _ => numbered(name, index),
            })
        })
    }

    /// The layout of an extended XYZ file, of which no line has more than `longest` words.
    fn named(properties: &str, longest: usize) -> Result<Self, Fault> {
        let parts: Vec<_> = properties.split(':').collect();
        let (mut species, mut numbers, mut types) = (None, None, None);
        let (mut position, mut radius, mut color) = (None, None, None);
        let (mut more, mut at) = (Vec::<(String, usize)>::new(), 0_usize);
        let mut all = Vec::new();
        for part in parts.chunks(3) {
            let &[name, kind, count] = part else {
                return Err(wrong("a name has no type or count"));
            };
            let count: u16 = count
                .parse()
                .map_err(|_| wrong("a count is not a number"))?;
            let count = usize::from(count);
            if at + count > longest {
                return Err(wrong("too many columns"));
            }
            let lower = name.to_ascii_lowercase();
            let mut is_number = matches!(kind, "R" | "I");
            match (&*lower, kind, count) {
                ("species", "S", 1) => species = Some(Species::Element(at)),
                ("z", "I", 1) => numbers = Some(Species::Element(at)),
                ("type", _, 1) => types = Some(Species::Type(at)),
                (POSITION, "R", 3) => (position, is_number) = (Some(at), false),
                (RADIUS, "R" | "I", 1) if radius.is_none() => {
                    (radius, is_number) = (Some(at), false);
                }
                (COLOR, "R", 3) if color.is_none() => color = Some(at),
                _ => {}
            }
            // An atomic number is in a column of every file.
            match (count, is_number) {
                (1, true) if lower != "z" => more.push((name.to_owned(), at)),
                (2.., true) => {
                    more.extend((0..count).map(|index| (numbered(name, index), at + index)));
                }
                _ => {}
            }
            all.push((name.to_owned(), count));
            at += count;
        }
        let known = |name: &str| COLUMNS.contains(&name);
        let mut seen = HashSet::new();
        for (name, _) in &more {
            if known(name) || !seen.insert(name) {
                let name = quote(name);
                let at = At::line(2);
                return Err(at.fault(format!("{name} is given twice in `Properties`")));
            }
        }
        Ok(Self {
            species: species.or(numbers).or(types).unwrap_or(Species::None),
            position: position.ok_or_else(|| wrong("there is no `pos:R:3`"))?,
            radius,
            color,
            properties: all,
            more,
            width: at,
        })
    }
}

/// Returns the name of a word of a property with several, by its index.
fn numbered(name: &str, index: usize) -> String {
    format!("{name}.{}", index + 1)
}

/// Returns true if the kinds of the first atoms are the first letters of the alphabet: `A`, `B` and so on, as
/// simulations name their types. They are not elements then, although `B`, `C`, `F` and others are symbols.
fn is_lettered<'a>(
    lines: &(impl Iterator<Item = (u64, &'a [u8])> + Clone),
    count: usize,
    species: Species,
) -> bool {
    let (Species::Element(at) | Species::Type(at)) = species else {
        return false;
    };
    let mut found = 0_u32;
    for (_, line) in lines.clone().take(count) {
        match words(line).nth(at).as_deref().map(str::as_bytes) {
            Some([letter @ b'A'..=b'Z']) => found |= 1 << (letter - b'A'),
            _ => return false,
        }
    }
    // One bit for each letter, without a gap.
    found & 1 == 1 && found & (found + 1) == 0
}

/// The start of the comment in files of LAMMPS, which have numbers of types.
const LAMMPS: &str = "Atoms. Timestep";

/// Returns the value of `Properties` in the comment of an extended XYZ file.
fn properties(comment: &str) -> Option<String> {
    const KEY: &str = "properties=";
    let at = comment.to_ascii_lowercase().find(KEY)?;
    let rest = comment.get(at + KEY.len()..)?;
    let value = match rest.chars().next() {
        Some(quote @ ('"' | '\'')) => rest.split(quote).nth(1),
        _ => rest.split_ascii_whitespace().next(),
    };
    value.map(str::to_owned)
}

/// Returns the words of a line.
fn words(line: &[u8]) -> impl Iterator<Item = Cow<'_, str>> {
    let words = line.split(u8::is_ascii_whitespace);
    let words = words.filter(|word| !word.is_empty());
    words.map(String::from_utf8_lossy)
}

/// Returns the symbol in a label such as `C12`; a number remains as it is.
fn letters(label: &str) -> &str {
    let end = label.find(|letter: char| !letter.is_ascii_alphabetic());
    match end.and_then(|end| label.get(..end)) {
        Some(letters) if !letters.is_empty() => letters,
        _ => label,
    }
}
