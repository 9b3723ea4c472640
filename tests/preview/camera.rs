//! Cameras and geometries that follow the hand.

use std::f64::consts::PI;

use super::{
    PageTest,
    browser::{Browser, key},
    preview::{Page, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, PageTest)] = tests![
    orbit_by_the_mouse,
    orbit_pan_and_dolly_by_keys,
    orbit_and_pinch_by_touch,
    wheel_and_shift,
    a_geometry_is_dragged,
    a_geometry_is_moved_by_keys,
    what_an_animation_moves_is_explained,
    the_pixel_is_read_again_after_a_movement,
    everything_is_framed,
];

fn tool(page: &Page, name: &str) {
    page.click(&format!("#tools input[value={name}]"));
}

/// Returns the three numbers behind a name in a text.
fn vector(text: &str, before: &str) -> Vec<f64> {
    let (_, rest) = text.split_once(before).unwrap();
    let rest = rest.replace("/* far */", "");
    let (inner, _) = rest.trim_start_matches(['(', ' ']).split_once(')').unwrap();
    inner
        .split(',')
        .map(|number| number.trim().parse().unwrap())
        .collect()
}

/// Returns the text without the numbers of the camera.
fn around(text: &str) -> String {
    let (start, rest) = text.split_once("eye: (").unwrap();
    let (eye, rest) = rest
        .split_once("), // keep me\n        look_at: (")
        .unwrap();
    let (target, end) = rest.split_once("), fov").unwrap();
    let is_number = |c: char| c.is_ascii_digit() || "-.e".contains(c);
    let layout = |text: &str| text.replace(is_number, "");
    let (eye, target) = (layout(&eye.replace("/* far */", "@")), layout(target));
    format!("{start}|{eye}|{target}|{end}")
}

fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn orbit_by_the_mouse(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    tool(&page, "camera");
    let (x, y) = page.at((32, 24));
    page.and_draw(|| page.drag(&[(x, y), (x + 30.0, y + 5.0), (x + 80.0, y + 10.0)]));
    page.wait_for("the numbers", || page.source() != SCENE);
    let text = page.source();
    assert_eq!(around(&text), around(SCENE));
    let eye = vector(&text, "eye: ");
    assert!(eye[0] < -0.5 && eye[1] > 0.05, "{eye:?}");
    assert!((length(&eye) - 5.0).abs() < 0.01, "{eye:?}");
    assert_eq!(vector(&text, "look_at: "), [0.0; 3]);
    assert_eq!(page.preview.on_disk(), SCENE);
    page.and_draw(|| page.click("#undo"));
    assert_eq!(page.source(), SCENE);
}

fn orbit_pan_and_dolly_by_keys(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    tool(&page, "camera");
    page.call("document.getElementById('frame').focus()", &[]);
    page.and_draw(|| page.keys(&key::RIGHT.to_string().repeat(3)));
    let eye = vector(&page.source(), "eye: ");
    // Fifteen degrees.
    let expected = [-5.0 * libm::sin(PI / 12.0), 0.0, 5.0 * libm::cos(PI / 12.0)];
    let distance: Vec<_> = eye
        .iter()
        .zip(expected)
        .map(|(one, other)| one - other)
        .collect();
    assert!(length(&distance) < 0.01, "{eye:?}");
    page.and_draw(|| page.keys("+"));
    let nearer = vector(&page.source(), "eye: ");
    assert!(length(&nearer) < 4.9, "{nearer:?}");
    page.and_draw(|| page.chord(&[key::SHIFT], &key::UP.to_string()));
    let target = vector(&page.source(), "look_at: ");
    assert!(target[1] < -0.01, "{target:?}");
    assert_eq!(around(&page.source()), around(SCENE));
}

fn orbit_and_pinch_by_touch(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    tool(&page, "camera");
    let (x, y) = page.at((32, 24));
    page.and_draw(|| page.touch(&[&[(x, y), (x + 30.0, y), (x + 60.0, y)]]));
    let eye = vector(&page.source(), "eye: ");
    assert!(eye[0] < -0.5, "{eye:?}");
    assert!((length(&eye) - 5.0).abs() < 0.01, "{eye:?}");
    page.and_draw(|| {
        page.touch(&[
            &[(x - 20.0, y), (x - 40.0, y), (x - 60.0, y), (x - 80.0, y)],
            &[(x + 20.0, y), (x + 40.0, y), (x + 60.0, y), (x + 80.0, y)],
        ]);
    });
    let eye = vector(&page.source(), "eye: ");
    let target = vector(&page.source(), "look_at: ");
    let between: Vec<_> = eye
        .iter()
        .zip(target)
        .map(|(one, other)| one - other)
        .collect();
    assert!(length(&between) < 3.0, "{between:?}");
    assert_eq!(around(&page.source()), around(SCENE));
    // A finger finds a geometry.
    tool(&page, "inspect");
    page.touch(&[&[page.at((10, 24))]]);
    page.wait_for("the line of the left sphere", || page.cursor_line() == 8);
}

fn wheel_and_shift(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    tool(&page, "camera");
    let at = page.at((32, 24));
    page.and_draw(|| page.wheel(at, -100));
    let eye = vector(&page.source(), "eye: ");
    assert!(eye[2] < 4.9 && eye[2] > 3.0, "{eye:?}");
}

