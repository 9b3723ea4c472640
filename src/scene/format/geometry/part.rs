//! The part of a scene file: another scene file.

use crate::scene::format::geometry::kind::{GeometryKind, SeveralWords, geometry};

geometry! {
    /// The geometries of another scene file, with their own materials.
    pub struct PartModel = "Part" {
        /// The scene file: a path from the folder of this file to a file .ron or .json, with `/`
        /// between its parts. It needs no camera.
        file | path: File { &["ron", "json"] }(Box<str>),
        /// True to add its lights; false is the default. The light of this scene falls on the part in
        /// either case.
        lights: Flag = false,
    } not solid
}

impl GeometryKind for PartModel {
    fn words(&self) -> Option<SeveralWords> {
        Some(SeveralWords {
            whole: "a part",
            all: "geometries of this part",
            one: "in this part",
        })
    }
}
