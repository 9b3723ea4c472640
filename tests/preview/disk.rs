//! The file on the disk: saves, faults and conflicts.

use std::fs;

use super::{
    PageTest,
    browser::{Browser, key},
    preview::{Page, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, PageTest)] = tests![
    a_save_on_disk_is_drawn,
    a_broken_file_keeps_its_last_picture,
    a_table_that_changes_is_drawn,
    a_draft_is_drawn_and_written_only_on_save,
    a_conflict_keeps_mine,
    a_conflict_takes_the_disk,
    a_conflict_shows_both,
    a_file_that_is_gone_is_written_again,
];

/// The scene with a blue sphere at the left.
fn blue() -> String {
    SCENE.replace("#ff0000", "#0000ff")
}

const LEFT: (u32, u32) = (22, 24);

fn a_save_on_disk_is_drawn(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.and_draw(|| page.preview.write(&blue()));
    assert_eq!(page.color("picture", LEFT), [0, 0, 255, 255]);
    page.wait(r##"source.textContent.includes("#0000ff")"##);
    assert_eq!(page.source(), blue());
    // As an editor saves: by renaming another file.
    page.and_draw(|| {
        let other = page.preview.folder().join("other");
        fs::write(&other, SCENE).unwrap();
        fs::rename(other, page.preview.folder().join("scene.ron")).unwrap();
    });
    assert_eq!(page.color("picture", LEFT), [255, 0, 0, 255]);
}

fn a_broken_file_keeps_its_last_picture(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    assert_eq!(page.style("#picture", "opacity"), "1");
    let broken = SCENE.replace(
        "radius: 0.8, color: \"#ff0000\"",
        "radius: -1, color: \"#ff0000\"",
    );
    page.and_reach("broken", || page.preview.write(&broken));
    let item = "document.querySelector('#diagnostics li')";
    let message = page.text(&format!("{item}.textContent"));
    assert!(
        message.contains("8:") && message.contains("radius"),
        "{message}"
    );
    assert_eq!(page.text(&format!("{item}.dataset.line")), "8");
    assert_eq!(page.color("picture", LEFT), [255, 0, 0, 255]);
    page.wait("Number(getComputedStyle(picture).opacity) < 0.5");
    page.wait("document.querySelector('#source .cm-lintRange-error')");
    page.shot("broken");
    // A click on the message leads to its place.
    page.click("#diagnostics .problem");
    assert_eq!(page.cursor_line(), 8);
    page.and_draw(|| page.preview.write(SCENE));
    page.wait("getComputedStyle(picture).opacity === '1'");
    assert_eq!(page.number("diagnostics.children.length"), 0.0);

    // Not even a text, or a folder.
    page.and_reach("broken", || page.preview.write("(camera: "));
    page.and_draw(|| page.preview.write(SCENE));
}

fn a_table_that_changes_is_drawn(browser: &Browser) {
    let text = SCENE.replace(
        "Plane(point: (0, -1, 0), normal: (0, 1, 0), color: (0.5, 0.5, 0.5)),",
        "Spheres(file: \"atoms.csv\", radius: 0.5, color: \"#ffffff\"),",
    );
    let page = Page::of(browser, &text);
    assert_eq!(page.state(), "broken");
    let table = page.preview.folder().join("atoms.csv");
    page.and_draw(|| fs::write(&table, "x,y,z\n0,1.5,0\n").unwrap());
    assert_eq!(page.color("picture", (31, 11)), [255, 255, 255, 255]);
    page.and_reach("broken", || fs::write(&table, "x,y,z\n0,q,0\n").unwrap());
    // A fault of the table is shown at its own line.
    let shown = page.text("diagnostics.textContent");
    assert!(
        shown.contains("atoms.csv:2:3 error[invalid-table] row 0 (line 2)"),
        "{shown}"
    );
    assert!(shown.contains("(used by 10:"), "{shown}");
    page.and_draw(|| fs::write(&table, "x,y,z\n0,-1.5,0\n").unwrap());
    assert_eq!(page.color("picture", (31, 36)), [255, 255, 255, 255]);
}

fn a_draft_is_drawn_and_written_only_on_save(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    page.and_draw(|| page.retype("#ff0000", "#0000ff"));
    page.wait_for("a blue sphere", || {
        page.color("picture", LEFT) == [0, 0, 255, 255]
    });
    assert_eq!(page.preview.on_disk(), SCENE);
    page.wait("saved.textContent === 'unsaved'");
    page.chord(&[key::CONTROL], "s");
    page.wait("saved.textContent === ''");
    assert_eq!(page.preview.on_disk(), blue());
    assert!(page.is("conflict.hidden"));

    page.and_draw(|| page.retype("#0000ff", "#ff0000"));
    page.click("#save");
    page.wait("saved.textContent === ''");
    assert_eq!(page.preview.on_disk(), SCENE);
}

/// The text of the scene that another program has written meanwhile.
fn theirs() -> String {
    SCENE.replace("#102030", "#ffffff")
}

/// A page with a draft whose file changes on the disk.
fn conflict(browser: &Browser) -> Page<'_> {
    let page = Page::of(browser, SCENE);
    page.and_draw(|| page.retype("#ff0000", "#0000ff"));
    page.wait("saved.textContent === 'unsaved'");
    page.preview.write(&theirs());
    page.wait("!conflict.hidden");
    assert_eq!(page.source(), blue());
    // Saving does not overwrite it.
    page.focus_editor();
    page.chord(&[key::CONTROL], "s");
    page.click("#save");
    page.wait("!conflict.hidden");
    assert_eq!(page.preview.on_disk(), theirs());
    assert_eq!(page.source(), blue());
    page
}

