//! Geometries in the fields of another: their fields, their numbers and their paths.

use std::{slice, sync::LazyLock};

use crate::{
    diagnostic::path::Step,
    scene::format::{
        geometry::{GeometryModel, placement::Placement},
        thing::{Thing, Type, Variant},
    },
    tracer::{
        error::GeometryError,
        shape::{
            Shape,
            solid::{Operation, Solid},
        },
    },
};

/// The geometries in a field of another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inside<'m> {
    pub(crate) field: &'static str,
    pub(crate) geometries: &'m [GeometryModel],
    /// True for a list, whose elements have an index; false for a field that is a geometry itself.
    pub(crate) is_list: bool,
}

impl<'m> Inside<'m> {
    /// The geometries of a list.
    pub(super) const fn list(field: &'static str, geometries: &'m [GeometryModel]) -> Self {
        Self {
            field,
            geometries,
            is_list: true,
        }
    }

    /// The geometry that a field is.
    pub(super) const fn single(field: &'static str, geometry: &'m GeometryModel) -> Self {
        Self {
            field,
            geometries: slice::from_ref(geometry),
            is_list: false,
        }
    }

    /// The steps from the geometry around it to one of those in the field.
    pub(super) fn steps(&self, index: usize) -> impl Iterator<Item = Step> + use<> {
        let index = self.is_list.then_some(Step::Index(index));
        [Step::Field(self.field.into())].into_iter().chain(index)
    }
}

/// The names of fields with geometries, in any geometry.
pub(crate) static FIELD_NAMES: LazyLock<Vec<&str>> = LazyLock::new(|| {
    let is_geometry = |variant: &Variant| {
        let mut all = GeometryModel::VARIANTS.iter();
        all.any(|geometry| geometry.name == variant.name)
    };
    let fields = GeometryModel::of_type().fields();
    let fields = fields.filter(|field| match (field.of_type)().innermost() {
        Type::OneOf(one_of) => one_of.variants.iter().all(is_geometry),
        _ => false,
    });
    let mut names: Vec<_> = fields.map(|field| field.name).collect();
    names.dedup();
    names
});

impl GeometryModel {
    /// Returns the number of geometries that it is: itself and all inside of it.
    pub(crate) fn total(&self) -> usize {
        let inside = self.inside().flat_map(|inside| inside.geometries);
        1 + inside.map(Self::total).sum::<usize>()
    }

    /// Returns true if `is_it` does for this geometry or any inside of it.
    pub(crate) fn any_inside(&self, is_it: &impl Fn(&Self) -> bool) -> bool {
        let mut inside = self.inside().flat_map(|inside| inside.geometries);
        is_it(self) || inside.any(|geometry| geometry.any_inside(is_it))
    }

    /// Returns the geometries in its fields, in the order of the file.
    pub(crate) fn children(&self) -> impl Iterator<Item = Child<'_>> {
        let mut end = 1;
        let fields = self.inside().enumerate();
        let all = fields.flat_map(|(place, inside)| {
            let geometries = inside.geometries.iter().enumerate();
            geometries.map(move |(index, geometry)| (place, inside, index, geometry))
        });
        all.map(move |(place, inside, index, geometry)| {
            let number = end;
            end += geometry.total();
            Child {
                place,
                inside,
                index,
                geometry,
                number,
                end,
            }
        })
    }

    /// Returns the geometries that lead to one inside of this one, by its number, which is the last.
    pub(super) fn line(&self, mut number: usize) -> Option<Vec<Child<'_>>> {
        let mut line: Vec<Child> = Vec::new();
        while number > 0 {
            let around = line.last().map_or(self, |child| child.geometry);
            let child = around.children().find(|child| number < child.end)?;
            number -= child.number;
            line.push(child);
        }
        Some(line)
    }
}

/// A geometry in a field of another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Child<'m> {
    /// The number of the field.
    pub(super) place: usize,
    pub(crate) inside: Inside<'m>,
    /// The index in the field.
    pub(crate) index: usize,
    pub(crate) geometry: &'m GeometryModel,
    /// Its number among the geometries inside of the other.
    pub(crate) number: usize,
    /// The number behind those inside of it.
    end: usize,
}

impl Child<'_> {
    /// Returns the number of the steps that lead to it, if these do.
    pub(super) fn is_on(&self, steps: &[Step]) -> Option<usize> {
        let count = match (self.inside.is_list, steps.get(1)) {
            (false, _) => 1,
            (true, Some(Step::Index(index))) if *index == self.index => 2,
            (true, _) => return None,
        };
        (steps.first()?.name() == Some(self.inside.field)).then_some(count)
    }
}

/// Returns the shape of a solid combined from those inside of it, each of which is mapped by its own
/// transform and by those around it.
#[inline(never)]
pub(super) fn combined<'a>(
    operation: Operation,
    inside: impl IntoIterator<Item = Inside<'a>>,
    around: &Placement,
) -> Result<Shape, GeometryError> {
    let operands = inside.into_iter().flat_map(|inside| inside.geometries);
    let shapes = operands.map(|operand| {
        let placement = around.within(operand.transform());
        if let Some(operation) = operand.combination() {
            return combined(operation, operand.inside(), &placement);
        }
        let refused = || Err(GeometryError::NotSolid { kind: "geometry" });
        placement.place(operand.any_shape().unwrap_or_else(refused)?)
    });
    let shapes = shapes.collect::<Result<Vec<_>, _>>()?;
    Solid::new(operation, shapes).map(Shape::from)
}
