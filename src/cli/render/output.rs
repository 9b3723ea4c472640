//! The file that a command writes: its name and its format.

use std::path::{MAIN_SEPARATOR, Path};

use clap::builder::PossibleValue;
use strahl::{ImageFormat, image_file::MovieFormat};

use crate::cli::failure::Failure;

/// The kind of output file: one picture, or a movie of many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Drawing {
    Image(ImageFormat),
    Movie(MovieFormat),
}

impl Default for Drawing {
    fn default() -> Self {
        Self::Image(ImageFormat::PNG)
    }
}

impl Drawing {
    /// Returns the extension of its files.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Image(format) => format.name(),
            Self::Movie(format) => format.name(),
        }
    }
}

/// Extensions of movies that are not written here, but that `ffmpeg` makes of one from standard input,
/// with its options.
const BY_FFMPEG: [(&str, &str); 5] = [
    ("gif", ""),
    ("mkv", ""),
    ("mov", "-pix_fmt yuv420p "),
    ("mp4", "-pix_fmt yuv420p "),
    ("webm", ""),
];

/// Returns the format of a picture by its extension. The error lists the movie formats among the
/// known ones.
pub(super) fn format_of(path: &Path) -> Result<ImageFormat, Failure> {
    ImageFormat::of_path(path).map_err(|error| {
        let movies = MovieFormat::ALL
            .iter()
            .map(|format| format!(".{}", format.name()));
        let movies: Vec<_> = movies.collect();
        let ending = path.extension().unwrap_or_default();
        let mut made = BY_FFMPEG.iter();
        let pipe = made.find(|(name, _)| ending.eq_ignore_ascii_case(name));
        let pipe = pipe.map_or_else(String::new, |(_, options)| {
            format!(
                "; ffmpeg makes such a file: `strahl render SCENE -o - --image-format y4m | \
                 ffmpeg -i - {options}{}`",
                path.display()
            )
        });
        let movies = movies.join(" and ");
        Failure::usage(format!("{error}, for movies {movies}{pipe}"))
    })
}

/// Returns all formats.
pub(super) fn drawings() -> impl Iterator<Item = Drawing> {
    let images = ImageFormat::ALL.iter().copied().map(Drawing::Image);
    images.chain(MovieFormat::ALL.iter().copied().map(Drawing::Movie))
}

/// Returns the names of a format.
pub(super) fn drawing(format: Drawing) -> PossibleValue {
    let name = PossibleValue::new(format.name());
    match format {
        Drawing::Image(format) => name.aliases(format.endings()),
        Drawing::Movie(_) => name,
    }
}

/// Returns true if a target is a folder, and not a picture with a folder in its place.
pub(super) fn is_folder(target: &Path) -> bool {
    let ends = target.to_string_lossy().ends_with(['/', MAIN_SEPARATOR]);
    ends || target.is_dir() && ImageFormat::of_path(target).is_err()
}
