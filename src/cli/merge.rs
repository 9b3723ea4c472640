//! `strahl merge`: a picture from its bands.

use std::path::PathBuf;

use strahl::{Cancel, ImageFormat, Scene};

use super::{
    Failure,
    cameras::CameraArgs,
    interrupt,
    picture::PictureArgs,
    render::one::{check_file, check_pictures, file, sources},
    scene,
    set::SetArgs,
};

/// Join the bands of a picture that `strahl render --shard` has drawn, of the same scene with the
/// same options
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    #[command(flatten)]
    scene: scene::SceneArgs,
    #[command(flatten)]
    tables: scene::TableArgs,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    set: SetArgs,
    /// The picture, whose bands lie beside it. The default is the scene's name with .png, in the
    /// current folder
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureArgs,
    /// How many threads read; the default is one for each core. The picture is the same
    #[arg(long, value_name = "N", value_parser = scene::threads())]
    threads: Option<u16>,
    /// Show no warnings
    #[arg(short, long)]
    quiet: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let cancel = Cancel::new();
    interrupt::exit_on_signal(cancel.clone());
    let scene = &args.scene.scene;
    let path = file(args.output.as_deref(), scene, args.camera.name())?;
    check_file(&path, scene)?;
    args.picture.check(ImageFormat::of_path(&path)?)?;
    let threads = args.threads.unwrap_or(0).into();
    let options = args.set.of(args.tables.options().threads(threads));
    let document = args.scene.read(options)?;
    scene::report(&document, args.quiet)?;
    let used = sources(&document, scene);
    let scene = args.camera.of(Scene::try_from(document)?)?;
    let options = args.picture.options().threads(threads).cancel(cancel);
    check_pictures(&path, &used, &options)?;
    Ok(scene.merge(&path, &options)?)
}
