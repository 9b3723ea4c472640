//! A torus.
//!
//! # The equation
//!
//! Lengths are divided by the ring's radius. A point of the ray's line is `x + z·w` with the unit vector w
//! of the axis; it is inside where `G = (|x| - 1)² + z² - ρ²` is below 0. Multiplied by
//! `(|x| + 1)² + z² - ρ²`, which is above 0 everywhere, G is the quartic of textbooks. Measured from the
//! point of the line that is nearest to the center, which is `p` at the unit direction `u`, it has no cubic
//! term, and its derivative is four times `s³ + α·s + β` with
//! `α = p·p + 1 - ρ² - 2·(1 - (u·w)²)` and `β = 2·(p·w)·(u·w)`.
//!
//! The zeros of that cubic, in turn between the zeros ±√(-α/3) of its derivative, divide the line into at
//! most four pieces in which G changes its sign at most once: from outside of all to outside of all. Each
//! change is found by Newton's method in a bracket that is halved at least in every second step.
//!
//! # The bound
//!
//! Only the sign of G decides, and G is computed from lengths, not from the quartic's coefficients: near
//! the torus, where every length is at most 2, its rounding errors move the surface by at most 37 ε, with
//! ε = 2⁻⁵³. Those of p and u move the line by at most 18 ε and by 3 ε times the distance of the ray's
//! origin from the center; those of t add 10 ε and 2 ε times that distance, and a bracket is at most 32 ε
//! wide. So every crossing lies within `2⁻⁴⁶·(R + |o - c|)` of the torus, and a ray that is deeper than
//! that in the tube, or farther than that from it, is found there: the number of crossings is right
//! unless the ray touches the torus within that bound. An error of a zero of the cubic moves it along a
//! stretch on which the quartic changes by less than its rounding errors.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        Membership,
        around::Around,
        axis::outward,
        contact::{ContactPoint, FaceEdge, FaceEquation, NearFace},
        face::{Crossing, Crossings, Faces, Leaving},
        span::Span,
        working::{Term, Working},
    },
    vector::{direction, finite, in_range, positive, rim, unit},
};

/// All points at the distance `r`, the radius of the tube, from a circle: the ring of radius `R` around a
/// center `c`, perpendicular to an axis. The tube is thinner than the ring, so that there is a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    center: DVec3,
    /// The unit vector `w` of the axis.
    axis: DVec3,
    radius: f64,
    tube_radius: f64,
}

/// The `s` of a line beyond which it is surely outside.
const REACH: f64 = 2.5;

/// The width of a bracket that is narrow enough, 2⁻⁴⁸.
const NARROW: f64 = 16.0 * f64::EPSILON;

/// The largest number of steps: two for each halving of the widest bracket.
const STEPS: usize = 2 * 52;

/// A ray's line beside a torus of radius 1.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// The `t` of the point that is nearest to the center, and the `t` per `s`.
    middle: f64,
    step: f64,
    /// That point and the unit direction.
    p: DVec3,
    u: DVec3,
    /// Their parts along the axis, and those across.
    along: [f64; 2],
    across: [DVec3; 2],
    /// `ρ²`.
    squared: f64,
}

impl Torus {
    /// Creates a torus around `center`.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, if the squared length of `axis` in f64 is 0 or not
    /// finite, if a radius is not above 0, or if that of the tube is not below the other.
    pub fn new(
        center: DVec3,
        axis: DVec3,
        radius: f64,
        tube_radius: f64,
    ) -> Result<Self, GeometryError> {
        let axis = direction(finite(axis, "axis")?, "axis")?;
        let radius = positive(radius, "radius")?;
        let tube_radius = positive(tube_radius, "tube_radius")?;
        Ok(Self {
            center: finite(center, "center")?,
            // Scaled first: the square of a short axis loses digits.
            axis: unit(axis / axis.abs().max_element()),
            radius,
            tube_radius: in_range(tube_radius, "tube_radius", [0.0, radius.next_down()])?,
        })
    }

    /// The center.
    pub const fn center(&self) -> DVec3 {
        self.center
    }

