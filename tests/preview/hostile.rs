//! The server against requests that it must not meet. No browser is needed.

use std::{
    fs,
    net::{SocketAddr, TcpStream},
    process::Command,
    time::Duration,
};

use super::{
    http::{Answer, Request},
    preview::{Preview, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, fn())] = tests![
    only_this_machine_is_served,
    every_route_needs_the_token,
    another_host_is_refused,
    other_pages_are_refused,
    every_answer_has_the_headers,
    the_page_allows_no_inline_code,
    nothing_else_is_served,
    nothing_else_is_written,
    the_first_free_port,
    a_taken_port_and_standard_input,
];

/// The source of the routes, from which the list of them is derived.
const ROUTES: &str = include_str!("../../src/cli/preview/routes.rs");

/// Returns the method and the path of every route.
fn routes() -> Vec<(String, String)> {
    let routes = ROUTES.lines().filter_map(|line| {
        let route = line.trim().strip_prefix(".route(\"")?;
        let (path, handler) = route.split_once("\", ")?;
        let (method, _) = handler.split_once('(')?;
        Some((method.to_uppercase(), path.replace("{id}", "1")))
    });
    let routes: Vec<_> = routes.collect();
    assert!(routes.len() > 15, "{routes:?}");
    assert_eq!(routes.len(), ROUTES.matches(".route(").count());
    routes
}

fn preview() -> Preview {
    Preview::of("scene.ron", SCENE)
}

