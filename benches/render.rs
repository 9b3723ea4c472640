//! Measures all stages from a scene file to a picture against straightforward code, on one thread:
//! `cargo bench --bench render`.
//!
//! Arguments select the measurements; without an argument of a kind, all of that kind run:
//! `cargo bench --bench render -- 1000 100000 sparse perspective trace encode`. The 10,000,000
//! spheres run only if named. Strahl's times are those of `--timings=json`, medians of runs that
//! alternate with the other program; those of one and two threads are measured within one process.

mod common;
#[path = "peers/formats.rs"]
mod formats;

use std::{
    env, fs,
    path::Path,
    process::Command,
    time::{Duration, Instant},
};

use common::{COUNTS, Density, HEIGHT, WIDTH, bare, median, seconds, time, world};
use formats::{Bench, View};
use image::{ExtendedColorType, ImageEncoder, RgbImage, codecs::png::PngEncoder};
use rayon::ThreadPoolBuilder;
use serde::Deserialize;
use strahl::{RayTracer, World};

/// The measured parts: reading both syntaxes, projecting, tracing, tracing on two threads,
/// encoding, all stages from JSON, all stages with 16 samples per pixel, and outlines.
const PARTS: [&str; 9] = [
    "json", "ron", "project", "trace", "threads", "encode", "whole", "samples", "outlines",
];
/// Number of runs of each measurement.
const RUNS: usize = 5;
/// Number of runs of tracing alone.
const THREADS_RUNS: usize = 21;
/// Duration of the warm-up, until each thread has its own core.
const WARM_UP: Duration = Duration::from_millis(200);
/// The largest number of spheres that runs without being named.
const UNNAMED: usize = 1_000_000;
/// Number of intersections that the plain loop tests for its sample of pixels.
const PLAIN_TESTS: usize = 200_000_000;
/// A picture so small that tracing consists of projection and binning.
const TINY: &str = "16x9";

fn main() {
    let words: Vec<String> = env::args().skip(1).collect();
    let wanted = |all: &[&str], name: &str| {
        let named = words.iter().any(|word| word == name);
        named || !words.iter().any(|word| all.contains(&word.as_str()))
    };
    let counts = COUNTS.map(|count| count.to_string());
    let counts = counts.each_ref().map(String::as_str);
    let densities = Density::ALL.map(Density::name);
    let views = View::FLAT.map(View::name);
    let folder = tempfile::tempdir().expect("a temporary folder");
    println!("| spheres | | | | ours | the other | ratio |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (count, name) in COUNTS.into_iter().zip(counts) {
        if !wanted(&counts, name) || count > UNNAMED && !words.iter().any(|word| word == name) {
            continue;
        }
        for density in Density::ALL {
            for view in View::FLAT {
                if wanted(&densities, density.name()) && wanted(&views, view.name()) {
                    let bench = Bench {
                        count,
                        density,
                        view,
                    };
                    run(bench, folder.path(), |part| wanted(&PARTS, part));
                }
            }
        }
    }
}