    /// The axis, of unit length.
    pub const fn axis(&self) -> DVec3 {
        self.axis
    }

    /// The radius of the ring in the middle of the tube.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// The radius of the tube, above 0 and below that of the ring.
    pub const fn tube_radius(&self) -> f64 {
        self.tube_radius
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        let q = at.point - self.center;
        let height = q.dot(self.axis);
        let across = q - height * self.axis;
        // From the nearest point of the ring.
        let away = across - self.radius * unit(across) + height * self.axis;
        let equation = FaceEquation {
            value: away.length() - self.tube_radius,
            gradient: unit(away),
            size: self.center.abs() + self.radius + self.tube_radius,
            more: 0.0,
        };
        at.see(0, &equation, FaceEdge::none, see);
    }

    fn hull(&self) -> Around {
        // Along a coordinate axis x, the ring extends to R·|x × w|.
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let beside = DVec3::from(axes.map(|axis| axis.cross(self.axis).length()));
        let half = self.radius * beside + self.tube_radius;
        let corners = [self.center - half, self.center + half];
        Around::new(corners, self.center, self.radius + self.tube_radius)
    }

    #[inline]
    pub(crate) fn around(&self) -> Option<Around> {
        Some(self.hull())
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        let ring = self.center + self.radius * rim(self.axis, direction);
        Some(ring + self.tube_radius * direction)
    }

    fn line(&self, ray: &Ray) -> Line {
        let (q, d) = (ray.origin() - self.center, ray.direction());
        let squared = d.dot(d);
        // Twice, as the first step from far away is rounded.
        let first = -(q.dot(d) / squared);
        let p = q + first * d;
        let second = -(p.dot(d) / squared);
        let length = squared.sqrt();
        let (p, u) = ((p + second * d) / self.radius, d / length);
        let along = [p, u].map(|v| v.dot(self.axis));
        let ratio = self.tube_radius / self.radius;
        Line {
            middle: first + second,
            step: self.radius / length,
            p,
            u,
            along,
            across: [p - along[0] * self.axis, u - along[1] * self.axis],
            squared: ratio * ratio,
        }
    }

    /// Returns the crossings of a ray's line. A ray that leaves the torus starts exactly on it: the tube
    /// is as thick as that, and this crossing is at 0.
    fn roots(&self, ray: &Ray, leaving: Leaving) -> [Option<f64>; 4] {
        let mut line = self.line(ray);
        let mut found = [None; 4];
        if line.p.dot(line.p) >= 4.0 {
            return found;
        }
        let own = (!leaving.is_empty()).then(|| -line.middle / line.step);
        if let Some(own) = own {
            line.squared += line.beyond(own)[0];
        }
        let mut free = found.iter_mut();
        let mut low = -REACH;
        for high in line.turns().chain([REACH]) {
            let s = change(|s| line.beyond(s), [low, high]);
            let is_own = own.is_some_and(|own| (low..=high).contains(&own));
            if let Some(s) = s
                && let Some(found) = free.next()
            {
                let t = line.middle + s * line.step;
                *found = Some(if is_own { 0.0 } else { t });
            }
            low = high;
        }
        found
    }

    /// Returns the parts of a ray's line inside.
    pub(super) fn span(&self, ray: &Ray, leaving: Leaving) -> [Option<Span>; 2] {
        let [a, b, c, d] = self.roots(ray, leaving);
        let span = |(enter, exit)| Span::new([enter, exit], 0);
        [a.zip(b).map(span), c.zip(d).map(span)]
    }

    pub(crate) const FACES: Faces = Faces::Curved;

    #[inline]
    pub(crate) fn crossings(&self, ray: &Ray, leaving: Leaving) -> Crossings<4> {
        let all = self.roots(ray, leaving);
        Crossings(all.map(|t| t.map(Crossing::from))).near(&self.hull(), ray)
    }

    pub(crate) fn normal_on(&self, _: u64, ray: &Ray, t: f64) -> DVec3 {
        let point = (ray.origin() - self.center) + t * ray.direction();
        let across = point - point.dot(self.axis) * self.axis;
        outward(point - self.radius * unit(across), ray)
    }
}