fn a_geometry_is_dragged(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    tool(&page, "move");
    let (x, y) = page.at((22, 24));
    let [_, _, width, _] = page.rectangle("#picture");
    let pixels = 10.0 * width / 64.0;
    page.and_draw(|| {
        page.drag(&[
            (x, y),
            (x + pixels / 2.0, y),
            (x + pixels, y),
            (x + pixels, y),
        ]);
    });
    // Ten pixels of the 48 that are 2·5·tan 30° high.
    let expected = -1.0 + 10.0 * 10.0 * libm::tan(PI / 6.0) / 48.0;
    page.wait_for("the whole way", || {
        let center = vector(&page.source(), "Sphere(center: ");
        (center[0] - expected).abs() < 0.05
    });
    let center = vector(&page.source(), "Sphere(center: ");
    assert_eq!(&center[1..], [0.0, 0.0]);
    let (start, rest) = SCENE.split_once("Sphere(center: (-1").unwrap();
    let text = page.source();
    assert!(text.starts_with(start) && text.ends_with(rest), "{text}");
    page.wait("document.body.dataset.state === 'drawn'");
    // Another one, without a click before.
    let (x, y) = page.at((44, 24));
    page.and_draw(|| page.drag(&[(x, y), (x, y - pixels / 2.0), (x, y - pixels)]));
    page.wait_for("the other", || {
        let (_, second) = page
            .source()
            .split_once("// left")
            .map(|(a, b)| (a.to_owned(), b.to_owned()))
            .unwrap();
        vector(&second, "Sphere(center: ")[1] > 0.9
    });
    assert_eq!(vector(&page.source(), "Sphere(center: ")[1], 0.0);
}

fn a_geometry_is_moved_by_keys(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.call("document.getElementById('frame').focus()", &[]);
    // The cross hair starts in the middle.
    page.keys(&key::LEFT.to_string().repeat(10));
    page.wait("readout.textContent.includes('sphere geometries[0]')");
    page.keys(&key::ENTER.to_string());
    page.wait_for("the line", || page.cursor_line() == 8);
    tool(&page, "move");
    page.call("document.getElementById('frame').focus()", &[]);
    page.and_draw(|| page.keys(&key::RIGHT.to_string()));
    let center = vector(&page.source(), "Sphere(center: ");
    assert!(center[0] > -0.95 && center[0] < -0.8, "{center:?}");
}

fn what_an_animation_moves_is_explained(browser: &Browser) {
    let text = SCENE.replace(
        "],\n)",
        "],\n    animation: (frames: 3, fps: 2, tracks: {\"camera.eye\": [(0, (1, 0, 5)), (1, (2, 0, 5))]}),\n)",
    );
    let page = Page::of(browser, &text);
    tool(&page, "camera");
    let (x, y) = page.at((32, 24));
    page.drag(&[(x, y), (x + 30.0, y), (x + 60.0, y)]);
    page.wait("connection.textContent.includes('animation')");
    page.wait("document.body.dataset.state === 'drawn'");
    assert_eq!(page.source(), text);
}

fn the_pixel_is_read_again_after_a_movement(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    let (x, y) = page.at((22, 24));
    let [_, _, width, _] = page.rectangle("#picture");
    let pixels = width / 64.0;
    tool(&page, "move");
    let end = (x + 4.0 * pixels, y);
    page.and_draw(|| page.drag(&[(x, y), (x + 2.0 * pixels, y), end, end]));
    page.wait("readout.textContent.includes('pixel 26, 23 ')");
    page.wait("readout.textContent.includes('geometries[0]')");
    page.point((x + 5.0 * pixels, y));
    tool(&page, "camera");
    // The camera comes nearer, and the sphere with it.
    let at = page.at((14, 24));
    page.point(at);
    page.wait("readout.textContent.includes('geometries[2]')");
    page.and_draw(|| {
        for _ in 0..10 {
            page.wheel(at, -100);
        }
    });
    page.wait("readout.textContent.includes('geometries[0]')");
    // A sphere that turns away from the mouse.
    let at = page.at((22, 24));
    page.point(at);
    page.and_draw(|| page.drag(&[at, (at.0 + 60.0, at.1), (at.0 + 120.0, at.1)]));
    page.wait_for("the pixel at the end", || {
        let column = ((at.0 + 120.0 - page.rectangle("#picture")[0]) / pixels).floor();
        page.text("readout.textContent")
            .contains(&format!("pixel {column}, 23 "))
    });
}

fn everything_is_framed(browser: &Browser) {
    let away = SCENE.replace("look_at: (0, 0,0)", "look_at: (0, 0,9)");
    let away = away.replace(
        "        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: (0.5, 0.5, 0.5)),\n",
        "",
    );
    let page = Page::of(browser, &away);
    page.wait("document.querySelector('[data-code=nothing-visible]')");
    page.and_draw(|| page.click("[data-code=nothing-visible] .fix"));
    page.wait("count.textContent === 'No problems'");
    let text = page.source();
    assert_eq!(
        around(&text).replace('-', ""),
        around(&away).replace('-', "")
    );
    let red = (0..64).filter(|x| page.color("picture", (*x, 24)) == [255, 0, 0, 255]);
    assert!((15..32).contains(&red.count()));
    // From any other place, also by the button and the key.
    for how in ["#frame-all", ""] {
        page.click("#save");
        page.wait("saved.textContent === ''");
        let far = SCENE.replace("eye: (0, 0", "eye: (0, 99");
        page.and_draw(|| page.preview.write(&far));
        page.and_draw(|| match how {
            "" => {
                page.call("document.getElementById('frame').focus()", &[]);
                page.keys("f");
            }
            button => page.click(button),
        });
        let colors: Vec<_> = (0..64).map(|x| page.color("picture", (x, 24))).collect();
        assert!(colors.contains(&[255, 0, 0, 255]) && colors.contains(&[0, 255, 0, 255]));
    }
    // Undone in one step.
    page.and_draw(|| page.click("#undo"));
    assert!(page.source().contains("eye: (0, 99"));
}
