//! What a camera sees of a world, and which of it a picture shows.

pub(crate) mod layers;
pub(crate) mod ray_tracer;
pub(crate) mod seen;
