//! The materials of a scene file: one file for each kind, with its fields and its construction.

pub(crate) mod emissive;
pub(crate) mod flat;
pub(crate) mod glass;
pub(crate) mod kind;
pub(crate) mod matte;
pub(crate) mod metal;
pub(crate) mod mirror;
pub(crate) mod named;
pub(crate) mod phong;
pub(crate) mod plastic;
pub(crate) mod principled;

pub use self::{
    emissive::EmissiveModel, flat::FlatModel, glass::GlassModel, matte::MatteModel,
    metal::MetalModel, mirror::MirrorModel, named::NamedModel, phong::PhongModel,
    plastic::PlasticModel, principled::PrincipledModel,
};

use std::{collections::HashMap, sync::Arc};

use serde::de::MapAccess;

use crate::{
    diagnostic::path::Path,
    scene::format::{
        color::{ColorModel, or_white},
        map::{Entry, Map},
        material::kind::MaterialKind,
        texture::TextureModel,
        variants::variants,
    },
    tracer::{
        error::GeometryError,
        material::{Material, texture::MappedTexture},
    },
};

variants! {
    /// What a surface does with light. Without `lights` a geometry shows its first color.
    pub enum MaterialModel = "Material" for of_each {
        /// Scatters light evenly to all sides.
        Matte(MatteModel) | Lambert | Lambertian | Diffuse | MeshLambertMaterial,
        /// Scatters light, with a highlight, and may reflect a part of what is around it.
        Phong(PhongModel) | MeshPhongMaterial,
        /// A surface of metal.
        Metal(MetalModel),
        /// A colored surface below a clear coat.
        Plastic(PlasticModel),
        /// A surface of metal, or of a clear coat above a colored one, or a mixture of both.
        Principled(PrincipledModel) | PrincipledBSDF | Disney | MeshStandardMaterial,
        /// Reflects what is around it, times a color.
        Mirror(MirrorModel),
        /// Reflects and refracts. A plane or a disc of glass is a pane without thickness.
        Glass(GlassModel) | Dielectric,
        /// Shows its color in any light.
        Flat(FlatModel) | MeshBasicMaterial,
        /// Shines, whatever light falls on it, but lights nothing else.
        Emissive(EmissiveModel) | Emission,
        /// One of the scene's `materials`, by its name.
        Named(NamedModel),
    }
}

impl MaterialModel {
    /// Returns the description, or the name of one.
    pub(crate) fn described(&self) -> Result<&dyn MaterialKind, &str> {
        of_each!(self, material => material.described())
    }

    /// Returns the description, also of a named material; `None` for an unknown name.
    pub(crate) fn resolve<'m>(
        &'m self,
        materials: Option<&'m MaterialsModel>,
    ) -> Option<&'m dyn MaterialKind> {
        self.described().ok().or_else(|| {
            let name = self.named()?;
            let mut entries = materials.into_iter().flat_map(|materials| &materials.0);
            let (_, material) = entries.find(|(known, _)| **known == *name)?;
            material.described().ok()
        })
    }

    /// Returns its texture, for a change; a name has none of its own.
    pub(crate) fn texture_mut(&mut self) -> Option<&mut TextureModel> {
        of_each!(self, material => material.texture_mut())
    }

    /// Returns the name that it refers to.
    pub(crate) fn named(&self) -> Option<&str> {
        self.described().err()
    }
}

/// Materials by their names, in the order of the file.
pub type MaterialsModel = Map<MaterialModel>;

impl<'de> Entry<'de> for MaterialModel {
    const WHAT: &'static str = "a map from names to materials";

    fn read<A: MapAccess<'de>>(_name: &str, map: &mut A) -> Result<Self, A::Error> {
        map.next_value()
    }
}

/// The surface of a geometry: a color, a texture or both, which is a matte one, or a material.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Surface<'m> {
    pub(crate) color: Option<&'m ColorModel>,
    pub(crate) texture: Option<&'m Arc<TextureModel>>,
    pub(crate) material: Option<&'m Arc<MaterialModel>>,
}

impl<'m> Surface<'m> {
    /// Returns true if it has a color, a texture or a material.
    pub(crate) const fn is_given(&self) -> bool {
        self.is_plain() || self.material.is_some()
    }

    /// Returns true if it has a color or a texture beside it.
    pub(crate) const fn is_plain(&self) -> bool {
        self.color.is_some() || self.texture.is_some()
    }

    /// Returns its texture, beside the color or that of a material without a name.
    #[inline]
    pub(crate) fn own_texture(&self) -> Option<&'m TextureModel> {
        let described = || self.material?.described().ok()?.texture();
        self.texture.map(|texture| &**texture).or_else(described)
    }

    /// Returns its texture, also that of a named material.
    pub(crate) fn texture(
        &self,
        materials: Option<&'m MaterialsModel>,
    ) -> Option<&'m TextureModel> {
        let resolved = || self.material?.resolve(materials)?.texture();
        self.texture.map(|texture| &**texture).or_else(resolved)
    }

    /// Returns the path of what the texture belongs to: the field of the geometry at `path`.
    pub(crate) fn path_of_texture(&self, path: Path) -> Path {
        path.field(match self.texture {
            Some(_) => "texture",
            None => "material",
        })
    }
}

/// The materials of a scene and their textures, built.
#[derive(Debug, Default)]
pub(crate) struct Materials(HashMap<Box<str>, (Material, Option<MappedTexture>)>);

impl Materials {
    /// Builds the materials of a scene.
    pub(crate) fn of(model: Option<&MaterialsModel>) -> Result<Self, GeometryError> {
        let entries = model.iter().flat_map(|materials| &materials.0);
        let built = entries.filter_map(|(name, material)| {
            let described = material.described().ok()?;
            let built = || Ok((described.build()?, texture_of(described)?));
            Some(built().map(|built| (name.clone(), built)))
        });
        built.collect::<Result<_, _>>().map(Self)
    }

    /// Builds the material of a surface. One that validation has rejected is matte and black.
    #[inline(always)]
    pub(crate) fn build(&self, surface: Surface) -> Result<Material, GeometryError> {
        match (surface.color, surface.material) {
            (Some(color), _) => Ok(Material::Matte(color.build())),
            (None, Some(material)) => self.of_model(material),
            (None, None) if surface.texture.is_some() => Ok(Material::Matte(or_white(None))),
            (None, None) => Ok(Material::Matte(ColorModel::BLACK.build())),
        }
    }

    /// Builds the texture of a surface, if it has one.
    #[inline]
    pub(crate) fn texture(&self, surface: Surface) -> Result<Option<MappedTexture>, GeometryError> {
        let name = surface.material.and_then(|material| material.named());
        match (surface.own_texture(), name) {
            (Some(texture), _) => texture.build(),
            (None, Some(name)) => Ok(self.0.get(name).and_then(|(_, texture)| texture.clone())),
            (None, None) => Ok(None),
        }
    }

    /// Builds a material.
    pub(crate) fn of_model(&self, material: &MaterialModel) -> Result<Material, GeometryError> {
        match material.described() {
            Ok(material) => material.build(),
            Err(name) => Ok(match self.0.get(name) {
                Some((material, _)) => material.clone(),
                None => Material::Matte(ColorModel::BLACK.build()),
            }),
        }
    }
}

fn texture_of(material: &dyn MaterialKind) -> Result<Option<MappedTexture>, GeometryError> {
    material.texture().map_or(Ok(None), TextureModel::build)
}
