//! `strahl schema`: the JSON Schema of the format.

use std::path::PathBuf;

use strahl::{image_file::write_file, parallel::Cancel, scene::schema};

use super::{failure::Failure, paths::is_dash};

/// Print the JSON Schema of the scene format, for editors
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// Write the schema to a file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    match args.output {
        Some(path) if !is_dash(&path) => Ok(write_file(path, schema().as_bytes(), &Cancel::new())?),
        _ => super::output::print(&schema()),
    }
}
