//! Other programs that are in the way: those that open connections, read the list of processes, or
//! write the file.

use std::{
    fs,
    io::Write,
    net::{Ipv4Addr, TcpStream},
    os::unix::fs::{PermissionsExt, symlink},
    path::{Path, PathBuf},
    process::Command,
    thread,
    time::{Duration, Instant},
};

use tempfile::TempDir;

use super::{
    PageTest,
    browser::{Browser, PATIENCE},
    http::{Answer, Request},
    preview::{Preview, SCENE},
    tests,
};

pub(crate) const PAGE_TESTS: &[(&str, PageTest)] = tests![the_private_file_opens_the_page];

pub(crate) const TESTS: &[(&str, fn())] = tests![
    half_requests_lock_nobody_out,
    the_token_is_not_in_the_list_of_processes,
    a_pipe_in_place_of_the_scene_is_not_read,
    of_two_that_save_at_once_none_loses_an_edit,
    a_link_on_the_way_is_followed,
];

fn authorized(request: Request, preview: &Preview) -> Request {
    request.header("Authorization", &format!("Bearer {}", preview.token()))
}

/// Returns the status that an answer means; a refusal that is a part of normal work is a success.
fn status(answer: &Answer) -> u16 {
    let refused = answer.header("x-strahl-refused");
    refused.map_or(answer.status, |refused| refused.parse().unwrap())
}

/// Sends a request, and returns the status of its answer.
fn post(preview: &Preview, path: &str, body: &str) -> u16 {
    status(&authorized(Request::post(path).body(body), preview).send(preview.port()))
}

/// Puts a line in front of the draft.
fn insert(preview: &Preview, version: u64, line: &str) -> u16 {
    let edit = format!(
        r#"{{"version": {version}, "edits": [{{"from": {{"line": 1, "column": 1}},
            "to": {{"line": 1, "column": 1}}, "text": "{line}\n"}}]}}"#
    );
    post(preview, "/edits", &edit)
}

fn text(preview: &Preview) -> String {
    authorized(Request::get("/text"), preview)
        .send(preview.port())
        .text()
}

fn wait_until(what: &str, mut has_happened: impl FnMut() -> bool) {
    let end = Instant::now() + PATIENCE;
    while !has_happened() {
        assert!(Instant::now() < end, "waited in vain for {what}");
        thread::sleep(Duration::from_millis(10));
    }
}

fn half_requests_lock_nobody_out() {
    let preview = Preview::of("scene.ron", SCENE);
    let half: Vec<_> = (0..800)
        .map(|number| {
            let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, preview.port())).unwrap();
            let part = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: ";
            let _ = stream.write_all(&part.as_bytes()[..number % part.len()]);
            stream
        })
        .collect();
    let before = authorized(Request::get("/events"), &preview).connect(preview.port());
    for _ in 0..3 {
        assert!(text(&preview).contains("Sphere"));
    }
    let open = fs::read_dir(format!("/proc/{}/fd", preview.id()));
    if let Ok(open) = open {
        let count = open.count();
        assert!(count < 200, "{count} files are open");
    }
    // A page that has shown the token stays, however many come after it.
    let more: Vec<_> = (0..200)
        .map(|_| TcpStream::connect((Ipv4Addr::LOCALHOST, preview.port())).unwrap())
        .collect();
    let mut before = before;
    assert_eq!(Answer::head(&mut before).status, 200);
    assert!(text(&preview).contains("Sphere"));
    drop((half, more));
}

/// A program called `xdg-open`, which notes its argument and the list of processes.
fn opener(folder: &Path) -> PathBuf {
    let programs = folder.join("bin");
    fs::create_dir(&programs).unwrap();
    let script = "#!/bin/sh\ncat /proc/[0-9]*/cmdline > \"$NOTES/list\" 2> /dev/null\n\
                  printf %s \"$1\" > \"$NOTES/part\"\nmv \"$NOTES/part\" \"$NOTES/argument\"\n";
    let file = programs.join("xdg-open");
    fs::write(&file, script).unwrap();
    fs::set_permissions(&file, PermissionsExt::from_mode(0o755)).unwrap();
    programs
}

/// Starts a preview that opens a browser, and returns the file that the browser gets.
fn opened() -> (Preview, PathBuf) {
    let folder = TempDir::new().unwrap();
    let programs = opener(folder.path());
    let scene = folder.path().join("scene.ron");
    fs::write(&scene, SCENE).unwrap();
    let notes = folder.path().to_owned();
    let path = std::env::var("PATH").unwrap();
    let path = format!("{}:{path}", programs.display());
    let preview = Preview::start_with(folder, scene, &["--port", "0"], |command| {
        command.env("PATH", path).env("NOTES", &notes);
    });
    let argument = notes.join("argument");
    wait_until("the browser", || argument.exists());
    (preview, fs::read_to_string(argument).unwrap().into())
}

