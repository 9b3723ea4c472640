//! The editor.

use super::{
    PageTest,
    browser::{Browser, key},
    preview::{Page, Preview, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, PageTest)] = tests![
    typing_is_drawn,
    a_fix_is_one_click,
    undo_and_redo,
    the_text_is_formatted,
    completion_offers_what_the_schema_knows,
    completion_in_a_broken_text,
    docs_under_the_mouse,
    a_color_opens_a_picker,
    ron_and_json_are_highlighted,
    line_ends_and_marks_survive,
];

fn typing_is_drawn(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.cursor_before("0.8, color: \"#ff0000\"");
    page.and_draw(|| page.keys("1"));
    page.wait_for("the larger sphere", || {
        page.color("picture", (2, 24)) == [255, 0, 0, 255]
    });
    // Broken and whole again.
    page.and_reach("broken", || page.keys("x"));
    page.and_draw(|| page.keys(&key::BACKSPACE.to_string()));
    assert_eq!(page.preview.on_disk(), SCENE);
}

fn a_fix_is_one_click(browser: &Browser) {
    let broken = SCENE.replace(
        "radius: 0.8, color: \"#ff0000\"",
        "raduis: 0.8, color: \"#ff0000\"",
    );
    let page = Page::of(browser, &broken);
    assert_eq!(page.state(), "broken");
    page.and_draw(|| page.click("#diagnostics .fix"));
    assert_eq!(page.source(), SCENE);
    assert_eq!(page.preview.on_disk(), broken);
    // By the keyboard, at the place itself.
    page.and_reach("broken", || page.click("#undo"));
    page.cursor_before("raduis");
    page.and_draw(|| page.chord(&[key::CONTROL], "."));
    assert_eq!(page.source(), SCENE);
    // In the tooltip of the squiggle.
    page.and_reach("broken", || page.click("#undo"));
    page.wait("document.querySelector('#source .cm-lintRange-error')");
    let [left, top, width, height] = page.rectangle("#source .cm-lintRange-error");
    page.point((left + width / 2.0, top + height / 2.0));
    page.wait("document.querySelector('.cm-tooltip .cm-diagnosticAction')");
    page.shot("squiggle");
    page.and_draw(|| page.click(".cm-tooltip .cm-diagnosticAction"));
    assert_eq!(page.source(), SCENE);
}

fn undo_and_redo(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.and_draw(|| page.retype("#ff0000", "#0000ff"));
    let blue = page.source();
    page.and_draw(|| page.click("#undo"));
    page.wait_for("the text as it was", || {
        page.click("#undo");
        page.source() == SCENE
    });
    page.wait("saved.textContent === ''");
    page.focus_editor();
    page.wait_for("the text again", || {
        page.chord(&[key::CONTROL], "y");
        page.source() == blue
    });
}

fn the_text_is_formatted(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.and_draw(|| page.click("#format"));
    page.wait("source.textContent.includes('look_at: (0, 0, 0)')");
    let formatted = page.source();
    page.click("#save");
    page.wait("saved.textContent === ''");
    let check = std::process::Command::new(env!("CARGO_BIN_EXE_strahl"))
        .args(["fmt", "--check", "scene.ron"])
        .current_dir(page.preview.folder())
        .status();
    assert!(check.unwrap().success(), "{formatted}");
    for comment in ["// small", "/* far */", "// keep me", "// left"] {
        assert!(formatted.contains(comment), "{formatted}");
    }
    page.and_draw(|| page.click("#undo"));
    assert_eq!(page.source(), SCENE);
}

const LABELS: &str = "[...document.querySelectorAll('.cm-tooltip-autocomplete .cm-completionLabel')]\
                      .map(label => label.textContent)";

fn labels(page: &Page) -> Vec<String> {
    serde_json::from_value(page.value(LABELS)).unwrap()
}

fn completion_offers_what_the_schema_knows(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.cursor_before("        Plane(");
    page.keys("Sph");
    page.wait_for("completions", || labels(&page) == ["Sphere", "Spheres"]);
    page.wait("document.querySelector('.cm-completionInfo')");
    page.shot("completion");
    let docs = page.text("document.querySelector('.cm-completionInfo').textContent");
    assert!(docs.to_lowercase().contains("sphere"), "{docs}");
    // Completion waits a moment before it takes keys.
    std::thread::sleep(std::time::Duration::from_millis(200));
    page.keys(&key::ENTER.to_string());
    page.wait("/Sphere\\(center: .*\\) +Plane\\(/.test(source.textContent)");
    page.wait("!document.querySelector('.cm-tooltip-autocomplete')");

    // All fields, on demand.
    page.cursor_before("image:");
    page.chord(&[key::CONTROL], " ");
    page.wait_for("fields", || {
        labels(&page).iter().any(|label| label == "lights")
    });
    // The word at the cursor is replaced.
    page.keys("out");
    page.wait_for("a field", || labels(&page) == ["outlines"]);
    std::thread::sleep(std::time::Duration::from_millis(200));
    page.keys(&key::ENTER.to_string());
    page.wait("source.textContent.includes('    outlines: (width: 64')");
}

