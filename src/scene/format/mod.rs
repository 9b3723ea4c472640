//! The format as plain serde types: what a file may say, one file for each thing that it may hold.
//!
//! Every name here is a name of the format; every doc comment is a sentence of its manual. A type
//! lists its fields once, as `fields!` in `field.rs` takes them: the kind of each gives its check, and
//! says whether it can change over time.

pub(crate) mod animation;
pub(crate) mod camera;
pub(crate) mod cameras;
pub(crate) mod color;
pub(crate) mod field;
pub mod geometry;
pub(crate) mod image;
pub(crate) mod map;
pub(crate) mod orthographic;
pub(crate) mod perspective;
pub(crate) mod scene;
pub(crate) mod warning;

pub use crate::scene::format::{
    animation::{AnimationModel, Interpolation, Key, Track, TracksModel, orbit::OrbitModel},
    camera::CameraModel,
    cameras::CamerasModel,
    color::ColorModel,
    field::{Name, Triple},
    image::ImageModel,
    map::Map,
    orthographic::OrthographicModel,
    perspective::PerspectiveModel,
    scene::Model as SceneModel,
    warning::WarningName,
};
