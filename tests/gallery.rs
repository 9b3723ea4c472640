//! docs/gallery.md shows every scene of scenes/ with its current picture, docs/light.md, docs/glass.md and docs/path.md each light
//! and material, and docs/scene-format.md each shape. Of each picture, a band of rows is rendered and compared; `.ci/run` compares
//! all bytes. `STRAHL_BLESS=1 cargo test --test gallery` renders the pictures again: look at them.

use std::{
    collections::BTreeSet,
    env, fs,
    path::{Path, PathBuf},
};

use image::imageops;
use strahl::{
    RenderOptions, Scene, Shape, Size,
    film::{Crop, Samples},
};

const PICTURES: &str = "docs/gallery";
const LIGHT: &str = "docs/light";
const PATH: &str = "docs/path/stage";
const SHAPES: &str = "docs/shapes";

fn files(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let files = fs::read_dir(folder).unwrap();
    let files = files.map(|file| file.unwrap().path());
    let is_wanted = |file: &PathBuf| {
        let ending = file.extension().unwrap_or_default();
        endings.iter().any(|wanted| ending == *wanted)
    };
    files.filter(is_wanted).collect()
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap().to_str().unwrap().to_owned()
}

/// The number of rows of each picture that are compared, and of one by paths the number of columns: each of their
/// pixels takes long.
const ROWS: u32 = 16;
const COLUMNS: u32 = 64;

/// The width and height of the pictures of scenes with an animation, whose frames are smaller.
const ANIMATED: (u32, u32) = (1200, 675);

/// Compares the rows in the middle of the picture of a page with the current ones of its scene.
fn compare(scene: &Path, shown: &Path) {
    let is_by_paths = fs::read_to_string(scene)
        .unwrap()
        .contains("lighting: Path(");
    let scene = Scene::from_path(scene).unwrap();
    let mut options = RenderOptions::new();
    if scene.animation().is_some() {
        let size = Size::new(ANIMATED.0, ANIMATED.1).unwrap();
        options = options.size(size).samples(Samples::new(16).unwrap());
    }
    if env::var_os("STRAHL_BLESS").is_some() {
        fs::create_dir_all(shown.parent().unwrap()).unwrap();
        scene.save_with(shown, &options).unwrap();
    }
    let old = image::open(shown).unwrap().into_rgb8();
    let width = if is_by_paths { COLUMNS } else { old.width() };
    let (left, top) = ((old.width() - width) / 2, (old.height() - ROWS) / 2);
    let crop = Crop::new(left, top, width, ROWS).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let drawn = folder.path().join("drawn.png");
    scene.save_with(&drawn, &options.crop(crop)).unwrap();
    let new = image::open(&drawn).unwrap().into_rgb8();
    let old = imageops::crop_imm(&old, left, top, width, ROWS).to_image();
    let same = old == new;
    assert!(same, "{} differs from the current picture", shown.display());
}

fn assert_no_others(folder: &str, names: &BTreeSet<String>) {
    let shown = files(folder, &["png"]);
    let shown: BTreeSet<_> = shown.iter().map(|file| stem(file)).collect();
    assert_eq!(shown, *names, "a picture without a scene");
}

#[test]
fn each_scene_is_on_the_page_with_its_picture() {
    let page = fs::read_to_string("docs/gallery.md").unwrap();
    let mut names = BTreeSet::new();
    for file in files("scenes", &["ron", "json"]) {
        let name = stem(&file);
        let scene = format!("](../scenes/{})", file.file_name().unwrap().display());
        assert!(
            page.contains(&scene),
            "{} is not in docs/gallery.md",
            file.display()
        );
        let picture = format!("{name}.png");
        assert!(page.contains(&format!("](gallery/{picture})")), "{picture}");
        compare(&file, &Path::new(PICTURES).join(&picture));
        assert!(names.insert(name), "two scenes have the name {picture}");
    }
    assert_no_others(PICTURES, &names);
}

#[test]
fn each_shape_is_in_the_manual_with_its_picture() {
    let page = fs::read_to_string("docs/scene-format.md").unwrap();
    let mut names = BTreeSet::new();
    for file in files(SHAPES, &["ron"]) {
        let name = stem(&file);
        assert!(page.contains(&format!("](shapes/{name}.png)]")), "{name}");
        compare(&file, &Path::new(SHAPES).join(format!("{name}.png")));
        names.insert(name);
    }
    for kind in Shape::KINDS {
        let kinds = match *kind {
            "solid" => ["union", "intersection", "difference"],
            "compound" => ["instances"; 3],
            kind => [kind; 3],
        };
        let has_picture = kinds.iter().all(|kind| names.contains(*kind));
        assert!(has_picture, "{kind} has no picture");
    }
    assert_no_others(SHAPES, &names);
}

#[test]
fn each_light_and_material_is_on_its_page_with_its_picture() {
    compare_stage(&["docs/light.md", "docs/glass.md"], LIGHT);
}

#[test]
fn each_light_and_material_of_paths_is_on_its_page_with_its_picture() {
    compare_stage(&["docs/path.md"], PATH);
}

/// Compares the pictures of a folder on some pages. After a picture comes its scene, or lines of the first scene
/// in their new form.
fn compare_stage(pages: &[&str], pictures: &str) {
    let link = format!("]({}/", pictures.strip_prefix("docs/").unwrap());
    let folder = tempfile::tempdir().unwrap();
    let mut names = BTreeSet::new();
    let mut stage = String::new();
    for page in pages {
        let page = fs::read_to_string(page).unwrap();
        for part in page.split(&link).skip(1) {
            let (name, rest) = part.split_once(".png)").unwrap();
            let block = rest.split("```").nth(1).unwrap();
            let block = block.strip_prefix("ron\n").unwrap();
            let text = if block.starts_with('(') {
                block.to_owned()
            } else {
                block
                    .lines()
                    .fold(stage.clone(), |text, line| replaced(&text, line))
            };
            if stage.is_empty() {
                stage.clone_from(&text);
            }
            let scene = folder.path().join(format!("{name}.ron"));
            fs::write(&scene, text).unwrap();
            compare(&scene, &Path::new(pictures).join(format!("{name}.png")));
            assert!(names.insert(name.to_owned()), "two pictures {name}");
        }
    }
    assert_no_others(pictures, &names);
}

/// Returns a scene with another line in place of the one that begins like it.
fn replaced(stage: &str, line: &str) -> String {
    let end = line.find("material:").or_else(|| line.find(['[', '{']));
    let end = end.unwrap();
    let is_it = |old: &&str| old.trim_start().starts_with(&line[..end]);
    assert_eq!(stage.lines().filter(is_it).count(), 1, "{line}");
    let lines = stage.lines();
    let lines = lines.map(|old| if is_it(&old) { line } else { old });
    lines.collect::<Vec<_>>().join("\n")
}
