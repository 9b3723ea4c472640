//! The option that leaves `strahl.toml` out.

use strahl::jobs::Configs;

/// Whether `strahl.toml` counts.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct ConfigArgs {
    /// Do not read `strahl.toml` from the folder of the scene or its parents
    #[arg(long)]
    no_config: bool,
}

impl ConfigArgs {
    /// The configurations that count.
    pub(super) fn configs(&self) -> Configs {
        if self.no_config {
            Configs::none()
        } else {
            Configs::new()
        }
    }
}
