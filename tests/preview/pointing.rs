//! From the picture to the text, and back.

use super::{
    PageTest,
    browser::{Browser, key},
    preview::{Page, Preview, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, PageTest)] = tests![
    a_click_on_a_geometry_finds_its_line,
    the_cursor_outlines_its_geometry,
    the_pixel_under_the_mouse_is_read,
    a_pixel_is_explained,
    a_row_of_a_table_is_marked_alone,
    a_row_of_a_table_is_not_moved,
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
        "pixel 41, 23 (y from the bottom)",
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
        .args(["pixel", "scene.ron", "41,23"])
        .current_dir(page.preview.folder())
        .output()
        .unwrap();
    assert_eq!(text, String::from_utf8(output.stdout).unwrap());
    page.keys(&key::ESCAPE.to_string());
    page.wait("!document.getElementById('why-dialog').open");
}

/// Opens the page of a scene with three spheres in a table, from left to right.
fn with_table(browser: &Browser) -> Page<'_> {
    let folder = tempfile::TempDir::new().unwrap();
    let rows =
        "x,y,z,charge,label\n-1.5,0,0,3.5,left\n0,0.25,0,-1.0,\"=\"\"mid\"\"\"\n1.5,0,0,2,\n";
    std::fs::write(folder.path().join("atoms.csv"), rows).unwrap();
    let scene = folder.path().join("scene.ron");
    let text = r##"(
    image: (width: 64, height: 48),
    camera: Perspective(eye: (0, 0, 5), look_at: (0, 0, 0), fov: 60),
    geometries: [
        Spheres(file: "atoms.csv", radius: 0.5, color_by: (column: "charge")),
    ],
)
"##;
    std::fs::write(&scene, text).unwrap();
    let preview = Preview::start(folder, scene, &["--port", "0", "--no-open"]);
    Page::open(browser, preview)
}

fn a_row_of_a_table_is_marked_alone(browser: &Browser) {
    let page = with_table(browser);
    page.click_at(page.at((32, 22)));
    page.wait_for("the line", || page.cursor_line() == 5);
    page.wait("readout.textContent.includes('row 1') && readout.textContent.includes('label')");
    let text = page.text("readout.textContent");
    // All columns, as they are in the file.
    let columns = "x 0, y 0.25, z 0, charge -1.0, label =\"mid\"";
    assert!(text.contains(columns), "{text}");
    page.wait("!outline.hidden && outline.dataset.geometry === 'geometries[0] row 1'");
    let edges = |from: u32, to: u32| {
        let all = (from..to).flat_map(|x| (10..38).map(move |y| (x, y)));
        all.filter(|at| page.color("outline", *at)[3] == 255)
            .count()
    };
    assert!(edges(22, 42) > 8);
    assert_eq!((edges(4, 20), edges(44, 60)), (0, 0));
    // Under the mouse, a row has the numbers of the scene.
    page.point(page.at((44, 24)));
    page.wait("readout.textContent.includes('row 2')");
    let text = page.text("readout.textContent");
    assert!(text.contains("z 0, radius 0.5, charge 2"), "{text}");
    // The cursor stands for all rows.
    page.cursor_before("radius");
    page.wait("!outline.hidden && outline.dataset.geometry === 'geometries[0]'");
    assert!(edges(4, 20) > 8 && edges(44, 60) > 8);
}

fn a_row_of_a_table_is_not_moved(browser: &Browser) {
    let page = with_table(browser);
    page.click("#tools input[value=move]");
    let (x, y) = page.at((32, 22));
    page.drag(&[(x, y), (x + 20.0, y), (x + 40.0, y)]);
    page.wait("connection.textContent.includes('not a table')");
    assert_eq!(page.console_errors(), Vec::<String>::new());
}
