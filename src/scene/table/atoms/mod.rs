//! Atoms: spheres whose elements determine radii and colors.

mod elements;
mod pdb;
mod xyz;

pub(super) use self::{pdb::read as read_pdb, xyz::read as read_xyz};

use std::io::{self, Read};

use crate::{
    scene::table::{
        Fault, Names, ReadError, Request, Table,
        atoms::elements::Element,
        bytes::{BYTE_ORDER_MARK, read_bytes},
        fault::Wrong,
        rows::Rows,
    },
    text::nearest::quote,
};

/// The columns of every file of atoms; `number` is the atomic number.
const COLUMNS: [&str; 5] = ["x", "y", "z", "radius", "number"];

/// A number of a row that the element does not determine.
#[derive(Clone, Copy)]
enum Column {
    Radius,
    /// One of the further columns of the file, from 0.
    More(usize),
}

/// The rows of atoms. The scene's radius and color replace those of the elements.
struct Atoms<'a> {
    request: &'a Request<'a>,
    /// The names of all columns.
    names: Vec<String>,
    /// The index of the value that determines the color.
    value: Option<usize>,
    rows: Rows,
}

impl<'a> Atoms<'a> {
    /// Starts the rows of a file that has some more columns.
    fn new<'n>(request: &'a Request<'a>, more: impl IntoIterator<Item = &'n str>) -> Self {
        let names = COLUMNS.into_iter().chain(more).map(str::to_owned);
        let names: Vec<_> = names.collect();
        let value = request
            .value
            .and_then(|value| names.iter().position(|name| name == value));
        Self {
            request,
            names,
            value,
            rows: Rows::new(),
        }
    }

    const fn has_radius(&self) -> bool {
        self.request.defaults.radius.is_none()
    }

    const fn has_color(&self) -> bool {
        self.request.defaults.color.is_none()
    }

    /// Adds an atom in a line. `more` returns the number in one of the columns of the file, from 0, or
    /// the radius if the file has one.
    fn push(
        &mut self,
        center: [f64; 3],
        (number, element): (u8, &Element),
        line: u64,
        mut more: impl FnMut(&mut Rows, Column) -> Option<f64>,
    ) -> io::Result<()> {
        let radius = match self.request.defaults.radius {
            Some(radius) => radius,
            None => more(&mut self.rows, Column::Radius).unwrap_or(element.radius()),
        };
        let mut numbers = center.to_vec();
        if self.has_radius() {
            numbers.push(radius);
        }
        if self.has_color() {
            numbers.extend(element.color());
        }
        if let Some(value) = self.value {
            numbers.push(match (center.get(value), value) {
                (Some(coordinate), _) => *coordinate,
                (None, 3) => radius,
                (None, 4) => f64::from(number),
                (None, other) => {
                    let column = Column::More(other - COLUMNS.len());
                    more(&mut self.rows, column).unwrap_or(f64::NAN)
                }
            });
        }
        self.rows.push(&numbers, Some(line))
    }

    /// Notes a number of the next row in whose middle the line ends.
    fn cut_number(rows: &mut Rows, column: &str, place: &str, text: &str) -> f64 {
        let row = rows.rows;
        rows.note(Wrong::End, column, || {
            Fault::new(format!(
                "row {row}{place}: the line is cut off after {}",
                quote(text)
            ))
        })
    }

    /// Notes an unreadable number of the next row, at a place such as ` (line 3), column `x``.
    fn bad_number(rows: &mut Rows, column: &str, place: &str, text: &str) -> f64 {
        let row = rows.rows;
        rows.note(Wrong::Number, column, || {
            let text = match text {
                "" => "a number is missing".to_owned(),
                text => format!("{} is not a number", quote(text)),
            };
            Fault::new(format!("row {row}{place}: {text}"))
        })
    }

    /// Returns the element of the next row, or notes that there is none.
    fn element(&mut self, text: &str, place: &str) -> (u8, &'static Element) {
        let found = Element::of(text);
        found.unwrap_or_else(|| {
            let row = self.rows.rows;
            self.rows.note(Wrong::Element, "", || {
                let fault = Fault::new(format!(
                    "row {row}{place}: {} is not an element",
                    quote(text)
                ));
                fault.help("write its symbol, such as `C`, or its atomic number")
            });
            (1, Element::hydrogen())
        })
    }

    fn into_table(self) -> Table {
        let (radius, color) = (self.has_radius(), self.has_color());
        let has = [
            true,
            true,
            true,
            false,
            false,
            false,
            radius,
            color,
            color,
            color,
            self.value.is_some(),
        ];
        // Atoms have many columns that no scene needs.
        let names = Names {
            all: self.names.into(),
            unused: [].into(),
        };
        self.rows.into_table(has, names, &self.request.defaults)
    }
}

/// Reads a file of lines.
fn text(reader: impl Read, length: u64) -> Result<Vec<u8>, ReadError> {
    let length = usize::try_from(length).map_err(|_| Fault::new("the file is too large"))?;
    read_bytes(reader, length)
}

/// Returns the lines of a text with their numbers, without their ends and without a byte order mark.
fn lines(text: &[u8]) -> impl Iterator<Item = (u64, &[u8])> {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let text = text.strip_suffix(b"\n").unwrap_or(text);
    let lines = text.split(|byte| *byte == b'\n');
    (1..).zip(lines.map(|line| line.strip_suffix(b"\r").unwrap_or(line)))
}
