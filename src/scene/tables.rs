//! Opens, reads and checks the tables that a scene names.

use std::{collections::BTreeMap, sync::Arc};

use crate::{
    diagnostic::{Code, path::Path},
    scene::{
        files::{self, Folder, Refused},
        format::{
            color::ColorModel,
            color_by::ColorByModel,
            geometry::{
                GeometryModel,
                nesting::{Leaf, Ordinal},
                table::{RowKind, TableModel},
            },
            material::MaterialsModel,
            scene::Model,
            transform::TransformModel,
        },
        instances::Instances,
        options::ReadOptions,
        part::{Part, PartLight},
        problem::{Cure, Focus, Problem},
        table::{
            Bad, BadRows, Defaults, Fault, Format, Kind, Names, ReadError, Request, Row, Table,
            cell, row,
        },
    },
    text::nearest::{list, nearest, quote},
    tracer::{color::Color, error::GeometryError, shape::Shape, transform::Transform},
};

/// The maximum number of geometries in a scene, rows included: an index has 32 bits, and one value
/// is reserved for none.
pub(crate) const MOST: usize = u32::MAX as usize - 1;

/// The tables and parts of a scene, by the number of the geometry that names them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tables(BTreeMap<Ordinal, Content>);

/// The geometries of a file that a scene names.
#[derive(Clone, Debug)]
pub(crate) enum Content {
    Table(Box<Table>),
    Part {
        /// The part as it is in its file.
        read: Arc<Part>,
        /// The part as it is in the scene: placed by transforms.
        part: Arc<Part>,
        transforms: Vec<Arc<Transform>>,
        /// True if the lights of the part light the scene.
        lights: bool,
    },
    Instances(Box<Instances>),
}

impl Content {
    /// The table, if it is one.
    const fn table(&self) -> Option<&Table> {
        match self {
            Self::Table(table) => Some(table),
            Self::Part { .. } | Self::Instances(_) => None,
        }
    }

    /// The part, if it is one.
    pub(crate) fn part(&self) -> Option<&Part> {
        match self {
            Self::Table(_) | Self::Instances(_) => None,
            Self::Part { part, .. } => Some(part),
        }
    }

    /// The copies, if it is some.
    const fn instances(&self) -> Option<&Instances> {
        match self {
            Self::Instances(instances) => Some(instances),
            Self::Table(_) | Self::Part { .. } => None,
        }
    }

    /// The number of geometries.
    pub(crate) fn count(&self) -> usize {
        match self {
            Self::Table(table) => table.rows(),
            Self::Part { part, .. } => part.count(),
            Self::Instances(instances) => instances.count(),
        }
    }
}

/// Reads all tables of a scene and returns their problems.
pub(crate) fn read(
    model: &Model,
    files: &Folder<'_>,
    options: &ReadOptions,
) -> (Tables, Vec<Problem>) {
    let mut tables = BTreeMap::new();
    let mut problems = Vec::new();
    let mut total = model.leaves().count();
    for (at, geometry) in model.walk() {
        let Some(named) = geometry.table() else {
            continue;
        };
        let named = &named;
        let place = Place {
            file: named.file,
            variant: model.path_of(at),
        };
        let table = match open(named, model.materials.as_ref(), &place, files, options) {
            Ok((table, format)) => {
                place.check(named, &table, format, &mut problems);
                place.unused_columns(named, &table, format, &mut problems);
                if !table.bad_rows().is_empty() || !place.has_values(named, &table, &mut problems) {
                    continue;
                }
                place.check_defaults(named, &table, format, &mut problems);
                table
            }
            Err(problem) => {
                problems.push(problem);
                continue;
            }
        };
        total = total.saturating_add(table.rows());
        if total > MOST {
            let message =
                format!("with this table there are {total} geometries, the maximum is {MOST}");
            problems.push(place.problem(Code::InvalidTable, message));
            break;
        }
        let content = match geometry {
            GeometryModel::Instances(_) if !table.bad().is_empty() => continue,
            GeometryModel::Instances(instances) => {
                let rows = match table.transforms() {
                    Ok(rows) => rows,
                    Err((at, error)) => {
                        problems.push(place.not_placed(at, &table, &error));
                        continue;
                    }
                };
                let columns = Some(Arc::clone(&table.names().all));
                Content::Instances(Instances::new(instances, &[], columns, rows).into())
            }
            _ => Content::Table(Box::new(table)),
        };
        tables.insert(at, content);
    }
    (Tables(tables), problems)
}