fn completion_in_a_broken_text(browser: &Browser) {
    let text = SCENE
        .replace("fov: 60),", "")
        .replace("geometries: [", "geometries: [ (");
    let page = Page::of(browser, &text);
    assert_eq!(page.state(), "broken");
    page.cursor_before("        look_at");
    page.keys("u");
    page.wait_for("a field", || {
        labels(&page).iter().any(|label| label == "up")
    });
}

fn docs_under_the_mouse(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    let script = "const walker = document.createTreeWalker(source, NodeFilter.SHOW_TEXT);
        for (let node; (node = walker.nextNode()); ) {
            const at = node.data.indexOf('look_at');
            if (at < 0) continue;
            const range = document.createRange();
            range.setStart(node, at); range.setEnd(node, at + 7);
            const box = range.getBoundingClientRect();
            return [box.left + box.width / 2, box.top + box.height / 2];
        }";
    let at: (f64, f64) = serde_json::from_value(page.call(script, &[])).unwrap();
    page.point((at.0 - 3.0, at.1));
    page.point(at);
    page.wait("document.querySelector('.hover-docs')");
    page.shot("hover");
    let docs = page.text("document.querySelector('.hover-docs').textContent");
    assert!(docs.contains("look_at") && docs.len() > 20, "{docs}");
    // It is in the way of who types.
    page.cursor_before("// small");
    page.point((at.0 - 3.0, at.1));
    page.point(at);
    page.wait("document.querySelector('.hover-docs')");
    page.keys("a");
    page.wait("!document.querySelector('.hover-docs')");
}

fn a_color_opens_a_picker(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.wait("document.querySelectorAll('#source .swatch').length === 4");
    let values = "[...document.querySelectorAll('#source .swatch')].map(swatch => swatch.value)";
    let values = page.value(values);
    assert_eq!(values[0], "#102030");
    assert_eq!(values[1], "#ff0000");
    assert_eq!(
        page.text("document.querySelector('#source .swatch').type"),
        "color"
    );
    let label = page.text("document.querySelector('#source .swatch').ariaLabel");
    assert!(label.contains("#102030"), "{label}");
    // The picker reports colors while it is open, and the last one when it closes.
    let pick = "const swatch = document.querySelectorAll('#source .swatch')[1];
        window.picked = swatch;
        for (const color of ['#00ffff', '#0000ff']) {
            swatch.value = color;
            swatch.dispatchEvent(new Event('input', {bubbles: true}));
        }
        swatch.dispatchEvent(new Event('change', {bubbles: true}));";
    page.and_draw(|| drop(page.call(pick, &[])));
    page.wait_for("the color", || {
        page.color("picture", (22, 24)) == [0, 0, 255, 255]
    });
    assert_eq!(page.source(), SCENE.replace("#ff0000", "#0000ff"));
    // The swatch is still the same element, or an open picker would close.
    page.wait("document.querySelectorAll('#source .swatch')[1].value === '#0000ff'");
    assert!(page.is("picked.isConnected"));
    // One step back.
    page.and_draw(|| page.click("#undo"));
    assert_eq!(page.source(), SCENE);
    // A color of three numbers.
    let pick = "const swatch = document.querySelectorAll('#source .swatch')[3];
        swatch.value = '#0000ff';
        swatch.dispatchEvent(new Event('change', {bubbles: true}));";
    page.and_draw(|| drop(page.call(pick, &[])));
    assert_eq!(page.color("picture", (32, 45)), [0, 0, 255, 255]);
}

fn ron_and_json_are_highlighted(browser: &Browser) {
    let colors = "new Set([...document.querySelectorAll('#source .cm-line span')]
        .map(span => getComputedStyle(span).color)).size";
    let page = Page::of(browser, SCENE);
    page.wait(&format!("{colors} >= 5"));
    let json = r##"{
    "camera": {"Perspective": {"eye": [0, 0, 5], "look_at": [0, 0, 0], "fov": 60}},
    "image": {"width": 64, "height": 48},
    "geometries": [{"Sphere": {"center": [-1, 0, 0], "radius": 0.8, "color": "#ff0000"}}]
}
"##;
    drop(page);
    let page = Page::open(browser, Preview::of("scene.json", json));
    assert_eq!(page.state(), "drawn");
    page.wait(&format!("{colors} >= 3"));
    page.click_at(page.at((22, 24)));
    page.wait_for("the line", || page.cursor_line() == 4);
    page.and_draw(|| page.retype("#ff0000", "#0000ff"));
    page.wait_for("the color", || {
        page.color("picture", (22, 24)) == [0, 0, 255, 255]
    });
    page.click("#save");
    page.wait("saved.textContent === ''");
    assert_eq!(page.preview.on_disk(), json.replace("#ff0000", "#0000ff"));
}

fn line_ends_and_marks_survive(browser: &Browser) {
    let text = format!(
        "\u{feff}{}",
        SCENE
            .replace("// small", "// \u{1f600} ü")
            .replace('\n', "\r\n")
    );
    let page = Page::of(browser, &text);
    assert_eq!(page.state(), "drawn");
    page.and_draw(|| page.retype("#ff0000", "#0000ff"));
    page.click("#save");
    page.wait("saved.textContent === ''");
    assert_eq!(page.preview.on_disk(), text.replace("#ff0000", "#0000ff"));
}
