//! The pictures of the manual, made by `STRAHL_SHOTS=FOLDER cargo test --test preview pictures`.

use super::{
    browser::{Browser, key},
    preview::{Page, Preview},
};

/// The scene of the README, lit, without the part that the film shows being written.
const SCENE: &str = r##"(
    image: (width: 640, height: 480, samples: 16),
    camera: Perspective(
        eye: (0, 0.8, 2), // a little above the floor
        look_at: (0, 0.6, -4),
        fov: 40,
    ),
    background: "#ffb703",
    lights: [Ambient(), Point(position: (3, 5, 0), intensity: 30)],
    geometries: [
        Plane(point: (0, 0, 0), normal: (0, 1, 0), color: "#023047"),
        Sphere(center: (0, 0, -4), radius: 1.5, color: "#fb8500"),
    ],
)
"##;

/// Takes a picture of the page, and those of a film in which a sphere is written and saved.
pub(crate) fn pictures_of_the_manual(browser: &Browser) {
    let page = Page::open(browser, Preview::of("first.ron", SCENE));
    page.cursor_before("Sphere(center: (0, 0, -4)");
    page.wait("!outline.hidden");
    page.shot("page");

    let mut frames = 0;
    let mut shot = || {
        frames += 1;
        page.shot(&format!("save-{frames:02}"));
    };
    page.cursor_before("    ],\n)");
    shot();
    // The editor closes brackets and quotes by itself.
    for (keys, waits_for) in [
        ("        Sphere", "true"),
        ("(center: (1.5, 0.7, -2.6", "true"),
        (
            &format!("{}, radius: 0.7, color: \"#8ecae6", key::RIGHT),
            "true",
        ),
        (
            &format!("{}{},\n", key::RIGHT, key::RIGHT),
            "document.body.dataset.state === 'drawn' && saved.textContent === 'unsaved'",
        ),
    ] {
        page.keys(&key::ESCAPE.to_string());
        page.keys(keys);
        page.wait(waits_for);
        std::thread::sleep(std::time::Duration::from_millis(400));
        shot();
    }
    page.chord(&[key::CONTROL], "s");
    page.wait("document.body.dataset.state === 'drawn' && saved.textContent === ''");
    shot();
}
