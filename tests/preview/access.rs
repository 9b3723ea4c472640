//! The page for everybody: keyboard, screen readers, small screens, light and dark.

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde_json::Value;

use super::{
    PageTest,
    browser::{Browser, key},
    preview::{Page, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, PageTest)] = tests![
    the_keyboard_reaches_every_control,
    the_keyboard_alone_is_enough,
    a_telephone_shows_all,
    a_telephone_shows_the_picture_above_the_diagnostics,
    the_keys_are_on_the_page,
    a_finger_finds_a_geometry,
    light_and_dark,
];

pub(crate) const AXE_TESTS: &[(&str, PageTest)] = tests![
    axe_finds_nothing_in_light,
    axe_finds_nothing_in_dark,
    axe_finds_nothing_at_360_pixels
];

/// A scene that shows every control: cameras, light, animation.
const EVERYTHING: &str = r##"(
    image: (width: 64, height: 48),
    camera: Perspective(eye: (0, 0, 5), look_at: (0, 0, 0), fov: 60),
    cameras: {"far": Perspective(eye: (0, 0, 50), look_at: (0, 0, 0), fov: 60)},
    lights: [Ambient(color: "#ffffff", intensity: 0.9)],
    geometries: [Sphere(center: (0, 0, 0), radius: 2, color: "#ff0000", name: "ball")], // a comment
    animation: (frames: 5, fps: 5, tracks: {"geometries.ball.radius": [(0, 2), (1, 1)]}),
)
"##;

/// The script of axe-core, which `npm ci` installs.
pub(crate) fn axe() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("src/cli/preview/page/node_modules/axe-core/axe.min.js")
}

/// Fails if axe finds something serious or critical.
fn assert_accessible(page: &Page, what: &str) {
    page.call(&fs::read_to_string(axe()).unwrap(), &[]);
    let script = "const done = arguments[arguments.length - 1];
        axe.run(document, {resultTypes: ['violations']}).then(found => done(found.violations
            .filter(fault => ['serious', 'critical'].includes(fault.impact))
            .map(fault => [fault.id, fault.help, fault.nodes.map(node => node.html)])),
            error => done([String(error)]));";
    let faults = page.call_async(script, &[]);
    assert_eq!(faults, Value::Array(Vec::new()), "{what}");
}

/// Lets axe look at the page in each of its states.
fn assert_all_accessible(browser: &Browser, name: &str) {
    let page = Page::of(browser, EVERYTHING);
    page.wait("document.querySelector('#source .swatch')");
    assert_accessible(&page, "drawn");
    page.click("#parts summary");
    page.wait("document.querySelector('.part')");
    page.shot(&format!("{name}-parts"));
    assert_accessible(&page, "parts");
    page.click("#parts summary");
    page.click("#show-keys");
    assert_accessible(&page, "keys");
    page.keys(&key::ESCAPE.to_string());
    page.call("picture.scrollIntoView({block: 'center'})", &[]);
    page.click_at(page.at((32, 24)));
    page.wait("readout.textContent.includes('ball')");
    page.call("picture.scrollIntoView({block: 'center'})", &[]);
    page.shot(&format!("{name}-everything"));
    assert_accessible(&page, "a pixel");
    page.click("#why");
    page.wait("document.getElementById('why-dialog').open");
    assert_accessible(&page, "why");
    page.keys(&key::ESCAPE.to_string());
    let white = page.preview.folder().join("white.png");
    image::RgbImage::new(64, 48).save(&white).unwrap();
    page.upload("#compare-file", &white);
    page.wait("comparison.textContent.includes('differ')");
    assert_accessible(&page, "wipe");
    page.and_draw(|| page.retype("#ff0000", "#0000ff"));
    page.preview.write(&EVERYTHING.replace("fps: 5", "fps: 6"));
    page.wait("!conflict.hidden");
    assert_accessible(&page, "conflict");
    page.click("#show-both");
    page.wait("document.getElementById('both-dialog').open");
    assert_accessible(&page, "both");
    page.keys(&key::ESCAPE.to_string());
    page.click("#keep-mine");
    page.wait("conflict.hidden");
    let broken = EVERYTHING.replace("radius: 2, color", "raduis: 2, color");
    page.and_reach("broken", || page.preview.write(&broken));
    page.wait("document.querySelector('#source .cm-lintRange-error')");
    page.shot(&format!("{name}-broken"));
    assert_accessible(&page, "broken");
    page.cursor_before("        Sphere".trim_start());
    page.chord(&[key::CONTROL], " ");
    page.wait("document.querySelector('.cm-tooltip-autocomplete')");
    assert_accessible(&page, "completion");
}

