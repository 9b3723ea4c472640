//! Affine maps of space: shapes that are moved, turned and stretched.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    vector::{direction, finite, unit},
};

/// An affine map `p ↦ L·p + s` that can be inverted: a 3x3 matrix `L` and a shift `s`.
///
/// # Examples
///
/// ```
/// use strahl::{Vec3, shape::Transform};
///
/// let shift = Vec3::new(0.0, 1.0, 0.0);
/// let transform = Transform::new(shift, None, Vec3::new(2.0, 1.0, 1.0))?;
/// assert_eq!(transform.point(Vec3::ONE), Vec3::new(2.0, 2.0, 1.0));
/// # Ok::<(), strahl::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// The rows of `L`.
    rows: [DVec3; 3],
    shift: DVec3,
    /// The rows of the inverse of `L`.
    inverse: [DVec3; 3],
}

impl Transform {
    /// Creates the map that scales along the axes, then turns about an axis through the origin by an
    /// angle in radians, counterclockwise as seen from the tip of the axis, then shifts.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, if the squared length of the axis in f64 is 0 or
    /// not finite, or if the map cannot be inverted.
    pub fn new(
        translate: DVec3,
        rotate: Option<(DVec3, f64)>,
        scale: DVec3,
    ) -> Result<Self, GeometryError> {
        let scale = finite(scale, "scale")?;
        let mut columns = [DVec3::X, DVec3::Y, DVec3::Z];
        if let Some((axis, angle)) = rotate {
            let axis = direction(finite(axis, "axis")?, "axis")?;
            let rotation = Rotation::new(axis, angle);
            columns = columns.map(|column| rotation.of(column));
        }
        let [x, y, z] = [0, 1, 2].map(|axis| columns[axis] * scale[axis]);
        let row = |axis: usize| DVec3::new(x[axis], y[axis], z[axis]);
        Self::of([row(0), row(1), row(2)], translate)
    }

    /// Creates a map from the rows of `(L s)`.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite or if the map cannot be inverted.
    pub fn from_rows(rows: [[f64; 4]; 3]) -> Result<Self, GeometryError> {
        let linear = rows.map(|[x, y, z, _]| DVec3::new(x, y, z));
        Self::of(linear, DVec3::from(rows.map(|[.., shift]| shift)))
    }

    fn of(rows: [DVec3; 3], shift: DVec3) -> Result<Self, GeometryError> {
        for row in rows {
            finite(row, "matrix")?;
        }
        Ok(Self {
            rows,
            shift: finite(shift, "translate")?,
            inverse: inverse(rows)?,
        })
    }

    /// Returns the rows of `(L s)`.
    pub fn rows(&self) -> [[f64; 4]; 3] {
        [0, 1, 2].map(|axis| {
            let [x, y, z] = self.rows[axis].to_array();
            [x, y, z, self.shift[axis]]
        })
    }

    /// Returns the map that applies `inner` first: the product of the matrices.
    ///
    /// # Errors
    ///
    /// Returns an error if a number of the product is not finite or if it cannot be inverted.
    pub fn times(&self, inner: &Self) -> Result<Self, GeometryError> {
        let column = |axis: usize| DVec3::from(inner.rows.map(|row| row[axis]));
        let columns = [column(0), column(1), column(2)];
        let rows = self
            .rows
            .map(|row| DVec3::from(columns.map(|column| row.dot(column))));
        Self::of(rows, self.point(inner.shift))
    }

    /// Returns true if the map changes nothing.
    pub(crate) fn is_identity(&self) -> bool {
        self.rows == [DVec3::X, DVec3::Y, DVec3::Z] && self.shift == DVec3::ZERO
    }

