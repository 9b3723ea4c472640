//! Many pictures: search for scenes, project configuration, and division of the work.

pub(crate) mod batch;
pub(crate) mod config;
pub(crate) mod shard;

pub use batch::{
    Checked, check_files,
    search::{SceneFile, find_scenes, no_scene},
};
pub use config::{Config, Configs};
pub use shard::{Shard, ShardError};
