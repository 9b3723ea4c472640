//! `strahl info`: the contents of a scene.

mod counts;
mod light;

use std::{
    fmt, fs, iter,
    path::{Path, PathBuf},
};

use serde::Serialize;
use strahl::{
    Camera, Document, RenderOptions, Scene, Size, film::Samples, light::Backdrop, parallel::Cancel,
    render::Seen, text::Stamp,
};

use self::{
    counts::Counts,
    light::{LightingTerms, Materials},
};
use super::{
    camera::{CameraTerms, vector},
    depfile,
    failure::Failure,
    frame::FrameArgs,
    interrupt,
    output::OutputFormat,
    paths::is_dash,
    progress::{Progress, When},
    render::one::sources,
    report::{self, GeometryPlace},
    scene::{InputArgs, STDIN, SceneArgs, ThreadArgs},
};

/// Show the contents of a scene: geometries, bounds, cameras and their views, files
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    frame: FrameArgs,
    /// Size of the picture in pixels, instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Also write the files that the scene depends on to a file for make or ninja
    #[arg(long, value_name = "FILE")]
    depfile: Option<PathBuf>,
    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "human")]
    output_format: OutputFormat,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let cancel = interrupt::cancel_on_signal();
    let threads = args.threads.count();
    let document = args.input.read(threads, false)?;
    let files = files(&args.input.scene, &document);
    if let Some(depfile) = &args.depfile {
        write_depfile(depfile, &args.input.scene.scene, &document, &cancel)?;
    }
    let tables: Vec<String> = document.table_names().map(str::to_owned).collect();
    let lights = document.light_names();
    let lights: Vec<_> = lights.map(|name| name.map(str::to_owned)).collect();
    let mut scene = args.frame.of(Scene::try_from(document)?)?;
    let size = args.size.unwrap_or(scene.size());
    let names: Vec<_> = scene.cameras().map(|name| Some(name.to_owned())).collect();
    let names = scene.has_camera().then_some(None).into_iter().chain(names);
    let names: Vec<Option<String>> = names.collect();
    let progress = Progress::new(size.pixels() * names.len() as u64, When::Auto);
    let options = RenderOptions::new()
        .size(size)
        .threads(threads)
        .cancel(cancel)
        .on_progress(progress.sink());
    let mut seen = Vec::new();
    for name in &names {
        if let Some(name) = name {
            scene = scene.with_camera(name)?;
        }
        let camera = (scene.camera_for(size)?, scene.is_framed());
        seen.push((camera, scene.seen(&options)?));
    }
    drop(progress);
    let views = names.iter().zip(&seen).map(|(name, (camera, seen))| {
        CameraView::new(&scene, name.as_deref(), *camera, size, seen)
    });
    let info = Info {
        format: 1,
        version: env!("CARGO_PKG_VERSION"),
        files,
        image: PictureSize {
            size,
            samples: scene.samples().count(),
        },
        animation: scene.animation().map(|animation| AnimationTerms {
            fps: animation.fps(),
            frames: animation.frames(),
            frame: args.frame.number().unwrap_or(0),
        }),
        background: {
            let color = scene.world().background();
            [color.r(), color.g(), color.b()]
        },
        backdrop: scene.world().backdrop().map(Backdrop::kind),
        lighting: LightingTerms::new(&scene, lights),
        materials: Materials::of(&scene),
        geometries: Counts::new(&scene, tables),
        bounds: BoundsTerms::of(&scene),
        cameras: views.collect(),
    };
    super::output::print_as(args.output_format, Stamp::Info, &info)
}

/// Returns the files that a scene depends on, each once: itself, its tables and its parts with
/// theirs.
fn files(scene: &SceneArgs, document: &Document) -> Vec<FileTerms> {
    let own = if scene.is_stdin() {
        FileTerms {
            file: STDIN.to_owned(),
            bytes: Some(document.text().len() as u64),
            used_by: Vec::new(),
        }
    } else {
        FileTerms::of(&scene.scene, &[])
    };
    let files = document.dependencies().into_iter();
    let files = files.map(|file| FileTerms::of(file.path, &file.used_by));
    iter::once(own).chain(files).collect()
}

