//! The origins of all geometries of a world.

use std::{iter, ops::Range, sync::Arc};

use crate::scene::{
    format::field::Name,
    origin::{Contained, Container, Origin},
    part::Places,
    reread::RowsOf,
};

/// The names of the geometries in a list, and the origins of the geometries of the world that they
/// stand for; only tables, parts and groups shift the indices.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origins {
    names: Names,
    spans: Vec<Span>,
}

/// The geometries of a table, a part or a group.
#[derive(Clone, Debug)]
struct Span {
    /// The index of the first one among those of the list.
    first: usize,
    count: usize,
    geometry: usize,
    content: SpanContent,
}

/// What a span holds.
#[derive(Clone, Debug)]
pub(crate) enum SpanContent {
    /// The rows of a table.
    Table(RowsOf),
    /// The geometries of a part, with their places in its file.
    Part(Arc<Places>),
    /// The geometries of a group, with their places in it.
    Group(Origins),
    /// Copies of the geometry with this name, and their table.
    Copies(Arc<str>, Option<RowsOf>),
}

impl Span {
    fn ids(&self) -> Range<usize> {
        self.first..self.first + self.count
    }

    /// The list of the group, if it is one.
    const fn group(&self) -> Option<&Origins> {
        match &self.content {
            SpanContent::Group(list) => Some(list),
            SpanContent::Table(_) | SpanContent::Part(_) | SpanContent::Copies(..) => None,
        }
    }
}

/// A geometry of a list that a geometry of the world comes from.
struct ListedGeometry<'a> {
    list: &'a Origins,
    geometry: usize,
    /// The span that it is, and the index in it.
    span: Option<(&'a Span, usize)>,
}

impl Origins {
    /// Adds the name of a geometry, if it has one. Indices must be added in ascending order.
    #[inline]
    pub(crate) fn add_name(&mut self, geometry: usize, name: Option<Name>) {
        self.names.add(geometry, name);
    }

    /// Adds a table, a part or a group, by its index in the list, and the indices of its geometries
    /// among those of the list. They must be added in ascending order.
    pub(crate) fn add(&mut self, geometry: usize, indices: Range<usize>, content: SpanContent) {
        self.spans.push(Span {
            first: indices.start,
            count: indices.len(),
            geometry,
            content,
        });
    }

