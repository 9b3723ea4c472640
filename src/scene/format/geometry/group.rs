//! The group of a scene file: geometries that belong together.

use crate::{
    diagnostic::Code,
    scene::{
        format::geometry::{
            GeometryModel,
            inside::Inside,
            kind::{FIELDS, GeometryKind, geometry},
        },
        problem::Problem,
    },
};

geometry! {
    /// Geometries that belong together. Each of them is seen as if it stood in the list of the scene, at
    /// the place that the transform gives it.
    pub struct GroupModel = "Group" {
        /// The geometries of the group; groups may be in groups.
        geometries | objects | shapes | children: Thing(Vec<GeometryModel>),
    }
}

impl GroupModel {
    /// The name of its list, which a scene has too.
    pub(in crate::scene::format) const LIST: &str = "geometries";
}

impl GeometryKind for GroupModel {
    fn faults(&self) -> Vec<Problem> {
        let message = "this has no effect: the group has no geometries";
        let problem = || {
            Problem::of_field(Code::NoEffect, Self::LIST, message)
                .help("add geometries to the group, or remove it")
        };
        Vec::from_iter(self.geometries.is_empty().then(problem))
    }

    fn inside(&self) -> [Option<Inside<'_>>; FIELDS] {
        [Some(Inside::list(Self::LIST, &self.geometries)), None]
    }

    fn inside_mut(&mut self) -> [&mut [GeometryModel]; FIELDS] {
        [&mut self.geometries, &mut []]
    }
}
