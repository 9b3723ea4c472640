//! `strahl convert`: RON to JSON and back.

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use strahl::{Cancel, Error, Syntax, write_file};

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
    let document = args.scene.read()?;
    scene::report(&document, true)?;
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
