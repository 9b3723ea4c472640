//! Pictures whose light follows paths in rounds, each with more samples, and files that keep what is known of
//! them.

use std::{io, path::Path};

use crate::{
    diagnostic::error::{Error, ErrorKind},
    film::SampleCount,
    image_file::{part, target::Target},
    pipeline::{Scene, options::RenderOptions, picture::Aovs},
    render::shading::picture_sums::PictureSums,
};

impl Scene {
    /// Returns true if light follows paths, so that a picture can get more samples in rounds.
    pub fn follows_paths(&self) -> bool {
        self.world.paths().is_some()
    }

    /// Adds samples to the sums of a picture in rounds: as many as `next` returns for the sums so far, until it
    /// returns `None`. Begins with those of `known`, unless these are of another scene or with other options.
    ///
    /// [`RenderOptions::sums`] draws the picture, which has the same bytes as one of as many samples in one run.
    ///
    /// # Errors
    ///
    /// A scene whose light does not follow paths, a crop that does not lie in the picture, more pixels than [`PictureSums::MOST_PIXELS`], a cancelled
    /// render, and the errors of `next`.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{RenderOptions, Scene, Syntax, film::SampleCount};
    ///
    /// let text = r##"(
    ///     image: (width: 24, height: 16),
    ///     camera: Perspective(eye: (0, 0, 4), look_at: (0, 0, 0), fov: 40),
    ///     lighting: Path(samples: 8),
    ///     lights: [Environment(color: "#fff")],
    ///     geometries: [Sphere(center: (0, 0, 0), radius: 1, color: "#b02818")],
    /// )"##;
    /// let scene = Scene::from_text(text, Syntax::Ron)?;
    /// let options = RenderOptions::new();
    /// let counts = [1, 3, 8].into_iter();
    /// let mut counts = counts.filter_map(|count| SampleCount::new(count).ok());
    /// let sums = scene.add_samples(None, &options, |_| Ok(counts.next()))?;
    /// assert_eq!(scene.render_with(&options.sums(sums))?, scene.render()?);
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn add_samples(
        &self,
        known: Option<PictureSums>,
        options: &RenderOptions,
        mut next: impl FnMut(&PictureSums) -> Result<Option<SampleCount>, Error>,
    ) -> Result<PictureSums, Error> {
        let crop = self.crop(options)?;
        let camera = self.camera_of(options)?;
        let tracer = self.tracer(&camera, options)?;
        let aovs = Aovs {
            is_transparent: options.settings.is_transparent,
            ..Aovs::default()
        };
        let next = |sums: &PictureSums| Ok(next(sums)?.map(SampleCount::count));
        let hash = self.hash_of_sums(options)?;
        let known = known.filter(|known| known.hash() == hash);
        let sums = self.with_work(options, aovs, |work| {
            tracer.add_rounds(crop, work, known, next)
        })?;
        Ok(sums.with_hash(hash))
    }

    /// Writes the sums of a picture with `options` to a file, for [`Scene::read_sums`].
    ///
    /// # Errors
    ///
    /// A file that cannot be written, and a cancelled render.
    pub fn save_sums(
        &self,
        path: impl AsRef<Path>,
        sums: &PictureSums,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        let path = path.as_ref();
        let title = title(&self.hash_of_sums(options)?);
        let mut target = Target::create(path, &options.cancel)?;
        let written = part::write(target.output(), &title, |sink| {
            sums.each_row(|row| {
                options.cancel.check()?;
                sink(row)
            })
        });
        written.map_err(|error| error.at(path))?;
        target.finish()
    }

    /// Reads the sums of a picture with `options` that [`Scene::save_sums`] has written; `None` if there is no
    /// such file.
    ///
    /// # Errors
    ///
    /// A file of another scene, with other options or with more samples, a damaged one
    /// ([`ErrorKind::Unreadable`]), and more pixels than [`PictureSums::MOST_PIXELS`].
    pub fn read_sums(
        &self,
        path: impl AsRef<Path>,
        options: &RenderOptions,
    ) -> Result<Option<PictureSums>, Error> {
        let path = path.as_ref();
        match path.symlink_metadata() {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            _ => {}
        }
        let refused = |why: &str| Error::new(ErrorKind::Unreadable, why.to_owned()).at(path);
        if !part::is_whole(path, &title(&self.hash_of_sums(options)?)) {
            return Err(refused(
                "the samples are of another scene, another size or other options, or the file is damaged",
            ));
        }
        let mut sums = self.add_samples(None, options, |_| Ok(None))?;
        let (mut left, mut known) = (sums.bytes(), 0);
        part::read(path, &mut left, &mut |rows| {
            options.cancel.check()?;
            sums.set_bytes(known, rows);
            known += rows.len();
            Ok(())
        })?;
        let most = options.samples.unwrap_or_else(|| self.samples());
        if sums.samples() > most.count() {
            let count = sums.samples();
            return Err(refused(&format!(
                "the picture has only {most} samples per pixel, and the file {count}"
            )));
        }
        Ok(Some(sums))
    }
}