    /// Returns `L·p + s`.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.direction(p) + self.shift
    }

    /// Returns `L·v`.
    pub fn direction(&self, v: DVec3) -> DVec3 {
        DVec3::from(self.rows.map(|row| row.dot(v)))
    }

    /// Returns the point that is mapped to `p`: `L⁻¹·(p - s)`.
    #[inline]
    pub fn point_back(&self, p: DVec3) -> DVec3 {
        self.direction_back(p - self.shift)
    }

    /// Returns the ray that is mapped to a ray, point by point: at each `t` it is at the point that
    /// is mapped there.
    #[inline]
    pub(crate) fn ray_back(&self, ray: &Ray) -> Ray {
        Ray::new(
            self.point_back(ray.origin()),
            self.direction_back(ray.direction()),
        )
    }

    /// The rows of `L⁻¹`.
    pub(crate) const fn inverse(&self) -> [DVec3; 3] {
        self.inverse
    }

    /// The shift `s`.
    pub(crate) const fn shift(&self) -> DVec3 {
        self.shift
    }

    #[inline]
    fn direction_back(&self, v: DVec3) -> DVec3 {
        DVec3::from(self.inverse.map(|row| row.dot(v)))
    }

    /// Returns the normal of a surface, of any length, at a point where it was `normal` before it
    /// was mapped: the transposed inverse of `L` times `normal`.
    pub(crate) fn normal(&self, normal: DVec3) -> DVec3 {
        let [x, y, z] = self.inverse;
        (x * normal.x + y * normal.y) + z * normal.z
    }

    /// Returns an upper bound of `|L·v|/|v|`: the root of the largest sum of a row of `LᵀL`
    /// (S. Gershgorin, 1931), which is exact if the columns of `L` are perpendicular.
    pub(crate) fn stretch(&self) -> f64 {
        /// The growth that covers all rounding errors.
        const GROWTH: f64 = 1.0 + 32.0 * f64::EPSILON;
        let most = self.largest();
        let column = |axis: usize| DVec3::from(self.rows.map(|row| row[axis] / most));
        let columns = [column(0), column(1), column(2)];
        let sum = |one: &DVec3| {
            let products = columns.iter().map(|other| one.dot(*other).abs());
            products.sum::<f64>()
        };
        let squared = columns.iter().map(sum).fold(0.0, f64::max);
        most * squared.sqrt() * GROWTH
    }

    /// Returns the corners of the box around a mapped box, grown by its rounding errors.
    pub(crate) fn surround(&self, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
        let middle = self.point((low + high) * 0.5);
        let half = self.rows.map(|row| row.abs().dot((high - low) * 0.5));
        let half = DVec3::from(half) + self.rounding(low.abs().max(high.abs()));
        [middle - half, middle + half]
    }

    /// Returns the largest rounding errors of points that are mapped there and back, whose
    /// coordinates are at most these.
    pub(crate) fn rounding(&self, most: DVec3) -> DVec3 {
        let terms = DVec3::from(self.rows.map(|row| row.abs().dot(most)));
        16.0 * f64::EPSILON * (terms + self.shift.abs())
    }

    /// Returns the direction in which points have to lie to be mapped farthest in a direction: the
    /// transpose of `L` times it, of unit length.
    pub(crate) fn steepest(&self, direction: DVec3) -> DVec3 {
        let [x, y, z] = self.rows.map(|row| row / self.largest());
        let along = (x * direction.x + y * direction.y) + z * direction.z;
        unit(along / along.abs().max_element())
    }

    /// Returns the largest number of `L`, without its sign.
    fn largest(&self) -> f64 {
        let rows = self.rows.map(|row| row.abs().max_element());
        rows.into_iter().fold(0.0, f64::max)
    }
}

/// Returns the rows of the inverse of a matrix: its adjugate divided by its determinant.
///
/// With the rows `a`, `b` and `c`, the determinant is `a·(b × c)` and the columns of the adjugate are
/// `b × c`, `c × a` and `a × b`.
fn inverse([a, b, c]: [DVec3; 3]) -> Result<[DVec3; 3], GeometryError> {
    let adjugate = [b.cross(c), c.cross(a), a.cross(b)];
    let determinant = a.dot(adjugate[0]);
    let rows = [0, 1, 2].map(|row| DVec3::from(adjugate.map(|column| column[row] / determinant)));
    match determinant.is_normal() && rows.iter().all(|row| row.is_finite()) {
        true => Ok(rows),
        false => Err(GeometryError::NotInvertible { determinant }),
    }
}

/// A rotation about a line through the origin.
pub(crate) struct Rotation {
    axis: DVec3,
    sin: f64,
    cos: f64,
}

impl Rotation {
    /// Creates a rotation by an angle in radians, counterclockwise as seen from the tip of the
    /// axis.
    pub(crate) fn new(axis: DVec3, angle: f64) -> Self {
        Self {
            axis: unit(axis),
            sin: libm::sin(angle),
            cos: libm::cos(angle),
        }
    }

