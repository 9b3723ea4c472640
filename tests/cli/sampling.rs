//! Pictures whose light follows paths: samples that are kept and continued, time limits, noise in bands.

use std::{fs, process::Stdio};

use crate::support::{Folder, run, until};

const SCENE: &str = r##"(
    image: (width: 20, height: 14),
    camera: Perspective(eye: (0, 1.2, 5), look_at: (0, 0.7, 0), fov: 40),
    lighting: Path(samples: 12),
    lights: [Environment(sky: (zenith: "#4a78b8", horizon: "#dfe8f0", ground: "#5a554c"))],
    outlines: (width: 1),
    geometries: [
        Plane(point: (0, 0, 0), normal: (0, 1, 0), color: "#c8c0b4"),
        Sphere(center: (0, 0.6, 0), radius: 0.6, material: Plastic(color: "#b02818")),
    ],
)"##;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("a.ron", SCENE);
    folder
}

/// Renders a picture; returns its bytes and what was printed.
fn render(folder: &Folder, output: &str, options: &[&str]) -> (Vec<u8>, String) {
    let args = ["render", "a.ron", "-o", output];
    let done = run(&mut folder.strahl(args.iter().chain(options)));
    assert_eq!(done.status, Some(0), "{options:?}: {}", done.stderr);
    (fs::read(folder.path(output)).unwrap(), done.stderr)
}

const KEPT: &str = ".strahl/a.exr.samples";
const LAYERS: [&str; 2] = ["--layers", "color,error,samples,id"];

#[test]
fn kept_samples_are_continued() {
    let folder = folder();
    let (whole, _) = render(&folder, "b.exr", &LAYERS);
    let kept = [&LAYERS[..], &["--samples", "5", "--keep-samples"]].concat();
    render(&folder, "a.exr", &kept);
    let five = fs::read(folder.path(KEPT)).unwrap();
    let resumed = [&LAYERS[..], &["--resume"]].concat();
    let (bytes, _) = render(&folder, "a.exr", &resumed);
    assert!(bytes == whole, "the picture of all samples");
    assert!(!folder.path(KEPT).exists(), "it is not needed any more");

    // What is not of this picture is told and not used.
    let cut = &five[..five.len() - 1];
    let mut changed = five.clone();
    changed[five.len() / 2] ^= 1;
    for file in [cut, &changed, b"strahl samples 1 x\n", b""] {
        fs::write(folder.path(KEPT), file).unwrap();
        let (bytes, told) = render(
            &folder,
            "a.exr",
            &[&resumed[..], &["--threads", "1"]].concat(),
        );
        assert!(bytes == whole);
        // The picture itself is finished.
        assert_eq!(
            told.lines().filter(|line| line.contains("warning")).count(),
            0,
            "{told}"
        );
        fs::remove_file(folder.path("a.exr")).unwrap();
        let (bytes, told) = render(&folder, "a.exr", &resumed);
        assert!(bytes == whole);
        assert!(
            told.contains("a.exr.samples") && told.contains("damaged"),
            "{told}"
        );
    }
    fs::write(folder.path(KEPT), &five).unwrap();
    fs::remove_file(folder.path("a.exr")).unwrap();
    let (_, told) = render(
        &folder,
        "a.exr",
        &[&resumed[..], &["--samples", "4"]].concat(),
    );
    assert!(
        told.contains("only 4 samples") && told.contains("the file 5"),
        "{told}"
    );
}

#[cfg(unix)]
#[test]
fn samples_are_not_written_through_a_link() {
    let folder = folder();
    folder.write("other", "mine");
    fs::create_dir(folder.path(".strahl")).unwrap();
    std::os::unix::fs::symlink(folder.path("other"), folder.path(KEPT)).unwrap();
    let args = ["render", "a.ron", "-o", "a.exr", "--keep-samples"];
    let done = run(&mut folder.strahl(args));
    assert!(done.stderr.contains("not a link"), "{}", done.stderr);
    assert_eq!(fs::read(folder.path("other")).unwrap(), b"mine");
}

