//! Framing: the camera that sees all of some shapes, as close as a margin allows.
//!
//! The camera looks against a direction that is given, so its basis u, v, w is known, and only the
//! eye e is unknown. All of a convex shape is at most s to the right of the middle of the picture,
//! in units of the distance to the picture, if and only if it lies on one side of a plane through
//! the eye: `e·(u + s·w) >= h(u + s·w)`, where the support function `h(n)` is the largest `p·n` of
//! its points p. For spheres that is the silhouette, exactly. The same holds for the other three
//! sides, so the smallest distance is the solution of two linear equations, one for left and right
//! and one for top and bottom. Where there is room to spare, the eye moves sideways until opposite
//! margins are equal: at the root of a concave function of s, which Newton's method approaches from
//! below and never passes, as it does for fractional programs (W. Dinkelbach, On nonlinear
//! fractional programming, 1967).

use std::ops::Range;

use glam::{DMat3, DVec3};

use crate::tracer::{
    camera::{
        basis::Basis,
        orthographic::pixels,
        rigid::{Farthest, Rigid, RigidPlace},
    },
    error::GeometryError,
    shape::{Extent, Shape},
    vector::{positive, unit},
};

/// The smallest distance of a perspective eye from what it sees, in units of its size. Only a thin
/// shape that points at the eye, or a very wide view, comes so near.
const NEAREST: f64 = 1e-6;

/// The largest error of the eye by rounding, in units of its distance from what it sees.
const ROUNDING: f64 = 1e-3;

/// The relative growth of s below which Newton's method has arrived.
const SETTLED: f64 = 4.0 * f64::EPSILON;

/// The most steps of Newton's method; it needs about four.
const MOST_STEPS: usize = 64;

/// The relative error of a bound on the points of a turned shape.
const SLACK: f64 = 1e-12;

/// The frame of a picture around what it shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// The direction from what is seen to the eye.
    pub(crate) from: DVec3,
    /// The direction that is up in the picture.
    pub(crate) up: DVec3,
    /// The part of the width that is free on the left and on the right, and of the height at the
    /// top and at the bottom: at least 0 and below 0.5.
    pub(crate) margin: f64,
    /// The width and the height of the picture.
    pub(crate) size: (u32, u32),
}

/// The places of what a camera that orbits around a line sees, from the camera.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Turntable {
    /// A point of the line.
    pub(crate) around: DVec3,
    /// The unit vector along the line.
    pub(crate) axis: DVec3,
    /// The rotation of the camera at each frame.
    pub(crate) turns: Vec<DMat3>,
}

/// A search for the farthest points of shapes in several directions.
pub(crate) struct Extremes {
    directions: Vec<DVec3>,
    /// The largest `p·n` so far and its point p, for each direction n.
    found: Vec<(f64, DVec3)>,
    is_finite: bool,
}

impl Extremes {
    /// Starts a search in directions of unit length.
    pub(crate) fn new(directions: &[DVec3]) -> Self {
        Self {
            directions: directions.to_vec(),
            found: vec![(f64::NEG_INFINITY, DVec3::ZERO); directions.len()],
            is_finite: true,
        }
    }

    /// Adds a shape; an unbounded one does not count.
    #[inline]
    pub(crate) fn add(&mut self, shape: &Shape) {
        for (n, found) in self.directions.iter().zip(&mut self.found) {
            let Some(p) = shape.support(*n) else { return };
            let far = p.dot(*n);
            self.is_finite &= far.is_finite();
            if far > found.0 {
                *found = (far, p);
            }
        }
    }

    /// Adds the shapes of another search in the same directions.
    pub(crate) fn add_all(&mut self, other: &Self) {
        self.is_finite &= other.is_finite;
        for (found, other) in self.found.iter_mut().zip(&other.found) {
            if other.0 > found.0 {
                *found = *other;
            }
        }
    }

