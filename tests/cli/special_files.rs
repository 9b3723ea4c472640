//! Pipes, devices and long files in place of those that the program reads.

use std::{fs, os::unix::fs::symlink, process::Command};

use crate::{
    support::{Folder, RON, run, skip, until},
    watch::Watching,
};

/// Creates a named pipe; false if the system has none.
fn pipe(folder: &Folder, name: &str) -> bool {
    let made = Command::new("mkfifo").arg(folder.path(name)).status();
    made.is_ok_and(|status| status.success())
}

#[test]
fn a_folder_may_hold_pipes_and_devices() {
    let folder = Folder::new();
    folder.write("scene.ron", RON);
    if !pipe(&folder, "x.ron") {
        return skip("there is no mkfifo");
    }
    symlink("/dev/zero", folder.path("zero.json")).unwrap();
    for args in [
        &["validate", "."][..],
        &["fmt", "."],
        &["render", ".", "-o", "{scene}.png"],
    ] {
        let done = run(&mut folder.strahl(args));
        assert_eq!(done.status, Some(0), "{args:?}: {}", done.stderr);
    }
    for (name, word) in [("x.ron", "named pipe"), ("zero.json", "is a device")] {
        for command in ["fmt", "render", "info", "convert", "preview", "pixel"] {
            let mut args = vec![command, name];
            args.extend((command == "pixel").then_some("1,1"));
            args.extend((command == "convert").then_some("y.ron"));
            run(&mut folder.strahl(args)).one_line(2, &[name, word]);
        }
        let done = run(&mut folder.strahl(["validate", name]));
        assert_eq!(done.status, Some(2), "{}", done.stderr);
    }
    // A pipe that is open already has a writer.
    let script = "cat scene.ron | \"$STRAHL\" render /dev/stdin --input-format ron -o a.png";
    run(&mut folder.shell(script)).quiet_success();
}

#[test]
fn pipes_are_not_patterns_and_settings() {
    let folder = Folder::with_scenes();
    for name in [".gitignore", "strahl.toml"] {
        if !pipe(&folder, name) {
            return skip("there is no mkfifo");
        }
        let done = run(&mut folder.strahl(["validate", "."]));
        done.one_line(2, &[name, "named pipe"]);
        fs::remove_file(folder.path(name)).unwrap();
        symlink("/dev/zero", folder.path(name)).unwrap();
        let done = run(&mut folder.strahl(["fmt", "."]));
        done.one_line(2, &[name, "is a device"]);
        fs::remove_file(folder.path(name)).unwrap();
        let bytes: String = (0..600_000).map(|line| format!("*{line}*\n")).collect();
        folder.write(name, bytes);
        let done = run(&mut folder.strahl(["render", "."]));
        done.one_line(2, &[name, "is larger than"]);
        fs::remove_file(folder.path(name)).unwrap();
    }
}

#[test]
fn pipes_are_not_tables_lists_and_rules() {
    let folder = Folder::with_scenes();
    if !["p.csv", "list", "rule.d", "a.part", "out.json"]
        .iter()
        .all(|name| pipe(&folder, name))
    {
        return skip("there is no mkfifo");
    }
    let cases: [&[&str]; 4] = [
        &["render", "scene.ron", "--params", "p.csv", "-o", "{id}.png"],
        &["validate", "--files-from", "list"],
        &["render", "scene.ron", "-o", "a.png", "--depfile", "rule.d"],
        &["render", "scene.ron", "-o", "a.png", "--report", "out.json"],
    ];
    for args in cases {
        run(&mut folder.strahl(args)).one_line(2, &["is a named pipe"]);
    }
    assert!(!folder.path("a.png").exists());
    let rule = "\"$STRAHL\" render scene.ron -o a.png --depfile /dev/stdout | cat";
    let done = run(&mut folder.shell(rule));
    assert!(done.stdout.starts_with(b"a.png:"), "{}", done.stderr);
    fs::create_dir_all(folder.path("out/.strahl")).unwrap();
    assert!(pipe(&folder, "out/.strahl/0-of-1-0.jsonl"));
    let done = run(&mut folder.strahl(["status", "out"]));
    assert_ne!(done.status, Some(0), "{}", done.stderr);
}