impl Torus {
    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let line = self.line(ray);
        let [alpha, beta] = line.cubic();
        Working {
            form: None,
            parts: vec![
                Term::vector("center", "center c", self.center),
                Term::vector("axis", "axis w", self.axis),
                Term::number("radius", "radius R", self.radius),
                Term::number("tube_radius", "tube radius r", self.tube_radius),
            ],
            lines: vec![
                vec![
                    Term::number("m", "m", line.middle),
                    Term::vector("p", "p", line.p),
                    Term::vector("u", "u", line.u),
                ],
                vec![
                    Term::number("alpha", "α", alpha),
                    Term::number("beta", "β", beta),
                ],
            ],
            solutions: self.crossings(ray, Leaving::NOTHING).solutions(),
            name: Some("crossings"),
        }
    }

    pub(crate) fn numbers(&self) -> impl IntoIterator<Item = f64> + use<> {
        let vectors = [self.center, self.axis].map(|vector| vector.to_array());
        let radii = [self.radius, self.tube_radius];
        vectors.into_iter().flatten().chain(radii)
    }

    /// Returns the height of a point above the plane of the ring and its distance from the axis.
    fn place_of(&self, point: DVec3) -> [f64; 2] {
        let q = point - self.center;
        let height = q.dot(self.axis);
        [height, (q - height * self.axis).length()]
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        let [height, away] = self.place_of(point);
        let away = away + self.radius;
        (height * height + away * away).sqrt() + self.tube_radius
    }

    /// Returns the depth of a point below the surface: above 0 inside, 0 on it and below 0 outside.
    pub(crate) fn depth(&self, point: DVec3) -> f64 {
        let [height, away] = self.place_of(point);
        let away = away - self.radius;
        self.tube_radius - (height * height + away * away).sqrt()
    }

    pub(crate) fn membership(&self, eye: DVec3) -> Membership {
        match self.depth(eye) > 0.0 {
            true => self.hull().inside(),
            false => Membership::Outside,
        }
    }
}

impl Line {
    /// Returns `G` at `s`, which is above 0 outside, and its derivative.
    #[inline]
    fn beyond(&self, s: f64) -> [f64; 2] {
        let ([h, g], [x, e]) = (self.along, self.across);
        let (x, z) = (x + s * e, h + s * g);
        let away = x.length();
        let beside = away - 1.0;
        let slope = beside * (x.dot(e) / away) + z * g;
        [beside * beside + z * z - self.squared, 2.0 * slope]
    }

    /// Returns `α` and `β`.
    fn cubic(&self) -> [f64; 2] {
        let [height, rise] = self.along;
        let [_, across] = self.across;
        let linear = self.p.dot(self.p) + 1.0 - self.squared - 2.0 * across.dot(across);
        [linear, 2.0 * height * rise]
    }

    /// Returns the zeros of the cubic, from low to high.
    fn turns(&self) -> impl Iterator<Item = f64> {
        let [alpha, beta] = self.cubic();
        let cubic = move |s: f64| [(s * s + alpha) * s + beta, 3.0 * s * s + alpha];
        let turn = (-alpha / 3.0).max(0.0).sqrt();
        [[-REACH, -turn], [-turn, turn], [turn, REACH]]
            .into_iter()
            .filter_map(move |bracket| change(cubic, bracket))
    }
}

