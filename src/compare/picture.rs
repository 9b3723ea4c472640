//! A picture as its file has it: the samples, and other layers.

use std::convert::identity;

use crate::{
    compare::layers::{self, Layer, LayerComparison},
    diagnostic::error::{Error, ErrorKind},
    film::size::Size,
    image_file::{check_memory, too_large},
    parallel::Cancel,
    tracer::srgb::to_linear,
};

/// A picture with the samples of its file: PNG, JPEG, BMP, TIFF, PPM, PFM, QOI, WebP, HDR, EXR, NPY
/// or NPZ.
///
/// # Examples
///
/// ```no_run
/// use strahl::compare::{CompareOptions, Picture};
///
/// let (golden, new) = (Picture::read("golden.png")?, Picture::read("new.png")?);
/// match golden.compare(&new, &CompareOptions::new())? {
///     Some(found) => println!("{} pixels differ", found.different),
///     None => println!("{} is not {}", golden.size(), new.size()),
/// }
/// # Ok::<(), strahl::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Picture {
    size: Size,
    pub(super) samples: Samples,
    /// Number of channels: gray, gray and alpha, RGB, or RGBA.
    pub(super) channels: usize,
    /// True if colors are multiplied by alpha.
    pub(super) premultiplied: bool,
    /// If false, the samples are black.
    pub(super) has_colors: bool,
    /// The layers other than the colors; `None` if the format does not support layers.
    pub(super) layers: Option<Vec<Layer>>,
}

/// The samples of a picture, pixel by pixel from the top left.
#[derive(Clone, Debug)]
pub(super) enum Samples {
    /// Display values (sRGB); 255 is white.
    Bytes(Vec<u8>),
    /// Display values (sRGB); 65535 is white.
    Words(Vec<u16>),
    /// Linear light; 1 is white.
    Floats(Vec<f32>),
}

impl Picture {
    /// Returns the width and height.
    pub fn size(&self) -> Size {
        self.size
    }

    /// Returns the number of bytes that the samples and layers take in memory.
    pub fn bytes(&self) -> usize {
        let samples = match &self.samples {
            Samples::Bytes(bytes) => size_of_val(&**bytes),
            Samples::Words(words) => size_of_val(&**words),
            Samples::Floats(floats) => size_of_val(&**floats),
        };
        let layers = self.layers.iter().flatten();
        samples + layers.map(|layer| layer.bytes.len()).sum::<usize>()
    }

    pub(super) fn new(
        size: Size,
        channels: usize,
        samples: Samples,
        premultiplied: bool,
    ) -> Result<Self, Error> {
        let expected = size.pixels() * channels as u64;
        let found = match &samples {
            Samples::Bytes(bytes) => bytes.len(),
            Samples::Words(words) => words.len(),
            Samples::Floats(floats) => floats.len(),
        };
        if found as u64 != expected {
            let message = format!("expected {expected} samples, found {found}");
            return Err(Error::new(ErrorKind::Unreadable, message));
        }
        Ok(Self {
            size,
            samples,
            channels,
            premultiplied,
            has_colors: true,
            layers: None,
        })
    }

    /// Creates a picture from layers, one of which may be its colors.
    pub(super) fn of_layers(mut all: Vec<Layer>, colors: &str) -> Result<Self, Error> {
        let colors = all.iter().position(|layer| layer.name == colors);
        let colors = colors.and_then(|at| all[at].as_colors().map(|colors| (at, colors)));
        if let Some((at, (channels, samples))) = colors {
            let layer = all.remove(at);
            let picture = Self::new(layer.size, channels, samples, false)?;
            return Ok(picture.with_layers(all));
        }
        let first = all
            .first()
            .ok_or_else(|| Error::new(ErrorKind::Unreadable, "the file has no arrays"))?;
        check_memory(first.size, first.size.pixels())?;
        let black = vec![0; usize::try_from(first.size.pixels()).unwrap_or(usize::MAX)];
        let picture = Self::new(first.size, 1, Samples::Bytes(black), false)?;
        let mut picture = picture.with_layers(all);
        picture.has_colors = false;
        Ok(picture)
    }

    /// Returns the linear light of its colors, from the top left. Gray is the same in all channels, and alpha
    /// does not count.
    ///
    /// # Errors
    ///
    /// It has no colors, the light does not fit into memory, or it is cancelled, which is asked for each row.
    pub(crate) fn into_light(self, cancel: Option<&Cancel>) -> Result<Vec<[f32; 3]>, Error> {
        if !self.has_colors {
            return Err(Error::new(ErrorKind::Unreadable, "the file has no colors"));
        }
        let table = |most: u16| -> Vec<f32> {
            let display = (0..=most).map(|value| f64::from(value) / f64::from(most));
            display.map(|value| to_linear(value) as f32).collect()
        };
        let form = (self.size, self.channels);
        match &self.samples {
            Samples::Bytes(all) => {
                let table = table(u8::MAX.into());
                colors(all, form, cancel, |byte| table[usize::from(byte)])
            }
            Samples::Words(all) => {
                let table = table(u16::MAX);
                colors(all, form, cancel, |word| table[usize::from(word)])
            }
            Samples::Floats(all) => colors(all, form, cancel, identity),
        }
    }

    fn with_layers(mut self, layers: Vec<Layer>) -> Self {
        self.layers = Some(layers);
        self
    }

    pub(super) fn compare_layers(&self, other: &Self) -> Vec<LayerComparison> {
        let (Some(ours), Some(theirs)) = (&self.layers, &other.layers) else {
            return Vec::new();
        };
        let mut all = layers::compare(ours, theirs);
        if self.has_colors != other.has_colors {
            all.insert(0, LayerComparison::missing("color"));
        }
        all
    }

    /// Returns true if the picture has colors; false if it has only depths and other numbers.
    pub fn has_colors(&self) -> bool {
        self.has_colors
    }

    pub(super) fn has_alpha(&self) -> bool {
        self.channels.is_multiple_of(2)
    }
}

/// Returns red, green and blue of each pixel, given the number of channels.
fn colors<T: Copy>(
    all: &[T],
    (size, channels): (Size, usize),
    cancel: Option<&Cancel>,
    light: impl Fn(T) -> f32,
) -> Result<Vec<[f32; 3]>, Error> {
    let mut colors = Vec::new();
    let reserved = colors.try_reserve_exact(all.len() / channels);
    reserved.map_err(|error| too_large(size).caused_by(error))?;
    for row in all.chunks_exact(size.width() as usize * channels) {
        cancel.map_or(Ok(()), Cancel::check)?;
        let pixels = row.chunks_exact(channels);
        colors.extend(pixels.map(|pixel| match *pixel {
            [r, g, b, ..] => [r, g, b].map(&light),
            [gray, ..] => [light(gray); 3],
            [] => [0.0; 3],
        }));
    }
    Ok(colors)
}
