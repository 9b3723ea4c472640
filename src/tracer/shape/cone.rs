//! A cone or the frustum of one, closed or open at its ends.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        around::Around,
        axis::{Axis, outward},
        contact::{ContactPoint, NearFace},
        face::{Crossings, Faces, Leaving},
        span::{Convex, Span},
        working::{Term, Working, open},
    },
    vector::{in_range, is_direction, positive, unit},
};

/// A cone around the line from a point `a` to a point `b`, with a radius `r` at `a` and a smaller,
/// equal or larger one at `b`, which may be 0: then `b` is the tip.
///
/// A capped one is closed by two flat caps. One that is not capped is open, and seen from both sides.
/// Face 0 is the side, 1 the cap at `a` and 2 the cap at `b`.
///
/// The equations are those of the manual of the format. The double cone is cut by the planes of the
/// two ends, so that its other half is never hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    axis: Axis,
    radius: f64,
    top_radius: f64,
    /// The growth of the radius per length along the axis, `k`.
    slope: f64,
    capped: bool,
    around: Around,
}

/// The equation `A·t² + 2H·t + C ≤ 0` of the points inside the double cone.
#[derive(Clone, Copy, Debug)]
struct Terms {
    /// The `t` of the point that the others are relative to.
    middle: f64,
    /// That point and the direction of the ray, without the parts along the axis.
    p: DVec3,
    e: DVec3,
    /// The radius at the height of that point, `ρ = r + k·(g·w)`.
    radius: f64,
    /// The growth of the radius along the ray, `σ = k·(d·w)`.
    growth: f64,
    /// `ρ·e - σ·p`.
    v: DVec3,
    /// `e × p`.
    x: DVec3,
    a: f64,
    h: f64,
    c: f64,
    /// `H² - A·C`.
    discriminant: f64,
}

impl Cone {
    /// Creates a cone between two points.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, if the squared distance of the points in f64 is 0
    /// or not finite, if `radius` is not above 0, or if `top_radius` is below 0.
    pub fn new(
        from: DVec3,
        to: DVec3,
        radius: f64,
        top_radius: f64,
        capped: bool,
    ) -> Result<Self, GeometryError> {
        let axis = Axis::new(from, to)?;
        let radius = positive(radius, "radius")?;
        let top_radius = in_range(top_radius, "top_radius", [0.0, f64::MAX])?;
        let slope = (top_radius - radius) / axis.length();
        Ok(Self {
            axis,
            radius,
            top_radius,
            slope,
            capped,
            around: axis.around([radius, top_radius]),
        })
    }

    /// The point in the middle of the first end.
    pub const fn from(&self) -> DVec3 {
        self.axis.from
    }

    /// The point in the middle of the other end, or the tip.
    pub const fn to(&self) -> DVec3 {
        self.axis.to
    }

    /// The radius of the first end, above 0.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// The radius of the other end; 0 for a tip.
    pub const fn top_radius(&self) -> f64 {
        self.top_radius
    }

    /// True if the ends are closed.
    pub const fn capped(&self) -> bool {
        self.capped
    }

    pub(crate) const fn axis(&self) -> &Axis {
        &self.axis
    }

    /// The growth of the radius along the axis.
    pub(crate) const fn slope(&self) -> f64 {
        self.slope
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        let radii = [self.radius, self.top_radius];
        self.axis.support(radii, direction)
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        let round = ([self.radius, self.top_radius], self.slope);
        self.axis.each_face(at, round, self.capped, see);
    }

    /// Returns the terms of the side, relative to the point of the ray at `middle`.
    #[inline]
    fn terms(&self, ray: &Ray, middle: f64) -> Terms {
        let w = self.axis.w;
        let q = (ray.origin() - self.axis.from) + middle * ray.direction();
        let (height, rise) = (q.dot(w), ray.direction().dot(w));
        let (p, e) = (q - height * w, ray.direction() - rise * w);
        let (radius, growth) = (self.radius + self.slope * height, self.slope * rise);
        // H² - AC without the difference of large numbers.
        let (v, x) = (radius * e - growth * p, e.cross(p));
        Terms {
            middle,
            p,
            e,
            radius,
            growth,
            v,
            x,
            a: e.dot(e) - growth * growth,
            h: p.dot(e) - radius * growth,
            c: p.dot(p) - radius * radius,
            discriminant: v.dot(v) - x.dot(x),
        }
    }

    /// Returns the terms relative to the point of the ray that is nearest to `a`.
    #[inline]
    fn nearest_terms(&self, ray: &Ray) -> Terms {
        self.terms(ray, ray.t_of(self.axis.from))
    }

