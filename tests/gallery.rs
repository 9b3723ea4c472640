//! docs/gallery.md shows every scene of scenes/ with its current picture.
//! `STRAHL_BLESS=1 cargo test --test gallery` renders the pictures again: look at them.

use std::{collections::BTreeSet, env, fs, path::PathBuf};

use strahl::Scene;

const PICTURES: &str = "docs/gallery";

fn files(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let files = fs::read_dir(folder).unwrap();
    let files = files.map(|file| file.unwrap().path());
    let is_wanted = |file: &PathBuf| {
        let ending = file.extension().unwrap_or_default();
        endings.iter().any(|wanted| ending == *wanted)
    };
    files.filter(is_wanted).collect()
}

fn stem(path: &std::path::Path) -> String {
    path.file_stem().unwrap().to_str().unwrap().to_owned()
}

#[test]
fn each_scene_is_on_the_page_with_its_picture() {
    let page = fs::read_to_string("docs/gallery.md").unwrap();
    let folder = tempfile::tempdir().unwrap();
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
        let (shown, drawn) = (
            PathBuf::from(PICTURES).join(&picture),
            folder.path().join(&picture),
        );
        Scene::from_path(&file).unwrap().save(&drawn).unwrap();
        if env::var_os("STRAHL_BLESS").is_some() {
            fs::create_dir_all(PICTURES).unwrap();
            fs::copy(&drawn, &shown).unwrap();
        }
        let same = fs::read(&shown).ok() == fs::read(&drawn).ok();
        assert!(same, "{} differs from the current picture", shown.display());
        assert!(names.insert(name), "two scenes have the name {picture}");
    }
    let shown: BTreeSet<_> = files(PICTURES, &["png"])
        .iter()
        .map(|file| stem(file))
        .collect();
    assert_eq!(shown, names, "a picture without a scene");
}
