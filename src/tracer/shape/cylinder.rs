//! A cylinder, closed or open at its ends.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        around::Around,
        axis::{Axis, outward},
        contact::{ContactPoint, NearFace},
        face::{Crossings, Faces, Leaving},
        span::{Convex, Round, Span},
        working::{Term, Working, open},
    },
    vector::positive,
};

/// A cylinder around the line from a point `a` to a point `b`, with a radius `r`.
///
/// A capped one is closed by two flat caps. One that is not capped is an open tube, seen from both
/// sides. Face 0 is the side, 1 the cap at `a` and 2 the cap at `b`.
///
/// With the unit vector `w` along the axis, `q = (o - a) - ((o - a)·w)·w` and `e = d - (d·w)·w`, a
/// ray is inside the side where `|q + t·e| ≤ r`, and between the ends from `((a - o)·w)/(d·w)` to
/// `((b - o)·w)/(d·w)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    axis: Axis,
    radius: f64,
    capped: bool,
    around: Around,
}

impl Cylinder {
    /// Creates a cylinder between two points.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, if the squared distance of the points in f64 is 0
    /// or not finite, or if `radius` is not above 0.
    pub fn new(from: DVec3, to: DVec3, radius: f64, capped: bool) -> Result<Self, GeometryError> {
        let axis = Axis::new(from, to)?;
        let radius = positive(radius, "radius")?;
        Ok(Self {
            axis,
            radius,
            capped,
            around: axis.around([radius; 2]),
        })
    }

    /// The point in the middle of the first end.
    pub const fn from(&self) -> DVec3 {
        self.axis.from
    }

    /// The point in the middle of the other end.
    pub const fn to(&self) -> DVec3 {
        self.axis.to
    }

    /// The radius, above 0.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// True if the ends are closed.
    pub const fn capped(&self) -> bool {
        self.capped
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        self.axis.support([self.radius; 2], direction)
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        let round = ([self.radius; 2], 0.0);
        self.axis.each_face(at, round, self.capped, see);
    }

    pub(crate) const fn axis(&self) -> &Axis {
        &self.axis
    }

    /// Returns the spans of the side and between the ends.
    #[inline]
    fn spans(&self, ray: &Ray, leaving: Leaving) -> Option<[Span; 2]> {
        let (q, e) = self.axis.across(ray);
        let side = Span::round(q, e, self.radius, leaving.has(0), 0)?;
        Some([side, self.axis.span(ray, leaving)?])
    }

    pub(crate) const FACES: Faces = Faces::Several;

    pub(crate) fn normal_on(&self, face: u64, ray: &Ray, t: f64) -> DVec3 {
        self.axis.end(face).map_or_else(
            || {
                let (q, e) = self.axis.across(ray);
                outward(q + t * e, ray)
            },
            |cap| cap.unit_normal(),
        )
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let (q, e) = self.axis.across(ray);
        Working {
            form: open(self.capped),
            parts: vec![
                Term::vector("from", "from a", self.from()),
                Term::vector("to", "to b", self.to()),
                Term::number("radius", "radius r", self.radius),
            ],
            lines: vec![
                vec![Term::vector("w", "w", self.axis.w)],
                vec![Term::vector("q", "q", q), Term::vector("e", "e", e)],
                Round::terms("", q, e, self.radius),
                self.axis.terms(ray),
            ],
            solutions: self.crossings(ray, Leaving::NOTHING).solutions(),
            name: Some("crossings"),
        }
    }

    pub(crate) fn numbers(&self) -> impl IntoIterator<Item = f64> + use<> {
        let last = [self.radius, f64::from(u8::from(self.capped))];
        self.axis.numbers().into_iter().chain(last)
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        self.axis.farthest_from(point, [self.radius; 2])
    }
}

impl Convex for Cylinder {
    #[inline]
    fn hull(&self) -> &Around {
        &self.around
    }

    /// Returns the part of the line inside, between the caps.
    #[inline]
    fn span(&self, ray: &Ray, leaving: Leaving) -> Option<Span> {
        let [side, ends] = self.spans(ray, leaving)?;
        side.and(ends)
    }

    #[inline]
    fn crossings(&self, ray: &Ray, leaving: Leaving) -> Crossings {
        let spans = self.spans(ray, leaving);
        let crossings = spans.map(|[side, ends]| side.between_ends(ends, self.capped, leaving));
        crossings.unwrap_or_default().near(&self.around, ray)
    }

    fn is_closed(&self) -> bool {
        self.capped
    }

    /// Returns a depth below the surface, as if capped: above 0 inside, 0 on it and below 0 outside.
    fn depth(&self, point: DVec3) -> f64 {
        let (_, away) = self.axis.place_of(point);
        self.axis.depth(point).min(self.radius - away)
    }
}
