//! The root of a scene file.

use crate::{
    diagnostic::path::Path,
    scene::format::{
        animation::AnimationModel,
        backdrop::BackdropModel,
        camera::CameraModel,
        cameras::{CamerasModel, NAMES},
        color::ColorModel,
        geometry::{GeometryModel, group::GroupModel},
        image::ImageModel,
        light::LightModel,
        lighting::LightingModel,
        material::MaterialsModel,
        object::object,
        outlines::OutlinesModel,
        thing::{Thing, Type},
        warning::WarningName,
    },
};

object! {
    /// A scene: the geometries, the cameras and the size of the picture.
    #[derive(Default)]
    pub struct Model = "Scene" {
        /// The location of this file's schema, for editors. JSON only.
        schema as "$schema": Text(String)?,
        /// The version of the format: 1, which is also meant where there is none.
        version: Other { Type::Whole(|| vec![Self::VERSION]) }(u32) = 1,
        /// The size of the picture.
        image: Thing(ImageModel)?,
        /// The viewpoint of the scene; required where there are no `cameras`.
        camera: Thing(CameraModel)?,
        /// More cameras, each by its name.
        cameras: Thing { Type::Map(CameraModel::of_type, Some(NAMES)) }(CamerasModel)?,
        /// The color where rays hit nothing; black is the default.
        background | background_color: Color = ColorModel::Channels([0.0; 3]),
        /// The surroundings where rays hit nothing: a sky or a picture. Give at most one of this and
        /// `background`.
        backdrop | sky | skybox | sky_sphere | environment_map | envmap | hdri: Thing(BackdropModel)?,
        /// The lights. With this field, even without a light in it, the scene is lit; without it, each
        /// geometry shows its color.
        lights: Thing(Vec<LightModel>)?,
        /// Materials, each by its name.
        materials: Thing(MaterialsModel)?,
        /// How light is evaluated; `Direct()` is the default.
        lighting: Thing(LightingModel)?,
        /// Lines where one geometry ends before another; there are none by default.
        outlines: Thing(OutlinesModel)?,
        /// The geometries; at equal distance, the first is in front.
        geometries | objects | shapes: Thing(Vec<GeometryModel>),
        /// The changes over time.
        animation: Thing(Box<AnimationModel>)?,
        /// Codes of warnings that this file does not want.
        allow: Other { Type::List(WarningName::of_type, 0) }(Vec<WarningName>)?,
    } at most one of background, backdrop any of camera, cameras
}

impl Model {
    /// Returns the names of the materials.
    pub(crate) fn names_of_materials(&self) -> impl Iterator<Item = &str> {
        let materials = self.materials.iter().flat_map(|materials| &materials.0);
        materials.map(|(name, _)| &**name)
    }

    /// The name of the only list that may be long.
    pub(crate) const LONG: &'static str = GroupModel::LIST;

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
