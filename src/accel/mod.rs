//! The nearest hit of [`World::hit`](crate::tracer::world::World::hit), sooner, and not one bit
//! different.
//!
//! For the rays of a camera there is [`raster`], which knows them in advance. For rays that start
//! anywhere there is a tree over all shapes that have an end, [`bvh`]. Both have fast ways for
//! spheres, and the raster for planes; any other shape is only asked by its own equation, where it
//! may be met at all. The equations in lanes of eight are in [`lanes`].

pub(crate) mod bvh;
mod lanes;
pub(crate) mod raster;

use glam::DVec3;

/// By how much a box or a ball has to grow, whose points have coordinates of at most these, so that
/// it also holds the points `o + t·d` of a shape in it: each coordinate is the sum of two rounded
/// numbers.
fn rounding(coordinates: DVec3) -> f64 {
    8.0 * f64::EPSILON * coordinates.max_element()
}
