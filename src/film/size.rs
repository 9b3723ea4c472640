//! The size of a picture.

use std::{
    error::Error,
    fmt,
    num::{IntErrorKind, ParseIntError},
    str::FromStr,
};

use serde::Serialize;

use crate::film::crop::Crop;

/// The width and height of a picture, in pixels.
///
/// A side is 1 to 1,000,000 pixels long, and a picture has at most 2³⁴ pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct Size {
    width: u32,
    height: u32,
}

impl Size {
    /// The maximum length of a side.
    pub const MAX_SIDE: u32 = 1_000_000;
    /// The maximum number of pixels.
    pub const MAX_PIXELS: u64 = 1 << 34;

    /// Creates a size.
    ///
    /// # Errors
    ///
    /// Returns an error if a side is 0 or above [`Size::MAX_SIDE`], or if there are more than
    /// [`Size::MAX_PIXELS`] pixels.
    pub fn new(width: u32, height: u32) -> Result<Self, SizeError> {
        let sides = 1..=Self::MAX_SIDE;
        let size = Self { width, height };
        if sides.contains(&width) && sides.contains(&height) && size.pixels() <= Self::MAX_PIXELS {
            Ok(size)
        } else {
            Err(SizeError::OutOfRange { width, height })
        }
    }

    /// The number of columns.
    pub const fn width(self) -> u32 {
        self.width
    }

    /// The number of rows.
    pub const fn height(self) -> u32 {
        self.height
    }

    /// The number of pixels.
    pub fn pixels(self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl FromStr for Size {
    type Err = SizeError;

    /// Parses `WIDTHxHEIGHT`, such as `640x480`.
    fn from_str(text: &str) -> Result<Self, SizeError> {
        let malformed = |error| SizeError::of_number(&error, SizeError::Malformed);
        let side = |text| number(text).map_err(malformed);
        let (width, height) = text.split_once(['x', 'X']).ok_or(SizeError::Malformed)?;
        Self::new(side(width)?, side(height)?)
    }
}

/// An invalid size.
#[derive(Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SizeError {
    /// A side is 0 or too long, or there are too many pixels.
    OutOfRange {
        /// The number of columns.
        width: u32,
        /// The number of rows.
        height: u32,
    },
    /// A number in the text is too large for a side.
    TooLarge,
    /// The text does not have the form `WIDTHxHEIGHT`.
    Malformed,
    /// A part of a picture lies outside it.
    Outside {
        /// The part.
        crop: Crop,
        /// The size of the picture.
        size: Size,
    },
    /// The text does not have the form `X,Y,W,H`.
    MalformedCrop,
}

impl fmt::Display for SizeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { width, height } => write!(
                f,
                "a picture's sides are 1 to 1000000 pixels long and it has at most 2^34 pixels, \
                 found {width}x{height}"
            ),
            Self::TooLarge => f.write_str("no picture has sides of more than 1000000 pixels"),
            Self::Malformed => f.write_str("a size is written WIDTHxHEIGHT, such as 640x480"),
            Self::Outside { crop, size } => write!(
                f,
                "the part {crop} (column, row, width and height in pixels from the top left) does \
                 not lie in a picture of {size}"
            ),
            Self::MalformedCrop => f.write_str(
                "a part is written X,Y,W,H in pixels from the top left, such as 0,0,64,64",
            ),
        }
    }
}

/// Same as `Display`, because a `main` that returns an error prints it with `Debug`.
impl fmt::Debug for SizeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Error for SizeError {}

/// Parses an integer that consists only of digits.
pub(super) fn number(text: &str) -> Result<u32, ParseIntError> {
    // `parse` accepts `+1` as well.
    let is_signed = text.starts_with('+');
    if is_signed { "+" } else { text }.parse()
}

impl SizeError {
    /// Converts a parse error: [`SizeError::TooLarge`] on overflow, else `malformed`.
    pub(super) fn of_number(error: &ParseIntError, malformed: Self) -> Self {
        match error.kind() {
            IntErrorKind::PosOverflow => Self::TooLarge,
            _ => malformed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_limits() {
        assert_eq!(Size::new(1, 1).unwrap().pixels(), 1);
        assert!(Size::new(1_000_000, 17_179).is_ok());
        assert!(Size::new(131_072, 131_072).is_ok(), "2^34 pixels");
        assert!(Size::new(131_072, 131_073).is_err());
        assert!(Size::new(0, 1).is_err());
        assert!(Size::new(1_000_001, 1).is_err());
        assert!(Size::new(1_000_000, 1_000_000).is_err());
    }

    #[test]
    fn sizes_are_read_as_they_are_written() {
        assert_eq!("640x480".parse(), Size::new(640, 480));
        assert_eq!("640X480".parse(), Size::new(640, 480));
        for text in [
            "", "640", "640x ", "640x", "x480", "640*480", "-1x5", "+1x5", "1x2x3", "1.5x2",
        ] {
            assert_eq!(text.parse::<Size>(), Err(SizeError::Malformed), "{text}");
        }
        assert_eq!("99999999999x5".parse::<Size>(), Err(SizeError::TooLarge));
        for text in ["0x5", "4294967295x5", "1000000x1000000"] {
            let refused = text.parse::<Size>();
            assert!(
                matches!(refused, Err(SizeError::OutOfRange { .. })),
                "{text}"
            );
        }
    }
}