fn request((method, path): &(String, String)) -> Request {
    let request = Request::new(method, path);
    match &**method {
        "POST" => request.body(r#"{"version": 1, "edits": [], "overwrite": true}"#),
        _ => request,
    }
}

fn with_token(request: Request, preview: &Preview) -> Request {
    request.header("Authorization", &format!("Bearer {}", preview.token()))
}

fn assert_refused(answer: &Answer, what: &str) {
    assert_eq!(answer.status, 403, "{what}: {}", answer.text());
    let text = answer.text();
    assert!(
        !text.contains("Sphere") && !text.contains("<html"),
        "{what}: {text}"
    );
}

fn only_this_machine_is_served() {
    let preview = preview();
    assert!(
        preview.url.starts_with("http://127.0.0.1:"),
        "{}",
        preview.url
    );
    assert!(preview.token().len() >= 32);
    // The addresses of this machine that others can reach.
    let others = fs::read_to_string("/proc/net/fib_trie").unwrap_or_default();
    let others = others.lines().filter_map(|line| {
        let address: std::net::Ipv4Addr = line.split("-- ").nth(1)?.trim().parse().ok()?;
        (!address.is_loopback() && !address.is_unspecified()).then_some(address)
    });
    for address in others {
        let address = SocketAddr::from((address, preview.port()));
        let connected = TcpStream::connect_timeout(&address, Duration::from_millis(300));
        assert!(connected.is_err(), "{address}");
    }
    // Two previews have two tokens.
    let other = Preview::of("scene.ron", SCENE);
    assert_ne!(preview.token(), other.token());
}

fn every_route_needs_the_token() {
    let preview = preview();
    let wrong = "0".repeat(preview.token().len());
    for route in routes() {
        let port = preview.port();
        let what = format!("{route:?}");
        let (_, path) = &route;
        assert_refused(&request(&route).send(port), &what);
        for value in [
            format!("Bearer {wrong}"),
            "Bearer ".to_owned(),
            preview.token().to_owned(),
        ] {
            let guess = request(&route).header("Authorization", &value);
            assert_refused(&guess.send(port), &what);
        }
        let (method, _) = &route;
        for query in [
            format!("token={wrong}"),
            "token=".to_owned(),
            format!("token={}x", preview.token()),
        ] {
            let guess = request(&(method.clone(), format!("{path}?{query}")));
            assert_refused(&guess.send(port), &what);
        }
        if path != "/events" {
            let answer = with_token(request(&route), &preview).send(port);
            assert_ne!(answer.status, 403, "{what}: {}", answer.text());
        }
    }
    // A part of the program is nobody's secret.
    for path in ["/page.js", "/page.css", "/icon.svg", "/events.js"] {
        assert_eq!(
            Request::get(path).send(preview.port()).status,
            200,
            "{path}"
        );
    }
}

fn another_host_is_refused() {
    let preview = preview();
    let port = preview.port();
    for host in [
        "evil.example".to_owned(),
        format!("evil.example:{port}"),
        format!("127.0.0.1.evil.example:{port}"),
        format!("localhost.evil.example:{port}"),
        "127.0.0.1".to_owned(),
        format!("127.0.0.1:{}", port.wrapping_add(1)),
        String::new(),
    ] {
        for route in routes()
            .into_iter()
            .chain([("GET".into(), "/page.js".into())])
        {
            let answer = with_token(request(&route).header("Host", &host), &preview).send(port);
            assert_refused(&answer, &format!("{host} {route:?}"));
        }
    }
    let localhost = Request::get("/text").header("Host", &format!("localhost:{port}"));
    assert_eq!(with_token(localhost, &preview).send(port).status, 200);
}

fn other_pages_are_refused() {
    let preview = preview();
    let port = preview.port();
    let same = format!("http://127.0.0.1:{port}");
    for (name, value) in [
        ("Origin", "http://evil.example".to_owned()),
        ("Origin", "null".to_owned()),
        ("Origin", format!("https://127.0.0.1:{port}")),
        (
            "Origin",
            format!("http://127.0.0.1:{}", port.wrapping_add(1)),
        ),
        ("Origin", format!("http://localhost:{port}")),
        ("Sec-Fetch-Site", "cross-site".to_owned()),
        ("Sec-Fetch-Site", "same-site".to_owned()),
        ("Sec-Fetch-Site", "\u{e9}".to_owned()),
    ] {
        for route in routes() {
            let answer = with_token(request(&route).header(name, &value), &preview).send(port);
            assert_refused(&answer, &format!("{name} {value} {route:?}"));
        }
    }
    for (name, value) in [
        ("Origin", &*same),
        ("Sec-Fetch-Site", "same-origin"),
        ("Sec-Fetch-Site", "none"),
    ] {
        let answer = with_token(Request::get("/text").header(name, value), &preview).send(port);
        assert_eq!(answer.status, 200, "{name} {value}");
    }
    // No answer allows another origin to read it.
    let asked = Request::new("OPTIONS", "/text")
        .header("Origin", "http://evil.example")
        .header("Access-Control-Request-Method", "GET");
    let answer = asked.send(port);
    assert_eq!(answer.header("access-control-allow-origin"), None);
    assert_refused(&answer, "preflight");
}

fn every_answer_has_the_headers() {
    let preview = preview();
    let known = routes();
    let others = [
        ("GET", "/page.js"),
        ("GET", "/events.js"),
        ("GET", "/page.css"),
        ("GET", "/icon.svg"),
        ("GET", "/nothing"),
        ("POST", "/nothing"),
        ("DELETE", "/text"),
        ("OPTIONS", "/save"),
        ("POST", "/text"),
        ("GET", "/save"),
        ("GET", "/picture?revision=x"),
        ("GET", "/reference/%FF"),
        ("GET", "/why?x=99999&y=99999&revision=1"),
    ];
    let others = others.map(|(method, path)| (method.to_owned(), path.to_owned()));
    for route in known.into_iter().chain(others) {
        for request in [request(&route), with_token(request(&route), &preview)] {
            let answer = Answer::head(&mut request.connect(preview.port()));
            for (name, value) in [
                ("cache-control", "no-store"),
                ("x-content-type-options", "nosniff"),
                ("x-frame-options", "DENY"),
                ("referrer-policy", "no-referrer"),
                ("cross-origin-resource-policy", "same-origin"),
            ] {
                assert_eq!(answer.header(name), Some(value), "{name} {route:?}");
            }
            let policy = answer.header("content-security-policy").unwrap();
            assert!(policy.starts_with("default-src 'none'"), "{policy}");
            assert!(policy.contains("frame-ancestors 'none'"), "{policy}");
            assert!(!policy.contains("unsafe"), "{policy}");
        }
    }
}

fn the_page_allows_no_inline_code() {
    let preview = preview();
    let page = || with_token(Request::get("/"), &preview).send(preview.port());
    let (one, other) = (page(), page());
    let policy = |answer: &Answer| answer.header("content-security-policy").unwrap().to_owned();
    let scripts = policy(&one);
    let scripts = scripts
        .split("; ")
        .find(|part| part.starts_with("script-src"));
    assert_eq!(scripts, Some("script-src 'self'"));
    // The nonce of the styles is another one each time.
    assert_ne!(policy(&one), policy(&other));
    let html = one.text();
    assert!(!html.contains("<style") && !html.contains(" style=") && !html.contains(" onclick="));
    assert_eq!(html.matches("<script").count(), 1);
    assert!(
        !html.contains("http:") && !html.contains("https:"),
        "everything is in the program"
    );
}

fn nothing_else_is_served() {
    let preview = preview();
    fs::write(preview.folder().join("secret.txt"), "SECRET").unwrap();
    fs::write(preview.folder().join("page.js"), "SECRET").unwrap();
    for path in [
        "/secret.txt",
        "/scene.ron",
        "/../secret.txt",
        "/./secret.txt",
        "/%2e%2e/secret.txt",
        "/..%2fsecret.txt",
        "/page.js/../secret.txt",
        "/page.js/../../etc/passwd",
        "//etc/passwd",
        "/etc/passwd",
        "/reference/..%2f..%2fetc%2fpasswd",
        "/reference/secret.txt",
        "/disk?path=secret.txt",
        "/text?file=secret.txt",
        "/page.js",
        "/Cargo.toml",
        "/index.html",
        "/page.js.map",
    ] {
        let answer = with_token(Request::get(path), &preview).send(preview.port());
        let text = answer.text();
        assert!(
            !text.contains("SECRET") && !text.contains("root:x:"),
            "{path}: {text}"
        );
    }
    // A table outside of the folder of the scene is not read.
    let text = SCENE.replace(
        "Plane(",
        "Spheres(file: \"../../etc/passwd\", radius: 1, color: \"#fff\"), Plane(",
    );
    let other = Preview::of("scene.ron", &text);
    let events = with_token(Request::get("/text"), &other).send(other.port());
    assert_eq!(events.status, 200);
    assert!(!events.text().contains("root:"));
}

fn nothing_else_is_written() {
    let preview = preview();
    let other = preview.folder().join("other.ron");
    fs::write(&other, "mine").unwrap();
    let edits = r#"{"version": 1, "edits": [{"from": {"line": 1, "column": 1},
        "to": {"line": 1, "column": 1}, "text": "// new\n"}]}"#;
    let post = |path: &str, body: &str| {
        with_token(Request::post(path).body(body), &preview).send(preview.port())
    };
    assert_eq!(post("/edits", edits).status, 200);
    assert_eq!(preview.on_disk(), SCENE);
    for body in [
        r#"{"version": 2, "path": "other.ron", "file": "other.ron", "overwrite": true}"#,
        r#"{"version": 2, "path": "../x", "overwrite": true}"#,
    ] {
        for path in [
            "/save",
            "/save?path=other.ron",
            "/save/other.ron",
            "/save/../other.ron",
        ] {
            post(path, body);
        }
    }
    assert_eq!(preview.on_disk(), format!("// new\n{SCENE}"));
    assert_eq!(fs::read_to_string(&other).unwrap(), "mine");
    let mut names: Vec<_> = fs::read_dir(preview.folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    names.sort();
    assert_eq!(names, ["other.ron", "scene.ron"]);
    // A body that is not what a page sends changes nothing.
    for body in [
        "",
        "[]",
        "{",
        r#"{"version": -1}"#,
        r#"{"version": 7, "edits": [{"from": 1}]}"#,
    ] {
        for path in ["/edits", "/save", "/format", "/move"] {
            let answer = post(path, body);
            let is_refused = answer.header("x-strahl-refused").is_some();
            assert!(
                is_refused || (400..500).contains(&answer.status),
                "{path} {body}: {}",
                answer.status
            );
        }
    }
    // As a form of another page would send it.
    let form = Request::post("/save").header("Content-Type", "text/plain");
    assert!(with_token(form, &preview).send(preview.port()).status >= 400);
}

fn the_first_free_port() {
    let one = Preview::with("scene.ron", SCENE, &["--no-open"]);
    let other = Preview::with("scene.ron", SCENE, &["--no-open"]);
    assert!(one.port() >= 8017 && other.port() > one.port());
}

fn a_taken_port_and_standard_input() {
    let preview = preview();
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_strahl"))
            .arg("preview")
            .args(arguments)
            .current_dir(preview.folder())
            .output()
            .unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
            output.stdout,
        )
    };
    let port = preview.port().to_string();
    let (code, message, output) = run(&["scene.ron", "--no-open", "--port", &port]);
    assert!(
        code == Some(2) && message.contains(&port) && output.is_empty(),
        "{code:?} {message}"
    );
    let (code, message, _) = run(&["-", "--no-open"]);
    assert!(
        code == Some(2) && message.contains("standard input"),
        "{code:?} {message}"
    );
    let (code, message, _) = run(&["missing.ron", "--no-open"]);
    assert!(
        code != Some(0) && message.contains("missing.ron"),
        "{code:?} {message}"
    );
}
