//! `strahl man`: man pages.

use std::{fs, path::PathBuf};

use strahl::Error;

use super::failure::Failure;

/// Write the man pages into a folder
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The folder, created if it is missing
    folder: PathBuf,
}

/// Writes the pages of the commands of a command line.
pub(crate) fn run(args: Args, cli: clap::Command) -> Result<(), Failure> {
    let made =
        fs::create_dir_all(&args.folder).and_then(|()| clap_mangen::generate_to(cli, &args.folder));
    made.map_err(|error| Error::writing_failed(&args.folder, error).into())
}
