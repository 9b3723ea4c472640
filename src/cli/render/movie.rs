//! Movies: many frames in one file.

use std::{io::StdoutLock, path::Path};

use sha2::{Digest, Sha256};
use strahl::{
    Image, RenderOptions, Scene, Size,
    image_file::{FrameSink, MovieFormat, Reel},
    parallel::{Cancel, in_order},
};

use super::frames::Frames;
use crate::cli::{
    failure::{Failure, STDOUT},
    picture::PictureArgs,
    render::output::Drawing,
};

/// Number of frames per thread that are being drawn or wait to be written.
const AHEAD: usize = 2;

/// Returns the format, if such a file is a movie.
pub(super) fn format(output: Option<&Path>, format: Option<Drawing>) -> Option<MovieFormat> {
    match (output.and_then(MovieFormat::of_path), format) {
        (Some(format), _) | (None, Some(Drawing::Movie(format))) => Some(format),
        _ => None,
    }
}

/// Frames that form one file: those of a scene, or one for each row of a table.
pub(super) struct Movie<'s> {
    format: MovieFormat,
    numbers: Vec<u32>,
    reel: Reel,
    /// The size of the whole picture, of which a frame may be a part.
    size: Size,
    frame: Box<dyn Fn(u32) -> Result<Scene, Failure> + Sync + 's>,
}

impl<'s> Movie<'s> {
    /// Creates the movie of a scene; rejects an impossible one before anything is drawn.
    pub(super) fn of(
        frames: Option<&Frames>,
        picture: &PictureArgs,
        format: MovieFormat,
        scene: &'s Scene,
    ) -> Result<Self, Failure> {
        let Some(animation) = scene.animation() else {
            return Err(Failure::usage("a movie needs a scene with an animation"));
        };
        let numbers: Vec<u32> = match frames {
            Some(Frames::Named(numbers)) => numbers.clone(),
            Some(Frames::All) | None => (0..animation.frames()).collect(),
        };
        if let Some(last) = numbers.iter().max()
            && *last >= animation.frames()
        {
            scene.frame(*last)?;
        }
        let frame = |number| Ok(scene.frame(number)?);
        Ok(Self::new(
            format,
            numbers,
            animation.fps(),
            scene.size(),
            picture,
            frame,
        ))
    }

    /// Creates a movie of frames with these numbers, which have the same size.
    pub(super) fn new(
        format: MovieFormat,
        numbers: Vec<u32>,
        fps: f64,
        size: Size,
        picture: &PictureArgs,
        frame: impl Fn(u32) -> Result<Scene, Failure> + Sync + 's,
    ) -> Self {
        Self {
            format,
            reel: Reel {
                size: picture.size(size),
                fps,
                frames: numbers.len() as u32,
            },
            numbers,
            size,
            frame: Box::new(frame),
        }
    }

    /// Returns the number of pixels of all frames.
    pub(super) fn pixels(&self, picture: &PictureArgs) -> u64 {
        picture.pixels(self.size) * self.numbers.len() as u64
    }

    /// Returns a hash of everything that the file depends on.
    pub(super) fn hash(&self, options: &RenderOptions) -> Result<String, Failure> {
        let mut sum = Sha256::new();
        sum.update(format!("{} {:?}", self.format.name(), self.reel.fps));
        for number in &self.numbers {
            let frame = (self.frame)(*number)?;
            sum.update(frame.hash("frame.png", options)?);
        }
        Ok(format!("{:x}", sum.finalize()))
    }

    /// Returns the size and the number of frames.
    pub(super) fn extent(&self) -> String {
        let Reel { size, frames, .. } = self.reel;
        format!("{size}, {frames} frames")
    }

    /// Writes the movie to a file.
    pub(super) fn save(
        &self,
        path: &Path,
        options: &RenderOptions,
        cancel: &Cancel,
    ) -> Result<(), Failure> {
        let draw = |sink: FrameSink| self.draw(options, sink);
        let saved = self.format.save(path, self.reel, cancel, draw);
        saved.map_err(|failure| named(failure, path))
    }

    /// Writes the movie to standard output.
    pub(super) fn write(&self, stdout: StdoutLock, options: &RenderOptions) -> Result<(), Failure> {
        let draw = |sink: FrameSink| self.draw(options, sink);
        let written = self.format.write(stdout, self.reel, draw);
        written.map_err(|failure| named(failure, Path::new(STDOUT)))
    }

    /// Draws the frames, each on one thread, and passes them on in order.
    fn draw(&self, options: &RenderOptions, sink: FrameSink) -> Result<(), Failure> {
        let threads = options.thread_count();
        let options = options.clone().threads(1);
        let draw = |number: &u32| Ok((self.frame)(*number)?.render_with(&options)?);
        let take = |image: Result<Image, Failure>| Ok(sink(&image?)?);
        in_order(&self.numbers, threads, AHEAD * threads, draw, take)
    }
}

/// Adds the name of a file or a stream to a failure.
pub(super) fn named(failure: Failure, path: &Path) -> Failure {
    match failure {
        Failure::Library(error) if error.path().is_none() => Failure::Library(error.of_file(path)),
        Failure::Usage(message) => Failure::refused(path, message),
        failure => failure,
    }
}
