//! What a picture is made of.

use std::{error::Error, fmt, ops::Range, str::FromStr};

use crate::colors::{ColorTable, Mixed, NOTHING};

/// The width and height of a picture, in pixels.
///
/// A side is 1 to 1,000,000 pixels long, and a picture has at most 2³⁴ of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Size {
    width: u32,
    height: u32,
}

impl Size {
    /// The longest side.
    pub const MAX_SIDE: u32 = 1_000_000;
    /// The most pixels.
    pub const MAX_PIXELS: u64 = 1 << 34;

    /// A size within the limits.
    ///
    /// # Errors
    ///
    /// A side of 0 or above [`Size::MAX_SIDE`], and more than [`Size::MAX_PIXELS`] pixels.
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

    /// Reads `WIDTHxHEIGHT`, such as `640x480`.
    fn from_str(text: &str) -> Result<Self, SizeError> {
        let side = |text: &str| number(text).ok_or(SizeError::Malformed);
        let (width, height) = text.split_once(['x', 'X']).ok_or(SizeError::Malformed)?;
        Self::new(side(width)?, side(height)?)
    }
}

/// A size that no picture can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SizeError {
    /// A side is 0 or too long, or there are too many pixels.
    OutOfRange {
        /// The number of columns.
        width: u32,
        /// The number of rows.
        height: u32,
    },
    /// The text is not of the form `WIDTHxHEIGHT`.
    Malformed,
    /// A part of a picture does not lie in it.
    Outside {
        /// The part.
        crop: Crop,
        /// The size of the picture.
        size: Size,
    },
    /// The text is not of the form `X,Y,W,H`.
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

impl Error for SizeError {}

/// A part of a picture: a rectangle of pixels, counted from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Crop {
    column: u32,
    row: u32,
    size: Size,
}

impl Crop {
    /// The rectangle of a size whose top left pixel stands in a column and a row.
    ///
    /// # Errors
    ///
    /// A size outside of the limits of [`Size`].
    pub fn new(column: u32, row: u32, width: u32, height: u32) -> Result<Self, SizeError> {
        Ok(Self {
            column,
            row,
            size: Size::new(width, height)?,
        })
    }

    /// All of a picture.
    pub(crate) const fn whole(size: Size) -> Self {
        Self {
            column: 0,
            row: 0,
            size,
        }
    }

    /// The column of the top left pixel.
    pub const fn column(self) -> u32 {
        self.column
    }

    /// The row of the top left pixel, from the top.
    pub const fn row(self) -> u32 {
        self.row
    }

    /// The size of the part.
    pub const fn size(self) -> Size {
        self.size
    }

    /// The columns, from the left.
    pub(crate) fn columns(self) -> Range<u32> {
        self.column..self.column + self.size.width
    }

    /// The rows, from the top.
    pub(crate) fn rows(self) -> Range<u32> {
        self.row..self.row + self.size.height
    }

    /// Refuses what does not lie in a picture.
    pub(crate) fn check(self, size: Size) -> Result<(), SizeError> {
        let fits = |first: u32, side: u32, whole: u32| first <= whole && side <= whole - first;
        let is_inside = fits(self.column, self.size.width, size.width)
            && fits(self.row, self.size.height, size.height);
        let outside = SizeError::Outside { crop: self, size };
        if is_inside { Ok(()) } else { Err(outside) }
    }
}

impl fmt::Display for Crop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { column, row, size } = self;
        write!(f, "{column},{row},{},{}", size.width, size.height)
    }
}

impl FromStr for Crop {
    type Err = SizeError;

    /// Reads `X,Y,W,H`, such as `0,0,64,64`.
    fn from_str(text: &str) -> Result<Self, SizeError> {
        let mut numbers = text.split(',').map(number);
        let mut next = || numbers.next().flatten().ok_or(SizeError::MalformedCrop);
        let [column, row, width, height] = [next()?, next()?, next()?, next()?];
        match numbers.next() {
            None => Self::new(column, row, width, height),
            Some(_) => Err(SizeError::MalformedCrop),
        }
    }
}

