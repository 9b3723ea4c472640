//! Writes the scenes of the benches for other programs:
//! `cargo bench --bench peers_scenes -- FOLDER COUNT DENSITY CAMERA FORMAT…`, with the formats of
//! `formats.rs`. See `README.md` beside this file.

#[path = "../common/mod.rs"]
mod common;
mod formats;

use std::{env, io, path::Path, process::ExitCode};

use common::Density;
use formats::{Bench, FORMATS, View};

fn main() -> ExitCode {
    // cargo itself adds --bench.
    let arguments: Vec<String> = env::args().skip(1).filter(|it| it != "--bench").collect();
    match write_all(&arguments) {
        Some(Ok(())) => ExitCode::SUCCESS,
        Some(Err(error)) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
        None => {
            let formats = FORMATS.map(|(ending, _)| ending).join("|");
            eprintln!("peers_scenes FOLDER COUNT dense|sparse perspective|orthographic {formats}…");
            // A plain `cargo bench` comes here as well.
            ExitCode::SUCCESS
        }
    }
}

/// Writes what the arguments say; `None` if they say nothing that can be understood.
fn write_all(arguments: &[String]) -> Option<io::Result<()>> {
    let [folder, count, density, view, formats @ ..] = arguments else {
        return None;
    };
    let bench = Bench {
        count: count.parse().ok()?,
        density: Density::ALL.into_iter().find(|it| it.name() == density)?,
        view: View::ALL.into_iter().find(|it| it.name() == view)?,
    };
    let mut formats = formats.iter();
    let known = |ending: &String| FORMATS.iter().any(|(of, _)| of == ending);
    formats
        .clone()
        .all(known)
        .then(|| formats.try_for_each(|ending| bench.write(Path::new(folder), ending).map(|_| ())))
}
