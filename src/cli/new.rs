//! `strahl new`: a scene to start from.

use std::path::PathBuf;

use strahl::{
    Syntax,
    image_file::write_file,
    parallel::Cancel,
    scene::{SCHEMA_URL, new_scene},
};

use super::{Failure, paths::is_dash, scene};

/// Write a small scene to start from
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The file to write, .ron or .json; it must not exist yet. `-` is standard output, in RON
    file: PathBuf,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let file = &args.file;
    if is_dash(file) {
        return super::print(new_scene(Syntax::Ron));
    }
    let syntax = Syntax::of_path(file)
        .ok_or_else(|| Failure::refused(file, "unknown file extension, expected .ron or .json"))?;
    if file.symlink_metadata().is_ok() {
        return Err(Failure::refused(
            file,
            "already exists and is left unchanged",
        ));
    }
    write_file(file, text(syntax).as_bytes(), &Cancel::new())?;
    scene::report_written(file, "", false);
    Ok(())
}

/// Returns the new scene. In JSON it names its schema, so that editors complete and check it.
fn text(syntax: Syntax) -> String {
    let scene = new_scene(syntax);
    match syntax {
        Syntax::Ron => scene.to_owned(),
        Syntax::Json => scene.replacen('{', &format!("{{\n    \"$schema\": \"{SCHEMA_URL}\","), 1),
    }
}
