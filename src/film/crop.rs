//! A rectangular part of a picture.

use std::{fmt, ops::Range, str::FromStr};

use crate::film::size::{Size, SizeError, number};

/// A rectangle of pixels in a picture, counted from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Crop {
    column: u32,
    row: u32,
    size: Size,
}

impl Crop {
    /// Creates a rectangle from the column and row of its top left pixel and its size.
    ///
    /// # Errors
    ///
    /// Returns an error if the size exceeds the limits of [`Size`].
    pub fn new(column: u32, row: u32, width: u32, height: u32) -> Result<Self, SizeError> {
        Ok(Self {
            column,
            row,
            size: Size::new(width, height)?,
        })
    }

    /// Returns the rectangle of the whole picture.
    pub(crate) const fn whole(size: Size) -> Self {
        Self {
            column: 0,
            row: 0,
            size,
        }
    }

    /// The column of the top left pixel, from the left.
    pub const fn column(self) -> u32 {
        self.column
    }

    /// The row of the top left pixel, from the top.
    pub const fn row(self) -> u32 {
        self.row
    }

    /// The width and height of the rectangle.
    pub const fn size(self) -> Size {
        self.size
    }

    /// The columns, from the left.
    pub(crate) fn columns(self) -> Range<u32> {
        self.column..self.column + self.size.width()
    }

    /// The rows, from the top.
    pub(crate) fn rows(self) -> Range<u32> {
        self.row..self.row + self.size.height()
    }

    /// Returns an error if the rectangle does not lie in a picture of this size.
    pub(crate) fn check(self, size: Size) -> Result<(), SizeError> {
        let fits = |first: u32, side: u32, whole: u32| first <= whole && side <= whole - first;
        let is_inside = fits(self.column, self.size.width(), size.width())
            && fits(self.row, self.size.height(), size.height());
        let outside = SizeError::Outside { crop: self, size };
        if is_inside { Ok(()) } else { Err(outside) }
    }
}

impl fmt::Display for Crop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { column, row, size } = self;
        write!(f, "{column},{row},{},{}", size.width(), size.height())
    }
}

impl FromStr for Crop {
    type Err = SizeError;

    /// Parses `X,Y,W,H`, such as `0,0,64,64`.
    fn from_str(text: &str) -> Result<Self, SizeError> {
        let malformed = SizeError::MalformedCrop;
        let number = |text| number(text).map_err(|error| SizeError::of_number(&error, malformed));
        let mut numbers = text.split(',').map(number);
        let mut next = || numbers.next().unwrap_or(Err(malformed));
        let [column, row, width, height] = [next()?, next()?, next()?, next()?];
        match numbers.next() {
            None => Self::new(column, row, width, height),
            Some(_) => Err(malformed),
        }
    }
}