fn open(
    named: &TableModel,
    materials: Option<&MaterialsModel>,
    place: &Place,
    files: &Folder<'_>,
    options: &ReadOptions,
) -> Result<(Table, Format), Problem> {
    let format = place.format(named)?;
    let (file, length) = place.open(files)?;
    let request = Request {
        defaults: defaults(named, materials, format),
        value: named.color_by.map(|by| &*by.column),
        columns: named.columns,
        array: named.array,
    };
    let read = Table::read(file, length, format, &request, |length| {
        options.pool(length)
    });
    let table = read.map_err(|error| match error {
        ReadError::Io(error) => place.problem(Code::FileNotFound, files::cause(error)),
        ReadError::Invalid(Fault {
            message,
            help,
            field,
        }) => {
            let problem = place.problem_at(field, Code::InvalidTable, message);
            problem.help_of(help)
        }
    })?;
    Ok((table, format))
}

/// Returns the values of rows that have none: the color is that of the material, if it has one.
/// Atoms have the colors of their elements.
fn defaults(named: &TableModel, materials: Option<&MaterialsModel>, format: Format) -> Defaults {
    let of_material = || {
        if format.is_atoms() {
            return None;
        }
        named.material?.resolve(materials)?.first_color()
    };
    let color = named.color.map(ColorModel::build).or_else(of_material);
    // Rows whose values have colors need no others.
    let color = color.or_else(|| named.color_by.map(|_| Color::BLACK));
    Defaults {
        kind: named.kind,
        radius: match named.kind {
            RowKind::Copy => Some(1.0),
            RowKind::Sphere | RowKind::Cylinder { .. } => named.radius,
        },
        color: color.map(|color| [color.r(), color.g(), color.b()]),
    }
}

/// A geometry that names a file.
pub(crate) struct Place<'a> {
    pub(crate) file: &'a str,
    pub(crate) variant: Path,
}

