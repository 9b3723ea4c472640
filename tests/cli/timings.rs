//! Timings.

use std::{fs, time::Instant};

use serde_json::Value;

use crate::support::{Folder, RON, run};

const STAGES: [&str; 6] = [
    "read_s", "check_s", "build_s", "trace_s", "encode_s", "write_s",
];

fn timings(folder: &Folder, args: &str) -> Value {
    let done = run(&mut folder.strahl(args.split_whitespace()));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    let (line, rest) = done.stderr.split_once('\n').unwrap();
    assert_eq!(rest, "", "one line");
    serde_json::from_str(line).unwrap()
}

#[test]
fn json_has_every_field_and_they_agree() {
    let folder = Folder::with_scenes();
    for threads in [1, 2, 3] {
        let start = Instant::now();
        let args =
            format!("render scene.ron --size 700x500 --timings=json --threads {threads} -o a.png");
        let found = timings(&folder, &args);
        let elapsed = start.elapsed().as_secs_f64();
        let names: Vec<_> = found.as_object().unwrap().keys().collect();
        assert_eq!(names.len(), 12, "{names:?}");
        let seconds = |name: &str| found[name].as_f64().unwrap();
        let total = seconds("total_s");
        assert!(total <= elapsed, "{total} {elapsed}");
        for stage in STAGES {
            let time = seconds(stage);
            assert!(
                time > 0.0 && time <= total,
                "{threads} threads: {stage} {time} of {total}"
            );
        }
        // Stages overlap only with several threads.
        let sum: f64 = STAGES.map(seconds).iter().sum();
        assert!(threads > 1 || sum <= total, "{sum} of {total}");
        assert_eq!(found["rays"], 350_000);
        assert_eq!(found["geometries"], 2);
        assert_eq!(found["threads"], threads);
        let memory = found["peak_memory_bytes"].as_u64();
        assert_eq!(memory.is_some(), cfg!(target_os = "linux"));
        assert!(memory.is_none_or(|bytes| bytes > 1 << 20 && bytes < 1 << 30));
    }
}

#[test]
fn the_fields_are_in_the_order_of_the_stages() {
    let folder = Folder::with_scenes();
    let line = run(&mut folder.strahl(["render", "scene.ron", "--timings=json"])).stderr;
    let mut names = vec!["strahl"];
    names.extend(STAGES);
    names.extend([
        "total_s",
        "rays",
        "geometries",
        "threads",
        "peak_memory_bytes",
    ]);
    let places: Vec<_> = names
        .iter()
        .map(|name| line.find(&format!("\"{name}\":")).expect(name))
        .collect();
    assert!(places.is_sorted(), "{line}");
}

#[test]
fn the_default_output_is_a_table() {
    let folder = Folder::with_scenes();
    for option in ["--timings", "--timings=human"] {
        let done = run(&mut folder.strahl(["render", "scene.ron", option]));
        assert_eq!(done.status, Some(0));
        assert!(done.stdout.is_empty());
        let names = done
            .stderr
            .lines()
            .map(|line| line.split_whitespace().next().unwrap());
        let stages = [
            "read", "check", "build", "trace", "encode", "write", "total",
        ];
        assert!(names.take(7).eq(stages), "{}", done.stderr);
        assert!(done.stderr.contains("768 rays"), "{}", done.stderr);
        let ends = done.stderr.lines().take(7).map(str::len);
        assert!(ends.clone().all(|end| Some(end) == ends.clone().next()));
    }
}

#[test]
fn quiet_runs_keep_their_timings_and_failed_ones_have_none() {
    let folder = Folder::with_scenes();
    timings(&folder, "render scene.ron -q --timings=json");
    folder.write("loud.ron", RON.replace("(0, 1, 0))", "(0, 9, 0))"));
    timings(&folder, "render loud.ron -q --timings=json");
    folder.write("bad.ron", "(");
    let done = run(&mut folder.strahl(["render", "bad.ron", "--timings=json"]));
    assert!(done.status == Some(1) && !done.stderr.contains("read_s"));
}

#[test]
fn timings_change_no_byte() {
    let folder = Folder::with_scenes();
    run(&mut folder.strahl(["render", "scene.ron", "-o", "a.png"])).quiet_success();
    timings(&folder, "render scene.ron -o b.png --timings=json");
    let read = |name| fs::read(folder.path(name)).unwrap();
    assert!(read("a.png") == read("b.png"));
    // The picture goes to standard output, the timings do not.
    let done = run(&mut folder.strahl(["render", "scene.ron", "-o", "-", "--timings"]));
    assert!(done.stdout == read("a.png"));
}

#[test]
fn only_two_formats_are_known() {
    let folder = Folder::with_scenes();
    let done = run(&mut folder.strahl(["render", "scene.ron", "--timings=xml"]));
    done.failure(2, &["xml", "human", "json"]);
    // The scene is not taken for a format.
    run(&mut folder.strahl(["render", "-q", "--timings", "scene.ron"]));
    assert!(folder.path("scene.png").exists());
}
