//! From a camera and a world to a picture, band by band.

use std::ops::Range;

use crate::{
    error::Error,
    film::{Film, Image, NOTHING, Size, SizeError},
    parallel::{Cancel, OnProgress, Pool},
    tracer::{camera::Camera, world::World},
};

/// How many pixels a band holds, if its rows are not longer than that.
const BAND: u32 = 1 << 18;
/// How many pixels a thread draws before it looks for other work.
const CHUNK: usize = 64;

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
        }
    }

    /// Draws the picture on the calling thread, by the plain loop of [`World::hit`]: the
    /// reference that anything faster is held to.
    pub fn draw(&self) -> Image {
        let mut pixels = Vec::new();
        for rows in bands(self.size) {
            let mut film = Film::new(self.size, &rows);
            self.trace(rows.start, 0, film.indices_mut());
            film.append_rgb8(self.world, &mut pixels);
        }
        Image::new(self.size, pixels)
    }

    /// Draws the picture on all threads of `pool` and hands it over in bands, from the top.
    pub(crate) fn draw_bands(
        &self,
        pool: &Pool,
        cancel: &Cancel,
        progress: Option<&OnProgress>,
        mut each: impl FnMut(&Film) -> Result<(), Error>,
    ) -> Result<(), Error> {
        for rows in bands(self.size) {
            let mut film = Film::new(self.size, &rows);
            pool.fill(film.indices_mut(), CHUNK, cancel, |first, indices| {
                self.trace(rows.start, first, indices);
                if let Some(progress) = progress {
                    progress(indices.len() as u64);
                }
            })?;
            each(&film)?;
        }
        Ok(())
    }

    /// Draws a run of pixels: `first` counts from the left end of the row `top`, which counts
    /// from the top of the picture.
    fn trace(&self, top: u32, first: usize, indices: &mut [u32]) {
        let (width, height) = (self.size.width(), self.size.height());
        let start = u64::from(top) * u64::from(width) + first as u64;
        for (pixel, index) in (start..).zip(indices) {
            let column = (pixel % u64::from(width)) as f64;
            let row = (pixel / u64::from(width)) as f64;
            let y = f64::from(height) - 1.0 - row;
            let ray = self.camera.ray_for(width, height, column, y);
            *index = match self.world.nearest(&ray) {
                // Scenes with 2^32 geometries do not fit into memory.
                Some((index, _, _)) => index as u32,
                None => NOTHING,
            };
        }
    }
}

/// The rows of a picture, cut into bands.
fn bands(size: Size) -> impl Iterator<Item = Range<u32>> {
    let rows = (BAND / size.width()).max(1);
    let tops = (0..size.height()).step_by(rows as usize);
    tops.map(move |top| top..(top + rows).min(size.height()))
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
            let size = Size::new(width, height).unwrap();
            let rows: Vec<u32> = bands(size).flatten().collect();
            assert!(rows.into_iter().eq(0..height));
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
            let append = |film: &Film| {
                film.append_rgb8(&world, &mut pixels);
                Ok(())
            };
            tracer
                .draw_bands(&pool, &Cancel::new(), None, append)
                .unwrap();
            assert!(pixels == expected.pixels(), "{threads} threads");
        }
    }
}
