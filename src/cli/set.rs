//! `--set`: values of a scene given on the command line.

use strahl::{Document, ReadOptions, diagnostic::Code, report::FileReport, scene::Setting};

/// The values that replace those of a scene.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct SetArgs {
    /// Set a value of the scene, such as camera.fov=60 or 'geometries[3].color="#0f0"', written as
    /// in the scene; null removes a field. Repeatable
    #[arg(long = "set", value_name = "PATH=VALUE")]
    settings: Vec<Setting>,
}

impl SetArgs {
    /// Adds these values to the options for reading a scene.
    pub(super) fn of(&self, options: ReadOptions) -> ReadOptions {
        let settings = self.settings.iter().cloned();
        settings.fold(options, ReadOptions::set)
    }
}

/// Passes on a report for each value that cannot be set as given.
pub(super) fn faults<E>(
    document: &Document,
    mut each: impl FnMut(&FileReport<'_>) -> Result<(), E>,
) -> Result<(), E> {
    let mut settings = document.setting_diagnostics();
    settings.try_for_each(|(setting, diagnostics)| {
        each(&FileReport {
            file: document.name(),
            option: Some(&format!("--set {}", setting.path())),
            text: setting.text(),
            diagnostics,
            ..FileReport::default()
        })
    })
}

/// Returns true if a path leads nowhere, which is a fault of the command, not of the scene.
pub(super) fn leads_nowhere(document: &Document) -> bool {
    let mut faults = document
        .setting_diagnostics()
        .flat_map(|(_, faults)| faults);
    faults.any(|fault| fault.code == Code::UnknownPath)
}
