//! The renderer: from a camera and a world to a picture, band by band.

use crate::{
    accel::raster::{
        first_hits::{FirstHits, Work, cut},
        grouping::TILE,
    },
    diagnostic::{error::Error, setters::setters},
    film::{
        Centers, Film, Image, Outlines, Wanted,
        colors::ColorTable,
        crop::Crop,
        resolve::Resolver,
        samples::{SampleCount, Samples},
        size::{Size, SizeError},
    },
    integrator::accelerated::Accelerated,
    parallel::{
        Cancel, Pool,
        timings::{Stage, Timings},
    },
    render::shading::{Shading, picture_sums::PictureSums},
    simd::isa::Isa,
    tracer::{camera::Camera, tone::Tone, world::World},
};

/// The number of pixels prepared at once, for rows of at most `SLAB` / [`TILE`] pixels.
const SLAB: u32 = 1 << 26;

/// Renders the view of a camera into a world, with one ray through the center of each pixel by
/// default.
///
/// # Examples
///
/// ```
/// use strahl::{Color, Geometry, PerspectiveCamera, RayTracer, Sphere, Vec3, World};
///
/// let camera = PerspectiveCamera::new(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.5)?.into();
/// let mut world = World::default();
/// let ball = Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5)?;
/// world.push(Geometry::new(ball, Color::new(1.0, 0.0, 0.0)));
///
/// let image = RayTracer::new(&camera, &world, 32, 24)?.draw();
/// assert_eq!(image.pixel(16, 12), Some([255, 0, 0]));
/// assert_eq!(image.pixel(0, 0), Some([0, 0, 0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RayTracer<'a> {
    camera: &'a Camera,
    world: &'a World,
    size: Size,
    samples: Samples,
    paths: Option<SampleCount>,
    known: Option<&'a PictureSums>,
    tone: Tone,
    outlines: Option<Outlines>,
    isa: Isa,
}

impl<'a> RayTracer<'a> {
    /// Prepares a picture of `width` times `height` pixels.
    ///
    /// # Errors
    ///
    /// Returns an error if the size exceeds the limits of [`Size`].
    pub fn new(
        camera: &'a Camera,
        world: &'a World,
        width: u32,
        height: u32,
    ) -> Result<Self, SizeError> {
        Ok(Self::with_size(camera, world, Size::new(width, height)?))
    }

    pub(crate) fn with_size(camera: &'a Camera, world: &'a World, size: Size) -> Self {
        Self {
            camera,
            world,
            size,
            samples: Samples::ONE,
            paths: None,
            known: None,
            tone: world.tone(Tone::default()),
            outlines: None,
            isa: Isa::best(),
        }
    }

    /// Sets the exposure and the tone mapping of a lit picture; a flat one has none.
    #[must_use]
    pub fn tone(mut self, tone: Tone) -> Self {
        self.tone = self.world.tone(tone);
        self
    }

    setters! {
        /// Sets the number of rays per pixel; the default is one. A pixel shows the mean of their
        /// colors, taken in linear light.
        samples(samples: Samples) => samples = samples;

        /// Sets the number of paths per pixel, where light follows paths; the default is that of the world.
        paths(paths: impl Into<Option<SampleCount>>) => paths = paths.into();

        /// Sets the sums of the paths that are known already.
        known(known: Option<&'a PictureSums>) => known = known;

        /// Sets the outlines; there are none by default.
        outlines(outlines: impl Into<Option<Outlines>>) => outlines = outlines.into();

        /// Sets an instruction set other than the best one of the processor. The picture is the same
        /// for each.
        #[doc(hidden)]
        isa(isa: Isa) => isa = isa;
    }

    /// Returns true if the picture is shaded sample by sample; otherwise, a pixel shows the color of
    /// a geometry, or a mean of some.
    pub(crate) fn is_shaded(&self, wanted: Wanted) -> bool {
        match wanted {
            Wanted::Hits => false,
            Wanted::Bytes(_) | Wanted::Light => !self.world.is_plain() || self.outlines.is_some(),
            Wanted::Parts => true,
        }
    }

    /// Renders the picture on the calling thread. Each pixel shows the result of [`World::hit`] for
    /// its ray or, in a lit world, of [`World::radiance`].
    pub fn draw(&self) -> Image {
        let mut pixels = Vec::new();
        let table = ColorTable::rgb8(self.world);
        let append = |film: Film| {
            if self.is_shaded(Wanted::Light) {
                film.append_lit(&mut pixels);
            } else {
                film.append(&table, &mut pixels);
            }
            Ok(())
        };
        // Nothing cancels this, and appending cannot fail.
        let _ = self.draw_alone(&Pool::Calling, append);
        Image::new(self.size, pixels)
    }

    /// Returns a function that traces the picture on this many threads and discards the result, to
    /// time tracing alone.
    #[doc(hidden)]
    pub fn tracing(&self, threads: usize) -> Result<impl Fn() -> Result<(), Error>, Error> {
        let pool = Pool::new(Some(threads));
        Ok(move || self.draw_alone(&pool, |_| Ok(())))
    }

    fn draw_alone(
        &self,
        pool: &Pool,
        take: impl FnMut(Film) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let (cancel, timings) = (Cancel::new(), Timings::new());
        let work = Work {
            pool,
            cancel: &cancel,
            progress: None,
            watch: &timings.shared_watch(Stage::Trace),
            kept: None,
            resolver: Resolver::new(self.world),
            centers: Centers::Unneeded,
            wanted: Wanted::Bytes(self.tone),
        };
        self.draw_bands(Crop::whole(self.size), work, take)
    }

    /// Renders a part of the picture and passes it on in bands, from the top.
    pub(crate) fn draw_bands(
        &self,
        crop: Crop,
        work: Work,
        mut take: impl FnMut(Film) -> Result<(), Error>,
    ) -> Result<(), Error> {
        if self.is_shaded(work.wanted) {
            let queries = self.queries(work);
            return self.shading(&queries).draw(crop, work, &mut take);
        }
        let hits = FirstHits::new(self.camera, self.world, self.size, self.samples, self.isa);
        let (columns, rows) = (crop.columns(), crop.rows());
        let slab = (SLAB / columns.len() as u32).max(TILE) / TILE * TILE;
        cut(rows, slab).try_for_each(|rows| hits.draw(columns.clone(), rows, work, &mut take))
    }

    /// Adds samples to the sums of a part of the picture, as [`Shading::add_rounds`] does.
    pub(crate) fn add_rounds(
        &self,
        crop: Crop,
        work: Work,
        sums: Option<PictureSums>,
        next: impl FnMut(&PictureSums) -> Result<Option<u32>, Error>,
    ) -> Result<PictureSums, Error> {
        let queries = self.queries(work);
        self.shading(&queries).add_rounds(crop, work, sums, next)
    }

    fn queries<'w>(&self, work: Work<'w>) -> Accelerated<'w>
    where
        'a: 'w,
    {
        Accelerated::new((self.world, work.kept), work.builder(self.isa))
    }

