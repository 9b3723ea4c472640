//! `--set`: values of a scene that the command line gives.

use strahl::{Diagnostic, Document, ReadOptions, diagnostic::Code, scene::Setting};

/// Values that are set instead of those of a scene.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct SetArgs {
    /// Set a value of the scene, such as camera.fov=60 or 'geometries[3].color="#0f0"', written as
    /// in the scene; null removes a field. Repeatable
    #[arg(long = "set", value_name = "PATH=VALUE")]
    settings: Vec<Setting>,
}

impl SetArgs {
    /// Reads a scene with these values in it.
    pub(super) fn of(&self, options: ReadOptions) -> ReadOptions {
        let settings = self.settings.iter().cloned();
        settings.fold(options, ReadOptions::set)
    }
}

/// What is wrong with values that were set: the option, its text and its faults.
pub(super) fn faults(document: &Document) -> impl Iterator<Item = (String, &str, &[Diagnostic])> {
    document.setting_diagnostics().map(|(setting, faults)| {
        let option = format!("--set {}", setting.path());
        (option, setting.text(), faults)
    })
}

/// Whether a path leads nowhere, which is a fault of the command and not of the scene.
pub(super) fn leads_nowhere(document: &Document) -> bool {
    let mut faults = document
        .setting_diagnostics()
        .flat_map(|(_, faults)| faults);
    faults.any(|fault| fault.code == Code::UnknownPath)
}
