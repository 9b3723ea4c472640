//! Rendering: the view of a camera into a world, and the layers of a picture.

pub(crate) mod layers;
pub(crate) mod ray_tracer;
pub(crate) mod visibility;

pub use layers::Layer;
pub use visibility::Seen;

#[doc(hidden)]
pub use crate::{
    simd::Isa,
    tracer::shape::working::{Term, Working},
};
