//! A hostile page of another origin in the same browser, and hostile texts in the page itself.

use std::{
    io::{Read, Write},
    net::{Ipv4Addr, TcpListener},
    thread,
};

use super::{
    PageTest,
    browser::Browser,
    preview::{Page, Preview, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, PageTest)] = tests![
    a_page_of_another_origin_gets_nothing,
    texts_of_a_scene_never_become_html,
];

/// Serves a page to anybody, until the program ends.
fn serve(html: String) -> u16 {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let port = listener.local_addr().unwrap().port();
    thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let _ = stream.read(&mut [0; 4096]);
            let length = html.len();
            let _ = write!(
                stream,
                "HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nContent-Length: {length}\r\n\
                 Connection: close\r\n\r\n{html}"
            );
        }
    });
    port
}

fn a_page_of_another_origin_gets_nothing(browser: &Browser) {
    let preview = Preview::of("scene.ron", SCENE);
    let (target, token) = (
        format!("http://127.0.0.1:{}", preview.port()),
        preview.token(),
    );
    // It even knows the token, as if somebody had given it away.
    let html = r##"<!doctype html><title>evil</title><form id=form method=post target=sink
        enctype="text/plain"><input name='{"version":1,"overwrite":true,"x":"' value='"}'></form>
        <iframe name=sink></iframe><script>
        window.results = {};
        const target = "TARGET", token = "TOKEN";
        const note = (name, promise) => promise.then(
            value => results[name] = value, error => results[name] = "failed");
        const headers = {Authorization: "Bearer " + token};
        const read = async (path, init) => "read " + (await (await fetch(target + path, init)).text());
        note("fetch", read("/text?token=" + token));
        note("header", read("/text", {headers}));
        note("opaque", fetch(target + "/text?token=" + token, {mode: "no-cors"})
            .then(answer => answer.type + answer.status));
        note("post", read("/save?token=" + token, {method: "POST",
            body: '{"version":1,"overwrite":true}'}));
        note("json", read("/edits", {method: "POST", headers: {...headers,
            "Content-Type": "application/json"}, body: '{"version":1,"edits":[]}'}));
        const load = (tag, path) => new Promise((done, fail) => {
            const element = document.createElement(tag);
            element.onload = () => done("loaded");
            element.onerror = fail;
            element[tag === "link" ? "href" : "src"] = target + path;
            if (tag === "link") element.rel = "stylesheet";
            document.head.append(element);
        });
        note("img", load("img", "/picture?revision=1&token=" + token));
        note("icon", load("img", "/icon.svg"));
        note("script", load("script", "/page.js"));
        note("style", load("link", "/page.css"));
        note("events", new Promise((done, fail) => {
            const events = new EventSource(target + "/events?token=" + token);
            events.onmessage = () => done("message");
            events.onerror = () => { events.close(); fail(); };
        }));
        note("socket", new Promise((done, fail) => {
            const socket = new WebSocket(target.replace("http", "ws") + "/events?token=" + token);
            socket.onopen = () => done("open");
            socket.onerror = fail;
        }));
        note("worker", new Promise((done, fail) => {
            const worker = new SharedWorker(target + "/events.js?token=" + token);
            worker.port.onmessage = () => done("message");
            worker.onerror = fail;
        }));
        const frame = document.createElement("iframe");
        frame.src = target + "/?token=" + token;
        document.documentElement.append(frame);
        note("frame", new Promise(done => frame.onload = () => {
            try { done("inside " + frame.contentDocument.body.innerHTML.length) }
            catch { done("failed") }
        }));
        form.action = target + "/save?token=" + token;
        form.submit();
        </script>"##;
    let html = html.replace("TARGET", &target).replace("TOKEN", token);
    for host in ["127.0.0.1", "localhost"] {
        browser.open(&format!("http://{host}:{}/", serve(html.clone())));
        browser.wait("Object.keys(results).length === 13");
        let results = browser.value("results");
        for (name, result) in results.as_object().unwrap() {
            let is_kept = match &**name {
                // Without any content or status.
                "opaque" => ["failed", "opaque0"].contains(&result.as_str().unwrap()),
                _ => result == "failed",
            };
            assert!(is_kept, "{host} {name}: {result}");
        }
    }
    // The console of that page has it all.
    browser.open("about:blank");
    assert!(!browser.console_errors().is_empty());
    // Nothing has been changed, and the page itself still works.
    assert_eq!(preview.on_disk(), SCENE);
    let page = Page::open(browser, preview);
    assert_eq!(page.source(), SCENE);
    assert_eq!(page.text("saved.textContent"), "");
}

fn texts_of_a_scene_never_become_html(browser: &Browser) {
    let attack =
        "<img src=x onerror='window.hacked=1'><script>window.hacked=1</script><b class=attack>";
    let text = SCENE
        .replace("name: \"right\"", &format!("name: \"{attack}\""))
        .replace("// left", &format!("// {attack}"));
    let preview = Preview::of("<b class=attack>&amp;.ron", &text);
    let page = Page::open(browser, preview);
    assert_eq!(page.state(), "drawn");
    page.click_at(page.at((41, 24)));
    page.wait("readout.textContent.includes('onerror')");
    page.click("#why");
    page.wait("document.getElementById('why-text').textContent.includes('onerror')");
    page.click("#why-dialog form button:last-child");
    // In names of cameras, and in messages with their fixes.
    let camera = "Perspective(eye: (0, 0, 5), look_at: (0, 0, 0), fov: 60)";
    let faulty = text.replace(
        "background:",
        &format!("cameras: {{\"{attack}\": {camera}}}, \"{attack}\": 1, background:"),
    );
    page.and_reach("broken", || page.preview.write(&faulty));
    assert!(page.is("diagnostics.textContent.includes('onerror')"));
    page.and_draw(|| page.preview.write(&text));
    page.and_reach("broken", || {
        page.preview.write(&text.replace(
            "background: \"#102030\"",
            &format!("background: \"{attack}\""),
        ));
    });
    // As a file that is compared.
    let file = page.preview.folder().join("x.png");
    std::fs::write(&file, attack).unwrap();
    page.upload("#compare-file", &file);
    page.wait("comparison.textContent !== ''");
    assert_eq!(
        page.number("document.querySelectorAll('.attack, img[src=x]').length"),
        0.0
    );
    assert!(!page.is("window.hacked"));
}
