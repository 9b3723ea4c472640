//! The test of triangles in eight lanes, by the equations of the format in their order of operations:
//! eight rays and one triangle, or one ray and eight triangles.

use glam::DVec3;

use crate::{
    accel::{
        lanes::{abs, splat3, sub},
        mesh::patch::Patch,
    },
    simd::{F64x8, Mask, Simd},
    tracer::shape::triangle,
};

/// Rays as the test of triangles needs them: the tracer's [`triangle::Sheared`], with the same axes in
/// all lanes.
pub(in crate::accel) struct Sheared<S: Simd> {
    origin: [S::F64; 3],
    /// The axes across, then the one along.
    axes: [usize; 3],
    /// `Sx`, `Sy` and `Sz`.
    shear: [S::F64; 3],
}

impl<S: Simd> Sheared<S> {
    /// Prepares eight rays; `None` if they do not have the same axes.
    #[inline(always)]
    pub(in crate::accel) fn new(simd: S, [origin, d]: [[S::F64; 3]; 2]) -> Option<Self> {
        let [x, y, z] = [abs(d[0]), abs(d[1]), abs(d[2])];
        let is_x = y.le(x) & z.le(x);
        let is_y = !is_x & z.le(y);
        let along = match (is_x.bits(), is_y.bits()) {
            (u8::MAX, _) => 0,
            (0, u8::MAX) => 1,
            (0, 0) => 2,
            _ => return None,
        };
        let mut axes = [(along + 1) % 3, (along + 2) % 3, along];
        match d[along].lt(simd.splat(0.0)).bits() {
            0 => {}
            u8::MAX => axes.swap(0, 1),
            _ => return None,
        }
        let [x, y, z] = [d[axes[0]], d[axes[1]], d[axes[2]]];
        Some(Self {
            origin: [origin[axes[0]], origin[axes[1]], origin[axes[2]]],
            axes,
            shear: [x / z, y / z, simd.splat(1.0) / z],
        })
    }

    /// The same ray in all lanes.
    #[inline(always)]
    pub(super) fn one(simd: S, ray: &triangle::Sheared) -> Self {
        let axes = ray.axes();
        Self {
            origin: by_axes(simd, axes, &ray.origin()),
            axes,
            shear: splat3(simd, ray.shear()),
        }
    }

    /// Returns a corner of a patch as the rays see it.
    #[inline(always)]
    pub(super) fn corner(&self, simd: S, patch: &Patch, place: usize) -> [S::F64; 3] {
        let [x, y, z] = self.axes;
        let corner = patch.corner(place);
        self.see([
            simd.splat(corner[x]),
            simd.splat(corner[y]),
            simd.splat(corner[z]),
        ])
    }

    /// Returns a corner of a triangle as the rays see it.
    #[inline(always)]
    pub(in crate::accel) fn point(&self, simd: S, corner: &DVec3) -> [S::F64; 3] {
        self.see(by_axes(simd, self.axes, corner))
    }

    /// Returns corners as the rays see them: across, then along. Each is given in the order of the axes.
    #[inline(always)]
    fn see(&self, corner: [S::F64; 3]) -> [S::F64; 3] {
        let [sx, sy, sz] = self.shear;
        let [x, y, z] = sub(corner, self.origin);
        [x - sx * z, y - sy * z, sz * z]
    }

    /// Returns the corners of a patch's triangles as the ray sees them.
    #[inline(always)]
    pub(super) fn corners(&self, simd: S, patch: &Patch) -> [[S::F64; 3]; 3] {
        let [x, y, z] = self.axes;
        let ((x, far_x), (y, far_y), (z, far_z)) =
            (patch.halves(x), patch.halves(y), patch.halves(z));
        let low = self.see([simd.load(x), simd.load(y), simd.load(z)]);
        let high = self.see([
            simd.load_twice(far_x),
            simd.load_twice(far_y),
            simd.load_twice(far_z),
        ]);
        let mut corners = [low; 3];
        for (corner, places) in corners.iter_mut().zip(&patch.places) {
            for (axis, of) in corner.iter_mut().zip(std::iter::zip(low, high)) {
                *axis = simd.pick(of.into(), *places);
            }
        }
        corners
    }
}