fn axe_finds_nothing_in_light(browser: &Browser) {
    assert_all_accessible(browser, "light");
}

fn axe_finds_nothing_in_dark(browser: &Browser) {
    browser.emulate_dark(true);
    assert_all_accessible(browser, "dark");
}

fn axe_finds_nothing_at_360_pixels(browser: &Browser) {
    browser.emulate_width(Some(360));
    assert_all_accessible(browser, "360");
}

fn the_keyboard_reaches_every_control(browser: &Browser) {
    let page = Page::of(
        browser,
        &EVERYTHING.replace("radius: 2, color", "raduis: 2, color"),
    );
    page.and_draw(|| page.click("#diagnostics .fix"));
    page.wait("document.querySelector('#source .swatch')");
    page.click_at(page.at((32, 24)));
    page.wait("!why.disabled");
    page.call("document.activeElement.blur()", &[]);
    for _ in 0..60 {
        page.keys(&key::TAB.to_string());
        page.call("document.activeElement.dataset.reached = ''", &[]);
    }
    let script = "return [...document.querySelectorAll(
            'button, select, input, a[href], .cm-content, [tabindex=\"0\"]')]
        .filter(control => control.checkVisibility() && !control.disabled)
        .filter(control => control.type !== 'radio' || control.checked)
        .filter(control => !('reached' in control.dataset))
        .map(control => control.outerHTML.slice(0, 200))";
    assert_eq!(page.call(script, &[]), Value::Array(Vec::new()));
}

/// Presses Tab until an element has the focus.
fn tab_to(page: &Page, css: &str) {
    for _ in 0..60 {
        if page.is(&format!("document.activeElement.matches('{css}')")) {
            return;
        }
        page.keys(&key::TAB.to_string());
    }
    panic!("{css} is out of reach");
}

fn the_keyboard_alone_is_enough(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    // The pixel of a geometry, and its place in the text.
    tab_to(&page, "#frame");
    page.keys(&key::RIGHT.to_string().repeat(9));
    page.wait("readout.textContent.includes('right')");
    assert_eq!(page.text("readout.getAttribute('aria-live')"), "polite");
    page.keys(&key::ENTER.to_string());
    page.wait_for("the line", || page.cursor_line() == 9);
    page.shot("keyboard");
    page.keys("w");
    page.wait("document.getElementById('why-dialog').open");
    page.keys(&key::ESCAPE.to_string());
    // The camera.
    page.call("document.activeElement.blur()", &[]);
    tab_to(&page, "input[name=tool]");
    page.keys(&key::RIGHT.to_string());
    assert!(page.is("document.querySelector('input[value=camera]').checked"));
    tab_to(&page, "#frame");
    page.and_draw(|| page.keys(&key::LEFT.to_string()));
    assert_ne!(page.source(), SCENE);
    // The text, and the file.
    tab_to(&page, ".cm-content");
    page.chord(&[key::CONTROL], &key::HOME.to_string());
    page.and_draw(|| page.keys("\n"));
    page.chord(&[key::CONTROL], "s");
    page.wait("saved.textContent === ''");
    assert_eq!(page.preview.on_disk(), page.source());
    // Out of the editor again.
    tab_to(&page, "body, #save");
    // A fault, and its fix.
    let broken = SCENE.replace(
        "radius: 0.8, color: \"#ff0000\"",
        "raduis: 0.8, color: \"#ff0000\"",
    );
    page.and_reach("broken", || page.preview.write(&broken));
    tab_to(&page, ".problem");
    page.keys(&key::ENTER.to_string());
    assert_eq!(page.cursor_line(), 8);
    tab_to(&page, ".fix");
    page.and_draw(|| page.keys(" "));
    assert_eq!(page.source(), SCENE);
}

