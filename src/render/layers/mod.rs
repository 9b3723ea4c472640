//! The layers of a picture, and their conversion to the rows of a file.

pub(crate) mod layout;
mod number;
pub(crate) mod rows;
#[cfg(test)]
mod tests;

use crate::{diagnostic::named::named, film::parts::LightParts, render::layers::number::Light};

named! {
    /// A quantity that a picture shows for each pixel.
    ///
    /// Color, direct, specular, albedo, coverage and error combine all samples of a pixel; the other layers
    /// show the hit of the ray through its center.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
    #[non_exhaustive]
    pub enum Layer {
        /// Red, green and blue.
        Color = "color",
        /// The distance along the ray; infinite for a miss.
        Depth = "depth",
        /// The distance along the view axis; infinite for a miss.
        Z = "z",
        /// The hit point in world space; 0 for a miss.
        Position = "position",
        /// The unit normal at that point in world space: outward for a closed shape, along `normal`
        /// for a flat one; 0 for a miss.
        Normal = "normal",
        /// The index of the geometry in the world, in file order; the rows of a table take the
        /// position of the table. 4294967295 for a miss.
        Id = "id",
        /// The fraction of the samples that hit something, in 0..1.
        Coverage = "coverage",
        /// The linear light of the first color of the material, whatever the lights; 0 where nothing
        /// is hit.
        Albedo = "albedo",
        /// The linear light that surfaces scatter and send themselves, and the background. In a flat
        /// picture it is all light.
        Direct = "direct",
        /// The linear light that mirrors and glass show: color is direct + specular. In a flat
        /// picture there is none.
        Specular = "specular",
        /// The standard error of the color, in linear light, where light follows paths: the mean
        /// is mostly nearer than this to that of very many samples. Infinite with one sample.
        Error = "error",
        /// The number of paths, where light follows paths.
        Samples = "samples",
    }
}

impl Layer {
    /// Returns the light that the layer shows, if it shows any.
    fn light(self) -> Option<Light> {
        match self {
            Self::Color => Some(Light::All),
            Self::Albedo => Some(Light::Albedo),
            Self::Error => Some(Light::Error),
            part => {
                let part = LightParts::NAMES
                    .iter()
                    .position(|name| *name == part.name());
                part.map(Light::Part)
            }
        }
    }
}
