//! `strahl completions`: the completion script for a shell.

use clap::CommandFactory;
use clap_complete::Shell;

use super::{Cli, failure::Failure};

/// Print completions for a shell
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The shell
    shell: Shell,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "strahl", &mut script);
    super::output::print(&String::from_utf8_lossy(&script))
}
