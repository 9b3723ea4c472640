//! The XYZ format: the number of atoms, a comment, then one atom per line: its element, x, y and z.
//!
//! The comment may name the columns, as in the extended XYZ format of libAtoms:
//! `Properties=species:S:1:pos:R:3:energy:R:1`; a `radius` replaces that of the element. Of several
//! frames, the first is read.

use std::{borrow::Cow, io::Read};

use super::{Atoms, COLUMNS, Column, lines, text};
use crate::{
    scene::table::{Fault, ReadError, Request, Table, fault::Wrong},
    text::nearest::quote,
};

pub(in super::super) fn read(
    reader: impl Read,
    length: u64,
    request: &Request,
) -> Result<Table, ReadError> {
    request.refuse_columns("the columns of an XYZ file have names")?;
    let text = text(reader, length)?;
    let mut lines = lines(&text);
    let (_, first) = lines.next().unwrap_or_default();
    let first = String::from_utf8_lossy(first);
    let first = first.trim();
    let count: usize = first.parse().map_err(|_| {
        let message = format!("line 1: {} is not the number of atoms", quote(first));
        Fault::new(message)
    })?;
    let (_, comment) = lines.next().unwrap_or_default();
    let mut lines = lines.peekable();
    let in_row = lines.peek().map_or(0, |(_, line)| words(line).count());
    let layout = match properties(&String::from_utf8_lossy(comment)) {
        Some(properties) => Layout::named(&properties)?,
        None => Layout::usual(in_row),
    };
    let mut atoms = Atoms::new(request, layout.more.iter().map(|(name, _)| name.as_str()));
    for row in 0..count {
        let Some((line, bytes)) = lines.next() else {
            atoms.rows.note(Wrong::End, "", || {
                Fault::new(format!("the file is cut off: {row} of {count} atoms"))
            });
            break;
        };
        let words: Vec<_> = words(bytes).collect();
        let word = |at: usize| words.get(at).map_or("", |word| word);
        let place = format!(" (line {line})");
        let element = atoms.element(letters(word(layout.species)), &place);
        let center = [0, 1, 2].map(|axis| {
            let text = word(layout.position + axis);
            text.parse().unwrap_or_else(|_| {
                let name = ["x", "y", "z"][axis];
                let place = format!("{place}, column `{name}`");
                Atoms::bad_number(&mut atoms.rows, name, &place, text)
            })
        });
        let more = |rows: &mut _, column| {
            let (name, at) = match column {
                Column::Radius => (RADIUS, layout.radius?),
                Column::More(index) => {
                    let (name, at) = layout.more.get(index)?;
                    (name.as_str(), *at)
                }
            };
            let text = word(at);
            Some(text.parse().unwrap_or_else(|_| {
                let place = format!("{place}, column {}", quote(name));
                Atoms::bad_number(rows, name, &place, text)
            }))
        };
        atoms.push(center, element, line, more)?;
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
            Fault::new(format!("line {line}: text after the last of {count} atoms"))
        });
    }
    Ok(atoms.into_table())
}

/// The property that replaces the radii of the elements.
const RADIUS: &str = "radius";

/// The places of the columns among the words of a line.
struct Layout {
    species: usize,
    position: usize,
    radius: Option<usize>,
    /// The names and places of further numbers.
    more: Vec<(String, usize)>,
}

impl Layout {
    /// The layout without names, for lines of this many words.
    fn usual(words: usize) -> Self {
        Self {
            species: 0,
            position: 1,
            radius: None,
            more: (4..words)
                .map(|at| (format!("column{}", at + 1), at))
                .collect(),
        }
    }

    /// The layout of an extended XYZ file.
    fn named(properties: &str) -> Result<Self, Fault> {
        let wrong = |what: &str| {
            let fault = Fault::new(format!("line 2: {what} in `Properties`"));
            fault.help("they are names, types and counts, such as `species:S:1:pos:R:3:energy:R:1`")
        };
        let parts: Vec<_> = properties.split(':').collect();
        let (mut species, mut position, mut radius) = (None, None, None);
        let (mut more, mut at) = (Vec::<(String, usize)>::new(), 0_usize);
        for part in parts.chunks(3) {
            let &[name, kind, count] = part else {
                return Err(wrong("a name has no type or count"));
            };
            // A line has at most as many words as the file has bytes.
            let count: u16 = count
                .parse()
                .map_err(|_| wrong("a count is not a number"))?;
            let count = usize::from(count);
            match (name, kind, count) {
                ("species", "S", 1) => species = Some(at),
                ("pos", "R", 3) => position = Some(at),
                (RADIUS, "R" | "I", 1) if radius.is_none() => radius = Some(at),
                (name, "R" | "I", 1) => more.push((name.to_owned(), at)),
                (name, "R" | "I", count) => {
                    more.extend(
                        (0..count).map(|index| (format!("{name}.{}", index + 1), at + index)),
                    );
                }
                _ => {}
            }
            at += count;
        }
        let known = |name: &str| COLUMNS.contains(&name);
        for (index, (name, _)) in more.iter().enumerate() {
            if known(name) || more[..index].iter().any(|(other, _)| other == name) {
                let name = quote(name);
                return Err(Fault::new(format!(
                    "line 2: {name} is given twice in `Properties`"
                )));
            }
        }
        Ok(Self {
            species: species.ok_or_else(|| wrong("there is no `species:S:1`"))?,
            position: position.ok_or_else(|| wrong("there is no `pos:R:3`"))?,
            radius,
            more,
        })
    }
}

/// Returns the value of `Properties` in the comment of an extended XYZ file.
fn properties(comment: &str) -> Option<String> {
    const KEY: &str = "properties=";
    let at = comment.to_ascii_lowercase().find(KEY)?;
    let rest = comment.get(at + KEY.len()..)?;
    let value = match rest.strip_prefix('"') {
        Some(quoted) => quoted.split('"').next(),
        None => rest.split_ascii_whitespace().next(),
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
