//! The ellipsoid of a scene file.

use std::sync::Arc;

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    diagnostic::Code,
    scene::format::{
        color::ColorModel,
        field::{Name, Triple, fields, rules},
        geometry::clash::{Clash, shown},
        geometry::kind::Kind,
        material::MaterialModel,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, ellipsoid::Ellipsoid},
        vector::{is_direction, unit},
    },
};

/// A ball that is stretched along three axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Ellipsoid", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct EllipsoidModel {
    /// The center.
    pub center: Triple,
    /// The three half axes: vectors from the center to the surface, perpendicular to each other. They
    /// cannot change over time.
    #[schemars(extend("minItems" = 3, "maxItems" = 3))]
    pub axes: Vec<Triple>,
    /// The color: a matte surface. Give this or `material`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<ColorModel>,
    /// The material. Give this or `color`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Arc<MaterialModel>>,
    /// The name of the geometry: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

impl EllipsoidModel {
    fn three(&self) -> Option<[DVec3; 3]> {
        let axes: &[Triple; 3] = self.axes.as_slice().try_into().ok()?;
        Some(axes.map(DVec3::from))
    }
}

impl Kind for EllipsoidModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let axes = self.three();
        let axes = axes.ok_or(GeometryError::NotFinite { name: "axes" });
        Some(axes.and_then(|axes| Ellipsoid::new(DVec3::from(self.center), axes).map(Shape::from)))
    }

    fn more_numbers(&self, see: &mut dyn FnMut(f64)) {
        self.axes.iter().flatten().for_each(|number| see(*number));
    }

    fn clashes(&self) -> Vec<Clash> {
        let Some(axes) = self.three() else {
            let message = format!("an ellipsoid has 3 axes, found {}", self.axes.len());
            let help = "write `axes: [(1, 0, 0), (0, 2, 0), (0, 0, 3)]`";
            return vec![Clash::new(Code::WrongType, "axes", message, help)];
        };
        let mut clashes = Vec::new();
        for (index, axis) in axes.iter().enumerate() {
            if !axis.is_finite() {
                clashes.push(
                    Clash::new(
                        Code::NotFinite,
                        "axes",
                        "expected finite numbers",
                        "numbers are finite 64-bit floats, up to about 1.8e308",
                    )
                    .at([index]),
                );
            } else if !is_direction(*axis) {
                let message = "this axis has no direction, its squared length is 0 or not finite \
                               in an f64";
                let help = "give the way from the center to the surface";
                clashes.push(Clash::new(Code::ZeroVector, "axes", message, help).at([index]));
            }
        }
        if clashes.is_empty()
            && let Some((one, other)) = Ellipsoid::skew(axes)
        {
            let message =
                format!("`axes[{one}]` and `axes[{other}]` must be perpendicular to each other");
            clashes.push(Clash::new(Code::OutOfRange, "axes", message, cure(axes)).at([other]));
        }
        clashes
    }
}

fields! {
    EllipsoidModel {
        center: Point,
        color: Color,
    } fixed {
        axes,
        material,
        name,
    }
}

/// Returns the cure for axes that are not perpendicular: others of the same lengths, the first of
/// the same direction (Gram and Schmidt).
fn cure(axes: [DVec3; 3]) -> String {
    let [a, b, c] = axes;
    let u = unit(a);
    let v = b - b.dot(u) * u;
    let w = u.cross(v);
    if !is_direction(v) || !is_direction(w) {
        return "give three directions at right angles".to_owned();
    }
    let side = if c.dot(w) < 0.0 { -1.0 } else { 1.0 };
    let [b, c] = [b.length() * unit(v), side * c.length() * unit(w)];
    let rounded = |vector: DVec3| vector.to_array().map(|x| (x * 1e9).round() / 1e9 + 0.0);
    let [a, b, c] = [a, b, c].map(|axis| shown(rounded(axis)));
    format!("the nearest ones are `axes: [{a}, {b}, {c}]`")
}
