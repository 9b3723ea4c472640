//! The number of samples per pixel.

use std::{error::Error, fmt, num::IntErrorKind, str::FromStr};

use crate::{film::size::number, tracer::light::transport::PathOptions};

/// The number of samples of a pixel: those of a grid, [`Samples`], or, where light follows paths, any
/// number from 1 to 1,048,576.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleCount(u32);

/// The number of samples per pixel: an n x n regular grid, n from 1 to 64.
///
/// Point (i, j) of pixel (x, y) is `(x + (i+½)/n - ½, y + (j+½)/n - ½)`, all counted from the
/// bottom left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Samples {
    side: u32,
}

impl Samples {
    /// One sample, in the center of the pixel.
    pub const ONE: Self = Self { side: 1 };
    /// The largest n.
    pub const MAX_SIDE: u32 = 64;

    /// Creates a grid of `count` samples.
    ///
    /// # Errors
    ///
    /// Returns an error if `count` is not the square of an integer from 1 to [`Samples::MAX_SIDE`].
    pub fn new(count: u32) -> Result<Self, SamplesError> {
        let side = count.isqrt();
        if (1..=Self::MAX_SIDE).contains(&side) && side * side == count {
            Ok(Self { side })
        } else {
            Err(SamplesError::OutOfRange { count })
        }
    }

    /// Returns all valid numbers of samples, in ascending order from 1.
    pub(crate) fn all() -> impl Iterator<Item = u32> {
        (1..=Self::MAX_SIDE).map(|side| side * side)
    }

    /// Returns the positions of the grid points in a column or row of pixels: `x + (i+½)/n - ½`.
    pub(crate) fn offsets(self, x: f64) -> impl Iterator<Item = f64> {
        let side = f64::from(self.side);
        (0..self.side).map(move |i| x + (f64::from(i) + 0.5) / side - 0.5)
    }

    /// The number of samples in a row of the grid: n.
    pub const fn side(self) -> u32 {
        self.side
    }

    /// The total number of samples: n².
    pub const fn count(self) -> u32 {
        self.side * self.side
    }
}

impl Default for Samples {
    fn default() -> Self {
        Self::ONE
    }
}

impl SampleCount {
    /// Creates a number of samples.
    ///
    /// # Errors
    ///
    /// Returns an error if `count` is 0 or above 1,048,576.
    pub fn new(count: u32) -> Result<Self, SamplesError> {
        if (1..=PathOptions::MAX_SAMPLES).contains(&count) {
            Ok(Self(count))
        } else {
            Err(SamplesError::OutOfRange { count })
        }
    }

    /// Returns the number of paths.
    pub(crate) fn of_paths(options: &PathOptions) -> Self {
        Self(options.samples())
    }

    /// The number.
    pub const fn count(self) -> u32 {
        self.0
    }

    /// Returns the grid of this many samples.
    ///
    /// # Errors
    ///
    /// Those of [`Samples::new`].
    pub fn grid(self) -> Result<Samples, SamplesError> {
        Samples::new(self.0)
    }
}

impl From<Samples> for SampleCount {
    fn from(samples: Samples) -> Self {
        Self(samples.count())
    }
}

impl fmt::Display for SampleCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl FromStr for SampleCount {
    type Err = SamplesError;

    /// Parses a number of samples, such as `100`.
    fn from_str(text: &str) -> Result<Self, SamplesError> {
        match number(text) {
            Ok(count) => Self::new(count),
            Err(error) if *error.kind() == IntErrorKind::PosOverflow => Err(SamplesError::TooMany),
            Err(_) => Err(SamplesError::Malformed),
        }
    }
}

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.count().fmt(f)
    }
}

impl FromStr for Samples {
    type Err = SamplesError;

    /// Parses a number of samples, such as `16`.
    fn from_str(text: &str) -> Result<Self, SamplesError> {
        match number(text) {
            Ok(count) => Self::new(count),
            Err(error) if *error.kind() == IntErrorKind::PosOverflow => Err(SamplesError::TooMany),
            Err(_) => Err(SamplesError::Malformed),
        }
    }
}

/// An invalid number of samples.
#[derive(Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SamplesError {
    /// The number is not the square of an integer from 1 to [`Samples::MAX_SIDE`].
    OutOfRange {
        /// The rejected number.
        count: u32,
    },
    /// The number is larger than any valid one.
    TooMany,
    /// The text is not an integer.
    Malformed,
}

impl SamplesError {
    /// Returns a hint with the nearest valid numbers.
    pub(crate) fn help(self) -> String {
        let count = match self {
            Self::OutOfRange { count } => count,
            Self::TooMany => u32::MAX,
            Self::Malformed => return "write a whole number such as 16".to_owned(),
        };
        let below = count.isqrt().min(Samples::MAX_SIDE);
        match (below, below + 1) {
            (0, _) => "the minimum is 1".to_owned(),
            (Samples::MAX_SIDE, _) => format!("the maximum is {}", below * below),
            (_, above) => format!("the nearest are {} and {}", below * below, above * above),
        }
    }
}

impl fmt::Display for SamplesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "a pixel has 1, 4, 9, 16, … or 4096 samples, a square of 1 to 64, or up to 1048576 paths",
        )?;
        match self {
            Self::OutOfRange { count } => write!(f, ", found {count}; {}", self.help()),
            Self::TooMany | Self::Malformed => write!(f, "; {}", self.help()),
        }
    }
}

/// Same as `Display`, because a `main` that returns an error prints it with `Debug`.
impl fmt::Debug for SamplesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Error for SamplesError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_squares() {
        for count in 0..5000 {
            let side = (1..=64).find(|side| side * side == count);
            assert_eq!(Samples::new(count).ok().map(Samples::side), side);
        }
        assert!(Samples::all().all(|count| Samples::new(count).is_ok_and(|s| s.count() == count)));
        assert_eq!("16".parse(), Samples::new(16));
        for text in ["", "+4", "-4", "4.0", "four", " 4"] {
            assert_eq!(
                text.parse::<Samples>(),
                Err(SamplesError::Malformed),
                "{text}"
            );
        }
        for (text, help) in [
            ("0", "the minimum is 1"),
            ("2", "the nearest are 1 and 4"),
            ("4095", "the nearest are 3969 and 4096"),
            ("4097", "the maximum is 4096"),
            ("99999999999", "the maximum is 4096"),
        ] {
            let refused = text.parse::<Samples>().unwrap_err();
            assert_eq!(refused.help(), help);
        }
    }
}
