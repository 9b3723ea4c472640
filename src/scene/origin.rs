//! The origin of a world's geometry in its scene.

use std::{fmt, ops::Range, sync::Arc};

use crate::scene::{
    part::Places,
    tables::{Content, Tables},
};

/// The origin of a world's geometry in its scene. It is displayed as a path, such as
/// `geometries[3]` or `geometries[3] row 17`. A geometry of a part has the index of the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// The index in the scene's list of geometries, from 0.
    pub geometry: usize,
    /// The row of the table that this geometry names, from 0.
    pub row: Option<usize>,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "geometries[{}]", self.geometry)?;
        self.row.map_or(Ok(()), |row| write!(f, " row {row}"))
    }
}

/// A table of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct TableRows<'a> {
    /// The index of the geometry that names it in the scene's list of geometries, from 0.
    pub geometry: usize,
    /// The name in the scene.
    pub name: Option<&'a str>,
    /// The indices of its rows in the world.
    pub indices: Range<usize>,
    /// The names of its columns, also of those that are not used.
    pub columns: &'a [String],
}

/// A part of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PartGeometries<'a> {
    /// The index of the part in the scene's list of geometries, from 0.
    pub geometry: usize,
    /// The name in the scene.
    pub name: Option<&'a str>,
    /// The path of the file from the current folder.
    pub file: &'a str,
    /// The indices of its geometries in the world.
    pub indices: Range<usize>,
}

/// The origin of every geometry of a world; only tables and parts shift the indices.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origins(Vec<Span>);

/// The rows of a table, or the geometries of a part.
#[derive(Clone, Debug)]
struct Span {
    /// The index of the first one in the world.
    first: usize,
    count: usize,
    geometry: usize,
    content: SpanContent,
}

/// What a span holds.
#[derive(Clone, Debug)]
enum SpanContent {
    /// The rows of a table with these columns.
    Table(Arc<[String]>),
    /// The geometries of a part, with their places in its file.
    Part(Arc<Places>),
}

impl Span {
    fn indices(&self) -> Range<usize> {
        self.first..self.first + self.count
    }

    fn part(&self) -> Option<&Arc<Places>> {
        match &self.content {
            SpanContent::Part(places) => Some(places),
            SpanContent::Table(_) => None,
        }
    }
}

impl Origins {
    /// Returns the origins for the world of a scene with these tables and parts.
    pub(crate) fn new(tables: &Tables) -> Self {
        let mut spans: Vec<Span> = Vec::new();
        for (geometry, content) in tables.contents() {
            let first = spans.last().map_or(geometry, |last| {
                last.indices().end + (geometry - last.geometry - 1)
            });
            spans.push(Span {
                first,
                count: content.count(),
                geometry,
                content: match content {
                    Content::Table(table) => SpanContent::Table(Arc::clone(&table.names().all)),
                    Content::Part { part, .. } => SpanContent::Part(Arc::clone(&part.places)),
                },
            });
        }
        Self(spans)
    }

    /// Each table; `name` returns the name of a geometry of the scene.
    pub(crate) fn tables<'a>(
        &'a self,
        name: impl Fn(usize) -> Option<&'a str>,
    ) -> impl Iterator<Item = TableRows<'a>> {
        self.0.iter().filter_map(move |span| match &span.content {
            SpanContent::Table(columns) => Some(TableRows {
                geometry: span.geometry,
                name: name(span.geometry),
                indices: span.indices(),
                columns,
            }),
            SpanContent::Part(_) => None,
        })
    }

    /// Each part: the index of the geometry that names it, the places in its file, and the indices
    /// of its geometries in the world.
    pub(crate) fn parts(&self) -> impl Iterator<Item = (usize, &Places, Range<usize>)> {
        let spans = self.0.iter();
        spans.filter_map(|span| Some((span.geometry, &**span.part()?, span.indices())))
    }

    /// Returns the part that holds a geometry of the world, and the index of the geometry in it.
    pub(crate) fn part_of(&self, index: usize) -> Option<(&Places, usize)> {
        let span = self.last_from(index)?;
        let part = span.part().filter(|_| span.indices().contains(&index))?;
        Some((part, index - span.first))
    }

    /// The last span that begins at an index of the world or before it.
    fn last_from(&self, index: usize) -> Option<&Span> {
        let before = self.0.partition_point(|span| span.first <= index);
        before.checked_sub(1).and_then(|last| self.0.get(last))
    }

    /// The indices in the world of a geometry of the scene.
    pub(crate) fn indices(&self, geometry: usize) -> Range<usize> {
        let before = self.0.partition_point(|span| span.geometry <= geometry);
        let span = before.checked_sub(1).and_then(|last| self.0.get(last));
        match span {
            None => geometry..geometry + 1,
            Some(span) if span.geometry == geometry => span.indices(),
            Some(span) => {
                let index = span.indices().end + (geometry - span.geometry - 1);
                index..index + 1
            }
        }
    }

    /// The origin of a geometry by its index in the world.
    pub(crate) fn of(&self, index: usize) -> Origin {
        match self.last_from(index) {
            None => Origin {
                geometry: index,
                row: None,
            },
            Some(span) if span.indices().contains(&index) => Origin {
                geometry: span.geometry,
                row: span.part().is_none().then_some(index - span.first),
            },
            Some(span) => Origin {
                geometry: span.geometry + 1 + (index - span.indices().end),
                row: None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{names::Names, scales::Scales};

    #[test]
    fn rows_take_the_place_of_their_table() {
        let span = |first, count, geometry| Span {
            first,
            count,
            geometry,
            content: SpanContent::Table([].into()),
        };
        // Two spheres, a table of three, one of none, a sphere, and a table of one.
        let origins = Origins(vec![span(2, 3, 2), span(5, 0, 3), span(6, 1, 5)]);
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
        let tables = origins.tables(|_| None);
        let tables = tables.map(|table| (table.geometry, table.indices));
        assert!(tables.eq([(2, 2..5), (3, 5..5), (5, 6..7)]));
        let indices: Vec<_> = (0..7).map(|geometry| origins.indices(geometry)).collect();
        assert_eq!(indices, [0..1, 1..2, 2..5, 5..5, 5..6, 6..7, 7..8]);
        assert_eq!(Origins::default().of(7).to_string(), "geometries[7]");
    }

    #[test]
    fn geometries_of_a_part_have_a_place_in_its_file() {
        let part = |file: &str, spans| {
            let names = Names::default();
            let (file, origins) = (file.into(), Origins(spans));
            let scales = Scales::default();
            Arc::new(Places {
                file,
                origins,
                names,
                scales,
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
        let origins = Origins(vec![span(1, 3, 1, tree)]);
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
        assert_eq!((origins.indices(1), origins.indices(2)), (1..4, 4..5));
        assert_eq!(
            (origins.tables(|_| None).count(), origins.parts().count()),
            (0, 1)
        );
    }
}
