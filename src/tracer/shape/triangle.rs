//! A triangle, without gaps to its neighbors.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        around::{Around, farthest},
        contact::{ContactPoint, FaceEdge, FaceEquation, NearFace},
        face::Leaving,
        plane::{Planar, Plane},
        working::{Term, Working},
    },
    vector::{farthest_along, finite},
};

/// A triangle with the corners `a`, `b` and `c`, seen from both sides.
///
/// Its normal is `(b - a) × (c - a)`. A ray through an edge or a corner that several triangles share
/// hits at least one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    corners: [DVec3; 3],
    plane: Plane,
    around: Around,
}

/// A ray as the test of triangles needs it: along one axis of space, sheared and scaled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheared {
    origin: DVec3,
    /// The axis of the largest component of the direction, and the two others.
    along: usize,
    across: [usize; 2],
    /// `Sx`, `Sy` and `Sz`.
    shear: DVec3,
}

/// The terms of a triangle's equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edges {
    /// `U`, `V` and `W`: twice the areas between the ray and two corners, which lie opposite to `a`,
    /// `b` and `c`.
    pub(crate) uvw: [f64; 3],
    /// `D = (U + V) + W`.
    pub(crate) sum: f64,
    /// `t·D`.
    pub(crate) scaled_t: f64,
}

impl Sheared {
    /// Prepares a ray.
    #[inline]
    pub(crate) fn new(ray: &Ray) -> Self {
        let (d, size) = (ray.direction().to_array(), ray.direction().abs());
        // Numbers in place of branches, which nobody could foresee.
        let (is_x, is_y) = (size.x >= size.y && size.x >= size.z, size.y >= size.z);
        let along = usize::from(!is_x) * (1 + usize::from(!is_y));
        let is_back = usize::from(d[along] < 0.0);
        let across = [(along + 1 + is_back) % 3, (along + 2 - is_back) % 3];
        let shear = DVec3::new(
            d[across[0]] / d[along],
            d[across[1]] / d[along],
            1.0 / d[along],
        );
        Self {
            origin: ray.origin(),
            along,
            across,
            shear,
        }
    }

    /// Returns a corner as the ray sees it: across, then along.
    #[inline]
    fn corner(&self, corner: &DVec3) -> [f64; 3] {
        // By numbers in memory: a vector would be asked for its axes by branches.
        let (origin, corner): (&[f64; 3], &[f64; 3]) = (self.origin.as_ref(), corner.as_ref());
        let axis = |axis: usize| corner[axis] - origin[axis];
        let ([x, y], along) = (self.across, axis(self.along));
        [
            axis(x) - self.shear.x * along,
            axis(y) - self.shear.y * along,
            self.shear.z * along,
        ]
    }

    /// Returns the terms of a triangle (Woop, Benthin and Wald, "Watertight Ray/Triangle
    /// Intersection", JCGT 2013).
    #[inline]
    pub(crate) fn edges(&self, corners: [&DVec3; 3]) -> Edges {
        let [a, b, c] = corners.map(|corner| self.corner(corner));
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        Edges {
            uvw: [u, v, w],
            sum: (u + v) + w,
            scaled_t: (u * a[2] + v * b[2]) + w * c[2],
        }
    }
}

/// Calls `see` with a triangle as a face beside a point, unless it is far away.
pub(crate) fn see_triangle(
    at: &ContactPoint,
    face: u64,
    corners: [DVec3; 3],
    see: &mut dyn FnMut(&NearFace),
) {
    let [a, b, c] = corners;
    let n = (b - a).cross(c - a);
    let equation = FaceEquation::plane(at, a, n);
    let edges = || FaceEdge::of_polygon(&corners, n, at.point);
    at.see(face, &equation, edges, see);
}

impl Sheared {
    /// The origin of the ray.
    #[inline(always)]
    pub(crate) const fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The axes across, then the one along.
    #[inline(always)]
    pub(crate) const fn axes(&self) -> [usize; 3] {
        let [x, y] = self.across;
        [x, y, self.along]
    }

