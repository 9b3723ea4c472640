//! `strahl new`: a scene to start from.

use std::path::PathBuf;

use strahl::{
    Syntax,
    image_file::write_file,
    parallel::Cancel,
    scene::{SCHEMA_URL, new_lit_scene, new_path_scene, new_scene},
};

use super::{failure::Failure, paths::is_dash, scene::report_written};

/// Write a small scene to start from
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The file to write, .ron or .json; it must not exist yet. `-` is standard output, in RON
    file: PathBuf,
    /// Write a scene with lights, gold, glass and a mirror
    #[arg(long)]
    lit: bool,
    /// Write a scene whose light follows paths, with a sky, a lamp, gold and frosted glass
    #[arg(long, conflicts_with = "lit")]
    path: bool,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let file = &args.file;
    let scene = match (args.lit, args.path) {
        (true, _) => new_lit_scene,
        (false, true) => new_path_scene,
        (false, false) => new_scene,
    };
    if is_dash(file) {
        return super::output::print(scene(Syntax::Ron));
    }
    let syntax = Syntax::of_path(file)
        .ok_or_else(|| Failure::refused(file, "unknown file extension, expected .ron or .json"))?;
    if file.symlink_metadata().is_ok() {
        return Err(Failure::refused(
            file,
            "already exists and is left unchanged",
        ));
    }
    write_file(file, text(scene(syntax), syntax).as_bytes(), &Cancel::new())?;
    report_written(file, "", false);
    Ok(())
}

/// Returns the new scene. In JSON it names its schema, so that editors complete and check it.
fn text(scene: &str, syntax: Syntax) -> String {
    match syntax {
        Syntax::Ron => scene.to_owned(),
        Syntax::Json => scene.replacen('{', &format!("{{\n    \"$schema\": \"{SCHEMA_URL}\","), 1),
    }
}
