//! Pictures by paths that grow better, round by round.

use std::sync::{Arc, Mutex};

use strahl::{
    Error, Scene,
    film::SampleCount,
    parallel::Cancel,
    render::PictureSums,
    session::{Quality, View},
};

use crate::cli::threads::lock;

/// The samples of the last view.
#[derive(Default)]
pub(super) struct Progressive(Mutex<Option<Arc<PictureSums>>>);

impl Progressive {
    /// Returns a PNG file of a view with this many samples, which are added to those that are known of it.
    pub(super) fn png(
        &self,
        view: &View,
        scene: &Scene,
        samples: SampleCount,
        cancel: &Cancel,
    ) -> Result<Vec<u8>, Error> {
        if scene.size().pixels() > PictureSums::MOST_PIXELS {
            let view = View {
                samples: Some(samples),
                ..view.clone()
            };
            return view.png(scene, Quality::Full, cancel);
        }
        // Taken over: what is of another view needs its memory no more.
        let known = lock(&self.0).take().map(Arc::unwrap_or_clone);
        let (file, sums) = view.png_of_samples(scene, samples, known, cancel)?;
        *lock(&self.0) = Some(sums);
        Ok(file)
    }
}
