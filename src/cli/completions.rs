//! `strahl completions`: the completion script for a shell.

use clap_complete::Shell;

use super::failure::Failure;

/// Print completions for a shell
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The shell
    shell: Shell,
}

/// Prints the script for the commands of a command line.
pub(crate) fn run(args: Args, mut cli: clap::Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut cli, "strahl", &mut script);
    super::output::print(&String::from_utf8_lossy(&script))
}
