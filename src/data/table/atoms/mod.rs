//! Atoms: spheres whose elements determine radii and colors.

mod elements;
mod names;
mod pdb;
mod xyz;

pub(super) use self::{
    pdb::{read as read_pdb, row_cells as pdb_row_cells},
    xyz::{read as read_xyz, row_cells as xyz_row_cells},
};

use std::io;

use crate::{
    data::{
        bytes::BYTE_ORDER_MARK,
        fault::{At, Fault, Wrong},
        table::{
            Table,
            atoms::elements::{Element, NEUTRAL},
            layout::{COLORS, RADIUS, VALUE},
            request::{Defaults, Request},
            rows::Rows,
            select::Names,
        },
    },
    text::nearest::quote,
};

/// The columns of every file of atoms; `number` is the atomic number, or the number of the type.
const COLUMNS: [&str; 5] = ["x", "y", "z", "radius", "number"];

/// A number of a row that the element does not determine.
#[derive(Clone, Copy)]
enum Column {
    Radius,
    /// A channel of the color, from 0.
    Color(usize),
    /// One of the further columns of the file, from 0.
    More(usize),
}

/// The kind of an atom.
#[derive(Clone, Copy)]
struct AtomKind {
    /// The atomic number, or the number of the type; NaN if there is none.
    number: f64,
    element: &'static Element,
}

/// The numbers that a file gives for each atom instead of its element.
#[derive(Clone, Copy, Default)]
struct Own {
    radius: bool,
    color: bool,
}

/// The rows of atoms. The scene's radius and color replace those of the elements.
struct Atoms<'a> {
    request: &'a Request<'a>,
    /// The names of all columns.
    names: Vec<String>,
    /// The index of the value that determines the color.
    value: Option<usize>,
    /// True if the elements determine a radius or a color.
    needs_elements: bool,
    rows: Rows,
}

