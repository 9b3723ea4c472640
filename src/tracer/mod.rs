//! The textbook: small pure values and the formulas between them, in f64.
//!
//! Every operation is rounded on its own, from left to right, and none is fused: the numbers
//! that come out are the same on every machine.

pub(crate) mod camera;
pub(crate) mod color;
pub(crate) mod error;
pub(crate) mod geometry;
pub(crate) mod hit;
pub(crate) mod radiance;
#[cfg(test)]
pub(crate) mod random;
pub(crate) mod ray;
pub(crate) mod shape;
pub(crate) mod srgb;
pub(crate) mod vector;
pub(crate) mod world;