impl Place<'_> {
    /// Opens the file. Returns its length as well.
    pub(crate) fn open(&self, files: &Folder<'_>) -> Result<(files::Content, u64), Problem> {
        files.open(self.file).map_err(|refused| match refused {
            Refused::Unreadable(why) => self.problem(Code::FileNotFound, why),
            Refused::Outside(how) => self.problem(Code::OutsideFolder, how).help(
                "put the file into the folder of the scene, or allow it by `--allow-outside`",
            ),
        })
    }

    /// Creates a problem of the file; the message names the file first.
    pub(crate) fn problem(&self, code: Code, message: impl AsRef<str>) -> Problem {
        self.problem_at("file", code, message)
    }

    /// The same at another field.
    fn problem_at(&self, field: &'static str, code: Code, message: impl AsRef<str>) -> Problem {
        let message = format!("{}: {}", quote(self.file), message.as_ref());
        Problem::new(code, self.variant.field(field), Focus::Value, message)
    }

    /// Returns the format of the file, if it may hold such rows.
    fn format(&self, named: &TableModel) -> Result<Format, Problem> {
        let endings = Format::endings(named.kind);
        let problem = |message: String| self.problem(Code::InvalidTable, message);
        match Format::of_name(self.file) {
            Some(format) if format.holds(named.kind) => Ok(format),
            Some(_) => {
                let name = named.kind.name();
                let message = format!("the format has no {name}s, expected {endings}");
                Err(problem(message).help("name points and atoms by `Spheres(file: …)`"))
            }
            None => Err(problem(format!(
                "the extension does not determine the format, expected {endings}"
            ))),
        }
    }

    /// Checks the column of `color_by`; returns false if there is none.
    fn has_values(&self, named: &TableModel, table: &Table, problems: &mut Vec<Problem>) -> bool {
        let Some(by) = named.color_by else {
            return true;
        };
        let values = table.values();
        let is_finite = values.is_some_and(|values| values.range().is_some()) || table.rows() == 0;
        let known = values.map(|_| is_finite);
        problems.extend(self.values(by, table.names(), known));
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
        let place = self.variant.field("color_by").field("column");
        let column = quote(&by.column);
        let file = quote(self.file);
        let Some(is_finite) = known else {
            let known: Vec<_> = names.all.iter().map(String::as_str).collect();
            let expected = list(&known);
            let message = format!("{file} has no column {column}, expected one of {expected}");
            let problem = Problem::new(Code::UnknownName, place, Focus::Value, message);
            return Some(match nearest(&by.column, &known) {
                Some(meant) => problem
                    .help(format!("did you mean {}?", quote(meant)))
                    .cure(Cure::Write(serde_json::Value::from(meant).to_string())),
                None => problem,
            });
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
    fn not_placed(&self, at: usize, table: &Table, error: &GeometryError) -> Problem {
        let row = row(at, table.line(at));
        self.problem(Code::InvalidTable, format!("{row}: {error}"))
    }

    /// Warns about columns that set nothing.
    fn unused_columns(
        &self,
        named: &TableModel,
        table: &Table,
        format: Format,
        problems: &mut Vec<Problem>,
    ) {
        let unused: Vec<_> = table.names().unused.iter().map(String::as_str).collect();
        let (what, are) = match unused.as_slice() {
            [] => return,
            [_] => ("column", "is"),
            _ => ("columns", "are"),
        };
        let field = if named.columns.is_some() {
            "columns"
        } else {
            "file"
        };
        let message = format!("{what} {} {are} not used", list(&unused));
        let problem = self.problem_at(field, Code::UnusedColumn, message);
        let missing = format
            .columns(named.kind)
            .into_iter()
            .flatten()
            .filter(|known| table.names().all.iter().all(|name| name != known));
        let missing: Vec<_> = missing.collect();
        let meant = unused.iter().find_map(|name| nearest(name, &missing));
        problems.push(match (meant, named.columns.is_some()) {
            (Some(meant), _) => problem.help(format!("did you mean `{meant}`?")),
            (None, true) => problem.help("write `_` for a column to skip"),
            (None, false) if named.color_by.is_some() || named.kind == RowKind::Copy => problem
                .help("remove what is not needed, or allow it by `allow: [\"unused-column\"]`"),
            (None, false) => problem.help(format!(
                "color by its values with `color_by: (column: {})`, or remove it",
                serde_json::Value::from(unused.first().copied().unwrap_or_default())
            )),
        });
    }

    fn check(
        &self,
        named: &TableModel,
        table: &Table,
        format: Format,
        problems: &mut Vec<Problem>,
    ) {
        // A material without a color is an unknown one, which is reported elsewhere.
        let has_color = table.has_color() || named.material.is_some();
        let needed = [("radius", table.has_radius()), ("color", has_color)];
        for (name, is_given) in needed {
            if !is_given && named.kind != RowKind::Copy {
                let help = format!("give one `{name}` for all rows, or add it to the table");
                problems.push(self.without(name, help));
            }
        }
        let (clamped, wrong): (Vec<_>, Vec<_>) = table
            .bad()
            .iter()
            .copied()
            .partition(|bad| bad.kind == Kind::Clamped);
        // One warning for the three channels.
        let count = clamped.iter().map(|bad| bad.count).sum();
        let first = clamped.into_iter().min_by_key(|bad| (bad.row, bad.column));
        let clamped = first.map(|first| Bad { count, ..first });
        let numbers = wrong.into_iter().chain(clamped);
        let numbers = numbers.map(|bad| (bad.row, self.bad(&bad, named, table, format)));
        let rows = table.bad_rows().iter();
        let rows = rows.map(|bad| (bad.row, self.bad_rows(bad)));
        let mut found: Vec<_> = numbers.chain(rows).collect();
        found.sort_by_key(|(row, _)| *row);
        problems.extend(found.into_iter().map(|(_, problem)| problem));
    }

    fn bad_rows(&self, bad: &BadRows) -> Problem {
        let message = format!("{}{}", bad.fault.message, and_more(bad.count));
        let problem = self.problem(Code::InvalidTable, message);
        problem.help_of(bad.fault.help.clone())
    }

    /// Warns about defaults of the scene that are unused because every row has its own value.
    fn check_defaults(
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
                    "columns of an array are {order} in this order, without alpha; name them by \
                     `columns`, or leave `{field}` out here if that is what the array holds"
                ),
                _ => {
                    format!("leave `{field}` out here, or remove it from the table")
                }
            }));
        }
    }

    fn bad(&self, bad: &Bad, named: &TableModel, table: &Table, format: Format) -> Problem {
        let more = and_more(bad.count);
        let (code, what) = match bad.kind {
            Kind::NotFinite => (Code::InvalidTable, "expected a finite number"),
            Kind::NotAboveZero if named.kind == RowKind::Copy => {
                (Code::InvalidTable, "a scale must be above 0")
            }
            Kind::NotAboveZero => (Code::InvalidTable, "a radius must be above 0"),
            Kind::Clamped => (Code::ColorClamped, "a color channel is clamped to 0..1"),
            Kind::NoAxis(why) => {
                let row = row(bad.row, table.line(bad.row));
                if named.kind == RowKind::Copy {
                    let message = format!(
                        "{row}: the axis has a squared length that is 0 or not finite in an f64{more}"
                    );
                    let problem = self.problem(Code::InvalidTable, message);
                    return problem.help("give a direction, such as (0, 1, 0)");
                }
                let name = named.kind.name();
                let message = format!("{row}: the ends {why}: the {name} has no length{more}");
                let problem = self.problem(Code::InvalidTable, message);
                return problem.help("give two different points, or remove the row");
            }
        };
        let column = format.column(named.kind, bad.column);
        let cell = cell(bad.row, table.line(bad.row), column.unwrap_or_default());
        let message = format!("{cell}: {what}, found `{}`{more}", bad.value);
        let problem = self.problem(code, message);
        match bad.kind {
            Kind::Clamped if bad.value > 1.0 && bad.value <= 255.0 => {
                problem.help("8-bit values? divide by 255")
            }
            _ => problem,
        }
    }
}