    fn shading<'s, Q>(&'s self, queries: &'s Q) -> Shading<'s, Q> {
        Shading {
            camera: self.camera,
            world: self.world,
            queries,
            size: self.size,
            samples: self.samples,
            paths: self.paths,
            known: self.known,
            outlines: self.outlines,
            tone: self.tone,
            isa: self.isa,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::tracer::{
        camera::perspective::PerspectiveCamera,
        color::Color,
        geometry::Geometry,
        shape::{cuboid::Cuboid, sphere::Sphere},
        tone::ToneMapping,
    };

    fn camera() -> Camera {
        let camera = PerspectiveCamera::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 0.5);
        camera.unwrap().into()
    }

    fn world() -> World {
        let mut world = World::default();
        for (x, y) in [(-1.0, -1.0), (1.0, 1.0), (1.5, 0.5)] {
            let ball = Sphere::new(DVec3::new(x, y, -5.0), 1.0).unwrap();
            world.push(Geometry::new(ball, Color::new(0.5, 0.25 + x / 8.0, 1.0)));
        }
        world
    }

    #[test]
    fn row_0_is_the_top() {
        let (camera, world) = (camera(), world());
        let image = RayTracer::new(&camera, &world, 64, 64).unwrap().draw();
        assert_eq!(
            image.pixel(44, 20),
            Some([128, 96, 255]),
            "the ball at the upper right"
        );
        assert_eq!(
            image.pixel(20, 20),
            Some([0, 0, 0]),
            "nothing at the upper left"
        );
    }

    #[test]
    fn each_face_shows_its_own_color() {
        let [red, white] = [Color::new(1.0, 0.0, 0.0), Color::WHITE];
        let cube = Cuboid::new(DVec3::new(-1.0, -1.0, -6.0), DVec3::new(1.0, 0.5, -4.0)).unwrap();
        // The camera looks at the upper side, face 3, from above.
        let eye = DVec3::new(0.0, 4.0, 0.0);
        let camera = PerspectiveCamera::new(eye, DVec3::new(0.0, -4.0, -5.0), DVec3::Y, 0.5);
        let camera = camera.unwrap().into();
        let cube = Geometry::new(cube, white).by_face([white, white, white, red]);
        // Half a level, and a tone that a flat picture does not have.
        let background = Color::new(0.5, 253.5 / 255.0, 0.1);
        let world = World::new(vec![cube], background);
        for samples in [1, 4, 9, 3600] {
            let tracer = RayTracer::new(&camera, &world, 64, 64).unwrap();
            let tracer = tracer.tone(Tone::new(1.0, ToneMapping::Neutral));
            let image = tracer.samples(Samples::new(samples).unwrap()).draw();
            assert_eq!(image.pixel(32, 30), Some([255, 0, 0]), "the upper side");
            assert_eq!(image.pixel(32, 44), Some([255; 3]), "the front");
            assert_eq!(image.pixel(0, 0), Some(background.to_rgb8()));
        }
    }

    #[test]
    fn any_number_of_threads_renders_the_same_picture() {
        let (camera, world) = (camera(), world());
        let tracer = RayTracer::new(&camera, &world, 700, 500).unwrap();
        let expected = tracer.draw();
        for threads in [1, 2, 3, 16] {
            let mut pixels = Vec::new();
            let pool = Pool::new(Some(threads));
            let table = ColorTable::rgb8(&world);
            let append = |film: Film| {
                film.append(&table, &mut pixels);
                Ok(())
            };
            tracer.draw_alone(&pool, append).unwrap();
            assert!(pixels == expected.pixels(), "{threads} threads");
        }
    }
}
