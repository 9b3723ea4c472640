//! Parts of one job: shards, records, and what a second run keeps.

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

/// Forty frames, and the command that draws them into `out/`.
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
fn shards_make_what_one_run_makes_and_each_picture_once() {
    let (folder, args) = job();
    stderr(&folder, 0, &args);
    let expected = pictures(&folder);
    assert_eq!(expected.len(), 40);
    fs::remove_dir_all(folder.path("out")).unwrap();
    // In any order, and one of them twice.
    let mut drawn = 0;
    for shard in ["2/3", "0/3", "2/3", "1/3"] {
        let told = stderr(&folder, 0, &with(&args, &["--shard", shard, "--resume"]));
        let count = told
            .strip_prefix("pictures: ")
            .and_then(|rest| rest.split(' ').next());
        drawn += count.unwrap().parse::<usize>().unwrap();
        if shard == "0/3" {
            let told = status(&folder, 1);
            assert!(told.contains("27 of 40") && told.contains("1/3"), "{told}");
        }
    }
    assert_eq!(drawn, 40);
    assert!(pictures(&folder) == expected);
    assert!(status(&folder, 0).contains("40 of 40"));
}

#[test]
fn what_is_torn_foreign_stale_or_gone_is_made_again_and_nothing_else() {
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
    let told = status(&folder, 1);
    assert!(
        told.contains("35 of 40") && told.contains("1 missing") && told.contains("4 damaged"),
        "{told}"
    );
    // A process that was killed while it wrote leaves half a line.
    let record = folder.path("out/.strahl/0-of-1-0.jsonl");
    let mut text = fs::read(&record).unwrap();
    text.extend_from_slice(b"{\"done\":{\"picture\":\"m_00");
    fs::write(&record, text).unwrap();
    let told = stderr(&folder, 0, &with(&args, &["--resume"]));
    assert!(told.contains("5 drawn, 35 kept"), "{told}");
    assert!(pictures(&folder) == expected);
    assert!(status(&folder, 0).contains("40 of 40"));
    assert!(stderr(&folder, 0, &with(&args, &["--resume"])).contains("0 drawn, 40 kept"));
    // A list that has grown is the job that counts.
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
    // Another scene, or other options, make other pictures.
    for more in [
        &["--set", "background=(0,0,1)"][..],
        &["--samples", "4"],
        &["--compression", "small"],
    ] {
        let told = stderr(&folder, 0, &with(&with(&args, &["--resume"]), more));
        assert!(told.contains("40 drawn"), "{more:?} {told}");
    }
    // And back: what is there now is not what was recorded for this.
    let told = stderr(&folder, 0, &with(&args, &["--resume"]));
    assert!(told.contains("40 drawn"), "{told}");
    assert!(pictures(&folder) == expected);
}

#[test]
fn the_same_shard_twice_at_once_does_no_harm() {
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
fn bands_are_joined_to_the_bytes_of_the_whole() {
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
        let told = stderr(&folder, 1, &with(&["merge"], &options));
        assert!(told.contains("missing: 2/3"), "{told}");
        stderr(
            &folder,
            0,
            &with(&with(&["render"], &options), &["--shard", "2/3"]),
        );
        let told = stderr(
            &folder,
            1,
            &with(&with(&["merge"], &options), &["--set", "camera.fov=50"]),
        );
        assert!(told.contains("another scene"), "{told}");
        stderr(&folder, 0, &with(&["merge"], &options));
        // Once more does no harm: what is to be there is there.
        stderr(&folder, 0, &with(&["merge"], &options));
        assert_eq!(folder.names(), whole, "{name}");
        for (name, expected) in made.iter().zip(&expected) {
            assert!(read(name) == *expected, "{name}");
            fs::remove_file(folder.path(name)).unwrap();
        }
    }
}

#[test]
fn a_band_that_is_there_is_kept_and_a_damaged_one_is_not() {
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
fn a_folder_without_a_record_is_told() {
    let folder = Folder::new();
    let done = run(&mut folder.strahl(["status", "."]));
    done.one_line(2, &[".strahl", "no run"]);
    run(&mut folder.strahl(["merge", "x.ron"])).one_line(2, &["x.ron", "no such"]);
    folder.write("m.ron", MOVING);
    run(&mut folder.strahl(["merge", "m.ron"])).one_line(1, &["m.png", "--shard"]);
}