/// Formats the number of further faults beyond the reported one.
pub(crate) fn and_more(count: usize) -> String {
    match count - 1 {
        0 => String::new(),
        more => format!(", and {more} more"),
    }
}

impl Tables {
    /// The table that a geometry names, if it has been read.
    pub(crate) fn of(&self, geometry: Ordinal) -> Option<&Table> {
        self.0.get(&geometry)?.table()
    }

    /// The part that a geometry names, if it has been read and has no errors.
    pub(crate) fn part(&self, geometry: Ordinal) -> Option<&Part> {
        self.0.get(&geometry)?.part()
    }

    /// The copies that a geometry is, if it names something that can be copied.
    pub(crate) fn instances(&self, geometry: Ordinal) -> Option<&Instances> {
        self.0.get(&geometry)?.instances()
    }

    /// Returns true if the table or the part that a geometry names has been read.
    pub(crate) fn has(&self, geometry: Ordinal) -> bool {
        self.0.contains_key(&geometry)
    }

    /// Returns the number of geometries that a leaf of the scene stands for: more or less than one
    /// for a table or a part.
    pub(crate) fn count(&self, geometry: Ordinal) -> usize {
        self.0.get(&geometry).map_or(1, Content::count)
    }

    /// Returns all tables and parts with the numbers of the geometries that name them.
    pub(crate) fn contents(&self) -> impl Iterator<Item = (Ordinal, &Content)> {
        self.0
            .iter()
            .map(|(geometry, content)| (*geometry, content))
    }

