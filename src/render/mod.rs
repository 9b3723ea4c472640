//! From a camera and a world to a picture, band by band.

use std::ops::Range;

use crate::{
    accel::{
        bins::TILE,
        first_hits::{FirstHits, Work},
        footprint::Region,
    },
    colors::ColorTable,
    error::Error,
    film::{Film, Image, Size, SizeError},
    parallel::{Cancel, OnProgress, Pool},
    simd::Isa,
    tracer::{camera::Camera, world::World},
};

/// How many pixels a band holds, if its rows are not longer than a [`TILE`]th of that.
const BAND: u32 = 1 << 18;
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
            isa: Isa::best(),
        }
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
        let _ = self.draw_bands(&Pool::Calling, &Cancel::new(), None, append);
        Image::new(self.size, pixels)
    }

    /// Finds what every pixel sees, on so many threads, and forgets it: for timing that alone.
    #[doc(hidden)]
    pub fn trace(&self, threads: usize) -> Result<(), Error> {
        let pool = Pool::new(Some(threads))?;
        pool.install(|| self.draw_bands(&pool, &Cancel::new(), None, |_| Ok(())))
    }

    /// Draws the picture on all threads of `pool` and hands it over in bands, from the top.
    pub(crate) fn draw_bands(
        &self,
        pool: &Pool,
        cancel: &Cancel,
        progress: Option<&OnProgress>,
        mut each: impl FnMut(Film) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let hits = FirstHits::new(self.camera, self.world, self.size, self.isa);
        let width = self.size.width();
        let slab_rows = rows(SLAB, width).min(Region::MAX_SIDE);
        for slab in cut(0..self.size.height(), slab_rows) {
            cancel.check()?;
            let prepared = hits.slab(slab.clone(), pool);
            for band in cut(slab, rows(BAND, width)) {
                let mut film = Film::new(self.size, &band);
                let work = Work {
                    pool,
                    cancel,
                    progress,
                };
                hits.draw(&prepared, band, film.indices_mut(), work)?;
                each(film)?;
            }
        }
        Ok(())
    }
}

/// How many rows hold about so many pixels: a multiple of [`TILE`], and not 0.
fn rows(pixels: u32, width: u32) -> u32 {
    (pixels / width).max(TILE) / TILE * TILE
}

/// A range in pieces of a length; the last may be shorter.
fn cut(range: Range<u32>, length: u32) -> impl Iterator<Item = Range<u32>> {
    let starts = range.clone().step_by(length as usize);
    starts.map(move |start| start..(start + length).min(range.end))
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
    fn bands_cover_every_row_once() {
        for (width, height) in [(1, 1), (1, 300_000), (1_000_000, 3), (1000, 1000)] {
            let bands = cut(0..height, rows(BAND, width));
            assert!(bands.flatten().eq(0..height));
        }
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
            let pool = Pool::new(Some(threads)).unwrap();
            let table = ColorTable::rgb8(&world);
            let append = |film: Film| {
                film.append(&table, &mut pixels);
                Ok(())
            };
            tracer
                .draw_bands(&pool, &Cancel::new(), None, append)
                .unwrap();
            assert!(pixels == expected.pixels(), "{threads} threads");
        }
    }
}
