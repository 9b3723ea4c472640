//! `strahl merge`: a picture assembled from its bands.

use std::{
    fs::{self, File},
    io::{self, Write},
    path::{Path, PathBuf},
};

use strahl::{
    Error, ErrorKind, ImageFormat, Scene,
    diagnostic::{folder_of, open_file},
    jobs::Shard,
    text::sanitize,
};

use super::{
    cameras::CameraArgs,
    failure::Failure,
    interrupt,
    picture::PictureArgs,
    record::{self, Done, Line, Recorder, Records, Written},
    render::one::{check_file, check_pictures, file, sources},
    scene::{self, InputArgs, ThreadArgs},
};

/// Join the bands of a picture from `strahl render --shard`, with the same scene and options
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    camera: CameraArgs,
    /// The picture, with its bands next to it; default: the scene's name with .png, in the
    /// current folder
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureArgs,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Do not print warnings
    #[arg(short, long)]
    quiet: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let cancel = interrupt::cancel_on_signal();
    let scene = &args.input.scene.scene;
    let path = file(args.output.as_deref(), scene, args.camera.name(), "png")?;
    check_file(&path, scene)?;
    args.picture.check(ImageFormat::of_path(&path)?)?;
    let threads = args.threads.count();
    let document = args.input.read(threads, args.quiet)?;
    let used = sources(&document, scene);
    let scene = args.camera.of(Scene::try_from(document)?)?;
    let options = args.picture.options().threads(threads).cancel(cancel);
    let files = check_pictures(&path, &used, &options)?;
    let hash = scene.hash(&path, &options)?;
    let name = |path: &PathBuf| {
        path.file_name()
            .map(|name| name.to_string_lossy().into_owned())
    };
    let picture = name(&path).unwrap_or_default();
    let folder = folder_of(&path);
    let _turn = take_turn(&path);
    match scene.merge(&path, &options) {
        Ok(parts) => {
            let written = files.iter().filter_map(name);
            let written = written.map(|file| Written::of(folder, &file));
            let done = Done {
                hash,
                files: written
                    .collect::<Result<_, _>>()
                    .map_err(|error| Error::reading_failed(&path, error))?,
                picture: picture.clone(),
            };
            // Recorded so that a repeated merge reports success, even if this one ends before the
            // last band is removed.
            let plan = record::plan(Shard::WHOLE, 1, vec![picture]);
            let recorder = Recorder::open(folder, &plan)?;
            recorder.write(&Line::Done(done))?;
            for part in parts {
                // The picture exists; a band that stays is only clutter.
                let _ = fs::remove_file(part);
            }
            recorder.remove();
            scene::report_written(&path, "", args.quiet);
            Ok(())
        }
        Err(error) if error.kind() == ErrorKind::Interrupted => Err(error.into()),
        Err(error) => {
            let records = Records::read(folder)?;
            let mut done = records.done(&picture, Some(&hash));
            let is_there = |done: &Done| done.files.iter().all(|file| file.is_there(folder));
            // Another process may have been faster and removed bands after this one saw them.
            if done.any(is_there) {
                return Ok(());
            }
            let is_whole = files.iter().all(|file| file.is_file());
            if !is_whole || bands(&path).next().is_some() {
                return Err(error.into());
            }
            if !args.quiet {
                let path = path.to_string_lossy();
                let message = "exists, and there are no bands left to merge";
                let _ = writeln!(io::stderr(), "note: {}: {message}", sanitize(&path));
            }
            Ok(())
        }
    }
}

/// Waits until no other process is merging the same picture, using a lock on its first band.
fn take_turn(path: &Path) -> Option<File> {
    // Except on Unix, a lock would keep this process from reading the band, too.
    let first = bands(path).min().filter(|_| cfg!(unix))?;
    let band = open_file(first).ok()?;
    band.lock().ok().map(|()| band)
}

/// Returns the bands of a picture, which are next to it.
fn bands(path: &Path) -> impl Iterator<Item = PathBuf> {
    let name = path.file_name().unwrap_or_default().to_owned();
    let entries = fs::read_dir(folder_of(path))
        .into_iter()
        .flatten()
        .flatten();
    let is_band = move |entry: &fs::DirEntry| {
        let found = entry.file_name();
        let found = found.as_encoded_bytes();
        found.starts_with(name.as_encoded_bytes()) && found.ends_with(b".part")
    };
    entries.filter(is_band).map(|entry| entry.path())
}
