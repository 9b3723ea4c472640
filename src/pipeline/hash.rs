//! The inputs of a picture, as a hash and as text.

use std::path::Path;

use glam::DVec3;

use crate::{
    diagnostic::error::Error,
    pipeline::{Scene, fingerprint::Fingerprint, options::RenderOptions},
    tracer::camera::Camera,
};

impl Scene {
    /// Returns a hash of everything the file of a picture depends on, as 64 hexadecimal digits.
    ///
    /// It covers the values of the scene, its tables and its parts, every option that changes a byte, the
    /// format, and the version of this program.
    ///
    /// # Errors
    ///
    /// An unknown file extension.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{RenderOptions, Scene};
    ///
    /// let scene = Scene::from_path("scenes/sphere.ron")?;
    /// let hash = |name: &str, options| scene.hash(name, &options);
    /// let one = hash("one.png", RenderOptions::new())?;
    /// assert_eq!(one, hash("other.png", RenderOptions::new().threads(3))?);
    /// assert_ne!(one, hash("one.ppm", RenderOptions::new())?);
    /// assert_ne!(one, hash("one.png", RenderOptions::new().metadata(true))?);
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn hash(&self, path: impl AsRef<Path>, options: &RenderOptions) -> Result<String, Error> {
        let mut fingerprint = Fingerprint::default();
        let (picture, file) = options.in_words(self.size, self.samples());
        let camera = self.camera_of(options)?;
        fingerprint.text(&self.fingerprint(&picture, &camera));
        fingerprint.text(options.format_of(path.as_ref())?.name());
        fingerprint.text(&file);
        fingerprint.names(&self.origins);
        Ok(fingerprint.digits())
    }

    /// Returns the version, the camera, and a hash of everything the picture shows.
    pub(super) fn about(&self, options: &RenderOptions) -> Result<Vec<(String, String)>, Error> {
        let camera = self.camera_of(options)?;
        let entry = |name: &str, text: String| (name.to_owned(), text);
        let (picture, _) = options.in_words(self.size, self.samples());
        let count = options.samples.unwrap_or_else(|| self.samples());
        let samples = || entry("Samples", count.to_string());
        let samples = self.world.paths().map(|_| samples());
        let about = vec![
            entry("Software", format!("strahl {}", env!("CARGO_PKG_VERSION"))),
            entry("Scene", self.fingerprint(&picture, &camera)),
            entry("Camera", in_words(&camera)),
        ];
        Ok(about.into_iter().chain(samples).collect())
    }

    /// Returns a hash of everything that the sums of the samples of a picture depend on, but for their number.
    pub(super) fn hash_of_sums(&self, options: &RenderOptions) -> Result<String, Error> {
        let camera = self.camera_of(options)?;
        let is_transparent = options.settings.is_transparent;
        let noise = self.world.paths().and_then(|paths| paths.noise);
        // The noise of a block is that after exposure.
        let exposure = noise.map(|_| self.tone.exposure());
        let size = options.size.unwrap_or(self.size);
        let words = format!(
            "{size} {} {is_transparent} {exposure:?}",
            self.crop(options)?
        );
        let mut fingerprint = Fingerprint::default();
        fingerprint.text(env!("CARGO_PKG_VERSION"));
        fingerprint.text(&words);
        fingerprint.camera(&camera);
        fingerprint.text(self.world_hash.of(&self.world));
        Ok(fingerprint.digits())
    }

    /// Returns a hash of everything the pixels depend on; `options` is the text of the options.
    fn fingerprint(&self, options: &str, camera: &Camera) -> String {
        let mut fingerprint = Fingerprint::default();
        fingerprint.text(env!("CARGO_PKG_VERSION"));
        fingerprint.text(options);
        fingerprint.camera(camera);
        fingerprint.text(self.world_hash.of(&self.world));
        let tone = self.world.lighting().map(|_| self.tone);
        fingerprint.develop(tone, self.outlines.as_ref());
        fingerprint.digits()
    }
}

