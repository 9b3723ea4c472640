//! Faster versions of [`World::hit`](crate::tracer::world::World::hit) with bit-identical results.
//!
//! [`raster`] serves the rays of a camera, which are known in advance. [`bvh`] serves rays that
//! start anywhere: a tree over all bounded shapes. Both have fast paths for spheres, and the raster
//! for planes; any other shape is tested by its own equation, and only where it may be hit.
//! A mesh is one shape to both, with a tree of its own over its triangles, in [`mesh`]; so are a list of
//! copies, in [`instances`], and a solid of many parts, in [`solid`]: their trees are [`places`].
//! [`shadow`] finds which of many points lie in the shadow of a light.
//! [`index`] gives meshes, copies and solids their trees.
//! [`kept`] holds what the frames of an animation share, and [`runs`] the parts of a world that it is of.
//! [`near_faces`] excludes faces that points do not lie on.
//! [`convex`] tests cylinders, cones, boxes and discs by eight rays.
//! [`lanes`] holds the equations for eight lanes, [`pow`] their powers, and [`pages`] the memory of trees.

pub(crate) mod bvh;
mod convex;
mod index;
pub(crate) mod instances;
pub(crate) mod kept;
pub(crate) mod lanes;
pub(crate) mod mesh;
pub(crate) mod near_faces;
pub(crate) mod pages;
mod places;
pub(crate) mod pow;
pub(crate) mod raster;
pub(crate) mod runs;
pub(crate) mod shadow;
mod solid;

use glam::DVec3;

use crate::{
    accel::convex::{FirstOfEach, is_tested},
    simd::Simd,
    tracer::{
        ray::{BUNDLE, Bundle},
        shape::{
            Shape,
            face::{Crossing, Faces, Leaving},
        },
    },
};

/// Returns the first crossing of each ray of a bundle with a shape.
pub(crate) fn first_of_each<S: Simd>(
    simd: S,
    shape: &Shape,
    bundle: &Bundle,
    leaving: &[Leaving; BUNDLE],
) -> [Option<Crossing>; BUNDLE] {
    match is_tested(shape) {
        true => simd.call(FirstOfEach {
            shape,
            bundle,
            leaving,
        }),
        false => shape.first_of_each(bundle, leaving),
    }
}

/// Prefetches what a shape refers to, which is not in its place among the others.
#[inline(always)]
fn prefetch_inside<S: Simd>(simd: S, shape: &Shape) {
    match shape {
        Shape::Cylinder(it) => simd.prefetch(&**it),
        Shape::Cone(it) => simd.prefetch(&**it),
        Shape::Cuboid(it) => simd.prefetch(&**it),
        Shape::Disc(it) => simd.prefetch(&**it),
        _ => {}
    }
}

/// Returns the faces that the rays of [`Bundle::to`] meet.
pub(crate) fn face_of_each<S: Simd>(simd: S, shape: &Shape, bundle: &Bundle) -> [u64; BUNDLE] {
    match shape.faces() {
        Faces::Flat | Faces::Curved => [0; BUNDLE],
        Faces::Several | Faces::Copies => {
            let met = first_of_each(simd, shape, bundle, &[Leaving::NOTHING; BUNDLE]);
            met.map(|met| met.map_or(0, |crossing| crossing.face))
        }
    }
}

/// Returns the margin by which to grow a box or a ball whose points have coordinates of at most
/// these, so that it also holds the points `o + t·d` of a shape in it: each coordinate is the sum
/// of two rounded numbers.
fn rounding(coordinates: DVec3) -> f64 {
    8.0 * f64::EPSILON * coordinates.max_element()
}