    /// Returns all tables, parts and copies, also those in groups.
    pub(crate) fn containers(&self) -> Vec<Container<'_>> {
        let mut found = Vec::new();
        self.add_containers(None, 0, &mut found);
        found
    }

    /// Adds all tables, parts and copies of the list of a group, or of the scene, whose first geometry
    /// has an index in the world.
    fn add_containers<'a>(
        &'a self,
        group: Option<&Origin>,
        first: usize,
        found: &mut Vec<Container<'a>>,
    ) {
        for span in &self.spans {
            let in_scene = || Origin::of(span.geometry);
            let origin = group.map_or_else(in_scene, |group| group.inside(span.geometry));
            let start = first + span.first;
            let content = match &span.content {
                SpanContent::Group(list) => {
                    list.add_containers(Some(&origin), start, found);
                    continue;
                }
                SpanContent::Table(rows) => Contained::Rows(&rows.columns),
                SpanContent::Part(part) => Contained::Part(&part.file),
                SpanContent::Copies(of, rows) => Contained::Copies {
                    of,
                    columns: rows.as_ref().map(|rows| &*rows.columns),
                },
            };
            found.push(Container {
                origin,
                name: self.names.of(span.geometry),
                indices: start..start + span.count,
                content,
            });
        }
    }

    /// Returns the names in the list, with the indices of their geometries.
    pub(crate) fn names(&self) -> impl Iterator<Item = (usize, &str)> {
        self.names.all()
    }

    /// Returns each part and each group of the list: its kind, its index, the indices of its
    /// geometries, and its own list.
    pub(crate) fn lists(&self) -> impl Iterator<Item = (&str, usize, Range<usize>, &Self)> {
        self.spans.iter().filter_map(|span| {
            let (kind, list) = match &span.content {
                SpanContent::Table(_) | SpanContent::Copies(..) => return None,
                SpanContent::Part(part) => ("part", &part.origins),
                SpanContent::Group(list) => ("group", list),
            };
            Some((kind, span.geometry, span.ids(), list))
        })
    }

    /// Returns the geometry of this list that a geometry of the world comes from.
    fn find(&self, index: usize) -> ListedGeometry<'_> {
        let before = self.spans.partition_point(|span| span.first <= index);
        let last = before.checked_sub(1).and_then(|last| self.spans.get(last));
        let (geometry, span) = match last {
            None => (index, None),
            Some(span) if span.ids().contains(&index) => {
                (span.geometry, Some((span, index - span.first)))
            }
            Some(span) => (span.geometry + 1 + (index - span.ids().end), None),
        };
        ListedGeometry {
            list: self,
            geometry,
            span,
        }
    }

    /// Returns the geometries that a geometry of the world comes from: one of this list, and if that
    /// is a group one of its list, and so on.
    fn way(&self, index: usize) -> impl Iterator<Item = ListedGeometry<'_>> {
        iter::successors(Some(self.find(index)), |found| {
            let (span, index) = found.span?;
            Some(span.group()?.find(index))
        })
    }

    /// The origin of a geometry by its index in the world.
    pub(crate) fn of(&self, index: usize) -> Origin {
        let mut way = self.way(index);
        let mut last = way.next();
        let mut origin = Origin::of(last.as_ref().map_or(index, |found| found.geometry));
        for found in way {
            origin.in_groups.push(found.geometry);
            last = Some(found);
        }
        if let Some((span, index)) = last.and_then(|found| found.span) {
            match &span.content {
                SpanContent::Table(rows) => origin.row = Some(rows.row_in_file(index)),
                SpanContent::Copies(..) => origin.instance = Some(index),
                SpanContent::Part(_) | SpanContent::Group(_) => {}
            }
        }
        origin
    }

    /// Returns the table of a geometry of the world that is a row of one, and the row, also in a part.
    pub(crate) fn row_of(&self, index: usize) -> Option<(&RowsOf, usize)> {
        let (span, index) = self.way(index).last()?.span?;
        match &span.content {
            SpanContent::Table(rows) | SpanContent::Copies(_, Some(rows)) => Some((rows, index)),
            SpanContent::Part(part) => part.origins.row_of(index),
            SpanContent::Group(_) | SpanContent::Copies(_, None) => None,
        }
    }

    /// The name of a geometry by its index in the world.
    pub(crate) fn name(&self, index: usize) -> Option<&str> {
        let found = self.way(index).last()?;
        found.list.names.of(found.geometry)
    }

    /// The names of the groups that hold a geometry by its index in the world, the outermost first.
    pub(crate) fn groups(&self, index: usize) -> Vec<&str> {
        self.names_at(&self.of(index)).1
    }

    /// Returns the part that holds a geometry of the world, and the index of the geometry in it.
    pub(crate) fn part_of(&self, index: usize) -> Option<(&Places, usize)> {
        let (span, index) = self.way(index).last()?.span?;
        match &span.content {
            SpanContent::Part(part) => Some((part, index)),
            SpanContent::Table(_) | SpanContent::Group(_) | SpanContent::Copies(..) => None,
        }
    }

    /// Returns the innermost part that holds a geometry of the world, and the index of the geometry in
    /// it.
    pub(crate) fn innermost_part_of(&self, index: usize) -> Option<(&Places, usize)> {
        let (part, index) = self.part_of(index)?;
        part.origins
            .innermost_part_of(index)
            .or(Some((part, index)))
    }

    /// The ids of a geometry of the scene.
    pub(crate) fn ids(&self, origin: &Origin) -> Range<usize> {
        let (mut list, mut first) = (self, 0);
        let mut geometry = origin.geometry;
        for inner in &origin.in_groups {
            let span = list.span(geometry);
            let Some((span, group)) = span.and_then(|span| Some((span, span.group()?))) else {
                return 0..0;
            };
            (list, first, geometry) = (group, first + span.first, *inner);
        }
        let indices = list.ids_in_list(geometry);
        let indices = first + indices.start..first + indices.end;
        let row = origin.row.and_then(|row| indices.clone().nth(row));
        row.map_or(indices, |row| row..row + 1)
    }

    /// The span of a geometry of this list.
    fn span(&self, geometry: usize) -> Option<&Span> {
        let found = self
            .spans
            .binary_search_by_key(&geometry, |span| span.geometry);
        found.ok().and_then(|found| self.spans.get(found))
    }

    fn ids_in_list(&self, geometry: usize) -> Range<usize> {
        let before = self.spans.partition_point(|span| span.geometry <= geometry);
        let span = before.checked_sub(1).and_then(|last| self.spans.get(last));
        match span {
            None => geometry..geometry + 1,
            Some(span) if span.geometry == geometry => span.ids(),
            Some(span) => {
                let index = span.ids().end + (geometry - span.geometry - 1);
                index..index + 1
            }
        }
    }

    /// The name of a geometry of the scene, and those of the groups that hold it, the outermost
    /// first.
    pub(crate) fn names_at(&self, origin: &Origin) -> (Option<&str>, Vec<&str>) {
        let mut list = Some(self);
        let mut names = Vec::new();
        for geometry in iter::once(&origin.geometry).chain(&origin.in_groups) {
            names.push(list.and_then(|list| list.names.of(*geometry)));
            list = list.and_then(|list| list.span(*geometry)?.group());
        }
        let name = names.pop().flatten();
        (name, names.into_iter().flatten().collect())
    }
}