/// Returns the number of samples in a report.
fn reported(folder: &Folder) -> u64 {
    let report = fs::read(folder.path("a.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
    report["image"]["samples"].as_u64().unwrap()
}

#[test]
fn a_time_limit_gives_the_picture_of_fewer_samples() {
    let folder = folder();
    let most = [
        "--samples",
        "1000000",
        "--metadata",
        "--report",
        "{scene}.json",
    ];
    for output in ["a.png", "a.exr"] {
        let (limited, _) = render(
            &folder,
            output,
            &[&most[..], &["--time-limit", "0.05s"]].concat(),
        );
        let count = reported(&folder);
        assert!((1..1_000_000).contains(&count), "{count}");
        let count = count.to_string();
        let (same, _) = render(&folder, output, &["--metadata", "--samples", &count]);
        assert!(limited == same, "{count} samples");
        let needle = format!("Samples\0\0\0\0\0{count}");
        let holds = |text: &[u8]| limited.windows(text.len()).any(|part| part == text);
        assert!(
            output == "a.exr" || holds(needle.as_bytes()),
            "{count} in the metadata"
        );
    }
    let (_, _) = render(
        &folder,
        "a.png",
        &["--time-limit", "1h", "--report", "{scene}.json"],
    );
    assert_eq!(reported(&folder), 12, "never more than those of the scene");
}

#[test]
fn options_of_rounds_are_refused_where_they_have_no_effect() {
    let folder = folder();
    folder.write(
        "flat.ron",
        SCENE.replace("lighting: Path(samples: 12),", ""),
    );
    for (args, words) in [
        (&["a.ron", "--time-limit", "90"][..], "90s, 15m or 2h"),
        (
            &["a.ron", "--time-limit", "1s", "--shard", "0/2"],
            "whole pictures",
        ),
        (
            &["a.ron", "-o", "a.apng", "--keep-samples"],
            "not for movies",
        ),
        (&["flat.ron", "--time-limit", "1s"], "lighting: Path()"),
        (&["flat.ron", "--keep-samples"], "lighting: Path()"),
        (
            &["a.ron", "--size", "5000x5000", "--time-limit", "1s"],
            "16777216 pixels",
        ),
    ] {
        let done = run(&mut folder.strahl(["render"].iter().chain(args)));
        assert_eq!(done.status, Some(2), "{args:?}: {}", done.stderr);
        assert!(done.stderr.contains(words), "{args:?}: {}", done.stderr);
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_keeps_its_samples() {
    let folder = folder();
    let args = ["render", "a.ron", "-o", "a.exr", "--resume", "--samples"];
    let mut command = folder.strahl(args.iter().chain(&["1000000"]));
    let mut child = command.stderr(Stdio::null()).spawn().unwrap();
    until("the samples are written", || folder.path(KEPT).exists());
    let id = child.id().to_string();
    let kill = std::process::Command::new("kill")
        .args(["-INT", &id])
        .status();
    assert!(kill.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(folder.path(KEPT).exists() && !folder.path("a.exr").exists());
    let resumed = [
        "--resume",
        "--samples",
        "1000000",
        "--time-limit",
        "0.001s",
        "--report",
        "{scene}.json",
    ];
    let (resumed, told) = render(&folder, "a.exr", &resumed);
    assert!(!told.contains("warning"), "{told}");
    let count = reported(&folder);
    assert!(count > 1, "the samples of the first run");
    let (same, _) = render(&folder, "b.exr", &["--samples", &count.to_string()]);
    assert!(resumed == same, "{count} samples");
}

#[test]
fn bands_of_a_picture_with_noise_are_those_of_the_whole() {
    let folder = folder();
    folder.write(
        "a.ron",
        SCENE.replace("samples: 12", "samples: 200, noise: 0.03"),
    );
    let (whole, _) = render(&folder, "b.exr", &LAYERS);
    for part in ["0/3", "1/3", "2/3"] {
        let args = ["render", "a.ron", "-o", "a.exr", "--shard", part];
        run(&mut folder.strahl(args.iter().chain(&LAYERS))).quiet_success();
    }
    let args = ["merge", "a.ron", "-o", "a.exr"];
    run(&mut folder.strahl(args.iter().chain(&LAYERS))).quiet_success();
    assert!(fs::read(folder.path("a.exr")).unwrap() == whole);
}
