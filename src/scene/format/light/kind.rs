//! What kinds of lights share.

use glam::DVec3;

use crate::{
    scene::format::variants::words,
    tracer::{
        error::GeometryError,
        light::{Falloff, Light},
    },
};

/// What each kind of light answers in its own file.
pub(super) trait LightKind {
    /// The light.
    fn build(&self) -> Result<Light, GeometryError>;

    /// Returns the field that gives it a size, if it does.
    fn size(&self) -> Option<&'static str> {
        None
    }

    /// Returns the vector to the point that it is directed at, if a point alone directs it and all
    /// numbers are finite.
    fn to_target(&self) -> Option<DVec3> {
        None
    }
}

/// Declares a kind of light: an object with the fields that lights share, behind its own.
macro_rules! light {
    (
        $(#[$($meta:tt)*])* pub struct $model:ident = $name:literal { $($fields:tt)* }
        $(#[$($docs:tt)*])* intensity = $intensity:literal
        $(falloff = $falloff:ident)?
        $(shadows = $shadows:literal)?
        $(one of $one:ident $(, $other:ident)+)?
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
                    falloff ! decay: Choice(super::kind::FalloffModel) = super::kind::FalloffModel::$falloff,
                )?
                $(
                    /// True if geometries cast shadows in this light; the default.
                    shadows: Flag = $shadows,
                )?
                /// The name of the light: no other light of the scene has it.
                name: Name?,
            } $(one of $one $(, $other)+)?
        }
    };
}

pub(super) use light;

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
