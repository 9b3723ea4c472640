//! Copies of a geometry that a scene names, in all the places that it gives them.

use std::{collections::HashMap, sync::Arc};

use crate::{
    scene::format::{
        geometry::{GeometryModel, kind::CopiesModel, ordinal::Ordinal, placement::Placement},
        scene::Model,
    },
    tracer::{
        error::GeometryError,
        geometry::Geometry,
        shape::{Shape, instances::Rows},
    },
};

/// Copies of a geometry.
#[derive(Clone, Debug)]
pub(crate) struct PlacedCopies {
    /// The name of the geometry.
    pub(crate) of: Arc<str>,
    rows: Arc<Vec<Rows>>,
    /// All copies, not placed by what is around them; `None` if what they are copies of is empty or
    /// invalid, or if there are none.
    all: Option<Geometry>,
}

/// The largest number of copies that are shapes for themselves, each of some hundred bytes.
const MOST_APART: usize = 1 << 18;

/// The reason why a name is not that of a geometry that can be copied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Refused {
    /// No geometry has the name.
    Unknown,
    /// The geometry holds the copies themselves.
    Itself(Ordinal),
    /// The geometry is a list of copies, or holds one.
    Copies(Ordinal),
    /// The geometry is an operand of a solid.
    Operand(Ordinal),
}

/// What copies may be of, by name. Many lists may be copies of one.
pub(crate) struct Prototypes<'m> {
    model: &'m Model,
    names: HashMap<&'m str, Ordinal>,
    known: HashMap<&'m str, Result<Ordinal, Refused>>,
}

impl<'m> Prototypes<'m> {
    /// Creates the prototypes of a scene.
    pub(crate) fn new(model: &'m Model) -> Self {
        let mut names = HashMap::new();
        for (at, geometry) in model.walk() {
            if let Some(name) = geometry.name() {
                names.entry(name).or_insert(at);
            }
        }
        Self {
            model,
            names,
            known: HashMap::new(),
        }
    }

    /// Returns the geometry with a name, if the geometry at `at` may hold copies of it.
    pub(crate) fn of(&mut self, name: &'m str, at: Ordinal) -> Result<Ordinal, Refused> {
        let Self {
            model,
            names,
            known,
        } = self;
        let found = *known.entry(name).or_insert_with(|| {
            let of = *names.get(name).ok_or(Refused::Unknown)?;
            let is_list = |inside: &GeometryModel| inside.copies().is_some();
            if model.geometry(of).is_some_and(|of| of.any_inside(&is_list)) {
                return Err(Refused::Copies(of));
            }
            match model.is_operand(of) {
                true => Err(Refused::Operand(of)),
                false => Ok(of),
            }
        });
        match found {
            Err(Refused::Copies(of)) if of == at || model.holds(of, at) => Err(Refused::Itself(of)),
            found => found,
        }
    }
}

impl Model {
    /// Returns each list of copies.
    pub(crate) fn copies(&self) -> impl Iterator<Item = (Ordinal, CopiesModel<'_>)> {
        self.walk()
            .filter_map(|(at, geometry)| Some((at, geometry.copies()?)))
    }
}

impl PlacedCopies {
    /// Creates copies of a prototype, in its own space, from the rows of transforms.
    pub(crate) fn new(named: CopiesModel, prototype: &[Geometry], rows: Arc<Vec<Rows>>) -> Self {
        Self {
            of: named.of.into(),
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

    /// Returns true if each copy can be a shape for itself.
    pub(crate) fn are_few(&self) -> bool {
        self.count() <= MOST_APART
    }

    /// Returns each copy as a shape for itself.
    pub(crate) fn each(&self) -> impl Iterator<Item = Shape> {
        let all = self.all.as_ref().and_then(|all| all.shape().copies());
        all.into_iter().flat_map(|all| all.each())
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
pub(crate) fn written(named: CopiesModel) -> Arc<Vec<Rows>> {
    let all = named.transforms.into_iter().flatten();
    let all = all.filter_map(|transform| Some(transform.build().ok()?.rows()));
    all.collect::<Vec<_>>().into()
}
