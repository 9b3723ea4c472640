//! Frames and movies: selection and names of frames, and movie files.

use std::{fs, io::BufReader};

use crate::support::{Done, Folder, run, run_with};

/// A scene whose cameras orbit a ball in three frames.
const ORBIT: &str = r##"(
    image: (width: 32, height: 24),
    camera: Perspective(eye: (0, 0, 5), look_at: (0, 0, 0), fov: 60),
    cameras: {
        "far": Perspective(eye: (0, 0, 9), look_at: (0, 0, 0), fov: 60),
        "top": Orthographic(eye: (0, 9, 0), gaze: (0, -1, 0), up: (0, 0, -1), scale: 4),
    },
    geometries: [Sphere(center: (0.5, 0, 0), radius: 1, color: "#ff0000")],
    animation: (frames: 3, orbit: (around: (0, 0, 0))),
)"##;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("m.ron", ORBIT);
    folder.write("n.ron", ORBIT.replace("frames: 3", "frames: 2"));
    folder.write("s.ron", ORBIT.replace("animation:", "allow: [], // "));
    folder.write("t.csv", "id,geometries[0].radius\nx,1\ny,0.5\n");
    folder
}

fn render(folder: &Folder, args: &str) -> Done {
    run(&mut folder.strahl(["render"].into_iter().chain(args.split(' '))))
}

#[track_caller]
fn drawn(folder: &Folder, args: &str) {
    let done = render(folder, args);
    assert_eq!(done.status, Some(0), "{args}: {}", done.stderr);
}

#[track_caller]
fn refused(folder: &Folder, args: &str) -> String {
    let done = render(folder, args);
    assert_eq!(done.status, Some(2), "{args}: {}", done.stderr);
    done.stderr
}

/// Returns the number of frames of an animated PNG.
fn frames(folder: &Folder, name: &str) -> u32 {
    let file = BufReader::new(fs::File::open(folder.path(name)).unwrap());
    let reader = png::Decoder::new(file).read_info().unwrap();
    reader.info().animation_control().unwrap().num_frames
}

fn bytes(folder: &Folder, name: &str) -> Vec<u8> {
    fs::read(folder.path(name)).unwrap()
}

#[test]
fn a_movie_has_all_frames_unless_some_are_named() {
    let folder = folder();
    drawn(&folder, "m.ron -o a.apng");
    drawn(&folder, "m.ron -o b.apng --frames all");
    drawn(&folder, "m.ron -o c.apng --frames 0-1");
    assert_eq!(bytes(&folder, "a.apng"), bytes(&folder, "b.apng"));
    assert_eq!(
        (frames(&folder, "a.apng"), frames(&folder, "c.apng")),
        (3, 2)
    );
}

#[test]
fn all_frames_means_those_of_each_scene() {
    let folder = folder();
    drawn(&folder, "m.ron n.ron s.ron --frames all -o all/");
    let names = ["m_0000", "m_0001", "m_0002", "n_0000", "n_0001", "s_0000"];
    for name in names {
        assert!(folder.path(format!("all/{name}.png")).exists(), "{name}");
    }
    assert_eq!(fs::read_dir(folder.path("all")).unwrap().count(), 7);
    // Each is the same as if selected by its number.
    drawn(&folder, "n.ron --frames 1 -o one_{frame}.png");
    assert_eq!(
        bytes(&folder, "one_1.png"),
        bytes(&folder, "all/n_0001.png")
    );
}

#[test]
fn a_frame_placeholder_means_all_frames() {
    let folder = folder();
    drawn(&folder, "m.ron -o p{frame:02}.png");
    let mut piped = folder.strahl(["render", "-", "-o", "i{frame}.png"]);
    assert_eq!(run_with(&mut piped, ORBIT.as_bytes()).status, Some(0));
    drawn(&folder, "m.ron --params t.csv -o {id}{frame}.png");
    for (one, other) in [("p02.png", "i2.png"), ("p01.png", "x1.png")] {
        assert_eq!(bytes(&folder, one), bytes(&folder, other));
    }
    assert_ne!(bytes(&folder, "y2.png"), bytes(&folder, "x2.png"));
}

