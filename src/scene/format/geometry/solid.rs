//! The solids of a scene file that are put together from others.

use std::{iter, slice, sync::Arc};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{Name, fields, rules},
        geometry::GeometryModel,
        material::{MaterialModel, Materials, Surface},
    },
    tracer::{
        error::GeometryError,
        geometry::Geometry,
        shape::{
            Shape,
            solid::{Operation, Solid},
        },
    },
};

/// All points that are in some of several solids.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Union", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct UnionModel {
    /// The solids.
    #[schemars(length(min = 1))]
    pub of: Vec<GeometryModel>,
    /// The color of those without their own: a matte surface. Give this or `material`, or neither if
    /// each has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<ColorModel>,
    /// The material of those without their own. Give this or `color`, or neither if each has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Arc<MaterialModel>>,
    /// The name of the geometry: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

/// The points that are in all of several solids.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Intersection", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct IntersectionModel {
    /// The solids.
    #[schemars(length(min = 1))]
    pub of: Vec<GeometryModel>,
    /// The color of those without their own: a matte surface. Give this or `material`, or neither if
    /// each has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<ColorModel>,
    /// The material of those without their own. Give this or `color`, or neither if each has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Arc<MaterialModel>>,
    /// The name of the geometry: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

/// What is left of a solid from which others are cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Difference", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct DifferenceModel {
    /// The solid that is cut.
    pub of: Box<GeometryModel>,
    /// The solids that are cut away. A cut shows the color of the solid that made it.
    #[schemars(length(min = 1))]
    pub minus: Vec<GeometryModel>,
    /// The color of those without their own: a matte surface. Give this or `material`, or neither if
    /// each has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<ColorModel>,
    /// The material of those without their own. Give this or `color`, or neither if each has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Arc<MaterialModel>>,
    /// The name of the geometry: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

fields! {
    UnionModel {
        color: Color,
    } fixed {
        of,
        material,
        name,
    }
}

fields! {
    IntersectionModel {
        color: Color,
    } fixed {
        of,
        material,
        name,
    }
}

fields! {
    DifferenceModel {
        color: Color,
    } fixed {
        of,
        minus,
        material,
        name,
    }
}

/// What is done with solids.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Combined<'m> {
    operation: Operation,
    /// The list that `of` is, or a list of the only one.
    of: &'m [GeometryModel],
    minus: &'m [GeometryModel],
}

impl<'m> Combined<'m> {
    fn operands(self) -> impl Iterator<Item = &'m GeometryModel> {
        self.of.iter().chain(self.minus)
    }
}

impl GeometryModel {
    /// Returns what is done with the solids inside, if it is put together from some.
    #[inline]
    pub(crate) fn combined(&self) -> Option<Combined<'_>> {
        let (operation, of, minus) = match self {
            Self::Union(union) => (Operation::Union, &*union.of, &[][..]),
            Self::Intersection(these) => (Operation::Intersection, &*these.of, &[][..]),
            Self::Difference(rest) => {
                let of = slice::from_ref(&*rest.of);
                (Operation::Difference, of, &*rest.minus)
            }
            Self::Plane(_)
            | Self::Sphere(_)
            | Self::Disc(_)
            | Self::Rectangle(_)
            | Self::Triangle(_)
            | Self::Box(_)
            | Self::Cylinder(_)
            | Self::Cone(_)
            | Self::Capsule(_)
            | Self::Ellipsoid(_)
            | Self::Mesh(_)
            | Self::Spheres(_)
            | Self::Cylinders(_)
            | Self::Part(_)
            | Self::Group(_)
            | Self::Instances(_) => return None,
        };
        Some(Combined {
            operation,
            of,
            minus,
        })
    }

    /// Returns the shape of a solid that is put together from others.
    #[inline(never)]
    pub(super) fn solid(&self) -> Option<Result<Shape, GeometryError>> {
        let combined = self.combined()?;
        let shapes = combined.operands().map(|operand| {
            let refused = || Err(GeometryError::NotSolid { kind: "geometry" });
            operand.any_shape().unwrap_or_else(refused)
        });
        let shapes = shapes.collect::<Result<Vec<_>, _>>();
        let solid = shapes.and_then(|shapes| Solid::new(combined.operation, shapes));
        Some(solid.map(Shape::from))
    }

    /// Returns the surface of each part of a solid that is put together from others, in their order:
    /// its own or that of the innermost solid around it that has one. Of any other geometry, its own.
    pub(crate) fn surfaces(&self) -> Vec<Surface<'_>> {
        let mut found = Vec::new();
        let nothing = Surface {
            color: None,
            material: None,
        };
        self.each_surface(nothing, &mut |surface| found.push(surface));
        found
    }

    fn each_surface<'m>(&'m self, around: Surface<'m>, see: &mut dyn FnMut(Surface<'m>)) {
        let own = self.surface();
        let surface = if own.is_given() { own } else { around };
        match self.combined() {
            None => see(surface),
            Some(combined) => {
                let operands = combined.operands();
                operands.for_each(|operand| operand.each_surface(surface, see));
            }
        }
    }

    /// Builds a solid that is put together from others, with the material of each part.
    pub(super) fn build_solid(
        &self,
        shape: Shape,
        materials: &Materials,
    ) -> Result<Geometry, GeometryError> {
        let parts = self
            .surfaces()
            .into_iter()
            .map(|surface| materials.build(surface));
        let parts = parts.collect::<Result<Vec<_>, _>>()?;
        let Some(first) = parts.first().cloned() else {
            return Err(GeometryError::NoOperand);
        };
        let faces = Solid::FACES_OF_PART as usize;
        let of_faces = parts
            .into_iter()
            .flat_map(|part| iter::repeat_n(part, faces));
        Ok(Geometry::new(shape, first).by_face(of_faces))
    }
}
