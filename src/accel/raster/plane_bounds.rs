//! Bounds on the hits of planes within a pixel.

use crate::{
    accel::{
        lanes::{dot, splat3, sub},
        raster::{
            planes::NumberedPlane,
            rays::{Parallel, Pinhole},
            view::{HUGE, RasterView},
        },
    },
    simd::{F64x8, Simd},
};

/// Bounds on the hits of planes within a pixel.
pub(super) trait PlaneBounds<S: Simd> {
    /// The terms of a plane that all pixels share.
    type Terms: Copy;

    /// Returns the terms of a plane; `None` if no bounds are known.
    fn plane_terms(&self, simd: S, plane: &NumberedPlane, view: &RasterView)
    -> Option<Self::Terms>;

    /// Returns the smallest t at which a ray of a pixel may hit a plane, and the largest t by which
    /// all have hit it.
    fn plane_bounds(simd: S, terms: Self::Terms, point: [S::F64; 3]) -> [S::F64; 2];
}

impl<S: Simd> PlaneBounds<S> for Pinhole {
    /// The normal towards the plane, the largest change of d·n, and (a-o)·n.
    type Terms = ([S::F64; 3], S::F64, S::F64);

    #[inline(always)]
    fn plane_terms(
        &self,
        simd: S,
        plane: &NumberedPlane,
        view: &RasterView,
    ) -> Option<Self::Terms> {
        let normal = plane.plane.normal();
        let (length, distance) = (normal.length(), plane.from_eye.abs());
        let change = (1.01 * view.spread() + 1e-7) * length;
        let terms = (
            splat3(simd, normal * plane.from_eye.signum()),
            simd.splat(change),
            simd.splat(distance),
        );
        let is_sane = [length, distance, change].iter().all(is_sane);
        is_sane.then_some(terms)
    }

    /// `t = from_eye/(d·n)`, where d varies.
    #[inline(always)]
    fn plane_bounds(
        simd: S,
        (normal, change, distance): Self::Terms,
        d: [S::F64; 3],
    ) -> [S::F64; 2] {
        let (zero, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
        let toward = dot(d, normal);
        let (most, least) = (toward + change, toward - change);
        let near = distance * simd.splat(1.0 - 1e-6) / most;
        let far = distance * simd.splat(1.0 + 1e-6) / least;
        [
            S::F64::select(zero.lt(most), near, infinity),
            S::F64::select(zero.lt(least), far, infinity),
        ]
    }
}

impl<S: Simd> PlaneBounds<S> for Parallel {
    /// a, n, d·n, and the largest change of t.
    type Terms = ([S::F64; 3], [S::F64; 3], S::F64, S::F64);

    #[inline(always)]
    fn plane_terms(
        &self,
        simd: S,
        plane: &NumberedPlane,
        view: &RasterView,
    ) -> Option<Self::Terms> {
        let (at, normal) = (plane.plane.point(), plane.plane.normal());
        let (length, toward) = (normal.length(), self.direction.dot(normal));
        let far = (at - view.camera.eye()).length() + view.reach();
        let change = (view.spread() + 1e-7 * far) * length / toward.abs();
        let terms = (
            splat3(simd, at),
            splat3(simd, normal),
            simd.splat(toward),
            simd.splat(change),
        );
        let is_sane = [length, change].iter().all(is_sane) && toward.abs() > 1e-6 * length;
        is_sane.then_some(terms)
    }

    /// `t = ((a-o)·n)/(d·n)`, where o varies.
    #[inline(always)]
    fn plane_bounds(
        simd: S,
        (at, normal, toward, change): Self::Terms,
        o: [S::F64; 3],
    ) -> [S::F64; 2] {
        let (zero, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
        let t = dot(sub(at, o), normal) / toward;
        let (near, far) = (t - change, t + change);
        let all_meet = zero.lt(near);
        let near = S::F64::select(all_meet, near, zero);
        [
            S::F64::select(far.lt(zero), infinity, near),
            S::F64::select(all_meet, far, infinity),
        ]
    }
}

fn is_sane(x: &f64) -> bool {
    1.0 / HUGE < *x && *x < HUGE
}
