//! The solids of a scene file combined from others.

use std::{
    iter, slice,
    sync::{Arc, LazyLock},
};

use crate::{
    scene::format::{
        field::Field,
        geometry::{
            GeometryModel,
            group::GroupModel,
            inside::Inside,
            kind::{FIELDS, GeometryKind, geometry},
        },
        material::{MaterialModel, Materials, Surface},
        thing::{Object, OneOf, Thing, Type, Variant},
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

/// The kinds of geometries that are solids: first the simple ones, then those of others.
pub(crate) static SOLIDS: LazyLock<Vec<&str>> = LazyLock::new(|| {
    let is_solid = |variant: &&Variant| variant.object().is_some_and(|object| object.is_solid);
    let solids = GeometryModel::VARIANTS.iter().filter(is_solid);
    solids.map(|variant| variant.name).collect()
});

/// A solid inside of another one.
static SOLID: LazyLock<OneOf> = LazyLock::new(|| {
    static VARIANTS: LazyLock<Vec<Variant>> = LazyLock::new(|| {
        let all = GeometryModel::VARIANTS.iter().copied();
        all.filter(|variant| SOLIDS.contains(&variant.name))
            .map(|variant| match variant.name {
                "Group" => Variant {
                    content: Some(|| Type::Object(&GROUP, true)),
                    ..variant
                },
                _ => variant,
            })
            .collect()
    });
    OneOf {
        name: "Solid",
        docs: "A solid, inside of another one. Its color or material may be that of the solid around \
               it.",
        variants: &VARIANTS,
        are_operands: true,
    }
});

/// A group inside of a solid: it holds solids.
static GROUP: LazyLock<Object> = LazyLock::new(|| {
    static FIELDS: LazyLock<Vec<Field>> = LazyLock::new(|| {
        let fields = GroupModel::FIELDS.iter().copied();
        fields
            .map(|field| match field.name {
                GroupModel::LIST => Field {
                    of_type: || Type::List(solid, 1),
                    ..field
                },
                _ => field,
            })
            .collect()
    });
    Object {
        name: "Group",
        docs: GroupModel::of_type().docs(),
        fields: &FIELDS,
        sets: &[],
        is_solid: true,
    }
});

/// The type of a solid inside of another one.
fn solid() -> Type {
    Type::OneOf(&SOLID)
}

geometry! {
    /// The union of several solids.
    pub struct UnionModel = "Union" {
        /// The solids.
        of: Thing { Type::List(solid, 1) }(Vec<GeometryModel>),
        /// The color of those without their own: a matte surface. Give this or `material`, or neither if
        /// each has its own.
        color: Color?,
        /// The material of those without their own. Give this or `color`, or neither if each has its own.
        material: Thing(Arc<MaterialModel>)?,
    } at most one of color, material
}

geometry! {
    /// The intersection of several solids.
    pub struct IntersectionModel = "Intersection" {
        /// The solids.
        of: Thing { Type::List(solid, 1) }(Vec<GeometryModel>),
        /// The color of those without their own: a matte surface. Give this or `material`, or neither if
        /// each has its own.
        color: Color?,
        /// The material of those without their own. Give this or `color`, or neither if each has its own.
        material: Thing(Arc<MaterialModel>)?,
    } at most one of color, material
}

geometry! {
    /// The difference of a solid and others.
    pub struct DifferenceModel = "Difference" {
        /// The solid that is cut.
        of: Thing { solid() }(Box<GeometryModel>),
        /// The solids that are cut away. A cut shows the color of the solid that made it. Let one stand out of
        /// a face that it opens: if it ends there, rounding may leave specks.
        minus: Thing { Type::List(solid, 1) }(Vec<GeometryModel>),
        /// The color of those without their own: a matte surface. Give this or `material`, or neither if
        /// each has its own.
        color: Color?,
        /// The material of those without their own. Give this or `color`, or neither if each has its own.
        material: Thing(Arc<MaterialModel>)?,
    } at most one of color, material
}

/// Defines what a solid of equal operands tells of itself.
macro_rules! equals {
    ($model:ident, $operation:ident) => {
        impl GeometryKind for $model {
            fn inside(&self) -> [Option<Inside<'_>>; FIELDS] {
                [Some(Inside::list("of", &self.of)), None]
            }

            fn inside_mut(&mut self) -> [&mut [GeometryModel]; FIELDS] {
                [&mut self.of, &mut []]
            }

            fn operation(&self) -> Option<Operation> {
                Some(Operation::$operation)
            }
        }
    };
}

equals!(UnionModel, Union);
equals!(IntersectionModel, Intersection);

impl GeometryKind for DifferenceModel {
    fn inside(&self) -> [Option<Inside<'_>>; FIELDS] {
        let minus = Inside::list("minus", &self.minus);
        [Some(Inside::single("of", &self.of)), Some(minus)]
    }

    fn inside_mut(&mut self) -> [&mut [GeometryModel]; FIELDS] {
        [slice::from_mut(&mut self.of), &mut self.minus]
    }

    fn operation(&self) -> Option<Operation> {
        Some(Operation::Difference)
    }
}

impl GeometryModel {
    /// Returns what is done with the geometries inside, if it is inside of a solid: a group is the union of
    /// its own.
    pub(crate) fn combination(&self) -> Option<Operation> {
        let of_group = || self.group().map(|_| Operation::Union);
        self.operation().or_else(of_group)
    }

    /// Returns the surface of each part of a solid combined from others, in their order:
    /// its own or that of the innermost solid around it that has one. Of any other geometry, its own.
    pub(crate) fn surfaces(&self) -> Vec<Surface<'_>> {
        let mut found = Vec::new();
        self.each_surface(Surface::default(), &mut |surface| found.push(surface));
        found
    }

    /// Calls `see` with each of these.
    pub(crate) fn each_surface<'m>(
        &'m self,
        around: Surface<'m>,
        see: &mut dyn FnMut(Surface<'m>),
    ) {
        let own = self.surface();
        let surface = if own.is_given() { own } else { around };
        if self.combination().is_none() {
            return see(surface);
        }
        let operands = self.inside().flat_map(|inside| inside.geometries);
        operands.for_each(|operand| operand.each_surface(surface, see));
    }

    /// Builds a solid combined from others, with the material of each part.
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
