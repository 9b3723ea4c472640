//! Many tabs, many events, and large scenes.

use std::{
    fmt::Write as _,
    fs,
    io::{Read, Write as _},
    net::TcpStream,
    thread,
    time::{Duration, Instant},
};

use serde_json::{Value, json};

use super::{
    PageTest,
    browser::{Browser, PATIENCE},
    http::{Answer, Request},
    preview::{Page, Preview, SCENE},
    tests,
};

pub(crate) const PAGE_TESTS: &[(&str, PageTest)] = tests![
    fifty_tabs_are_served_and_let_go,
    an_hour_of_events_does_not_grow_a_tab
];

pub(crate) const TESTS: &[(&str, fn())] = tests![
    closed_streams_are_let_go,
    slow_readers_cost_nothing,
    rounds_of_paths_end_with_the_whole_picture,
    a_million_spheres_answer_while_they_are_drawn,
];

const TABS: usize = 50;

/// Returns the number of open files of a process, sockets among them.
fn open_files(preview: &Preview) -> usize {
    fs::read_dir(format!("/proc/{}/fd", preview.id()))
        .unwrap()
        .count()
}

/// Returns a number of `/proc/PID/status`: kibibytes or a count.
fn status(preview: &Preview, name: &str) -> u64 {
    let status = fs::read_to_string(format!("/proc/{}/status", preview.id())).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix(name));
    let number = line.unwrap().trim_start_matches(':').trim();
    number.split(' ').next().unwrap().parse().unwrap()
}

fn wait_until(what: &str, mut has_happened: impl FnMut() -> bool) {
    let end = Instant::now() + PATIENCE;
    while !has_happened() {
        assert!(Instant::now() < end, "waited in vain for {what}");
        thread::sleep(Duration::from_millis(10));
    }
}

fn authorized(request: Request, preview: &Preview) -> Request {
    request.header("Authorization", &format!("Bearer {}", preview.token()))
}

/// Opens a stream of events.
fn events(preview: &Preview) -> TcpStream {
    let mut stream = authorized(Request::get("/events"), preview).connect(preview.port());
    assert_eq!(Answer::head(&mut stream).status, 200);
    stream
}

/// Waits for the first state that meets a condition.
fn state_where(preview: &Preview, is_it: impl Fn(&Value) -> bool) -> Value {
    let mut stream = events(preview);
    let mut pending = Vec::new();
    loop {
        let mut bytes = [0; 65536];
        let count = stream.read(&mut bytes).unwrap();
        assert!(count > 0, "the stream has ended");
        pending.extend_from_slice(&bytes[..count]);
        let text = String::from_utf8_lossy(&pending).replace("\r\n", "\n");
        for part in text.split("data: ").skip(1) {
            let (data, _) = part.split_once("\n\n").unwrap_or_default();
            if let Ok(state) = serde_json::from_str(data)
                && is_it(&state)
            {
                return state;
            }
        }
    }
}

/// Edits the text as a page does: inserts a space at its end, or removes it again.
fn edit(preview: &Preview, version: u64) {
    let [start, end] = [1, if version.is_multiple_of(2) { 2 } else { 1 }];
    let text = if version.is_multiple_of(2) { "" } else { " " };
    let place = |column: u32| json!({"line": 1, "column": column});
    let edits = json!([{"from": place(start), "to": place(end), "text": text}]);
    let body = json!({"version": version, "edits": edits}).to_string();
    let answer = authorized(Request::post("/edits").body(&body), preview).send(preview.port());
    assert_eq!(answer.status, 200, "{}", answer.text());
}

fn fifty_tabs_are_served_and_let_go(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    let first = page.tab();
    let before = open_files(&page.preview);
    let mut tabs = Vec::new();
    for _ in 1..TABS {
        tabs.push(page.new_tab());
        page.open(&page.preview.url);
        page.wait("document.body.dataset.state === 'drawn'");
    }
    // A change reaches the first and the last one, and any of them can ask.
    let revision = page.revision();
    page.preview.write(&SCENE.replace("#ff0000", "#0000ff"));
    for tab in [&first, &tabs[TABS / 2], &tabs[TABS - 2]] {
        page.switch_to(tab);
        page.wait(&format!(
            "Number(document.body.dataset.revision) > {revision} && \
             document.body.dataset.state === 'drawn'"
        ));
        assert_eq!(page.color("picture", (22, 24)), [0, 0, 255, 255]);
    }
    for tab in &tabs {
        page.switch_to(tab);
        page.close_tab();
    }
    page.switch_to(&first);
    page.wait_for("the end of the connections", || {
        open_files(&page.preview) <= before + 6
    });
    page.and_draw(|| page.preview.write(SCENE));
    let wait_for_threads = || status(&page.preview, "Threads") < 64;
    page.wait_for("the end of the threads", wait_for_threads);
}

fn an_hour_of_events_does_not_grow_a_tab(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    let heap = || {
        page.dev_tools("HeapProfiler.collectGarbage", &json!({}));
        page.dev_tools("Runtime.getHeapUsage", &json!({}))["usedSize"]
            .as_f64()
            .unwrap()
    };
    let nodes = || page.number("document.querySelectorAll('*').length");
    let mut measured = Vec::new();
    for round in 0..3 {
        let start = 1 + round * 1000;
        for version in start..start + 1000 {
            edit(&page.preview, version);
        }
        let end = start + 1000;
        page.wait_for("the last version", || {
            let state = state_where(&page.preview, |state| state["checked"] == end);
            page.revision() == state["revision"].as_u64().unwrap() && page.state() == "drawn"
        });
        measured.push((
            heap(),
            nodes(),
            open_files(&page.preview),
            status(&page.preview, "VmRSS"),
        ));
    }
    let (_, first, last) = (measured[0], measured[1], measured[2]);
    assert!(last.0 < first.0 * 1.2 + 1e6, "{measured:?}");
    assert!(last.1 < first.1 + 20.0, "{measured:?}");
    assert!(last.2 < first.2 + 8, "{measured:?}");
    assert!(last.3 < first.3 + 16 * 1024, "{measured:?}");
}