/// The names of the geometries that have one, by their index in a list.
#[derive(Clone, Debug, Default)]
pub(crate) struct Names(Vec<(usize, Name)>);

impl Names {
    /// Adds the name of a geometry, if it has one. Indices must be added in ascending order.
    #[inline]
    pub(crate) fn add(&mut self, geometry: usize, name: Option<Name>) {
        if let Some(name) = name {
            self.0.push((geometry, name));
        }
    }

    /// Returns all names with the indices of their geometries.
    pub(crate) fn all(&self) -> impl Iterator<Item = (usize, &str)> {
        self.0.iter().map(|(geometry, name)| (*geometry, &***name))
    }

    /// The name of a geometry, if it has one.
    pub(crate) fn of(&self, geometry: usize) -> Option<&str> {
        let found = self.0.binary_search_by_key(&geometry, |(index, _)| *index);
        found.ok().and_then(|at| Some(&**self.0.get(at)?.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::scales::Scales;

    fn spans(spans: Vec<Span>) -> Origins {
        Origins {
            spans,
            ..Origins::default()
        }
    }

    fn geometry(geometry: usize, in_groups: &[usize]) -> Origin {
        Origin {
            geometry,
            in_groups: in_groups.into(),
            ..Origin::default()
        }
    }

    #[test]
    fn rows_take_the_place_of_their_table() {
        let span = |first, count, geometry| Span {
            first,
            count,
            geometry,
            content: SpanContent::Table(RowsOf::default()),
        };
        // Two spheres, a table of three, one of none, a sphere, and a table of one.
        let origins = spans(vec![span(2, 3, 2), span(5, 0, 3), span(6, 1, 5)]);
        let found: Vec<_> = (0..8).map(|index| origins.of(index).to_string()).collect();
        let expected = [
            "geometries[0]",
            "geometries[1]",
            "geometries[2] row 0",
            "geometries[2] row 1",
            "geometries[2] row 2",
            "geometries[4]",
            "geometries[5] row 0",
            "geometries[6]",
        ];
        assert_eq!(found, expected);
        let tables = origins.containers().into_iter();
        let tables = tables.map(|table| (table.origin.geometry, table.indices));
        assert!(tables.eq([(2, 2..5), (3, 5..5), (5, 6..7)]));
        let indices = (0..7).map(|index| origins.ids(&geometry(index, &[])));
        let indices: Vec<_> = indices.collect();
        assert_eq!(indices, [0..1, 1..2, 2..5, 5..5, 5..6, 6..7, 7..8]);
        assert_eq!(Origins::default().of(7).to_string(), "geometries[7]");
    }

    #[test]
    fn geometries_of_a_part_have_a_place_in_its_file() {
        let part = |file: &str, list| {
            Arc::new(Places {
                file: file.into(),
                origins: spans(list),
                scales: Scales::default(),
            })
        };
        let span = |first, count, geometry, part| Span {
            first,
            count,
            geometry,
            content: SpanContent::Part(part),
        };
        // A sphere, a part of a sphere and a part of two spheres, and a sphere.
        let leaf = part("leaf.ron", Vec::new());
        let tree = part("tree.ron", vec![span(1, 2, 1, leaf)]);
        let origins = spans(vec![span(1, 3, 1, tree)]);
        let found = (0..5).map(|index| {
            let mut places = Vec::new();
            if let Some((part, index)) = origins.part_of(index) {
                part.add_to(&mut places, index);
            }
            let places = places.iter();
            let inner = places.map(|place| format!(", {} {}", place.file, place.origin));
            format!("{}{}", origins.of(index), inner.collect::<String>())
        });
        let expected = [
            "geometries[0]",
            "geometries[1], tree.ron geometries[0]",
            "geometries[1], tree.ron geometries[1], leaf.ron geometries[0]",
            "geometries[1], tree.ron geometries[1], leaf.ron geometries[1]",
            "geometries[2]",
        ];
        assert_eq!(found.collect::<Vec<_>>(), expected);
        let indices = [1, 2].map(|index| origins.ids(&geometry(index, &[])));
        assert_eq!(indices, [1..4, 4..5]);
        let containers = origins.containers();
        let contents: Vec<_> = containers.iter().map(|one| one.content).collect();
        assert_eq!(contents, [Contained::Part("tree.ron")]);
    }

    #[test]
    fn groups_hold_geometries_tables_and_groups() {
        let name = |text: &str| Some(Name::new(text.into()));
        let span = |first, count, geometry, content| Span {
            first,
            count,
            geometry,
            content,
        };
        let table = || SpanContent::Table(RowsOf::default());
        // A sphere, a group of a sphere, a table of two, an empty group and a group of a sphere, and
        // a sphere.
        let mut inmost = spans(Vec::new());
        inmost.add_name(0, name("nut"));
        let mut group = spans(vec![
            span(1, 2, 1, table()),
            span(3, 0, 2, SpanContent::Group(Origins::default())),
            span(3, 1, 3, SpanContent::Group(inmost)),
        ]);
        group.add_name(1, name("seeds"));
        let mut origins = spans(vec![span(1, 4, 1, SpanContent::Group(group))]);
        origins.add_name(1, name("bowl"));
        let expected = [
            ("geometries[0]", None, vec![]),
            ("geometries[1].geometries[0]", None, vec!["bowl"]),
            (
                "geometries[1].geometries[1] row 0",
                Some("seeds"),
                vec!["bowl"],
            ),
            (
                "geometries[1].geometries[1] row 1",
                Some("seeds"),
                vec!["bowl"],
            ),
            (
                "geometries[1].geometries[3].geometries[0]",
                Some("nut"),
                vec!["bowl"],
            ),
            ("geometries[2]", None, vec![]),
        ];
        for (index, (path, name, groups)) in expected.into_iter().enumerate() {
            let origin = origins.of(index);
            assert_eq!(origin.to_string(), path);
            let path = path.split(' ').next().unwrap();
            assert_eq!(origin.path().to_string(), path);
            let parsed: Origin = path.parse().unwrap();
            assert_eq!(
                (parsed.geometry, &parsed.in_groups),
                (origin.geometry, &origin.in_groups)
            );
            assert_eq!(
                (origins.name(index), origins.groups(index)),
                (name, groups.clone())
            );
            assert_eq!(origins.names_at(&origin), (name, groups));
            assert!(origins.ids(&origin).contains(&index));
        }
        for wrong in [
            "",
            "geometries",
            "geometries[0].radius",
            "lights[0]",
            "geometries[x]",
        ] {
            assert!(wrong.parse::<Origin>().is_err(), "{wrong}");
        }
        assert_eq!(origins.ids(&geometry(1, &[])), 1..5);
        assert_eq!(origins.ids(&geometry(1, &[2])), 4..4);
        assert_eq!(origins.ids(&geometry(1, &[3])), 4..5);
        let [table] = &origins.containers()[..] else {
            panic!("there is one");
        };
        let found = (table.origin.to_string(), table.name, table.indices.clone());
        let place = "geometries[1].geometries[1]".to_owned();
        assert_eq!(found, (place, Some("seeds"), 2..4));
    }
}
