//! What a picture can show of each pixel beside its color, and how that becomes the rows of a
//! file.

pub(crate) mod layout;
mod number;
pub(crate) mod rows;

use crate::diagnostic::named::named;

named! {
    /// What a picture shows of each pixel.
    ///
    /// Color and coverage are those of all samples of a pixel; the others are what the ray through its
    /// center meets.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
    #[non_exhaustive]
    pub enum Layer {
        /// Red, green and blue.
        Color = "color",
        /// The distance along the ray; infinite where nothing was hit.
        Depth = "depth",
        /// The distance along the view axis; infinite where nothing was hit.
        Z = "z",
        /// The point that was hit, in the world; 0 where nothing was.
        Position = "position",
        /// The unit normal at that point, in the world: outward from a closed shape, along `normal` for
        /// a flat one; 0 where nothing was hit.
        Normal = "normal",
        /// The index of the geometry in the world: in the order of the file, each row of a table in the
        /// place of its table; 4294967295 where nothing was hit.
        Id = "id",
        /// The part of the samples that hit something, in 0..1.
        Coverage = "coverage",
    }
}