    /// Rotates a vector by Rodrigues' formula (O. Rodrigues, Des lois géométriques qui régissent
    /// les déplacements d'un système solide, 1840).
    pub(crate) fn of(&self, v: DVec3) -> DVec3 {
        let Self { axis, sin, cos } = *self;
        v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::tracer::random::{Rng, cases};

    #[test]
    fn a_quarter_turn_is_counterclockwise() {
        let quarter = Rotation::new(DVec3::new(0.0, 3.0, 0.0), TAU / 4.0);
        let turned = quarter.of(DVec3::new(0.0, 2.0, 5.0));
        assert!((turned - DVec3::new(5.0, 2.0, 0.0)).length() < 1e-15);
    }

    // (1, 2, 3) by a third of a turn about the diagonal: the coordinates swap places.
    #[test]
    fn a_third_of_a_turn_about_the_diagonal() {
        let third = Rotation::new(DVec3::ONE, TAU / 3.0);
        let turned = third.of(DVec3::new(1.0, 2.0, 3.0));
        assert!((turned - DVec3::new(3.0, 1.0, 2.0)).length() < 1e-14);
    }

    #[test]
    fn it_scales_then_turns_then_shifts() {
        let quarter = Some((DVec3::Z, TAU / 4.0));
        let all = Transform::new(
            DVec3::new(0.0, 0.0, 7.0),
            quarter,
            DVec3::new(2.0, 3.0, 4.0),
        );
        let moved = all.unwrap().point(DVec3::ONE);
        assert!((moved - DVec3::new(-3.0, 2.0, 11.0)).length() < 1e-14);
    }

    #[test]
    fn the_inverse_is_exact_where_numbers_are() {
        let rows = [
            [2.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 4.0, 2.0],
            [0.0, -8.0, 0.0, 3.0],
        ];
        let map = Transform::from_rows(rows).unwrap();
        assert_eq!(map.rows(), rows);
        assert_eq!(map.point(DVec3::ONE), DVec3::new(3.0, 6.0, -5.0));
        assert_eq!(map.point_back(DVec3::new(3.0, 6.0, -5.0)), DVec3::ONE);
        // The plane y = 0 becomes z = 3, and its normal points down.
        assert_eq!(map.normal(DVec3::Y), DVec3::new(0.0, 0.0, -0.125));
        assert_eq!(map.stretch(), 8.0 * (1.0 + 32.0 * f64::EPSILON));
    }

    #[test]
    fn a_product_applies_the_inner_map_first() {
        let shift = Transform::new(DVec3::X, None, DVec3::ONE).unwrap();
        let double = Transform::new(DVec3::ZERO, None, DVec3::splat(2.0)).unwrap();
        let point = |map: Result<Transform, _>| map.unwrap().point(DVec3::ONE);
        assert_eq!(point(shift.times(&double)), DVec3::new(3.0, 2.0, 2.0));
        assert_eq!(point(double.times(&shift)), DVec3::new(4.0, 2.0, 2.0));
    }

    #[test]
    fn bounds_hold_every_point() {
        let mut rng = Rng(21);
        for _ in 0..cases(5000) {
            let row = |rng: &mut Rng| rng.vector().extend(rng.signed()).to_array();
            let rows = [row(&mut rng), row(&mut rng), row(&mut rng)];
            let Ok(map) = Transform::from_rows(rows) else {
                continue;
            };
            let v = rng.vector();
            assert!(map.direction(v).length() <= map.stretch() * v.length());
            let [low, high] = map.surround([DVec3::NEG_ONE, DVec3::ONE]);
            let p = map.point(v.signum());
            assert!(p.cmpge(low).all() && p.cmple(high).all());
            let back = map.point_back(map.point(v)) - v;
            let condition = map.inverse.map(DVec3::length).iter().sum::<f64>() * map.stretch();
            assert!(back.length() <= 1e-14 * condition, "{back} {rows:?}");
            let steepest = map.steepest(v / v.length());
            assert!(map.direction(steepest).dot(v) >= map.direction(unit(v)).dot(v));
        }
    }

    #[test]
    fn what_cannot_be_inverted_is_refused() {
        let scale = |x, y, z| Transform::new(DVec3::ZERO, None, DVec3::new(x, y, z));
        assert_eq!(
            scale(1.0, 0.0, 1.0),
            Err(GeometryError::NotInvertible { determinant: 0.0 })
        );
        assert!(scale(1e-200, 1e-200, 1.0).is_err(), "almost 0");
        assert!(scale(1e200, 1e200, 1.0).is_err(), "infinite");
        assert!(scale(1e-100, -1e-100, 1.0).is_ok());
        assert!(scale(f64::NAN, 1.0, 1.0).is_err());
        let flat = [
            [1.0, 2.0, 3.0, 0.0],
            [2.0, 4.0, 6.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
        ];
        assert!(Transform::from_rows(flat).is_err());
        let turn = Transform::new(DVec3::ZERO, Some((DVec3::ZERO, 1.0)), DVec3::ONE);
        assert!(matches!(
            turn,
            Err(GeometryError::NoDirection { name: "axis", .. })
        ));
    }
}
