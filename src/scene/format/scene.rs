//! The root of a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    diagnostic::path::Path,
    scene::format::{
        animation::AnimationModel, camera::CameraModel, cameras::CamerasModel, color::ColorModel,
        field::fields, geometry::GeometryModel, image::ImageModel, light::LightModel,
        lighting::LightingModel, material::MaterialsModel, outlines::OutlinesModel,
        warning::WarningName,
    },
};

/// A scene: the geometries, the cameras and the size of the picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub struct Model {
    /// The location of this file's schema, for editors. JSON only.
    #[serde(rename = "$schema", skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// The version of the format: 1, which is also meant where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("enum" = [1, null], "default" = 1))]
    pub version: Option<u32>,
    /// The size of the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub image: Option<ImageModel>,
    /// The viewpoint of the scene; required where there are no `cameras`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraModel>,
    /// More cameras, each by its name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cameras: Option<CamerasModel>,
    /// The color where no geometry is seen; black is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = [0, 0, 0]))]
    pub background: Option<ColorModel>,
    /// The lights. With this field, even without a light in it, the scene is lit; without it, each
    /// geometry shows its color.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lights: Option<Vec<LightModel>>,
    /// Materials, each by its name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub materials: Option<MaterialsModel>,
    /// How light is evaluated; `Direct()` is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lighting: Option<LightingModel>,
    /// Lines where one geometry ends before another; there are none by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outlines: Option<OutlinesModel>,
    /// Everything that can be seen; at equal distance the first is in front.
    pub geometries: Vec<GeometryModel>,
    /// The changes over time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub animation: Option<Box<AnimationModel>>,
    /// Codes of warnings that this file does not want.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub allow: Option<Vec<WarningName>>,
}

impl Model {
    /// Returns the names of the materials.
    pub(crate) fn names_of_materials(&self) -> impl Iterator<Item = &str> {
        let materials = self.materials.iter().flat_map(|materials| &materials.0);
        materials.map(|(name, _)| &**name)
    }

    /// The name of the only list that may be long.
    pub(crate) const LONG: &'static str = "geometries";

    /// The version of the format that this program reads.
    pub(crate) const VERSION: u32 = 1;

    /// The path of the camera, or of one of `cameras`.
    pub(crate) fn path_of_camera(name: Option<&str>) -> Path {
        match name {
            None => Path::ROOT.field("camera"),
            Some(name) => Path::ROOT.field("cameras").key(name),
        }
    }

    /// Returns the width and the height of the picture.
    pub(crate) fn sides(&self) -> (u32, u32) {
        let image = self.image.as_ref();
        image.map_or_else(|| ImageModel::default().sides(), ImageModel::sides)
    }

    /// Every camera, with its name if it is one of `cameras`.
    pub(crate) fn all_cameras(&self) -> impl Iterator<Item = (Option<&str>, &CameraModel)> {
        let camera = self.camera.iter().map(|camera| (None, camera));
        let cameras = self.cameras.iter().flat_map(|cameras| &cameras.0);
        camera.chain(cameras.map(|(name, camera)| (Some(&**name), camera)))
    }
}

fields! {
    Model {
        background: Color = ColorModel::BLACK,
    } fixed {
        schema = "$schema",
        version,
        image,
        camera,
        cameras,
        lights,
        materials,
        lighting,
        outlines,
        geometries,
        animation,
        allow,
    }
}
