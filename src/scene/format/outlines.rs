//! The outlines of a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    film::Outlines,
    scene::format::{
        color::ColorModel,
        field::{fields, rules},
    },
};

/// Lines where one geometry ends before another.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Outlines", deny_unknown_fields)]
#[schemars(transform = rules::<Self>)]
pub struct OutlinesModel {
    /// The width of the lines in pixels, above 0 and at most 100; 1.5 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1.5))]
    pub width: Option<f64>,
    /// The color of the lines; black is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "#000000"))]
    pub color: Option<ColorModel>,
    /// Within one geometry, the difference of distances along the rays that makes a line; without
    /// it, there are no such lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<f64>,
    /// Within one geometry, the angle between normals in degrees that makes a line, 0 to 180;
    /// without it, there are no such lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub creases: Option<f64>,
}

impl OutlinesModel {
    /// The outlines.
    pub(crate) fn build(&self) -> Outlines {
        Outlines {
            width: self.width.unwrap_or(Outlines::WIDTH),
            color: self.color.as_ref().unwrap_or(&ColorModel::BLACK).build(),
            depth: self.depth,
            creases: self.creases,
        }
    }
}

fields! {
    OutlinesModel {
        width: Width = Outlines::WIDTH,
        color: Color = ColorModel::BLACK,
        depth: Distance,
        creases: Turn,
    } fixed {}
}
