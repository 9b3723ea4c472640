//! Light from the surroundings, in a scene file.

use crate::{
    scene::format::{
        light::kind::{LightKind, light},
        object::object,
        sight::UP,
    },
    tracer::{
        error::GeometryError,
        light::{Environment, Light, Sky},
    },
};

light! {
    /// Light from the surroundings, where light follows paths: rays that hit nothing show it. At most one
    /// light is of this kind.
    pub struct EnvironmentLightModel = "Environment" {
        /// The colors of a sky; give this or `color`.
        sky: Thing(SkyModel)?,
        /// The direction of the zenith, of any length; (0, 1, 0) is the default.
        up: Direction = UP,
        /// True if the camera sees it in place of the background; the default.
        visible: Flag = true,
    }
    /// The intensity, from 0 to 1e12; 1 is the default: white light makes a white matte surface white.
    intensity = 1.0
    one of color, sky
}

object! {
    /// The colors of a sky. In between, they blend with the height of the direction.
    pub struct SkyModel = "Sky" {
        /// The color above.
        zenith: Color,
        /// The color at the horizon.
        horizon: Color,
        /// The color below.
        ground: Color,
    }
}

impl LightKind for EnvironmentLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let environment = match &self.sky {
            None => Environment::new(self.color().build(), self.intensity())?,
            Some(sky) => {
                let sky = Sky {
                    zenith: sky.zenith.build(),
                    horizon: sky.horizon.build(),
                    ground: sky.ground.build(),
                };
                Environment::of_sky(sky, self.up().into(), self.intensity())?
            }
        };
        Ok(environment.visible(self.visible()).into())
    }
}
