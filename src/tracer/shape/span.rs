//! The parts of a ray's line inside a solid: one interval if it is convex, whose ends lie on faces.
//!
//! A convex solid is the intersection of simpler ones, and so is its span. Its ends are compared with each
//! other and never with a position, so that no ray slips through where two faces meet.
//!
//! The end at which a ray leaves a face of the solid is 0 exactly. So a ray that leaves outward does
//! not meet the solid again, and one that leaves inward meets it where it comes out.

use std::cmp::Ordering;

use glam::DVec3;

use crate::tracer::{
    ray::Ray,
    shape::{
        Membership,
        around::Around,
        face::{Crossing, Crossings, Leaving},
        working::Term,
    },
};

/// An interval of a ray's line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) enter: Crossing,
    pub(crate) exit: Crossing,
}

/// The side of a point of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Before,
    After,
}

impl Span {
    /// The whole line.
    pub(crate) const WHOLE: Self = Self::new([f64::NEG_INFINITY, f64::INFINITY], 0);

    /// Creates the span between two `t` on one face.
    pub(crate) const fn new([enter, exit]: [f64; 2], face: u64) -> Self {
        Self {
            enter: Crossing { t: enter, face },
            exit: Crossing { t: exit, face },
        }
    }

    /// Returns the span in a solid in which the numbers of its faces begin with one.
    #[inline]
    pub(crate) const fn with_faces_from(mut self, first: u64) -> Self {
        self.enter.face += first;
        self.exit.face += first;
        self
    }

    /// Returns the part inside both solids; at an equal t, the face of this one. `None` if there is
    /// none or if a number is NaN.
    #[inline]
    pub(crate) fn and(self, other: Self) -> Option<Self> {
        let is_later = other
            .enter
            .t
            .partial_cmp(&self.enter.t)
            .is_none_or(Ordering::is_gt);
        let is_sooner = other
            .exit
            .t
            .partial_cmp(&self.exit.t)
            .is_none_or(Ordering::is_lt);
        let both = Self {
            enter: if is_later { other.enter } else { self.enter },
            exit: if is_sooner { other.exit } else { self.exit },
        };
        (both.enter.t <= both.exit.t).then_some(both)
    }

    /// Returns true if the line lies inside at a point, just before or just after it.
    #[inline]
    pub(crate) fn holds(&self, t: f64, side: Side) -> bool {
        match side {
            Side::Before => self.enter.t < t && t <= self.exit.t,
            Side::After => self.enter.t <= t && t < self.exit.t,
        }
    }

    /// Returns the span of a convex solid on whose surface the origin of the ray lies.
    #[inline]
    pub(crate) const fn around_origin(mut self) -> Self {
        self.enter.t = self.enter.t.min(0.0);
        self.exit.t = self.exit.t.max(0.0);
        self
    }

    /// Returns the ends. One at which a ray leaves a face is not met.
    #[inline]
    pub(crate) fn crossings(self, leaving: Leaving) -> Crossings {
        let enter = leaving.is_empty().then_some(self.enter);
        Crossings([enter, Some(self.exit)])
    }

    /// Returns the span between two parallel planes, `low` and `high` above the ray's origin, on which
    /// it moves up by `up` per t. If it is parallel to them, it is inside or never.
    #[inline]
    pub(crate) fn slab([low, high]: [f64; 2], up: f64, faces: [u64; 2]) -> Option<Self> {
        if up == 0.0 {
            return (low <= 0.0 && high >= 0.0).then_some(Self::WHOLE);
        }
        let low = Crossing {
            t: low / up,
            face: faces[0],
        };
        let high = Crossing {
            t: high / up,
            face: faces[1],
        };
        Some(match up > 0.0 {
            true => Self {
                enter: low,
                exit: high,
            },
            false => Self {
                enter: high,
                exit: low,
            },
        })
    }

    /// Returns the span of a face that is round: the `t` with `|q + t·d| ≤ r`.
    ///
    /// With `A = d·d`, `H = q·d` and `m = q - (H/A)·d`, the point of the line that is nearest to the
    /// center, the discriminant is `D = r² - m·m`, and with `s = √(A·D)` and `k = -(H ± s)`, the sign
    /// being that of H, the ends are `k/A` and `((q·q) - r²)/k` (Haines et al., "Precision
    /// Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019). If the ray leaves the
    /// face, they are 0 and `-2H/A`.
    #[inline]
    pub(crate) fn round(q: DVec3, d: DVec3, r: f64, is_left: bool, face: u64) -> Option<Self> {
        let round = Round::new(q, d, r);
        let Round { a, h, .. } = round;
        let c = q.dot(q) - r * r;
        if a == 0.0 {
            return (c <= 0.0).then_some(Self::WHOLE);
        }
        let ends = if is_left {
            [0.0, -2.0 * h / a]
        } else if round.d >= 0.0 {
            let k = round.k();
            if k == 0.0 { [0.0; 2] } else { [k / a, c / k] }
        } else {
            return None;
        };
        Some(Self::between(ends, face))
    }

