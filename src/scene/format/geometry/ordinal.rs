//! The numbers of geometries in a scene, and the geometries and paths of these numbers.

use std::ops::RangeInclusive;

use crate::{
    diagnostic::path::{Path, Step},
    scene::format::{geometry::GeometryModel, scene::Model, transform::TransformModel},
};

/// The number of a geometry in a scene. Ascending numbers are in the order of the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Ordinal {
    /// The index in the scene's list of the geometry that it is or is in.
    pub(crate) index: usize,
    /// Its number among the geometries inside of that one, depth-first from 1; 0 for that one itself.
    pub(crate) inner: usize,
}

impl From<usize> for Ordinal {
    fn from(index: usize) -> Self {
        Self { index, inner: 0 }
    }
}

impl Ordinal {
    /// Returns the number of a geometry inside of this one, by its number there.
    pub(crate) const fn inside(self, number: usize) -> Self {
        Self {
            inner: self.inner + number,
            ..self
        }
    }
}

impl GeometryModel {
    /// Returns the numbers of the geometry and of those inside of it, given its own.
    pub(crate) fn span(&self, at: Ordinal) -> RangeInclusive<Ordinal> {
        at..=at.inside(self.total() - 1)
    }

    /// Returns true if the number of the geometry, or of one inside of it, is among some in ascending
    /// order.
    pub(crate) fn is_among(&self, at: Ordinal, numbers: &[Ordinal]) -> bool {
        let next = numbers.get(numbers.partition_point(|number| *number < at));
        next.is_some_and(|next| self.span(at).contains(next))
    }
}

impl Model {
    /// Returns the meshes that are in files of their own.
    pub(crate) fn meshes_in_files(&self) -> Vec<Ordinal> {
        let all = self.walk();
        let all = all.filter(|(_, geometry)| geometry.mesh_file().is_some());
        all.map(|(at, _)| at).collect()
    }

    /// Drops the meshes that were read from files, and returns their number.
    pub(crate) fn forget_meshes(&mut self) -> usize {
        let mut forgotten = 0;
        for at in self.meshes_in_files() {
            let file = self.geometry_mut(at).and_then(GeometryModel::mesh_file_mut);
            forgotten += usize::from(file.is_some_and(|file| file.mesh.take().is_some()));
        }
        forgotten
    }

    /// Returns true if a geometry is one of those that a solid consists of.
    pub(crate) fn is_operand(&self, at: Ordinal) -> bool {
        let whole = self.geometries.get(at.index).filter(|_| at.inner > 0);
        let mut line = whole
            .and_then(|whole| whole.line(at.inner))
            .into_iter()
            .flatten();
        line.any(|child| child.inside.field != Self::LONG)
    }

    /// Returns a geometry by its number.
    pub(crate) fn geometry(&self, at: Ordinal) -> Option<&GeometryModel> {
        let whole = self.geometries.get(at.index)?;
        if at.inner == 0 {
            return Some(whole);
        }
        Some(whole.line(at.inner)?.pop()?.geometry)
    }

    /// Returns a geometry by its number, writable.
    pub(crate) fn geometry_mut(&mut self, at: Ordinal) -> Option<&mut GeometryModel> {
        let mut found = self.geometries.get_mut(at.index)?;
        if at.inner == 0 {
            return Some(found);
        }
        let line = found.line(at.inner)?.into_iter();
        for (place, index) in line
            .map(|child| (child.place, child.index))
            .collect::<Vec<_>>()
        {
            found = found.inside_mut().nth(place)?.get_mut(index)?;
        }
        Some(found)
    }

    /// Returns true if a geometry is inside of another.
    pub(crate) fn holds(&self, around: Ordinal, at: Ordinal) -> bool {
        let is_in = |geometry: &GeometryModel| geometry.span(around).contains(&at);
        around.index == at.index && around < at && self.geometry(around).is_some_and(is_in)
    }

    /// Returns the path of a geometry.
    pub(crate) fn path_of(&self, at: Ordinal) -> Path {
        let path = Path::ROOT.field(Self::LONG).index(at.index);
        let whole = self.geometries.get(at.index).filter(|_| at.inner > 0);
        let line = whole.and_then(|whole| whole.line(at.inner));
        let steps = line.into_iter().flatten();
        let steps = steps.flat_map(|child| child.inside.steps(child.index));
        path.join(&steps.collect::<Vec<_>>())
    }

    /// Returns the transforms of a geometry and of those around it, from outermost to innermost.
    pub(crate) fn transforms(&self, at: Ordinal) -> Vec<&TransformModel> {
        let Some(whole) = self.geometries.get(at.index) else {
            return Vec::new();
        };
        let line = whole.line(at.inner).into_iter().flatten();
        let all = [whole].into_iter().chain(line.map(|child| child.geometry));
        all.filter_map(GeometryModel::transform).collect()
    }

    /// Returns the innermost geometry on a path, and the number of steps that lead to it; `None` if
    /// the path leads elsewhere.
    pub(crate) fn geometry_on(&self, path: &[Step]) -> Option<(Ordinal, usize)> {
        let [list, Step::Index(index), ..] = path else {
            return None;
        };
        if list.name() != Some(Self::LONG) {
            return None;
        }
        let (mut at, mut steps) = (Ordinal::from(*index), 2);
        let mut around = self.geometries.get(*index)?;
        while let Some((more, child)) = around.children().find_map(|child| {
            let more = child.is_on(path.get(steps..)?)?;
            Some((more, child))
        }) {
            at.inner += child.number;
            steps += more;
            around = child.geometry;
        }
        Some((at, steps))
    }
}
