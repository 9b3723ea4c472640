//! Changes over time: keys on tracks, and the scene at any of its frames.
//!
//! A frame depends only on the scene and on its number: frame n, from 0, is the scene at n / fps
//! seconds.

mod curve;
pub(crate) mod frames;
mod orbit;
mod places;
pub(crate) mod target;
#[cfg(test)]
mod tests;
