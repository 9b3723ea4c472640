//! The materials of one geometry: the same everywhere, or one that depends on the point.

use std::sync::Arc;

use crate::tracer::material::Material;

/// The materials of one geometry.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Coating {
    /// The same everywhere.
    Plain(Material),
    /// One for each face.
    ByFace(Arc<ByFace>),
}

/// The materials of the faces of one geometry.
#[derive(Debug, PartialEq)]
pub(crate) struct ByFace {
    /// The materials of the first faces, in the order of their numbers.
    faces: Box<[Material]>,
    /// The material of all other faces.
    others: Material,
}

impl ByFace {
    /// Returns the material of a face.
    #[inline]
    pub(crate) fn of(&self, face: u32) -> &Material {
        self.faces.get(face as usize).unwrap_or(&self.others)
    }
}

impl Coating {
    /// Creates the coating of some faces in the order of their numbers, and that of all others.
    pub(crate) fn by_face(faces: impl IntoIterator<Item = Material>, others: Material) -> Self {
        let faces: Box<[_]> = faces.into_iter().collect();
        match faces.iter().all(|material| *material == others) {
            true => Self::Plain(others),
            false => Self::ByFace(ByFace { faces, others }.into()),
        }
    }

    /// Returns the material of all faces that have none of their own.
    #[inline]
    pub(crate) fn main(&self) -> &Material {
        match self {
            Self::Plain(material) => material,
            Self::ByFace(materials) => &materials.others,
        }
    }

    /// Returns the material of a face.
    pub(crate) fn of(&self, face: u32) -> &Material {
        match self {
            Self::Plain(material) => material,
            Self::ByFace(materials) => materials.of(face),
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

    /// Returns all materials, that of all other faces last; some may be equal.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Material> {
        let of_faces = match self {
            Self::Plain(_) => &[][..],
            Self::ByFace(materials) => &materials.faces,
        };
        of_faces.iter().chain([self.main()])
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
        assert_eq!((unequal.plain(), unequal.all().count()), (None, 2));
    }

    // A million spheres pay nothing for it.
    #[test]
    fn a_coating_is_no_larger_than_a_material() {
        assert_eq!(size_of::<Coating>(), size_of::<Material>());
    }
}
