//! The lights of a scene, one per file.
//!
//! Everything that the rest of the crate needs from a light is a method here, implemented in the
//! file of the light.
//!
//! A light of intensity 1 gives a white matte surface that faces it the radiance 1, which is white
//! on the screen. In physical units, the irradiance is π times the intensity.

pub(crate) mod ambient;
pub(crate) mod backdrop;
pub(crate) mod directional;
pub(crate) mod environment;
pub(crate) mod falloff;
pub(crate) mod headlight;
pub(crate) mod picture;
pub(crate) mod point;
pub(crate) mod source;
pub(crate) mod spot;
pub(crate) mod transport;

pub use self::{
    ambient::Ambient,
    backdrop::Backdrop,
    directional::Directional,
    environment::{Environment, Sky},
    falloff::Falloff,
    headlight::Headlight,
    picture::SkyPicture,
    point::Point,
    spot::{Cone, Spot},
    transport::{PathOptions, PixelFilter, Transport},
};

pub use crate::tracer::texels::{TexelWrap, Texels};

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    light::{
        falloff::END,
        source::{Glow, LightSize, Source},
    },
    radiance::Radiance,
    transform::Transform,
    vector::{is_direction, unit},
};

/// Defines the enum of all lights and the methods that each light implements in its own file.
macro_rules! lights {
    ($($(#[$doc:meta])* $light:ident = $name:literal,)*) => {
        /// A light.
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Light {
            $($(#[$doc])* $light($light)),*
        }

        impl Light {
            /// The name of the kind of light, in lowercase.
            pub const fn kind(&self) -> &'static str {
                match self {
                    $(Self::$light(_) => $name),*
                }
            }

            /// The color and the intensity.
            pub const fn glow(&self) -> &Glow {
                match self {
                    $(Self::$light(light) => &light.glow),*
                }
            }

            /// Returns true if geometries cast shadows in this light.
            pub const fn shadows(&self) -> bool {
                match self {
                    $(Self::$light(light) => light.shadows()),*
                }
            }

            /// Returns the place that the light comes from.
            #[inline(always)]
            pub(crate) fn source(&self) -> Source {
                match self {
                    $(Self::$light(light) => light.source()),*
                }
            }

            /// Returns the size of the light, where light follows paths.
            pub(crate) fn size(&self) -> LightSize {
                match self {
                    $(Self::$light(light) => light.size()),*
                }
            }

            /// Returns the light mapped by a transform: its position and its direction. Its angle,
            /// its intensity and its falloff stay.
            ///
            /// # Errors
            ///
            /// Returns an error if a number of the mapped light is not valid.
            pub fn placed(&self, transform: &Transform) -> Result<Self, GeometryError> {
                match self {
                    $(Self::$light(light) => light.placed(transform).map(Self::$light)),*
                }
            }

            /// Calls `see` with every number that defines the light, beside its color and intensity.
            pub(crate) fn each_number(&self, see: impl FnMut(f64)) {
                match self {
                    $(Self::$light(light) => light.numbers().into_iter().for_each(see)),*
                }
            }
        }

        $(impl From<$light> for Light {
            fn from(light: $light) -> Self {
                Self::$light(light)
            }
        })*
    };
}

lights! {
    /// Light from everywhere; it casts no shadows.
    Ambient = "ambient",
    /// Light along whatever ray arrives, which is never in shadow.
    Headlight = "headlight",
    /// Light from the surroundings, where light follows paths.
    Environment = "environment",
    /// Parallel light, as from the sun.
    Directional = "directional",
    /// Light from a point in all directions.
    Point = "point",
    /// A cone of light from a point.
    Spot = "spot",
}

impl Light {
    /// Returns the light that arrives at a point of a surface if nothing is in its way; `v` is the
    /// unit vector to the viewer. `None` if none arrives: the light lies on the point, or too far
    /// away for f64.
    pub(crate) fn arriving(&self, point: DVec3, v: DVec3) -> Option<Arriving> {
        let radiance = self.glow().radiance();
        let (l, falloff, cone, ray) = match self.source() {
            Source::Everywhere => {
                let from = None;
                return Some(Arriving { radiance, from });
            }
            Source::Surroundings => return None,
            Source::Viewer => (v, 1.0, 1.0, None),
            Source::Direction(to_light) => {
                (unit(to_light), 1.0, 1.0, Some((to_light, f64::INFINITY)))
            }
            Source::Point {
                position,
                falloff,
                cone,
            } => {
                let to_light = position - point;
                let l = is_direction(to_light).then(|| unit(to_light))?;
                let cone = cone.map_or(1.0, |cone| cone.at(l));
                (l, falloff.at(to_light), cone, Some((to_light, END)))
            }
        };
        let ray = ray.filter(|_| self.shadows());
        let shadow = ray.map(|(direction, t_max)| ShadowRay { direction, t_max });
        Some(Arriving {
            radiance: radiance * (falloff * cone),
            from: Some(Incidence {
                l,
                falloff,
                cone,
                shadow,
            }),
        })
    }
}

/// Light that arrives at a point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arriving {
    /// The light before shadows: `(falloff · cone) · (intensity · lin(color))`.
    pub radiance: Radiance,
    /// The direction that it comes from, unless that is every direction.
    pub from: Option<Incidence>,
}

/// The direction that light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incidence {
    /// The unit vector to the light.
    pub l: DVec3,
    /// The weakening by distance, 1 if there is none.
    pub falloff: f64,
    /// The part that the cone of a spot lets through, 1 if there is no cone.
    pub cone: f64,
    /// The ray on which other geometries cast a shadow; `None` if the light casts none.
    pub shadow: Option<ShadowRay>,
}

/// A ray from a surface to a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowRay {
    /// The direction, which is not normalized.
    pub direction: DVec3,
    /// The upper bound of the `t` of geometries that cast a shadow.
    pub t_max: f64,
}