/// Returns the place in a bracket at which a function gets below 0 or no longer is, given the function with
/// its derivative; `None` if it is below 0 at both ends or at neither.
fn change(of: impl Fn(f64) -> [f64; 2], [mut low, mut high]: [f64; 2]) -> Option<f64> {
    let is_below = |s| of(s)[0] < 0.0;
    let at_low = is_below(low);
    if is_below(high) == at_low {
        return None;
    }
    let mut root = f64::NAN;
    let mut guess = f64::NAN;
    for _ in 0..STEPS {
        let width = high - low;
        if width <= NARROW {
            break;
        }
        let is_inside = low < guess && guess < high;
        let s = if is_inside { guess } else { low + 0.5 * width };
        let [value, slope] = of(s);
        root = s - value / slope;
        // A little beyond, so that the bracket gets narrow from the other side too.
        let push = if (value < 0.0) == at_low {
            low = s;
            0.25 * NARROW
        } else {
            high = s;
            -0.25 * NARROW
        };
        let is_halved = high - low <= 0.5 * width;
        guess = if is_halved { root + push } else { f64::NAN };
    }
    // NaN is neither.
    Some(root.max(low).min(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::{
        random::{Rng, cases},
        shape::face::FaceId,
    };

    fn ring() -> Torus {
        Torus::new(DVec3::ZERO, DVec3::Y * 3.0, 2.0, 0.5).unwrap()
    }

    fn all(torus: &Torus, ray: &Ray, leaving: Leaving) -> Vec<f64> {
        let crossings = torus.crossings(ray, leaving).in_front(f64::INFINITY);
        crossings.map(|at| at.t).collect()
    }

    #[test]
    fn a_ray_crosses_the_tube_up_to_four_times() {
        let found = |origin: DVec3, direction| {
            let ray = Ray::new(origin, direction);
            all(&ring(), &ray, Leaving::NOTHING)
        };
        let (x, y) = (DVec3::X, DVec3::Y);
        assert_eq!(found(x * -9.0, x), [6.5, 7.5, 10.5, 11.5]);
        assert_eq!(found(x * -2.0, x * 2.0), [0.25, 1.75, 2.25], "from inside");
        assert_eq!(found(x * 2.0 + y * 9.0, -y), [8.5, 9.5]);
        assert!(found(y * 9.0, -y).is_empty(), "through the hole");
        assert!(found(x * -9.0 + y * 0.6, x).is_empty(), "over it");
        let above = found(x * -9.0 + y * 0.3, x);
        let expected = [6.6, 7.4, 10.6, 11.4];
        assert_eq!(above.len(), 4);
        let pairs = above.iter().zip(expected);
        assert!(
            pairs.into_iter().all(|(t, at)| (t - at).abs() < 1e-14),
            "{above:?}"
        );
    }

    #[test]
    fn the_normal_points_away_from_the_ring() {
        let ray = Ray::new(DVec3::X * -9.0, DVec3::X);
        let normals = [6.5, 7.5, 10.5].map(|t| ring().normal_on(0, &ray, t));
        assert_eq!(normals, [DVec3::NEG_X, DVec3::X, DVec3::NEG_X]);
    }

    // The crossing that a ray starts at is left out, and all others are as they are for a ray from just
    // before it.
    #[test]
    fn a_ray_that_leaves_meets_the_torus_elsewhere() {
        let mut rng = Rng(0x7045);
        let mut counts = [0; 4];
        for _ in 0..cases(20_000) {
            let ratio = rng.one(&[0.25, 0.5, 0.9, 0.1]);
            let torus = Torus::new(rng.vector(), rng.vector(), 1.0, ratio).unwrap();
            let origin = rng.vector() * 3.0;
            let ray = Ray::new(origin, torus.center() + rng.vector() - origin);
            let t = rng.one(&[0, 1, 2, 3]);
            let Some(t) = all(&torus, &ray, Leaving::NOTHING).get(t).copied() else {
                continue;
            };
            let direction = unit(rng.vector());
            let normal = torus.normal_on(0, &ray, t);
            if normal.dot(direction).abs() < 1e-3 {
                continue;
            }
            let own = FaceId::of_shape(0);
            let next = Ray::new(ray.at(t), direction);
            let found = all(&torus, &next, Leaving::only(&own));
            let before = Ray::new(ray.at(t) - 1e-7 * direction, direction);
            let mut expected = all(&torus, &before, Leaving::NOTHING);
            expected.retain(|t| (t - 1e-7).abs() > 1e-9);
            assert_eq!(found.len(), expected.len(), "{torus:?} {ray:?} {direction}");
            for (t, other) in found.iter().zip(expected) {
                assert!((t - (other - 1e-7)).abs() < 1e-6, "{torus:?}");
            }
            counts[found.len()] += 1;
        }
        assert!(
            counts.iter().all(|count| *count > cases(20_000) / 1000),
            "{counts:?}"
        );
    }
}