fn closed_streams_are_let_go() {
    let preview = Preview::of("scene.ron", SCENE);
    state_where(&preview, |state| state["checked"] == 1);
    let before = open_files(&preview);
    let streams: Vec<_> = (0..TABS).map(|_| events(&preview)).collect();
    assert!(open_files(&preview) >= before + TABS - 2);
    drop(streams);
    wait_until("the end of the streams", || {
        open_files(&preview) <= before + 2
    });
}

fn slow_readers_cost_nothing() {
    let preview = Preview::of("scene.ron", SCENE);
    // They never read.
    let streams: Vec<_> = (0..TABS).map(|_| events(&preview)).collect();
    let measure = || {
        (
            status(&preview, "VmRSS"),
            status(&preview, "Threads"),
            open_files(&preview),
        )
    };
    (1..1001).for_each(|version| edit(&preview, version));
    let middle = measure();
    (1001..4001).for_each(|version| edit(&preview, version));
    state_where(&preview, |state| state["checked"] == 4001);
    let end = measure();
    assert!(end.0 < middle.0 + 16 * 1024, "{middle:?} {end:?}");
    assert!(
        end.1 <= middle.1 + 8 && end.2 <= middle.2 + 8,
        "{middle:?} {end:?}"
    );
    drop(streams);
}

fn rounds_of_paths_end_with_the_whole_picture() {
    let text = r##"(
    image: (width: 48, height: 36),
    camera: Perspective(eye: (0, 1, 5), look_at: (0, 0.5, 0), fov: 40),
    lighting: Path(samples: 6),
    lights: [Environment(color: "#fff"), Point(position: (3, 5, 0), intensity: 9, radius: 1)],
    geometries: [
        Plane(point: (0, 0, 0), normal: (0, 1, 0), color: "#888"),
        Sphere(center: (0, 0.7, 0), radius: 0.7, color: "#fb8500"),
    ],
)
"##;
    let preview = Preview::of("scene.ron", text);
    let state = state_where(&preview, |state| state["checked"] == 1);
    assert_eq!(state["scene"]["follows_paths"], true, "{state}");
    let get = |query: &str| {
        let path = format!("/picture?revision=1&{query}");
        let answer = authorized(Request::get(&path), &preview).send(preview.port());
        assert_eq!(answer.status, 200, "{query}: {}", answer.text());
        answer.body
    };
    let rounds = [1, 2, 4, 6].map(|round| get(&format!("round={round}")));
    assert!(rounds.windows(2).all(|two| two[0] != two[1]));
    assert!(rounds[3] == get("quality=full"));
    // Another view, and the same with fewer samples than are known.
    assert!(get("round=2&exposure=1") == get("quality=full&samples=2&exposure=1"));
    assert!(get("round=1&exposure=1") == get("quality=full&samples=1&exposure=1"));
    let answer = authorized(Request::get("/picture?revision=1&round=0"), &preview);
    let answer = answer.send(preview.port());
    assert!(
        answer.header("x-strahl-refused").is_some(),
        "{}",
        answer.text()
    );
}

fn a_million_spheres_answer_while_they_are_drawn() {
    let mut table = String::from("x,y,z\n");
    for index in 0..1_000_000_u32 {
        let (x, y, z) = (index % 100, index / 100 % 100, index / 10_000);
        writeln!(table, "{x},{y},-{z}").unwrap();
    }
    let folder = tempfile::TempDir::new().unwrap();
    fs::write(folder.path().join("atoms.csv"), table).unwrap();
    let text = r##"(
    image: (width: 4000, height: 4000, samples: 4096),
    camera: Perspective(eye: (50, 50, 100), look_at: (50, 50, 0), fov: 60),
    geometries: [Spheres(file: "atoms.csv", radius: 0.6, color: "#ff0000")],
)
"##;
    let scene = folder.path().join("scene.ron");
    fs::write(&scene, text).unwrap();
    let preview = Preview::start(folder, scene, &["--port", "0", "--no-open"]);
    let state = state_where(&preview, |state| state["checked"] == 1);
    assert_eq!(state["scene"]["geometries"], 1_000_000, "{state}");
    let picture = Request::get("/picture?revision=1&quality=full");
    let mut picture = authorized(picture, &preview).connect(preview.port());
    picture.flush().unwrap();
    thread::sleep(Duration::from_millis(300));
    // The next key.
    let place = |column: u32| json!({"line": 4, "column": column});
    let edits = json!([{"from": place(5), "to": place(6), "text": "x"}]);
    let body = json!({"version": 1, "edits": edits}).to_string();
    let answer = authorized(Request::post("/edits").body(&body), &preview).send(preview.port());
    assert_eq!(answer.status, 200);
    let state = state_where(&preview, |state| state["checked"] == 2);
    assert_eq!(state["diagnostics"][0]["code"], "unknown-field", "{state}");
    // The picture is still being drawn.
    picture.set_nonblocking(true).unwrap();
    let answer = picture.peek(&mut [0]);
    assert!(answer.is_err_and(|error| error.kind() == std::io::ErrorKind::WouldBlock));
}
