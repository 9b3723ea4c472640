//! Compares every scene below `tests/golden` with the picture of the same stem, pixel by pixel, and
//! checks that any number of threads and either syntax give the same bytes.
//!
//! `STRAHL_BLESS=1` rewrites the pictures that differ. Check the new ones against the equations
//! with `tests/reference`.

use std::{
    collections::BTreeMap,
    env,
    error::Error,
    ffi::OsStr,
    fs, io,
    path::{Path, PathBuf},
    process::ExitCode,
};

use image::{DynamicImage, RgbImage};
use libtest_mimic::{Arguments, Failed, Trial};
use strahl::{ImageFormat, RenderOptions, Scene, Size, film::Samples};

/// The largest picture allowed in the repository.
const MOST_BYTES: u64 = 20 * 1024;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments = Arguments::from_args();
    let mut trials = golden_trials()?;
    trials.extend(gallery_trials()?);
    Ok(libtest_mimic::run(&arguments, trials).exit_code())
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn golden_trials() -> io::Result<Vec<Trial>> {
    let files = files_below(&root().join("tests/golden"))?;
    let mut trials = Vec::new();
    for (stem, scenes) in by_stem(&files) {
        let name = name_of(&stem, "tests");
        let case = scenes.clone();
        trials.push(Trial::test(name.clone(), move || golden(&stem, &case)));
        trials.extend(twin_trial(&name, scenes));
    }
    trials.push(Trial::test("golden has no strays", move || strays(&files)));
    Ok(trials)
}

fn gallery_trials() -> io::Result<Vec<Trial>> {
    let mut files = files_below(&root().join("scenes"))?;
    // The parts of scenes have no cameras.
    files.retain(|file| !file.starts_with(root().join("scenes/parts")));
    let mut trials = Vec::new();
    for (stem, scenes) in by_stem(&files) {
        for scene in &scenes {
            let scene = scene.clone();
            trials.push(Trial::test(name_of(&scene, ""), move || threads(&scene)));
        }
        trials.extend(twin_trial(&name_of(&stem, ""), scenes));
    }
    Ok(trials)
}

fn twin_trial(name: &str, scenes: Vec<PathBuf>) -> Option<Trial> {
    (scenes.len() > 1).then(|| Trial::test(format!("{name} twins"), move || twins(&scenes)))
}

/// Checks the picture of a stem, from each of its scenes, with one thread and with three.
fn golden(stem: &Path, scenes: &[PathBuf]) -> Result<(), Failed> {
    let expectation = stem.with_extension("png");
    for path in scenes {
        let scene = Scene::from_path(path)?;
        let image = scene.render_with(&RenderOptions::new().threads(1))?;
        let by_three = scene.render_with(&RenderOptions::new().threads(3))?;
        if by_three.pixels() != image.pixels() {
            return Err(format!("{}: three threads draw another picture", path.display()).into());
        }
        let drawn = RgbImage::from_raw(image.width(), image.height(), image.pixels().to_vec())
            .ok_or("as many bytes as pixels were expected")?;
        compare(path, &expectation, &drawn, || Ok(image.save(&expectation)?))?;
    }
    let size = fs::metadata(&expectation)?.len();
    if size > MOST_BYTES {
        let picture = expectation.display();
        return Err(format!("{picture} has {size} bytes; at most {MOST_BYTES} belong here").into());
    }
    Ok(())
}

fn compare(
    scene: &Path,
    expectation: &Path,
    drawn: &RgbImage,
    bless: impl FnOnce() -> Result<(), Failed>,
) -> Result<(), Failed> {
    let expected = read_picture(expectation);
    if expected.as_ref().is_ok_and(|expected| expected == drawn) {
        return Ok(());
    }
    if env::var_os("STRAHL_BLESS").is_some_and(|value| value == "1") {
        return bless();
    }
    let new = output(expectation, "png")?;
    drawn.save(&new)?;
    let scene = scene.display();
    let new = new.display();
    let expected = expected.map_err(|error| {
        let expectation = expectation.display();
        format!(
            "{expectation}: {}\nthe picture of {scene}: {new}",
            message(&error)
        )
    })?;

    let (difference, count) = difference(&expected, drawn);
    let file = output(expectation, "difference.png")?;
    difference.save(&file)?;
    Err(format!(
        "{scene}: {count} pixels differ\nthe new picture: {new}\nthe difference:  {}",
        file.display(),
    )
    .into())
}

/// Returns the expected picture, darkened, with differing pixels in red, and their number. A pixel
/// that only one of the pictures has differs.
fn difference(expected: &RgbImage, drawn: &RgbImage) -> (RgbImage, u64) {
    let mut count = 0;
    let width = expected.width().max(drawn.width());
    let height = expected.height().max(drawn.height());
    let picture = RgbImage::from_fn(width, height, |column, row| {
        let old = expected.get_pixel_checked(column, row);
        if let Some(old) = old
            && drawn.get_pixel_checked(column, row) == Some(old)
        {
            return image::Rgb(old.0.map(|channel| channel / 4));
        }
        count += 1;
        image::Rgb([255, 0, 0])
    });
    (picture, count)
}

