//! The format as plain serde types, one file for each item of a scene file.
//!
//! Every name here is a name of the format; every doc comment is a sentence of its manual. Each thing
//! is declared once, with `object!` in `object.rs`: the kind of a field determines its type, its check
//! and whether it can change over time.

pub(crate) mod animation;
pub(crate) mod backdrop;
pub(crate) mod camera;
pub(crate) mod cameras;
pub(crate) mod color;
pub(crate) mod color_by;
pub(crate) mod color_names;
pub(crate) mod field;
pub(crate) mod fit;
pub mod geometry;
pub(crate) mod image;
pub mod light;
pub(crate) mod lighting;
pub(crate) mod map;
pub mod material;
pub(crate) mod numbers;
pub(crate) mod object;
pub(crate) mod orthographic;
pub(crate) mod outlines;
pub(crate) mod perspective;
pub(crate) mod picture;
pub(crate) mod rare;
pub(crate) mod scene;
pub(crate) mod sight;
pub(crate) mod texture;
pub(crate) mod thing;
pub(crate) mod transform;
pub(crate) mod variants;
pub(crate) mod warning;

pub use crate::scene::format::numbers::ScaleModel;
pub use crate::scene::format::numbers::{Interval, Triple};
pub use crate::scene::format::{
    animation::{AnimationModel, Interpolation, Key, OrbitModel, Track, TracksModel},
    backdrop::{BackdropModel, ImageBackdropModel, SkyBackdropModel},
    camera::CameraModel,
    cameras::CamerasModel,
    color::ColorModel,
    color_by::{ColorByModel, ColormapModel},
    field::Name,
    fit::{FitModel, OrthographicProjectionModel, PerspectiveProjectionModel, ProjectionModel},
    image::{ImageModel, ToneMappingModel},
    lighting::{
        BoxFilterModel, DirectModel, FilterModel, GaussianFilterModel, LightingModel, PathModel,
    },
    map::Map,
    orthographic::OrthographicModel,
    outlines::OutlinesModel,
    perspective::PerspectiveModel,
    picture::PictureFileModel,
    rare::Rare,
    scene::Model as SceneModel,
    texture::{
        CheckerModel, ImageTextureModel, MappingModel, NaturalMappingModel, PlanarMappingModel,
        SphericalMappingModel, TexelInterpolationModel, TexelWrapModel, TextureModel,
    },
    transform::{MatrixModel, RotateModel, TransformModel},
    warning::WarningName,
};
