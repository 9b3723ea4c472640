//! Parts of one job, for several processes or machines.

use std::{
    error::Error,
    fmt,
    ops::Range,
    path::{Path, PathBuf},
    str::FromStr,
};

/// The extension of a file that holds a band.
pub(crate) const BAND: &str = ".part";

/// A part of a job that is split into `count` parts: the one with the number `index`, from 0.
///
/// # Examples
///
/// ```
/// use strahl::jobs::Shard;
///
/// let shard: Shard = "1/3".parse()?;
/// let taken: Vec<_> = (0..8).filter(|number| shard.takes(*number)).collect();
/// assert_eq!(taken, [1, 4, 7]);
/// assert!("3/3".parse::<Shard>().is_err());
/// # Ok::<(), strahl::jobs::ShardError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Shard {
    index: u32,
    count: u32,
}

/// The error for an invalid part.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct ShardError;

impl fmt::Display for ShardError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("expected I/N, the number of a part from 0 to N-1 and the number of parts")
    }
}

/// Same as `Display`, because a `main` that returns an error prints it with `Debug`.
impl fmt::Debug for ShardError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Error for ShardError {}

impl Shard {
    /// The whole job as one part.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// Creates part `index`, from 0, of `count`.
    ///
    /// # Errors
    ///
    /// Fails if the index is not less than the count.
    pub const fn new(index: u32, count: u32) -> Result<Self, ShardError> {
        if index < count {
            Ok(Self { index, count })
        } else {
            Err(ShardError)
        }
    }

    /// Returns the number of the part, from 0.
    pub const fn index(self) -> u32 {
        self.index
    }

    /// Returns the number of parts.
    pub const fn count(self) -> u32 {
        self.count
    }

    /// Returns the file that holds this band of a picture, next to it.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::jobs::Shard;
    ///
    /// let band = Shard::new(0, 4)?.file("out.png".as_ref());
    /// assert_eq!(band.to_str(), Some("out.png.0-of-4.part"));
    /// # Ok::<(), strahl::jobs::ShardError>(())
    /// ```
    pub fn file(self, picture: &Path) -> PathBuf {
        let mut name = picture.to_owned().into_os_string();
        name.push(format!(".{}-of-{}{BAND}", self.index, self.count));
        name.into()
    }

    /// Returns true if the item with this number belongs to the part. Each part takes every
    /// `count`-th item, so that work that grows or shrinks along a list is shared evenly.
    pub const fn takes(self, number: u64) -> bool {
        number % self.count as u64 == self.index as u64
    }

    /// Returns the rows of this part for a picture with `rows` rows. They are contiguous.
    pub(crate) fn rows(self, rows: u32) -> Range<u32> {
        let at = |index: u32| u64::from(rows) * u64::from(index) / u64::from(self.count);
        at(self.index) as u32..at(self.index + 1) as u32
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let (index, count) = text.split_once('/').ok_or(ShardError)?;
        let number = |text: &str| text.trim().parse().map_err(|_| ShardError);
        Self::new(number(index)?, number(count)?)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shards_are_complete_and_do_not_overlap() {
        let rows = |index, count, rows| Shard::new(index, count).unwrap().rows(rows);
        for (height, count) in [(480, 7), (3, 5), (1, 1), (100, 100)] {
            let mut next = 0;
            for index in 0..count {
                let part = rows(index, count, height);
                assert_eq!(part.start, next);
                next = part.end;
            }
            assert_eq!(next, height);
        }
        let many = 4_000_000_000;
        assert_eq!(rows(0, many, 1_000_000), 0..0);
        assert_eq!(rows(many - 1, many, 1_000_000), 999_999..1_000_000);
    }

    #[test]
    fn invalid_shards_are_rejected() {
        for text in ["", "1", "1/", "/2", "2/2", "-1/2", "0/0", "1/2/3", "a/b"] {
            assert_eq!(text.parse::<Shard>(), Err(ShardError), "{text}");
        }
    }
}
