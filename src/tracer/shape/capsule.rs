//! A capsule: a cylinder with hemispherical ends.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        around::Around,
        axis::{Axis, outward},
        contact::{ContactPoint, FaceEdge, FaceEquation, NearFace},
        face::{Faces, Leaving},
        span::{Convex, Round, Span},
        working::{Term, Working},
    },
    vector::{farthest_along, positive},
};

/// The part of the radius by which a point may lie on the side and on a ball beside the joint: 2⁻²⁰.
const JOINT: f64 = 1.0 / (1 << 20) as f64;

/// All points at the distance `r` from the line between a point `a` and a point `b`.
///
/// Face 0 is the side, 1 the round end at `a` and 2 the one at `b`.
///
/// A ray enters where it first enters the side, between the ends, or a ball at an end, and comes out
/// where it last comes out of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    axis: Axis,
    radius: f64,
    around: Around,
}

impl Capsule {
    /// Creates a capsule around the line between two points.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, if the squared distance of the points in f64 is 0
    /// or not finite, or if `radius` is not above 0.
    pub fn new(from: DVec3, to: DVec3, radius: f64) -> Result<Self, GeometryError> {
        let axis = Axis::new(from, to)?;
        let radius = positive(radius, "radius")?;
        let half = (to - from) * 0.5;
        let corners = [from.min(to) - radius, from.max(to) + radius];
        Ok(Self {
            axis,
            radius,
            around: Around::new(corners, from + half, half.length() + radius),
        })
    }

    /// The center of the first end.
    pub const fn from(&self) -> DVec3 {
        self.axis.from
    }

    /// The center of the other end.
    pub const fn to(&self) -> DVec3 {
        self.axis.to
    }

    /// The radius, above 0.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    pub(crate) const fn axis(&self) -> &Axis {
        &self.axis
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        let end = farthest_along([self.from(), self.to()], direction)?;
        Some(end + self.radius * direction)
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        // Where they are tangent, a point lies on both even a little before the joint.
        let joint = JOINT * self.radius;
        let (w, length) = (self.axis.w, self.axis.length());
        let height = (at.point - self.from()).dot(w);
        let within = |[low, high]: [f64; 2]| {
            move || FaceEdge::of_interval(height, [low - joint, high + joint], w)
        };
        let side = self.axis.side(at, self.radius, 0.0);
        at.see(0, &side, within([0.0, length]), see);
        let ends = [
            (1, self.from(), [f64::NEG_INFINITY, 0.0]),
            (2, self.to(), [length, f64::INFINITY]),
        ];
        for (face, center, heights) in ends {
            let ball = FaceEquation::ball(at, center, self.radius);
            at.see(face, &ball, within(heights), see);
        }
    }

    /// Returns the spans of the side and of both balls.
    #[inline]
    fn rounds(&self, ray: &Ray, leaving: Leaving) -> [Option<Span>; 3] {
        let (q, e) = self.axis.across(ray);
        let d = ray.direction();
        let round =
            |face: u64, q: DVec3, d: DVec3| Span::round(q, d, self.radius, leaving.has(face), face);
        [
            round(0, q, e),
            round(1, ray.origin() - self.from(), d),
            round(2, ray.origin() - self.to(), d),
        ]
    }

    pub(crate) const FACES: Faces = Faces::Several;

    pub(crate) fn normal_on(&self, face: u64, ray: &Ray, t: f64) -> DVec3 {
        let (q, d) = match face {
            1 => (ray.origin() - self.from(), ray.direction()),
            2 => (ray.origin() - self.to(), ray.direction()),
            _ => self.axis.across(ray),
        };
        outward(q + t * d, ray)
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let (q, e) = self.axis.across(ray);
        let (o, d) = (ray.origin(), ray.direction());
        Working {
            form: None,
            parts: vec![
                Term::vector("from", "from a", self.from()),
                Term::vector("to", "to b", self.to()),
                Term::number("radius", "radius r", self.radius),
            ],
            lines: vec![
                vec![
                    Term::vector("w", "w", self.axis.w),
                    Term::vector("q", "q", q),
                    Term::vector("e", "e", e),
                ],
                self.axis.terms(ray),
                Round::terms("side_", q, e, self.radius),
                Round::terms("from_", o - self.from(), d, self.radius),
                Round::terms("to_", o - self.to(), d, self.radius),
            ],
            solutions: self.crossings(ray, Leaving::NOTHING).solutions(),
            name: Some("crossings"),
        }
    }

    pub(crate) fn numbers(&self) -> impl IntoIterator<Item = f64> + use<> {
        self.axis.numbers().into_iter().chain([self.radius])
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        let distance = |end: DVec3| (end - point).length() + self.radius;
        distance(self.from()).max(distance(self.to()))
    }
}

impl Convex for Capsule {
    #[inline]
    fn hull(&self) -> &Around {
        &self.around
    }

    /// Returns the part of the line inside.
    #[inline]
    fn span(&self, ray: &Ray, leaving: Leaving) -> Option<Span> {
        let rounds = self.rounds(ray, leaving);
        let mut left = leaving.faces().filter_map(|face| rounds.get(face as usize));
        let is_outward = left.any(|own| own.is_some_and(|own| own.exit.t <= 0.0));
        let [side, from, to] = rounds;
        let ends = self.axis.span(ray, Leaving::NOTHING);
        let on_side = side
            .zip(ends)
            .into_iter()
            .flat_map(|(side, ends)| side.within(ends).0)
            .flatten();
        let on_balls = [from, to]
            .into_iter()
            .flatten()
            .flat_map(|ball| [ball.enter, ball.exit]);
        let mut span = on_side
            .chain(on_balls)
            .fold(None, |span: Option<Span>, at| {
                let Some(Span { enter, exit }) = span else {
                    return Some(Span {
                        enter: at,
                        exit: at,
                    });
                };
                Some(Span {
                    enter: if at.t < enter.t { at } else { enter },
                    exit: if at.t > exit.t { at } else { exit },
                })
            })?;
        if !leaving.is_empty() {
            // The shape is convex.
            let end = if is_outward {
                &mut span.exit
            } else {
                &mut span.enter
            };
            end.t = 0.0;
            span.enter.t = span.enter.t.min(0.0);
        }
        Some(span)
    }

    /// Returns a depth below the surface: above 0 inside, 0 on it and below 0 outside.
    fn depth(&self, point: DVec3) -> f64 {
        let (height, away) = self.axis.place_of(point);
        let is_beside = (0.0..=1.0).contains(&(height / self.axis.length()));
        let ends = [self.from(), self.to()].map(|end| (point - end).length());
        let nearest = ends[0].min(ends[1]);
        self.radius
            - if is_beside {
                nearest.min(away)
            } else {
                nearest
            }
    }
}