/// Writes the rule that the scene depends on its tables and parts.
fn write_depfile(
    depfile: &Path,
    scene: &Path,
    document: &Document,
    cancel: &Cancel,
) -> Result<(), Failure> {
    if is_dash(scene) {
        let message = "--depfile needs a scene that is a file, not standard input";
        return Err(Failure::usage(message));
    }
    report::check(depfile, &sources(document, scene))?;
    let files = document.dependencies().into_iter();
    let files: Vec<_> = files.map(|file| file.path.to_owned()).collect();
    depfile::Rule::new(&[scene.to_owned()], &files)?.write(depfile, cancel)
}

#[derive(Serialize)]
struct Info<'a> {
    format: u32,
    version: &'static str,
    files: Vec<FileTerms>,
    image: PictureSize,
    animation: Option<AnimationTerms>,
    background: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    backdrop: Option<&'static str>,
    lighting: Option<LightingTerms>,
    materials: Materials,
    geometries: Counts<'a>,
    bounds: Option<BoundsTerms>,
    cameras: Vec<CameraView<'a>>,
}

#[derive(Serialize)]
struct FileTerms {
    file: String,
    /// `None` for a pipe, which has no size.
    bytes: Option<u64>,
    /// The files that name it; none for the scene.
    used_by: Vec<String>,
}

impl FileTerms {
    fn of(path: &Path, used_by: &[&str]) -> Self {
        let about = fs::metadata(path).ok().filter(fs::Metadata::is_file);
        Self {
            file: path.to_string_lossy().into_owned(),
            bytes: about.map(|about| about.len()),
            used_by: used_by.iter().map(|&file| file.to_owned()).collect(),
        }
    }
}

#[derive(Serialize)]
struct PictureSize {
    #[serde(flatten)]
    size: Size,
    samples: u32,
}

#[derive(Serialize)]
struct AnimationTerms {
    fps: f64,
    frames: u32,
    /// The frame that the other fields describe.
    frame: u32,
}

/// The smallest axis-aligned box around everything finite.
#[derive(Serialize)]
struct BoundsTerms {
    min: [f64; 3],
    max: [f64; 3],
}

impl BoundsTerms {
    fn of(scene: &Scene) -> Option<Self> {
        let [min, max] = scene.world().bounds()?;
        Some(Self {
            min: min.into(),
            max: max.into(),
        })
    }
}

/// A camera and its view.
#[derive(Serialize)]
struct CameraView<'a> {
    name: Option<&'a str>,
    /// True for a camera that frames the geometries.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    fit: bool,
    #[serde(flatten)]
    terms: CameraTerms,
    #[serde(skip_serializing_if = "Option::is_none")]
    fov_degrees: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    aperture: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    focus: Option<f64>,
    extrinsics: [[f64; 4]; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    intrinsics: Option<[[f64; 3]; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    affine: Option<[[f64; 4]; 3]>,
    seen: usize,
    unseen: usize,
    nearest: Option<Depth<'a>>,
    farthest: Option<Depth<'a>>,
}

/// A geometry and its distance along a ray.
#[derive(Serialize)]
struct Depth<'a> {
    #[serde(flatten)]
    place: GeometryPlace<'a>,
    depth: f64,
}

impl<'a> CameraView<'a> {
    fn new(
        scene: &'a Scene,
        name: Option<&'a str>,
        (camera, fit): (Camera, bool),
        size: Size,
        seen: &[Seen],
    ) -> Self {
        let (width, height) = (size.width(), size.height());
        let depth = |id, depth| Depth {
            place: GeometryPlace::new(scene, id),
            depth,
        };
        let (fov_degrees, lens) = match camera {
            Camera::Perspective(camera) => (Some(fov_degrees(camera.half_angle())), camera.lens()),
            Camera::Orthographic(_) => (None, None),
        };
        let nearest = seen.iter().min_by(|a, b| a.nearest.total_cmp(&b.nearest));
        // Of several equally far ones the first is taken, as for the nearest.
        let farthest = seen.iter().rev();
        let farthest = farthest.max_by(|a, b| a.farthest.total_cmp(&b.farthest));
        Self {
            name,
            fit,
            terms: CameraTerms::new(&camera),
            fov_degrees,
            aperture: lens.map(|[aperture, _]| aperture),
            focus: lens.map(|[_, focus]| focus),
            extrinsics: camera.extrinsics(),
            intrinsics: camera.intrinsics(width, height),
            affine: camera.affine(width, height),
            seen: seen.len(),
            unseen: scene.world().ids() - seen.len(),
            nearest: nearest.map(|seen| depth(seen.id, seen.nearest)),
            farthest: farthest.map(|seen| depth(seen.id, seen.farthest)),
        }
    }
}

