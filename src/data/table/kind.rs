//! The shape that a row stands for.

/// The shape that each row of a table stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum RowKind {
    #[default]
    Sphere,
    Cylinder {
        capped: bool,
    },
    /// The place, direction and size of a copy.
    Copy,
}

impl RowKind {
    /// The name of the shape, in lowercase.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Cylinder { .. } => "cylinder",
            Self::Copy => "copy",
        }
    }

    /// The name of several.
    pub(crate) const fn names(self) -> &'static str {
        match self {
            Self::Sphere => "spheres",
            Self::Cylinder { .. } => "cylinders",
            Self::Copy => "copies",
        }
    }
}
