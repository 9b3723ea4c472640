//! A parallelogram.

use std::iter;

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        around::{Around, farthest},
        contact::{ContactPoint, FaceEdge, FaceEquation, NearFace},
        face::{Crossing, Leaving, in_front},
        plane::{Planar, Plane},
        triangle::Sheared,
        working::{Term, Working},
    },
    vector::{farthest_along, finite},
};

/// A parallelogram with a corner `a` and the edges `u` and `v` from there, seen from both sides.
///
/// Its normal is `u × v`. Its edges are those of two triangles, so that there are no gaps where
/// rectangles and triangles share one; its `t` is that of its plane, so that of two rectangles in one
/// plane along the axes, the first is seen.
///
/// A ray meets it where it meets its plane, if it hits the triangle `a`, `a + u`, `(a + u) + v` or
/// `a`, `(a + u) + v`, `a + v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    edges: [DVec3; 2],
    /// The corners, in their order around the middle.
    corners: [DVec3; 4],
    /// The plane, with the normal `u × v` and with that normal at unit length.
    plane: Plane,
    unit_plane: Plane,
    around: Around,
}

impl Rectangle {
    /// Creates a parallelogram from a corner and two edges.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, or if the edges are parallel: the squared length
    /// of `u × v` in f64 is 0 or not finite.
    pub fn new(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> Result<Self, GeometryError> {
        let corner = finite(corner, "corner")?;
        let (u, v) = (finite(edge_u, "edge_u")?, finite(edge_v, "edge_v")?);
        let opposite = finite((corner + u) + v, "corner + edge_u + edge_v")?;
        let plane = Plane::new(corner, u.cross(v))?;
        let corners = [corner, corner + u, opposite, corner + v];
        Ok(Self {
            edges: [u, v],
            corners,
            around: Around::points(&corners),
            plane,
            unit_plane: Plane::new(corner, plane.unit_normal())?,
        })
    }

    /// The first corner.
    pub const fn corner(&self) -> DVec3 {
        self.corners[0]
    }

    /// The two edges at the first corner.
    pub const fn edges(&self) -> [DVec3; 2] {
        self.edges
    }

    pub(crate) const fn around(&self) -> Option<Around> {
        Some(self.around)
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        farthest_along(self.corners, direction)
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        let n = self.plane.normal();
        let equation = FaceEquation::plane(at, self.corner(), n);
        let edges = || FaceEdge::of_polygon(&self.corners, n, at.point);
        at.see(0, &equation, edges, see);
    }

    /// The four corners, in their order around it.
    pub(crate) const fn corners(&self) -> [DVec3; 4] {
        self.corners
    }

    /// The box and the ball around it.
    pub(crate) const fn ball(&self) -> &Around {
        &self.around
    }

    /// The plane with a unit normal.
    pub(crate) const fn unit_plane(&self) -> &Plane {
        &self.unit_plane
    }

    const fn halves(&self) -> [[DVec3; 3]; 2] {
        let [a, b, c, d] = self.corners;
        [[a, b, c], [a, c, d]]
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let sheared = Sheared::new(ray);
        let [first, second] = self.halves();
        let halves = [("first_", first), ("second_", second)];
        let halves = halves.map(|(prefix, corners)| sheared.terms(prefix, corners));
        let (numerator, denominator) = self.unit_plane.terms(ray);
        let plane = vec![
            Term::vector("unit_normal", "n", self.unit_plane.normal()),
            Term::number("numerator", "(a - o)·n", numerator),
            Term::number("denominator", "d·n", denominator),
        ];
        let [u, v] = self.edges;
        Working {
            form: None,
            parts: vec![
                Term::vector("corner", "corner a", self.corner()),
                Term::vector("edge_u", "edge_u", u),
                Term::vector("edge_v", "edge_v", v),
            ],
            lines: iter::once(vec![sheared.term()])
                .chain(halves.into_iter().flatten())
                .chain([plane])
                .collect(),
            solutions: self.crossings(ray, Leaving::NOTHING).solutions(),
            name: None,
        }
    }

    pub(crate) fn numbers(&self) -> impl IntoIterator<Item = f64> + use<> {
        let [u, v] = self.edges;
        let all = [self.corner(), u, v].map(|vector| vector.to_array());
        all.into_iter().flatten()
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        farthest(&self.corners, point)
    }

    /// Returns its crossing with `0 < t < t_max`. Nearly all rays that do not meet it are known by the `t` of its
    /// plane.
    #[inline]
    pub(super) fn first(&self, ray: &Ray, leaving: Leaving, t_max: f64) -> Option<Crossing> {
        let t = leaving.is_empty().then(|| self.unit_plane.t(ray))??;
        (in_front(t, t_max).is_some() && self.is_hit(ray, t)).then(|| t.into())
    }

    /// Returns true if the ray's line, which meets the plane at `t`, hits the rectangle.
    #[inline]
    fn is_hit(&self, ray: &Ray, t: f64) -> bool {
        // Nearly all rays that miss it miss the box around it, too, which is sooner known.
        if !self.around.holds(ray, t) {
            return false;
        }
        let sheared = Sheared::new(ray);
        let mut halves = self.halves().into_iter();
        halves.any(|half| sheared.edges(half.each_ref()).is_hit())
    }
}

impl Planar for Rectangle {
    const PLANE: &'static str = "the plane of this rectangle";

    fn in_plane(&self) -> &Plane {
        &self.plane
    }

    /// Returns the `t` at which the ray's line hits the rectangle.
    #[inline]
    fn t(&self, ray: &Ray) -> Option<f64> {
        self.unit_plane.t(ray).filter(|t| self.is_hit(ray, *t))
    }
}
