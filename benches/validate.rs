//! Measures checking against mere deserialization: `cargo bench --bench validate`.
//!
//! Each figure is a ratio of medians of alternating runs, so that a slowdown of the machine affects
//! both. The types below are the simplest that serde can read the format into.

use std::{
    fs,
    hint::black_box,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

mod common;
use common::bare;
use strahl::{
    Document, ReadOptions, Syntax,
    jobs::{check_files, find_scenes},
};

const RUNS: usize = 11;

fn main() {
    println!("{:<44} {:>10} {:>10} {:>7}", "", "checked", "bare", "ratio");
    for syntax in Syntax::ALL {
        large(*syntax);
    }
    many();
}

/// Measures a file of 100,000 spheres, without faults and with 1,000.
fn large(syntax: Syntax) {
    const SPHERES: usize = 100_000;
    let clean = scene(syntax, SPHERES, 0);
    let faulty = scene(syntax, SPHERES, 1000);
    let name = syntax.name();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |file: &str, text: &str| {
        let path = folder.path().join(file).with_extension(syntax.name());
        fs::write(&path, text).expect("a scene");
        path
    };
    let (clean, faulty) = (write("clean", &clean), write("faulty", &faulty));
    let check = |path: &Path| {
        let document = Document::from_path(path).expect("it is read");
        document.diagnostics().len()
    };
    assert_eq!(check(&clean), 0);
    assert_eq!(check(&faulty), 1000);
    compare(
        &format!("{name}, {SPHERES} spheres, no fault"),
        || check(&clean),
        || deserialise(&read(&clean), syntax),
    );
    compare(
        &format!("{name}, 1000 faults : no fault (both checked)"),
        || check(&faulty),
        || check(&clean),
    );
}

/// Measures 20,000 files of 20 spheres each.
fn many() {
    const FILES: usize = 20_000;
    let folder = tempfile::tempdir().expect("a temporary folder");
    for index in 0..FILES {
        let text = scene(Syntax::Json, 20, 0);
        let path = folder.path().join(format!("{index:05}.json"));
        fs::write(path, text).expect("a scene");
    }
    let paths = [folder.path().to_owned()];
    let check = |threads| {
        let files = find_scenes(&paths, &[], &strahl::jobs::Configs::none()).expect("scenes");
        let mut count = 0;
        let each = |_| {
            count += 1;
            Ok::<(), strahl::Error>(())
        };
        check_files(&files, &ReadOptions::new(), threads, each).expect("all are read");
        assert_eq!(count, FILES);
        count
    };
    let bare = || {
        let entries = fs::read_dir(folder.path()).expect("the folder");
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a file").path()).collect();
        paths.sort();
        paths
            .iter()
            .map(|path| deserialise(&read(path), Syntax::Json))
            .sum::<usize>()
    };
    compare(
        &format!("json, {FILES} files, one thread"),
        || check(1),
        bare,
    );
    compare(
        "the same, one thread : two threads",
        || check(1),
        || check(2),
    );
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).expect("a scene")
}

fn deserialise(text: &str, syntax: Syntax) -> usize {
    let scene: bare::Scene = match syntax {
        Syntax::Ron => ron::from_str(text).expect("a scene"),
        Syntax::Json => serde_json::from_str(text).expect("a scene"),
    };
    black_box(&scene.camera);
    scene.geometries.len()
}

fn compare<A, B>(what: &str, mut one: impl FnMut() -> A, mut other: impl FnMut() -> B) {
    let (mut ones, mut others) = (Vec::new(), Vec::new());
    for _ in 0..RUNS {
        ones.push(time(&mut one));
        others.push(time(&mut other));
    }
    let (one, other) = (median(ones), median(others));
    let ratio = one.as_secs_f64() / other.as_secs_f64();
    println!("{what:<44} {one:>10.1?} {other:>10.1?} {ratio:>7.2}");
}

fn time<T>(work: &mut impl FnMut() -> T) -> Duration {
    let start = Instant::now();
    black_box(work());
    start.elapsed()
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times[times.len() / 2]
}

/// Returns a scene of spheres whose numbers have all their digits; `faults` of them
/// have a negative radius.
fn scene(syntax: Syntax, spheres: usize, faults: usize) -> String {
    let mut random = 88_172_645_463_325_252_u64;
    let mut number = || {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random >> 11) as f64 / (1_u64 << 53) as f64
    };
    let sphere = |index: usize| {
        let [x, y, z, radius, r, g, b] = [(); 7].map(|()| number());
        let radius = match faults {
            0 => radius,
            _ if index.is_multiple_of(spheres / faults) => -radius,
            _ => radius,
        };
        let (x, y, z) = (x * 100.0, y * 100.0, -z * 100.0 - 2.0);
        match syntax {
            Syntax::Ron => format!(
                "Sphere(center: ({x}, {y}, {z}), radius: {radius}, color: ({r}, {g}, {b})),\n"
            ),
            Syntax::Json => format!(
                "{{\"Sphere\": {{\"center\": [{x}, {y}, {z}], \"radius\": {radius}, \
                 \"color\": [{r}, {g}, {b}]}}}},\n"
            ),
        }
    };
    let geometries: String = (0..spheres).map(sphere).collect();
    match syntax {
        Syntax::Ron => format!(
            "(camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90), \
             geometries: [\n{geometries}])"
        ),
        Syntax::Json => format!(
            "{{\"camera\": {{\"Perspective\": {{\"eye\": [0, 0, 0], \"gaze\": [0, 0, -1], \
             \"fov\": 90}}}}, \"geometries\": [\n{}\n]}}",
            geometries.trim_end().trim_end_matches(',')
        ),
    }
}