#[test]
fn a_table_that_sets_the_number_of_frames_needs_their_placeholder() {
    let folder = folder();
    folder.write("frames.csv", "id,animation.frames\nx,5\n");
    let args = "m.ron --params frames.csv -o {id}{frame}.png";
    let messages = refused(&folder, args);
    assert!(messages.contains("`animation.frames`") && messages.contains("--frames 0-9"));
    drawn(&folder, &format!("{args} --frames 0-4"));
    drawn(&folder, "m.ron --params frames.csv -o {id}.apng");
    assert_eq!(frames(&folder, "x.apng"), 5);
}

#[test]
fn each_row_and_each_camera_is_a_movie() {
    let folder = folder();
    drawn(&folder, "m.ron --params t.csv -o {id}.apng");
    drawn(&folder, "m.ron -o m.apng");
    assert_eq!(bytes(&folder, "x.apng"), bytes(&folder, "m.apng"));
    drawn(&folder, "m.ron --set geometries[0].radius=0.5 -o m.apng");
    assert_eq!(bytes(&folder, "y.apng"), bytes(&folder, "m.apng"));

    drawn(&folder, "m.ron --all-cameras -o {camera}.y4m");
    drawn(&folder, "m.ron --camera top -o one.y4m");
    assert_eq!(bytes(&folder, "top.y4m"), bytes(&folder, "one.y4m"));
    assert_ne!(bytes(&folder, "far.y4m"), bytes(&folder, "one.y4m"));

    drawn(&folder, "m.ron n.ron --image-format apng -o movies/");
    assert_eq!(frames(&folder, "movies/n.apng"), 2);
}

#[test]
fn threads_and_shards_make_the_same_movies() {
    let folder = folder();
    for inside in ["a", "b"] {
        fs::create_dir_all(folder.path(inside)).unwrap();
    }
    drawn(&folder, "m.ron --params t.csv -o a/{id}.apng --threads 1");
    drawn(
        &folder,
        "m.ron --params t.csv -o b/{id}.apng --shard 0/2 --threads 3",
    );
    drawn(
        &folder,
        "m.ron --params t.csv -o b/{id}.apng --shard 1/2 --threads 3",
    );
    for name in ["x.apng", "y.apng"] {
        let [one, other] = ["a", "b"].map(|inside| bytes(&folder, &format!("{inside}/{name}")));
        assert_eq!(one, other, "{name}");
    }
}

#[test]
fn resume_keeps_a_movie_until_its_orbit_changes() {
    let folder = folder();
    let args = "m.ron --params t.csv -o {id}.apng --resume";
    drawn(&folder, args);
    let kept = |args: &str| render(&folder, args).stderr;
    assert!(kept(args).contains("2 kept"));
    let other = format!("{args} --set animation.orbit.turns=2");
    assert!(kept(&other).contains("pictures: 2 drawn in"));
    let slower = format!("{other} --set animation.fps=5");
    assert!(kept(&slower).contains("pictures: 2 drawn in"));
    assert!(kept(&slower).contains("2 kept"));
}

#[test]
fn resume_renders_frames_again_after_an_orbit_change() {
    let folder = folder();
    let args = "m.ron --frames all -o out/ --resume";
    drawn(&folder, args);
    let other = format!("{args} --set animation.orbit.turns=-1");
    // Frame 0 is the same.
    let messages = render(&folder, &other).stderr;
    assert!(messages.contains("2 drawn, 1 kept"), "{messages}");
}

