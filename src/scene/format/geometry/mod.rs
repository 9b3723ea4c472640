//! The geometries of a scene file: one file for each kind, with its fields and its construction.

pub(crate) mod plane;
pub(crate) mod sphere;
pub(crate) mod spheres;

pub use self::{plane::PlaneModel, sphere::SphereModel, spheres::SpheresModel};
use std::mem::{self, Discriminant};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{Kind, Name, Value, variants},
    },
    tracer::{error::GeometryError, shape::Shape},
};

/// Something that can be seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Geometry", deny_unknown_fields)]
pub enum GeometryModel {
    /// An infinite plane, seen from both sides.
    Plane(PlaneModel),
    /// A sphere.
    Sphere(SphereModel),
    /// Many spheres from a table, a file beside the scene: one in each row.
    Spheres(SpheresModel),
}

/// The result of building a geometry.
pub(crate) enum Built {
    /// One shape of a color.
    Shape(Shape, ColorModel),
    /// The rows of a table.
    Rows,
}

variants! {
    GeometryModel {
        Plane(PlaneModel),
        Sphere(SphereModel),
        Spheres(SpheresModel),
    }
}

/// Evaluates an expression for each kind of geometry.
macro_rules! of_each {
    ($self:expr, $model:ident => $value:expr) => {
        match $self {
            Self::Plane($model) => $value,
            Self::Sphere($model) => $value,
            Self::Spheres($model) => $value,
        }
    };
}

impl GeometryModel {
    /// Returns its name in the scene.
    pub(crate) fn name(&self) -> Option<&str> {
        of_each!(self, geometry => geometry.name.as_ref().map(|name| &***name))
    }

    /// Builds the geometry, and returns its name.
    #[inline]
    pub(crate) fn build(self) -> (Result<Built, GeometryError>, Option<Name>) {
        match self {
            Self::Plane(plane) => (
                plane.shape().map(|shape| Built::Shape(shape, plane.color)),
                plane.name,
            ),
            Self::Sphere(sphere) => (
                sphere
                    .shape()
                    .map(|shape| Built::Shape(shape, sphere.color)),
                sphere.name,
            ),
            Self::Spheres(table) => (Ok(Built::Rows), table.name),
        }
    }

    /// Returns the shape, if it is a valid one.
    pub(crate) fn shape(&self) -> Option<Shape> {
        match self {
            Self::Plane(plane) => plane.shape().ok(),
            Self::Sphere(sphere) => sphere.shape().ok(),
            Self::Spheres(_) => None,
        }
    }

    /// The largest number of numbers in a variant.
    pub(crate) const NUMBERS: usize = {
        let (mut most, mut variant) = (0, 0);
        while variant < Self::VARIANTS.len() {
            let (mut count, mut field) = (0, 0);
            while field < Self::VARIANTS[variant].1.len() {
                count += match Self::VARIANTS[variant].1[field].1 {
                    Kind::Number | Kind::Positive | Kind::Angle | Kind::Count { .. } => 1,
                    Kind::Point | Kind::Direction => 3,
                    Kind::Color | Kind::Fixed => 0,
                };
                field += 1;
            }
            if count > most {
                most = count;
            }
            variant += 1;
        }
        most
    };

    /// Returns its variant and numbers, whatever its color and name; `None` for a table.
    #[inline]
    pub(crate) fn numbers(&self) -> Option<(Discriminant<Self>, [f64; Self::NUMBERS])> {
        if self.table().is_some() {
            return None;
        }
        let (mut numbers, mut count) = ([0.0; Self::NUMBERS], 0);
        let mut add = |number: f64| {
            if let Some(place) = numbers.get_mut(count) {
                *place = number;
            }
            count += 1;
        };
        self.each(|_, value| match value {
            Value::Number(number) => add(number),
            Value::Vector([x, y, z]) => {
                add(*x);
                add(*y);
                add(*z);
            }
            Value::Color(_) => {}
        });
        Some((mem::discriminant(self), numbers))
    }

    /// The table that it names.
    pub(crate) const fn table(&self) -> Option<&SpheresModel> {
        match self {
            Self::Spheres(table) => Some(table),
            Self::Plane(_) | Self::Sphere(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // A million spheres stay below 80 MB.
    #[test]
    fn geometries_are_small() {
        assert!(size_of::<GeometryModel>() <= 80);
    }
}
