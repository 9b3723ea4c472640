//! The pictures that a scene names.

use serde::{Deserialize, Serialize};

use crate::tracer::light::picture::SkyPicture;

/// The extensions of pictures that a scene may name.
pub(crate) const ENDINGS: &[&str] = &["exr", "hdr", "pfm", "png", "jpg", "jpeg"];

/// The path of a picture of the surroundings, and what is in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SkyFileModel {
    /// The path from the folder of the scene.
    pub path: Box<str>,
    /// The picture, once the file is read.
    #[serde(skip)]
    pub(crate) picture: Option<SkyPicture>,
}

impl From<&str> for SkyFileModel {
    fn from(path: &str) -> Self {
        Self {
            path: path.into(),
            picture: None,
        }
    }
}