fn a_conflict_keeps_mine(browser: &Browser) {
    let page = conflict(browser);
    page.shot("conflict");
    page.click("#keep-mine");
    page.wait("conflict.hidden && saved.textContent === ''");
    assert_eq!(page.preview.on_disk(), blue());
}

fn a_conflict_takes_the_disk(browser: &Browser) {
    let page = conflict(browser);
    page.and_draw(|| page.click("#take-disk"));
    page.wait("conflict.hidden && saved.textContent === ''");
    page.wait(r##"source.textContent.includes("#ffffff")"##);
    assert_eq!(page.source(), theirs());
    assert_eq!(page.preview.on_disk(), theirs());
    // The draft is not lost.
    page.and_draw(|| page.click("#undo"));
    assert_eq!(page.source(), blue());
}

fn a_conflict_shows_both(browser: &Browser) {
    let page = conflict(browser);
    page.click("#show-both");
    page.wait("document.getElementById('both-dialog').open");
    let [mine, disk] = ["both-mine", "both-disk"]
        .map(|id| page.text(&format!("document.getElementById('{id}').textContent")));
    assert_eq!((mine, disk), (blue(), theirs()));
    let marked = "[...document.querySelectorAll('#both mark')].map(mark => mark.textContent)";
    let marked = page.value(marked);
    let marked = marked.as_array().unwrap();
    // Two lines of each.
    let marked: Vec<_> = marked.iter().map(|mark| mark.as_str().unwrap()).collect();
    assert_eq!(marked.len(), 4, "{marked:?}");
    assert!(marked[0].contains("#102030") && marked[1].contains("#0000ff"));
    assert!(marked[2].contains("#ffffff") && marked[3].contains("#ff0000"));
    page.shot("difference-of-texts");
    page.keys(&key::ESCAPE.to_string());
    page.wait("!document.getElementById('both-dialog').open");
    assert!(!page.is("conflict.hidden"));
    assert_eq!(page.preview.on_disk(), theirs());
}

fn a_file_that_is_gone_is_written_again(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    fs::remove_file(page.preview.folder().join("scene.ron")).unwrap();
    page.wait("!conflict.hidden");
    page.click("#keep-mine");
    page.wait("conflict.hidden");
    assert_eq!(page.preview.on_disk(), SCENE);
}
