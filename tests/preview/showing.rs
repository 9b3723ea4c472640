//! The picture, and the choices of what it shows.

use std::process::Command;

use super::{
    PageTest,
    browser::{Browser, key},
    preview::{Page, Preview, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, PageTest)] = tests![
    the_page_shows_the_picture_of_the_scene,
    cameras_layers_and_exposure,
    zoom_shows_exact_pixels,
    fit_is_as_sharp_as_the_panel,
    a_timeline_with_play,
    a_slow_picture_is_coarse_first,
    the_last_picture_stays_until_a_whole_one,
    an_edit_that_changes_no_picture_draws_nothing,
    a_picture_is_stale_after_a_pause,
    a_depth_has_the_range_of_what_is_bounded,
    the_picture_is_downloaded,
];

/// A scene with two cameras and light.
const LIT: &str = r##"(
    image: (width: 64, height: 48),
    camera: Perspective(eye: (0, 0, 5), look_at: (0, 0, 0), fov: 60),
    cameras: {"far": Perspective(eye: (0, 0, 50), look_at: (0, 0, 0), fov: 60)},
    lights: [Ambient(color: "#ffffff", intensity: 0.5)],
    geometries: [Sphere(center: (0, 0, 0), radius: 2, color: "#ff0000")],
)
"##;

/// A scene with a sphere that moves from left to right in ten frames.
const MOVING: &str = r##"(
    image: (width: 60, height: 20),
    camera: Orthographic(eye: (0, 0, 5), gaze: (0, 0, -1), scale: 2),
    background: "#000000",
    geometries: [Sphere(center: (-2.5, 0, 0), radius: 0.5, color: "#ff0000", name: "ball")],
    animation: (frames: 11, fps: 20, tracks: {
        "geometries.ball.center": [(0, (-2.5, 0, 0)), (0.5, (2.5, 0, 0))],
    }),
)
"##;

fn the_page_shows_the_picture_of_the_scene(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    assert_eq!(page.state(), "drawn");
    assert!(page.revision() >= 1);
    assert_eq!(page.source(), SCENE);
    let size = "(image => `${image.naturalWidth}x${image.naturalHeight}`)(picture)";
    assert_eq!(page.text(size), "64x48");
    assert_eq!(page.color("picture", (22, 24)), [255, 0, 0, 255]);
    assert_eq!(page.color("picture", (41, 24)), [0, 255, 0, 255]);
    assert_eq!(page.color("picture", (0, 0)), [16, 32, 48, 255]);
    let alt = page.text("picture.alt");
    assert!(alt.contains("scene.ron") && alt.contains("64"), "{alt}");
    assert_eq!(page.text("count.textContent"), "No problems");
    assert!(page.text("document.title").contains("scene.ron"));
    page.shot("wide-light");
}

fn cameras_layers_and_exposure(browser: &Browser) {
    let page = Page::of(browser, LIT);
    let half = page.color("picture", (32, 24));
    let change = |what: &dyn Fn()| {
        let before = page.text("picture.src");
        what();
        page.wait(&format!(
            "picture.src !== '{before}' && document.body.dataset.state === 'drawn'"
        ));
    };
    change(&|| page.choose("#camera", "far"));
    assert_eq!(page.color("picture", (22, 24)), [0, 0, 0, 255]);
    assert_eq!(page.color("picture", (32, 24)), half);
    change(&|| page.set("#exposure", "1"));
    assert_eq!(page.color("picture", (32, 24)), [255, 0, 0, 255]);
    change(&|| page.choose("#camera", ""));
    change(&|| page.choose("#layer", "normal"));
    let [r, g, b, _] = page.color("picture", (32, 24));
    assert!(
        b > 250 && r.abs_diff(127) < 12 && g.abs_diff(127) < 12,
        "{r} {g} {b}"
    );
    for layer in ["depth", "id", "albedo", "specular", "direct"] {
        change(&|| page.choose("#layer", layer));
    }
    // The light of surfaces is all light here; it is shown with the exposure.
    assert_eq!(page.color("picture", (32, 24)), [255, 0, 0, 255]);
    // More samples.
    page.choose("#layer", "color");
    change(&|| page.choose("#samples", "16"));
    // The choices survive a save.
    page.and_draw(|| page.preview.write(&LIT.replace("#ff0000", "#0000ff")));
    assert_eq!(page.text("samples.value"), "16");
}

