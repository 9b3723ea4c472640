//! Measures the time from a save of a scene to its picture on the page of `strahl preview`, in
//! Chromium: `cargo bench --bench preview`.
//!
//! Each figure is the median of 20 saves, each in its own file, as another editor writes it. The page
//! notes the time at which it shows the picture. The second line is the time that the program alone
//! takes for the same picture, `strahl render`, beside it.

#[allow(dead_code, reason = "the bench uses a part")]
#[path = "../tests/preview/browser.rs"]
mod browser;
#[allow(dead_code, reason = "the bench uses a part")]
#[path = "../tests/preview/driver.rs"]
mod driver;
#[allow(dead_code, reason = "the bench uses a part")]
#[path = "../tests/preview/http.rs"]
mod http;
#[allow(dead_code, reason = "the bench uses a part")]
#[path = "../tests/preview/preview.rs"]
mod preview;

use std::{
    process::Command,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use browser::Browser;
use preview::{Page, Preview};

/// Number of saves.
const RUNS: usize = 20;
/// The longest median, in milliseconds, that a small scene may take.
const LIMIT: f64 = 100.0;

/// Notes the time of each picture.
const WATCH: &str = "new MutationObserver(() => {
    const { state, revision } = document.body.dataset;
    if (state === 'drawn') document.body.dataset.shown = `${revision} ${Date.now()}`;
}).observe(document.body, { attributes: true, attributeFilter: ['data-state', 'data-revision'] });";

fn main() {
    if driver::programs().is_none() {
        println!("chromium or chromedriver is missing");
        return;
    }
    println!("| scene, 640x480 | median | fastest | slowest | `strahl render` |");
    println!("| --- | --- | --- | --- | --- |");
    Browser::with(|browser| {
        measure(browser, "small, flat", &small(""), Some(LIMIT));
        let lights = "lights: [Ambient(), Point(position: (3, 5, 2), intensity: 30)],";
        measure(browser, "small, lit", &small(lights), Some(LIMIT));
        measure(browser, "10,000 spheres", &many(10_000), None);
    });
    driver::stop();
}

fn small(lights: &str) -> String {
    format!(
        "(
    image: (width: 640, height: 480),
    camera: Perspective(eye: (0, 0.8, 2), look_at: (0, 0.6, -4), fov: 40),
    background: \"#ffb703\",
    {lights}
    geometries: [
        Plane(point: (0, 0, 0), normal: (0, 1, 0), color: \"#023047\"),
        Sphere(center: (0, 0, -4), radius: 1.5, color: \"#fb8500\"),
    ],
)
"
    )
}

fn many(count: usize) -> String {
    let sphere = |index: usize| {
        let (x, y) = ((index % 100) as f64, (index / 100) as f64);
        format!("        Sphere(center: ({x}, {y}, 0), radius: 0.4, color: \"#fb8500\"),\n")
    };
    format!(
        "(
    image: (width: 640, height: 480),
    camera: Perspective(eye: (50, 50, 120), look_at: (50, 50, 0), fov: 40),
    background: \"#ffb703\",
    geometries: [
{}    ],
)
",
        (0..count).map(sphere).collect::<String>()
    )
}

fn measure(browser: &Browser, name: &str, text: &str, limit: Option<f64>) {
    let page = Page::open(browser, Preview::of("scene.ron", text));
    page.call(WATCH, &[]);
    let mut times: Vec<f64> = (0..RUNS)
        .map(|run| {
            let color = format!("\"#ff{:02x}03\"", 100 + run);
            let text = text.replacen("\"#ffb703\"", &color, 1);
            let before = page.revision();
            let start = since_1970();
            page.preview.write(&text);
            let shown = "(document.body.dataset.shown ?? '').split(' ')";
            page.wait(&format!("Number({shown}[0]) > {before}"));
            page.number(&format!("Number({shown}[1])")) - start.as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    let median = (times[RUNS / 2 - 1] + times[RUNS / 2]) / 2.0;
    println!(
        "| {name} | {median:.0} ms | {:.0} ms | {:.0} ms | {:.0} ms |",
        times[0],
        times[RUNS - 1],
        rendered(&page.preview).as_secs_f64() * 1e3,
    );
    if let Some(limit) = limit {
        assert!(median < limit, "the median is not below {limit} ms");
    }
}

fn since_1970() -> Duration {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .expect("after 1970")
}

/// Returns the median time of `strahl render`.
fn rendered(preview: &Preview) -> Duration {
    let mut times: Vec<_> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            let done = Command::new(env!("CARGO_BIN_EXE_strahl"))
                .args(["render", "scene.ron", "-q"])
                .current_dir(preview.folder())
                .status();
            assert!(done.expect("strahl runs").success());
            start.elapsed()
        })
        .collect();
    times.sort();
    times[RUNS / 2]
}
