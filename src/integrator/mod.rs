//! The light that a ray brings back.

pub(crate) mod accelerated;
pub(crate) mod batch;
pub(crate) mod direct;
pub(crate) mod explain;
