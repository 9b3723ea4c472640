//! What rays see that hit nothing, in a scene file.

use crate::{
    scene::format::{
        object::object,
        picture::{ENDINGS, PictureFileModel},
        sight::UP,
        variants::variants,
    },
    tracer::{
        error::GeometryError,
        light::{backdrop::Backdrop, environment::Sky},
        texels::Texels,
    },
};

variants! {
    /// The surroundings that rays see where they hit nothing, in flat and in lit scenes. They light nothing by
    /// themselves.
    pub enum BackdropModel = "Backdrop" {
        /// The colors of a sky.
        Sky(SkyBackdropModel) | Gradient,
        /// A picture of all directions.
        Image(ImageBackdropModel) | Skybox | Environment,
    }
}

object! {
    /// The colors of a sky. In between, they blend with the height of the direction.
    pub struct SkyBackdropModel = "Sky" {
        /// The color above.
        zenith: Color,
        /// The color at the horizon.
        horizon: Color,
        /// The color below.
        ground: Color,
        /// The direction of the zenith, of any length; (0, 1, 0) is the default.
        up: Direction = UP,
    }
}

object! {
    /// A picture of all directions.
    pub struct ImageBackdropModel = "Image" {
        /// The picture, its first row the zenith: a path from the folder of the scene to a file .exr, .hdr, .pfm,
        /// .png or .jpg, with `/` between its parts.
        file | path | image | map: File { ENDINGS }(PictureFileModel<Texels>),
        /// The turn of the picture about the zenith in degrees, counterclockwise as seen from there; 0 is the
        /// default: its middle lies in the direction (0, 0, -1).
        rotation: Number = 0.0,
        /// The direction of the zenith, of any length; (0, 1, 0) is the default.
        up: Direction = UP,
    }
}

impl BackdropModel {
    /// The backdrop; `None` as long as its file is not read.
    pub(crate) fn build(&self) -> Result<Option<Backdrop>, GeometryError> {
        match self {
            Self::Sky(backdrop) => {
                let SkyBackdropModel {
                    zenith,
                    horizon,
                    ground,
                    ..
                } = backdrop;
                let sky = Sky {
                    zenith: zenith.build(),
                    horizon: horizon.build(),
                    ground: ground.build(),
                };
                Backdrop::of_sky(sky, backdrop.up().into()).map(Some)
            }
            Self::Image(image) => {
                let build =
                    |texels| Backdrop::of_picture(texels, image.up().into(), image.rotation());
                image.file.content.clone().map(build).transpose()
            }
        }
    }

    /// Returns the picture, if it is one.
    pub(crate) const fn file(&self) -> Option<&PictureFileModel<Texels>> {
        match self {
            Self::Sky(_) => None,
            Self::Image(image) => Some(&image.file),
        }
    }

    /// The same for a change.
    pub(crate) const fn file_mut(&mut self) -> Option<&mut PictureFileModel<Texels>> {
        match self {
            Self::Sky(_) => None,
            Self::Image(image) => Some(&mut image.file),
        }
    }
}
