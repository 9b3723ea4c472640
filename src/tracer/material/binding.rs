//! The materials of one geometry: the same everywhere, or one that depends on the point.

use std::sync::Arc;

use crate::tracer::{
    color::Color,
    colormap::scale::ColorScale,
    material::{Material, texture::Textured},
    radiance::Radiance,
    vector::weighted,
};

/// The materials of one geometry.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum MaterialBinding {
    /// The same everywhere.
    Plain(Material),
    /// One for each face.
    ByFace(Arc<ByFace>),
    /// One whose first color depends on the triangle of a mesh, or its vertices.
    ByVertex(Arc<ByVertex>),
    /// One whose first color depends on the point.
    Textured(Arc<Textured>),
    /// One binding for each shape that copies are of.
    ByShape(Arc<ByShape>),
}

/// The bindings of the shapes that copies are of.
#[derive(Debug, PartialEq)]
pub(crate) struct ByShape {
    /// In the order of the shapes.
    bindings: Box<[MaterialBinding]>,
    /// The materials of all bindings.
    materials: Box<[Material]>,
}

/// The materials of the faces of one geometry.
#[derive(Debug, PartialEq)]
pub(crate) struct ByFace {
    /// The materials of the first faces, in the order of their numbers.
    faces: Box<[Material]>,
    /// The material of all other faces.
    others: Material,
}

/// The material of a mesh whose vertices or triangles determine its first color.
#[derive(Debug, PartialEq)]
pub(crate) struct ByVertex {
    /// The material, with the color of the first vertex.
    first: Material,
    vertices: VertexColors,
}

/// The colors or values of the vertices of a mesh, in their order, or the colors of its triangles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum VertexColors {
    /// Colors, as linear light.
    Colors(Arc<[Radiance]>),
    /// Values that determine colors.
    Values(Arc<[f64]>, ColorScale),
    /// Colors of triangles.
    OfTriangles(Arc<[Color]>),
}

/// The interpolation of a color between the corners of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Interpolation<'a> {
    /// The weights of the corners, in 0..=1; their sum is 1 but for rounding.
    pub weights: [f64; 3],
    /// The colors or values of the corners.
    pub corners: Corners<'a>,
}

/// The colors of the corners of a triangle, or the values that determine them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Corners<'a> {
    /// Colors, which are interpolated as linear light.
    Colors([Radiance; 3]),
    /// Values, which are interpolated, and the colors of values.
    Values([f64; 3], &'a ColorScale),
}

impl<'a> Interpolation<'a> {
    /// Returns the value at the point, and the colors of all values; `None` if the corners have
    /// colors.
    pub fn value(&self) -> Option<(f64, &'a ColorScale)> {
        match self.corners {
            Corners::Colors(_) => None,
            Corners::Values(values, scale) => Some((weighted(values, self.weights), scale)),
        }
    }

    /// Returns the color at the point.
    pub fn color(&self) -> Color {
        match self.corners {
            Corners::Colors(colors) => Color::from_linear(weighted(colors, self.weights)),
            Corners::Values(values, scale) => scale.color(weighted(values, self.weights)),
        }
    }
}

impl VertexColors {
    /// Returns what the corners of a triangle have.
    fn of(&self, corners: [u32; 3]) -> Option<Corners<'_>> {
        Some(match self {
            Self::Colors(colors) => Corners::Colors(pick(colors, corners)?),
            Self::Values(values, scale) => Corners::Values(pick(values, corners)?, scale),
            Self::OfTriangles(_) => return None,
        })
    }

    /// Returns the color of the first vertex or triangle.
    fn first(&self) -> Color {
        if let Self::OfTriangles(colors) = self {
            return colors.first().copied().unwrap_or_default();
        }
        let corners = self.of([0; 3]);
        corners.map_or(Color::BLACK, |corners| {
            let weights = [1.0, 0.0, 0.0];
            Interpolation { weights, corners }.color()
        })
    }
}

fn pick<T: Copy>(of_vertices: &[T], corners: [u32; 3]) -> Option<[T; 3]> {
    let [a, b, c] = corners.map(|corner| of_vertices.get(corner as usize).copied());
    Some([a?, b?, c?])
}

impl ByVertex {
    /// The colors or values of the vertices.
    pub(crate) const fn vertices(&self) -> &VertexColors {
        &self.vertices
    }

    /// Returns how the first color follows at a point of a triangle with these corners.
    pub(crate) fn at(&self, corners: [u32; 3], weights: [f64; 3]) -> Option<Interpolation<'_>> {
        let corners = self.vertices.of(corners)?;
        Some(Interpolation { weights, corners })
    }

    /// Returns the color of a triangle, if it has one of its own.
    pub(crate) fn of_triangle(&self, face: u64) -> Option<Color> {
        match &self.vertices {
            VertexColors::OfTriangles(colors) => colors.get(face as usize).copied(),
            VertexColors::Colors(_) | VertexColors::Values(..) => None,
        }
    }

    /// Returns the material with a first color.
    pub(crate) fn with_color(&self, color: Color) -> Material {
        self.first.with_color(color)
    }
}

