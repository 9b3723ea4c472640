//! The contents of a scene and the part of them that its picture shows.

use std::ops::Range;

use super::{Scene, options::RenderOptions, picture::Aovs};
use crate::{
    diagnostic::error::Error,
    film::{Centers, Wanted, samples::Samples},
    parallel::Pool,
    render::visibility::{Seen, Tally},
    scene::origin::{InstancesOf, PartGeometries, TableRows},
};

impl Scene {
    /// Returns the tables of the scene, in scene order.
    pub fn tables(&self) -> impl Iterator<Item = TableRows<'_>> {
        self.origins.tables()
    }

    /// Returns the parts that the scene names, in scene order.
    pub fn parts(&self) -> impl Iterator<Item = PartGeometries<'_>> {
        self.origins.parts()
    }

    /// Returns the geometries of the scene that are copies of another, in scene order.
    pub fn instances(&self) -> impl Iterator<Item = InstancesOf<'_>> {
        self.origins.instances()
    }

    /// Returns the geometries hit by the rays through the pixel centers, in the order of the world.
    ///
    /// The number of samples per pixel does not matter. With a crop, only its pixels count.
    ///
    /// # Errors
    ///
    /// A crop that does not lie in the picture, and a cancelled render.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{RenderOptions, Scene, Syntax};
    ///
    /// let text = r##"(
    ///     image: (width: 5, height: 3),
    ///     camera: Orthographic(eye: (0, 0, 0), gaze: (0, 0, -1), scale: 2),
    ///     geometries: [
    ///         Sphere(center: (9, 0, -3), radius: 0.5, color: "#00ff00"),
    ///         Sphere(center: (1, 0, -3), radius: 0.5, color: "#ff0000"),
    ///     ],
    /// )"##;
    /// let seen = Scene::from_text(text, Syntax::Ron)?.seen(&RenderOptions::new())?;
    /// let [ball] = &seen[..] else { panic!("one is beside the picture") };
    /// assert_eq!((ball.id, ball.pixels, ball.bounds), (1, 1, [3, 1, 1, 1]));
    /// assert_eq!((ball.nearest, ball.farthest), (2.5, 2.5));
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn seen(&self, options: &RenderOptions) -> Result<Vec<Seen>, Error> {
        let crop = self.crop(options)?;
        let mut tally = Tally::new(self.world.ids(), crop);
        let pool = Pool::new(options.threads);
        let options = options.clone().samples(Samples::ONE);
        let watch = options.timings.watch();
        let aovs = Aovs {
            centers: Centers::Hits,
            wanted: Wanted::Hits,
            ..Aovs::default()
        };
        self.draw(&options, &watch, aovs, |film| {
            tally.add(&film, &pool);
            Ok(())
        })?;
        Ok(tally.finish())
    }

    /// Returns, for each pixel row by row from the top left, whether the ray through its center
    /// hits one of these geometries, given by their indices in the world.
    pub(crate) fn mask(
        &self,
        geometries: &Range<usize>,
        options: &RenderOptions,
    ) -> Result<Vec<bool>, Error> {
        let options = options.clone().samples(Samples::ONE);
        let watch = options.timings.watch();
        let aovs = Aovs {
            centers: Centers::Ids,
            wanted: Wanted::Hits,
            ..Aovs::default()
        };
        let mut mask = Vec::new();
        self.draw(&options, &watch, aovs, |film| {
            let ids = film.runs().flat_map(|run| run.ids);
            // No geometry has the largest number, which stands for a miss.
            mask.extend(ids.map(|id| geometries.contains(&(*id as usize))));
            Ok(())
        })?;
        Ok(mask)
    }
}
