//! The contents of a scene and the part of them that its picture shows.

use std::ops::Range;

use super::{Scene, options::RenderOptions, picture::Aovs};
use crate::{
    data::table::row_cells::RowCells,
    diagnostic::error::Error,
    film::{Centers, Wanted, samples::Samples},
    parallel::{Cancel, Pool},
    render::visibility::{Seen, Tally},
    scene::{
        locate::range_of,
        origin::{Container, Origin},
        part::PartPlace,
        scales::ColorValues,
    },
    tracer::{colormap::scale::ColorScale, shape::Shape},
};

/// The columns of the row of a table of spheres.
const SPHERE: [&str; 4] = ["x", "y", "z", "radius"];
/// Those of cylinders.
const CYLINDER: [&str; 7] = ["x1", "y1", "z1", "x2", "y2", "z2", "radius"];

impl Scene {
    /// Returns the position in the scene of a geometry, by its index in the world. Each row of a
    /// table and each geometry of a group is one of its own; those of a part have the position of
    /// the part.
    pub fn origin(&self, index: usize) -> Origin {
        self.origins.of(index)
    }

    /// Returns the places of a geometry in the parts that hold it, by its index in the world: first
    /// in the part that the scene names. A geometry of the scene itself has none.
    pub fn places_in_parts(&self, index: usize) -> Vec<PartPlace<'_>> {
        let mut places = Vec::new();
        if let Some((part, index)) = self.origins.part_of(index) {
            part.add_to(&mut places, index);
        }
        places
    }

    /// Returns the ids of a geometry of the scene: one, or those of the rows of a table, of the copies in a
    /// list, or of the geometries of a part or a group.
    pub(crate) fn ids(&self, origin: &Origin) -> Range<usize> {
        self.origins.ids(origin)
    }

    /// Returns the name of a geometry in the scene, by its index in the world. All rows of a table
    /// have the name of the table, and all geometries of a part that of the part.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Scene, Syntax};
    ///
    /// let text = r##"(
    ///     camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    ///     geometries: [
    ///         Sphere(center: (2, 0, -3), radius: 0.5, color: "#00ff00"),
    ///         Sphere(center: (0, 0, -3), radius: 0.5, color: "#ff0000", name: "ball"),
    ///     ],
    /// )"##;
    /// let scene = Scene::from_text(text, Syntax::Ron)?;
    /// assert_eq!([scene.name(0), scene.name(1)], [None, Some("ball")]);
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn name(&self, index: usize) -> Option<&str> {
        self.origins.name(index)
    }

    /// Returns the names of the groups that hold a geometry, by its index in the world, the outermost
    /// first. Groups without a name are left out.
    pub fn groups(&self, index: usize) -> Vec<&str> {
        self.origins.groups(index)
    }

    /// Returns each table and each mesh whose values determine its colors, in the order of the scene.
    pub fn color_values(&self) -> impl Iterator<Item = ColorValues<'_>> {
        self.scales.all(&self.world, &self.origins).into_iter()
    }

    /// Returns the value that determines the color of a row of a table, by its index in the world, and
    /// the colors of all values of the table; `None` if no value does. Those of a mesh depend on the
    /// point: see [`Hit::interpolation`](crate::Hit::interpolation).
    pub fn value(&self, index: usize) -> Option<(f64, &ColorScale)> {
        self.scales.of(index)
    }

    /// Returns the cells of a geometry that is a row of a table of spheres or cylinders, by its index in
    /// the world and its shape: the numbers that give it its place, its size and its color by value. Empty for
    /// any other geometry.
    pub fn row_cells(&self, index: usize, shape: &Shape) -> RowCells {
        let names: &[&str] = match shape {
            _ if self.origin(index).row.is_none() => &[],
            Shape::Sphere(_) => &SPHERE,
            Shape::Cylinder(_) => &CYLINDER,
            _ => &[],
        };
        let mut numbers = Vec::new();
        shape.each_number(|number| numbers.push(number));
        let value = self
            .value(index)
            .map(|(value, scale)| (&*scale.column, value));
        RowCells::of_scene(names.iter().copied().zip(numbers).chain(value))
    }

    /// Returns the cells of all columns of a row, read again from its file; those of [`Scene::row_cells`] if
    /// the file has changed, or cannot be read. Reading ends soon after `cancel` is cancelled.
    pub fn row_cells_in_file(&self, index: usize, shape: &Shape, cancel: &Cancel) -> RowCells {
        let found = self.origins.row_of(index);
        let cells = found.and_then(|(table, row)| table.cells(row, cancel));
        cells.unwrap_or_else(|| self.row_cells(index, shape))
    }

    /// Returns the position in the scene text of a geometry, by its index in the world.
    ///
    /// The range is in bytes, with the end exclusive. A row of a table has the range of the
    /// geometry that names the table, a geometry of a part that of the part. `None` if the text was not kept
    /// ([`ReadOptions::keep_text`](crate::ReadOptions::keep_text)).
    ///
    /// # Examples
    ///
    /// From a pixel to the text:
    ///
    /// ```
    /// use strahl::{Document, Scene, Syntax};
    ///
    /// let text = r##"(
    ///     camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    ///     geometries: [Sphere(center: (0, 0, -3), radius: 1, color: "#ff0000")],
    /// )"##;
    /// let scene = Scene::from_text(text, Syntax::Ron)?;
    /// let seen = scene.geometry_at(320, 240).and_then(|index| scene.text_range(index));
    /// assert!(text[seen.unwrap()].starts_with("Sphere("));
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn text_range(&self, index: usize) -> Option<Range<usize>> {
        let path = self.origin(index).path();
        range_of(self.source.text(), self.source.tree(), path.steps())
    }

    /// Returns the index in the world of the geometry at the center of a pixel, or `None` if the
    /// pixel shows the background.
    ///
    /// The picture has the size given by the scene; `x` counts from the left, `y` from the top.
    pub fn geometry_at(&self, x: u32, y: u32) -> Option<usize> {
        let (width, height) = (self.size.width(), self.size.height());
        let y = height.checked_sub(y.checked_add(1)?)?;
        let camera = self.camera();
        let ray = camera.ray_for(width, height, f64::from(x), f64::from(y));
        self.world.hit(&ray).map(|(index, _)| index)
    }

    /// Returns the tables, parts and copies of the scene, in scene order.
    pub fn containers(&self) -> impl Iterator<Item = Container<'_>> {
        self.origins.containers().into_iter()
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
