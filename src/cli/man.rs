//! `strahl man`: man pages.

use std::{fs, path::PathBuf};

use clap::CommandFactory;
use strahl::Error;

use super::{Cli, failure::Failure};

/// Write the man pages into a folder
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The folder, created if it is missing
    folder: PathBuf,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let made = fs::create_dir_all(&args.folder)
        .and_then(|()| clap_mangen::generate_to(Cli::command(), &args.folder));
    made.map_err(|error| Error::writing_failed(&args.folder, error).into())
}