#[test]
fn what_another_program_saves_meanwhile_survives() {
    // Long enough that the other program saves between reading and writing.
    let spheres = "Sphere(center:(0,0,-9),radius:1,color:\"#f00\"),\n".repeat(20_000);
    let scene = |name: &str| {
        RON.replace(
            "geometries: [",
            &format!("geometries: [ // {name}\n{spheres}"),
        )
    };
    let folder = Folder::new();
    let mut lost = 0;
    for round in 0..8 {
        folder.write("s.ron", scene("old"));
        let mut fmt = folder.strahl(["fmt", "s.ron"]).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(40 * round));
        let new = scene("new");
        folder.write("other", &new);
        fs::rename(folder.path("other"), folder.path("s.ron")).unwrap();
        let status = fmt.wait().unwrap();
        let text = fs::read_to_string(folder.path("s.ron")).unwrap();
        assert!([Some(0), Some(75)].contains(&status.code()), "{status}");
        lost += usize::from(!text.contains("// new"));
    }
    assert_eq!(lost, 0);
}

#[test]
fn links_on_the_way_are_watched() {
    let folder = Folder::new();
    let versions = ["v1", "v2", "v3"];
    let background =
        |name: &str| RON.replace("(0, 0.2, 0.4)", &format!("(0, 0, 0.{})", &name[1..]));
    for name in versions {
        fs::create_dir(folder.path(name)).unwrap();
        folder.write(format!("{name}/s.ron"), background(name));
    }
    let point = |name: &str| {
        symlink(name, folder.path("new")).unwrap();
        fs::rename(folder.path("new"), folder.path("cur")).unwrap();
    };
    point("v1");
    let mut watching = Watching::new(folder.strahl(["watch", "cur/s.ron", "-o", "s.png"]));
    until("the first picture", || {
        watching.stderr().contains("wrote s.png")
    });
    let mut last = fs::read(folder.path("s.png")).unwrap();
    for name in ["v2", "v3"] {
        watching.expect("wrote s.png", || point(name));
        let picture = fs::read(folder.path("s.png")).unwrap();
        assert_ne!(picture, last);
        last = picture;
        // And everything after it.
        watching.expect("wrote s.png", || {
            folder.write(format!("{name}/s.ron"), RON);
        });
    }
    watching.end();
}

#[test]
fn the_links_of_a_folder_are_watched() {
    let folder = Folder::new();
    for (name, text) in [
        ("..v1", RON.to_owned()),
        ("..v2", RON.replace("radius", "radios")),
    ] {
        fs::create_dir(folder.path(name)).unwrap();
        folder.write(format!("{name}/s.ron"), text);
    }
    fs::create_dir(folder.path("scenes")).unwrap();
    let point = |name: &str| {
        symlink(format!("../{name}"), folder.path("scenes/new")).unwrap();
        fs::rename(folder.path("scenes/new"), folder.path("scenes/..data")).unwrap();
    };
    point("..v1");
    symlink("..data/s.ron", folder.path("scenes/s.ron")).unwrap();
    symlink("scenes", folder.path("link")).unwrap();
    for path in ["scenes", "link"] {
        let args = ["validate", "--watch", path, "--output-format", "short"];
        let mut watching = Watching::new(folder.strahl(args));
        until("a report", || {
            watching.stderr().contains("1 file: no problems\nwaiting")
        });
        watching.expect("1 file: 1 error", || point("..v2"));
        watching.expect("1 file: no problems", || point("..v1"));
        watching.expect("1 file: 1 error", || {
            folder.write("..v1/s.ron", RON.replace("radius", "radios"));
        });
        watching.expect("1 file: no problems", || {
            folder.write("..v1/s.ron", RON);
        });
        if path == "link" {
            fs::create_dir(folder.path("empty")).unwrap();
            folder.write("empty/t.ron", RON.replace("radius", "radios"));
            watching.expect("1 file: 1 error", || {
                symlink("empty", folder.path("new")).unwrap();
                fs::rename(folder.path("new"), folder.path("link")).unwrap();
            });
        }
        watching.end();
    }
}
