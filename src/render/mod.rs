//! What a camera sees of a world, and which of it a picture shows.

pub(crate) mod layers;
pub(crate) mod ray_tracer;
pub(crate) mod seen;

pub use layers::Layer;
pub use seen::Seen;

#[doc(hidden)]
pub use crate::{
    simd::Isa,
    tracer::shape::working::{Term, Working},
};