    /// Adds a shape as some frames of a turntable show it.
    pub(crate) fn add_turned(
        &mut self,
        shape: &Shape,
        turntable: &Turntable,
        frames: Range<usize>,
    ) {
        let Extent::Ball(center, radius) = shape.extent() else {
            return;
        };
        let Turntable {
            around,
            axis,
            turns,
        } = turntable;
        let from_line = center - around;
        let along = from_line.dot(*axis);
        let beside = (from_line - along * axis).length();
        let slack = SLACK * (around.length() + from_line.length() + radius);
        for (n, found) in self.directions.iter().zip(&mut self.found) {
            // The circle of the center goes no farther than this, which spares most shapes the
            // turns.
            let across = (n - n.dot(*axis) * axis).length();
            let most = around.dot(*n) + along * n.dot(*axis) + beside * across + radius + slack;
            if most < found.0 {
                continue;
            }
            for turn in turns.get(frames.clone()).unwrap_or(&[]) {
                let Some(p) = shape.support(*turn * *n) else {
                    return;
                };
                let p = around + turn.transpose() * (p - around);
                let far = p.dot(*n);
                self.is_finite &= far.is_finite();
                if far > found.0 {
                    *found = (far, p);
                }
            }
        }
    }

    /// Adds shapes that move as one, at a place; `None` of a turntable is a camera that stands still.
    pub(crate) fn add_rigid(
        &mut self,
        rigid: &Rigid,
        place: &mut RigidPlace,
        turned: Option<(&Turntable, usize)>,
    ) {
        let turned =
            turned.and_then(|(table, frame)| Some((table.around, *table.turns.get(frame)?)));
        for (n, found) in self.directions.iter().zip(&mut self.found) {
            let mut farthest = Farthest::than(found.0);
            match turned {
                None => {
                    let see = |p: DVec3| (p.dot(*n), p);
                    rigid.search(place, *n, (0.0, 0.0), see, &mut farthest);
                }
                Some((around, turn)) => {
                    let toward = turn * *n;
                    let beyond = around.dot(*n) - around.dot(toward);
                    let see = |p: DVec3| {
                        let p = around + turn.transpose() * (p - around);
                        (p.dot(*n), p)
                    };
                    let error = SLACK * around.length();
                    rigid.search(place, toward, (beyond, error), see, &mut farthest);
                }
            }
            self.is_finite &= farthest.is_finite;
            if let Some(p) = farthest.point() {
                *found = (farthest.far, p);
            }
        }
    }

    /// Returns true if all numbers are finite, and the largest `p·n` of each direction with its point.
    #[cfg(test)]
    pub(crate) fn found(&self) -> (bool, &[(f64, DVec3)]) {
        (self.is_finite, &self.found)
    }

    /// Returns the largest `p·n` of each direction.
    #[cfg(test)]
    pub(crate) fn distances(&self) -> Vec<f64> {
        self.found.iter().map(|(far, _)| *far).collect()
    }

    /// Returns the points, one for each direction.
    fn points<const N: usize>(&self) -> Result<[DVec3; N], GeometryError> {
        if !self.is_finite {
            return Err(GeometryError::CannotFit);
        }
        if self.found.iter().any(|(far, _)| *far == f64::NEG_INFINITY) {
            return Err(GeometryError::NothingToFit);
        }
        let mut points = [DVec3::ZERO; N];
        for (point, (_, found)) in points.iter_mut().zip(&self.found) {
            *point = *found;
        }
        Ok(points)
    }
}

impl Frame {
    fn basis(&self) -> Result<Basis, GeometryError> {
        Basis::new(DVec3::ZERO, -self.from, self.up)
    }

    /// Returns the parts of the width and of the height that are not free, in pixels.
    fn filled(&self) -> [f64; 2] {
        let (width, height) = self.size;
        [width, height].map(|side| f64::from(side) * (1.0 - 2.0 * self.margin))
    }

    /// Returns the distance from the eye of the middle of what is framed, along the line of sight.
    pub(crate) fn middle_from(
        &self,
        eye: DVec3,
        mut search: impl FnMut(&[DVec3]) -> Extremes,
    ) -> Result<f64, GeometryError> {
        let w = self.basis()?.w;
        let [near, far] = search(&[w, -w]).points()?;
        Ok((eye - near.midpoint(far)).dot(w))
    }

