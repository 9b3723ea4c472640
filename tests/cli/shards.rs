//! Shards and bands of one job, its records, and resumed runs.

use std::fs;

use crate::{
    many::MOVING,
    support::{Folder, run},
};

fn stderr(folder: &Folder, status: i32, args: &[&str]) -> String {
    let done = run(&mut folder.strahl(args));
    assert_eq!(done.status, Some(status), "{args:?}: {}", done.stderr);
    done.stderr
}

fn status(folder: &Folder, code: i32) -> String {
    let done = run(&mut folder.strahl(["status", "out"]));
    assert_eq!(done.status, Some(code), "{}", done.stderr);
    String::from_utf8(done.stdout).unwrap()
}

/// A scene with forty frames, and the command that renders them into `out/`.
fn job() -> (Folder, Vec<&'static str>) {
    let folder = Folder::new();
    folder.write(
        "m.ron",
        MOVING
            .replace("frames: 3", "frames: 40")
            .replace("(1, 2)", "(20, 2)"),
    );
    (
        folder,
        vec!["render", "m.ron", "--frames", "0-39", "-o", "out/"],
    )
}

fn with<'a>(args: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    [args, more].concat()
}

fn pictures(folder: &Folder) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder.path("out")).unwrap();
    let files = entries.map(|entry| entry.unwrap().path());
    let files = files.filter(|path| path.is_file());
    let mut files: Vec<_> = files
        .map(|path| {
            (
                path.file_name().unwrap().to_string_lossy().into_owned(),
                fs::read(&path).unwrap(),
            )
        })
        .collect();
    files.sort();
    files
}

#[test]
fn shards_render_each_picture_of_one_run_once() {
    let (folder, args) = job();
    stderr(&folder, 0, &args);
    let expected = pictures(&folder);
    assert_eq!(expected.len(), 40);
    fs::remove_dir_all(folder.path("out")).unwrap();
    // In any order, one of them twice.
    let mut drawn = 0;
    for shard in ["2/3", "0/3", "2/3", "1/3"] {
        let messages = stderr(&folder, 0, &with(&args, &["--shard", shard, "--resume"]));
        let count = messages
            .strip_prefix("pictures: ")
            .and_then(|rest| rest.split(' ').next());
        drawn += count.unwrap().parse::<usize>().unwrap();
        if shard == "0/3" {
            let messages = status(&folder, 1);
            assert!(
                messages.contains("27 of 40") && messages.contains("1/3"),
                "{messages}"
            );
        }
    }
    assert_eq!(drawn, 40);
    assert!(pictures(&folder) == expected);
    assert!(status(&folder, 0).contains("40 of 40"));
}

#[test]
fn only_damaged_foreign_stale_or_missing_pictures_are_rendered_again() {
    let (folder, args) = job();
    stderr(&folder, 0, &args);
    let expected = pictures(&folder);
    let name = |number: usize| folder.path("out").join(&expected[number].0);
    fs::write(name(3), &expected[3].1[..50]).unwrap();
    fs::write(name(4), b"foreign").unwrap();
    let mut rotten = expected[2].1.clone();
    *rotten.last_mut().unwrap() ^= 1;
    fs::write(name(2), rotten).unwrap();
    fs::copy(name(6), name(5)).unwrap();
    fs::remove_file(name(7)).unwrap();
    let messages = status(&folder, 1);
    assert!(
        messages.contains("35 of 40")
            && messages.contains("1 missing")
            && messages.contains("4 damaged"),
        "{messages}"
    );
    // A process that is killed while writing leaves half a line.
    let record = folder.path("out/.strahl/0-of-1-0.jsonl");
    let mut text = fs::read(&record).unwrap();
    text.extend_from_slice(b"{\"done\":{\"picture\":\"m_00");
    fs::write(&record, text).unwrap();
    let messages = stderr(&folder, 0, &with(&args, &["--resume"]));
    assert!(messages.contains("5 drawn, 35 kept"), "{messages}");
    assert!(pictures(&folder) == expected);
    assert!(status(&folder, 0).contains("40 of 40"));
    assert!(stderr(&folder, 0, &with(&args, &["--resume"])).contains("0 drawn, 40 kept"));
    // A changed list of pictures replaces the job.
    for shard in ["0/2", "1/2"] {
        stderr(&folder, 0, &with(&args, &["--resume", "--shard", shard]));
    }
    let grown: Vec<_> = args
        .iter()
        .map(|arg| if *arg == "0-39" { "0-38" } else { arg })
        .collect();
    for shard in ["0/2", "1/2"] {
        stderr(&folder, 0, &with(&grown, &["--resume", "--shard", shard]));
    }
    assert!(status(&folder, 0).contains("39 of 39"));
    // A different scene or different options give different pictures.
    for more in [
        &["--set", "background=(0,0,1)"][..],
        &["--samples", "4"],
        &["--compression", "small"],
    ] {
        let messages = stderr(&folder, 0, &with(&with(&args, &["--resume"]), more));
        assert!(messages.contains("40 drawn"), "{more:?} {messages}");
    }
    // And back: the current files are not those recorded for these options.
    let messages = stderr(&folder, 0, &with(&args, &["--resume"]));
    assert!(messages.contains("40 drawn"), "{messages}");
    assert!(pictures(&folder) == expected);
}

