//! What each kind of geometry tells of itself. Defaults are what holds for most.

use std::sync::Arc;

use crate::{
    data::table::kind::RowKind,
    scene::{
        format::{
            color::ColorModel,
            color_by::ColorByModel,
            geometry::{
                GeometryModel,
                inside::{Inside, combined},
                placement::Placement,
            },
            material::{MaterialModel, Surface},
            texture::TextureModel,
            transform::TransformModel,
        },
        problem::Problem,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, solid::Operation},
    },
};

/// The largest number of fields with geometries.
pub(super) const FIELDS: usize = 2;

/// A kind of geometry.
pub(super) trait GeometryKind {
    /// Returns the shape; `None` for a table, a part, a group, and a mesh whose file is not read.
    #[inline]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let inside = self.inside().into_iter().flatten();
        Some(combined(self.operation()?, inside, &Placement::default()))
    }

    /// Returns the faults between fields that are valid alone.
    #[inline]
    fn faults(&self) -> Vec<Problem> {
        Vec::new()
    }

    /// Calls `see` with each number of the shape that is not the value of a field.
    #[inline]
    fn more_numbers(&self, see: &mut dyn FnMut(f64)) {
        if self.operation().is_some() {
            match self.shape() {
                Some(Ok(shape)) => shape.each_number(see),
                // One that is invalid equals no other.
                _ => see(f64::NAN),
            }
        }
    }

    /// Returns its fields with geometries, in the order of the file.
    #[inline]
    fn inside(&self) -> [Option<Inside<'_>>; FIELDS] {
        [None; FIELDS]
    }

    /// The same geometries, writable.
    #[inline]
    fn inside_mut(&mut self) -> [&mut [GeometryModel]; FIELDS] {
        [&mut [], &mut []]
    }

    /// Returns what is done with the solids inside, if it is put together from some.
    #[inline]
    fn operation(&self) -> Option<Operation> {
        None
    }

    /// The table that it names.
    #[inline]
    fn table(&self) -> Option<TableModel<'_>> {
        None
    }

    /// The copies that it is.
    #[inline]
    fn copies(&self) -> Option<CopiesModel<'_>> {
        None
    }

    /// The words for what it stands for, if that is several geometries of the world.
    fn words(&self) -> Option<SeveralWords> {
        None
    }
}

/// Copies of a geometry, whatever gives them their places.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CopiesModel<'a> {
    /// The name of the geometry.
    pub(crate) of: &'a str,
    /// The place of each, unless the rows of a table give it.
    pub(crate) transforms: Option<&'a [TransformModel]>,
}

/// The words for a geometry that stands for several of the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeveralWords {
    /// The whole, such as `a table`.
    pub(crate) whole: &'static str,
    /// All of them, such as `geometries of this part`.
    pub(crate) all: &'static str,
    /// What one of them is, such as `in this part`.
    pub(crate) one: &'static str,
}

/// The surface of a kind of geometry, if it has one of its own.
pub(super) trait Coat {
    #[inline]
    fn surface(&self) -> Surface<'_> {
        Surface::default()
    }

    #[inline]
    fn material_mut(&mut self) -> Option<&mut Arc<MaterialModel>> {
        None
    }

    #[inline]
    fn texture_mut(&mut self) -> Option<&mut Arc<TextureModel>> {
        None
    }
}

/// Declares a kind of geometry: an object with the fields that all geometries have, behind its own.
macro_rules! geometry {
    (@coat $model:ident $(at most)? one of color $(+ $texture:ident)?, material $($others:tt)*) => {
        const _: () = {
            use $crate::scene::format::{geometry::kind, material};

            impl kind::Coat for $model {
                #[inline]
                fn surface(&self) -> material::Surface<'_> {
                    material::Surface {
                        color: self.color.as_ref(),
                        texture: None$(.or(self.$texture.as_ref()))?,
                        material: self.material.as_ref(),
                    }
                }

                #[inline]
                fn material_mut(&mut self) -> Option<&mut std::sync::Arc<material::MaterialModel>> {
                    self.material.as_mut()
                }

                $(#[inline]
                fn texture_mut(&mut self) -> Option<&mut std::sync::Arc<$crate::scene::format::texture::TextureModel>> {
                    // To ask a rare field for a change takes memory.
                    self.$texture.as_ref()?;
                    self.$texture.as_mut()
                })?
            }
        };
    };
    (@coat $model:ident $($others:tt)*) => {
        impl $crate::scene::format::geometry::kind::Coat for $model {}
    };
    (
        $(#[$($meta:tt)*])* pub struct $model:ident = $name:literal { $($fields:tt)* } $($sets:tt)*
    ) => {
        $crate::scene::format::object::object! {
            $(#[$($meta)*])* pub struct $model = $name {
                $($fields)*
                /// The change of place, direction and size, also of the lights of parts.
                rare transform: Thing(Box<$crate::scene::format::transform::TransformModel>)?,
                /// The name of the geometry: no other geometry of the scene has it.
                name: Name?,
            } $($sets)*
        }

        $crate::scene::format::geometry::kind::geometry!(@coat $model $($sets)*);
    };
}

/// Declares a kind of geometry with one color or material.
macro_rules! colored {
    ($(#[$($meta:tt)*])* pub struct $model:ident = $name:literal { $($fields:tt)* } $($more:tt)*) => {
        $crate::scene::format::geometry::kind::geometry! {
            $(#[$($meta)*])* pub struct $model = $name {
                $($fields)*
                /// The color: a matte surface; with a `texture`, white is the default. Give this or `material`.
                color: Color?,
                /// A texture, which the color is multiplied by. A `material` has its own.
                rare texture: Thing(std::sync::Arc<$crate::scene::format::texture::TextureModel>)?,
                /// The material. Give this or `color`.
                material: Thing(std::sync::Arc<$crate::scene::format::material::MaterialModel>)?,
            } one of color + texture, material $($more)*
        }
    };
}

pub(super) use {colored, geometry};

/// A geometry that names a table, whatever its rows stand for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TableModel<'a> {
    pub(crate) kind: RowKind,
    pub(crate) file: &'a str,
    pub(crate) columns: Option<&'a [Box<str>]>,
    pub(crate) array: Option<&'a str>,
    pub(crate) radius: Option<f64>,
    pub(crate) color: Option<&'a ColorModel>,
    pub(crate) color_by: Option<&'a ColorByModel>,
    pub(crate) texture: Option<&'a TextureModel>,
    pub(crate) material: Option<&'a MaterialModel>,
}