#[test]
fn impossible_movies_are_rejected() {
    let folder = folder();
    for (args, expected) in [
        ("s.ron -o s.apng", "a movie needs a scene with an animation"),
        (
            "m.ron s.ron --image-format apng -o x/",
            "s.ron: a movie needs",
        ),
        ("m.ron --all-cameras -o q.apng", "{camera}"),
        ("m.ron --shard 0/2 -o q.apng", "--shard"),
        ("m.ron --report r.json -o q.apng", "--report"),
        (
            "m.ron --params t.csv -o {id}.apng --report {id}.json",
            "not for movies",
        ),
        (
            "m.ron --params t.csv -o {id}.apng --frames 2-3",
            "no frame 3",
        ),
        (
            "m.ron --params t.csv -o {id}.apng --layers depth",
            "--layers",
        ),
        ("m.ron --frames every -o q.apng", "`all`, or numbers"),
    ] {
        let messages = refused(&folder, args);
        assert!(messages.contains(expected), "{args}: {messages}");
    }
}

#[test]
fn pixel_and_info_show_any_frame() {
    let folder = folder();
    let text = |args: &str| {
        let out = run(&mut folder.strahl(args.split(' '))).quiet_success();
        String::from_utf8(out).unwrap()
    };
    let pixel = text("pixel m.ron 16,12 --frame 1");
    assert!(pixel.contains("32x24 at frame 1,"), "{pixel}");
    assert!(pixel.contains("eye e        (4.33012701892219"), "{pixel}");
    assert_ne!(pixel, text("pixel m.ron 16,12"));
    assert!(text("pixel m.ron 16,12 --frame 1 --output-format json").contains("\"frame\": 1"));
    let info = text("info m.ron --frame 2");
    assert!(
        info.contains("3 frames, 24 per second, frame 2 shown"),
        "{info}"
    );
    assert!(info.contains("eye e        (-4.33012701892219"), "{info}");
    // A still scene has only frame 0, as with `render --frames`.
    assert_eq!(text("info s.ron --frame 0"), text("info s.ron"));
    for command in ["pixel {} 1,1", "info {}"] {
        for (scene, expected) in [
            ("m.ron", "there is no frame 3, the animation has 3: 0 to 2"),
            ("s.ron", "there is no frame 3, the scene has no animation"),
        ] {
            let args = format!("{} --frame 3", command.replace("{}", scene));
            let done = run(&mut folder.strahl(args.split(' ')));
            assert_eq!(done.status, Some(2));
            assert!(done.stderr.contains(expected), "{}", done.stderr);
        }
    }
}

/// A scene whose `Fit` frames the atoms of a table.
const STEP: &str = r##"(
    image: (width: 32, height: 24),
    camera: Fit(from: (0, 0, 1)),
    cameras: {"top": Fit(from: (0, 1, 0), up: (0, 0, -1))},
    geometries: [Spheres(file: "0.csv", radius: 0.5, color_by: (column: "q"))],
)"##;

/// A folder with three steps of a growing chain, and the table that names them.
fn steps() -> Folder {
    let folder = Folder::new();
    folder.write("s.ron", STEP);
    let mut rows = "geometries[0].file\n".to_owned();
    for step in 0..3 {
        let atoms: String = (0..=step).map(|at| format!("{at},0,0,{at}\n")).collect();
        folder.write(format!("{step}.csv"), format!("x,y,z,q\n{atoms}"));
        rows += &format!("{step}.csv\n");
    }
    folder.write("rows.csv", rows);
    folder
}

