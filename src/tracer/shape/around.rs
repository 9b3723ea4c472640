//! The box and the ball around a shape, outside of which a ray does not meet it.
//!
//! Rounding errors find crossings far from a shape: of a triangle that is seen exactly from its edge,
//! or beside a very flat ellipsoid. Only those count that lie in the box and in the ball, both grown
//! by 1e-7 of the larger of the ball's radius and its distance from the ray's origin. All that finds
//! shapes faster than the plain loop relies on this: see `accel/bvh/frame.rs`.

use std::ops::RangeInclusive;

use glam::DVec3;

use crate::tracer::{
    ray::Ray,
    shape::{Extent, Membership, Shape},
    transform::Transform,
};

/// The growth of the box and the ball, as a part of the radius or the distance.
pub(crate) const GROWTH: f64 = 1e-7;

/// The same for the coordinates, each of which is the sum of rounded numbers.
pub(crate) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The lengths of which something is known.
pub(crate) const ORDINARY_LENGTHS: RangeInclusive<f64> = 1e-50..=1e50;

/// The box and the ball around a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Around {
    low: DVec3,
    high: DVec3,
    center: DVec3,
    radius: f64,
}

impl Around {
    pub(crate) const fn new([low, high]: [DVec3; 2], center: DVec3, radius: f64) -> Self {
        Self {
            low,
            high,
            center,
            radius,
        }
    }

    /// Creates the box around some points and the ball around its middle.
    pub(crate) fn points(points: &[DVec3]) -> Self {
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [low, high] = points.iter().fold(none, |[low, high], point| {
            [low.min(*point), high.max(*point)]
        });
        let center = low + (high - low) * 0.5;
        Self::new([low, high], center, farthest(points, center))
    }

    /// Returns the box and the ball around a shape; `None` if it is unbounded or not finite in f64.
    pub(crate) fn shape(shape: &Shape) -> Option<Self> {
        shape.around().filter(|around| around.bounds().is_some())
    }

    /// Returns the box and the ball around several; `None` if one is unbounded.
    pub(crate) fn union(all: &[Option<Self>]) -> Option<Self> {
        let mut others = all.iter();
        let mut whole = (*others.next()?)?;
        for other in others {
            let other = (*other)?;
            whole.low = whole.low.min(other.low);
            whole.high = whole.high.max(other.high);
        }
        if all.len() > 1 {
            let balls = all.iter().flatten();
            whole = Self::boxed(whole.low, whole.high);
            let away = |ball: &Self| (ball.center - whole.center).length() + ball.radius;
            whole.radius = whole.radius.min(balls.map(away).fold(0.0, f64::max));
        }
        Some(whole)
    }

    /// Returns the box and the ball that lie in all of several; `None` if all are unbounded. The ball
    /// is that around the box or the smallest of theirs; then its place is returned.
    pub(crate) fn intersection(all: &[Option<Self>]) -> (Option<Self>, Option<usize>) {
        let bounded = || {
            all.iter()
                .enumerate()
                .filter_map(|(at, one)| Some((at, (*one)?)))
        };
        let Some((first, smallest)) =
            bounded().min_by(|(_, one), (_, other)| one.radius.total_cmp(&other.radius))
        else {
            return (None, None);
        };
        let none = [DVec3::NEG_INFINITY, DVec3::INFINITY];
        let [low, high] = bounded().fold(none, |[low, high], (_, one)| {
            [low.max(one.low), high.min(one.high)]
        });
        if !low.cmplt(high).all() {
            // It is empty; but a box without a size would be no box.
            return (Some(smallest), Some(first));
        }
        let whole = Self::boxed(low, high);
        if smallest.radius <= whole.radius {
            return (
                Some(Self {
                    low,
                    high,
                    ..smallest
                }),
                Some(first),
            );
        }
        (Some(whole), None)
    }

    /// Returns the box and the ball around what these hold once it is mapped, if that is finite.
    pub(crate) fn mapped(&self, transform: &Transform) -> Option<Self> {
        let [low, high] = transform.surround(self.bounds()?);
        let rounding = transform.rounding(self.center.abs() + self.radius);
        let center = transform.point(self.center);
        let radius = transform.stretch() * self.radius + rounding.length();
        // Both are too large, each for other shapes: together they fit spheres and boxes.
        let bounds = [low.max(center - radius), high.min(center + radius)];
        let farthest = (high - center).max(center - low).length();
        let mapped = Self::new(bounds, center, radius.min(farthest));
        mapped.is_finite().then_some(mapped)
    }

    /// Returns false if no shape in the box meets the ray with `0 < t < t_max`: the box is grown by ten
    /// times what the crossing of a shape may lie beside it. Nothing is known of extreme numbers.
    pub(crate) fn may_meet(&self, ray: &Ray, t_max: f64) -> bool {
        let from = ray.origin() - self.center;
        let reach = from.abs().max_element().max(self.radius);
        let lengths = [reach, ray.direction().length()];
        if !lengths
            .iter()
            .all(|length| ORDINARY_LENGTHS.contains(length))
        {
            return true;
        }
        let most = self.low.abs().max(self.high.abs()).max(ray.origin().abs());
        let slack = 20.0 * GROWTH * reach + 4.0 * ROUNDING * most.max_element();
        let (low, high) = (
            self.low - self.center - slack,
            self.high - self.center + slack,
        );
        let (mut near, mut far) = (0.0_f64, t_max);
        for axis in 0..3 {
            let inverse = 1.0 / ray.direction()[axis];
            let one = (low[axis] - from[axis]) * inverse;
            let other = (high[axis] - from[axis]) * inverse;
            // NaN excludes nothing: these take the other number.
            near = near.max(one.min(other));
            far = far.min(one.max(other));
        }
        near <= far
    }

