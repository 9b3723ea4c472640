//! The lights of a scene file: one file for each kind, with its fields and its construction.

pub(crate) mod ambient;
pub(crate) mod directional;
pub(crate) mod environment;
pub(crate) mod headlight;
mod kind;
pub(crate) mod point;
pub(crate) mod spot;

pub use self::{
    ambient::AmbientLightModel,
    directional::DirectionalLightModel,
    environment::{EnvironmentLightModel, SkyModel},
    headlight::HeadlightLightModel,
    kind::FalloffModel,
    point::PointLightModel,
    spot::SpotLightModel,
};

use glam::DVec3;

use crate::{
    scene::format::{light::kind::LightKind, variants::variants},
    tracer::{error::GeometryError, light::Light},
};

variants! {
    /// A light.
    pub enum LightModel = "Light" for of_each {
        /// Light from everywhere; it casts no shadows.
        Ambient(AmbientLightModel) | AmbientLight,
        /// Light from the viewer along every ray, mirrored ones as well; it casts no shadows.
        Headlight(HeadlightLightModel),
        /// Light from the surroundings, where light follows paths: rays that hit nothing show it.
        Environment(EnvironmentLightModel) | EnvironmentLight | Dome | Background,
        /// Parallel light, as from the sun.
        Directional(DirectionalLightModel) | DirectionalLight | DistantLight | Sun,
        /// Light from a point in all directions.
        Point(PointLightModel) | PointLight,
        /// A cone of light from a point.
        Spot(SpotLightModel) | SpotLight,
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

    /// Returns the field that gives it a size, if it does.
    pub(crate) fn size(&self) -> Option<&'static str> {
        of_each!(self, light => light.size())
    }

    /// Returns the vector to the point that it is directed at, if a point alone directs it and all
    /// numbers are finite.
    pub(crate) fn to_target(&self) -> Option<DVec3> {
        of_each!(self, light => light.to_target())
    }
}
