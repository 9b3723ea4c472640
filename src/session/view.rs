//! The view of a scene: the picture that somebody looks at.

use std::{iter, sync::Arc};

use glam::DVec3;

use crate::{
    diagnostic::{
        Path,
        error::{Error, ErrorKind},
    },
    film::{
        samples::{SampleCount, Samples},
        size::Size,
    },
    image_file::ImageFormat,
    parallel::Cancel,
    pipeline::{Scene, options::RenderOptions},
    render::{layers::Layer, shading::picture_sums::PictureSums},
    scene::origin::Origin,
    session::{camera::Motion, outline::outline},
    tracer::{hit::Hit, ray::Ray, tone::Tone},
};

/// The parts of a scene that a picture shows.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// One of the scene's `cameras`; `None` for its own.
    pub camera: Option<String>,
    /// The frame of its animation, from 0.
    pub frame: u32,
    /// The layer.
    pub layer: Layer,
    /// The exposure in stops, in place of the scene's.
    pub exposure: Option<f64>,
    /// The number of samples, in place of the scene's.
    pub samples: Option<SampleCount>,
    /// The movement of the camera.
    pub motion: Motion,
}

impl Default for View {
    fn default() -> Self {
        Self {
            camera: None,
            frame: 0,
            layer: Layer::Color,
            exposure: None,
            samples: None,
            motion: Motion::default(),
        }
    }
}

/// A geometry in the middle of a pixel.
#[derive(Clone, Debug)]
pub struct Seen<'a> {
    /// The id in the world.
    pub id: usize,
    /// The place in the scene.
    pub origin: Origin,
    /// The hit of the ray through the center of the pixel.
    pub hit: Hit<'a>,
}

impl View {
    /// Returns the scene as this view shows it.
    ///
    /// # Errors
    ///
    /// An unknown camera, a frame past the last, and a movement that leaves no camera.
    pub fn of(&self, scene: &Scene) -> Result<Scene, Error> {
        let scene = self.before_motion(scene)?;
        if self.motion == Motion::default() {
            return Ok(scene);
        }
        let pivot = pivot(&scene);
        let moved = self.motion.of(scene.camera(), pivot);
        let (camera, _) = moved.map_err(|error| Error::refused(error.to_string()))?;
        Ok(scene.seen_by(camera))
    }

    /// Returns the scene with the camera, at the frame, before the movement.
    pub(super) fn before_motion(&self, scene: &Scene) -> Result<Scene, Error> {
        let scene = match &self.camera {
            Some(name) => scene.clone().with_camera(name)?,
            None => scene.clone(),
        };
        let scene = match self.frame {
            0 => scene,
            frame => scene.frame(frame)?,
        };
        let tone = scene.tone();
        Ok(match self.exposure {
            Some(stops) => scene.with_tone(Tone::new(stops, tone.mapping())),
            None => scene,
        })
    }

    /// Returns the path of the camera in a scene.
    pub(super) fn path_of_camera(&self, scene: &Scene) -> Path {
        let named = self.camera.as_deref();
        let first = || scene.cameras().next().filter(|_| !scene.has_camera());
        match named.or_else(first) {
            Some(name) => Path::ROOT.field("cameras").key(name),
            None => Path::ROOT.field("camera"),
        }
    }

    /// Returns a PNG file of the view.
    ///
    /// # Errors
    ///
    /// Those of [`View::of`], a layer that has no picture, and a cancelled render.
    pub fn png(&self, scene: &Scene, quality: Quality, cancel: &Cancel) -> Result<Vec<u8>, Error> {
        let scene = self.of(scene)?;
        let options = self.options(&scene, quality, cancel)?;
        let mut file = Vec::new();
        scene.write_with(&mut file, ImageFormat::PNG, &options)?;
        Ok(file)
    }

    /// Returns a PNG file of the view in a scene whose light follows paths, with this many samples, and their
    /// sums, with which the next call continues. More samples are added to those of `known`, unless these
    /// are of something else. The file is that of [`View::png`] once it has all samples.
    ///
    /// # Errors
    ///
    /// Those of [`View::png`], and more pixels than [`PictureSums::MOST_PIXELS`].
    pub fn png_of_samples(
        &self,
        scene: &Scene,
        samples: SampleCount,
        known: Option<PictureSums>,
        cancel: &Cancel,
    ) -> Result<(Vec<u8>, Arc<PictureSums>), Error> {
        let scene = self.of(scene)?;
        let options = self.options(&scene, Quality::Full, cancel)?;
        let options = options.samples(samples);
        let known = known.filter(|known| known.samples() <= samples.count());
        let mut rounds = iter::once(samples);
        let sums = scene.add_samples(known, &options, |_| Ok(rounds.next()))?;
        let sums = Arc::new(sums);
        let options = options.sums(Arc::clone(&sums));
        let mut file = Vec::new();
        scene.write_with(&mut file, ImageFormat::PNG, &options)?;
        Ok((file, sums))
    }