/// Returns the first line of a file of sums.
fn title(hash: &str) -> String {
    format!("strahl samples 1 {hash}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        film::crop::Crop, image_file::ImageFormat, render::layers::Layer, text::syntax::Syntax,
    };

    fn scene(path: &str) -> Scene {
        let text = format!(
            "(
                image: (width: 19, height: 13),
                camera: Perspective(eye: (0, 1, 5), look_at: (0, 0.5, 0), fov: 40),
                lighting: Path({path}),
                lights: [Environment(sky: (zenith: \"#48b\", horizon: \"#def\", ground: \"#554\"))],
                outlines: (width: 1),
                geometries: [
                    Plane(point: (0, 0, 0), normal: (0, 1, 0), color: \"#aaa\"),
                    Sphere(center: (0, 0.7, 0), radius: 0.7, color: \"#b02818\"),
                ],
            )"
        );
        Scene::from_text(text, Syntax::Ron).unwrap()
    }

    fn file(scene: &Scene, options: &RenderOptions) -> Vec<u8> {
        let layers = [
            Layer::Color,
            Layer::Error,
            Layer::Samples,
            Layer::Albedo,
            Layer::Id,
        ];
        let options = options.clone().layers(layers);
        let mut file = Vec::new();
        scene
            .write_with(&mut file, ImageFormat::EXR, &options)
            .unwrap();
        file
    }

    fn add(
        scene: &Scene,
        known: Option<PictureSums>,
        options: &RenderOptions,
        to: &[u32],
    ) -> PictureSums {
        let mut counts = to.iter().map(|count| SampleCount::new(*count).unwrap());
        scene
            .add_samples(known, options, |_| Ok(counts.next()))
            .unwrap()
    }

    #[test]
    fn rounds_have_the_bytes_of_one_run() {
        for path in ["samples: 11", "samples: 200, noise: 0.05"] {
            let scene = scene(path);
            let most = scene.samples().count();
            for crop in [None, Some(Crop::new(3, 2, 9, 6).unwrap())] {
                for is_transparent in [false, true] {
                    let options = RenderOptions::new().transparent(is_transparent);
                    let options = crop.into_iter().fold(options, RenderOptions::crop);
                    let whole = file(&scene, &options);
                    let one = add(&scene, None, &options.clone().threads(1), &[1, 3, 7]);
                    let three = options.clone().threads(3);
                    let sums = add(&scene, Some(one), &three, &[most / 2, most]);
                    assert!(
                        file(&scene, &options.clone().sums(sums)) == whole,
                        "{path} {crop:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn files_of_samples_are_those_that_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.samples");
        let (scene, options) = (scene("samples: 11"), RenderOptions::new());
        assert_eq!(scene.read_sums(&path, &options).unwrap(), None);
        let sums = add(&scene, None, &options, &[4]);
        scene.save_sums(&path, &sums, &options).unwrap();
        assert_eq!(scene.read_sums(&path, &options).unwrap(), Some(sums));
        let refused = |scene: &Scene, options: &RenderOptions| {
            let error = scene.read_sums(&path, options).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Unreadable);
            error.to_string()
        };
        let seven = self::scene("samples: 11, seed: 7");
        assert!(refused(&seven, &options).contains("another scene"));
        assert!(refused(&scene, &options.clone().transparent(true)).contains("other options"));
        let fewer = options.clone().samples(SampleCount::new(3).unwrap());
        assert!(refused(&scene, &fewer).contains("only 3 samples per pixel, and the file 4"));
        // The number of samples of the scene does not matter, nor the layers.
        let more = self::scene("samples: 64");
        let layers = options.clone().layers([Layer::Error]);
        assert!(more.read_sums(&path, &layers).unwrap().is_some());
    }

    #[test]
    fn known_samples_are_used_and_those_of_others_are_not() {
        let (scene, options) = (scene("samples: 4"), RenderOptions::new());
        let whole = file(&scene, &options);
        let mut sums = add(&scene, None, &options, &[4]);
        let other = self::scene("samples: 4, seed: 1");
        let others = add(&other, None, &options, &[4]);
        assert!(file(&scene, &options.clone().sums(others.clone())) == whole);
        assert_eq!(add(&scene, Some(others.clone()), &options, &[4]), sums);
        let mut bytes = Vec::new();
        let row = |row: &[u8]| {
            bytes.extend_from_slice(row);
            Ok(())
        };
        others.each_row(row).unwrap();
        sums.set_bytes(0, &bytes);
        let image = |scene: &Scene, options: &RenderOptions| scene.render_with(options).unwrap();
        let changed = image(&scene, &options.clone().sums(sums));
        assert!(changed == image(&other, &options) && changed != image(&scene, &options));
    }

    #[test]
    fn too_many_pixels_have_no_sums() {
        let size = crate::film::size::Size::new(5000, 5000).unwrap();
        let options = RenderOptions::new().size(size);
        let error = scene("")
            .add_samples(None, &options, |_| Ok(None))
            .unwrap_err();
        assert!(error.to_string().contains("25000000 pixels"), "{error}");
    }
}