/// Rays as the test of triangles needs them, each with axes of its own.
#[derive(Clone, Copy)]
pub(in crate::accel) struct ShearedApart<S: Simd> {
    /// The lanes in which the axis along is x, and y.
    is_x: S::Mask,
    is_y: S::Mask,
    /// Those of rays that go back along it.
    is_back: S::Mask,
    origin: [S::F64; 3],
    shear: [S::F64; 3],
}

impl<S: Simd> ShearedApart<S> {
    /// Prepares eight rays.
    #[inline(always)]
    pub(in crate::accel) fn new(simd: S, [origin, d]: [[S::F64; 3]; 2]) -> Self {
        let [x, y, z] = [abs(d[0]), abs(d[1]), abs(d[2])];
        let is_x = y.le(x) & z.le(x);
        let is_y = !is_x & z.le(y);
        let along = S::F64::select(is_x, d[0], S::F64::select(is_y, d[1], d[2]));
        let mut sheared = Self {
            is_x,
            is_y,
            is_back: along.lt(simd.splat(0.0)),
            origin,
            shear: d,
        };
        sheared.origin = sheared.in_order(origin);
        let [x, y, z] = sheared.in_order(d);
        sheared.shear = [x / z, y / z, simd.splat(1.0) / z];
        sheared
    }

    /// Returns the numbers of vectors in the order of the axes: across, then along.
    #[inline(always)]
    fn in_order(&self, [x, y, z]: [S::F64; 3]) -> [S::F64; 3] {
        let of = |at_x, at_y, at_z| {
            S::F64::select(self.is_x, at_x, S::F64::select(self.is_y, at_y, at_z))
        };
        let (next, last) = (of(y, z, x), of(z, x, y));
        [
            S::F64::select(self.is_back, last, next),
            S::F64::select(self.is_back, next, last),
            of(x, y, z),
        ]
    }

    /// Returns a corner of a triangle as the rays see it.
    #[inline(always)]
    pub(in crate::accel) fn point(&self, simd: S, corner: &DVec3) -> [S::F64; 3] {
        let [sx, sy, sz] = self.shear;
        let [x, y, z] = sub(self.in_order(splat3(simd, *corner)), self.origin);
        [x - sx * z, y - sy * z, sz * z]
    }
}

/// Returns the `t` at which rays cross triangles, whose corners they see there, and the lanes in which
/// `0 < t < ∞`; `None` if no ray's line meets its triangle.
#[inline(always)]
pub(in crate::accel) fn crossings<S: Simd>(
    simd: S,
    [a, b, c]: [[S::F64; 3]; 3],
) -> Option<(S::F64, S::Mask)> {
    let zero = simd.splat(0.0);
    let ([u, v, w], sum, is_hit) = edges(simd, [a, b, c]);
    if is_hit.bits() == 0 {
        return None;
    }
    let t = ((u * a[2] + v * b[2]) + w * c[2]) / sum;
    Some((t, is_hit & zero.lt(t) & t.lt(simd.splat(f64::INFINITY))))
}

/// Returns the lanes in which a ray's line meets a triangle, whose corners it sees there.
#[inline(always)]
pub(in crate::accel) fn is_hit<S: Simd>(simd: S, corners: [[S::F64; 3]; 3]) -> S::Mask {
    edges(simd, corners).2
}

/// Returns U, V and W, their sum, and the lanes in which a ray's line meets a triangle.
#[inline(always)]
fn edges<S: Simd>(simd: S, [a, b, c]: [[S::F64; 3]; 3]) -> ([S::F64; 3], S::F64, S::Mask) {
    let zero = simd.splat(0.0);
    let u = c[0] * b[1] - c[1] * b[0];
    let v = a[0] * c[1] - a[1] * c[0];
    let w = b[0] * a[1] - b[1] * a[0];
    let is_outside = u.min(v).min(w).lt(zero) & zero.lt(u.max(v).max(w));
    let sum = (u + v) + w;
    ([u, v, w], sum, !is_outside & !sum.eq(zero))
}

/// Returns the numbers of a vector in the order of the axes, each in all lanes.
#[inline(always)]
fn by_axes<S: Simd>(simd: S, axes: [usize; 3], vector: &DVec3) -> [S::F64; 3] {
    let [x, y, z] = axes;
    let vector: &[f64; 3] = vector.as_ref();
    [
        simd.splat(vector[x]),
        simd.splat(vector[y]),
        simd.splat(vector[z]),
    ]
}
