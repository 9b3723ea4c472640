//! The format as plain serde types: what a file may say, one file for each thing that it may hold.
//!
//! Every name here is a name of the format; every doc comment is a sentence of its manual. A type
//! lists its fields once, as `fields!` in `field.rs` takes them: the kind of each gives its check, and
//! says whether it can change over time.

pub(crate) mod camera;
pub(crate) mod color;
pub(crate) mod field;
pub mod geometry;
pub(crate) mod image;
pub(crate) mod orthographic;
pub(crate) mod perspective;
pub(crate) mod scene;
pub(crate) mod warning;

pub use crate::scene::{
    animation::{
        model::{AnimationModel, Interpolation, Key, Track, TracksModel},
        orbit::OrbitModel,
    },
    cameras::CamerasModel,
    format::{
        camera::CameraModel,
        color::ColorModel,
        field::{Name, Triple},
        image::ImageModel,
        orthographic::OrthographicModel,
        perspective::PerspectiveModel,
        scene::Model as SceneModel,
        warning::WarningName,
    },
    map::Map,
};
