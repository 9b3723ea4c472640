//! The hits of a camera's rays.
//!
//! [`grouping`] defines tiles, [`view`] computes the projection of a ball, [`footprint`] finds the
//! pixels that it may cover, [`bins`] sorts it into the tiles of these pixels, [`planes`] finds the
//! planes that matter to a tile, and [`tile`] finds the geometry that each of its pixels sees, by
//! the equations in [`rays`]. With several samples per pixel, [`samples`] finds the pixels that see
//! a single geometry. [`first_hits`] does all of it for a picture.

mod binned;
pub(crate) mod bins;
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
pub(crate) mod view;
