//! A part of a scene that names a file, and the problems of that file.

use std::io::Read;

use crate::{
    data::{
        fault::{At, BadRows, Blamed, Fault, LinePart, most_listed},
        table::{Bad, BadKind, Format, Names, Table, kind::RowKind},
    },
    diagnostic::{Code, path::Path},
    scene::{
        files::{self, Folder, Refused},
        foreign::{Foreign, start_of},
        format::{color_by::ColorByModel, geometry::kind::TableModel},
        problem::{Focus, Problem},
    },
    text::nearest::{list, nearest, quote},
    tracer::error::GeometryError,
};

/// A part of a scene that names a file.
pub(crate) struct Place<'a> {
    pub(crate) file: &'a str,
    /// The field with its path.
    pub(crate) field: &'static str,
    pub(crate) variant: Path,
}

impl Place<'_> {
    /// Opens the file. Returns its length as well.
    pub(crate) fn open(&self, files: &Folder<'_>) -> Result<(files::Content, u64), Problem> {
        let opened = files.open(self.file);
        opened.map_err(|refused| self.refused(refused))
    }

    /// Creates the problem of a file that is not opened.
    pub(super) fn refused(&self, refused: Refused) -> Problem {
        match refused {
            Refused::Unreadable(why) => self.problem(Code::FileNotFound, why),
            Refused::Outside(how) => self.problem(Code::OutsideFolder, how).help(
                "put the file into the folder of the scene, or allow it by `--allow-outside`",
            ),
        }
    }

    /// Opens a file of data, unless it is something else than its name says. Returns its first bytes and
    /// its length as well; the reader begins with these bytes.
    pub(super) fn open_data(
        &self,
        files: &Folder<'_>,
        code: Code,
    ) -> Result<(Vec<u8>, impl Read + Send + use<>, u64), Problem> {
        let (file, length) = self.open(files)?;
        let (start, file) = start_of(file)
            .map_err(|error| self.problem(Code::FileNotFound, files::cause(error)))?;
        match Foreign::of(&start, self.file) {
            Some(Foreign { what, help }) => Err(self.problem(code, what).help(help)),
            None => Ok((start, file, length)),
        }
    }

    /// The path of a field that may be at fault.
    fn field(&self, blamed: Blamed) -> Path {
        match blamed {
            Blamed::File => self.variant.field(self.field),
            Blamed::Columns => self.variant.field("columns"),
            Blamed::Array => self.variant.field("array"),
            Blamed::Value => self.variant.field("color_by").field("column"),
        }
    }

    /// Creates a problem of the file; the message names the file first.
    pub(crate) fn problem(&self, code: Code, message: impl AsRef<str>) -> Problem {
        self.problem_at(Blamed::File, code, message)
    }

    /// The same at another field.
    pub(super) fn problem_at(
        &self,
        blamed: Blamed,
        code: Code,
        message: impl AsRef<str>,
    ) -> Problem {
        let message = format!("{}: {}", quote(self.file), message.as_ref());
        Problem::new(code, self.field(blamed), Focus::Value, message)
    }

    /// Creates the problem of a fault of the file that is at this many places.
    pub(super) fn fault(&self, code: Code, fault: &Fault, count: usize) -> Problem {
        let message = format!("{}{}", fault.message, and_more(count));
        let problem = self.problem_at(fault.blamed, code, &message);
        // The other fields are the scene's own faults.
        let spot = fault.spot.clone().filter(|_| fault.blamed == Blamed::File);
        Problem {
            in_file: spot.map(|spot| Box::new((spot, message))),
            ..problem.help_of(fault.help.clone())
        }
    }

    /// Returns the format of the file, if it may hold such rows.
    pub(super) fn format(&self, named: &TableModel) -> Result<Format, Problem> {
        let endings = Format::endings(named.kind);
        let problem = |message: String| self.problem(Code::InvalidTable, message);
        match Format::of_name(self.file) {
            Some(format) if format.holds(named.kind) => Ok(format),
            Some(_) => {
                let names = named.kind.names();
                let message = format!("the format has no {names}, expected {endings}");
                Err(problem(message).help("name points and atoms by `Spheres(file: …)`"))
            }
            None => Err(problem(format!(
                "the extension does not determine the format, expected {endings}"
            ))),
        }
    }

    /// Checks the column of `color_by`; returns false if there is none.
    pub(super) fn has_values(
        &self,
        named: &TableModel,
        table: &Table,
        problems: &mut Vec<Problem>,
    ) -> bool {
        let Some(by) = named.color_by else {
            return true;
        };
        let values = table.values();
        let is_finite = values.is_some_and(|values| values.range().is_some()) || table.rows() == 0;
        let known = values.map(|_| is_finite);
        let problem = self.values(by, &table.names, known);
        // The columns of an array without names have those of their order.
        let is_array = Format::of_name(self.file) == Some(Format::Npy) && named.columns.is_none();
        problems.extend(problem.map(|problem| match problem.diagnostic.help {
            None if is_array && known.is_none() => problem.help(format!(
                "name the columns of the array, such as `columns: [\"x\", \"y\", \"z\", {:?}]`",
                by.column
            )),
            _ => problem,
        }));
        known.is_some()
    }

    /// Returns the problem of a column of `color_by` that is not known, or that has no finite value;
    /// `known` is false for that, and `None` for no such column.
    pub(crate) fn values(
        &self,
        by: &ColorByModel,
        names: &Names,
        known: Option<bool>,
    ) -> Option<Problem> {
        let place = self.field(Blamed::Value);
        let column = quote(&by.column);
        let file = quote(self.file);
        let Some(is_finite) = known else {
            let known: Vec<_> = names.all.iter().map(String::as_str).collect();
            let expected = list(&known);
            let message = format!("{file} has no column {column}, expected one of {expected}");
            let problem = Problem::new(Code::UnknownName, place, Focus::Value, message);
            return Some(problem.meaning(&by.column, &known));
        };
        (by.range.is_none() && !is_finite).then(|| {
            let message = format!(
                "this has no effect: {file} has no finite number in column {column}, and `range` \
                 is not given"
            );
            let problem = Problem::new(Code::NoEffect, place, Focus::Value, message);
            problem.help("choose another column, or give a `range`")
        })
    }

    /// Creates the problem of a field that neither the scene nor the file gives.
    pub(crate) fn without(&self, name: &str, help: String) -> Problem {
        let message = format!(
            "missing field `{name}`, which {} does not have either",
            quote(self.file)
        );
        let variant = self.variant.clone();
        Problem::new(Code::MissingField, variant, Focus::Name, message).help(help)
    }

    /// Creates the problem of a row whose transform cannot be inverted.
    pub(super) fn not_placed(&self, at: usize, table: &Table, error: &GeometryError) -> Problem {
        let fault = At::row(at, table.line(at)).fault(error);
        self.fault(Code::InvalidTable, &fault, 1)
    }

    /// Warns about what a table does not take from its file.
    pub(super) fn not_taken(&self, table: &Table) -> impl Iterator<Item = Problem> {
        let left_out = table.left_out.iter().flat_map(|left_out| {
            let rows = counted(&left_out.listed, left_out.count);
            rows.map(|(row, count)| {
                let at = At::row(row, table.line(*row));
                let fault = at.fault("all coordinates are NaN, so there is no point");
                self.fault(Code::NoEffect, &fault, count)
            })
        });
        let behind = table.behind.as_ref();
        let behind = behind.map(|fault| self.fault(Code::NoEffect, fault, 1));
        left_out.chain(behind)
    }

    /// Warns about columns that set nothing.
    pub(super) fn unused_columns(
        &self,
        named: &TableModel,
        table: &Table,
        format: Format,
        problems: &mut Vec<Problem>,
    ) {
        let colors: Vec<_> = match named.color_by {
            Some(_) => format.color_names(named.kind).collect(),
            None => Vec::new(),
        };
        let all: Vec<_> = table.names.all.iter().map(String::as_str).collect();
        // One that a misspelt `color_by` means is not needless.
        let by = named.color_by.map(|by| &*by.column);
        let by = by.filter(|by| !all.contains(by));
        let by = by.and_then(|by| nearest(by, &all));
        let unused = table.names.unused.iter().map(String::as_str);
        let unused = unused.filter(|name| Some(*name) != by);
        let (replaced, unused): (Vec<_>, Vec<_>) = unused.partition(|name| colors.contains(name));
        if !replaced.is_empty() {
            let problem = self.unused(&replaced, named, ": `color_by` gives the colors");
            problems.push(problem.help(
                "leave `color_by` out for the colors of the table, or allow it by `allow: \
                 [\"unused-column\"]`",
            ));
        }
        let Some(first) = unused.first() else {
            return;
        };
        let problem = self.unused(&unused, named, "");
        let known = format.column_names(named.kind);
        let missing = known.filter(|known| {
            let is_there = table.names.all.iter().any(|name| name == known);
            !is_there && !colors.contains(known)
        });
        let missing: Vec<_> = missing.collect();
        let meant = unused.iter().find_map(|name| nearest(name, &missing));
        problems.push(match (meant, named.columns.is_some()) {
            (Some(meant), _) => problem.help(format!("did you mean `{meant}`?")),
            (None, true) => problem.help("write `_` for a column to skip"),
            (None, false) if named.color_by.is_some() || named.kind == RowKind::Copy => problem
                .help("remove what is not needed, or allow it by `allow: [\"unused-column\"]`"),
            (None, false) => problem.help(format!(
                "color by its values with `color_by: (column: {})`, or remove it",
                serde_json::Value::from(*first)
            )),
        });
    }

    /// Creates the warning about columns that are not used, for a reason if one is known.
    fn unused(&self, columns: &[&str], named: &TableModel, why: &str) -> Problem {
        let (what, are) = match columns {
            [_] => ("column", "is"),
            _ => ("columns", "are"),
        };
        let blamed = match named.columns {
            Some(_) => Blamed::Columns,
            None => Blamed::File,
        };
        let message = format!("{what} {} {are} not used{why}", list(columns));
        self.problem_at(blamed, Code::UnusedColumn, message)
    }

    /// Reports what is wrong with the rows of a table.
    pub(super) fn check(
        &self,
        named: &TableModel,
        table: &Table,
        format: Format,
        problems: &mut Vec<Problem>,
    ) {
        // A material without a color is an unknown one, which is reported elsewhere.
        let has_surface = named.texture.is_some() || named.material.is_some();
        let has_color = table.has_color() || has_surface;
        let needed = [("radius", table.has_radius()), ("color", has_color)];
        for (name, is_given) in needed {
            if !is_given && named.kind != RowKind::Copy {
                let help = format!("give one `{name}` for all rows, or add it to the table");
                problems.push(self.without(name, help));
            }
        }
        let (clamped, wrong): (Vec<_>, Vec<_>) = table
            .bad
            .iter()
            .copied()
            .partition(|bad| bad.kind == BadKind::Clamped);
        let clamped = one_of_a_row(clamped);
        let numbers = wrong.into_iter().chain(clamped);
        let numbers = numbers.map(|bad| (bad.row, self.bad(&bad, named, table, format)));
        let is_choice = |bad: &BadRows| {
            let by = named.color_by;
            by.is_some_and(|by| table.has_no_numbers(bad, &by.column))
        };
        // The choice of a column is one fault.
        let (choice, rows): (Vec<_>, Vec<_>) =
            table.bad_rows.iter().partition(|bad| is_choice(bad));
        let count = choice.iter().map(|bad| bad.count).sum();
        let mut choice = choice.first().map(|first| BadRows::clone(first));
        choice.iter_mut().for_each(|choice| choice.count = count);
        let rows = rows.into_iter().chain(&choice);
        let rows = rows.map(|bad| (bad.row, self.bad_rows(bad, named, table)));
        let mut found: Vec<_> = numbers.chain(rows).collect();
        found.sort_by_key(|(row, _)| *row);
        problems.extend(found.into_iter().map(|(_, problem)| problem));
    }

    fn bad_rows(&self, bad: &BadRows, named: &TableModel, table: &Table) -> Problem {
        let by = named
            .color_by
            .filter(|by| table.has_no_numbers(bad, &by.column));
        let fault = match by {
            None => bad.fault.clone(),
            Some(by) => {
                let others = table.names.all.iter().map(String::as_str);
                let others: Vec<_> = others.filter(|name| *name != &*by.column).collect();
                bad.fault.clone().blame_value(&others)
            }
        };
        self.fault(bad.code(), &fault, bad.count)
    }

    /// Warns about defaults of the scene that are unused because every row has its own value.
    pub(super) fn check_defaults(
        &self,
        named: &TableModel,
        table: &Table,
        format: Format,
        problems: &mut Vec<Problem>,
    ) {
        let file = quote(self.file);
        let columns: Vec<_> = format.columns(named.kind).into_iter().flatten().collect();
        let order = columns.join(", ");
        let radius = columns.iter().position(|name| *name == "radius");
        let radius = format!("column {} of the array", radius.unwrap_or_default() + 1);
        let (radius, color) = match format {
            Format::Csv => ("column `radius`", "column `color` or `r`, `g` and `b`"),
            Format::Npy if named.columns.is_none() => (&*radius, "the last 3 columns of the array"),
            Format::Npy | Format::Npz | Format::Xyz | Format::Pdb => {
                ("column `radius`", "columns `r`, `g` and `b`")
            }
            Format::Ply => ("property `radius`", "properties `red`, `green` and `blue`"),
        };
        for (field, columns, is_unused) in [
            (
                "radius",
                radius,
                named.radius.is_some() && table.has_every_radius(),
            ),
            (
                "color",
                color,
                named.color.is_some() && table.has_every_color(),
            ),
        ] {
            if !is_unused {
                continue;
            }
            let message =
                format!("this `{field}` is not used: {file} gives one in every row, {columns}");
            let place = self.variant.field(field);
            let problem = Problem::new(Code::UnusedDefault, place, Focus::Value, message);
            problems.push(problem.help(match format {
                Format::Npy if named.columns.is_none() => format!(
                    "columns of an array are {order} in this order, without alpha; name others, such \
                     as `columns: [\"x\", \"y\", \"z\", \"value\"]`, or leave `{field}` out here if \
                     the array holds it"
                ),
                _ => {
                    format!("leave `{field}` out here, or remove it from the table")
                }
            }));
        }
    }

    fn bad(&self, bad: &Bad, named: &TableModel, table: &Table, format: Format) -> Problem {
        let (code, what) = match bad.kind {
            BadKind::NotFinite => (Code::InvalidTable, "expected a finite number"),
            BadKind::NotAboveZero if named.kind == RowKind::Copy => {
                (Code::InvalidTable, "a scale must be above 0")
            }
            BadKind::NotAboveZero => (Code::InvalidTable, "a radius must be above 0"),
            BadKind::Clamped => (Code::ColorClamped, "a color channel is clamped to 0..1"),
            BadKind::NoAxis(why) => {
                let row = At::row(bad.row, table.line(bad.row));
                let fault = if named.kind == RowKind::Copy {
                    row.fault("the axis has a squared length that is 0 or not finite in an f64")
                        .help("give a direction, such as (0, 1, 0)")
                } else {
                    let name = named.kind.name();
                    row.fault(format!("the ends {why}: the {name} has no length"))
                        .help("give two different points, or remove the row")
                };
                return self.fault(Code::InvalidTable, &fault, bad.count);
            }
        };
        let column = format.column(named.kind, bad.column).unwrap_or_default();
        let names = &table.names.all;
        let (at, of) = (names.iter().position(|name| name == column), names.len());
        let part = match at {
            // The columns of atoms are not those of the text.
            Some(at) if !format.is_atoms() => LinePart::Cell { at, of },
            _ => LinePart::Number(bad.value),
        };
        let cell = At::cell(bad.row, table.line(bad.row), column).part(part);
        let fault = cell.fault(format!("{what}, found `{}`", bad.value));
        let fault = match bad.kind {
            BadKind::Clamped if bad.value > 1.0 && bad.value <= 255.0 => {
                fault.help("8-bit values? divide by 255")
            }
            _ => fault,
        };
        self.fault(code, &fault, bad.count)
    }
}

/// Returns one fault for the three channels of each row; those that are not listed are counted with the
/// last.
fn one_of_a_row(mut bad: Vec<Bad>) -> Vec<Bad> {
    let mut rest = bad.iter().map(|bad| bad.count).sum::<usize>();
    bad.sort_by_key(|bad| (bad.row, bad.column));
    bad.dedup_by_key(|bad| bad.row);
    bad.truncate(most_listed(false));
    for bad in &mut bad {
        rest -= 1;
        bad.count = 1;
    }
    if let Some(last) = bad.last_mut() {
        last.count += rest;
    }
    bad
}

/// Returns the listed places with the number that each stands for: those that are not listed are counted
/// with the last.
fn counted<T>(listed: &[T], count: usize) -> impl Iterator<Item = (&T, usize)> {
    let last = listed.len();
    let number = move |at: usize| if at == last { count + 1 - last } else { 1 };
    (1..)
        .zip(listed)
        .map(move |(at, place)| (place, number(at)))
}

/// Formats the number of further faults beyond the reported one.
pub(crate) fn and_more(count: usize) -> String {
    match count - 1 {
        0 => String::new(),
        more => format!(", and {more} more"),
    }
}