/// Reads an integer; one too long for an u32 is out of any range, not malformed.
fn number(text: &str) -> Option<u32> {
    let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| text.parse().unwrap_or(u32::MAX))
}

/// How many samples each pixel has: n x n in a regular grid, n from 1 to 64.
///
/// Point (i, j) of pixel (x, y) is `(x + (i+½)/n - ½, y + (j+½)/n - ½)`, all counted from the
/// bottom left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Samples {
    side: u32,
}

impl Samples {
    /// One sample, in the middle of the pixel.
    pub const ONE: Self = Self { side: 1 };
    /// The largest n.
    pub const MAX_SIDE: u32 = 64;

    /// So many samples.
    ///
    /// # Errors
    ///
    /// A number that is not the square of 1 to [`Samples::MAX_SIDE`].
    pub fn new(count: u32) -> Result<Self, SamplesError> {
        let side = count.isqrt();
        if (1..=Self::MAX_SIDE).contains(&side) && side * side == count {
            Ok(Self { side })
        } else {
            Err(SamplesError::OutOfRange { count })
        }
    }

    /// Every number of samples that there is, from 1.
    pub(crate) fn all() -> impl Iterator<Item = u32> {
        (1..=Self::MAX_SIDE).map(|side| side * side)
    }

    /// Where the points of the grid lie in a column or row of pixels: `x + (i+½)/n - ½`.
    pub(crate) fn offsets(self, x: f64) -> impl Iterator<Item = f64> {
        let side = f64::from(self.side);
        (0..self.side).map(move |i| x + (f64::from(i) + 0.5) / side - 0.5)
    }

    /// How many there are in a row of the grid: n.
    pub const fn side(self) -> u32 {
        self.side
    }

    /// How many there are in all: n².
    pub const fn count(self) -> u32 {
        self.side * self.side
    }
}

impl Default for Samples {
    fn default() -> Self {
        Self::ONE
    }
}

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.count().fmt(f)
    }
}

impl FromStr for Samples {
    type Err = SamplesError;

    /// Reads a number of samples, such as `16`.
    fn from_str(text: &str) -> Result<Self, SamplesError> {
        number(text).map_or(Err(SamplesError::Malformed), Self::new)
    }
}

/// A number of samples that no pixel can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SamplesError {
    /// The number is not a square, or not one of 1 to [`Samples::MAX_SIDE`].
    OutOfRange {
        /// The number.
        count: u32,
    },
    /// The text is not a whole number.
    Malformed,
}

impl SamplesError {
    /// The numbers that can be, next to the one that cannot.
    pub(crate) fn help(self) -> String {
        let Self::OutOfRange { count } = self else {
            return "write a whole number such as 16".to_owned();
        };
        let below = count.isqrt().min(Samples::MAX_SIDE);
        match (below, below + 1) {
            (0, _) => "the least is 1".to_owned(),
            (Samples::MAX_SIDE, _) => format!("the most are {}", below * below),
            (_, above) => format!("the nearest are {} and {}", below * below, above * above),
        }
    }
}

impl fmt::Display for SamplesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a pixel has 1, 4, 9, 16, … or 4096 samples, a square of 1 to 64")?;
        match self {
            Self::OutOfRange { count } => write!(f, ", found {count}; {}", self.help()),
            Self::Malformed => write!(f, "; {}", self.help()),
        }
    }
}

impl Error for SamplesError {}

/// A band of a picture: some rows of it, from the top, with what each pixel sees.
///
/// A pixel holds the index of the geometry that it sees; its color derives from that. Where its
/// samples see several, it holds the number of what became of them, which follow on the indices.
/// A band comes in pieces, from left to right, as each is the work of one thread.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Film {
    pieces: Vec<Piece>,
}

/// Some columns of a band.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Piece {
    width: usize,
    indices: Vec<u32>,
    /// How many geometries there are: the number of the first of `mixed`.
    geometries: u32,
    mixed: Vec<Mixed>,
}

