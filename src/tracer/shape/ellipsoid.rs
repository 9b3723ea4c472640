//! An ellipsoid.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        around::Around,
        axis::outward,
        contact::{ContactPoint, FaceEdge, FaceEquation, NearFace},
        face::{Faces, Leaving},
        span::{Convex, Round, Span},
        working::{Term, Working},
    },
    vector::{direction, finite, unit},
};

/// All points `c + x·a + y·b + z·c'` with `x² + y² + z² = 1`, for a center `c` and three half axes
/// that are perpendicular to each other.
///
/// A ray meets it as it meets a ball of radius 1 in the coordinates of the axes, `(v·a)/(a·a)` for
/// each axis `a`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    center: DVec3,
    axes: [DVec3; 3],
    around: Around,
}

/// The largest cosine of the angle between two axes that counts as perpendicular: numbers in files
/// are often rounded to six digits.
pub(crate) const SKEW: f64 = 1e-5;

/// The growth of the bounds that covers that angle.
const GROWTH: f64 = 1.0 + 4.0 * SKEW;

impl Ellipsoid {
    /// Creates an ellipsoid around `center`.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, if the squared length of an axis in f64 is 0 or
    /// not finite, or if two axes are not perpendicular: |a·b| > 1e-5·|a|·|b|.
    pub fn new(center: DVec3, axes: [DVec3; 3]) -> Result<Self, GeometryError> {
        let center = finite(center, "center")?;
        for axis in axes {
            direction(finite(axis, "axes")?, "axes")?;
        }
        match Self::skew(axes) {
            Some((one, other)) => Err(GeometryError::NotPerpendicular {
                one: axes[one],
                other: axes[other],
            }),
            None => Ok(Self {
                center,
                axes,
                around: around(center, axes),
            }),
        }
    }

    /// Returns the first two axes that are not perpendicular, by their indices.
    pub(crate) fn skew(axes: [DVec3; 3]) -> Option<(usize, usize)> {
        let is_skew = |(one, other): &(usize, usize)| {
            let [a, b] = [axes[*one], axes[*other]];
            (a / a.length()).dot(b / b.length()).abs() > SKEW
        };
        [(0, 1), (0, 2), (1, 2)].into_iter().find(is_skew)
    }

    /// The center.
    pub const fn center(&self) -> DVec3 {
        self.center
    }

    /// The half axes.
    pub const fn axes(&self) -> [DVec3; 3] {
        self.axes
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        // The ball of radius 1 has its farthest point along these parts of the direction.
        let along = DVec3::from(self.axes.map(|axis| axis.dot(direction)));
        let [x, y, z] = unit(along).to_array();
        let [a, b, c] = self.axes;
        Some(self.center + ((x * a + y * b) + z * c))
    }

    /// Returns the coordinates of a vector along the axes.
    #[inline]
    fn coordinates(&self, v: DVec3) -> DVec3 {
        DVec3::from(self.axes.map(|axis| v.dot(axis) / axis.dot(axis)))
    }

    /// Returns the coordinates of the ray's origin, from the center, and of its direction.
    #[inline]
    fn inside(&self, ray: &Ray) -> (DVec3, DVec3) {
        let q = self.coordinates(ray.origin() - self.center);
        (q, self.coordinates(ray.direction()))
    }

    pub(crate) const FACES: Faces = Faces::Curved;

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        let q = self.coordinates(at.point - self.center);
        let [x, y, z] = (2.0 * q).to_array();
        let [a, b, c] = self.axes.map(|axis| axis / axis.dot(axis));
        let [u, v, w] = self.axes.map(DVec3::abs);
        let equation = FaceEquation {
            value: q.dot(q) - 1.0,
            gradient: (x * a + y * b) + z * c,
            size: self.center.abs() + ((u + v) + w),
            more: 0.0,
        };
        at.see(0, &equation, FaceEdge::none, see);
    }

    pub(crate) fn normal_on(&self, _: u64, ray: &Ray, t: f64) -> DVec3 {
        let (q, e) = self.inside(ray);
        let [x, y, z] = (q + t * e).to_array();
        let [a, b, c] = self.axes.map(|axis| axis / axis.dot(axis));
        outward(x * a + y * b + z * c, ray)
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let [a, b, c] = self.axes;
        let (q, e) = self.inside(ray);
        Working {
            form: None,
            parts: vec![
                Term::vector("center", "center c", self.center),
                Term::vector("axis_a", "axes", a),
                Term::vector("axis_b", "and", b),
                Term::vector("axis_c", "and", c),
            ],
            lines: vec![
                vec![Term::vector("q", "q", q), Term::vector("e", "e", e)],
                Round::terms("", q, e, 1.0),
            ],
            solutions: self.crossings(ray, Leaving::NOTHING).solutions(),
            name: Some("crossings"),
        }
    }

    pub(crate) fn numbers(&self) -> impl IntoIterator<Item = f64> + use<> {
        let [a, b, c] = self.axes;
        let all = [self.center, a, b, c].map(|vector| vector.to_array());
        all.into_iter().flatten()
    }

    /// Returns the distance from a point to the farthest end of an axis.
    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        let ends = self
            .axes
            .iter()
            .flat_map(|axis| [self.center - *axis, self.center + *axis]);
        ends.fold(0.0, |farthest, end| {
            f64::max(farthest, (end - point).length())
        })
    }
}

impl Convex for Ellipsoid {
    #[inline]
    fn hull(&self) -> &Around {
        &self.around
    }

    #[inline]
    fn span(&self, ray: &Ray, leaving: Leaving) -> Option<Span> {
        let (q, e) = self.inside(ray);
        Span::round(q, e, 1.0, !leaving.is_empty(), 0)
    }

    /// Returns a depth below the surface: above 0 inside, 0 on it and below 0 outside.
    fn depth(&self, point: DVec3) -> f64 {
        1.0 - self.coordinates(point - self.center).length()
    }
}

/// Returns the box and the ball around an ellipsoid.
fn around(center: DVec3, axes: [DVec3; 3]) -> Around {
    let [a, b, c] = axes;
    let along = |axis: usize| DVec3::new(a[axis], b[axis], c[axis]).length();
    let half = DVec3::new(along(0), along(1), along(2)) * GROWTH;
    let longest = axes.map(DVec3::length).into_iter().fold(0.0, f64::max);
    Around::new([center - half, center + half], center, longest * GROWTH)
}
