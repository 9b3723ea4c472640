//! Measures time and memory of reading against `ron` and `serde_json`:
//! `RAYON_NUM_THREADS=1 cargo bench --bench read`.
//!
//! On Linux, times are CPU times of the thread, so that a busy machine does not affect them;
//! without the variable, the work of other threads would be missing.
//!
//! Strahl reads and checks a file; the others fill the simplest types that serde can read, without
//! checks.

mod common;

use std::{fmt::Write as _, fs, hint::black_box, path::Path, process::Command};

use common::{Density, balls, bare, median, take_turns_on_core, time};
use strahl::{Document, Scene, Syntax, parallel::Stage};

/// The argument with which the bench starts itself to read one file in a separate process.
const PEAK: &str = "--peak-of";

fn main() {
    let arguments: Vec<_> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|argument| argument == PEAK) {
        return peak(Path::new(&arguments[at + 1]));
    }
    println!("{:<46} {:>10} {:>10} {:>7}", "", "one", "other", "ratio");
    for (count, runs) in [(100_000, 11), (1_000_000, 5)] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [ron, json] = [Syntax::Ron, Syntax::Json].map(|syntax| {
            let path = folder.path().join("scene").with_extension(syntax.name());
            fs::write(&path, text(syntax, count)).expect("a scene");
            path
        });
        let read = |path: &Path| Document::from_path(path).expect("it is read");
        let compare = |what: &str, one: &dyn Fn(), other: &dyn Fn()| {
            compare(&format!("{count} spheres, {what}"), runs, one, other);
        };
        let drop = |value| std::mem::drop(black_box(value));
        compare("ron : `ron`", &|| drop(read(&ron)), &|| {
            std::mem::drop(bare::read(&ron))
        });
        compare_reading(
            &format!("{count} spheres, ron : `ron`, reading alone"),
            runs,
            &ron,
        );
        compare_reading(
            &format!("{count} spheres, json : `serde_json`, the same"),
            runs,
            &json,
        );
        compare("json : `serde_json`", &|| drop(read(&json)), &|| {
            std::mem::drop(bare::read(&json))
        });
        compare("ron : json", &|| drop(read(&ron)), &|| drop(read(&json)));
        let build = || std::mem::drop(Scene::from_path(&json).expect("a scene"));
        compare("json, read and built : read", &build, &|| drop(read(&json)));
        let itself = std::env::current_exe().expect("this program");
        let child = Command::new(itself).arg(PEAK).arg(&json).status();
        assert!(child.expect("it starts").success());
    }
}

/// Reads a file and prints the peak memory, including any parts of the file in it.
fn peak(path: &Path) {
    let before = peak_memory();
    let document = Document::from_path(path).expect("it is read");
    let read = peak_memory();
    let scene = Scene::try_from(document).expect("a scene");
    let spheres = scene.world().geometries().len() as f64;
    let each = |peak: f64| (peak - before) / spheres;
    println!(
        "{:<46} {:>10.0} {:>10.0}",
        "bytes a sphere at most, read : built",
        each(read),
        each(peak_memory()),
    );
}

/// Returns the peak memory of this process in bytes, or 0 if the system does not report it.
fn peak_memory() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse().ok());
    kib.unwrap_or(0.0) * 1024.0
}

/// Compares reading without the time of the checks, in wall-clock time.
fn compare_reading(what: &str, runs: usize, path: &Path) {
    let ours = || {
        let document = Document::from_path(path).expect("it is read");
        document.timings().of(Stage::Read).as_secs_f64()
    };
    let turns = (0..runs).map(|_| (ours(), time(1, || bare::read(path))));
    let (ours, others): (Vec<f64>, Vec<f64>) = turns.unzip();
    row(what, median(ours), median(others));
}

/// Compares the medians of alternating runs.
fn compare(what: &str, runs: usize, one: &dyn Fn(), other: &dyn Fn()) {
    let (one, other) = take_turns_on_core(runs, one, other);
    row(what, one, other);
}

fn row(what: &str, one: f64, other: f64) {
    let (ratio, one, other) = (one / other, one * 1e3, other * 1e3);
    println!("{what:<46} {one:>7.1} ms {other:>7.1} ms {ratio:>7.2}");
}

/// Returns a scene of this many dense spheres whose numbers have all their digits.
fn text(syntax: Syntax, count: usize) -> String {
    let mut text = String::from(match syntax {
        Syntax::Ron => {
            "(camera: Perspective(eye: (0, 0, 4), gaze: (0, 0, -1), fov: 40), geometries: [\n"
        }
        Syntax::Json => {
            "{\"camera\": {\"Perspective\": {\"eye\": [0, 0, 4], \"gaze\": [0, 0, -1], \
             \"fov\": 40}}, \"geometries\": [\n"
        }
    });
    for (index, ball) in balls(count, Density::Dense).enumerate() {
        let ([x, y, z], radius, [r, g, b]) = (ball.center, ball.radius, ball.color);
        let comma = if index + 1 < count { "," } else { "" };
        let written = match syntax {
            Syntax::Ron => writeln!(
                text,
                "Sphere(center: ({x}, {y}, {z}), radius: {radius}, color: ({r}, {g}, {b})){comma}"
            ),
            Syntax::Json => writeln!(
                text,
                "{{\"Sphere\": {{\"center\": [{x}, {y}, {z}], \"radius\": {radius}, \
                 \"color\": [{r}, {g}, {b}]}}}}{comma}"
            ),
        };
        written.expect("a string grows");
    }
    text.push_str(match syntax {
        Syntax::Ron => "])\n",
        Syntax::Json => "]}\n",
    });
    text
}
