//! The lights of a scene file: one file for each kind, with its fields and its construction.

pub(crate) mod ambient;
pub(crate) mod directional;
pub(crate) mod headlight;
pub(crate) mod point;
pub(crate) mod spot;

pub use self::{
    ambient::AmbientLightModel, directional::DirectionalLightModel, headlight::HeadlightLightModel,
    point::PointLightModel, spot::SpotLightModel,
};

use glam::DVec3;

use crate::{
    scene::format::variants::{variants, words},
    tracer::{
        error::GeometryError,
        light::{Falloff, Light},
    },
};

variants! {
    /// A light.
    pub enum LightModel = "Light" for of_each {
        /// Light from everywhere; it casts no shadows.
        Ambient(AmbientLightModel) | AmbientLight,
        /// Light from the viewer along every ray, mirrored ones as well; it casts no shadows.
        Headlight(HeadlightLightModel),
        /// Parallel light, as from the sun.
        Directional(DirectionalLightModel) | DirectionalLight | DistantLight | Sun,
        /// Light from a point in all directions.
        Point(PointLightModel) | PointLight,
        /// A cone of light from a point.
        Spot(SpotLightModel) | SpotLight,
    }
}

/// Declares a kind of light: an object with the fields that lights share, behind its own.
macro_rules! light {
    (
        $(#[$($meta:tt)*])* pub struct $model:ident = $name:literal { $($fields:tt)* }
        $(#[$($docs:tt)*])* intensity = $intensity:literal
        $(falloff = $falloff:ident)?
        $(shadows = $shadows:literal)?
        $(one of $one:ident, $other:ident)?
    ) => {
        $crate::scene::format::object::object! {
            $(#[$($meta)*])* pub struct $model = $name {
                $($fields)*
                /// The color; white is the default.
                color: Color = $crate::scene::format::color::ColorModel::WHITE,
                $(#[$($docs)*])*
                intensity | strength ! power ! energy: Intensity = $intensity,
                $(
                    /// The weakening by distance; `InverseSquare` is the default.
                    falloff ! decay: Choice(super::FalloffModel) = super::FalloffModel::$falloff,
                )?
                $(
                    /// True if geometries cast shadows in this light; the default.
                    shadows: Flag = $shadows,
                )?
                /// The name of the light: no other light of the scene has it.
                name: Name?,
            } $(one of $one, $other)?
        }
    };
}

use light;

/// What each kind of light answers in its own file.
trait LightKind {
    /// The light.
    fn build(&self) -> Result<Light, GeometryError>;

    /// Returns the vector to the point that it is directed at, if a point alone directs it and all
    /// numbers are finite.
    fn to_target(&self) -> Option<DVec3> {
        None
    }
}

impl LightModel {
    /// Returns its name in the scene.
    pub(crate) fn name(&self) -> Option<&str> {
        of_each!(self, light => light.name.as_ref().map(|name| &***name))
    }

    /// The light.
    pub(crate) fn build(&self) -> Result<Light, GeometryError> {
        of_each!(self, light => light.build())
    }

    /// Returns the vector to the point that it is directed at, if a point alone directs it and all
    /// numbers are finite.
    pub(crate) fn to_target(&self) -> Option<DVec3> {
        of_each!(self, light => light.to_target())
    }
}

words! {
    /// The weakening of light by distance.
    #[derive(Copy, Default, Eq)]
    pub enum FalloffModel = "Falloff" {
        /// As in nature: a quarter of the light at twice the distance.
        #[default]
        InverseSquare,
        /// No weakening.
        Constant,
    }
}

impl From<FalloffModel> for Falloff {
    fn from(falloff: FalloffModel) -> Self {
        match falloff {
            FalloffModel::InverseSquare => Self::InverseSquare,
            FalloffModel::Constant => Self::Constant,
        }
    }
}
