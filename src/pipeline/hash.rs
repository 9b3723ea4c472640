//! What a picture is made of, as a hash and in words.

use std::path::Path;

use glam::DVec3;

use crate::{
    error::Error,
    film::crop::Crop,
    fingerprint::Fingerprint,
    pipeline::{Scene, options::RenderOptions},
    tracer::camera::Camera,
};

impl Scene {
    /// A hash of all that the file of a picture depends on: of the values of the scene with those of
    /// its tables, of every option that changes a byte, of its format, and of the version of this
    /// program. 64 hexadecimal digits.
    ///
    /// # Errors
    ///
    /// An unknown ending.
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
        fingerprint.text(&self.fingerprint(options));
        fingerprint.text(options.format_of(path.as_ref())?.name());
        fingerprint.text(&options.of_the_file());
        for (geometry, name) in self.names.all() {
            fingerprint.text(&geometry.to_string());
            fingerprint.text(name);
        }
        Ok(fingerprint.digits())
    }

    /// Version, camera and a hash of all that the picture shows.
    pub(super) fn about(&self, options: &RenderOptions) -> Vec<(String, String)> {
        let entry = |name: &str, text: String| (name.to_owned(), text);
        vec![
            entry("Software", format!("strahl {}", env!("CARGO_PKG_VERSION"))),
            entry("Scene", self.fingerprint(options)),
            entry("Camera", in_words(self.camera())),
        ]
    }

    /// A hash of all that the pixels depend on.
    fn fingerprint(&self, options: &RenderOptions) -> String {
        let mut fingerprint = Fingerprint::default();
        fingerprint.text(env!("CARGO_PKG_VERSION"));
        let size = options.size.unwrap_or(self.size);
        let crop = options.crop.unwrap_or(Crop::whole(size));
        let samples = options.samples.unwrap_or(self.samples);
        fingerprint.text(&format!("{size} {crop} {samples}"));
        fingerprint.camera(self.camera());
        let world = self.world_hash.get_or_init(|| {
            let mut fingerprint = Fingerprint::default();
            fingerprint.world(&self.world);
            fingerprint.digits()
        });
        fingerprint.text(world);
        fingerprint.digits()
    }
}

/// A camera as a scene may write it: the same one but for the rounding of an angle in degrees.
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
            format!("Perspective(eye: {eye}, gaze: {gaze}, up: {up}, fov: {fov:?})")
        }
        Camera::Orthographic(camera) => {
            let (scale, stretch) = (camera.scale(), camera.stretch());
            let stretch = if stretch { ", stretch: true" } else { "" };
            format!("Orthographic(eye: {eye}, gaze: {gaze}, up: {up}, scale: {scale:?}{stretch})")
        }
    }
}