#[test]
fn the_same_shard_can_run_twice_at_once() {
    let (folder, args) = job();
    stderr(&folder, 0, &args);
    let expected = pictures(&folder);
    fs::remove_dir_all(folder.path("out")).unwrap();
    let start = || {
        folder
            .strahl(with(&args, &["--resume", "-q"]))
            .spawn()
            .unwrap()
    };
    let mut runs: Vec<_> = (0..4).map(|_| start()).collect();
    for run in &mut runs {
        assert!(run.wait().unwrap().success());
    }
    assert!(pictures(&folder) == expected);
    assert!(status(&folder, 0).contains("40 of 40"));
}

#[test]
fn merged_bands_equal_the_whole_picture() {
    let folder = Folder::new();
    folder.write("m.ron", MOVING);
    for (name, more) in [
        ("a.png", &["--samples", "4"][..]),
        ("a.tiff", &["--crop", "3,2,20,17"]),
        ("a.exr", &["--layers", "color,depth,id", "--bits", "16"]),
        ("a.jpg", &[]),
        ("a.npz", &["--layers", "color,normal,id"]),
        ("b.png", &["--layers", "color,normal", "--palette", "auto"]),
    ] {
        let options = [&["m.ron", "-q", "-o", name], more].concat();
        stderr(&folder, 0, &with(&["render"], &options));
        let whole = folder.names();
        let read = |name: &String| fs::read(folder.path(name)).unwrap();
        let made: Vec<_> = whole.iter().filter(|name| !name.ends_with("ron")).collect();
        let expected: Vec<_> = made.iter().map(|name| read(name)).collect();
        made.iter()
            .for_each(|name| fs::remove_file(folder.path(name)).unwrap());
        for shard in ["1/3", "0/3"] {
            stderr(
                &folder,
                0,
                &with(&with(&["render"], &options), &["--shard", shard]),
            );
        }
        let messages = stderr(&folder, 1, &with(&["merge"], &options));
        assert!(messages.contains("missing: 2/3"), "{messages}");
        stderr(
            &folder,
            0,
            &with(&with(&["render"], &options), &["--shard", "2/3"]),
        );
        let messages = stderr(
            &folder,
            1,
            &with(&with(&["merge"], &options), &["--set", "camera.fov=50"]),
        );
        assert!(messages.contains("another scene"), "{messages}");
        stderr(&folder, 0, &with(&["merge"], &options));
        // Merging again does no harm: the result already exists.
        stderr(&folder, 0, &with(&["merge"], &options));
        assert_eq!(folder.names(), whole, "{name}");
        for (name, expected) in made.iter().zip(&expected) {
            assert!(read(name) == *expected, "{name}");
            fs::remove_file(folder.path(name)).unwrap();
        }
    }
}

#[test]
fn an_existing_band_is_kept_unless_damaged() {
    let folder = Folder::new();
    folder.write("m.ron", MOVING);
    let args = [
        "render", "m.ron", "-q", "-o", "a.png", "--shard", "0/2", "--resume",
    ];
    stderr(&folder, 0, &args);
    let part = folder.path("a.png.0-of-2.part");
    let time = || fs::metadata(&part).unwrap().modified().unwrap();
    let (before, bytes) = (time(), fs::read(&part).unwrap());
    stderr(&folder, 0, &args);
    assert_eq!(time(), before);
    fs::write(&part, &bytes[..bytes.len() - 1]).unwrap();
    assert!(stderr(&folder, 1, &["merge", "m.ron", "-o", "a.png"]).contains("damaged"));
    stderr(&folder, 0, &args);
    assert!(fs::read(&part).unwrap() == bytes);
}

#[test]
fn a_folder_without_a_record_is_reported() {
    let folder = Folder::new();
    let done = run(&mut folder.strahl(["status", "."]));
    done.one_line(2, &[".strahl", "no record"]);
    run(&mut folder.strahl(["merge", "x.ron"])).one_line(2, &["x.ron", "no such"]);
    folder.write("m.ron", MOVING);
    run(&mut folder.strahl(["merge", "m.ron"])).one_line(1, &["m.png", "--shard"]);
}
