//! Many pictures: the scenes that are found, how a project wants them, and who draws which.

pub(crate) mod batch;
pub(crate) mod config;
pub(crate) mod shard;