impl ByShape {
    /// The bindings, in the order of the shapes.
    pub(crate) const fn bindings(&self) -> &[MaterialBinding] {
        &self.bindings
    }
}

impl ByFace {
    /// Returns the material of a face.
    #[inline]
    pub(crate) fn of(&self, face: u64) -> &Material {
        self.faces.get(face as usize).unwrap_or(&self.others)
    }
}

impl MaterialBinding {
    /// Creates the binding of some faces in the order of their numbers, and that of all others.
    pub(crate) fn by_face(faces: impl IntoIterator<Item = Material>, others: Material) -> Self {
        let faces: Box<[_]> = faces.into_iter().collect();
        match faces.iter().all(|material| *material == others) {
            true => Self::Plain(others),
            false => Self::ByFace(ByFace { faces, others }.into()),
        }
    }

    /// Creates the binding of a mesh whose vertices determine the first color of its material.
    pub(crate) fn by_vertex(material: &Material, vertices: VertexColors) -> Self {
        let first = material.with_color(vertices.first());
        Self::ByVertex(ByVertex { first, vertices }.into())
    }

    /// Creates the binding of copies of shapes with these, at least one.
    pub(crate) fn by_shape(bindings: Box<[Self]>) -> Self {
        let materials = bindings.iter().flat_map(Self::all).cloned().collect();
        match &*bindings {
            [one] => one.clone(),
            [Self::Plain(material), others @ ..]
                if others.iter().all(|other| other.plain() == Some(material)) =>
            {
                Self::Plain(material.clone())
            }
            _ => Self::ByShape(
                ByShape {
                    bindings,
                    materials,
                }
                .into(),
            ),
        }
    }

    /// Returns the binding of one of the shapes that copies are of.
    pub(crate) fn of_shape(&self, index: usize) -> &Self {
        match self {
            Self::ByShape(all) => all.bindings.get(index).unwrap_or(self),
            Self::Plain(_) | Self::ByFace(_) | Self::ByVertex(_) | Self::Textured(_) => self,
        }
    }

    /// Returns the material of all faces that have none of their own; where the vertices determine
    /// its color, that of the first vertex, and of copies that of the first shape.
    #[inline]
    pub(crate) fn main(&self) -> &Material {
        match self {
            Self::Plain(material) => material,
            Self::ByFace(materials) => &materials.others,
            Self::ByVertex(materials) => &materials.first,
            Self::Textured(textured) => textured.material(),
            Self::ByShape(all) => match &*all.bindings {
                [first, ..] => first.main(),
                [] => &Material::Matte(Color::BLACK),
            },
        }
    }

    /// Returns the material, if it is the same everywhere.
    #[inline]
    pub(crate) const fn plain(&self) -> Option<&Material> {
        match self {
            Self::Plain(material) => Some(material),
            Self::ByFace(_) | Self::ByVertex(_) | Self::Textured(_) | Self::ByShape(_) => None,
        }
    }

    /// Returns what the vertices have, if they determine colors.
    #[inline]
    pub(crate) fn vertices(&self) -> Option<&VertexColors> {
        match self {
            Self::Plain(_) | Self::ByFace(_) | Self::Textured(_) | Self::ByShape(_) => None,
            Self::ByVertex(materials) => Some(materials.vertices()),
        }
    }

    /// Returns all materials, that of all other faces last; some may be equal. Colors that depend on
    /// vertices are left out, except for the first, and so are textures.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Material> {
        let (first, last) = match self {
            Self::Plain(_) | Self::ByVertex(_) | Self::Textured(_) => (&[][..], Some(self.main())),
            Self::ByFace(materials) => (&*materials.faces, Some(self.main())),
            Self::ByShape(all) => (&*all.materials, None),
        };
        first.iter().chain(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::color::Color;

    #[test]
    fn equal_materials_are_one() {
        let [white, black] = [Color::WHITE, Color::BLACK].map(Material::Matte);
        let equal = MaterialBinding::by_face([white.clone(), white.clone()], white.clone());
        assert_eq!(equal.plain(), Some(&white));
        let unequal = MaterialBinding::by_face([white.clone()], black);
        assert_eq!((unequal.plain(), unequal.all().count()), (None, 2));
    }

    // A million spheres pay nothing for it.
    #[test]
    fn a_binding_is_no_larger_than_a_material() {
        assert_eq!(size_of::<MaterialBinding>(), size_of::<Material>());
    }
}
