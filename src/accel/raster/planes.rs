//! The planes that matter to a tile.

use glam::DVec3;

use crate::{
    accel::raster::view::HUGE,
    tracer::{
        geometry::Geometry,
        shape::{Extent, plane::Plane},
    },
};

/// A plane and its id in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct NumberedPlane {
    pub(super) id: u32,
    pub(super) plane: Plane,
    /// `(point - eye)·normal`
    pub(super) from_eye: f64,
}

/// The corners of a tile: the part of a ray that differs between pixels.
#[derive(Clone, Copy, Debug)]
pub(super) enum Corners {
    /// Rays that all start at the eye; the corners are directions of any length.
    Directions([DVec3; 4]),
    /// Rays that all have the same direction; the corners are origins.
    Origins([DVec3; 4], DVec3),
}

/// The known relation between a plane and the rays of a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Known {
    Missed,
    /// Hit by every ray, with a number for each corner that is larger the nearer the hit is. The
    /// numbers are affine on the screen: a relation at the corners holds between them.
    Hit([f64; 4]),
    Open,
}

/// The distance from 0, relative to the largest of its terms, at which the sign of a number is
/// certain; rounding errors are a millionth of that.
const CLEAR: f64 = 1e-6;

impl NumberedPlane {
    pub(super) fn new(id: u32, geometry: &Geometry, eye: DVec3) -> Option<Self> {
        match geometry.shape().extent() {
            Extent::Plane(plane) => Some(Self {
                id,
                plane: *plane,
                from_eye: (plane.point() - eye).dot(plane.normal()),
            }),
            Extent::Ball(..) => None,
        }
    }

    fn known(&self, corners: &Corners) -> Known {
        let normal = self.plane.normal();
        let length = normal.length();
        let sane = |x: f64| 1.0 / HUGE < x && x < HUGE;
        if !sane(length) {
            return Known::Open;
        }
        match corners {
            // t = from_eye·|r| / (r·n). Its reciprocal is compared, without |r|, which all planes
            // share.
            Corners::Directions(directions) => {
                if !sane(self.from_eye.abs()) {
                    return Known::Open;
                }
                let longest = directions
                    .map(DVec3::length)
                    .into_iter()
                    .fold(0.0, f64::max);
                let toward = directions.map(|r| r.dot(normal) * self.from_eye.signum());
                decide(toward, CLEAR * longest * length, |toward| {
                    toward / self.from_eye.abs()
                })
            }
            // t = ((a - o)·n) / (d·n).
            Corners::Origins(origins, direction) => {
                let toward = direction.dot(normal);
                // Exactly zero for all rays.
                if toward == 0.0 {
                    return Known::Missed;
                }
                if toward.abs() <= CLEAR * length * direction.length() {
                    return Known::Open;
                }
                let ahead = origins.map(|o| (self.plane.point() - o).dot(normal) * toward.signum());
                let largest = origins.map(|o| {
                    self.plane
                        .point()
                        .abs()
                        .max_element()
                        .max(o.abs().max_element())
                });
                let largest = largest.into_iter().fold(0.0, f64::max);
                if !sane(largest) {
                    return Known::Open;
                }
                decide(ahead, CLEAR * largest * length, |ahead| {
                    -ahead / toward.abs()
                })
            }
        }
    }
}

/// Returns a hit if all four numbers are above 0, a miss if all are below.
fn decide(numbers: [f64; 4], clear: f64, nearness: impl Fn(f64) -> f64) -> Known {
    if numbers.iter().all(|x| *x > clear) {
        Known::Hit(numbers.map(nearness))
    } else if numbers.iter().all(|x| *x < -clear) {
        Known::Missed
    } else {
        Known::Open
    }
}

/// Writes to `out` the planes that may hold the nearest hit of any ray of a tile. Returns true if
/// there is exactly one and every ray hits it, or if there are none.
pub(super) fn relevant(
    planes: &[NumberedPlane],
    corners: &Corners,
    out: &mut Vec<NumberedPlane>,
) -> bool {
    out.clear();
    let mut nearest: Option<[f64; 4]> = None;
    let mut closed = true;
    for plane in planes {
        match plane.known(corners) {
            Known::Missed => {}
            Known::Open => {
                closed = false;
                out.push(*plane);
            }
            Known::Hit(nearness) => match nearest {
                Some(first) if before(&first, &nearness) => {}
                Some(first) if closed && before(&nearness, &first) => {
                    nearest = Some(nearness);
                    out.clear();
                    out.push(*plane);
                }
                Some(_) => {
                    closed = false;
                    out.push(*plane);
                }
                None => {
                    nearest = Some(nearness);
                    out.push(*plane);
                }
            },
        }
    }
    closed
}

/// Returns true if one plane is certainly in front of another in the whole tile.
fn before(one: &[f64; 4], other: &[f64; 4]) -> bool {
    one.iter()
        .zip(other)
        .all(|(one, other)| one - other > CLEAR * one.abs().max(other.abs()))
}