fn zoom_shows_exact_pixels(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.choose("#zoom", "8");
    let [_, _, width, height] = page.rectangle("#picture");
    assert_eq!((width, height), (512.0, 384.0));
    assert_eq!(page.style("#picture", "imageRendering"), "pixelated");
    page.choose("#zoom", "32");
    assert_eq!(page.rectangle("#picture")[2], 2048.0);
    // The pixel under the mouse stays where it is.
    page.choose("#zoom", "8");
    let at = page.at((22, 24));
    page.point(at);
    page.wait("readout.textContent.includes('22, 23 (y from the bottom)')");
    page.wheel(at, -100);
    page.wait("zoom.value === '16'");
    let after = page.at((22, 24));
    assert!(
        (after.0 - at.0).abs() < 20.0 && (after.1 - at.1).abs() < 20.0,
        "{at:?} {after:?}"
    );
    page.call("document.getElementById('frame').focus()", &[]);
    page.keys("0");
    page.wait("zoom.value === '0'");
    let [_, _, width, _] = page.rectangle("#frame");
    assert!(page.rectangle("#picture")[2] <= width);
    // A scaled picture has no hard pixels.
    assert_eq!(page.style("#picture", "imageRendering"), "auto");
}

fn fit_is_as_sharp_as_the_panel(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.wait("!sharp.hidden");
    page.shot("sharp");
    // At least a pixel for each of the screen, in squares that each are a pixel of the scene.
    let factor = page.number("sharp.naturalWidth") / 64.0;
    assert_eq!(factor.fract(), 0.0);
    assert_eq!(page.number("sharp.naturalHeight"), factor * 48.0);
    let place = page.rectangle("#picture");
    assert_eq!(page.rectangle("#sharp"), place);
    let ratio = page.number("devicePixelRatio");
    assert!(factor * 64.0 >= place[2] * ratio && (factor - 1.0) * 64.0 < place[2] * ratio);
    // The scene's own picture is the one that is read and saved.
    assert_eq!(page.number("picture.naturalWidth"), 64.0);
    for (x, y) in [(22, 24), (41, 24), (0, 0), (63, 47), (14, 24)] {
        page.point(page.at((x, y)));
        let read = format!("pixel {x}, {} (y from the bottom)", 47 - y);
        page.wait(&format!("readout.textContent.startsWith('{read}')"));
        let [r, g, b, _] = page.color("picture", (x, y));
        let color = page.text("readout.textContent");
        assert!(color.contains(&format!("({r}, {g}, {b})")), "{color}");
        let printed = Command::new(env!("CARGO_BIN_EXE_strahl"))
            .args(["pixel", "scene.ron", &format!("{x},{}", 47 - y)])
            .current_dir(page.preview.folder())
            .output()
            .unwrap();
        let printed = String::from_utf8(printed.stdout).unwrap();
        assert!(printed.contains(&format!("({r}, {g}, {b})")), "{printed}");
    }
    // A fixed zoom shows the pixels of the scene.
    page.choose("#zoom", "4");
    assert!(page.is("sharp.hidden"));
    page.choose("#zoom", "0");
    page.wait("!sharp.hidden");
    // Another scene hides the last one.
    page.and_draw(|| page.retype("#ff0000", "#0000ff"));
    let middle = (22.0 + 0.5) * factor;
    page.wait_for("the new picture", || {
        !page.is("sharp.hidden")
            && page.color("sharp", (middle as u32, (24.5 * factor) as u32)) == [0, 0, 255, 255]
    });
    assert_eq!(page.color("picture", (22, 24)), [0, 0, 255, 255]);
}

fn a_timeline_with_play(browser: &Browser) {
    let page = Page::of(browser, MOVING);
    assert_eq!(page.color("picture", (5, 10)), [255, 0, 0, 255]);
    // The last frame, by the keyboard.
    page.call("time.focus()", &[]);
    page.keys(&key::END.to_string());
    page.wait_for("the last frame", || {
        page.color("picture", (54, 10)) == [255, 0, 0, 255]
    });
    assert!(
        page.text("document.getElementById('frame-number').textContent")
            .contains("10")
    );
    page.click("#play");
    page.wait("play.getAttribute('aria-pressed') === 'true'");
    let script = "const [done] = arguments, seen = new Set();
        const look = () => {
            seen.add(document.getElementById('time').value);
            if (seen.size > 6) done(seen.size); else requestAnimationFrame(look);
        };
        look();";
    assert!(page.call_async(script, &[]).as_u64().unwrap() > 6);
    page.click("#play");
    page.wait("play.getAttribute('aria-pressed') === 'false'");
    // Fewer frames: the frame is one of them.
    page.keys(&key::END.to_string());
    page.and_draw(|| {
        page.preview.write(
            &MOVING
                .replace("frames: 11", "frames: 5")
                .replace("(0.5,", "(0.2,"),
        );
    });
    assert!(page.number("Number(time.max)") == 4.0 && page.number("Number(time.value)") <= 4.0);
    page.and_draw(|| page.preview.write(SCENE));
    assert!(page.is("timeline.hidden"));
}

fn a_slow_picture_is_coarse_first(browser: &Browser) {
    let text = SCENE.replace(
        "width: 64, height: 48",
        "width: 2000, height: 1500, samples: 16",
    );
    let preview = Preview::of("scene.ron", &text);
    let page = browser.with_script(SIZES, || Page::open(browser, preview));
    page.wait("sizes.length >= 3");
    assert_eq!(page.value("sizes"), serde_json::json!([500, 2000, 2000]));
}