fn the_token_is_not_in_the_list_of_processes() {
    let (preview, file) = opened();
    let token = preview.token();
    assert!(
        !file.to_str().unwrap().contains(token),
        "{}",
        file.display()
    );
    let list = fs::read(preview.folder().join("list")).unwrap();
    assert!(!String::from_utf8_lossy(&list).contains(token));
    let about = fs::metadata(&file).unwrap();
    assert_eq!(about.permissions().mode() & 0o777, 0o600);
    let content = fs::read_to_string(&file).unwrap();
    assert!(
        content.contains(&format!("url={}\"", preview.url)),
        "{content}"
    );
    // Only whoever has the token removes it.
    assert_eq!(Request::get("/").send(preview.port()).status, 403);
    assert_eq!(Request::get("/page.js").send(preview.port()).status, 200);
    assert!(file.exists());
    assert!(text(&preview).contains("Sphere"));
    assert!(!file.exists());
    // Nor does it outlive the program.
    let (preview, file) = opened();
    let id = preview.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    wait_until("the end", || !file.exists());
}

fn the_private_file_opens_the_page(browser: &Browser) {
    let (preview, file) = opened();
    browser.open(&format!("file://{}", file.display()));
    browser.wait("document.querySelector('#source .cm-line')");
    browser.wait("document.body.dataset.state === 'drawn'");
    assert!(!file.exists());
    drop(preview);
}

fn a_pipe_in_place_of_the_scene_is_not_read() {
    let preview = Preview::of("scene.ron", SCENE);
    let scene = preview.folder().join("scene.ron");
    let mut version = 1;
    let pipe = |scene: &Path| {
        assert!(
            Command::new("mkfifo")
                .arg(scene)
                .status()
                .unwrap()
                .success()
        );
    };
    let endless = |scene: &Path| symlink("/dev/zero", scene).unwrap();
    let long = |scene: &Path| fs::File::create(scene).unwrap().set_len(3 << 30).unwrap();
    let others: [&dyn Fn(&Path); 3] = [&pipe, &endless, &long];
    for other in others {
        fs::remove_file(&scene).unwrap();
        other(&scene);
        assert_eq!(insert(&preview, version, "// mine"), 200);
        version += 1;
        let save = format!(r#"{{"version": {version}}}"#);
        assert_eq!(post(&preview, "/save", &save), 409);
        assert_eq!(post(&preview, "/reload", "{}"), 409);
        let overwrite = format!(r#"{{"version": {version}, "overwrite": true}}"#);
        assert_eq!(post(&preview, "/save", &overwrite), 500);
        let disk = authorized(Request::get("/disk"), &preview).send(preview.port());
        assert_eq!(status(&disk), 404);
        fs::remove_file(&scene).unwrap();
        assert_eq!(post(&preview, "/save", &overwrite), 200);
    }
    assert_eq!(
        preview.on_disk(),
        format!("{}{SCENE}", "// mine\n".repeat(3))
    );
    let status = fs::read_to_string(format!("/proc/{}/status", preview.id())).unwrap();
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .unwrap();
    let peak: u64 = peak.trim().trim_end_matches(" kB").parse().unwrap();
    assert!(peak < 400_000, "{peak} KiB");
}

fn of_two_that_save_at_once_none_loses_an_edit() {
    for _ in 0..10 {
        let one = Preview::of("scene.ron", SCENE);
        let scene = one.folder().join("scene.ron");
        let other = Preview::start(
            TempDir::new().unwrap(),
            scene,
            &["--port", "0", "--no-open"],
        );
        assert_eq!(insert(&one, 1, "// one"), 200);
        assert_eq!(insert(&other, 1, "// other"), 200);
        let answers = thread::scope(|scope| {
            let save = |preview| scope.spawn(move || post(preview, "/save", r#"{"version": 2}"#));
            [save(&one), save(&other)].map(|saved| saved.join().unwrap())
        });
        let text = one.on_disk();
        match answers {
            [200, 409] => assert_eq!(text, format!("// one\n{SCENE}")),
            [409, 200] => assert_eq!(text, format!("// other\n{SCENE}")),
            answers => panic!("{answers:?}: {text}"),
        }
    }
}

fn a_link_on_the_way_is_followed() {
    let folder = TempDir::new().unwrap();
    for name in ["v1", "v2", "v3"] {
        fs::create_dir(folder.path().join(name)).unwrap();
        fs::write(folder.path().join(name).join("s.ron"), SCENE).unwrap();
    }
    let (new, link) = (folder.path().join("new"), folder.path().join("cur"));
    let point = |name: &str| {
        symlink(name, &new).unwrap();
        fs::rename(&new, &link).unwrap();
    };
    point("v1");
    let write = |preview: &Preview, name: &str, line: &str| {
        let scene = preview.folder().join(name).join("s.ron");
        fs::write(scene, format!("// {line}\n{SCENE}")).unwrap();
    };
    let scene = link.join("s.ron");
    let preview = Preview::start(folder, scene, &["--port", "0", "--no-open"]);
    for name in ["v2", "v3"] {
        // The new file has the same text at first, so only its later changes are seen.
        let before = text(&preview);
        let link = preview.folder().join("cur/s.ron");
        let same = fs::read(&link).unwrap();
        fs::write(preview.folder().join(name).join("s.ron"), same).unwrap();
        point(name);
        // Written again and again: the link may not have been noticed yet.
        let mut count = 0;
        wait_until("the new text", || {
            count += 1;
            write(&preview, name, &format!("{name} {count}"));
            thread::sleep(Duration::from_millis(50));
            text(&preview) != before
        });
        write(&preview, name, &format!("last of {name}"));
        wait_until("the last text", || {
            text(&preview).contains(&format!("last of {name}"))
        });
    }
}
