//! The faults of a mesh file.

use crate::data::fault::Fault;

/// A fault of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flaw {
    /// A line of an unknown kind.
    Line,
    /// Too few or too many numbers.
    Length,
    /// A word that is not a number of its type.
    Number,
    NotFinite,
    /// A vertex that the file does not have.
    Index,
    /// The file is too short.
    End,
    /// The file goes on behind its end.
    Behind,
    /// A face with fewer than three corners.
    Corners,
    /// A face whose corners are not in a plane.
    NotFlat,
    /// A face whose edges cross, or that has too many corners to find out.
    Crossing,
    /// A vertex without a color among others with one.
    Colorless,
    /// A face without texture coordinates among others with some.
    Untextured,
    /// A color channel outside 0 to 1.
    Clamped,
    /// Materials, which are not read.
    Material,
    /// Lines, points and curves, which are not read.
    NotFace,
    /// A triangle without area.
    Degenerate,
}

impl Flaw {
    /// Returns true if the mesh must not be used.
    pub(crate) const fn is_error(self) -> bool {
        match self {
            Self::Line
            | Self::Length
            | Self::Number
            | Self::NotFinite
            | Self::Index
            | Self::End => true,
            Self::Behind
            | Self::Corners
            | Self::NotFlat
            | Self::Crossing
            | Self::Colorless
            | Self::Untextured
            | Self::Clamped
            | Self::Material
            | Self::NotFace
            | Self::Degenerate => false,
        }
    }
}

/// A fault of a file, and its further places that are not listed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Note {
    pub(crate) flaw: Flaw,
    /// The fault at its first place.
    pub(crate) fault: Fault,
    /// The number of places of the same flaw that are listed before.
    pub(super) before: usize,
    /// The number of places, the first included: of those that are not listed on their own.
    pub(crate) count: usize,
}
