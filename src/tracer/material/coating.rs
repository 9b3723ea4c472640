//! The materials of one geometry: the same everywhere, or one that depends on the point.

use std::{slice, sync::Arc};

use crate::tracer::material::Material;

/// The materials of one geometry.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Coating {
    /// The same everywhere.
    Plain(Material),
    /// One for each face, in the order of their numbers; the last one is that of all further faces.
    ByFace(Arc<[Material]>),
}

impl Coating {
    /// Creates the coating of some faces in the order of their numbers, and that of all others.
    pub(crate) fn by_face(faces: impl IntoIterator<Item = Material>, others: Material) -> Self {
        let all: Vec<_> = faces.into_iter().chain([others.clone()]).collect();
        match all.iter().all(|material| *material == others) {
            true => Self::Plain(others),
            false => Self::ByFace(all.into()),
        }
    }

    /// Returns the material, if it is the same everywhere.
    #[inline]
    pub(crate) const fn plain(&self) -> Option<&Material> {
        match self {
            Self::Plain(material) => Some(material),
            Self::ByFace(_) => None,
        }
    }

    /// Returns all materials; some may be equal.
    pub(crate) fn all(&self) -> &[Material] {
        match self {
            Self::Plain(material) => slice::from_ref(material),
            Self::ByFace(materials) => materials,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::color::Color;

    #[test]
    fn equal_materials_are_one() {
        let [white, black] = [Color::WHITE, Color::BLACK].map(Material::Matte);
        let equal = Coating::by_face([white.clone(), white.clone()], white.clone());
        assert_eq!(equal.plain(), Some(&white));
        let unequal = Coating::by_face([white.clone()], black);
        assert_eq!((unequal.plain(), unequal.all().len()), (None, 2));
    }

    // A million spheres pay nothing for it.
    #[test]
    fn a_coating_is_no_larger_than_a_material() {
        assert_eq!(size_of::<Coating>(), size_of::<Material>());
    }
}
