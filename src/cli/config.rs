//! The option to ignore `strahl.toml`.

use strahl::jobs::Configs;

/// The use of `strahl.toml`.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct ConfigArgs {
    /// Do not read `strahl.toml` from the folder of the scene or its parents
    #[arg(long)]
    no_config: bool,
}

impl ConfigArgs {
    /// Returns the configurations to use.
    pub(super) fn configs(&self) -> Configs {
        if self.no_config {
            Configs::none()
        } else {
            Configs::new()
        }
    }
}