/// Returns the path of a file below `target/golden`, and creates its folder.
fn output(expectation: &Path, extension: &str) -> io::Result<PathBuf> {
    // `CARGO_TARGET_TMPDIR` is `tmp` in the target folder, wherever that is.
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("..");
    let target = fs::canonicalize(&target).unwrap_or(target);
    let inside = expectation
        .strip_prefix(root().join("tests"))
        .unwrap_or(expectation);
    let path = target.join(inside).with_extension(extension);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    Ok(path)
}

fn read_picture(path: &Path) -> Result<RgbImage, Failed> {
    match image::open(path)? {
        DynamicImage::ImageRgb8(picture) => Ok(picture),
        other => Err(format!("{:?} instead of 8-bit red, green and blue", other.color()).into()),
    }
}

fn message(failed: &Failed) -> &str {
    failed.message().unwrap_or("no picture")
}

/// Returns the files that are neither a scene nor the picture of one, which nothing would test.
fn strays(files: &[PathBuf]) -> Result<(), Failed> {
    let stems = by_stem(files);
    if stems.is_empty() {
        return Err("there are no cases".into());
    }
    let stray = |file: &&PathBuf| {
        let picture = has_extension(file, "png") && stems.contains_key(&file.with_extension(""));
        !is_scene(file) && !picture && !is_data(file)
    };
    let strays: Vec<_> = files
        .iter()
        .filter(stray)
        .map(|file| name_of(file, ""))
        .collect();
    if strays.is_empty() {
        Ok(())
    } else {
        Err(strays.join("\n").into())
    }
}

/// Checks that any number of threads gives the same file. A few samples show that, and a sixteenth of
/// the pixels unless `STRAHL_FULL` is set.
fn threads(path: &Path) -> Result<(), Failed> {
    let scene = Scene::from_path(path)?;
    let mut few = RenderOptions::new().samples(Samples::new(4)?);
    let is_by_paths = fs::read_to_string(path)?.contains("lighting: Path(");
    if is_by_paths || env::var_os("STRAHL_FULL").is_none() {
        let size = scene.size();
        few = few.size(Size::new(size.width() / 4, size.height() / 4)?);
    }
    let alone = png(&scene, few.clone().threads(1))?;
    for threads in [2, 3, 16] {
        if png(&scene, few.clone().threads(threads))? != alone {
            return Err(format!("{threads} threads write another file than one").into());
        }
    }
    Ok(())
}

/// Checks that either syntax gives the same file.
fn twins(scenes: &[PathBuf]) -> Result<(), Failed> {
    let mut files = Vec::new();
    for scene in scenes {
        files.push(png(&Scene::from_path(scene)?, RenderOptions::new())?);
    }
    if files.windows(2).all(|pair| pair[0] == pair[1]) {
        Ok(())
    } else {
        Err("the RON scene and the JSON scene give different files".into())
    }
}

fn png(scene: &Scene, options: RenderOptions) -> Result<Vec<u8>, Failed> {
    let mut file = Vec::new();
    scene.write_with(&mut file, ImageFormat::PNG, &options)?;
    Ok(file)
}

fn files_below(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(files_below(&path)?);
        } else {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Returns the scenes among `files` by their path without the extension.
fn by_stem(files: &[PathBuf]) -> BTreeMap<PathBuf, Vec<PathBuf>> {
    let mut stems: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for file in files.iter().filter(|file| is_scene(file)) {
        stems
            .entry(file.with_extension(""))
            .or_default()
            .push(file.clone());
    }
    stems
}

fn is_scene(path: &Path) -> bool {
    has_extension(path, "ron") || has_extension(path, "json")
}

/// Returns true if a file is a table or a mesh, in a folder beside the scenes that name it.
fn is_data(path: &Path) -> bool {
    let of = |folder: &str, endings: &[&str]| {
        let is_one = endings.iter().any(|ending| has_extension(path, ending));
        is_one && path.parent().is_some_and(|parent| parent.ends_with(folder))
    };
    of("tables", &["csv", "npy", "npz", "ply", "xyz", "pdb"])
        || of("meshes", &["ply", "obj"])
        || of("pictures", &["png"])
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension() == Some(OsStr::new(extension))
}

/// Returns a path inside `folder` of this crate, with `/` on every platform.
fn name_of(path: &Path, folder: &str) -> String {
    let inside = path.strip_prefix(root().join(folder)).unwrap_or(path);
    let parts: Vec<_> = inside.iter().map(OsStr::to_string_lossy).collect();
    parts.join("/")
}
