//! Textures: colors that depend on the place on a surface.

use glam::DVec3;

use crate::tracer::{
    color::Color,
    error::GeometryError,
    material::Material,
    radiance::Radiance,
    shape::{
        Shape,
        uv::{FRONT, around_ball},
    },
    texels::{TexelWrap, Texels},
    transform::Transform,
    vector::{direction, finite, positive, unit},
};

/// Colors by two coordinates on a surface, which the first color of its material is multiplied by, as linear
/// light.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// A checkerboard.
    Checker(Checkerboard),
    /// A picture, whose coordinates grow from 0 at the left to 1 at the right, and from 0 at the bottom to 1 at
    /// the top.
    Image(ImageTexture),
}

/// A texture and the coordinates that it is drawn by.
pub(crate) type MappedTexture = (Texture, TextureMapping);

/// A checkerboard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checkerboard {
    even: Color,
    odd: Color,
    size: f64,
}

/// A picture on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTexture {
    /// The picture.
    pub texels: Texels,
    /// True to blend between the centers of pixels; false for the nearest one.
    pub is_smooth: bool,
    /// The continuation beyond the border of the picture.
    pub wrap: TexelWrap,
}

/// The coordinates on a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TextureMapping {
    /// Those of the shape.
    #[default]
    Natural,
    /// Those of a plane, which go on at a right angle to it: in parts of two vectors.
    Planar {
        /// The point where both are 0.
        origin: DVec3,
        /// The vectors over which each grows by 1.
        axes: [DVec3; 2],
    },
    /// Longitude and latitude as seen from a point, in 0..=1.
    Spherical {
        /// The point.
        center: DVec3,
        /// The unit vectors to the right, up and to the front, where both are 1/2.
        axes: [DVec3; 3],
    },
}

/// A material with a texture, on a shape.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Textured {
    material: Material,
    texture: Texture,
    mapping: TextureMapping,
    /// The shape before it was placed.
    shape: Shape,
    place: Option<Transform>,
}

impl Checkerboard {
    /// Creates a checkerboard with cells of this size.
    ///
    /// # Errors
    ///
    /// Returns an error if the size is not a finite number above 0.
    pub fn new(even: Color, odd: Color, size: f64) -> Result<Self, GeometryError> {
        let size = positive(size, "size")?;
        Ok(Self { even, odd, size })
    }

    fn light(&self, uv: [f64; 2]) -> Radiance {
        let [column, row] = uv.map(|part| (part / self.size).floor());
        // Exact also where numbers are too large for integers.
        let is_even = (column + row).rem_euclid(2.0) == 0.0;
        if is_even { self.even } else { self.odd }.to_linear()
    }
}

impl Texture {
    /// Returns the light at a place.
    fn light(&self, uv: [f64; 2]) -> Radiance {
        match self {
            Self::Checker(checker) => checker.light(uv),
            Self::Image(image) => {
                let (texels, [u, v]) = (&image.texels, uv);
                let x = u * f64::from(texels.width());
                let y = (1.0 - v) * f64::from(texels.height());
                match image.is_smooth {
                    true => texels.blended([x, y], [image.wrap; 2]),
                    false => texels.nearest([x, y], image.wrap),
                }
            }
        }
    }

    /// Calls `see` with all numbers.
    pub(crate) fn each_number(&self, mut see: impl FnMut(f64)) {
        match self {
            Self::Checker(Checkerboard { even, odd, size }) => {
                for color in [even, odd] {
                    see(color.r());
                    see(color.g());
                    see(color.b());
                }
                see(*size);
            }
            Self::Image(ImageTexture {
                texels,
                is_smooth,
                wrap,
            }) => {
                see(f64::from(u8::from(*is_smooth)));
                see(f64::from(*wrap as u8));
                texels.numbers().for_each(see);
            }
        }
    }
}

impl TextureMapping {
    /// Creates coordinates in a plane.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, or if a vector has no length.
    pub fn planar(origin: DVec3, axes: [DVec3; 2]) -> Result<Self, GeometryError> {
        let [u, v] = axes;
        Ok(Self::Planar {
            origin: finite(origin, "origin")?,
            axes: [
                direction(finite(u, "u")?, "u")?,
                direction(finite(v, "v")?, "v")?,
            ],
        })
    }

    /// Creates longitudes and latitudes around a point; the front may lean to the poles.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, if a vector has no length, or if the two are parallel.
    pub fn spherical(center: DVec3, up: DVec3, front: DVec3) -> Result<Self, GeometryError> {
        let up = unit(direction(finite(up, "up")?, "up")?);
        let front = unit(direction(finite(front, "front")?, "front")?);
        let front = front - front.dot(up) * up;
        let front = unit(direction(front, "front")?);
        Ok(Self::Spherical {
            center: finite(center, "center")?,
            axes: [front.cross(up), up, front],
        })
    }

    /// The front of [`TextureMapping::spherical`], where none is given.
    pub const FRONT: DVec3 = FRONT;

    /// Returns the coordinates of a point on a face of a shape, if it has some.
    fn uv(&self, shape: &Shape, point: DVec3, face: u64) -> Option<[f64; 2]> {
        match self {
            Self::Natural => shape.uv(point, face),
            Self::Planar { origin, axes } => {
                let q = point - *origin;
                Some(axes.map(|axis| q.dot(axis) / axis.dot(axis)))
            }
            Self::Spherical { center, axes } => Some(around_ball(point - *center, *axes)),
        }
    }

    fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let (kind, vectors) = match *self {
            Self::Natural => (0.0, [DVec3::ZERO; 3]),
            Self::Planar {
                origin,
                axes: [u, v],
            } => (1.0, [origin, u, v]),
            Self::Spherical {
                center,
                axes: [_, up, front],
            } => (2.0, [center, up, front]),
        };
        let vectors = vectors.into_iter().flat_map(|vector| vector.to_array());
        [kind].into_iter().chain(vectors)
    }
}

impl Textured {
    pub(crate) fn new(material: Material, (texture, mapping): MappedTexture, shape: Shape) -> Self {
        Self {
            material,
            texture,
            mapping,
            shape,
            place: None,
        }
    }

    /// The material without the texture.
    pub(crate) const fn material(&self) -> &Material {
        &self.material
    }

    /// Returns the same where the shape is placed, once more.
    pub(crate) fn placed(&self, transform: &Transform) -> Result<Self, GeometryError> {
        let place = match &self.place {
            Some(inner) => transform.times(inner)?,
            None => *transform,
        };
        Ok(Self {
            place: Some(place),
            ..self.clone()
        })
    }

    /// Returns the material at a point of a face.
    pub(crate) fn at(&self, point: DVec3, face: u64) -> Material {
        let point = self
            .place
            .as_ref()
            .map_or(point, |place| place.point_back(point));
        match self.mapping.uv(&self.shape, point, face) {
            None => self.material.clone(),
            Some(uv) => {
                let light = self.material.color().to_linear() * self.texture.light(uv);
                self.material.with_color(Color::from_linear(light))
            }
        }
    }

    /// Calls `see` with all numbers but those of the material.
    pub(crate) fn each_number(&self, mut see: impl FnMut(f64)) {
        self.mapping.numbers().for_each(&mut see);
        let rows = self.place.iter().flat_map(Transform::rows);
        rows.flatten().for_each(&mut see);
        self.texture.each_number(see);
    }
}
