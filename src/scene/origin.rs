//! The origin of a world's geometry in its scene.

use std::{fmt, ops::Range, sync::Arc};

use crate::scene::tables::Tables;

/// The origin of a world's geometry in its scene. It is displayed as a path, such as
/// `geometries[3]` or `geometries[3] row 17`.
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

/// The origin of every geometry of a world; only tables shift the indices.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origins(Vec<Span>);

/// The rows of a table.
#[derive(Clone, Debug)]
struct Span {
    /// The index of the first row in the world.
    first: usize,
    rows: usize,
    geometry: usize,
    columns: Arc<[String]>,
}

impl Origins {
    /// Returns the origins for the world of a scene with these tables.
    pub(crate) fn new(tables: &Tables) -> Self {
        let mut spans: Vec<Span> = Vec::new();
        for (geometry, table) in tables.iter() {
            let first = spans.last().map_or(geometry, |last| {
                last.first + last.rows + (geometry - last.geometry - 1)
            });
            spans.push(Span {
                first,
                rows: table.rows(),
                geometry,
                columns: Arc::clone(&table.names().all),
            });
        }
        Self(spans)
    }

    /// Each table; `name` returns the name of a geometry of the scene.
    pub(crate) fn tables<'a>(
        &'a self,
        name: impl Fn(usize) -> Option<&'a str>,
    ) -> impl Iterator<Item = TableRows<'a>> {
        self.0.iter().map(move |span| TableRows {
            geometry: span.geometry,
            name: name(span.geometry),
            indices: span.first..span.first + span.rows,
            columns: &span.columns,
        })
    }

    /// The indices in the world of a geometry of the scene.
    pub(crate) fn indices(&self, geometry: usize) -> Range<usize> {
        let before = self.0.partition_point(|span| span.geometry <= geometry);
        let span = before.checked_sub(1).and_then(|last| self.0.get(last));
        match span {
            None => geometry..geometry + 1,
            Some(span) if span.geometry == geometry => span.first..span.first + span.rows,
            Some(span) => {
                let index = span.first + span.rows + (geometry - span.geometry - 1);
                index..index + 1
            }
        }
    }

    /// The origin of a geometry by its index in the world.
    pub(crate) fn of(&self, index: usize) -> Origin {
        let before = self.0.partition_point(|span| span.first <= index);
        let span = before.checked_sub(1).and_then(|last| self.0.get(last));
        match span {
            None => Origin {
                geometry: index,
                row: None,
            },
            Some(span) if index - span.first < span.rows => Origin {
                geometry: span.geometry,
                row: Some(index - span.first),
            },
            Some(span) => Origin {
                geometry: span.geometry + 1 + (index - span.first - span.rows),
                row: None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_take_the_place_of_their_table() {
        let span = |first, rows, geometry| Span {
            first,
            rows,
            geometry,
            columns: [].into(),
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
}