    /// Returns the spans of the side and between the ends.
    #[inline]
    fn spans(&self, ray: &Ray, leaving: Leaving) -> Option<[Span; 2]> {
        let side = if leaving.has(0) {
            let terms = self.terms(ray, 0.0);
            let c = 0.0;
            let discriminant = terms.h * terms.h;
            Terms {
                c,
                discriminant,
                ..terms
            }
            .span()?
        } else {
            self.nearest_terms(ray).span()?
        };
        Some([side, self.axis.span(ray, leaving)?])
    }

    pub(crate) const FACES: Faces = Faces::Several;

    pub(crate) fn normal_on(&self, face: u64, ray: &Ray, t: f64) -> DVec3 {
        if let Some(cap) = self.axis.end(face) {
            return cap.unit_normal();
        }
        let (q, e) = self.axis.across(ray);
        let across = q + t * e;
        let normal = if is_direction(across) {
            unit(across) - self.slope * self.axis.w
        } else {
            DVec3::ZERO
        };
        outward(normal, ray)
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let terms = self.nearest_terms(ray);
        let nearest = (ray.origin() - self.axis.from) + terms.middle * ray.direction();
        Working {
            form: open(self.capped),
            parts: vec![
                Term::vector("from", "from a", self.from()),
                Term::vector("to", "to b", self.to()),
                Term::number("radius", "radius r", self.radius),
                Term::number("top_radius", "top_radius", self.top_radius),
            ],
            lines: vec![
                vec![
                    Term::vector("w", "w", self.axis.w),
                    Term::number("slope", "k", self.slope),
                    Term::number("middle", "m", terms.middle),
                    Term::vector("nearest", "g", nearest),
                ],
                terms.side(),
                terms.equation(),
                self.axis.terms(ray),
            ],
            solutions: self.crossings(ray, Leaving::NOTHING).solutions(),
            name: Some("crossings"),
        }
    }

    pub(crate) fn numbers(&self) -> impl IntoIterator<Item = f64> + use<> {
        let capped = f64::from(u8::from(self.capped));
        let last = [self.radius, self.top_radius, capped];
        self.axis.numbers().into_iter().chain(last)
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        self.axis
            .farthest_from(point, [self.radius, self.top_radius])
    }
}

impl Convex for Cone {
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
        let (height, away) = self.axis.place_of(point);
        let radius = self.radius + self.slope * height;
        self.axis.depth(point).min(radius - away)
    }
}

impl Terms {
    /// Returns the terms of the side with their names in data.
    fn side(&self) -> Vec<Term> {
        vec![
            Term::vector("p", "p", self.p),
            Term::vector("e", "e", self.e),
            Term::number("rho", "ρ", self.radius),
            Term::number("sigma", "σ", self.growth),
            Term::vector("v", "v", self.v),
            Term::vector("x", "x", self.x),
        ]
    }

    /// Returns the terms of the equation with their names in data; `h` is that of a ray which meets the
    /// double cone.
    fn equation(&self) -> Vec<Term> {
        let mut terms = vec![
            Term::number("a", "A", self.a),
            Term::number("h", "H", self.h),
            Term::number("c", "C", self.c),
            Term::number("discriminant", "D", self.discriminant),
        ];
        if self.a != 0.0 && self.discriminant >= 0.0 {
            terms.push(Term::number("k", "h", self.k()));
        }
        terms
    }

    /// Returns `h = -(H ± √D)`, with the sign of `H`; `D` below 0 is a rounded 0.
    #[inline]
    fn k(&self) -> f64 {
        -(self.h + self.discriminant.max(0.0).sqrt().copysign(self.h))
    }

    /// Returns the part of the line inside the half of the double cone where the radius is above 0:
    /// with `A < 0` the line is inside both halves, in the right one where the radius grows.
    #[inline]
    fn span(&self) -> Option<Span> {
        let Self {
            middle,
            a,
            h,
            c,
            discriminant,
            growth,
            ..
        } = *self;
        let whole = [f64::NEG_INFINITY, f64::INFINITY];
        let [start, end] = if a == 0.0 {
            let root = middle - c / (2.0 * h);
            if h > 0.0 {
                [whole[0], root]
            } else if h < 0.0 {
                [root, whole[1]]
            } else if c <= 0.0 {
                whole
            } else {
                return None;
            }
        } else {
            if discriminant < 0.0 && a > 0.0 {
                return None;
            }
            let k = self.k();
            let [one, other] = if k == 0.0 { [0.0; 2] } else { [k / a, c / k] };
            let roots = [middle + one.min(other), middle + one.max(other)];
            if a > 0.0 {
                roots
            } else if growth > 0.0 {
                [roots[1], whole[1]]
            } else {
                [whole[0], roots[0]]
            }
        };
        Some(Span::new([start, end], 0))
    }
}
