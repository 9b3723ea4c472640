//! The names of geometries.

use crate::scene::format::field::Name;

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