    /// Returns all tables with the numbers of the geometries that name them.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (Ordinal, &Table)> {
        let contents = self.contents();
        contents.filter_map(|(geometry, content)| Some((geometry, content.table()?)))
    }

    /// Returns the parts with the numbers of the geometries that name them.
    pub(crate) fn parts(&self) -> impl Iterator<Item = (Ordinal, &Part)> {
        let contents = self.contents();
        contents.filter_map(|(geometry, content)| Some((geometry, content.part()?)))
    }

    /// Returns the lights that each lit part adds to the scene.
    pub(crate) fn lights(&self) -> impl Iterator<Item = &[PartLight]> {
        self.0.values().filter_map(|content| match content {
            Content::Part {
                part, lights: true, ..
            } => part.lights.as_deref(),
            Content::Part { .. } | Content::Table(_) | Content::Instances(_) => None,
        })
    }

    /// Adds a part, not placed yet.
    pub(crate) fn add_part(&mut self, geometry: Ordinal, part: Arc<Part>, lights: bool) {
        let content = Content::Part {
            read: Arc::clone(&part),
            part,
            transforms: Vec::new(),
            lights,
        };
        self.0.insert(geometry, content);
    }

    /// Places the parts as a scene does.
    ///
    /// # Errors
    ///
    /// Returns the first part that f64 cannot place as it is asked. Those whose transform alone is
    /// invalid stay as they are: validation reports it.
    pub(crate) fn place(&mut self, model: &Model) -> Result<(), (Ordinal, GeometryError)> {
        for (at, content) in &mut self.0 {
            let Content::Part {
                read,
                part,
                transforms,
                ..
            } = content
            else {
                continue;
            };
            let asked = model.transforms(*at).into_iter().map(TransformModel::build);
            let Ok(asked) = asked.collect::<Result<Vec<_>, _>>() else {
                continue;
            };
            if asked
                .iter()
                .eq(transforms.iter().map(|transform| &**transform))
            {
                continue;
            }
            let asked: Vec<_> = asked.into_iter().map(Arc::new).collect();
            *part = match &*asked {
                [] => Arc::clone(read),
                asked => Arc::new(read.placed(asked).map_err(|error| (*at, error))?),
            };
            *transforms = asked;
        }
        Ok(())
    }

    /// Adds the copies that a geometry is, or replaces them.
    pub(crate) fn add_instances(&mut self, geometry: Ordinal, instances: Instances) {
        let content = Content::Instances(instances.into());
        self.0.insert(geometry, content);
    }

    /// Returns the numbers of the geometries that are copies.
    pub(crate) fn copies(&self) -> Vec<Ordinal> {
        let all = self.contents();
        let all = all.filter(|(_, content)| content.instances().is_some());
        all.map(|(at, _)| at).collect()
    }

    /// Returns the tables and parts of a geometry and of those inside of it, placed by no transform
    /// that is around it.
    ///
    /// # Errors
    ///
    /// A part that f64 cannot place as it is asked.
    pub(crate) fn inside(&self, model: &Model, around: Ordinal) -> Result<Self, GeometryError> {
        let own = model.geometry(around).and_then(GeometryModel::transform);
        let outer = model.transforms(around).len() - usize::from(own.is_some());
        let all = self
            .0
            .iter()
            .filter(|(at, _)| **at == around || model.holds(around, **at));
        let all = all.map(|(at, content)| {
            let mut content = content.clone();
            if let Content::Part {
                read,
                part,
                transforms,
                ..
            } = &mut content
                && outer > 0
            {
                transforms.drain(..outer.min(transforms.len()));
                *part = Arc::new(read.placed(transforms)?);
            }
            Ok((*at, content))
        });
        Ok(Self(all.collect::<Result<_, GeometryError>>()?))
    }

    /// Returns a copy of the parts that some geometries name; of all, if one of these is copies.
    pub(crate) fn some_parts(&self, geometries: &[Ordinal]) -> Self {
        if geometries.iter().any(|at| self.instances(*at).is_some()) {
            return self.clone();
        }
        let all = geometries.iter().filter_map(|at| {
            let content = self.0.get(at)?;
            content.part().map(|_| (*at, content.clone()))
        });
        Self(all.collect())
    }

    /// Returns true if there are no tables, no parts and no copies.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Replaces the defaults of the tables by those of these geometries.
    pub(crate) fn set_defaults(&mut self, model: &Model) {
        for (at, content) in &mut self.0 {
            let named = model.geometry(*at).and_then(GeometryModel::table);
            if let Content::Table(table) = content
                && let Some(named) = named
                && let Some(format) = Format::of_name(named.file)
            {
                table.set_defaults(&defaults(&named, model.materials.as_ref(), format));
            }
        }
    }

    /// Removes and returns a table or a part.
    pub(crate) fn take(&mut self, geometry: Ordinal) -> Option<Content> {
        self.0.remove(&geometry)
    }

    /// Returns true if `is_it` does for any shape in the scene that a leaf stands for: its own, or
    /// those of the table or the part that it names. Invalid ones are skipped.
    #[inline]
    pub(crate) fn any_shape(&self, leaf: &Leaf, mut is_it: impl FnMut(&Shape) -> bool) -> bool {
        match leaf.shape() {
            Some(shape) => is_it(&shape),
            None => self.any_of_file(leaf, is_it),
        }
    }

    fn any_of_file(&self, leaf: &Leaf, mut is_it: impl FnMut(&Shape) -> bool) -> bool {
        if let Some(part) = self.part(leaf.at) {
            let mut geometries = part.geometries.iter();
            return geometries.any(|geometry| is_it(geometry.shape()));
        }
        if let Some(instances) = self.instances(leaf.at) {
            let all = instances.placed(&leaf.placement);
            return all.is_some_and(|all| all.is_ok_and(|all| is_it(all.shape())));
        }
        let mut is_row = |row: Row| {
            let shape = row.shape.and_then(|shape| leaf.placement.place(shape));
            shape.is_ok_and(|shape| is_it(&shape))
        };
        self.of(leaf.at)
            .is_some_and(|table| table.any_row(&mut is_row))
    }
}
