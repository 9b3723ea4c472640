//! Movies: several pictures in one file.

mod apng;
mod fraction;
mod y4m;

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use crate::{
    diagnostic::{error::Error, named::named},
    film::{Image, size::Size},
    image_file::target::Target,
    parallel::Cancel,
};

named! {
    /// A movie file format.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum MovieFormat {
        /// YUV4MPEG2, uncompressed: read from a pipe by `ffmpeg` and other video encoders.
        Y4m = "y4m",
        /// Animated Portable Network Graphics, lossless: shown by browsers.
        Apng = "apng",
    }
}

/// The properties shared by all pictures of a movie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reel {
    /// The size of each picture.
    pub size: Size,
    /// Number of pictures per second: positive and finite.
    pub fps: f64,
    /// Number of pictures: at least 1.
    pub frames: u32,
}

/// A function that takes the pictures of a movie in order.
pub type FrameSink<'a> = &'a mut dyn FnMut(&Image) -> Result<(), Error>;

impl MovieFormat {
    /// Returns the format for a file extension, in either case.
    pub fn of_ending(ending: &str) -> Option<Self> {
        Self::of_name(&ending.to_ascii_lowercase())
    }

    /// Returns the format of a file by its extension, in either case.
    pub fn of_path(path: impl AsRef<Path>) -> Option<Self> {
        Self::of_ending(path.as_ref().extension()?.to_str()?)
    }

    /// Writes a movie to a stream. `draw` passes on as many pictures as the reel states.
    ///
    /// # Errors
    ///
    /// Fails if the format does not support the size, if the number of pictures or the size of one
    /// is wrong, or if `draw` or the stream fails.
    pub fn write<E: From<Error>>(
        self,
        writer: impl Write,
        reel: Reel,
        draw: impl FnOnce(FrameSink) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut left = reel.frames;
        let counted = |sink: FrameSink| {
            draw(&mut |image: &Image| {
                left = left
                    .checked_sub(1)
                    .ok_or_else(|| wrong("too many pictures"))?;
                if image.size() != reel.size {
                    return Err(wrong("a picture of another size"));
                }
                sink(image)
            })?;
            if left > 0 {
                return Err(wrong("too few pictures").into());
            }
            Ok(())
        };
        match self {
            Self::Y4m => y4m::write(writer, reel, counted),
            Self::Apng => apng::write(writer, reel, counted),
        }
    }

    /// Writes a movie to a file, whole or not at all.
    ///
    /// # Errors
    ///
    /// Fails like [`MovieFormat::write`], or if the file cannot be written.
    pub fn save<E: From<Error>>(
        self,
        path: impl Into<PathBuf>,
        reel: Reel,
        cancel: &Cancel,
        draw: impl FnOnce(FrameSink) -> Result<(), E>,
    ) -> Result<(), E> {
        let path = path.into();
        let mut target = Target::create(&path, cancel)?;
        self.write(target.output(), reel, draw)?;
        Ok(target.finish()?)
    }
}

fn wrong(message: &str) -> Error {
    Error::refused(message)
}