fn assert_no_sideways_scroll(page: &Page) {
    let width = page.number("document.documentElement.scrollWidth");
    let wide = page.value(
        "[...document.body.querySelectorAll('*')].filter(element =>
            element.checkVisibility() && !element.closest('.cm-scroller') &&
            element.getBoundingClientRect().right > innerWidth + 1 &&
            getComputedStyle(element).position !== 'absolute')
        .map(element => element.outerHTML.slice(0, 120))",
    );
    assert!(width <= 360.0, "{width}: {wide:#}");
}

fn a_telephone_shows_all(browser: &Browser) {
    browser.emulate_width(Some(360));
    let page = Page::of(browser, EVERYTHING);
    assert_eq!(page.number("innerWidth"), 360.0);
    page.shot("360-top");
    assert_no_sideways_scroll(&page);
    for css in ["#picture", "#source", "#diagnostics", "#timeline", "#save"] {
        let [left, _, width, _] = page.rectangle(css);
        assert!(left >= 0.0 && left + width <= 360.0, "{css}");
    }
    let broken = EVERYTHING.replace("radius: 2, color", "raduis: 2, color");
    page.and_reach("broken", || page.preview.write(&broken));
    assert_no_sideways_scroll(&page);
    page.call("scrollTo(0, 10000)", &[]);
    page.shot("360-bottom");
}

fn a_telephone_shows_the_picture_above_the_diagnostics(browser: &Browser) {
    browser.emulate_width(Some(360));
    let page = Page::of(browser, EVERYTHING);
    let broken = EVERYTHING.replace("radius: 2, color", "raduis: 2, color");
    page.and_reach("broken", || page.preview.write(&broken));
    for css in ["#picture", "#save", "#count", "#diagnostics .place"] {
        let [_, top, _, height] = page.rectangle(css);
        assert!(
            top >= 0.0 && top + height <= 740.0,
            "{css}: {top} + {height}"
        );
    }
    let [_, _, _, height] = page.rectangle("#source");
    assert!(height > 90.0, "{height}");
}

fn the_keys_are_on_the_page(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.click("#show-keys");
    page.wait("document.getElementById('keys-dialog').open");
    page.shot("keys");
    let keys = page.text("document.getElementById('keys-dialog').textContent");
    // All of the table of the manual, and of the hint on the picture.
    let manual = include_str!("../../docs/preview.md");
    let (_, table) = manual.split_once("| key | purpose |").unwrap();
    let rows = table
        .lines()
        .skip(2)
        .map_while(|line| line.strip_prefix("| "));
    for row in rows {
        let (key, _) = row.split_once(" |").unwrap();
        assert!(keys.contains(key), "{key}: {keys}");
    }
    page.keys(&key::ESCAPE.to_string());
    page.wait("!document.getElementById('keys-dialog').open");
    page.call("document.getElementById('frame').focus()", &[]);
    page.keys("?");
    page.wait("document.getElementById('keys-dialog').open");
    page.keys(&key::ESCAPE.to_string());
    for (key, tool) in [("c", "camera"), ("m", "move"), ("i", "inspect")] {
        page.call("document.getElementById('frame').focus()", &[]);
        page.keys(key);
        assert!(page.is(&format!(
            "document.querySelector('input[value={tool}]').checked"
        )));
    }
}

fn a_finger_finds_a_geometry(browser: &Browser) {
    browser.emulate_width(Some(360));
    let page = Page::of(browser, SCENE);
    page.touch(&[&[page.at((41, 24))]]);
    page.wait("readout.textContent.includes('right')");
    page.wait_for("the line", || page.cursor_line() == 9);
}

fn light_and_dark(browser: &Browser) {
    // The lightness of a color of the form rgb(r, g, b).
    let lightness = |page: &Page, css: &str, property: &str| -> u32 {
        let color = page.style(css, property);
        let numbers = color.split(|c: char| !c.is_ascii_digit());
        numbers
            .filter_map(|part| part.parse::<u32>().ok())
            .take(3)
            .sum()
    };
    for is_dark in [false, true] {
        browser.emulate_dark(is_dark);
        let page = Page::of(browser, SCENE);
        let back = lightness(&page, "body", "backgroundColor");
        let text = lightness(&page, "body", "color");
        let editor = lightness(&page, "#source", "backgroundColor");
        assert_eq!(back < 200, is_dark, "{back}");
        assert_eq!(text > 500, is_dark, "{text}");
        assert_eq!(editor < 200, is_dark, "{editor}");
        page.shot(if is_dark { "wide-dark" } else { "wide-light" });
    }
}
