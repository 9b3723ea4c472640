//! Copies of a geometry that a scene names, in all the places that it gives them.

use std::sync::Arc;

use crate::{
    scene::format::{
        geometry::{GeometryModel, InstancesModel, nesting::Ordinal, placement::Placement},
        scene::Model,
        transform::TransformModel,
    },
    tracer::{error::GeometryError, geometry::Geometry, shape::Shape, transform::Transform},
};

/// Copies of a geometry.
#[derive(Clone, Debug)]
pub(crate) struct Instances {
    /// The name of the geometry.
    pub(crate) of: Arc<str>,
    /// The geometry, in its own space; `None` if it is empty or invalid.
    geometry: Option<Geometry>,
    transforms: Vec<Result<Arc<Transform>, GeometryError>>,
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
    /// Creates the copies of a geometry in its own space; of nothing if it is `None`.
    pub(crate) fn new(named: &InstancesModel, geometry: Option<Geometry>) -> Self {
        let transforms = named.transforms.iter().map(TransformModel::build);
        Self {
            of: (*named.of).into(),
            geometry,
            transforms: transforms
                .map(|transform| transform.map(Arc::new))
                .collect(),
        }
    }

    /// The number of copies.
    pub(crate) fn count(&self) -> usize {
        match self.geometry {
            Some(_) => self.transforms.len(),
            None => 0,
        }
    }

    /// Returns each copy, placed by what is around all of them.
    pub(crate) fn each(
        &self,
        placement: &Placement,
    ) -> impl Iterator<Item = Result<Geometry, GeometryError>> {
        self.geometry.iter().flat_map(move |geometry| {
            self.transforms.iter().map(move |transform| {
                let transform = transform.as_ref().map_err(GeometryError::clone)?;
                let place = |shape: Shape| placement.place(shape.placed(transform)?);
                geometry.clone().map_shape(place)
            })
        })
    }

    /// Appends all copies.
    ///
    /// # Errors
    ///
    /// A transform that is invalid, or a product that cannot be inverted.
    pub(crate) fn build(
        &self,
        placement: &Placement,
        all: &mut Vec<Geometry>,
    ) -> Result<(), GeometryError> {
        all.reserve(self.count());
        for geometry in self.each(placement) {
            all.push(geometry?);
        }
        Ok(())
    }

    /// Returns true if `is_it` does for any copy. Invalid ones are skipped.
    pub(crate) fn any(
        &self,
        placement: &Placement,
        mut is_it: impl FnMut(&Geometry) -> bool,
    ) -> bool {
        self.each(placement)
            .flatten()
            .any(|geometry| is_it(&geometry))
    }
}