    /// Returns the crossings of a round side between two ends: also those with the ends if they are
    /// capped.
    #[inline]
    pub(crate) fn between_ends(self, ends: Self, is_capped: bool, leaving: Leaving) -> Crossings {
        if is_capped {
            let span = self.and(ends);
            span.map_or_else(Crossings::default, |span| span.crossings(leaving))
        } else {
            self.within(ends)
        }
    }

    /// Returns the ends that lie inside another span, its own ends included.
    #[inline]
    pub(crate) fn within(self, other: Self) -> Crossings {
        let inside = other.enter.t..=other.exit.t;
        let ends = [self.enter, self.exit].map(Some);
        Crossings(ends.map(|end| end.filter(|end| inside.contains(&end.t))))
    }

    /// Creates the span between two `t` in any order.
    #[inline]
    pub(crate) fn between([one, other]: [f64; 2], face: u64) -> Self {
        let ends = if one <= other {
            [one, other]
        } else {
            [other, one]
        };
        Self::new(ends, face)
    }
}

/// The parts of a ray's line inside a solid.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Spans {
    Convex(Option<Span>),
    Several([Option<Span>; 2]),
}

impl Spans {
    /// Returns that of a convex solid.
    #[inline(always)]
    pub(crate) fn convex(self) -> Option<Span> {
        match self {
            Self::Convex(span) => span,
            Self::Several(_) => None,
        }
    }
}

impl From<Option<Span>> for Spans {
    #[inline(always)]
    fn from(span: Option<Span>) -> Self {
        Self::Convex(span)
    }
}

impl From<[Option<Span>; 2]> for Spans {
    #[inline(always)]
    fn from(spans: [Option<Span>; 2]) -> Self {
        Self::Several(spans)
    }
}

/// A convex solid, given by the spans of rays.
pub(crate) trait Convex {
    /// The box and the ball around it.
    fn hull(&self) -> &Around;

    /// Returns the part of a ray's line inside. A ray that leaves a face begins on it.
    fn span(&self, ray: &Ray, leaving: Leaving) -> Option<Span>;

    /// Returns the depth of a point below the surface: above 0 inside, 0 on it and below 0 outside. A
    /// solid that is open has the depths of the closed one.
    fn depth(&self, point: DVec3) -> f64;

    /// Returns true if it has all of its faces.
    fn is_closed(&self) -> bool {
        true
    }

    fn around(&self) -> Option<Around> {
        Some(*self.hull())
    }

    #[inline]
    fn crossings(&self, ray: &Ray, leaving: Leaving) -> Crossings {
        let crossings = self.span(ray, leaving).map(|span| span.crossings(leaving));
        crossings.unwrap_or_default().near(self.hull(), ray)
    }

    fn membership(&self, eye: DVec3) -> Membership {
        match self.is_closed() && self.depth(eye) > 0.0 {
            true => self.hull().inside(),
            false => Membership::Outside,
        }
    }
}

/// The terms of a round face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Round {
    /// `A = d·d`.
    pub(crate) a: f64,
    /// `H = q·d`.
    pub(crate) h: f64,
    /// `D = r² - m·m` with `m = q - (H/A)·d`.
    pub(crate) d: f64,
}

impl Round {
    #[inline]
    pub(crate) fn new(q: DVec3, d: DVec3, r: f64) -> Self {
        let (a, h) = (d.dot(d), q.dot(d));
        let m = q - (h / a) * d;
        Self {
            a,
            h,
            d: r * r - m.dot(m),
        }
    }

    /// Returns the terms with their names in data, which begin with `prefix`. `k` is that of a ray which
    /// meets the face.
    pub(crate) fn terms(prefix: &str, q: DVec3, d: DVec3, r: f64) -> Vec<Term> {
        let round = Self::new(q, d, r);
        let Self { a, h, .. } = round;
        let name = |name: &str| format!("{prefix}{name}");
        let number = |of: &str, symbol, number| Term::number(name(of), symbol, number);
        let mut terms = vec![
            number("a", "A", a),
            number("h", "H", h),
            Term::vector(name("m"), "m", q - (h / a) * d),
            number("discriminant", "D", round.d),
            number("c", "C", q.dot(q) - r * r),
        ];
        if a != 0.0 && round.d >= 0.0 {
            terms.push(number("k", "k", round.k()));
        }
        terms
    }

    /// Returns `k = -(H ± √(A·D))`, with the sign of `H`.
    #[inline]
    fn k(&self) -> f64 {
        -(self.h + (self.a * self.d).sqrt().copysign(self.h))
    }
}
