//! The geometries of a scene: how many of each kind, in which tables and parts.

use std::fmt;

use serde::{Serialize, Serializer};
use strahl::{
    Scene, Shape,
    scene::{Contained, Origin},
    shape::Mesh,
};

use crate::cli::report::write_names;

/// The geometries of a scene.
#[derive(Serialize)]
pub(super) struct Counts<'a> {
    total: usize,
    #[serde(flatten)]
    kinds: Kinds,
    tables: Vec<TableTerms<'a>>,
    /// Those that the scene itself lists.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    mesh_sizes: Vec<MeshTerms<'a>>,
    /// The lists of copies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    instances: Vec<CopiesTerms<'a>>,
    parts: Vec<PartTerms<'a>>,
}

/// The number of geometries of each kind that the scene itself lists.
struct Kinds(Vec<(&'static str, usize)>);

impl Serialize for Kinds {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(kind, count)| (plural(kind), count)))
    }
}

fn plural(kind: &str) -> String {
    if let Some(stem) = kind.strip_suffix('y') {
        return format!("{stem}ies");
    }
    let is_hissing = kind.ends_with(['s', 'x']) || kind.ends_with("sh");
    let ending = if is_hissing { "es" } else { "s" };
    format!("{kind}{ending}")
}

#[derive(Serialize)]
struct TableTerms<'a> {
    #[serde(flatten)]
    place: PlaceTerms<'a>,
    file: String,
    rows: usize,
    /// The index of the first row in the world; the others follow.
    first_id: usize,
    /// The names of its columns.
    columns: &'a [String],
    #[serde(skip_serializing_if = "Option::is_none")]
    color_by: Option<ColorByTerms<'a>>,
}

#[derive(Serialize)]
struct CopiesTerms<'a> {
    #[serde(flatten)]
    place: PlaceTerms<'a>,
    /// The name of the geometry that each is a copy of.
    of: &'a str,
    /// The number of copies.
    copies: usize,
    /// The id of the first copy; the others follow.
    first_id: usize,
    /// The names of the columns of their table.
    #[serde(skip_serializing_if = "Option::is_none")]
    columns: Option<&'a [String]>,
}

#[derive(Serialize)]
struct MeshTerms<'a> {
    #[serde(flatten)]
    place: PlaceTerms<'a>,
    triangles: usize,
    vertices: usize,
    /// The groups that its file names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    groups: Vec<GroupTerms<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    color_by: Option<ColorByTerms<'a>>,
}

#[derive(Serialize)]
struct GroupTerms<'a> {
    name: &'a str,
    triangles: usize,
}

/// The largest number of groups that are listed for people.
const GROUPS: usize = 20;

/// The place of a geometry in the scene, and its name.
#[derive(Serialize)]
struct PlaceTerms<'a> {
    /// The index in the list of geometries.
    geometry: usize,
    /// The index in the list of each group.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    in_groups: Vec<usize>,
    name: Option<&'a str>,
    #[serde(skip)]
    path: String,
}

impl<'a> PlaceTerms<'a> {
    fn new(origin: &Origin, name: Option<&'a str>) -> Self {
        Self {
            geometry: origin.geometry,
            in_groups: origin.in_groups.clone(),
            name,
            path: origin.to_string(),
        }
    }
}

impl fmt::Display for PlaceTerms<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "  {}", self.path)?;
        write_names(out, self.name, &[])
    }
}

/// The values that determine the colors of a table or a mesh.
#[derive(Serialize)]
struct ColorByTerms<'a> {
    column: &'a str,
    /// The values of the first and the last color.
    range: Option<[f64; 2]>,
    /// The smallest and the largest finite value.
    data: Option<[f64; 2]>,
    /// The number of rows or vertices without a value.
    missing: usize,
}

