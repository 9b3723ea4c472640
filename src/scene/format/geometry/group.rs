//! The group of a scene file: geometries that belong together.

use crate::scene::format::{
    geometry::{
        GeometryModel,
        inside::Inside,
        kind::{FIELDS, GeometryKind, geometry},
    },
    scene::Model,
};

geometry! {
    /// Geometries that belong together. Each of them is seen as if it stood in the list of the scene, at
    /// the place that the transform gives it.
    pub struct GroupModel = "Group" {
        /// The geometries of the group; groups may be in groups.
        geometries | objects | shapes | children: Thing(Vec<GeometryModel>),
    }
}

impl GeometryKind for GroupModel {
    fn inside(&self) -> [Option<Inside<'_>>; FIELDS] {
        [Some(Inside::list(Model::LONG, &self.geometries)), None]
    }

    fn inside_mut(&mut self) -> [&mut [GeometryModel]; FIELDS] {
        [&mut self.geometries, &mut []]
    }
}
