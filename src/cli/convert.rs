//! `strahl convert`: RON to JSON and back.

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use strahl::{
    Document, Syntax,
    diagnostic::folder_of,
    image_file::write_file,
    jobs::Config,
    scene::{Look, LostComments},
    text::sanitize,
};

use super::{
    additions::looks,
    failure::Failure,
    interrupt,
    paths::{is_dash, is_same},
    scene::{self, SceneArgs, TableArgs},
};

/// Convert a scene between RON and JSON, by file extension
///
/// Between files of the same syntax, the scene is copied in the canonical format, with all
/// comments. A scene without a camera is converted too, as it may be a part of another.
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    #[command(flatten)]
    scene: SceneArgs,
    /// The file to write; `-` is standard output
    output: PathBuf,
    /// Syntax to write, for a file with another extension
    #[arg(long, value_name = "SYNTAX", value_parser = scene::syntaxes())]
    to: Option<Syntax>,
    /// Replace each camera `Fit` by the camera that it becomes in a picture of the scene's size
    #[arg(long)]
    explicit_camera: bool,
    /// Write the lights of a look in place of those of the scene; see `strahl render --help`
    #[arg(long, value_name = "NAME", value_parser = looks())]
    look: Option<Look>,
    #[command(flatten)]
    tables: TableArgs,
    /// Convert even if comments are lost
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let cancel = interrupt::cancel_on_signal();
    let is_stdout = is_dash(&args.output);
    let (to, ending) = (args.to, Syntax::of_path(&args.output));
    if let (Some(to), Some(ending)) = (to, ending)
        && to != ending
    {
        let message = "the file extension and --to name different syntaxes; leave out --to";
        return Err(Failure::refused(&args.output, message));
    }
    let syntax = to.or(ending);
    let syntax = syntax.ok_or_else(|| {
        Failure::refused(
            &args.output,
            "unknown syntax; give `--to ron` or `--to json`",
        )
    })?;
    // A scene without a camera is a part of another.
    let options = args.tables.options(&Config::default()).as_part(true);
    let document = args.scene.read(match args.explicit_camera {
        true => options,
        false => options.without_tables(),
    })?;
    scene::report(&document, true)?;
    let document = match args.explicit_camera {
        true => {
            let why = "they are in the camera that is replaced";
            unless_lost(document.with_explicit_cameras()?, &args, why)?
        }
        false => document,
    };
    let document = match args.look {
        Some(look) => {
            let why = "they are in the lights that are replaced";
            unless_lost(document.with_look(look)?, &args, why)?
        }
        None => document,
    };
    if !is_stdout && !share_a_folder(&args.scene, &args.output) {
        // Paths stay as they are written: they are relative to the folder of the new scene.
        let tables = document.table_names().chain(document.copy_table_names());
        let tables = tables.map(|name| ("table", name));
        let meshes = document.mesh_names().map(|name| ("mesh", name));
        let parts = document.part_names().map(|name| ("part", name));
        for (kind, name) in tables.chain(meshes).chain(parts) {
            let _ = writeln!(
                io::stderr(),
                "note: the {kind} `{}` is not moved; the new scene looks for it in its own folder",
                sanitize(name)
            );
        }
    }
    let text = text(document, syntax, &args)?;
    if is_stdout {
        super::output::print(&text)
    } else {
        write_file(&args.output, text.as_bytes(), &cancel)?;
        scene::report_written(&args.output, "", false);
        Ok(())
    }
}

/// Returns a changed scene, unless comments are lost.
fn unless_lost(
    (document, lost): (Document, Option<LostComments>),
    args: &Args,
    why: &str,
) -> Result<Document, Failure> {
    match lost.filter(|_| !args.force) {
        Some(lost) => Err(lost_comments(args, lost, why)),
        None => Ok(document),
    }
}

/// Returns the scene in a syntax; in its own syntax it keeps its comments.
fn text(document: Document, syntax: Syntax, args: &Args) -> Result<String, Failure> {
    let own = document.format().filter(|_| syntax == document.syntax());
    if let Some(own) = own {
        return Ok(own);
    }
    let converted = document.convert(syntax)?;
    if let Some(lost) = converted.lost.filter(|_| !args.force) {
        let why = match syntax {
            Syntax::Json => "JSON does not support comments",
            Syntax::Ron => "they are not part of the scene",
        };
        return Err(lost_comments(args, lost, why));
    }
    for dropped in &converted.dropped {
        let _ = writeln!(io::stderr(), "note: dropped {}", sanitize(dropped));
    }
    Ok(converted.text)
}

/// Returns the error for a scene whose comments would be lost.
fn lost_comments(args: &Args, lost: LostComments, why: &str) -> Failure {
    let line = lost.line;
    let comments = match lost.count {
        1 => "1 comment".to_owned(),
        count => format!("{count} comments"),
    };
    let why = format!(
        "{comments}, the first in line {line}, would be lost, because {why}; use --force to convert anyway"
    );
    Failure::refused(&args.scene.scene, why)
}

/// Returns true if two scenes look for their tables in the same folder. For standard input without
/// a name, it is the current one.
fn share_a_folder(scene: &SceneArgs, output: &Path) -> bool {
    is_same(folder_of(scene.place()), folder_of(output))
}
