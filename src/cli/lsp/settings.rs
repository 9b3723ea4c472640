//! `strahl.toml` and the options of the command.

use std::{
    collections::HashSet,
    path::{Path, PathBuf},
    sync::Arc,
};

use strahl::{
    ReadOptions,
    jobs::{Config, Configs},
};

use super::{
    super::{config::ConfigArgs, scene::TableArgs},
    open_files::OpenFiles,
    outbox::Outbox,
};

/// The name of the file.
pub(super) const NAME: &str = "strahl.toml";
/// The most diagnostics of a text, unless `strahl.toml` says otherwise.
const MOST: usize = 1000;
/// The type of a message to the user that is a warning.
const WARNING: u8 = 2;

pub(super) struct Settings {
    tables: TableArgs,
    config: ConfigArgs,
    configs: Configs,
    pub(super) open_files: OpenFiles,
    /// The faults that were shown already.
    shown: HashSet<String>,
}

/// The settings of a scene.
#[derive(Clone)]
pub(super) struct OfScene {
    pub(super) options: ReadOptions,
    pub(super) open_files: OpenFiles,
    /// The most diagnostics that are sent.
    pub(super) most: usize,
}

impl Settings {
    pub(super) fn new(tables: TableArgs, config: ConfigArgs) -> Self {
        Self {
            configs: config.configs(),
            tables,
            config,
            open_files: OpenFiles::default(),
            shown: HashSet::new(),
        }
    }

    /// Forgets all `strahl.toml`, so that they are read again.
    pub(super) fn read_again(&mut self) {
        self.configs = self.config.configs();
        self.shown.clear();
    }

    pub(super) const fn configs(&self) -> &Configs {
        &self.configs
    }

    /// Returns the settings for a scene in a folder.
    pub(super) fn in_folder(&mut self, folder: &Path, outbox: &Outbox) -> OfScene {
        let config = self.configs.of(folder).unwrap_or_else(|error| {
            let message = error.to_string();
            if self.shown.insert(message.clone()) {
                let params = serde_json::json!({"type": WARNING, "message": message});
                outbox.notify("window/showMessage", params);
            }
            Arc::default()
        });
        self.of(&config).in_folder(folder)
    }

    /// Returns the settings for scenes with a configuration.
    pub(super) fn of(&self, config: &Config) -> OfScene {
        of(&self.tables, &self.open_files, config)
    }

    /// Returns [`Settings::of`] for another thread.
    pub(super) fn checker(&self) -> SettingsOf {
        let (tables, open_files) = (self.tables.clone(), self.open_files.clone());
        Box::new(move |config| of(&tables, &open_files, config))
    }

    /// Returns the places where the `strahl.toml` of a folder may be.
    pub(super) fn files_of(folder: &Path) -> impl Iterator<Item = PathBuf> {
        folder.ancestors().map(|folder| folder.join(NAME))
    }
}

fn of(tables: &TableArgs, open_files: &OpenFiles, config: &Config) -> OfScene {
    OfScene {
        options: tables.options(config).files(open_files.clone()),
        open_files: open_files.clone(),
        most: config.max_diagnostics().unwrap_or(MOST),
    }
}

/// The settings of the scenes with a configuration.
pub(super) type SettingsOf = Box<dyn Fn(&Config) -> OfScene + Send>;

impl OfScene {
    fn in_folder(self, folder: &Path) -> Self {
        Self {
            options: self.options.folder(folder),
            ..self
        }
    }
}
