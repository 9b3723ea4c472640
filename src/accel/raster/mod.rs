//! What the rays of a camera hit.
//!
//! [`grouping`] says what a tile is, [`view`] knows how a ball looks from the camera, [`footprint`]
//! finds the pixels that it may cover, [`bins`] sorts it into the screen tiles that they lie in,
//! [`planes`] finds out which planes matter to a tile, and [`tile`] finds what each of its pixels
//! sees, by the equations that [`rays`] holds. Where a pixel has several samples [`samples`] finds
//! out which pixels see one thing alone. [`first_hits`] does all of it for a picture.

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
mod view;
