//! The materials of surfaces, one per file.
//!
//! Everything that the rest of the crate needs from a material is a method here, implemented in the
//! file of the material. Its `lobes` say how it sends light.

pub(crate) mod binding;
pub(crate) mod bsdf;
pub(crate) mod emissive;
mod flat;
pub(crate) mod glass;
pub(crate) mod lobes;
mod matte;
pub(crate) mod microfacet;
mod mirror;
pub(crate) mod parameters;
pub(crate) mod phong;
pub(crate) mod principled;
pub(crate) mod rough_glass;
pub(crate) mod texture;

pub use self::{
    binding::{Corners, Interpolation},
    emissive::Emissive,
    glass::Glass,
    phong::Phong,
    principled::Principled,
    texture::{Checkerboard, ImageTexture, Texture, TextureMapping},
};

use std::sync::Arc;

use crate::tracer::{
    color::Color,
    material::{
        lobes::Lobes,
        parameters::{Parameter, Parameters},
    },
};

/// Defines the enum of all materials and the methods that each material implements in its own file.
macro_rules! materials {
    ($($(#[$doc:meta])* $material:ident($content:ty) in $file:ident,)*) => {
        /// A material of a surface.
        ///
        /// A [`Color`] alone is a matte one. In a scene without lights, a geometry shows the material's
        /// [first color](Material::color).
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Material {
            $($(#[$doc])* $material($content)),*
        }

        impl Material {
            /// The name of the kind of material, in lowercase.
            pub const fn kind(&self) -> &'static str {
                match self {
                    $(Self::$material(_) => stringify!($file)),*
                }
            }

            /// The equation of the light that a surface sends. The rays that it sends on have this order.
            pub(crate) const fn equation(&self) -> &'static str {
                match self {
                    $(Self::$material(_) => $file::EQUATION),*
                }
            }

            /// The first color: `diffuse` or `color`.
            pub fn color(&self) -> Color {
                match self {
                    $(Self::$material(material) => material.first()),*
                }
            }

            /// Returns the material with another first color.
            #[must_use]
            pub fn with_color(&self, color: Color) -> Self {
                match self {
                    $(Self::$material(material) => Self::$material(material.with_first(color).into())),*
                }
            }

            /// Returns what a surface does with light.
            #[inline(always)]
            pub(crate) fn lobes(&self) -> Lobes<'_> {
                match self {
                    $(Self::$material(material) => $file::lobes(material)),*
                }
            }

            /// Calls `see` with every parameter, the first color first.
            pub(crate) fn each_parameter(&self, see: impl FnMut(Parameter)) {
                match self {
                    $(Self::$material(material) => material.each(see)),*
                }
            }
        }
    };
}

materials! {
    /// Scatters light evenly to all sides (Lambert).
    Matte(Color) in matte,
    /// Scatters light, with a highlight, and may reflect a part of what is around it.
    Phong(Arc<Phong>) in phong,
    /// A surface of metal, or of a coat above a diffuse one, or a mixture of both.
    Principled(Arc<Principled>) in principled,
    /// Reflects what is around it, times a color.
    Mirror(Color) in mirror,
    /// Reflects and refracts.
    Glass(Arc<Glass>) in glass,
    /// Shows its color in any light.
    Flat(Color) in flat,
    /// Shines, but lights nothing else.
    Emissive(Arc<Emissive>) in emissive,
}

impl Material {
    /// Returns the glass that light goes through, if it does: then the shadow of the geometry is not
    /// black.
    #[inline(always)]
    pub(crate) fn glass(&self) -> Option<&Glass> {
        self.lobes().interface
    }
}

impl Material {
    /// Returns what lights other surfaces, where light follows paths.
    pub(crate) fn lamp(&self) -> Option<&Emissive> {
        match self {
            Self::Emissive(emissive) => Some(emissive),
            Self::Matte(_)
            | Self::Phong(_)
            | Self::Principled(_)
            | Self::Mirror(_)
            | Self::Glass(_)
            | Self::Flat(_) => None,
        }
    }
}

/// Converts materials of several parameters.
macro_rules! from {
    ($($material:ident),*) => {$(
        impl From<$material> for Material {
            fn from(material: $material) -> Self {
                Self::$material(material.into())
            }
        }
    )*};
}

from!(Phong, Principled, Glass, Emissive);

impl From<Color> for Material {
    /// Creates a matte material.
    fn from(color: Color) -> Self {
        Self::Matte(color)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_color_can_be_replaced_alone() {
        let (red, blue) = (Color::new(1.0, 0.0, 0.0), Color::new(0.0, 0.0, 1.0));
        let grey = Color::new(0.5, 0.5, 0.5);
        let materials = [
            Material::Matte(red),
            Material::Mirror(red),
            Material::Flat(red),
            Phong::new(red, grey, 20.0, grey).unwrap().into(),
            Principled::new(red, 0.5, 0.3, 1.5).unwrap().into(),
            Glass::new(red, 1.5).unwrap().into(),
            Emissive::new(red, 3.0).unwrap().into(),
        ];
        for material in materials {
            let other = material.with_color(blue);
            assert_eq!((material.color(), other.color()), (red, blue));
            assert_ne!(other, material);
            assert_eq!(other.with_color(red), material, "all else stays");
        }
    }
}
