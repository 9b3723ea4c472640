//! Starts `strahl lsp` in Zed.

use zed_extension_api::{
    settings::LspSettings, Command, Extension, LanguageServerId, Result, Worktree,
};

const PROGRAM: &str = "strahl";

struct Strahl;

impl Extension for Strahl {
    fn new() -> Self {
        Self
    }

    fn language_server_command(
        &mut self,
        _: &LanguageServerId,
        worktree: &Worktree,
    ) -> Result<Command> {
        let settings = LspSettings::for_worktree(PROGRAM, worktree)?;
        let set = settings.binary.and_then(|binary| binary.path);
        let missing = "`strahl` is missing in PATH; install it, or set `lsp.strahl.binary.path`";
        Ok(Command {
            command: set.or_else(|| worktree.which(PROGRAM)).ok_or(missing)?,
            args: vec!["lsp".to_owned()],
            env: worktree.shell_env(),
        })
    }
}

zed_extension_api::register_extension!(Strahl);
