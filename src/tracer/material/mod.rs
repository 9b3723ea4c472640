//! The materials of surfaces, one per file.
//!
//! A material says what a surface does with light;
//! [`World::radiance`](crate::tracer::world::World::radiance) evaluates it.

pub(crate) mod coating;
pub(crate) mod emissive;
pub(crate) mod glass;
pub(crate) mod phong;

pub use self::{
    coating::{Corners, Interpolation},
    emissive::Emissive,
    glass::Glass,
    phong::Phong,
};

use std::sync::Arc;

use crate::tracer::color::Color;

/// A material of a surface.
///
/// A [`Color`] alone is a matte one. In a scene without lights, a geometry shows the material's
/// [first color](Material::color).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Material {
    /// Scatters light evenly to all sides (Lambert).
    Matte(Color),
    /// Scatters light, with a highlight, and may reflect a part of what is around it.
    Phong(Arc<Phong>),
    /// Reflects what is around it, times a color.
    Mirror(Color),
    /// Reflects and refracts.
    Glass(Arc<Glass>),
    /// Shows its color in any light.
    Flat(Color),
    /// Shines, but lights nothing else.
    Emissive(Arc<Emissive>),
}

impl Material {
    /// The name of the kind of material, in lowercase.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Matte(_) => "matte",
            Self::Phong(_) => "phong",
            Self::Mirror(_) => "mirror",
            Self::Glass(_) => "glass",
            Self::Flat(_) => "flat",
            Self::Emissive(_) => "emissive",
        }
    }

    /// The first color: `diffuse` or `color`.
    pub fn color(&self) -> Color {
        match self {
            Self::Matte(color) | Self::Mirror(color) | Self::Flat(color) => *color,
            Self::Phong(phong) => phong.diffuse,
            Self::Glass(glass) => glass.color,
            Self::Emissive(emissive) => emissive.color,
        }
    }

    /// Returns the material with another first color.
    #[must_use]
    pub fn with_color(&self, color: Color) -> Self {
        match self {
            Self::Matte(_) => Self::Matte(color),
            Self::Mirror(_) => Self::Mirror(color),
            Self::Flat(_) => Self::Flat(color),
            Self::Phong(phong) => Self::from(Phong {
                diffuse: color,
                ..**phong
            }),
            Self::Glass(glass) => Self::from(Glass { color, ..**glass }),
            Self::Emissive(emissive) => Self::from(Emissive {
                color,
                ..**emissive
            }),
        }
    }

    /// Returns true if light goes through: then the shadow of the geometry is not black.
    pub(crate) const fn glass(&self) -> Option<&Arc<Glass>> {
        match self {
            Self::Glass(glass) => Some(glass),
            Self::Matte(_)
            | Self::Phong(_)
            | Self::Mirror(_)
            | Self::Flat(_)
            | Self::Emissive(_) => None,
        }
    }

    /// Calls `see` with every number beyond the first color.
    pub(crate) fn each_number(&self, mut see: impl FnMut(f64)) {
        match self {
            Self::Matte(_) | Self::Mirror(_) | Self::Flat(_) => {}
            Self::Phong(phong) => phong.numbers().into_iter().for_each(see),
            Self::Glass(glass) => see(glass.ior),
            Self::Emissive(emissive) => see(emissive.intensity),
        }
    }
}

impl From<Color> for Material {
    /// Creates a matte material.
    fn from(color: Color) -> Self {
        Self::Matte(color)
    }
}

impl From<Phong> for Material {
    fn from(phong: Phong) -> Self {
        Self::Phong(phong.into())
    }
}

impl From<Glass> for Material {
    fn from(glass: Glass) -> Self {
        Self::Glass(glass.into())
    }
}

impl From<Emissive> for Material {
    fn from(emissive: Emissive) -> Self {
        Self::Emissive(emissive.into())
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
