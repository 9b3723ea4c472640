//! The reference implementation: small pure values and the formulas between them, in f64.
//!
//! Every operation is rounded separately, from left to right, and none is fused, so the results are
//! identical on every machine.

pub(crate) mod camera;
pub(crate) mod color;
pub(crate) mod colormap;
pub(crate) mod contact;
pub(crate) mod error;
pub(crate) mod geometry;
pub(crate) mod hit;
pub mod light;
pub mod material;
pub(crate) mod radiance;
#[cfg(test)]
pub(crate) mod random;
pub(crate) mod ray;
pub(crate) mod sampling;
pub mod shape;
pub(crate) mod srgb;
pub(crate) mod texels;
pub(crate) mod tone;
pub(crate) mod transform;
pub(crate) mod vector;
pub(crate) mod world;