/// Formats a camera as in a scene file. It is the same camera except for the rounding of an angle
/// in degrees.
fn in_words(camera: &Camera) -> String {
    let vector = |vector: DVec3| format!("({:?}, {:?}, {:?})", vector.x, vector.y, vector.z);
    let (eye, gaze, up) = (
        vector(camera.eye()),
        vector(-camera.w()),
        vector(camera.v()),
    );
    match camera {
        Camera::Perspective(camera) => {
            let fov = camera.half_angle().to_degrees() * 2.0;
            let lens = camera.lens().map_or_else(String::new, |[aperture, focus]| {
                format!(", aperture: {aperture:?}, focus: {focus:?}")
            });
            format!("Perspective(eye: {eye}, gaze: {gaze}, up: {up}, fov: {fov:?}{lens})")
        }
        Camera::Orthographic(camera) => {
            let (scale, stretch) = (camera.scale(), camera.stretch());
            let stretch = if stretch { ", stretch: true" } else { "" };
            format!("Orthographic(eye: {eye}, gaze: {gaze}, up: {up}, scale: {scale:?}{stretch})")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        film::{crop::Crop, samples::Samples, size::Size},
        image_file::{Compression, ImageFormat, Palette},
        parallel::{Cancel, timings::Timings},
        render::{layers::Layer, shading::picture_sums::PictureSums},
        simd::isa::Isa,
        text::syntax::Syntax,
    };

    const SCENE: &str = "(image: (width: 40, height: 30), \
        camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90), \
        geometries: [Sphere(center: (0.3, 0, -3), radius: 1.5, color: (1, 0.4, 0.2))])";

    /// The options that do not change a byte.
    const SAME: [&str; 6] = ["sums", "threads", "cancel", "progress", "timings", "isa"];

    /// Every option with a value other than its default, by field name. Leaving out a field is a
    /// compile error.
    fn changed() -> Vec<(&'static str, RenderOptions)> {
        let new = RenderOptions::new;
        macro_rules! each {
            ($($field:ident: $options:expr),* $(,)?) => {{
                let RenderOptions { $($field: _),* } = new();
                vec![$((stringify!($field), $options)),*]
            }};
        }
        each! {
            format: new().format(ImageFormat::TIFF),
            size: new().size(Size::new(20, 20).unwrap()),
            crop: new().crop(Crop::new(10, 10, 20, 12).unwrap()),
            samples: new().samples(Samples::new(4).unwrap()),
            sums: new().sums(PictureSums::new((0..1, 0..1), Size::new(1, 1).unwrap()).unwrap()),
            layers: new().layers([Layer::Coverage]),
            settings: new().transparent(true),
            quality: new().format(ImageFormat::JPEG).quality(20),
            metadata: new().metadata(true),
            threads: new().threads(3),
            compression: new().compression(Compression::Small),
            palette: new().palette(Palette::Auto),
            cancel: new().cancel(Cancel::default()),
            progress: new().on_progress(|_| ()),
            timings: new().timings(Timings::new()),
            isa: new().isa(Isa::all()[0]),
        }
    }

    #[test]
    fn files_have_the_same_hash_if_and_only_if_they_have_the_same_bytes() {
        let scene = Scene::from_text(SCENE, Syntax::Ron).unwrap();
        let bytes = |options: &RenderOptions| {
            let mut bytes = Vec::new();
            let format = options.format.unwrap_or(ImageFormat::PNG);
            scene.write_with(&mut bytes, format, options).unwrap();
            bytes
        };
        for (field, options) in changed() {
            // Quality needs a format that uses it.
            let plain = match field {
                "quality" => RenderOptions::new().format(ImageFormat::JPEG),
                _ => RenderOptions::new(),
            };
            let hash = |options| scene.hash("a.png", options).unwrap();
            let same = bytes(&options) == bytes(&plain);
            assert_eq!(same, SAME.contains(&field), "{field} changes the bytes");
            assert_eq!(hash(&options) == hash(&plain), same, "{field}");
        }
    }

    #[test]
    fn everything_about_light_is_in_the_hash() {
        let scene = |fields: &str, surface: &str| {
            let text = SCENE.replace("color: (1, 0.4, 0.2)", surface);
            let text = text.replace("geometries", &format!("{fields} geometries"));
            Scene::from_text(text, Syntax::Ron).unwrap()
        };
        let options = RenderOptions::new();
        let of = |scene: &Scene| scene.hash("a.png", &options).unwrap();
        let white = "color: (1, 1, 1)";
        let hash = |fields: &str| of(&scene(fields, white));
        let lit = |fields: &str| hash(&format!("lights: [Headlight()], {fields}"));
        let shiny = |surface| of(&scene("lights: [Headlight()],", surface));
        let gold = |material: &str| {
            let fields = format!("lights: [Headlight()], materials: {{\"gold\": {material}}},");
            of(&scene(&fields, "material: Named(\"gold\")"))
        };
        let image = |fields: &str| {
            let text = SCENE.replace("height: 30", &format!("height: 30, {fields}"));
            let text = text.replace("geometries", "lights: [Headlight()], geometries");
            let text = text.replace("(1, 0.4, 0.2)", "(1, 1, 1)");
            of(&Scene::from_text(text, Syntax::Ron).unwrap())
        };
        let hashes = [
            hash(""),
            lit(""),
            hash("lights: [Ambient()],"),
            hash("lights: [Ambient(intensity: 0.3)],"),
            hash("lights: [Directional(direction: (0, 0, -1))],"),
            hash("lights: [Directional(direction: (0, 0, -1), shadows: false)],"),
            hash("lights: [Point(position: (0, 0, 2))],"),
            hash("lights: [Point(position: (0, 0, 2), falloff: Constant)],"),
            hash("lights: [Spot(position: (0, 0, 2), direction: (0, 0, -1), angle: 9)],"),
            hash("lights: [Spot(position: (0, 0, 2), direction: (0, 0, -1), angle: 9, blend: 1)],"),
            lit("lighting: Direct(max_depth: 3),"),
            lit("lighting: Path(),"),
            lit("lighting: Path(samples: 9),"),
            lit("lighting: Path(noise: 0.1),"),
            lit("lighting: Path(seed: 1),"),
            hash("outlines: (),"),
            hash("outlines: (width: 2),"),
            hash("outlines: (color: \"#fff\"),"),
            hash("outlines: (depth: 0),"),
            hash("outlines: (creases: 0),"),
            lit("outlines: (),"),
            shiny("material: Flat(color: (1, 1, 1))"),
            shiny("material: Emissive(color: (1, 1, 1), intensity: 2)"),
            shiny("material: Mirror()"),
            shiny("material: Glass()"),
            shiny("material: Glass(ior: 1.4)"),
            gold("Phong(diffuse: (1, 1, 1))"),
            gold("Phong(diffuse: (1, 1, 1), exponent: 9)"),
            gold("Phong(diffuse: (1, 1, 1), reflection: (0, 0, 1))"),
            image("exposure: 1"),
            image("tone_mapping: Neutral"),
        ];
        for (index, hash) in hashes.iter().enumerate() {
            assert!(!hashes[..index].contains(hash), "{index}");
        }
        assert_eq!(shiny("material: Matte(color: (1, 1, 1))"), lit(""));
        assert_eq!(image("exposure: 0, tone_mapping: Clip"), lit(""));
    }

    #[test]
    fn each_setting_of_layers_is_in_the_hash() {
        let scene = Scene::from_text(SCENE, Syntax::Ron).unwrap();
        let hash = |options: RenderOptions| scene.hash("a.png", &options).unwrap();
        let new = RenderOptions::new;
        let hashes = [
            hash(new()),
            hash(new().bits(16)),
            hash(new().transparent(true)),
            hash(new().depth_range(1.0, 2.0)),
            hash(new().depth_range(1.0, 3.0)),
        ];
        for (index, hash) in hashes.iter().enumerate() {
            assert!(!hashes[..index].contains(hash), "{index}");
        }
    }
}