/// Returns the field of view of a half angle, rounded to the digits that survive the conversion to
/// radians and back.
fn fov_degrees(half_angle: f64) -> f64 {
    let degrees = (2.0 * half_angle).to_degrees();
    format!("{degrees:.12e}").parse().unwrap_or(degrees)
}

impl fmt::Display for Info<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut title = "files";
        let scene = self.files.first().map(|file| &file.file);
        for terms in &self.files {
            let FileTerms {
                file,
                bytes,
                used_by,
            } = terms;
            write!(out, "{title:<14} {file:?}")?;
            if let Some(bytes) = bytes {
                write!(out, ", {bytes} bytes")?;
            }
            // Most files are named by the scene alone.
            if used_by.iter().any(|user| Some(user) != scene) {
                let users: Vec<_> = used_by.iter().map(|user| format!("{user:?}")).collect();
                write!(out, ", used by {}", users.join(", "))?;
            }
            writeln!(out)?;
            title = "";
        }
        let PictureSize { size, samples } = self.image;
        write!(out, "picture        {size}")?;
        if samples > Samples::ONE.count() {
            write!(out, ", {samples} samples per pixel")?;
        }
        if let Some(AnimationTerms { fps, frames, frame }) = &self.animation {
            write!(
                out,
                "\nanimation      {frames} frames, {fps} per second, frame {frame} shown"
            )?;
        }
        match self.backdrop {
            Some(kind) => writeln!(out, "\nbackdrop       {kind}")?,
            None => writeln!(out, "\nbackground     {}", vector(self.background))?,
        }
        if let Some(lighting) = &self.lighting {
            write!(out, "{lighting}")?;
        }
        write!(out, "{}{}", self.geometries, self.materials)?;
        match &self.bounds {
            Some(BoundsTerms { min, max }) => {
                writeln!(out, "bounds         {} to", vector(*min))?;
                writeln!(
                    out,
                    "               {}, around all bounded geometries",
                    vector(*max)
                )?;
            }
            None => writeln!(out, "bounds         none: no geometry is bounded")?,
        }
        for view in &self.cameras {
            write!(out, "{view}")?;
        }
        writeln!(out, "\nstrahl {}", self.version)
    }
}

impl fmt::Display for CameraView<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "\ncamera")?;
        if let Some(name) = self.name {
            write!(out, " {name:?}")?;
        }
        write!(out, ", {}", self.terms)?;
        if let Some(fov) = self.fov_degrees {
            writeln!(out, "  fov 2α       {fov:?} degrees")?;
        }
        if let Some((aperture, focus)) = self.aperture.zip(self.focus) {
            writeln!(out, "  lens         aperture {aperture:?}, focus {focus:?}")?;
        }
        if let Some([[focal, ..], ..]) = self.intrinsics {
            writeln!(out, "  focal length {focal:?} pixels")?;
        }
        if self.fit {
            writeln!(out, "  fit          around all bounded geometries")?;
        }
        writeln!(
            out,
            "  seen         {} of {}",
            self.seen,
            self.seen + self.unseen
        )?;
        for (title, found) in [("nearest", &self.nearest), ("farthest", &self.farthest)] {
            if let Some(Depth { place, depth }) = found {
                writeln!(out, "  {title:<12} {place} at t = {depth:?}")?;
            }
        }
        Ok(())
    }
}
