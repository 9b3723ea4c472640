//! The rays of a camera and their hits, eight at a time, by the textbook's formulas in their order
//! of operations.

use glam::DVec3;

use crate::{
    accel::{
        lanes::{Divide, dot, splat3, sub, unit},
        raster::planes::{Corners, NumberedPlane},
    },
    simd::{LANES, Simd},
    tracer::{ray::Bundle, shape::sphere::Sphere},
};

/// The common properties of a picture's rays. Pixels differ by a point (x, y, z): a direction or an
/// origin.
pub(super) trait Rays<S: Simd>: Divide<S> {
    /// The terms of a sphere that all rays share.
    type Sphere: Copy;
    /// The terms of a plane that all rays share.
    type Plane: Copy;

    /// Returns the points of eight pixels, from the sum that the camera defines, and `A = d·d`.
    fn points(&self, simd: S, sum: [S::F64; 3]) -> ([S::F64; 3], S::F64);
    fn sphere(&self, simd: S, sphere: &Sphere) -> Self::Sphere;
    /// Returns B and C of the quadratic equation.
    fn terms(sphere: Self::Sphere, point: [S::F64; 3]) -> (S::F64, S::F64);
    fn plane(&self, simd: S, plane: &NumberedPlane) -> Self::Plane;
    /// Returns t, whatever its value.
    fn meets(plane: Self::Plane, point: [S::F64; 3]) -> S::F64;
    fn corners(&self, sums: [DVec3; 4]) -> Corners;
    /// Returns the rays of eight pixels, which end before `t_max`.
    fn bundle(&self, points: [[f64; LANES]; 3], t_max: [f64; LANES]) -> Bundle;
}

/// Rays that all start at the eye; a point is a direction.
pub(super) struct Pinhole {
    pub(super) eye: DVec3,
}

/// Rays that all have the same direction; a point is an origin.
pub(super) struct Parallel {
    pub(super) direction: DVec3,
    /// True if `A = d·d` is exactly 1.
    is_unit: bool,
}

impl Parallel {
    pub(super) fn new(direction: DVec3) -> Self {
        let is_unit = direction.dot(direction) == 1.0;
        Self { direction, is_unit }
    }
}

impl<S: Simd> Divide<S> for Pinhole {}

impl<S: Simd> Divide<S> for Parallel {
    #[inline(always)]
    fn over_2a(&self, simd: S, x: S::F64, a: S::F64) -> S::F64 {
        if self.is_unit {
            // Equal to x/2, but faster.
            x * simd.splat(0.5)
        } else {
            x / (simd.splat(2.0) * a)
        }
    }
}

impl<S: Simd> Rays<S> for Pinhole {
    /// 2(o-c), and C.
    type Sphere = ([S::F64; 3], S::F64);
    /// (a-o)·n, and n.
    type Plane = (S::F64, [S::F64; 3]);

    #[inline(always)]
    fn points(&self, _: S, sum: [S::F64; 3]) -> ([S::F64; 3], S::F64) {
        let d = unit(sum);
        (d, dot(d, d))
    }

    #[inline(always)]
    fn sphere(&self, simd: S, sphere: &Sphere) -> Self::Sphere {
        let oc = self.eye - sphere.center();
        let c = oc.dot(oc) - sphere.radius() * sphere.radius();
        (splat3(simd, 2.0 * oc), simd.splat(c))
    }

    #[inline(always)]
    fn terms((oc2, c): Self::Sphere, d: [S::F64; 3]) -> (S::F64, S::F64) {
        (dot(d, oc2), c)
    }

    #[inline(always)]
    fn plane(&self, simd: S, plane: &NumberedPlane) -> Self::Plane {
        let normal = plane.plane.normal();
        (simd.splat(plane.from_eye), splat3(simd, normal))
    }

    #[inline(always)]
    fn meets((from_eye, normal): Self::Plane, d: [S::F64; 3]) -> S::F64 {
        from_eye / dot(d, normal)
    }

    #[inline(always)]
    fn corners(&self, sums: [DVec3; 4]) -> Corners {
        Corners::Directions(sums)
    }

    #[inline]
    fn bundle(&self, directions: [[f64; LANES]; 3], t_max: [f64; LANES]) -> Bundle {
        Bundle::new(in_all(self.eye), directions, t_max)
    }
}

impl<S: Simd> Rays<S> for Parallel {
    /// c, r·r and 2d.
    type Sphere = ([S::F64; 3], S::F64, [S::F64; 3]);
    /// a, n and d·n.
    type Plane = ([S::F64; 3], [S::F64; 3], S::F64);

    #[inline(always)]
    fn points(&self, simd: S, sum: [S::F64; 3]) -> ([S::F64; 3], S::F64) {
        (sum, simd.splat(self.direction.dot(self.direction)))
    }

    #[inline(always)]
    fn sphere(&self, simd: S, sphere: &Sphere) -> Self::Sphere {
        let squared = sphere.radius() * sphere.radius();
        let center = splat3(simd, sphere.center());
        (
            center,
            simd.splat(squared),
            splat3(simd, 2.0 * self.direction),
        )
    }

    #[inline(always)]
    fn terms((center, squared, d2): Self::Sphere, o: [S::F64; 3]) -> (S::F64, S::F64) {
        let oc = sub(o, center);
        // d·(2(o-c)) has the same bits, since doubling is exact. One of them may overflow where the
        // other does not, but then C is infinite as well, and nothing is hit.
        (dot(d2, oc), dot(oc, oc) - squared)
    }

    #[inline(always)]
    fn plane(&self, simd: S, plane: &NumberedPlane) -> Self::Plane {
        let normal = plane.plane.normal();
        let toward = simd.splat(self.direction.dot(normal));
        (
            splat3(simd, plane.plane.point()),
            splat3(simd, normal),
            toward,
        )
    }

    #[inline(always)]
    fn meets((point, normal, toward): Self::Plane, o: [S::F64; 3]) -> S::F64 {
        dot(sub(point, o), normal) / toward
    }

    #[inline(always)]
    fn corners(&self, sums: [DVec3; 4]) -> Corners {
        Corners::Origins(sums, self.direction)
    }

    #[inline]
    fn bundle(&self, origins: [[f64; LANES]; 3], t_max: [f64; LANES]) -> Bundle {
        Bundle::new(origins, in_all(self.direction), t_max)
    }
}

/// Returns a vector in all lanes.
fn in_all(vector: DVec3) -> [[f64; LANES]; 3] {
    vector.to_array().map(|x| [x; LANES])
}
