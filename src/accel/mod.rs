//! The nearest hit of [`World::hit`](crate::tracer::world::World::hit), sooner, and not one bit
//! different.
//!
//! For the rays of a camera: [`grouping`] says what a tile is, [`view`] knows how a sphere looks
//! from there, [`footprint`] finds the pixels that it may cover, [`bins`] sorts it into the screen
//! tiles that they lie in, [`planes`] finds out which planes matter to a tile, and [`tile`] finds
//! what each of its pixels sees, by the equations that [`rays`] holds. Where a pixel has several
//! samples [`samples`] finds out which pixels see one thing alone. [`first_hits`] does all of it
//! for a picture.
//!
//! For rays that start anywhere there is a tree over all shapes that have an end, [`bvh`].

pub(crate) mod bins;
pub(crate) mod bvh;
pub(crate) mod first_hits;
pub(crate) mod footprint;
pub(crate) mod grouping;
mod plane_bounds;
mod planes;
mod rays;
mod samples;
#[cfg(test)]
mod tests;
mod tile;
mod view;

use glam::DVec3;

/// By how much a box or a ball has to grow, whose points have coordinates of at most these, so that
/// it also holds the points `o + t·d` of a shape in it: each coordinate is the sum of two rounded
/// numbers.
fn rounding(coordinates: DVec3) -> f64 {
    8.0 * f64::EPSILON * coordinates.max_element()
}
