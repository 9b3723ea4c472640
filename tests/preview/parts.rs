//! The list of the parts of a scene.

use super::{
    PageTest,
    browser::Browser,
    preview::{Page, Preview, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, PageTest)] = tests![
    a_part_is_found_hidden_and_shown,
    parts_are_added,
    a_json_scene_hides_nothing,
];

const RED: [u8; 4] = [255, 0, 0, 255];

fn open(page: &Page) {
    page.click("#parts summary");
    page.wait("document.querySelectorAll('#part-lists section').length === 3");
}

fn a_part_is_found_hidden_and_shown(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    open(&page);
    page.shot("parts");
    let names = "[...document.querySelectorAll('.part')].map(part => part.textContent)";
    let expected = [
        "camera Perspective",
        "[0] Sphere",
        "right Sphere",
        "[2] Plane",
    ];
    page.wait_for("the parts", || {
        page.value(names) == serde_json::json!(expected)
    });
    page.click("#part-lists li:nth-child(2) .part");
    page.wait_for("the line", || page.cursor_line() == 9);
    page.wait("!outline.hidden && outline.dataset.geometry === 'geometries[1]'");
    // Hidden in a comment, which a save keeps.
    page.and_draw(|| page.click("[aria-label='Hide [0] Sphere']"));
    assert_ne!(page.color("picture", (22, 24)), RED);
    let hidden =
        "/* hidden: Sphere(center: (-1, 0, 0), radius: 0.8, color: \"#ff0000\"), */ // left";
    assert!(page.source().contains(hidden), "{}", page.source());
    page.wait("document.querySelector('.hidden-part')");
    page.and_draw(|| page.click("[aria-label^='Show']"));
    assert_eq!(page.source(), SCENE);
    assert_eq!(page.color("picture", (22, 24)), RED);
    page.wait("!document.querySelector('.hidden-part')");
}

fn parts_are_added(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    open(&page);
    page.and_draw(|| page.choose("[aria-label='Add to lights']", "Ambient"));
    assert!(
        page.source().contains("lights: [Ambient("),
        "{}",
        page.source()
    );
    page.wait("document.querySelectorAll('.part').length === 5");
    page.and_draw(|| page.choose("[aria-label='Add to geometries']", "Box"));
    page.wait("document.querySelectorAll('.part').length === 6");
    page.and_draw(|| page.choose("[aria-label='Add to cameras']", "Fit"));
    page.wait("document.querySelectorAll('.part').length === 7");
    // A click on a camera shows its picture.
    let before = page.text("picture.src");
    page.click("[aria-label='Cameras'] li:nth-child(2) .part");
    page.wait(&format!(
        "camera.value === 'camera 1' && picture.src !== '{before}' && document.body.dataset.state === 'drawn'"
    ));
    page.and_draw(|| page.click("#undo"));
}

fn a_json_scene_hides_nothing(browser: &Browser) {
    let json = r##"{
    "camera": {"Fit": {}},
    "geometries": [{"Sphere": {"center": [-1, 0, 0], "radius": 0.8, "color": "#ff0000"}}]
}
"##;
    let page = Page::open(browser, Preview::of("scene.json", json));
    open(&page);
    page.and_draw(|| page.choose("[aria-label='Add to geometries']", "Box"));
    page.wait("document.querySelectorAll('.part').length === 3");
    let hide = "document.querySelectorAll('[aria-label^=Hide]')";
    let says_why = "button => button.disabled && button.title.includes('JSON has no comments')";
    assert!(page.is(&format!(
        "{hide}.length === 2 && [...{hide}].every({says_why})"
    )));
}
