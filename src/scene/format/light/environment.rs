//! Light from the surroundings, in a scene file.

use glam::DVec3;

use crate::{
    scene::format::{
        light::kind::{LightKind, light},
        object::object,
        picture::{ENDINGS, PictureFileModel},
        sight::UP,
    },
    tracer::{
        error::GeometryError,
        light::{Environment, Light, Sky, picture::SkyPicture},
    },
};

light! {
    /// Light from the surroundings, where light follows paths: rays that hit nothing show it. At most one
    /// light is of this kind. It has a `color`, a `sky` or an `image`.
    #[derive(Default)]
    pub struct EnvironmentLightModel = "Environment" {
        /// The colors of a sky; give this, `color` or `image`.
        sky: Thing(SkyModel)?,
        /// A picture of all directions, its first row the zenith: a path from the folder of the scene to a file
        /// .exr, .hdr, .pfm, .png or .jpg, with `/` between its parts.
        image | map | file: File { ENDINGS }(PictureFileModel<SkyPicture>)?,
        /// The turn of the picture about the zenith in degrees, counterclockwise as seen from there; 0 is the
        /// default: its middle lies in the direction (0, 0, -1).
        rotation: Number = 0.0,
        /// The direction of the zenith, of any length; (0, 1, 0) is the default.
        up: Direction = UP,
        /// True if the camera sees it in place of the background; the default.
        visible: Flag = true,
    }
    /// The intensity, from 0 to 1e12; 1 is the default: white light makes a white matte surface white.
    intensity = 1.0
    one of color, sky, image
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
        let picture = self.image.as_ref().and_then(|image| image.content.as_ref());
        let up = DVec3::from(self.up());
        let environment = match (&self.sky, picture) {
            (_, Some(picture)) => {
                Environment::of_picture(picture, up, self.rotation(), self.intensity())?
            }
            (None, None) => Environment::new(self.color().build(), self.intensity())?,
            (Some(sky), None) => {
                let sky = Sky {
                    zenith: sky.zenith.build(),
                    horizon: sky.horizon.build(),
                    ground: sky.ground.build(),
                };
                Environment::of_sky(sky, up, self.intensity())?
            }
        };
        Ok(environment.visible(self.visible()).into())
    }
}