    /// Returns true if a point lies in the box, grown by the rounding errors of a point that was mapped.
    pub(crate) fn boxes(&self, point: DVec3) -> bool {
        let slack = GROWTH * point.abs().max_element().max(self.radius);
        (point + slack).cmpge(self.low).all() && (point - slack).cmple(self.high).all()
    }

    /// Returns a box and the ball through its corners.
    fn boxed(low: DVec3, high: DVec3) -> Self {
        Self::points(&[low, high])
    }

    /// Returns the corners of the box, or `None` if one is not finite in f64.
    pub(crate) fn bounds(&self) -> Option<[DVec3; 2]> {
        let Self { low, high, .. } = *self;
        (low.is_finite() && high.is_finite()).then_some([low, high])
    }

    /// The center and the corners relative to it, and the radius.
    pub(crate) fn middle(&self) -> (DVec3, [DVec3; 2], f64) {
        let corners = [self.low - self.center, self.high - self.center];
        (self.center, corners, self.radius)
    }

    /// The largest coordinate of the box.
    #[inline]
    pub(crate) fn most(&self) -> f64 {
        self.low.abs().max(self.high.abs()).max_element()
    }

    pub(crate) const fn extent(&self) -> Extent<'static> {
        Extent::Ball(self.center, self.radius)
    }

    /// Returns true if every number is finite.
    pub(crate) fn is_finite(&self) -> bool {
        let Self { center, radius, .. } = *self;
        self.bounds().is_some() && center.is_finite() && radius.is_finite()
    }

    /// Returns the distance from a point to the farthest point of the box and the ball, or a little
    /// more.
    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        let corner = (self.high - point).max(point - self.low);
        f64::min(
            corner.length(),
            (self.center - point).length() + self.radius,
        )
    }

    /// Returns the position of an eye inside a solid that fills the ball.
    pub(crate) const fn inside(&self) -> Membership {
        Membership::Inside(self.center, self.radius)
    }

    /// Returns the box and the ball, a little smaller.
    #[inline]
    pub(crate) fn near(&self) -> Near {
        Near {
            center: self.center,
            low: self.low - self.center,
            high: self.high - self.center,
            squared: self.radius * self.radius * (1.0 - ROUNDING),
        }
    }

    /// Returns true if the point of the ray at `t` lies in the grown box and ball.
    #[inline]
    pub(crate) fn holds(&self, ray: &Ray, t: f64) -> bool {
        let from = ray.origin() - self.center;
        let point = from + t * ray.direction();
        let (low, high) = (self.low - self.center, self.high - self.center);
        let most = self.most();
        let slack = GROWTH * from.abs().max_element().max(self.radius) + ROUNDING * most;
        let radius = self.radius + slack;
        // NaN is nowhere.
        (point + slack).cmpge(low).all()
            && (point - slack).cmple(high).all()
            && point.dot(point) <= radius * radius
    }
}

/// Returns true if the box and the ball around the corners of a triangle hold the point of a ray at
/// `t`, as [`Around::points`] and [`Around::holds`] find it, mostly without roots: the slack and the
/// radius are at least what they are without theirs.
#[inline(always)]
pub(crate) fn triangle_holds(corners: [DVec3; 3], ray: &Ray, t: f64) -> bool {
    let near = Near::triangle(corners);
    let from = ray.origin() - near.center;
    let point = from + t * ray.direction();
    let slack = GROWTH * from.abs().max_element();
    let is_inside = (point + slack).cmpge(near.low).all()
        && (point - slack).cmple(near.high).all()
        && point.length_squared() <= near.squared;
    is_inside || triangle_holds_by_roots(corners, ray, t)
}

// Few points are so near to the edge.
#[cold]
#[inline(never)]
fn triangle_holds_by_roots(corners: [DVec3; 3], ray: &Ray, t: f64) -> bool {
    Around::points(&corners).holds(ray, t)
}

/// A box and a ball a little smaller than those of an [`Around`], relative to its center: a point inside
/// both is surely inside the original.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    pub(crate) center: DVec3,
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// The square of the radius.
    pub(crate) squared: f64,
}

impl Near {
    #[inline]
    pub(crate) fn triangle(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let center = low + (high - low) * 0.5;
        let [a, b, c] = corners.map(|corner| (corner - center).length_squared());
        Self {
            center,
            low: low - center,
            high: high - center,
            squared: a.max(b).max(c) * (1.0 - ROUNDING),
        }
    }
}

/// Returns the largest distance of some points from another.
pub(crate) fn farthest(points: &[DVec3], from: DVec3) -> f64 {
    let distances = points.iter().map(|point| (*point - from).length());
    distances.fold(0.0, f64::max)
}