    /// `Sx`, `Sy` and `Sz`.
    #[inline(always)]
    pub(crate) const fn shear(&self) -> DVec3 {
        self.shear
    }

    /// Returns the shear with its name in data.
    pub(crate) fn term(&self) -> Term {
        Term::vector("shear", "(Sx, Sy, Sz)", self.shear)
    }

    /// Returns the corners of a triangle and the terms of its equation, with their names in data, which
    /// begin with `prefix`.
    pub(crate) fn terms(&self, prefix: &str, corners: [DVec3; 3]) -> [Vec<Term>; 2] {
        let Edges {
            uvw: [u, v, w],
            sum,
            ..
        } = self.edges(corners.each_ref());
        let corner = |name: &str, symbol: &'static str, corner: &DVec3| {
            let corner = self.corner(corner).into();
            Term::vector(format!("{prefix}sheared_{name}"), symbol, corner)
        };
        let number = |name: &str, symbol: &'static str, number| {
            Term::number(format!("{prefix}{name}"), symbol, number)
        };
        let [a, b, c] = &corners;
        [
            vec![
                corner("a", "(Ax, Ay, Az)", a),
                corner("b", "(Bx, By, Bz)", b),
                corner("c", "(Cx, Cy, Cz)", c),
            ],
            vec![
                number("u", "U", u),
                number("v", "V", v),
                number("w", "W", w),
                number("sum", "D", sum),
            ],
        ]
    }
}

impl Edges {
    /// Returns true if the ray's line hits the triangle.
    #[inline]
    pub(crate) fn is_hit(&self) -> bool {
        let [u, v, w] = self.uvw;
        let is_outside = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
        !is_outside && self.sum != 0.0
    }

    /// Returns the weights of the corners at the point that the ray's line hits: their sum is 1 but
    /// for rounding.
    #[inline]
    pub(crate) fn weights(&self) -> [f64; 3] {
        self.uvw.map(|area| area / self.sum)
    }

    /// Returns the `t` at which the ray's line hits the triangle.
    #[inline]
    pub(crate) fn t(&self) -> Option<f64> {
        self.is_hit().then(|| self.scaled_t / self.sum)
    }
}

impl Triangle {
    /// Creates a triangle.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, or if the corners lie on a line: the squared
    /// length of `(b - a) × (c - a)` in f64 is 0 or not finite.
    pub fn new(a: DVec3, b: DVec3, c: DVec3) -> Result<Self, GeometryError> {
        let (a, b, c) = (finite(a, "a")?, finite(b, "b")?, finite(c, "c")?);
        Ok(Self {
            corners: [a, b, c],
            around: Around::points(&[a, b, c]),
            plane: Plane::new(a, (b - a).cross(c - a))?,
        })
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        see_triangle(at, 0, self.corners, see);
    }

    /// The corners.
    pub const fn corners(&self) -> [DVec3; 3] {
        self.corners
    }

    pub(crate) const fn around(&self) -> Option<Around> {
        Some(self.around)
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        farthest_along(self.corners, direction)
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let sheared = Sheared::new(ray);
        let [a, b, c] = self.corners;
        let [seen, equation] = sheared.terms("", self.corners);
        Working {
            form: None,
            parts: vec![
                Term::vector("a", "a", a),
                Term::vector("b", "b", b),
                Term::vector("c", "c", c),
            ],
            lines: vec![vec![sheared.term()], seen, equation],
            solutions: self.crossings(ray, Leaving::NOTHING).solutions(),
            name: None,
        }
    }

    pub(crate) fn numbers(&self) -> impl IntoIterator<Item = f64> + use<> {
        let corners = self.corners.map(|corner| corner.to_array());
        corners.into_iter().flatten()
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        farthest(&self.corners, point)
    }
}

impl Planar for Triangle {
    const PLANE: &'static str = "the plane of this triangle";

    fn in_plane(&self) -> &Plane {
        &self.plane
    }

    #[inline]
    fn t(&self, ray: &Ray) -> Option<f64> {
        let t = Sheared::new(ray).edges(self.corners.each_ref()).t()?;
        self.around.holds(ray, t).then_some(t)
    }
}
