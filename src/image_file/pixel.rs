//! The pixel types of image files.

use std::{borrow::Cow, fmt};

/// The type of one number of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Sample {
    U8,
    U16,
    U32,
    F16,
    F32,
    F64,
}

impl Sample {
    /// Returns the size in bytes.
    pub(crate) const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::F16 => 2,
            Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Converts numbers from native byte order to little-endian.
    pub(super) fn little_endian(self, numbers: &[u8]) -> Cow<'_, [u8]> {
        if cfg!(target_endian = "little") {
            numbers.into()
        } else {
            self.reversed(numbers)
        }
    }

    /// Converts numbers from native byte order to big-endian.
    pub(super) fn big_endian(self, numbers: &[u8]) -> Cow<'_, [u8]> {
        if cfg!(target_endian = "big") {
            numbers.into()
        } else {
            self.reversed(numbers)
        }
    }

    fn reversed(self, numbers: &[u8]) -> Cow<'_, [u8]> {
        fn reverse<const N: usize>(mut numbers: Vec<u8>) -> Vec<u8> {
            let (all, _) = numbers.as_chunks_mut::<N>();
            all.iter_mut().for_each(|number| number.reverse());
            numbers
        }
        match self.bytes() {
            2 => reverse::<2>(numbers.to_vec()).into(),
            4 => reverse::<4>(numbers.to_vec()).into(),
            8 => reverse::<8>(numbers.to_vec()).into(),
            _ => numbers.into(),
        }
    }
}

impl fmt::Display for Sample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::U8 => "8-bit",
            Self::U16 => "16-bit",
            Self::U32 => "32-bit",
            Self::F16 => "16-bit float",
            Self::F32 => "32-bit float",
            Self::F64 => "64-bit float",
        })
    }
}

/// The content of a pixel in a file.
///
/// Numbers are in native byte order. Integer colors are sRGB, float colors linear light. Alpha is
/// premultiplied in channels only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pixel<'a> {
    /// One number.
    Gray(Sample),
    /// Red, green and blue.
    Rgb(Sample),
    /// Red, green, blue and alpha.
    Rgba(Sample),
    /// One byte: an index into a palette of 1 to 256 colors.
    Indexed(&'a [[u8; 3]]),
    /// Named numbers. A row consists of the row of the first channel, then that of the second, and
    /// so on.
    Channels(&'a [Channel]),
    /// Named pictures. A row consists of the row of the first array, then that of the second, and
    /// so on.
    Arrays(&'a [Array]),
}

/// A named number of every pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Channel {
    pub(crate) name: String,
    pub(crate) sample: Sample,
}

/// One of several pictures in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Array {
    pub(crate) name: String,
    /// One to four numbers of one type.
    pub(crate) pixel: Pixel<'static>,
}

impl Pixel<'_> {
    /// Returns the number of bytes per pixel.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Indexed(_) => 1,
            Self::Channels(all) => all.iter().map(|channel| channel.sample.bytes()).sum(),
            Self::Arrays(all) => all.iter().map(|array| array.pixel.bytes()).sum(),
            Self::Gray(_) | Self::Rgb(_) | Self::Rgba(_) => {
                let (count, sample) = self.samples().unwrap_or((0, Sample::U8));
                count * sample.bytes()
            }
        }
    }

    /// Returns the number of samples and their type, if the samples of a pixel are adjacent.
    pub(super) const fn samples(&self) -> Option<(usize, Sample)> {
        match self {
            Self::Gray(sample) => Some((1, *sample)),
            Self::Rgb(sample) => Some((3, *sample)),
            Self::Rgba(sample) => Some((4, *sample)),
            Self::Indexed(_) | Self::Channels(_) | Self::Arrays(_) => None,
        }
    }
}

impl fmt::Display for Pixel<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gray(sample) => write!(f, "{sample} gray"),
            Self::Rgb(sample) => write!(f, "{sample} RGB"),
            Self::Rgba(sample) => write!(f, "{sample} RGBA"),
            Self::Indexed(_) => f.write_str("a palette"),
            Self::Channels(_) => f.write_str("named channels"),
            Self::Arrays(_) => f.write_str("several arrays"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_reordered() {
        let numbers = [0x0102_u16, 0x0304].map(u16::to_ne_bytes);
        let numbers = numbers.as_flattened();
        assert_eq!(*Sample::U16.big_endian(numbers), [1, 2, 3, 4]);
        assert_eq!(*Sample::F16.little_endian(numbers), [2, 1, 4, 3]);
        let number = 0x0102_0304_u32.to_ne_bytes();
        assert_eq!(*Sample::F32.big_endian(&number), [1, 2, 3, 4]);
        let number = 0x0102_0304_0506_0708_u64.to_ne_bytes();
        assert_eq!(*Sample::F64.big_endian(&number), [1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(*Sample::U8.big_endian(&[1, 2]), [1, 2]);
    }

    #[test]
    fn the_size_of_a_pixel_is_that_of_its_samples() {
        assert_eq!(Pixel::Rgba(Sample::F32).bytes(), 16);
        assert_eq!(Pixel::Indexed(&[[0; 3]; 7]).bytes(), 1);
        let channel = |name: &str, sample| Channel {
            name: name.to_owned(),
            sample,
        };
        let channels = [channel("id", Sample::U32), channel("Z", Sample::F16)];
        assert_eq!(Pixel::Channels(&channels).bytes(), 6);
        let array = |pixel| Array {
            name: "a".to_owned(),
            pixel,
        };
        let arrays = [
            array(Pixel::Rgb(Sample::U8)),
            array(Pixel::Gray(Sample::F64)),
        ];
        assert_eq!(Pixel::Arrays(&arrays).bytes(), 11);
    }
}
