//! Opens, reads and checks the tables that a scene names.

use std::{borrow::Cow, collections::BTreeMap, sync::Arc};

use crate::{
    data::{
        fault::ReadError,
        table::{Cloud, Defaults, Format, Request, Row, Table, kind::RowKind},
    },
    diagnostic::Code,
    scene::{
        copies::{self, PlacedCopies},
        files::{self, Folder},
        foreign::Foreign,
        format::{
            color::{ColorModel, or_white},
            geometry::{
                GeometryModel,
                kind::{CopiesModel, TableModel},
                ordinal::Ordinal,
                placement::Placement,
                walk::Leaf,
            },
            material::MaterialsModel,
            scene::Model,
            transform::TransformModel,
        },
        in_file,
        options::ReadOptions,
        origins::SpanContent,
        part::{Part, PartLight},
        place::Place,
        problem::Problem,
        reread::{RowsOf, TableFile},
    },
    tracer::{
        color::Color, error::GeometryError, geometry::Geometry, shape::Shape, transform::Transform,
    },
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
    /// A table and its file.
    Table(Arc<Table>, Option<Arc<TableFile>>),
    Part {
        /// The part as it is in its file.
        read: Arc<Part>,
        /// The part as it is in the scene: placed by transforms.
        part: Arc<Part>,
        transforms: Vec<Arc<Transform>>,
        /// True if the lights of the part light the scene.
        lights: bool,
    },
    /// Copies, and the table whose rows place them, if there is one.
    Copies(Box<PlacedCopies>, Option<RowsOf>),
}

impl Content {
    /// The table, if it is one.
    pub(crate) fn table(&self) -> Option<&Table> {
        match self {
            Self::Table(table, _) => Some(table),
            Self::Part { .. } | Self::Copies(..) => None,
        }
    }

    /// The part, if it is one.
    pub(crate) fn part(&self) -> Option<&Part> {
        match self {
            Self::Table(..) | Self::Copies(..) => None,
            Self::Part { part, .. } => Some(part),
        }
    }

    /// The copies, if it is some.
    const fn copies(&self) -> Option<&PlacedCopies> {
        match self {
            Self::Copies(copies, _) => Some(copies),
            Self::Table(..) | Self::Part { .. } => None,
        }
    }

