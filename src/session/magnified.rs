//! The picture of a view for a screen that has more pixels than it.

use crate::{
    diagnostic::error::Error,
    image_file::ImageFormat,
    parallel::Cancel,
    pipeline::Scene,
    session::view::{Quality, View},
};

impl View {
    /// The longest side of a magnified picture, in pixels.
    pub const LARGEST: u32 = 4096;

    /// Returns a PNG file of the view for a screen with more pixels than the picture: all samples, `factor`
    /// times the size or as large as [`View::LARGEST`] allows. Each pixel of the picture becomes a square of
    /// pixels, and outlines are as much wider. `None` if it would be the picture itself, and for an orthographic
    /// camera that stretches its pixels.
    ///
    /// # Errors
    ///
    /// Those of [`View::png`].
    pub fn magnified(
        &self,
        scene: &Scene,
        factor: u32,
        cancel: &Cancel,
    ) -> Result<Option<Vec<u8>>, Error> {
        let scene = self.of(scene)?;
        let (width, height) = (scene.size().width(), scene.size().height());
        let factor = factor.min(Self::LARGEST / width.max(height));
        let magnified = || scene.clone().magnified(factor);
        let Some(magnified) = (factor > 1).then(magnified).flatten() else {
            return Ok(None);
        };
        // The range of depths is that of the picture.
        let options = self.options(&scene, Quality::Full, cancel)?;
        let samples = self.samples.unwrap_or_else(|| scene.samples());
        let options = options.samples(scene.samples_magnified(samples, factor));
        let mut file = Vec::new();
        magnified.write_with(&mut file, ImageFormat::PNG, &options)?;
        Ok(Some(file))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{film::samples::Samples, render::layers::Layer, text::syntax::Syntax};

    fn decoded(file: &[u8]) -> image::RgbImage {
        image::load_from_memory(file).unwrap().to_rgb8()
    }

    #[test]
    fn pixels_of_a_magnified_picture_are_those_of_the_picture_divided() {
        let cancel = Cancel::new();
        for (camera, layer) in [
            (
                "Perspective(eye: (0, 1, 9), look_at: (0, 0, 0), fov: 30)",
                Layer::Color,
            ),
            ("Fit()", Layer::Color),
            (
                "Fit(from: (1, 2, 3), projection: Orthographic())",
                Layer::Normal,
            ),
            ("Fit()", Layer::Depth),
        ] {
            let text = format!(
                "(image: (width: 31, height: 17), camera: {camera}, geometries: [
                    Sphere(center: (-1, 0, 0), radius: 1.3, color: \"#f00\"),
                    Box(min: (0, -1, -1), max: (2, 0.5, 1), color: \"#0f0\"),
                ])"
            );
            let scene = Scene::from_text(text.as_str(), Syntax::Ron).unwrap();
            let view = View {
                layer,
                ..View::default()
            };
            let own = decoded(&view.png(&scene, Quality::Full, &cancel).unwrap());
            let large = view.magnified(&scene, 3, &cancel).unwrap().unwrap();
            let large = decoded(&large);
            assert_eq!(large.dimensions(), (93, 51));
            for (x, y, pixel) in own.enumerate_pixels() {
                let middle = large.get_pixel(3 * x + 1, 3 * y + 1);
                assert_eq!(middle, pixel, "{camera} {layer} ({x}, {y})");
            }
        }
    }

    #[test]
    fn a_magnified_picture_is_bounded() {
        let camera = "Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 30)";
        let text = format!("(image: (width: 400, height: 2), camera: {camera}, geometries: [])");
        let scene = Scene::from_text(text.as_str(), Syntax::Ron).unwrap();
        let width = |factor| {
            let file = View::default().magnified(&scene, factor, &Cancel::new());
            file.unwrap().map(|file| decoded(&file).width())
        };
        assert_eq!(width(u32::MAX), Some(4000));
        assert_eq!(width(2), Some(800));
        assert_eq!((width(0), width(1)), (None, None));
        let stretched = "Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 2, stretch: true)";
        let text = text.replace(camera, stretched);
        let scene = Scene::from_text(text.as_str(), Syntax::Ron).unwrap();
        let file = View::default().magnified(&scene, 2, &Cancel::new());
        assert_eq!(file.unwrap(), None);
    }

    #[test]
    fn lines_of_a_magnified_picture_are_as_wide_in_the_scene() {
        let text = "(
            image: (width: 60, height: 45, samples: 4),
            camera: Fit(),
            background: \"#fff\",
            outlines: (width: 2),
            geometries: [Sphere(center: (0, 0, 0), radius: 1, color: \"#fff\")],
        )";
        let scene = Scene::from_text(text, Syntax::Ron).unwrap();
        let (view, cancel) = (View::default(), Cancel::new());
        // Half of a pixel with the byte 188 is inked.
        let inked = |file: Vec<u8>| {
            let picture = decoded(&file);
            let pixels = picture.pixels().filter(|pixel| pixel.0[0] <= 188);
            pixels.count() as f64
        };
        let own = inked(view.png(&scene, Quality::Full, &cancel).unwrap());
        for factor in [2, 3] {
            let large = view.magnified(&scene, factor, &cancel).unwrap().unwrap();
            let ratio = inked(large) / own / f64::from(factor * factor);
            assert!((ratio - 1.0).abs() < 0.1, "{factor} {ratio}");
        }
        let side = |side: u32, factor| {
            let samples = Samples::new(side * side).unwrap();
            let fewer = scene.samples_magnified(samples.into(), factor);
            fewer.grid().unwrap().side()
        };
        assert_eq!([side(4, 2), side(4, 3), side(8, 2)], [2, 2, 4]);
        assert_eq!([side(1, 3), side(2, 2), side(4, 9)], [1, 2, 2]);
    }
}