impl<'a> Atoms<'a> {
    /// Starts the rows of a file that has some more columns.
    fn new<'n>(
        request: &'a Request<'a>,
        own: Own,
        more: impl IntoIterator<Item = &'n str>,
    ) -> Self {
        let names = COLUMNS.into_iter().chain(more).map(str::to_owned);
        let names: Vec<_> = names.collect();
        let value = request
            .value
            .and_then(|value| names.iter().position(|name| name == value));
        let Defaults { radius, color, .. } = request.defaults;
        Self {
            request,
            names,
            value,
            needs_elements: !(own.radius || radius.is_some()) || !(own.color || color.is_some()),
            rows: Rows::default(),
        }
    }

    const fn has_radius(&self) -> bool {
        self.request.defaults.radius.is_none()
    }

    const fn has_color(&self) -> bool {
        self.request.defaults.color.is_none()
    }

    /// Adds an atom in a line. `more` returns the number in one of the columns of the file, from 0, or
    /// the radius or a channel of the color if the file has them.
    fn push(
        &mut self,
        center: [f64; 3],
        AtomKind { number, element }: AtomKind,
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
            let channels = element.color().into_iter().enumerate();
            numbers.extend(
                channels.map(|(at, channel)| {
                    more(&mut self.rows, Column::Color(at)).unwrap_or(channel)
                }),
            );
        }
        if let Some(value) = self.value {
            numbers.push(match (center.get(value), value) {
                (Some(coordinate), _) => *coordinate,
                (None, 3) => radius,
                (None, 4) => number,
                (None, other) => {
                    let column = Column::More(other - COLUMNS.len());
                    more(&mut self.rows, column).unwrap_or(f64::NAN)
                }
            });
        }
        self.rows.push(&numbers, Some(line))
    }

    /// Notes a number of the next row in whose middle the line ends.
    fn cut_number(rows: &mut Rows, column: &str, at: impl FnOnce(usize) -> At, text: &str) -> f64 {
        let row = rows.rows;
        rows.note(Wrong::End, column, || {
            at(row).fault(format!("the line is cut off after {}", quote(text)))
        })
    }

    /// Notes an unreadable number of the next row.
    fn bad_number(
        rows: &mut Rows,
        column: &str,
        at: impl FnOnce(usize) -> At,
        text: &str,
        help: impl FnOnce() -> Option<String>,
    ) -> f64 {
        let row = rows.rows;
        rows.note(Wrong::Number, column, || {
            let text = match text {
                "" => "a number is missing".to_owned(),
                text => format!("{} is not a number", quote(text)),
            };
            Fault {
                help: help(),
                ..at(row).fault(text)
            }
        })
    }

    /// Returns the kind of the next row, an element or anything else, for which a neutral atom stands.
    fn kind(&mut self, text: &str, at: &impl Fn(usize) -> At) -> AtomKind {
        if let Some((number, element)) = Element::of(text) {
            return AtomKind {
                number: f64::from(number),
                element,
            };
        }
        // The place of the kind has another number in it.
        let is_number =
            text.starts_with(|first: char| matches!(first, '0'..='9' | '+' | '-' | '.'));
        if is_number && text.parse::<u32>().is_err() || text.is_empty() && self.needs_elements {
            let row = self.rows.rows;
            self.rows.note(Wrong::Element, "", || {
                let fault = at(row).fault(format!("{} is not an element", quote(text)));
                fault.help("write its symbol, such as `C`, or its atomic number")
            });
        }
        self.neutral(text, at)
    }

    /// Returns the kind of the next row, whose type is a number that is not an atomic number, or a name.
    fn type_of(&mut self, text: &str, at: &impl Fn(usize) -> At) -> AtomKind {
        if text.parse::<u32>().is_ok() {
            self.neutral(text, at)
        } else {
            self.kind(text, at)
        }
    }

    /// Returns the kind of the next row, which is a type with a letter as its name.
    fn lettered(&mut self, text: &str, at: &impl Fn(usize) -> At) -> AtomKind {
        let why = match text {
            "A" => "is not an element",
            _ => "is a type as `A` is, and not an element",
        };
        self.gray(text, why, at)
    }

    fn neutral(&mut self, text: &str, at: &impl Fn(usize) -> At) -> AtomKind {
        self.gray(text, "is not an element", at)
    }

    /// Returns the kind of an atom that is not an element, for this reason.
    fn gray(&mut self, text: &str, why: &str, at: &impl Fn(usize) -> At) -> AtomKind {
        if self.needs_elements && !text.is_empty() {
            let row = self.rows.rows;
            self.rows.note(Wrong::Kind, "", || {
                let text = quote(text);
                let fault =
                    at(row).fault(format!("the kind {text} {why}, a gray ball stands for it"));
                fault.help("write elements, or give a `radius` and `color` or `color_by`")
            });
        }
        AtomKind {
            number: text.parse::<u32>().map_or(f64::NAN, f64::from),
            element: &NEUTRAL,
        }
    }

    fn into_table(self) -> Table {
        let (radius, color) = (self.has_radius(), self.has_color());
        let mut has = [false; _];
        has[..3].fill(true);
        has[RADIUS] = radius;
        has[COLORS].fill(color);
        has[VALUE] = self.value.is_some();
        // Atoms have many columns that no scene needs.
        let names = Names {
            all: self.names.into(),
            unused: [].into(),
        };
        self.rows.into_table(has, names, &self.request.defaults)
    }
}

/// Returns the lines of a text with their numbers, without their ends and without a byte order mark.
/// In the files of old Macs, they end with CR.
fn lines(text: &[u8]) -> impl Iterator<Item = (u64, &[u8])> + Clone {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let end = if text.contains(&b'\n') { b'\n' } else { b'\r' };
    let text = text.strip_suffix(&[end]).unwrap_or(text);
    let lines = text.split(move |byte| *byte == end);
    (1..).zip(lines.map(|line| line.strip_suffix(b"\r").unwrap_or(line)))
}
