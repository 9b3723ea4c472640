//! `strahl convert`: RON to JSON and back.

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use strahl::{Cancel, Error, ReadOptions, Syntax, write_file};

use super::{
    Failure, interrupt,
    scene::{self, InputFormat, SceneArgs},
};

/// Write a scene in the other syntax; the endings tell which
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    #[command(flatten)]
    scene: SceneArgs,
    /// The file to write; `-` is standard output
    output: PathBuf,
    /// The syntax to write, where the ending of the file does not tell it
    #[arg(long, value_name = "SYNTAX")]
    to: Option<InputFormat>,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let cancel = Cancel::new();
    interrupt::exit_on_signal(cancel.clone());
    let is_stdout = args.output == Path::new("-");
    let syntax = args
        .to
        .map(Syntax::from)
        .or_else(|| Syntax::of_path(&args.output));
    let syntax = syntax.ok_or_else(|| {
        let place = args.output.display();
        Failure::Usage(format!(
            "{place}: the syntax is not known, give `--to ron` or `--to json`"
        ))
    })?;
    let document = args.scene.read(ReadOptions::new().without_tables())?;
    scene::report(&document, true)?;
    if !is_stdout && !share_a_folder(&args.scene, &args.output) {
        // Paths stay as they are written: they start in the folder of the new scene.
        for table in document.table_names() {
            let _ = writeln!(
                io::stderr(),
                "note: the table `{table}` is not moved; the new scene looks for it in its own folder"
            );
        }
    }
    let converted = document.convert(syntax)?;
    for dropped in &converted.dropped {
        let _ = writeln!(io::stderr(), "note: dropped {dropped}");
    }
    if is_stdout {
        super::print(&converted.text)
    } else {
        let written: Result<(), Error> =
            write_file(&args.output, converted.text.as_bytes(), &cancel);
        Ok(written?)
    }
}

/// Whether two scenes look for their tables in one folder, which for standard input is the current
/// one.
fn share_a_folder(scene: &SceneArgs, output: &Path) -> bool {
    let folder = |path: &Path| {
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        folder.unwrap_or(Path::new(".")).canonicalize()
    };
    let input = if scene.is_stdin() {
        Path::new("")
    } else {
        &scene.scene
    };
    matches!((folder(input), folder(output)), (Ok(one), Ok(other)) if one == other)
}
