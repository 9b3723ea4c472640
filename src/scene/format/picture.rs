//! The pictures that a scene names.

use serde::{Deserialize, Serialize};

/// The extensions of pictures that a scene may name.
pub(crate) const ENDINGS: &[&str] = &["exr", "hdr", "pfm", "png", "jpg", "jpeg"];

/// The path of a picture, and what it is used as.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent, bound = "")]
pub struct PictureFileModel<T> {
    /// The path from the folder of the scene.
    pub path: Box<str>,
    /// The picture, once the file is read.
    #[serde(skip)]
    pub(crate) content: Option<T>,
}

impl<T> From<&str> for PictureFileModel<T> {
    fn from(path: &str) -> Self {
        Self {
            path: path.into(),
            content: None,
        }
    }
}
