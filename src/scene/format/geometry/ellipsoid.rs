//! The ellipsoid of a scene file.

use glam::DVec3;

use crate::{
    diagnostic::Code,
    scene::{
        format::{
            field::FieldKind,
            geometry::{
                faults::{not_finite, shown, value},
                kind::{GeometryKind, colored},
            },
            numbers::Triple,
            thing::Type,
        },
        problem::{Focus, Problem},
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, ellipsoid::Ellipsoid},
        vector::{is_direction, unit},
    },
};

colored! {
    /// An ellipsoid.
    pub struct EllipsoidModel = "Ellipsoid" {
        /// The center.
        center | position | location | c: Point,
        /// The three half axes: vectors from the center to the surface, perpendicular to each other. They
        /// cannot change over time.
        axes ! radii: Other { Type::Tuple(|| Type::Value(FieldKind::Edge), 3) }(Vec<Triple>),
    }
}

impl EllipsoidModel {
    fn three(&self) -> Option<[DVec3; 3]> {
        let axes: &[Triple; 3] = self.axes.as_slice().try_into().ok()?;
        Some(axes.map(DVec3::from))
    }
}

impl GeometryKind for EllipsoidModel {
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

    fn faults(&self) -> Vec<Problem> {
        let Some(axes) = self.three() else {
            let message = format!("an ellipsoid has 3 axes, found {}", self.axes.len());
            let help = "write `axes: [(1, 0, 0), (0, 2, 0), (0, 0, 3)]`";
            return vec![Problem::of_field(Code::WrongType, "axes", message).help(help)];
        };
        let place = |index| value("axes", [index]);
        let mut faults = Vec::new();
        for (index, axis) in axes.iter().enumerate() {
            if !axis.is_finite() {
                let numbers = axis.to_array().into_iter().enumerate();
                let infinite = numbers.filter(|(_, number)| !number.is_finite());
                faults.extend(infinite.map(|(at, _)| not_finite("axes", [index, at])));
            } else if !is_direction(*axis) {
                let message = "this axis has no direction, its squared length is 0 or not finite \
                               in an f64";
                let help = "give the way from the center to the surface";
                let fault = Problem::new(Code::ZeroVector, place(index), Focus::Value, message);
                faults.push(fault.help(help));
            }
        }
        if faults.is_empty()
            && let Some((one, other)) = Ellipsoid::skew(axes)
        {
            let message =
                format!("`axes[{one}]` and `axes[{other}]` must be perpendicular to each other");
            let fault = Problem::new(Code::OutOfRange, place(other), Focus::Value, message);
            let fault = fault.help(cure(axes));
            faults.push(fault.label(place(one), Focus::Value, "the other one"));
        }
        faults
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
    let axes = [a, b, c].map(rounded);
    // Of two that are nearly parallel only rounding errors are left.
    if Ellipsoid::skew(axes).is_some() {
        return "give three directions at right angles".to_owned();
    }
    let [a, b, c] = axes.map(|axis| shown(axis.to_array()));
    format!("the nearest ones are `axes: [{a}, {b}, {c}]`")
}

/// Rounds each number of a vector to about a billionth of its length.
fn rounded(vector: DVec3) -> DVec3 {
    const DIGITS: i32 = 9;
    let exponent = |x: f64| libm::log10(x.abs()).floor() as i32;
    let longest = exponent(vector.length());
    vector.map(|x| {
        // That of 0 is the smallest of all numbers.
        let digits = exponent(x).saturating_sub(longest).saturating_add(DIGITS);
        let digits = usize::try_from(digits).ok();
        let text = digits.map(|digits| format!("{x:.digits$e}"));
        text.and_then(|text| text.parse().ok()).unwrap_or_default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cure_is_valid_at_any_size() {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
        for axes in [
            [x, x + y, z],
            [3.0 * x + 1e-3 * y, 2.0 * y, -5.0 * z],
            [1e-10 * x, 1e-10 * (x + y), 1e-10 * z],
            [DVec3::new(1e-7, 2e-8, 0.0), 1e-7 * y, 5e-8 * z],
            [1e100 * x, 1e-100 * (x + y), z],
            [DVec3::new(1.0, 2.0, 3.0) / 7.0, y, z],
        ] {
            let cure = cure(axes);
            let (_, list) = cure.split_once("axes: ").unwrap();
            let numbers = list.replace(['(', ')', '[', ']', '`'], "");
            let numbers = numbers.split(", ").map(|number| number.parse().unwrap());
            let numbers: Vec<f64> = numbers.collect();
            let cured = [0, 3, 6].map(|at| DVec3::from_slice(&numbers[at..]));
            assert_eq!(Ellipsoid::skew(cured), None, "{cure}");
            for (cured, given) in cured.iter().zip(axes) {
                let factor = cured.length() / given.length();
                assert!((factor - 1.0).abs() < 1e-8, "{cure}");
            }
        }
        // Nothing is left of the second axis, or only rounding errors.
        let along = DVec3::new(0.1, 0.2, 0.3);
        for axes in [[x, 2.0 * x, z], [along, 7.0 * along, z]] {
            assert_eq!(cure(axes), "give three directions at right angles");
        }
    }
}