impl fmt::Display for ColorByTerms<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            column,
            range,
            data,
            missing,
        } = self;
        write!(out, "    colors by {column:?}")?;
        match data {
            Some([low, high]) => write!(out, ", values {low:?} to {high:?}")?,
            None => write!(out, ", no finite value")?,
        }
        if let Some([low, high]) = range.filter(|range| Some(*range) != *data) {
            write!(out, ", colors from {low:?} to {high:?}")?;
        }
        if *missing > 0 {
            write!(out, ", {missing} missing")?;
        }
        writeln!(out)
    }
}

#[derive(Serialize)]
struct PartTerms<'a> {
    #[serde(flatten)]
    place: PlaceTerms<'a>,
    file: &'a str,
    /// The number of its geometries.
    geometries: usize,
    /// The index of the first one in the world; the others follow.
    first_id: usize,
    /// The values that determine the colors of its tables and meshes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    color_by: Vec<ColorByTerms<'a>>,
}

impl<'a> Counts<'a> {
    /// Creates the counts of a scene whose tables have these names, in order.
    pub(super) fn new(scene: &'a Scene, tables: Vec<String>) -> Self {
        let geometries = scene.world().geometries();
        let (mut of_tables, mut instances, mut parts) = (Vec::new(), Vec::new(), Vec::new());
        let mut files = tables.into_iter();
        for one in scene.containers() {
            let place = PlaceTerms::new(&one.origin, one.name);
            let (count, first_id) = (one.indices.len(), one.indices.start);
            let mut colors_by = colors_by(scene, &one.origin);
            match one.content {
                Contained::Rows(columns) => of_tables.extend(files.next().map(|file| TableTerms {
                    place,
                    file,
                    rows: count,
                    first_id,
                    columns,
                    color_by: colors_by.next(),
                })),
                Contained::Part(file) => parts.push(PartTerms {
                    place,
                    file,
                    geometries: count,
                    first_id,
                    color_by: colors_by.collect(),
                }),
                Contained::Copies { of, columns } => instances.push(CopiesTerms {
                    place,
                    of,
                    copies: count,
                    first_id,
                    columns,
                }),
            }
        }
        let is_listed = |index: usize| {
            let before = parts.partition_point(|part| part.first_id <= index);
            let part = before.checked_sub(1).and_then(|last| parts.get(last));
            let is_in = part.is_some_and(|part| index < part.first_id + part.geometries);
            let origin = scene.origin(index);
            !is_in && origin.row.is_none() && origin.instance.is_none()
        };
        let listed = geometries.iter().enumerate();
        let listed = listed.map(|(index, geometry)| (scene.world().id_of(index, 0), geometry));
        let listed = listed.filter(|(index, _)| is_listed(*index));
        let mut mesh_sizes = Vec::new();
        // Copies are listed apart.
        let kinds = Shape::KINDS.iter().filter(|kind| **kind != "instances");
        let mut kinds: Vec<_> = kinds.map(|kind| (*kind, 0)).collect();
        for (index, geometry) in listed {
            if let Some(mesh) = mesh_of(geometry.shape()) {
                let origin = scene.origin(index);
                mesh_sizes.push(MeshTerms {
                    place: PlaceTerms::new(&origin, scene.name(index)),
                    triangles: mesh.triangles().len(),
                    vertices: mesh.vertices().len(),
                    groups: groups_of(mesh),
                    color_by: colors_by(scene, &origin).next(),
                });
            }
            let of_kind = |(kind, _): &&mut (&str, usize)| *kind == geometry.shape().kind();
            if let Some((_, count)) = kinds.iter_mut().find(of_kind) {
                *count += 1;
            }
        }
        Self {
            total: scene.world().ids(),
            tables: of_tables,
            instances,
            kinds: Kinds(kinds),
            mesh_sizes,
            parts,
        }
    }
}

/// Returns the mesh that a shape is, placed or not.
fn mesh_of(shape: &Shape) -> Option<&Mesh> {
    match shape {
        Shape::Mesh(mesh) => Some(mesh),
        Shape::Placed(placed) => mesh_of(placed.shape()),
        _ => None,
    }
}

