//! From the picture to the text, and back.

use super::{
    PageTest,
    browser::{Browser, key},
    preview::{Page, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, PageTest)] = tests![
    a_click_on_a_geometry_finds_its_line,
    the_cursor_outlines_its_geometry,
    the_pixel_under_the_mouse_is_read,
    a_pixel_is_explained,
];

const LEFT: (u32, u32) = (22, 24);
const RIGHT: (u32, u32) = (41, 24);
const PLANE: (u32, u32) = (32, 45);

fn a_click_on_a_geometry_finds_its_line(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    for (pixel, line, start) in [
        (RIGHT, 9, "Sphere(center: (1,"),
        (LEFT, 8, "Sphere(center: (-1,"),
        (PLANE, 10, "Plane("),
    ] {
        page.click_at(page.at(pixel));
        page.wait_for("the line", || page.cursor_line() == line);
        let mark = "[...document.querySelectorAll('#source .found')]";
        let mark = format!("{mark}.map(mark => mark.textContent).join('')");
        page.wait_for("the mark", || page.text(&mark).starts_with(start));
    }
}

fn the_cursor_outlines_its_geometry(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    for (text, index, inside, outside) in [
        ("radius: 0.8, color: \"#00ff00\"", "1", RIGHT, LEFT),
        ("(-1, 0, 0)", "0", LEFT, RIGHT),
    ] {
        page.cursor_before(text);
        page.wait(&format!(
            "!outline.hidden && outline.dataset.geometry === 'geometries[{index}]'"
        ));
        assert_eq!(page.style("#outline", "visibility"), "visible");
        // The edge is around the geometry: nothing in its middle, something at its side.
        assert_eq!(page.color("outline", inside)[3], 0);
        let edge = (inside.0.saturating_sub(9)..inside.0)
            .filter(|x| page.color("outline", (*x, inside.1))[3] == 255)
            .count();
        assert!((1..4).contains(&edge), "{edge}");
        let other = (outside.0 - 3..outside.0 + 3)
            .filter(|x| page.color("outline", (*x, outside.1))[3] == 255)
            .count();
        assert_eq!(other, 0);
        assert_eq!(page.rectangle("#outline"), page.rectangle("#picture"));
    }
    page.cursor_before("image:");
    page.wait("outline.hidden");
}

fn the_pixel_under_the_mouse_is_read(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.point(page.at(RIGHT));
    page.wait("readout.textContent.includes('right')");
    let text = page.text("readout.textContent");
    for part in [
        "41, 24",
        "#00ff00",
        "0, 255, 0",
        "sphere",
        "[1]",
        "depth",
        "position (",
        "normal (",
    ] {
        let text = text.to_lowercase();
        assert!(text.contains(part), "{part}: {text}");
    }
    page.point(page.at((0, 0)));
    page.wait("readout.textContent.includes('background')");
    assert!(page.text("readout.textContent").contains("#102030"));
}

fn a_pixel_is_explained(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.click_at(page.at(RIGHT));
    page.wait("!why.disabled");
    page.click("#why");
    page.wait("document.getElementById('why-dialog').open");
    let text = page.text("document.getElementById('why-text').textContent");
    page.shot("why");
    // The words of `strahl pixel`.
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_strahl"))
        .args(["pixel", "scene.ron", "--from-top", "41,24"])
        .current_dir(page.preview.folder())
        .output()
        .unwrap();
    assert_eq!(text, String::from_utf8(output.stdout).unwrap());
    page.keys(&key::ESCAPE.to_string());
    page.wait("!document.getElementById('why-dialog').open");
}
