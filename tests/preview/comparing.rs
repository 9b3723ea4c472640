//! The picture beside another one.

use std::path::PathBuf;

use image::{Rgb, RgbImage};

use super::{
    PageTest,
    browser::{Browser, key},
    preview::{Page, SCENE},
    tests,
};

pub(crate) const TESTS: &[(&str, PageTest)] = tests![
    wipe_side_by_side_and_difference,
    a_picture_of_another_size,
    a_file_that_is_not_a_picture,
];

/// Writes a picture of one color next to the scene.
fn picture(page: &Page, name: &str, (width, height): (u32, u32)) -> PathBuf {
    let file = page.preview.folder().join(name);
    let picture = RgbImage::from_pixel(width, height, Rgb([255, 255, 255]));
    picture.save(&file).unwrap();
    file
}

fn wipe_side_by_side_and_difference(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    let file = picture(&page, "white.png", (64, 48));
    page.upload("#compare-file", &file);
    page.wait("canvas.dataset.mode === 'wipe' && !reference.hidden");
    page.wait("comparison.textContent.includes('differ')");
    let text = page.text("comparison.textContent");
    assert!(text.contains("3072 of 3072"), "{text}");
    // What is compared is shown.
    assert!(page.is("sharp.hidden"));
    assert_eq!(page.rectangle("#reference"), page.rectangle("#picture"));
    assert!(page.style("#reference", "clipPath").contains("50%"));
    page.shot("wipe");
    page.call("wipe.focus()", &[]);
    page.keys(&key::HOME.to_string());
    page.wait("getComputedStyle(reference).clipPath.includes('0%') || getComputedStyle(reference).clipPath === 'inset(0px)'");

    // The border in the picture itself.
    let [left, top, width, height] = page.rectangle("#wipe-line");
    let from = (left + width / 2.0, top + height / 2.0);
    let [left, _, width, _] = page.rectangle("#picture");
    assert!((from.0 - left).abs() < 2.0, "{from:?}");
    page.drag(&[
        from,
        (left + width / 2.0, from.1),
        (left + width * 0.75, from.1),
    ]);
    page.wait("Math.abs(wipe.valueAsNumber - 75) < 1");
    page.wait("Math.abs(parseFloat(reference.style.clipPath.split(' ').pop()) - 75) < 1");

    page.choose("#compare-mode", "side");
    page.wait("canvas.dataset.mode === 'side'");
    // Both at one moment: a line of text above may still change its height.
    page.wait(
        "((one, other) => one.right === other.left && one.top === other.top)(
            picture.getBoundingClientRect(), reference.getBoundingClientRect())",
    );
    let beside = page.rectangle("#reference");
    let frame = page.rectangle("#frame");
    assert!(beside[0] + beside[2] <= frame[0] + frame[2]);
    page.shot("side");
    // The other picture is read at the same pixel.
    page.point((
        beside[0] + beside[2] * 22.5 / 64.0,
        beside[1] + beside[3] * 24.5 / 48.0,
    ));

    page.choose("#compare-mode", "difference");
    page.wait("!difference.hidden && difference.naturalWidth === 64");
    assert!(page.is("reference.hidden"));
    page.shot("difference");

    page.choose("#compare-mode", "off");
    page.wait("reference.hidden && difference.hidden && comparison.textContent === ''");

    // The picture of the scene itself.
    let same = page.preview.folder().join("same.png");
    let made = std::process::Command::new(env!("CARGO_BIN_EXE_strahl"))
        .args(["render", "scene.ron", "-o", "same.png", "--quiet"])
        .current_dir(page.preview.folder())
        .status();
    assert!(made.unwrap().success());
    page.upload("#compare-file", &same);
    page.wait("comparison.textContent.includes('equal')");
    // Again after each change.
    page.and_draw(|| page.preview.write(&SCENE.replace("#ff0000", "#ff0001")));
    page.wait("comparison.textContent.includes('differ')");
}

fn a_picture_of_another_size(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    let file = picture(&page, "small.png", (32, 24));
    page.upload("#compare-file", &file);
    page.wait("comparison.textContent.includes('32x24')");
    assert!(!page.is("reference.hidden"));
}

fn a_file_that_is_not_a_picture(browser: &Browser) {
    let page = Page::of(browser, SCENE);
    let file = page.preview.folder().join("x.png");
    std::fs::write(&file, "<script>alert(1)</script>").unwrap();
    page.upload("#compare-file", &file);
    page.wait("comparison.textContent.length > 10");
    assert!(page.is("reference.hidden"));
}