#[test]
fn the_rows_of_a_table_are_the_frames_of_one_movie() {
    let folder = steps();
    drawn(&folder, "s.ron --params rows.csv -o s.apng");
    drawn(
        &folder,
        "s.ron --params rows.csv -o s.y4m --fps 5 --threads 1",
    );
    assert_eq!(frames(&folder, "s.apng"), 3);
    let movie = bytes(&folder, "s.y4m");
    let header = b"YUV4MPEG2 W32 H24 F5:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
    let frames: Vec<_> = movie
        .strip_prefix(header)
        .unwrap()
        .chunks(6 + 3 * 32 * 24)
        .collect();
    assert_eq!(frames.len(), 3);
    // Each is that of an animation that shows this row.
    for (step, frame) in frames.iter().enumerate() {
        let still = STEP.replace("0.csv", &format!("{step}.csv"));
        folder.write(
            "a.ron",
            still.replace("geometries:", "animation: (fps: 5, frames: 1, tracks: {\"geometries[0].radius\": [(0, 0.5)]}), geometries:"),
        );
        drawn(&folder, "a.ron -o a.y4m");
        assert_eq!(&bytes(&folder, "a.y4m")[header.len()..], *frame, "{step}");
    }
    drawn(
        &folder,
        "s.ron --params rows.csv -o {scene}_{camera}.y4m --all-cameras --fps 5",
    );
    drawn(
        &folder,
        "s.ron --params rows.csv -o top.y4m --camera top --fps 5",
    );
    assert_eq!(bytes(&folder, "s_top.y4m"), bytes(&folder, "top.y4m"));
    let done = render(
        &folder,
        "s.ron --params rows.csv -o - --image-format y4m --fps 5 -q",
    );
    assert_eq!((done.status, &*done.stderr), (Some(0), ""));
    assert_eq!(done.stdout, movie);
}

#[test]
fn a_series_is_kept_until_a_row_changes() {
    let folder = steps();
    let args = "s.ron --params rows.csv --fit-all -o s.apng --resume";
    let made = |args: &str| render(&folder, args).stderr;
    assert!(made(args).contains("1 drawn"));
    let first = bytes(&folder, "s.apng");
    assert!(made(args).contains("1 kept"));
    assert!(made(&format!("{args} --fps 9")).contains("1 drawn"));
    assert!(made(args.replace(" --fit-all", "").as_str()).contains("1 drawn"));
    assert_ne!(bytes(&folder, "s.apng"), first);
    assert!(made(args).contains("1 drawn"));
    assert_eq!(bytes(&folder, "s.apng"), first);
    folder.write("1.csv", "x,y,z,q\n0,0,0,7\n");
    assert!(made(args).contains("1 drawn"));
}

#[test]
fn impossible_series_are_rejected() {
    let folder = steps();
    folder.write("sizes.csv", "image.width\n8\n9\n");
    folder.write("bad.csv", "geometries[0].radius\n1\n-1\n");
    folder.write("m.ron", ORBIT);
    folder.write("t.csv", "geometries[0].radius\n1\n2\n");
    for (args, expected, status) in [
        (
            "s.ron --params sizes.csv -o q.apng",
            "sizes.csv:3: the picture is 9x",
            2,
        ),
        ("s.ron --params bad.csv -o q.apng", "bad.csv:3:1", 1),
        (
            "m.ron --params t.csv -o q.apng",
            "put {id} into the name",
            2,
        ),
        (
            "m.ron --params t.csv --fit-all -o {id}.apng",
            "--fit-all is for rows without",
            2,
        ),
        (
            "s.ron --params rows.csv -o {id}.png --fps 3",
            "--fps is for a movie",
            2,
        ),
        ("s.ron -o q.apng --fps 3", "--fps is for a movie", 2),
        ("s.ron -o q.png --fit-all", "--params", 2),
        ("s.ron --params rows.csv -o q.apng --fps 0", "above 0", 2),
    ] {
        let done = render(&folder, args);
        assert_eq!(done.status, Some(status), "{args}: {}", done.stderr);
        assert!(done.stderr.contains(expected), "{args}: {}", done.stderr);
        assert!(!folder.path("q.apng").exists(), "{args}");
    }
}

