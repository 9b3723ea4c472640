//! Copies of a geometry that a scene names, in all the places that it gives them.

use std::sync::Arc;

use crate::{
    scene::format::{
        geometry::{GeometryModel, InstancesModel, nesting::Ordinal, placement::Placement},
        scene::Model,
    },
    tracer::{error::GeometryError, geometry::Geometry, shape::instances::Rows},
};

/// Copies of a geometry.
#[derive(Clone, Debug)]
pub(crate) struct Instances {
    /// The name of the geometry.
    pub(crate) of: Arc<str>,
    /// The names of the columns, if the transforms are the rows of a table.
    pub(crate) columns: Option<Arc<[String]>>,
    rows: Arc<Vec<Rows>>,
    /// All copies, not placed by what is around them; `None` if what they are copies of is empty or
    /// invalid, or if there are none.
    all: Option<Geometry>,
}

/// The reason why a name is not that of a geometry that can be copied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Refused {
    /// No geometry has the name.
    Unknown,
    /// The geometry holds the copies themselves.
    Itself(Ordinal),
    /// The geometry is a list of copies, or holds one.
    Instances(Ordinal),
    /// The geometry is an operand of a solid.
    Operand(Ordinal),
}

impl Model {
    /// Returns the geometry with a name, if the geometry at `at` may hold copies of it.
    pub(crate) fn copied(&self, name: &str, at: Ordinal) -> Result<Ordinal, Refused> {
        let mut all = self.walk();
        let found = all.find(|(_, geometry)| geometry.name() == Some(name));
        let (of, geometry) = found.ok_or(Refused::Unknown)?;
        if of == at || self.holds(of, at) {
            return Err(Refused::Itself(of));
        }
        if geometry.any_inside(&|inside| matches!(inside, GeometryModel::Instances(_))) {
            return Err(Refused::Instances(of));
        }
        match self.is_operand(of) {
            true => Err(Refused::Operand(of)),
            false => Ok(of),
        }
    }

    /// Returns the copies that a geometry is, with the number of what they are copies of.
    pub(crate) fn instances(&self) -> impl Iterator<Item = (Ordinal, Ordinal)> {
        self.walk().filter_map(|(at, geometry)| match geometry {
            GeometryModel::Instances(named) => Some((at, self.copied(&named.of, at).ok()?)),
            _ => None,
        })
    }
}

impl Instances {
    /// Creates copies of a prototype, in its own space, from the rows of transforms.
    pub(crate) fn new(
        named: &InstancesModel,
        prototype: &[Geometry],
        columns: Option<Arc<[String]>>,
        rows: Arc<Vec<Rows>>,
    ) -> Self {
        Self {
            of: (*named.of).into(),
            columns,
            // What is invalid has its own diagnostics.
            all: Geometry::copies_at(prototype, Arc::clone(&rows)).ok(),
            rows,
        }
    }

    /// The rows of all transforms.
    pub(crate) const fn rows(&self) -> &Arc<Vec<Rows>> {
        &self.rows
    }

    /// The number of copies.
    pub(crate) fn count(&self) -> usize {
        self.all.as_ref().map_or(0, Geometry::count)
    }

    /// Returns all copies, placed by what is around them; `None` if there are none.
    ///
    /// # Errors
    ///
    /// A product of transforms that cannot be inverted.
    pub(crate) fn placed(&self, placement: &Placement) -> Option<Result<Geometry, GeometryError>> {
        let all = self.all.clone()?;
        Some(all.map_shape(|shape| placement.place(shape)))
    }
}

/// Returns the rows of transforms that are written in a scene; none of one that is invalid.
pub(crate) fn written(named: &InstancesModel) -> Arc<Vec<Rows>> {
    let all = named.transforms.iter().flatten();
    let all = all.filter_map(|transform| Some(transform.build().ok()?.rows()));
    all.collect::<Vec<_>>().into()
}