    /// Returns the eye of a perspective camera with the half angle α in radians. `search` finds the
    /// extremes of all shapes in some directions; it is called about five times.
    ///
    /// # Errors
    ///
    /// Directions that are no camera's, no bounded shape, and shapes so large, or so small for
    /// their distance from the origin, that f64 is too coarse for the eye.
    pub(crate) fn perspective_eye(
        &self,
        half_angle: f64,
        mut search: impl FnMut(&[DVec3]) -> Extremes,
    ) -> Result<DVec3, GeometryError> {
        let basis = self.basis()?;
        let Basis { u, v, w, .. } = basis;
        let (_, height) = self.size;
        let tangent = libm::tan(half_angle);
        let [right, top] = self
            .filled()
            .map(|side| tangent * (side / f64::from(height)));
        let (origin, [r, l, t, b, back]) = first(&mut search, &basis, [right, top])?;
        let least = [(r, l, u, right), (t, b, v, top)].map(|(one, other, axis, s)| {
            ((one - other).dot(axis) / s + (one + other).dot(w)) / 2.0
        });
        let extents = [(r - l).dot(u), (t - b).dot(v), -back.dot(w)];
        let size = extents.into_iter().fold(0.0, f64::max);
        let c = least.into_iter().fold(NEAREST * size, f64::max);
        let root = |[one, other]: [DVec3; 2], axis: DVec3| {
            (one - other).dot(axis) / (2.0 * c - (one + other).dot(w))
        };
        let (mut across, mut up) = ([r, l], [t, b]);
        let mut s = [root(across, u), root(up, v)];
        for _ in 0..MOST_STEPS {
            let [x, y] = s;
            let sides = [u + x * w, -u + x * w, v + y * w, -v + y * w].map(unit);
            let [r, l, t, b] = search(&sides).points()?.map(|point| point - origin);
            let next = [root([r, l], u), root([t, b], v)];
            let is_done = (0..2).all(|axis| next[axis] <= s[axis] * (1.0 + SETTLED));
            (across, up, s) = ([r, l], [t, b], next);
            if is_done {
                break;
            }
        }
        let place = |[one, other]: [DVec3; 2], axis: DVec3, s: f64| {
            ((one + other).dot(axis) + s * (one - other).dot(w)) / 2.0
        };
        let offset = place(across, u, s[0]) * u + place(up, v, s[1]) * v + c * w;
        rounded(origin, offset, c)
    }

    /// Returns the eye and the scale of an orthographic camera with square pixels. The eye lies one
    /// height of the picture in front of the nearest point.
    ///
    /// # Errors
    ///
    /// As [`Frame::perspective_eye`].
    pub(crate) fn orthographic_eye(
        &self,
        mut search: impl FnMut(&[DVec3]) -> Extremes,
    ) -> Result<(DVec3, f64), GeometryError> {
        let basis = self.basis()?;
        let Basis { u, v, w, .. } = basis;
        let (_, height) = self.size;
        let (origin, [r, l, t, b, _]) = first(&mut search, &basis, [0.0, 0.0])?;
        let [width, filled] = self.filled();
        let pixel = ((r - l).dot(u) / width).max((t - b).dot(v) / filled);
        let c = pixel * f64::from(height);
        let offset = (r + l).dot(u) / 2.0 * u + (t + b).dot(v) / 2.0 * v + c * w;
        let scale = positive(pixel * pixels(height), "scale");
        let scale = scale.map_err(|_| GeometryError::CannotFit)?;
        Ok((rounded(origin, offset, c)?, scale))
    }
}

/// Returns a nearest point and, relative to it, the extreme points on the right, on the left, at the
/// top and at the bottom of a view with these slopes, and a farthest one.
fn first(
    search: &mut impl FnMut(&[DVec3]) -> Extremes,
    basis: &Basis,
    [right, top]: [f64; 2],
) -> Result<(DVec3, [DVec3; 5]), GeometryError> {
    let Basis { u, v, w, .. } = *basis;
    let sides = [u + right * w, -u + right * w, v + top * w, -v + top * w].map(unit);
    let [r, l, t, b] = sides;
    let points = search(&[r, l, t, b, -w, w]).points()?;
    let [r, l, t, b, back, origin] = points;
    Ok((origin, [r, l, t, b, back].map(|point| point - origin)))
}

