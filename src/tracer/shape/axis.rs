//! The axis of a round shape, between two points.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        around::Around,
        contact::{ContactPoint, FaceEdge, FaceEquation, NearFace},
        face::Leaving,
        plane::Plane,
        span::Span,
        working::Term,
    },
    vector::{direction, farthest_along, finite, is_direction, rim, unit},
};

/// A line between two points, which a shape is round about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axis {
    pub(crate) from: DVec3,
    pub(crate) to: DVec3,
    /// The unit vector `w` from `from` to `to`.
    pub(crate) w: DVec3,
    /// The planes of the two ends. Their normals are as long as the axis and point away from each
    /// other.
    pub(crate) ends: [Plane; 2],
}

impl Axis {
    /// Creates the axis between two points.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, or if the squared distance of the points in f64 is
    /// 0 or not finite.
    pub(crate) fn new(from: DVec3, to: DVec3) -> Result<Self, GeometryError> {
        let (from, to) = (finite(from, "from")?, finite(to, "to")?);
        let along = direction(to - from, "to - from")?;
        Ok(Self {
            from,
            to,
            w: unit(along),
            ends: [Plane::new(from, -along)?, Plane::new(to, along)?],
        })
    }

    /// Returns the ray's origin relative to `from` and its direction, both without the parts along
    /// the axis: `q - (q·w)·w`.
    #[inline]
    pub(crate) fn across(&self, ray: &Ray) -> (DVec3, DVec3) {
        let across = |v: DVec3| v - v.dot(self.w) * self.w;
        (across(ray.origin() - self.from), across(ray.direction()))
    }

    /// Returns the distances of the two ends above the ray's origin, along the axis.
    #[inline]
    pub(crate) fn heights(&self, ray: &Ray) -> [f64; 2] {
        [self.from, self.to].map(|end| (end - ray.origin()).dot(self.w))
    }

    /// Returns the span between the ends.
    #[inline]
    pub(crate) fn span(&self, ray: &Ray, leaving: Leaving) -> Option<Span> {
        let mut heights = self.heights(ray);
        if !leaving.is_empty() {
            for (height, end) in heights.iter_mut().zip(1..) {
                *height = if leaving.has(end) { 0.0 } else { *height };
            }
        }
        Span::slab(heights, ray.direction().dot(self.w), [1, 2])
    }

    /// Returns the terms of the ends.
    pub(crate) fn terms(&self, ray: &Ray) -> Vec<Term> {
        let [from, to] = self.heights(ray);
        vec![
            Term::number("from_height", "(a - o)·w", from),
            Term::number("to_height", "(b - o)·w", to),
            Term::number("rise", "d·w", ray.direction().dot(self.w)),
        ]
    }

    /// Returns the plane of an end, by the number of its face: 1 or 2.
    pub(crate) fn end(&self, face: u64) -> Option<Plane> {
        match face {
            1 => Some(self.ends[0]),
            2 => Some(self.ends[1]),
            _ => None,
        }
    }

    pub(crate) fn numbers(&self) -> [f64; 6] {
        let [a, b] = [self.from, self.to];
        [a.x, a.y, a.z, b.x, b.y, b.z]
    }

    /// The distance of the ends.
    pub(crate) fn length(&self) -> f64 {
        (self.to - self.from).length()
    }

    /// Returns the box and the ball around two discs at the ends.
    pub(crate) fn around(&self, radii: [f64; 2]) -> Around {
        // Along a coordinate axis x, a rim extends to r·|x × w|.
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let beside = DVec3::from(axes.map(|axis| axis.cross(self.w).length()));
        let [one, other] = radii.map(|radius| radius * beside);
        let low = (self.from - one).min(self.to - other);
        let high = (self.from + one).max(self.to + other);
        let half = (self.to - self.from) * 0.5;
        let radius = radii[0].max(radii[1]);
        let radius = (half.dot(half) + radius * radius).sqrt();
        Around::new([low, high], self.from + half, radius)
    }

    /// Returns the farthest point of two discs at the ends in a direction.
    pub(crate) fn support(&self, radii: [f64; 2], direction: DVec3) -> Option<DVec3> {
        let rim = rim(self.w, direction);
        let [one, other] = radii.map(|radius| radius * rim);
        farthest_along([self.from + one, self.to + other], direction)
    }

    /// Returns the distance from a point to the farthest point of two discs at the ends.
    pub(crate) fn farthest_from(&self, point: DVec3, radii: [f64; 2]) -> f64 {
        let distance = |end: DVec3, radius: f64| {
            let above = (end - point).dot(self.w);
            let beside = ((end - point) - above * self.w).length() + radius;
            (beside * beside + above * above).sqrt()
        };
        distance(self.from, radii[0]).max(distance(self.to, radii[1]))
    }

    /// Returns the depth of a point below the plane of the nearer end: above 0 between the two, and 0
    /// on one of them, exactly so if it is the end itself.
    pub(crate) fn depth(&self, point: DVec3) -> f64 {
        let (above, below) = (
            (point - self.from).dot(self.w),
            (self.to - point).dot(self.w),
        );
        above.min(below)
    }

    /// Calls `see` with a round side, whose radius grows by `slope` per length along the axis, and with
    /// the caps at the ends, if there are some.
    pub(crate) fn each_face(
        &self,
        at: &ContactPoint,
        (radii, slope): ([f64; 2], f64),
        is_capped: bool,
        see: &mut dyn FnMut(&NearFace),
    ) {
        let side = self.side(at, radii[0], slope);
        let (q, length) = (at.point - self.from, self.length());
        let height = q.dot(self.w);
        let across = q - height * self.w;
        let ends = || FaceEdge::of_interval(height, [0.0, length], self.w);
        at.see(0, &side, ends, see);
        let caps = [(1, self.from, radii[0]), (2, self.to, radii[1])];
        for (face, center, radius) in caps.into_iter().filter(|_| is_capped) {
            let equation = FaceEquation::plane(at, center, self.w);
            at.see(face, &equation, || FaceEdge::of_circle(across, radius), see);
        }
    }

    /// Returns the equation of a round side: the distance from the axis less `r + k·h` at the height h.
    pub(crate) fn side(&self, at: &ContactPoint, radius: f64, slope: f64) -> FaceEquation {
        let q = at.point - self.from;
        let height = q.dot(self.w);
        let across = q - height * self.w;
        let away = across.length();
        FaceEquation {
            value: away - (radius + slope * height),
            gradient: across / away - slope * self.w,
            size: self.from.abs() + self.to.abs() + radius,
            more: 0.0,
        }
    }

    /// Returns the height of a point above `from` and its distance from the axis.
    pub(crate) fn place_of(&self, point: DVec3) -> (f64, f64) {
        let q = point - self.from;
        let height = q.dot(self.w);
        (height, (q - height * self.w).length())
    }
}

/// Returns a vector at unit length, or the direction back along the ray if it has no direction.
pub(crate) fn outward(vector: DVec3, ray: &Ray) -> DVec3 {
    if is_direction(vector) {
        unit(vector)
    } else {
        unit(-ray.direction())
    }
}