impl Piece {
    /// Columns of a band in which nothing is seen yet, of a world of so many geometries.
    pub(crate) fn new(width: u32, height: u32, geometries: usize) -> Self {
        let width = width as usize;
        Self {
            width,
            indices: vec![NOTHING; width * height as usize],
            geometries: u32::try_from(geometries).unwrap_or(NOTHING),
            mixed: Vec::new(),
        }
    }

    /// Adds what the pixels are whose numbers follow on the indices of geometries, in that order.
    pub(crate) fn mix(&mut self, mixed: impl Iterator<Item = Mixed>) {
        self.mixed.extend(mixed);
    }

    /// What the ray through the center of a pixel sees that holds a number.
    pub(crate) fn center(&self, number: u32) -> u32 {
        self.mixed(number).map_or(number, |mixed| mixed.center)
    }

    /// What a pixel is that holds such a number.
    pub(crate) fn mixed(&self, number: u32) -> Option<&Mixed> {
        self.mixed
            .get(number.checked_sub(self.geometries)? as usize)
    }

    /// The rows, from the top: the index of the geometry that each pixel sees.
    pub(crate) fn rows_mut(&mut self) -> impl ExactSizeIterator<Item = &mut [u32]> {
        self.indices.chunks_exact_mut(self.width)
    }

    /// How many pixels it has.
    pub(crate) fn pixels(&self) -> usize {
        self.indices.len()
    }
}

impl Film {
    /// Adds what lies to the right, which is as high.
    pub(crate) fn push(&mut self, piece: Piece) {
        self.pieces.push(piece);
    }

    /// Adds all that another one has, to the right.
    pub(crate) fn extend(&mut self, other: Self) {
        self.pieces.extend(other.pieces);
    }

    /// How many columns there are.
    pub(crate) fn width(&self) -> usize {
        self.pieces.iter().map(|piece| piece.width).sum()
    }

    /// How many rows there are.
    pub(crate) fn height(&self) -> usize {
        let height = |piece: &Piece| piece.indices.len() / piece.width;
        self.pieces.first().map_or(0, height)
    }

    /// What each pixel of a row sees, from the left, in runs that lie together in memory.
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = (&Piece, &[u32])> {
        let pieces = self.pieces.iter();
        pieces.map(move |piece| (piece, &piece.indices[row * piece.width..][..piece.width]))
    }

    /// What each pixel sees, row by row from the top left, in runs that lie together in memory.
    pub(crate) fn runs(&self) -> impl Iterator<Item = (&Piece, &[u32])> {
        (0..self.height()).flat_map(|row| self.row(row))
    }

    /// Writes what `table` holds for each pixel behind what stands in `out`.
    pub(crate) fn append<const N: usize>(&self, table: &ColorTable<N>, out: &mut Vec<u8>) {
        /// Pixels that are compared at once, without a branch for each.
        const GROUP: usize = 16;
        // What a flat picture mostly is: a group of one color, most often that of the last.
        let (mut last, mut pattern) = (NOTHING, [table.of(NOTHING); GROUP]);
        for (piece, run) in self.runs() {
            let of = |index: u32| match piece.mixed(index) {
                Some(mixed) => table.mixed(mixed),
                None => table.of(index),
            };
            out.reserve(run.len() * N);
            let mut groups = run.chunks_exact(GROUP);
            for group in &mut groups {
                let first = group[0];
                if group.iter().fold(0, |other, index| other | (index ^ first)) != 0 {
                    let group: [u32; GROUP] = std::array::from_fn(|pixel| group[pixel]);
                    out.extend_from_slice(group.map(of).as_flattened());
                    continue;
                }
                if first != last {
                    (last, pattern) = (first, [table.of(first); GROUP]);
                }
                out.extend_from_slice(pattern.as_flattened());
            }
            for &index in groups.remainder() {
                out.extend_from_slice(&of(index));
            }
        }
    }
}

/// A finished picture: bytes of red, green and blue, row by row from the top left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    size: Size,
    pixels: Vec<u8>,
}