/// Measures the selected parts of a scene.
fn run(bench: Bench, folder: &Path, wanted: impl Fn(&str) -> bool) {
    let [json, ron] = ["json", "ron"].map(|ending| {
        let needed = ending == "json" || wanted("ron");
        needed.then(|| bench.write(folder, ending).expect("a scene"))
    });
    let json = json.expect("always written");
    let picture = folder.join("picture.png");
    let render = |scene: &Path, options: &[&str]| ours(scene, &picture, options);
    let row = |part: &str, other: &str, ours: f64, others: f64| {
        let Bench {
            count,
            density,
            view,
        } = bench;
        println!(
            "| {count} | {} | {} | {part} : {other} | {:.2} ms | {:.2} ms | {:.2} |",
            density.name(),
            view.name(),
            ours * 1e3,
            others * 1e3,
            others / ours,
        );
    };

    // Each run of the program reports all its times; the other program runs in between.
    let (mut runs, mut serde_json, mut image_png) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..RUNS {
        runs.push(render(&json, &[]));
        if wanted("json") || wanted("whole") {
            serde_json.push(time(1, || bare::read(&json)));
        }
        if wanted("encode") || wanted("whole") {
            let picture = image::open(&picture).expect("a picture").into_rgb8();
            image_png.push(time(1, || default_png(&picture)));
        }
    }
    let of = |stage: fn(&Times) -> f64| median(runs.iter().map(stage).collect());
    let plain = (wanted("trace") || wanted("project") || wanted("whole")).then(|| plain(bench));

    if wanted("json") {
        row(
            "read json",
            "`serde_json`",
            of(|it| it.read_s),
            median(serde_json.clone()),
        );
    }
    if let Some(ron) = ron {
        let (mut ours, mut others) = (Vec::new(), Vec::new());
        for _ in 0..RUNS {
            ours.push(render(&ron, &["--size", TINY]).read_s);
            others.push(time(1, || bare::read(&ron)));
        }
        row("read ron", "`ron`", median(ours), median(others));
        fs::remove_file(ron).expect("removed");
    }
    if let Some(plain) = plain {
        if wanted("project") {
            let tiny = (0..RUNS).map(|_| render(&json, &["--size", TINY]).trace_s);
            row("project", "plain loop", median(tiny.collect()), plain);
        }
        if wanted("trace") {
            row(
                "project and trace",
                "plain loop",
                of(|it| it.trace_s),
                plain,
            );
        }
        if wanted("whole") {
            let others = median(serde_json) + plain + median(image_png.clone());
            row("whole", "all of these", of(|it| it.total_s), others);
        }
    }
    if wanted("samples") {
        let runs: Vec<_> = (0..RUNS)
            .map(|_| [render(&json, &[]), render(&json, &["--samples", "16"])])
            .collect();
        let of = |which: usize, stage: fn(&Times) -> f64| {
            median(runs.iter().map(|run| stage(&run[which])).collect())
        };
        let other = "one sample";
        row(
            "trace 16 samples",
            other,
            of(1, |it| it.trace_s),
            of(0, |it| it.trace_s),
        );
        row(
            "whole with 16 samples",
            other,
            of(1, |it| it.total_s),
            of(0, |it| it.total_s),
        );
    }
    if wanted("outlines") {
        for (kind, light) in [("flat", &[][..]), ("lit", &["--lights", "headlight"])] {
            for samples in ["1", "4", "16", "64"] {
                let plain = [&["--samples", samples], light].concat();
                let outlined = [&plain[..], &["--outlines"]].concat();
                let [plain, outlined] = [plain, outlined].map(|options| {
                    let runs = (0..RUNS).map(|_| render(&json, &options).total_s);
                    median(runs.collect())
                });
                let name = format!("outlines, {kind}, {samples} samples");
                row(&name, "no outlines", outlined, plain);
            }
        }
    }
    if wanted("threads") {
        let [one, two, apart] = threads(bench);
        row("trace on two threads", "one thread", two, one);
        row(
            "two traces on two threads",
            "one after the other",
            apart,
            2.0 * one,
        );
    }
    if wanted("encode") {
        row("encode", "`image`", of(|it| it.encode_s), median(image_png));
    }
    fs::remove_file(json).expect("removed");
}

/// The output of `--timings=json`.
#[derive(Deserialize)]
struct Times {
    read_s: f64,
    trace_s: f64,
    encode_s: f64,
    total_s: f64,
}

/// Runs the program on one thread.
fn ours(scene: &Path, picture: &Path, options: &[&str]) -> Times {
    let mut command = Command::new(env!("CARGO_BIN_EXE_strahl"));
    command.args(["render", "-q", "--threads", "1", "--timings=json", "-o"]);
    let output = command.arg(picture).arg(scene).args(options).output();
    let output = output.expect("it starts");
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    serde_json::from_str(&text).expect("times")
}

/// Returns the seconds of tracing on one thread, on two, and on one while another thread traces the
/// same picture independently: the limit for two threads that share nothing.
fn threads(bench: Bench) -> [f64; 3] {
    let (camera, world) = (bench.camera(), world(bench.count, bench.density));
    let tracer = RayTracer::new(&camera, &world, WIDTH, HEIGHT).expect("a size");
    let tracing = |threads| tracer.tracing(threads).expect("threads");
    let (one, two, other) = (tracing(1), tracing(2), tracing(1));
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let mut times = [const { Vec::new() }; 3];
    let begin = Instant::now();
    while times[0].len() < THREADS_RUNS {
        let turn = [
            seconds(&mut || one().expect("traced")),
            seconds(&mut || two().expect("traced")),
            seconds(&mut || {
                pool.in_place_scope(|scope| {
                    scope.spawn(|_| other().expect("traced"));
                    one().expect("traced");
                });
            }),
        ];
        if begin.elapsed() > WARM_UP {
            times
                .iter_mut()
                .zip(turn)
                .for_each(|(times, time)| times.push(time));
        }
    }
    times.map(median)
}

/// Returns the seconds of [`World::hit`] for the whole picture, estimated from evenly spread
/// pixels.
fn plain(bench: Bench) -> f64 {
    let (camera, world) = (bench.camera(), world(bench.count, bench.density));
    let pixels = u64::from(WIDTH) * u64::from(HEIGHT);
    let sample = (PLAIN_TESTS / world.geometries().len()).clamp(16, pixels as usize) as u64;
    let hits = |world: &World| {
        let pixel = |index: u64| index * pixels / sample;
        let ray = |pixel: u64| {
            let (x, y) = (pixel % u64::from(WIDTH), pixel / u64::from(WIDTH));
            camera.ray_for(WIDTH, HEIGHT, x as f64, y as f64)
        };
        let hits = (0..sample).filter_map(|index| world.hit(&ray(pixel(index))));
        hits.fold(0, |sum, (index, _)| sum ^ index)
    };
    time(1, || hits(&world)) * (pixels as f64 / sample as f64)
}

fn default_png(picture: &RgbImage) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = PngEncoder::new(&mut file);
    let (width, height) = picture.dimensions();
    let written = encoder.write_image(picture, width, height, ExtendedColorType::Rgb8);
    written.expect("a file");
    file
}
