//! From a camera and a world to a picture, band by band.

use crate::{
    accel::raster::{
        first_hits::{FirstHits, Work, cut},
        grouping::TILE,
    },
    diagnostic::error::Error,
    film::{
        Centers, Film, Image,
        colors::ColorTable,
        crop::Crop,
        resolve::Resolver,
        samples::Samples,
        size::{Size, SizeError},
    },
    parallel::{
        Cancel, Pool,
        timings::{Stage, Timings},
    },
    simd::Isa,
    tracer::{camera::Camera, world::World},
};

/// How many pixels are prepared at once, if rows are not longer than a [`TILE`]th of that.
const SLAB: u32 = 1 << 26;

/// Draws what a camera sees of a world, one ray through the center of each pixel.
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
    isa: Isa,
}

impl<'a> RayTracer<'a> {
    /// Prepares a picture of `width` times `height` pixels.
    ///
    /// # Errors
    ///
    /// A size outside of the limits of [`Size`].
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
            isa: Isa::best(),
        }
    }

    /// With so many rays through each pixel instead of one. A pixel shows the mean of what they
    /// see, taken in linear light.
    #[must_use]
    pub fn samples(mut self, samples: Samples) -> Self {
        self.samples = samples;
        self
    }

    /// With other instructions than the best that the processor has; the picture is the same.
    #[doc(hidden)]
    pub fn isa(mut self, isa: Isa) -> Self {
        self.isa = isa;
        self
    }

    /// Draws the picture on the calling thread. Each pixel is what [`World::hit`] says of its
    /// ray.
    pub fn draw(&self) -> Image {
        let mut pixels = Vec::new();
        let table = ColorTable::rgb8(self.world);
        let append = |film: Film| {
            film.append(&table, &mut pixels);
            Ok(())
        };
        // Nobody cancels, and appending does not fail.
        let _ = self.draw_alone(&Pool::Calling, append);
        Image::new(self.size, pixels)
    }

    /// What finds all that the pixels see, on so many threads, and forgets it: for timing that
    /// alone.
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
            resolver: Resolver::new(self.world),
            centers: Centers::Unneeded,
        };
        self.draw_bands(Crop::whole(self.size), work, take)
    }

    /// Draws a part of the picture and hands it over in bands, from the top.
    pub(crate) fn draw_bands(
        &self,
        crop: Crop,
        work: Work,
        mut take: impl FnMut(Film) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let hits = FirstHits::new(self.camera, self.world, self.size, self.samples, self.isa);
        let (columns, rows) = (crop.columns(), crop.rows());
        let slab = (SLAB / columns.len() as u32).max(TILE) / TILE * TILE;
        cut(rows, slab).try_for_each(|rows| hits.draw(columns.clone(), rows, work, &mut take))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::tracer::{
        camera::perspective::PerspectiveCamera, color::Color, geometry::Geometry,
        shape::sphere::Sphere,
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
    fn any_number_of_threads_draws_the_same_picture() {
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
