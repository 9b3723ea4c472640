//! Measures time and size of PNG files against those that `image` writes by default, on one thread.
//!
//! `cargo bench --bench encode` takes 2, 1,000 and 100,000 spheres,
//! `cargo bench --bench encode -- 2 1000` only these. A second table has the same numbers of
//! spheres in 200 colors, for the palette.

mod common;

use std::fmt::Write;

use common::{Density, EYE, FOV, HEIGHT, PLANES, WIDTH, balls, take_turns};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use strahl::{
    Image, ImageFormat, RenderOptions, Scene, Syntax,
    image_file::{Compression, Palette},
    parallel::{Stage, Timings},
};

/// Number of runs of each measurement.
const RUNS: usize = 7;

fn main() {
    let counts = std::env::args()
        .skip(1)
        .filter_map(|count| count.parse().ok());
    let mut counts: Vec<usize> = counts.collect();
    if counts.is_empty() {
        counts = vec![2, 1000, 100_000];
    }
    let rgb = [
        ("fast", options(Compression::Fast, Palette::Never)),
        ("small", options(Compression::Small, Palette::Never)),
    ];
    let indexed = [
        ("fast", options(Compression::Fast, Palette::Never)),
        ("fast, palette", options(Compression::Fast, Palette::Auto)),
        ("small, palette", options(Compression::Small, Palette::Auto)),
    ];
    table("a color for each sphere", &counts, usize::MAX, &rgb);
    table("200 colors", &counts, 200, &indexed);
}

fn options(compression: Compression, palette: Palette) -> RenderOptions {
    let options = RenderOptions::new().threads(1);
    options.compression(compression).palette(palette)
}

fn table(title: &str, counts: &[usize], colors: usize, ways: &[(&str, RenderOptions)]) {
    println!("\n{title}\n");
    println!("| spheres | | encode | `image` | ratio | KiB | `image` | ratio |");
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for (count, density) in counts
        .iter()
        .flat_map(|count| Density::ALL.map(|of| (*count, of)))
    {
        let scene = scene(count, density, colors);
        let image = scene.render().expect("a picture");
        let default_size = by_image(&image).len();
        for (name, options) in ways {
            let mut times = Vec::new();
            // The wall-clock time of a run is not used: it includes rendering.
            let ours = || times.push(encode(&scene, options).1);
            let (_, default) = take_turns(RUNS, ours, || by_image(&image));
            times.sort_by(f64::total_cmp);
            let time = times[times.len() / 2];
            let size = encode(&scene, options).0;
            println!(
                "| {count} {} | {name} | {:.1} ms | {:.1} ms | {:.2} | {} | {} | {:.2} |",
                density.name(),
                time * 1e3,
                default * 1e3,
                time / default,
                size / 1024,
                default_size / 1024,
                size as f64 / default_size as f64,
            );
        }
    }
}

/// Returns the size of the file, and the time from the hits of the pixels to its bytes.
fn encode(scene: &Scene, options: &RenderOptions) -> (usize, f64) {
    let (timings, mut file) = (Timings::new(), Vec::new());
    let options = options.clone().timings(timings.clone());
    let done = scene.write_with(&mut file, ImageFormat::PNG, &options);
    done.expect("a file");
    let seconds = |stage| timings.of(stage).as_secs_f64();
    (file.len(), seconds(Stage::Encode) + seconds(Stage::Build))
}

fn by_image(image: &Image) -> Vec<u8> {
    let mut file = Vec::new();
    let (width, height) = (image.width(), image.height());
    let done = PngEncoder::new(&mut file).write_image(
        image.pixels(),
        width,
        height,
        ExtendedColorType::Rgb8,
    );
    done.expect("a file");
    file
}

/// Returns a scene of the benches, as if read from a file, with at most this many colors.
fn scene(count: usize, density: Density, colors: usize) -> Scene {
    let mut geometries = String::new();
    for [point, normal, color] in PLANES {
        let plane = format!(r#"{{"point":{point:?},"normal":{normal:?},"color":{color:?}}}"#);
        let _ = write!(geometries, r#"{{"Plane":{plane}}},"#);
    }
    let palette: Vec<_> = balls(count, density)
        .take(colors)
        .map(|ball| ball.color)
        .collect();
    for (index, ball) in balls(count, density).enumerate() {
        let (center, radius, color) = (ball.center, ball.radius, palette[index % palette.len()]);
        let ball = format!(r#"{{"center":{center:?},"radius":{radius:?},"color":{color:?}}}"#);
        let _ = write!(geometries, r#"{{"Sphere":{ball}}},"#);
    }
    let geometries = geometries.trim_end_matches(',');
    let eye = EYE.to_array();
    let text = format!(
        r#"{{"image":{{"width":{WIDTH},"height":{HEIGHT}}},"camera":{{"Perspective":{{"eye":{eye:?},
        "gaze":[0,0,-1],"fov":{FOV}}}}},"geometries":[{geometries}]}}"#
    );
    Scene::from_text(text, Syntax::Json).expect("a scene")
}