    /// Returns the geometries in the scene; none for a table, whose rows are built one by one.
    ///
    /// # Errors
    ///
    /// A product of transforms that cannot be inverted.
    pub(crate) fn geometries(
        &self,
        placement: &Placement,
    ) -> Result<Cow<'_, [Geometry]>, GeometryError> {
        Ok(match self {
            Self::Table(..) => Cow::default(),
            Self::Part { part, .. } => Cow::Borrowed(&part.geometries),
            Self::Copies(copies, _) => {
                Cow::Owned(Vec::from_iter(copies.placed(placement).transpose()?))
            }
        })
    }

    /// Returns what the geometries of the world come from.
    pub(crate) fn into_span(self) -> SpanContent {
        match self {
            Self::Table(table, file) => SpanContent::Table(RowsOf::new(&table, file)),
            Self::Part { part, .. } => SpanContent::Part(Arc::clone(&part.places)),
            Self::Copies(copies, table) => SpanContent::Copies(copies.of, table),
        }
    }

    /// The number of geometries in the world; copies are one.
    pub(crate) fn length(&self) -> usize {
        match self {
            Self::Table(table, _) => table.rows(),
            Self::Part { part, .. } => part.geometries.len(),
            Self::Copies(copies, _) => usize::from(copies.count() > 0),
        }
    }

    /// Follows a change of the geometry that names it: a table takes the defaults that it gives, and a part
    /// is placed by its transforms.
    ///
    /// # Errors
    ///
    /// A part that f64 cannot place as it is asked. One whose transform alone is invalid stays as it
    /// is: validation reports it.
    fn renew(&mut self, at: Ordinal, model: &Model) -> Result<(), GeometryError> {
        match self {
            Self::Table(table, _) => {
                if let Some(named) = model.geometry(at).and_then(GeometryModel::table) {
                    let given = defaults(&named, model.materials.as_ref(), table.format);
                    Arc::make_mut(table).set_defaults(&given);
                }
            }
            Self::Part {
                read,
                part,
                transforms,
                ..
            } => {
                let asked = model.transforms(at).into_iter().map(TransformModel::build);
                let Ok(asked) = asked.collect::<Result<Vec<_>, _>>() else {
                    return Ok(());
                };
                if !asked.iter().eq(transforms.iter().map(|one| &**one)) {
                    let asked: Vec<_> = asked.into_iter().map(Arc::new).collect();
                    *part = match &*asked {
                        [] => Arc::clone(read),
                        asked => Arc::new(read.placed(asked)?),
                    };
                    *transforms = asked;
                }
            }
            Self::Copies(..) => {}
        }
        Ok(())
    }

    /// The number of geometries.
    pub(crate) fn count(&self) -> usize {
        match self {
            Self::Table(table, _) => table.rows(),
            Self::Part { part, .. } => part.count(),
            Self::Copies(copies, _) => copies.count(),
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
        let before = problems.len();
        let place = Place {
            file: named.file,
            field: "file",
            variant: model.path_of(at),
        };
        let locate = |problems: &mut Vec<Problem>| {
            let problems = problems.get_mut(before..).unwrap_or_default();
            in_file::place(problems, named.file, || options.path_of(named.file), files);
        };
        let (table, file) = match open(named, model.materials.as_ref(), &place, files, options) {
            Ok((table, file)) => {
                let format = table.format;
                place.check(named, &table, format, &mut problems);
                problems.extend(place.not_taken(&table));
                locate(&mut problems);
                place.unused_columns(named, &table, format, &mut problems);
                if table.has_unread_rows() || !place.has_values(named, &table, &mut problems) {
                    continue;
                }
                place.check_defaults(named, &table, format, &mut problems);
                (table, file)
            }
            Err(problem) => {
                problems.push(problem);
                locate(&mut problems);
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
        let content = match geometry.copies() {
            Some(_) if !table.bad.is_empty() => continue,
            Some(named) => {
                let around = model.leaf(at).map(|leaf| leaf.placement);
                let around = around.as_ref().and_then(|all| all.transform().ok()?);
                let rows = match table.transforms(around.map(|all| &**all)) {
                    Ok(rows) => rows,
                    Err((at, error)) => {
                        problems.push(place.not_placed(at, &table, &error));
                        locate(&mut problems);
                        continue;
                    }
                };
                let table = Some(RowsOf::new(&table, file.map(Arc::new)));
                Content::Copies(PlacedCopies::new(named, &[], rows).into(), table)
            }
            None => Content::Table(Arc::new(table), file.map(Arc::new)),
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
) -> Result<(Table, Option<TableFile>), Problem> {
    let format = place.format(named)?;
    let path = files.find(named.file);
    let (start, content, length) = place.open_data(files, Code::InvalidTable)?;
    if format == Format::Ply
        && let Some(Foreign { what, help }) = Foreign::of_lines(&start)
    {
        return Err(place.problem(Code::InvalidTable, what).help(help));
    }
    let cloud = (format == Format::Xyz).then(|| Cloud::of(&start)).flatten();
    let format = cloud.as_ref().map_or(format, |_| Format::Csv);
    let columns = cloud.as_ref().and_then(Cloud::names);
    let request = Request {
        defaults: defaults(named, materials, format),
        value: named.color_by.map(|by| &*by.column),
        columns: named.columns.or(columns),
        array: named.array,
    };
    let file = path.ok();
    let file = file.and_then(|path| TableFile::new(path, format, &request, options.shared_files()));
    let content = options.until_cancelled(content);
    let read = Table::read(content, length, format, &request, |length| {
        options.pool(length)
    });
    let table = read.map_err(|error| match error {
        ReadError::Io(error) => place.problem(Code::FileNotFound, files::cause(error)),
        ReadError::Invalid(fault) => place.fault(Code::InvalidTable, &fault, 1),
    })?;
    Ok((table, file))
}

/// Returns the values of rows that have none: the color is that of the material, if it has one, and
/// white for a texture.
/// Atoms have the colors of their elements.
fn defaults(named: &TableModel, materials: Option<&MaterialsModel>, format: Format) -> Defaults {
    let of_surface = || {
        if format.is_atoms() {
            return None;
        }
        if named.texture.is_some() {
            return Some(or_white(None));
        }
        let material = named.material?.resolve(materials)?.build().ok()?;
        Some(material.color())
    };
    let color = named.color.map(ColorModel::build).or_else(of_surface);
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
    pub(crate) fn copies(&self, geometry: Ordinal) -> Option<&PlacedCopies> {
        self.0.get(&geometry)?.copies()
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

    /// Returns the lights that each lit part adds to the scene.
    pub(crate) fn lights(&self) -> impl Iterator<Item = &[PartLight]> {
        self.lights_of_parts().map(|(_, lights)| lights)
    }

    /// The same with the numbers of the geometries that name the parts.
    pub(crate) fn lights_of_parts(&self) -> impl Iterator<Item = (Ordinal, &[PartLight])> {
        self.0.iter().filter_map(|(at, content)| match content {
            Content::Part {
                part, lights: true, ..
            } => part.lights.as_deref().map(|lights| (*at, lights)),
            Content::Part { .. } | Content::Table(..) | Content::Copies(..) => None,
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
        let mut parts = self.0.iter_mut();
        parts.try_for_each(|(at, content)| match content {
            Content::Part { .. } => content.renew(*at, model).map_err(|error| (*at, error)),
            Content::Table(..) | Content::Copies(..) => Ok(()),
        })
    }

    /// Follows a change of the scene, as [`Content::renew`].
    pub(crate) fn renew(&mut self, at: Ordinal, model: &Model) -> Result<(), GeometryError> {
        let content = self.0.get_mut(&at);
        content.map_or(Ok(()), |content| content.renew(at, model))
    }

    /// Adds the copies that a geometry is, or replaces them. Those of a table keep it, and their places.
    pub(crate) fn add_copies(
        &mut self,
        geometry: Ordinal,
        named: CopiesModel,
        prototype: &[Geometry],
    ) {
        let (rows, table) = match self.0.remove(&geometry) {
            Some(Content::Copies(known, Some(table))) => (Arc::clone(known.rows()), Some(table)),
            _ => (copies::written(named), None),
        };
        let copies = PlacedCopies::new(named, prototype, rows);
        self.0
            .insert(geometry, Content::Copies(copies.into(), table));
    }

    /// Returns true if there are no tables, no parts and no copies.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What a geometry names or holds, if it has been read.
    pub(crate) fn get(&self, geometry: Ordinal) -> Option<&Content> {
        self.0.get(&geometry)
    }

    /// Removes and returns a table or a part.
    pub(crate) fn take(&mut self, geometry: Ordinal) -> Option<Content> {
        self.0.remove(&geometry)
    }

    /// Returns true if `is_it` does for any shape in a scene.
    #[inline]
    pub(crate) fn any_shape_of(
        &self,
        model: &Model,
        mut is_it: impl FnMut(&Shape) -> bool,
    ) -> bool {
        let mut leaves = model.leaves();
        leaves.any(|leaf| self.any_shape(&leaf, &mut is_it))
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

    /// The same for the shapes before they are placed by what is around the leaf, each copy of copies
    /// for itself.
    pub(crate) fn any_own_shape(&self, leaf: &Leaf, mut is_it: impl FnMut(Shape) -> bool) -> bool {
        match self.0.get(&leaf.at) {
            None => leaf.geometry.shape().is_some_and(is_it),
            Some(Content::Table(table, ..)) => table.any_row(|row| row.shape.is_ok_and(&mut is_it)),
            Some(Content::Part { read, .. }) => {
                let mut geometries = read.geometries.iter();
                geometries.any(|geometry| is_it(geometry.shape().clone()))
            }
            Some(Content::Copies(copies, _)) => copies.each().any(is_it),
        }
    }

    fn any_of_file(&self, leaf: &Leaf, mut is_it: impl FnMut(&Shape) -> bool) -> bool {
        let Some(content) = self.0.get(&leaf.at) else {
            return false;
        };
        if let Some(table) = content.table() {
            return table.any_row(|row: Row| {
                let shape = row.shape.and_then(|shape| leaf.placement.place(shape));
                shape.is_ok_and(|shape| is_it(&shape))
            });
        }
        let all = content.geometries(&leaf.placement);
        all.is_ok_and(|all| all.iter().any(|geometry| is_it(geometry.shape())))
    }
}
