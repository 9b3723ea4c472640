//! The transform of a geometry in a scene file.

use std::{f64::consts::PI, fmt};

use glam::DVec3;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{SeqAccess, Visitor},
};

use crate::{
    scene::format::{
        numbers::{ScaleModel, Triple, elements},
        object::object,
        thing::Type,
    },
    tracer::{error::GeometryError, transform::Transform},
};

object! {
    /// A change of place, direction and size: first `scale`, then `rotate`, then `translate`; or a
    /// matrix alone.
    #[derive(Default)]
    pub struct TransformModel = "Transform" {
        /// The shift; (0, 0, 0) is the default.
        translate | translation | position | location: Point = Triple::default(),
        /// The rotation about an axis through the origin; none is the default.
        rotate | rotation: Thing(RotateModel)?,
        /// The factor of all lengths, or three factors along x, y and z; 1 is the default. A negative
        /// factor mirrors. 0 is not allowed.
        scale: Scale = ScaleModel::Uniform(1.0),
        /// The matrix, in place of the other fields: three rows of four numbers, of which the last is
        /// the shift. It can be inverted.
        matrix: Other { Type::Matrix }(Box<MatrixModel>)?,
    }
}

object! {
    /// A rotation about an axis through the origin.
    pub struct RotateModel = "Rotation" {
        /// The axis, of any length.
        axis: Direction,
        /// The angle in degrees, counterclockwise as seen from the tip of the axis.
        angle: Number,
    }
}

/// Three rows of four numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct MatrixModel(pub [[f64; 4]; 3]);

impl MatrixModel {
    /// What is expected where one is read, as messages say it.
    pub(crate) const EXPECTED: &str = "three rows of four numbers";
}

impl TransformModel {
    /// Builds the transform.
    pub(crate) fn build(&self) -> Result<Transform, GeometryError> {
        if let Some(matrix) = &self.matrix {
            return Transform::from_rows(matrix.0);
        }
        let rotate = self.rotate.as_ref();
        Transform::new(
            self.translate.map_or(DVec3::ZERO, DVec3::from),
            rotate.map(|rotate| (DVec3::from(rotate.axis), rotate.angle * (PI / 180.0))),
            self.scale.as_ref().map_or(DVec3::ONE, ScaleModel::factors),
        )
    }
}

impl<'de> Deserialize<'de> for MatrixModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct MatrixVisitor;

        impl<'de> Visitor<'de> for MatrixVisitor {
            type Value = MatrixModel;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(MatrixModel::EXPECTED)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<MatrixModel, A::Error> {
                elements(seq, &self).map(MatrixModel)
            }
        }

        deserializer.deserialize_tuple(3, MatrixVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> TransformModel {
        ron::from_str(text).unwrap()
    }

    #[test]
    fn a_scale_is_a_number_or_three() {
        for (text, factors) in [
            ("2", [2.0; 3]),
            ("-0.1", [-0.1; 3]),
            ("-3", [-3.0; 3]),
            ("(1, 2, 3.5)", [1.0, 2.0, 3.5]),
        ] {
            let scale = read(&format!("(scale: Some({text}))")).scale.unwrap();
            assert_eq!(scale.factors().to_array(), factors);
        }
        let json: ScaleModel = serde_json::from_str("1e-3").unwrap();
        assert_eq!(json, ScaleModel::Uniform(1e-3));
    }

    #[test]
    fn angles_are_degrees_and_a_matrix_stands_alone() {
        let quarter =
            read("(rotate: Some((axis: (0, 0, 2), angle: 90)), translate: Some((5, 0, 0)))");
        let moved = quarter.build().unwrap().point(DVec3::X);
        assert!((moved - DVec3::new(5.0, 1.0, 0.0)).length() < 1e-15);
        let text = "(matrix: Some(((0, 1, 0, 5), (2, 0, 0, 6), (0, 0, 3, 7))))";
        let moved = read(text).build().unwrap().point(DVec3::X);
        assert_eq!(moved, DVec3::new(5.0, 8.0, 7.0));
        assert_eq!(read("()").build().unwrap().point(DVec3::ONE), DVec3::ONE);
    }
}
