//! Writes the scenes of the benches for other programs:
//! `cargo bench --bench peers_scenes -- FOLDER COUNT DENSITY CAMERA FORMAT…`, with the formats of
//! `formats.rs`. `trace` instead of a format traces the scene on one thread a few times in this
//! process, and prints the median in seconds; `trace-without-shadows` does so without shadows. See `README.md` next to this file.

#[path = "../common/mod.rs"]
mod common;
mod formats;

use std::{env, io, path::Path, process::ExitCode};

use common::{Density, HEIGHT, WIDTH, lighting, time, world};
use formats::{Bench, FORMATS, View};
use strahl::RayTracer;

/// Number of times that a scene is traced.
const RUNS: usize = 3;

fn main() -> ExitCode {
    // cargo adds --bench.
    let arguments: Vec<String> = env::args().skip(1).filter(|it| it != "--bench").collect();
    match write_all(&arguments) {
        Some(Ok(())) => ExitCode::SUCCESS,
        Some(Err(error)) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
        None => {
            let formats = FORMATS.map(|(ending, _)| ending).join("|");
            let views = View::ALL.map(View::name).join("|");
            let scene = format!("FOLDER COUNT dense|sparse {views}");
            eprintln!("peers_scenes {scene} trace|{formats}…");
            // A plain `cargo bench` gets here as well.
            ExitCode::SUCCESS
        }
    }
}

/// Writes the files that the arguments ask for; `None` if the arguments are invalid.
fn write_all(arguments: &[String]) -> Option<io::Result<()>> {
    let [folder, count, density, view, formats @ ..] = arguments else {
        return None;
    };
    let bench = Bench {
        count: count.parse().ok()?,
        density: Density::ALL.into_iter().find(|it| it.name() == density)?,
        view: View::ALL.into_iter().find(|it| it.name() == view)?,
    };
    if let [only] = formats
        && let "trace" | "trace-without-shadows" = &**only
    {
        println!("{}", trace(bench, only == "trace"));
        return Some(Ok(()));
    }
    let mut formats = formats.iter();
    let known = |ending: &String| FORMATS.iter().any(|(of, _)| of == ending);
    formats
        .clone()
        .all(known)
        .then(|| formats.try_for_each(|ending| bench.write(Path::new(folder), ending).map(|_| ())))
}

/// Returns the seconds that tracing takes with warm memory.
fn trace(bench: Bench, shadows: bool) -> f64 {
    let (camera, mut world) = (bench.camera(), world(bench.count, bench.density));
    if bench.view == View::Lit {
        world = world.lit(lighting(shadows));
    }
    let tracer = RayTracer::new(&camera, &world, WIDTH, HEIGHT).expect("a size");
    let trace = tracer.tracing(1).expect("one thread");
    trace().expect("traced");
    time(RUNS, || trace().expect("traced"))
}