/// Returns the eye at an offset from the nearest point, at the distance c before it, unless f64 is
/// too coarse for it.
fn rounded(origin: DVec3, offset: DVec3, c: f64) -> Result<DVec3, GeometryError> {
    let eye = origin + offset;
    let error = ((eye - origin) - offset).length();
    // False for NaN.
    if eye.is_finite() && c > 0.0 && error <= ROUNDING * c {
        Ok(eye)
    } else {
        Err(GeometryError::CannotFit)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::tracer::{
        random::{Rng, cases},
        shape::{any::any, plane::Plane, sphere::Sphere},
    };

    fn search(shapes: &[Shape]) -> impl FnMut(&[DVec3]) -> Extremes {
        |directions| {
            let mut extremes = Extremes::new(directions);
            shapes.iter().for_each(|shape| extremes.add(shape));
            extremes
        }
    }

    fn frame(rng: &mut Rng) -> Frame {
        Frame {
            from: rng.vector() * rng.magnitude(-3.0, 3.0),
            up: rng.vector(),
            margin: rng.one(&[0.0, 0.05, 0.3, 0.499]),
            size: (rng.below(999) as u32 + 1, rng.below(999) as u32 + 1),
        }
    }

    /// Returns the largest slope of a circle in the plane of `across` and `depth`, by the angle of
    /// its center and the angle between that and the tangent.
    fn slope(across: f64, depth: f64, radius: f64) -> f64 {
        let tangent = libm::asin(radius / libm::hypot(across, depth));
        libm::tan(libm::atan2(across, depth) + tangent)
    }

    fn spheres(rng: &mut Rng) -> Vec<Sphere> {
        let middle = rng.vector() * rng.one(&[0.0, 1.0, 1e4]);
        let scale = rng.magnitude(-3.0, 3.0);
        let count = 1 + rng.below(9);
        let sphere = |_| {
            let center = middle * scale + rng.vector() * rng.one(&[0.0, scale, scale]);
            Sphere::new(center, scale * rng.magnitude(-4.0, 0.5)).unwrap()
        };
        (0..count).map(sphere).collect()
    }

    // The four slopes of the silhouettes, by another formula: no margin is less than asked for, one
    // is no more, and opposite ones are equal.
    #[test]
    fn silhouettes_of_spheres_touch_the_margin() {
        let mut rng = Rng(0x00f1_7f17);
        for _ in 0..cases(3_000) {
            let (spheres, frame) = (spheres(&mut rng), frame(&mut rng));
            let half_angle = rng.one(&[0.01, 0.3, 0.7, 1.2]);
            let shapes: Vec<_> = spheres.iter().map(|sphere| (*sphere).into()).collect();
            let eye = frame.perspective_eye(half_angle, search(&shapes)).unwrap();
            let Basis { u, v, w, .. } = frame.basis().unwrap();
            let slopes = [u, -u, v, -v].map(|axis| {
                let slopes = spheres.iter().map(|sphere| {
                    let center = sphere.center() - eye;
                    slope(center.dot(axis), -center.dot(w), sphere.radius())
                });
                slopes.fold(f64::NEG_INFINITY, f64::max)
            });
            let (width, height) = frame.size;
            let aspect = f64::from(width) / f64::from(height);
            let top = libm::tan(half_angle);
            let part = |index: usize| slopes[index] / [top * aspect, top][index / 2];
            let [r, l, t, b] = [0, 1, 2, 3].map(part);
            let filled = 1.0 - 2.0 * frame.margin;
            // In units of what is not free. The eye has only the digits that its place leaves.
            let place = spheres[0].center().length() / spheres[0].radius();
            let slack = (1e-9 + 1e-12 * place) / half_angle;
            let parts = [r, l, t, b].map(|part| part / filled);
            let most = parts.iter().fold(0.0, |one: f64, other| one.max(*other));
            assert!((most - 1.0).abs() < slack, "{parts:?} {frame:?}");
            assert!((parts[0] - parts[1]).abs() < slack, "{parts:?} {frame:?}");
            assert!((parts[2] - parts[3]).abs() < slack, "{parts:?} {frame:?}");
        }
    }

    #[test]
    fn parallel_rays_frame_the_sides() {
        let mut rng = Rng(0x0f17);
        for _ in 0..cases(3_000) {
            let (spheres, frame) = (spheres(&mut rng), frame(&mut rng));
            let shapes: Vec<_> = spheres.iter().map(|sphere| (*sphere).into()).collect();
            let (eye, scale) = frame.orthographic_eye(search(&shapes)).unwrap();
            let Basis { u, v, w, .. } = frame.basis().unwrap();
            let side = |axis: DVec3| {
                let far = |sphere: &Sphere| (sphere.center() - eye).dot(axis) + sphere.radius();
                spheres.iter().map(far).fold(f64::NEG_INFINITY, f64::max)
            };
            let (width, height) = frame.size;
            let pixel = scale / pixels(height);
            let filled = pixel * (1.0 - 2.0 * frame.margin) / 2.0;
            let sides = [(u, width), (v, height)].map(|(axis, pixels)| {
                let half = filled * f64::from(pixels);
                [side(axis) / half, side(-axis) / half]
            });
            let place = spheres[0].center().length() / spheres[0].radius();
            let slack = 1e-9 + 1e-12 * place;
            let most = sides.as_flattened().iter().copied().fold(0.0, f64::max);
            assert!((most - 1.0).abs() < slack, "{sides:?} {frame:?}");
            for [one, other] in sides {
                assert!((one - other).abs() < slack, "{sides:?} {frame:?}");
            }
            assert!(side(w) < 0.0, "all lies in front of the eye");
        }
    }

    // A sphere of radius 1 with a half angle of 30 degrees to its tangent: the eye is at distance 2.
    #[test]
    fn a_sphere_by_hand() {
        let center = DVec3::new(5.0, -7.0, 2.0);
        let shapes = [
            Sphere::new(center, 1.0).unwrap().into(),
            Plane::new(DVec3::ZERO, DVec3::Y).unwrap().into(),
        ];
        let frame = |margin, size| Frame {
            from: DVec3::new(0.0, 0.0, 3.0),
            up: DVec3::Y,
            margin,
            size,
        };
        for size in [(10, 10), (100, 10)] {
            let eye = frame(0.0, size).perspective_eye(PI / 6.0, search(&shapes));
            let expected = center + DVec3::new(0.0, 0.0, 2.0);
            assert!((eye.unwrap() - expected).length() < 1e-14);
        }
        // A narrow picture of a quarter free on either side: 2 pixels of radius 1 in 20 of height.
        let (eye, scale) = frame(0.25, (4, 20))
            .orthographic_eye(search(&shapes))
            .unwrap();
        assert_eq!((eye.x, eye.y, scale), (5.0, -7.0, 19.0));
    }

    // Of an intersection, all of its smallest solid is framed.
    fn holds_solids(shape: &Shape) -> bool {
        match shape.unplaced() {
            Shape::Solid(_) => true,
            Shape::Instances(copies) => copies.shapes().any(holds_solids),
            _ => false,
        }
    }

    #[test]
    fn shapes_of_any_kind_stay_within_the_margin() {
        let mut rng = Rng(0x5ade);
        for _ in 0..cases(1_000) {
            let frame = frame(&mut rng);
            let size = rng.magnitude(-2.0, 2.0);
            let shapes: Vec<_> = (0..5)
                .map(|_| {
                    let center = rng.vector() * 10.0;
                    any(&mut rng, center, size).unwrap()
                })
                .collect();
            let half_angle = rng.one(&[0.1, 0.7, 1.4]);
            let eye = frame.perspective_eye(half_angle, search(&shapes)).unwrap();
            let Basis { u, v, w, .. } = frame.basis().unwrap();
            for shape in &shapes {
                for _ in 0..50 {
                    let direction = unit(rng.vector());
                    let p = shape.support(direction).unwrap() - eye;
                    let [low, high] = shape.bounds().unwrap();
                    let farthest = p + eye;
                    let slack = 1e-9 * (farthest.length() + size);
                    if !holds_solids(shape) {
                        assert!(farthest.cmpge(low - slack).all(), "{shape:?}");
                        assert!(farthest.cmple(high + slack).all(), "{shape:?}");
                    }
                    let depth = -p.dot(w);
                    let (width, height) = frame.size;
                    let top = libm::tan(half_angle) * (1.0 - 2.0 * frame.margin) * depth;
                    let right = top * f64::from(width) / f64::from(height);
                    let slack = 1e-9 * eye.length();
                    assert!(p.dot(u).abs() <= right + slack, "{shape:?} {frame:?}");
                    assert!(p.dot(v).abs() <= top + slack, "{shape:?} {frame:?}");
                }
            }
        }
    }

    // The points of a sphere and its turned copies have the same extremes as one that is turned.
    #[test]
    fn a_turntable_shows_each_shape_at_every_frame() {
        let mut rng = Rng(0x7f17);
        for _ in 0..cases(300) {
            let axis = unit(rng.vector());
            let around = rng.vector();
            let turns: Vec<_> = (0..7)
                .map(|_| DMat3::from_axis_angle(axis, 4.0 * rng.signed()))
                .collect();
            let table = Turntable {
                around,
                axis,
                turns: turns.clone(),
            };
            let spheres: Vec<_> = (0..20)
                .map(|_| Sphere::new(rng.vector() * 3.0, rng.magnitude(-2.0, 0.0)).unwrap())
                .collect();
            let directions = [unit(rng.vector()), unit(rng.vector())];
            let (mut one, mut other) = (Extremes::new(&directions), Extremes::new(&directions));
            for sphere in &spheres {
                one.add_turned(&(*sphere).into(), &table, 1..7);
                for turn in &turns[1..] {
                    let center = around + turn.transpose() * (sphere.center() - around);
                    let sphere = Sphere::new(center, sphere.radius()).unwrap();
                    other.add(&sphere.into());
                }
            }
            let (one, other): ([DVec3; 2], [DVec3; 2]) =
                (one.points().unwrap(), other.points().unwrap());
            for (one, other) in one.into_iter().zip(other) {
                assert!((one - other).length() < 1e-13, "{one} {other}");
            }
        }
    }

    #[test]
    fn what_cannot_be_framed_is_rejected() {
        let frame = Frame {
            from: DVec3::ONE,
            up: DVec3::Y,
            margin: 0.05,
            size: (4, 3),
        };
        let eye = |shapes: &[Shape]| frame.perspective_eye(0.3, search(shapes));
        let plane = Plane::new(DVec3::ZERO, DVec3::Y).unwrap();
        for shapes in [&[][..], &[plane.into()]] {
            assert_eq!(eye(shapes), Err(GeometryError::NothingToFit));
            let parallel = frame.orthographic_eye(search(shapes));
            assert_eq!(parallel, Err(GeometryError::NothingToFit));
        }
        let sphere = |x, radius| Sphere::new(DVec3::splat(x), radius).unwrap().into();
        for shape in [
            sphere(1e308, 1e308),
            sphere(0.0, 1.7e308),
            sphere(1e10, 1e-9),
            sphere(1.0, 5e-324),
        ] {
            assert_eq!(eye(&[shape]), Err(GeometryError::CannotFit));
        }
        for shape in [sphere(0.0, 1e-300), sphere(0.0, 1e300), sphere(1e10, 1.0)] {
            assert!(eye(std::slice::from_ref(&shape)).is_ok());
            assert!(frame.orthographic_eye(search(&[shape])).is_ok());
        }
        let parallel = Frame {
            from: DVec3::NEG_Y,
            ..frame
        };
        assert!(matches!(
            parallel.perspective_eye(0.3, search(&[sphere(0.0, 1.0)])),
            Err(GeometryError::ParallelVectors { .. })
        ));
    }
}
