//! Pictures that follow each other, in one file.

mod apng;
mod fraction;
mod y4m;

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use crate::{
    diagnostic::{
        error::{Error, ErrorKind},
        named::named,
    },
    film::{Image, size::Size},
    image_file::target::Target,
    parallel::Cancel,
};

named! {
    /// A format of files that hold many pictures.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum MovieFormat {
        /// YUV4MPEG2, without compression: what `ffmpeg` and other encoders of video read from a pipe.
        Y4m = "y4m",
        /// Animated Portable Network Graphics, lossless: what browsers show.
        Apng = "apng",
    }
}

/// What all pictures of a movie have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reel {
    /// The size of each picture.
    pub size: Size,
    /// How many pictures make a second: above 0 and finite.
    pub fps: f64,
    /// How many pictures there are: at least 1.
    pub frames: u32,
}

/// Takes the pictures of a movie, one after the other.
pub type FrameSink<'a> = &'a mut dyn FnMut(&Image) -> Result<(), Error>;

impl MovieFormat {
    /// The format with an ending, in either case.
    pub fn of_ending(ending: &str) -> Option<Self> {
        Self::of_name(&ending.to_ascii_lowercase())
    }

    /// The format of a file by its ending, in either case.
    pub fn of_path(path: impl AsRef<Path>) -> Option<Self> {
        Self::of_ending(path.as_ref().extension()?.to_str()?)
    }

    /// Writes a movie to a stream: `draw` hands over as many pictures as the reel says.
    ///
    /// # Errors
    ///
    /// A size that the format does not have, pictures of another size or number, and what `draw` or
    /// the stream return.
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

    /// Writes a movie to a file: whole or not at all.
    ///
    /// # Errors
    ///
    /// Those of [`MovieFormat::write`], and a file that cannot be written.
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
    Error::new(ErrorKind::Usage, message)
}