impl Image {
    pub(crate) fn new(size: Size, pixels: Vec<u8>) -> Self {
        Self { size, pixels }
    }

    /// The number of columns.
    pub fn width(&self) -> u32 {
        self.size.width
    }

    /// The number of rows.
    pub fn height(&self) -> u32 {
        self.size.height
    }

    /// The width and height.
    pub fn size(&self) -> Size {
        self.size
    }

    /// Red, green and blue of every pixel, row by row from the top left: `3 * width * height`
    /// bytes.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// Red, green and blue of a pixel, `row` counted from the top; `None` outside of the
    /// picture.
    pub fn pixel(&self, column: u32, row: u32) -> Option<[u8; 3]> {
        if column >= self.size.width {
            return None;
        }
        let start = (row as usize * self.size.width as usize + column as usize) * 3;
        let pixel = self.pixels.get(start..start + 3)?;
        pixel.try_into().ok()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::tracer::{color::Color, geometry::Geometry, shape::sphere::Sphere, world::World};

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
            "", "640", "640x", "x480", "640*480", "-1x5", "+1x5", "1x2x3", "1.5x2",
        ] {
            assert_eq!(text.parse::<Size>(), Err(SizeError::Malformed), "{text}");
        }
        for text in ["0x5", "99999999999x5", "1000000x1000000"] {
            let refused = text.parse::<Size>();
            assert!(
                matches!(refused, Err(SizeError::OutOfRange { .. })),
                "{text}"
            );
        }
    }

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
            ("0", "the least is 1"),
            ("2", "the nearest are 1 and 4"),
            ("4095", "the nearest are 3969 and 4096"),
            ("4097", "the most are 4096"),
            ("99999999999", "the most are 4096"),
        ] {
            let refused = text.parse::<Samples>().unwrap_err();
            assert_eq!(refused.help(), help);
        }
    }

    #[test]
    fn every_pixel_has_the_bytes_of_its_geometry() {
        // Runs of 1 to 40 pixels, so that groups hold one color or several.
        let mut run = (0, 0);
        let mut see = || {
            if run.1 == 0 {
                run = (run.0 + 1, run.0 * 7 % 40 + 1);
            }
            run.1 -= 1;
            if run.0 % 3 == 0 {
                NOTHING
            } else {
                run.0 % 3 - 1
            }
        };
        let mut pieces = [70, 31].map(|width| Piece::new(width, 3, 2));
        let mut seen = Vec::new();
        let [left, right] = &mut pieces;
        for (left, right) in left.rows_mut().zip(right.rows_mut()) {
            for index in left.iter_mut().chain(right) {
                *index = see();
                seen.push(*index);
            }
        }
        let mut film = Film::default();
        pieces.into_iter().for_each(|piece| film.push(piece));
        assert!(film.width() == 101 && film.runs().flat_map(|(_, run)| run).eq(&seen));
        let color = |r: f64, g: f64, b: f64| Color::new(r / 255.0, g / 255.0, b / 255.0);
        let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let colors = [color(1.0, 2.0, 3.0), color(4.0, 5.0, 6.0)];
        let geometries = colors.map(|color| Geometry::new(ball, color)).to_vec();
        let table = ColorTable::rgb8(&World::new(geometries, color(9.0, 9.0, 9.0)));
        let mut bytes = vec![7];
        film.append(&table, &mut bytes);
        let expected = seen.iter().flat_map(|&index| match index {
            NOTHING => [9, 9, 9],
            0 => [1, 2, 3],
            _ => [4, 5, 6],
        });
        assert!(bytes[1..].iter().copied().eq(expected));
        assert_eq!(bytes[0], 7);
    }

    #[test]
    fn an_image_gives_its_pixels_from_the_top_left() {
        let image = Image::new(Size::new(2, 1).unwrap(), vec![1, 2, 3, 4, 5, 6]);
        assert_eq!(image.pixel(1, 0), Some([4, 5, 6]));
        assert_eq!(image.pixel(2, 0), None);
        assert_eq!(image.pixel(0, 1), None);
    }
}