/// Returns the groups of a mesh.
fn groups_of(mesh: &Mesh) -> Vec<GroupTerms<'_>> {
    let groups = mesh.groups();
    let firsts = groups.iter().skip(1).map(|group| group.first);
    let ends = firsts.chain([mesh.triangles().len()]);
    let terms = groups.iter().zip(ends).map(|(group, end)| GroupTerms {
        name: &group.name,
        triangles: end - group.first,
    });
    terms.collect()
}

/// Returns the values that determine colors of a geometry of the scene.
fn colors_by<'a>(scene: &'a Scene, origin: &Origin) -> impl Iterator<Item = ColorByTerms<'a>> {
    let values = scene.color_values();
    let values = values.filter(move |values| values.origin == *origin);
    values.map(|values| ColorByTerms {
        column: &values.scale.column,
        range: values.scale.range,
        data: values.data,
        missing: values.missing,
    })
}

impl fmt::Display for Counts<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            total,
            kinds,
            tables,
            mesh_sizes,
            instances,
            parts: named,
        } = self;
        let count = |count: usize, one: &str| match count {
            1 => format!("1 {one}"),
            _ => format!("{count} {}", plural(one)),
        };
        let kinds = kinds.0.iter().filter(|(_, number)| *number > 0);
        let mut parts: Vec<_> = kinds.map(|(kind, number)| count(*number, kind)).collect();
        let rows: usize = tables.iter().map(|table| table.rows).sum();
        if !tables.is_empty() {
            let (rows, tables) = (count(rows, "row"), count(tables.len(), "table"));
            parts.push(format!("{rows} of {tables}"));
        }
        let copies: usize = instances.iter().map(|list| list.copies).sum();
        if !instances.is_empty() {
            parts.push(count(copies, "copy"));
        }
        if !named.is_empty() {
            let of_parts: usize = named.iter().map(|part| part.geometries).sum();
            parts.push(format!("{of_parts} of {}", count(named.len(), "part")));
        }
        write!(out, "geometries     {total}")?;
        if !parts.is_empty() {
            write!(out, ": {}", parts.join(", "))?;
        }
        writeln!(out)?;
        for table in tables {
            let (place, file) = (&table.place, &table.file);
            write!(out, "{place}: {} of {file:?}", count(table.rows, "row"))?;
            writeln!(out, ", columns {}", table.columns.join(", "))?;
            if let Some(color_by) = &table.color_by {
                write!(out, "{color_by}")?;
            }
        }
        for list in instances {
            let (place, of) = (&list.place, list.of);
            write!(out, "{place}: {} of {of:?}", count(list.copies, "copy"))?;
            match list.columns {
                Some(columns) => writeln!(out, ", columns {}", columns.join(", "))?,
                None => writeln!(out)?,
            }
        }
        for mesh in mesh_sizes {
            let triangles = count(mesh.triangles, "triangle");
            let vertices = match mesh.vertices {
                1 => "1 vertex".to_owned(),
                many => format!("{many} vertices"),
            };
            writeln!(out, "{}: mesh of {triangles}, {vertices}", mesh.place)?;
            for GroupTerms { name, triangles } in mesh.groups.iter().take(GROUPS) {
                writeln!(out, "    group {name:?}: {}", count(*triangles, "triangle"))?;
            }
            if let Some(more) = mesh.groups.len().checked_sub(GROUPS + 1) {
                writeln!(out, "    and {}", count(more + 1, "more group"))?;
            }
            if let Some(color_by) = &mesh.color_by {
                write!(out, "{color_by}")?;
            }
        }
        for part in named {
            let (place, file) = (&part.place, part.file);
            let geometries = count(part.geometries, "geometry");
            writeln!(out, "{place}: {geometries} of {file:?}")?;
            for color_by in &part.color_by {
                write!(out, "{color_by}")?;
            }
        }
        Ok(())
    }
}