#[test]
fn rows_keep_the_ranges_of_parts() {
    let folder = steps();
    let part = |step: u8| {
        format!(
            "(geometries: [Spheres(file: \"{step}.csv\", radius: 0.3, color_by: (column: \"q\"))])"
        )
    };
    for step in 0..3 {
        folder.write(format!("part{step}.ron"), part(step));
    }
    folder.write(
        "p.ron",
        "(camera: Fit(), geometries: [Part(file: \"part0.ron\")])",
    );
    folder.write(
        "p.csv",
        "id,geometries[0].file\n0,part0.ron\n1,part1.ron\n2,part2.ron\n",
    );
    for out in ["p_{id}.ppm", "p.apng"] {
        let done = render(&folder, &format!("p.ron --params p.csv -o {out} --fit-all"));
        let warning = "--fit-all does not change those of parts";
        assert_eq!(done.status, Some(0), "{}", done.stderr);
        assert!(done.stderr.contains(warning), "{}", done.stderr);
        assert!(!done.stderr.contains("add --fit-all"), "{}", done.stderr);
    }
    let done = render(&folder, "p.ron --params p.csv -o q.apng --depfile q.d");
    assert_eq!(done.status, Some(2));
    assert!(
        done.stderr.contains("`strahl info SCENE --depfile FILE`"),
        "{}",
        done.stderr
    );
}

#[test]
fn all_rows_are_framed_together() {
    let folder = steps();
    let warning = "the colors of the rows have different ranges";
    let done = render(&folder, "s.ron --params rows.csv -o {id}.ppm");
    assert!(done.stderr.contains(warning), "{}", done.stderr);
    let quiet = render(&folder, "s.ron --params rows.csv -o {id}.ppm -q");
    assert_eq!(quiet.stderr, "");
    let done = render(&folder, "s.ron --params rows.csv -o all_{id}.ppm --fit-all");
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    assert!(!done.stderr.contains(warning), "{}", done.stderr);
    // The last step is the largest, and has all values.
    assert_eq!(bytes(&folder, "all_2.ppm"), bytes(&folder, "2.ppm"));
    assert_ne!(bytes(&folder, "all_0.ppm"), bytes(&folder, "0.ppm"));
    // The pictures are those of the camera and the range that the last step has.
    run(&mut folder.strahl(["convert", "s.ron", "e.ron", "--explicit-camera"]));
    folder.write("last.ron", STEP.replace("0.csv", "2.csv"));
    run(&mut folder.strahl(["convert", "last.ron", "last_e.ron", "--explicit-camera"]));
    let explicit = String::from_utf8(bytes(&folder, "last_e.ron")).unwrap();
    let ranged = explicit.replace("column: \"q\"", "column: \"q\", range: (0, 2)");
    assert_ne!(ranged, explicit);
    folder.write("one.ron", ranged);
    for step in 0..3 {
        let set = format!("one.ron -o one.ppm -q --set geometries[0].file={step}.csv");
        drawn(&folder, &set);
        let expected = bytes(&folder, "one.ppm");
        assert_eq!(
            bytes(&folder, &format!("all_{step}.ppm")),
            expected,
            "{step}"
        );
    }
    // In a picture of another shape, and in parts of the job.
    drawn(
        &folder,
        "s.ron --params rows.csv -o w_{id}.ppm --fit-all --size 24x48",
    );
    drawn(
        &folder,
        "s.ron --params rows.csv -o v_{id}.ppm --fit-all --size 24x48 --shard 1/3",
    );
    assert_eq!(bytes(&folder, "w_1.ppm"), bytes(&folder, "v_1.ppm"));
    drawn(&folder, "last.ron -o last.ppm --size 24x48");
    assert_eq!(bytes(&folder, "w_2.ppm"), bytes(&folder, "last.ppm"));
    // A range of the scene stays.
    folder.write("given.ron", STEP.replace("\"q\"", "\"q\", range: (0, 9)"));
    let done = render(
        &folder,
        "given.ron --params rows.csv -o g_{id}.ppm --fit-all",
    );
    assert_eq!(
        (done.status, done.stderr.contains("ranges")),
        (Some(0), false)
    );
    drawn(
        &folder,
        "given.ron --set geometries[0].file=2.csv -o given.ppm",
    );
    assert_eq!(bytes(&folder, "g_2.ppm"), bytes(&folder, "given.ppm"));
}