    pub(super) fn options(
        &self,
        scene: &Scene,
        quality: Quality,
        cancel: &Cancel,
    ) -> Result<RenderOptions, Error> {
        let options = options(cancel).layers([self.layer]);
        let options = match quality {
            Quality::Coarse => options.size(coarse(scene.size())?).samples(Samples::ONE),
            Quality::Single => options.samples(Samples::ONE),
            Quality::Full => match self.samples {
                Some(samples) => options.samples(samples),
                None => options,
            },
        };
        if !matches!(self.layer, Layer::Depth | Layer::Z) {
            return Ok(options);
        }
        let seen = scene.seen(&options)?;
        // A plane goes as far as the horizon; beside that, everything else would be at the same depth.
        let is_bounded = |id: usize| {
            let geometry = scene.world().with_id(id);
            geometry.is_some_and(|geometry| geometry.shape().bounds().is_some())
        };
        let has_bounded = seen.iter().any(|seen| is_bounded(seen.id));
        let seen: Vec<_> = seen
            .iter()
            .filter(|seen| !has_bounded || is_bounded(seen.id))
            .collect();
        let near = seen.iter().map(|seen| seen.nearest);
        let far = seen.iter().map(|seen| seen.farthest);
        let (near, far) = (near.fold(f64::INFINITY, f64::min), far.fold(0.0, f64::max));
        // One depth, or none, has no range.
        let range = if near < far {
            (near, far)
        } else {
            (0.0, far.max(1.0))
        };
        Ok(options.depth_range(range.0, range.1))
    }

    /// Returns a PNG file with the outline of a geometry of the scene, transparent elsewhere;
    /// `None` if no pixel shows it.
    ///
    /// # Errors
    ///
    /// Those of [`View::of`], and a cancelled render.
    pub fn outline(
        &self,
        scene: &Scene,
        geometry: &Origin,
        cancel: &Cancel,
    ) -> Result<Option<Vec<u8>>, Error> {
        let scene = self.of(scene)?;
        let geometries = scene.ids(geometry);
        outline(&scene, scene.size(), &geometries, &options(cancel))
    }
}

/// The effort of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quality {
    /// A quarter of the width and height, one sample.
    Coarse,
    /// One sample.
    Single,
    /// All samples.
    Full,
}

impl Quality {
    /// All, by name.
    pub const ALL: [(&'static str, Self); 3] = [
        ("coarse", Self::Coarse),
        ("single", Self::Single),
        ("full", Self::Full),
    ];
}

/// Returns the options of all pictures. They have threads of their own: with those that the whole
/// process shares, a quick picture would wait for a slow one.
fn options(cancel: &Cancel) -> RenderOptions {
    let options = RenderOptions::new().cancel(cancel.clone());
    let threads = options.thread_count();
    options.threads(threads)
}

fn coarse(size: Size) -> Result<Size, Error> {
    let quarter = |side: u32| side.div_ceil(4);
    let size = Size::new(quarter(size.width()), quarter(size.height()));
    size.map_err(|error| Error::refused(error.to_string()))
}

impl Scene {
    /// Returns what the ray through the center of a pixel hits; `x` counts from the left, `y` from
    /// the top.
    pub fn seen_at(&self, x: u32, y: u32) -> Option<Seen<'_>> {
        let (index, hit) = self.world().hit(&self.ray_at(x, y)?)?;
        let id = self.world().id_of(index, hit.face);
        Some(Seen {
            id,
            origin: self.origin(id),
            hit,
        })
    }

    fn ray_at(&self, x: u32, y: u32) -> Option<Ray> {
        let (width, height) = (self.size().width(), self.size().height());
        let y = height.checked_sub(y.checked_add(1)?)?;
        let ray = || {
            self.camera()
                .ray_for(width, height, f64::from(x), f64::from(y))
        };
        (x < width).then(ray)
    }

    /// Returns the layers that can be shown as a picture.
    pub fn shown_layers(&self) -> impl Iterator<Item = Layer> {
        let options = RenderOptions::new().depth_range(0.0, 1.0);
        let layers = Layer::ALL.iter().copied();
        layers.filter(move |layer| {
            let layout = self.layout(ImageFormat::PNG, &[*layer], options.settings);
            layout.is_ok_and(|layout| ImageFormat::PNG.holds(layout.pixel()))
        })
    }
}

/// Returns the point that a camera turns about: its `look_at`, or the depth of what the middle of
/// the picture shows, or else the end of `gaze`.
pub(super) fn pivot(scene: &Scene) -> DVec3 {
    let camera = scene.camera();
    let eye = camera.eye();
    let shown = || {
        let (_, hit) = scene.world().hit(&Ray::new(eye, -camera.w()))?;
        let bounds = hit.geometry.shape().bounds();
        let center = bounds.map_or(hit.point, |[low, high]| low.midpoint(high));
        let depth = (eye - center).dot(camera.w());
        Some(eye - camera.w() * depth.max(hit.t))
    };
    scene.target().or_else(shown).unwrap_or(eye + camera.gaze())
}

impl Error {
    /// Returns true if the work was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.kind() == ErrorKind::Interrupted
    }
}
