//! Faster versions of [`World::hit`](crate::tracer::world::World::hit) with bit-identical results.
//!
//! [`raster`] serves the rays of a camera, which are known in advance. [`bvh`] serves rays that
//! start anywhere: a tree over all bounded shapes. Both have fast paths for spheres, and the raster
//! for planes; any other shape is tested by its own equation, and only where it may be hit.
//! A mesh is one shape to both, with a tree of its own over its triangles, in [`mesh`]; so is a list of
//! copies, in [`instances`].
//! [`shadow`] finds which of many points lie in the shadow of a light.
//! [`lanes`] holds the equations for eight lanes, and [`pages`] the memory of trees.

pub(crate) mod bvh;
pub(crate) mod instances;
pub(crate) mod lanes;
pub(crate) mod mesh;
pub(crate) mod pages;
pub(crate) mod raster;
pub(crate) mod shadow;

use glam::DVec3;

use crate::{
    accel::{instances::index_copies, mesh::index_mesh},
    parallel::Pool,
    simd::Isa,
    tracer::{geometry::Geometry, shape::Shape},
};

/// Gives the shapes of geometries an index, if they may have one.
pub(crate) fn index_shapes<'a>(
    geometries: impl IntoIterator<Item = &'a Geometry>,
    pool: &Pool,
    isa: Isa,
) {
    for geometry in geometries {
        index_shape(geometry.shape(), pool, isa);
    }
}

fn index_shape(shape: &Shape, pool: &Pool, isa: Isa) {
    if let Some(mesh) = shape.mesh() {
        index_mesh(mesh, pool, isa);
    }
    if let Some(copies) = shape.copies() {
        copies
            .shapes()
            .for_each(|shape| index_shape(shape, pool, isa));
        index_copies(copies, pool, isa);
    }
}

/// Returns the margin by which to grow a box or a ball whose points have coordinates of at most
/// these, so that it also holds the points `o + t·d` of a shape in it: each coordinate is the sum
/// of two rounded numbers.
fn rounding(coordinates: DVec3) -> f64 {
    8.0 * f64::EPSILON * coordinates.max_element()
}
