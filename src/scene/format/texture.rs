//! The textures of materials, in a scene file.

use crate::{
    scene::format::{
        color::ColorModel,
        object::object,
        picture::{ENDINGS, PictureFileModel},
        sight::UP,
        variants::{variants, words},
    },
    tracer::{
        error::GeometryError,
        material::texture::{Checkerboard, ImageTexture, Texture, TextureMapping},
        texels::{TexelWrap, Texels},
    },
};

variants! {
    /// A color that depends on the place on a surface. The color of the material is multiplied by it, and it is
    /// white unless it is given.
    pub enum TextureModel = "Texture" {
        /// A checkerboard.
        Checker(CheckerModel) | Checkerboard,
        /// A picture.
        Image(ImageTextureModel) | ImageMap | Bitmap,
    }
}

object! {
    /// A checkerboard.
    #[derive(Default)]
    pub struct CheckerModel = "Checker" {
        /// The color of the first cell and of every second one; white is the default.
        even: Color = ColorModel::WHITE,
        /// The color of the others; `"#404040"` is the default.
        odd: Color = ColorModel::Hex([0x40; 3]),
        /// The side of a cell in the units of `mapping`, above 0; 1 is the default.
        size: Positive = 1.0,
        /// The coordinates on the surface; `Natural()` is the default.
        mapping: Thing(MappingModel)?,
    }
}

object! {
    /// A picture.
    pub struct ImageTextureModel = "Image" {
        /// The picture: a path from the folder of the scene to a file .exr, .hdr, .pfm, .png or .jpg, with `/`
        /// between its parts.
        file | path | filename | image: File { ENDINGS }(PictureFileModel<Texels>),
        /// The interpolation between pixel centers; `Bilinear` is the default.
        interpolation | filter: Choice(TexelInterpolationModel) = TexelInterpolationModel::default(),
        /// The continuation beyond the border of the picture; `Repeat` is the default.
        wrap | extension: Choice(TexelWrapModel) = TexelWrapModel::default(),
        /// The coordinates on the surface; `Natural()` is the default.
        mapping: Thing(MappingModel)?,
    }
}

words! {
    /// The interpolation between pixel centers.
    #[derive(Copy, Default, Eq)]
    pub enum TexelInterpolationModel = "TexelInterpolation" {
        /// A blend of the four nearest pixels.
        #[default]
        Bilinear,
        /// The nearest pixel.
        Nearest,
    }
}

words! {
    /// The continuation of a picture beyond its border.
    #[derive(Copy, Default, Eq)]
    pub enum TexelWrapModel = "TexelWrap" {
        /// The picture again.
        #[default]
        Repeat,
        /// The pixels at its border.
        Clamp,
    }
}

variants! {
    /// The coordinates on a surface, which move with the shape where it is placed.
    pub enum MappingModel = "Mapping" {
        /// The coordinates of the shape.
        Natural(NaturalMappingModel),
        /// Coordinates in a plane: parts of two vectors from a point.
        Planar(PlanarMappingModel),
        /// Longitude and latitude around a point.
        Spherical(SphericalMappingModel),
    }
}

object! {
    /// The coordinates of the shape: of a sphere longitude and latitude, of a cylinder angle and height, of a rectangle its
    /// edges, all from 0 to 1; of a plane two coordinates; of a mesh those of its OBJ or PLY file.
    #[derive(Default)]
    pub struct NaturalMappingModel = "Natural" {}
}

object! {
    /// Coordinates in a plane: parts of two vectors from a point.
    pub struct PlanarMappingModel = "Planar" {
        /// The point where both are 0.
        origin: Point,
        /// The vector over which the first grows by 1.
        u: Direction,
        /// The vector over which the second grows by 1.
        v: Direction,
    }
}

object! {
    /// Longitude and latitude around a point, from 0 to 1.
    pub struct SphericalMappingModel = "Spherical" {
        /// The point.
        center: Point,
        /// The direction of the pole; (0, 1, 0) is the default.
        up: Direction = UP,
        /// The direction where both are 1/2; (0, 0, -1) is the default.
        front: Direction = [0.0, 0.0, -1.0],
    }
}

impl TextureModel {
    /// The texture and its coordinates; `None` as long as its file is not read.
    pub(crate) fn build(&self) -> Result<Option<(Texture, TextureMapping)>, GeometryError> {
        let texture = match self {
            Self::Checker(checker) => {
                let [even, odd] = [checker.even(), checker.odd()].map(|color| color.build());
                Texture::Checker(Checkerboard::new(even, odd, checker.size())?)
            }
            Self::Image(image) => {
                let Some(texels) = image.file.content.clone() else {
                    return Ok(None);
                };
                Texture::Image(ImageTexture {
                    texels,
                    is_smooth: image.interpolation() == TexelInterpolationModel::Bilinear,
                    wrap: match image.wrap() {
                        TexelWrapModel::Repeat => TexelWrap::Repeat,
                        TexelWrapModel::Clamp => TexelWrap::Clamp,
                    },
                })
            }
        };
        let mapping = self
            .mapping()
            .map_or(Ok(TextureMapping::Natural), MappingModel::build)?;
        Ok(Some((texture, mapping)))
    }

    /// Returns the coordinates, if they are given.
    pub(crate) const fn mapping(&self) -> Option<&MappingModel> {
        match self {
            Self::Checker(checker) => checker.mapping.as_ref(),
            Self::Image(image) => image.mapping.as_ref(),
        }
    }

    /// Returns true if the coordinates are those of the shape.
    pub(crate) const fn is_natural(&self) -> bool {
        matches!(self.mapping(), None | Some(MappingModel::Natural(_)))
    }

    /// Returns the picture, if it is one.
    pub(crate) const fn file(&self) -> Option<&PictureFileModel<Texels>> {
        match self {
            Self::Checker(_) => None,
            Self::Image(image) => Some(&image.file),
        }
    }

    /// The same for a change.
    pub(crate) const fn file_mut(&mut self) -> Option<&mut PictureFileModel<Texels>> {
        match self {
            Self::Checker(_) => None,
            Self::Image(image) => Some(&mut image.file),
        }
    }
}

impl MappingModel {
    /// The coordinates.
    pub(crate) fn build(&self) -> Result<TextureMapping, GeometryError> {
        match self {
            Self::Natural(_) => Ok(TextureMapping::Natural),
            Self::Planar(PlanarMappingModel { origin, u, v }) => {
                TextureMapping::planar((*origin).into(), [(*u).into(), (*v).into()])
            }
            Self::Spherical(spherical) => TextureMapping::spherical(
                spherical.center.into(),
                spherical.up().into(),
                spherical.front().into(),
            ),
        }
    }
}
