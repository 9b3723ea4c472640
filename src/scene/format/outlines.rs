//! The outlines of a scene file.

use crate::{
    film::Outlines,
    scene::format::{color::ColorModel, object::object},
};

object! {
    /// Lines where one geometry ends before another.
    #[derive(Default)]
    pub struct OutlinesModel = "Outlines" {
        /// The width of the lines in pixels, above 0 and at most 100; 1.5 is the default.
        width: Width = Outlines::WIDTH,
        /// The color of the lines; black is the default.
        color: Color = ColorModel::BLACK,
        /// Within one geometry, the difference of distances along the rays that makes a line; without
        /// it, there are no such lines.
        depth: Distance?,
        /// Within one geometry, the angle between normals in degrees that makes a line, 0 to 180;
        /// without it, there are no such lines.
        creases: Turn?,
    }
}

impl OutlinesModel {
    /// The outlines.
    pub(crate) fn build(&self) -> Outlines {
        Outlines {
            width: self.width(),
            color: self.color().build(),
            depth: self.depth,
            creases: self.creases,
        }
    }
}