/// Notes the widths of the pictures that are shown.
const SIZES: &str = "window.sizes = []; document.addEventListener('load', event => {
        if (event.target.id === 'picture') window.sizes.push(event.target.naturalWidth);
    }, true);";

fn the_last_picture_stays_until_a_whole_one(browser: &Browser) {
    let text = SCENE.replace(
        "width: 64, height: 48",
        "width: 2000, height: 1500, samples: 16",
    );
    let preview = Preview::of("scene.ron", &text);
    let page = browser.with_script(SIZES, || Page::open(browser, preview));
    page.wait("document.body.dataset.state === 'drawn'");
    page.call("sizes.length = 0", &[]);
    page.and_draw(|| page.retype("#ff0000", "#0000ff"));
    page.wait("sizes.length > 0");
    let sizes = page.value("sizes");
    let sizes = sizes.as_array().unwrap();
    assert!(sizes.iter().all(|width| width == 2000), "{sizes:?}");
}

fn an_edit_that_changes_no_picture_draws_nothing(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    let pictures = "performance.getEntriesByType('resource')
        .filter(entry => entry.name.includes('/picture?')).length";
    let before = (page.number(pictures), page.text("picture.src"));
    page.cursor_before("// small");
    page.and_draw(|| page.keys("/* quite */"));
    page.retype("right", "other");
    page.wait("saved.textContent === 'unsaved'");
    // What is found is where it is now, and has its new name.
    page.click_at(page.at((41, 24)));
    page.wait("readout.textContent.includes('other')");
    page.wait_for("the line", || page.cursor_line() == 9);
    assert_eq!((page.number(pictures), page.text("picture.src")), before);
    page.and_draw(|| page.retype("#ff0000", "#0000ff"));
    assert_eq!(page.color("picture", (22, 24)), [0, 0, 255, 255]);
}

fn a_picture_is_stale_after_a_pause(browser: &Browser) {
    // The pause of half a second ends when the test says so.
    let script = "window.pauses = new Map(); const wait = setTimeout, forget = clearTimeout;
        window.setTimeout = (run, after, ...more) => {
            if (after !== 500) return wait(run, after, ...more);
            const id = -1 - window.pauses.size; window.pauses.set(id, run); return id;
        };
        window.clearTimeout = id => id < 0 ? window.pauses.delete(id) : forget(id);";
    let page = browser.with_script(script, || Page::of(browser, SCENE));
    let is_marked = "getComputedStyle(document.getElementById('stale')).display !== 'none'";
    page.cursor_before("0.8, color: \"#ff0000\"");
    page.and_reach("broken", || page.keys("x"));
    assert!(!page.is(is_marked) && page.style("#picture", "filter") == "none");
    // Each key starts the pause again.
    page.and_reach("broken", || page.keys("y"));
    assert_eq!(page.number("pauses.size"), 1.0);
    page.call("for (const run of pauses.values()) run()", &[]);
    page.wait(is_marked);
    assert_ne!(page.style("#picture", "filter"), "none");
    page.keys(&key::BACKSPACE.to_string());
    page.and_draw(|| page.keys(&key::BACKSPACE.to_string()));
    assert!(!page.is(is_marked) && page.style("#picture", "filter") == "none");
}

fn a_depth_has_the_range_of_what_is_bounded(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    let before = page.text("picture.src");
    page.choose("#layer", "depth");
    page.wait(&format!(
        "picture.src !== '{before}' && document.body.dataset.state === 'drawn'"
    ));
    let [near, ..] = page.color("picture", (24, 24));
    let [far, ..] = page.color("picture", (16, 24));
    assert!(near < 64 && far > near + 64, "{near} {far}");
}

fn the_picture_is_downloaded(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    assert_eq!(page.text("download.download"), "scene.png");
    let script = "const [done] = arguments;
        fetch(download.href).catch(error => done(String(error)));
        const image = new Image();
        image.onload = () => done(`${image.naturalWidth}x${image.naturalHeight}`);
        image.src = download.href;";
    // A fetch of its own picture is outside of the policy of the page; showing it is not.
    let _ = page.call_async(script, &[]);
    assert!(
        page.console_errors()
            .iter()
            .all(|error| error.contains("blob:"))
    );
    let folder = page.preview.folder().join("downloads");
    page.dev_tools(
        "Browser.setDownloadBehavior",
        &serde_json::json!({"behavior": "allow", "downloadPath": folder}),
    );
    page.click("#download");
    let file = folder.join("scene.png");
    page.wait_for("the download", || file.exists());
    let mine = image::open(&file).unwrap().to_rgb8();
    assert_eq!(mine.dimensions(), (64, 48));
    assert_eq!(mine.get_pixel(22, 24).0, [255, 0, 0]);
}
