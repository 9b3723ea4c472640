//! The origin of a world's geometry in its scene.

use std::{fmt, ops::Range, str::FromStr};

use serde::Serialize;

use crate::{
    diagnostic::{
        Code, Diagnostic,
        error::Error,
        path::{Path, Step},
    },
    scene::{format::scene::Model, path},
};

/// The origin of a world's geometry in its scene. It is displayed as a path, such as
/// `geometries[3]`, `geometries[3].geometries[0]` in a group, or `geometries[3] row 17`. A geometry
/// of a part has the origin of the part.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Origin {
    /// The index in the scene's list of geometries, from 0.
    pub geometry: usize,
    /// For a geometry in groups, its index in the list of each group, from the outermost; the group
    /// at `geometry` is the first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub in_groups: Vec<usize>,
    /// The row of the table that this geometry names, from 0.
    pub row: Option<usize>,
    /// The instance among those that this geometry is, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instance: Option<usize>,
}

impl Origin {
    /// Returns the origin of a geometry in the scene's list.
    pub(crate) fn of(geometry: usize) -> Self {
        Self {
            geometry,
            ..Self::default()
        }
    }

    /// Returns the origin of a geometry in the group that this is.
    pub(crate) fn inside(&self, index: usize) -> Self {
        let mut inside = self.clone();
        inside.in_groups.push(index);
        inside
    }

    /// Returns the path of the geometry in the scene.
    pub fn path(&self) -> Path {
        let first = Path::ROOT.field(Model::LONG).index(self.geometry);
        let inner = self.in_groups.iter();
        inner.fold(first, |path, index| path.field(Model::LONG).index(*index))
    }

    /// Returns the place of the innermost geometry of a list that a path leads to or into.
    pub(crate) fn around(path: &Path) -> Option<Self> {
        let mut steps = path.steps();
        let mut indices = Vec::new();
        while let [list, Step::Index(index), rest @ ..] = steps {
            if list.name() != Some(Model::LONG) {
                break;
            }
            indices.push(*index);
            steps = rest;
        }
        let geometry = *indices.first()?;
        indices.remove(0);
        Some(Self {
            geometry,
            in_groups: indices,
            ..Self::default()
        })
    }
}

impl FromStr for Origin {
    type Err = Error;

    /// Reads a path, such as `geometries[3].geometries[0]`, or one with a row, such as
    /// `geometries[3] row 17`.
    fn from_str(text: &str) -> Result<Self, Error> {
        let (place, row) = match text.rsplit_once(" row ") {
            Some((place, row)) => (place, row.parse().map(Some)),
            None => (text, Ok(None)),
        };
        let steps = path::parts(place).unwrap_or_default().into_iter();
        let steps: Vec<_> = steps.map(|part| part.step).collect();
        let found = Self::around(&Path::from(&steps[..]));
        let found = found.filter(|found| found.path().steps().len() == steps.len());
        let found = found
            .zip(row.ok())
            .map(|(found, row)| Self { row, ..found });
        found.ok_or_else(|| {
            let message = "not a geometry, expected a path such as `geometries[3]`";
            Error::usage(Diagnostic::new(Code::UnknownPath, 0..text.len(), message))
        })
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "geometries[{}]", self.geometry)?;
        for index in &self.in_groups {
            write!(f, ".geometries[{index}]")?;
        }
        self.row.map_or(Ok(()), |row| write!(f, " row {row}"))?;
        let instance = self.instance;
        instance.map_or(Ok(()), |instance| write!(f, " instance {instance}"))
    }
}

/// A geometry of a scene that stands for several of the world: a table, a part or copies.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Container<'a> {
    /// The place in the scene.
    pub origin: Origin,
    /// The name in the scene.
    pub name: Option<&'a str>,
    /// The indices of its geometries in the world.
    pub indices: Range<usize>,
    /// What it holds.
    pub content: Contained<'a>,
}

/// What a [`Container`] holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contained<'a> {
    /// The rows of a table with these columns, also those that are not used.
    Rows(&'a [String]),
    /// The geometries of a part, whose file has this path from the current folder.
    Part(&'a str),
    /// Copies of another geometry.
    Copies {
        /// The name of the geometry.
        of: &'a str,
        /// The names of the columns if the copies are the rows of a table, also of those that are not
        /// used.
        columns: Option<&'a [String]>,
    },
}
