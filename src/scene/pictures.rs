//! Opens and reads the pictures that a scene names.

use std::{
    collections::{BTreeMap, HashMap},
    io::Read,
    sync::Arc,
};

use crate::{
    compare::{limit::PictureOptions, picture::Picture, profile::other_than_srgb},
    diagnostic::{Code, path::Path},
    scene::{
        files::{self, Folder},
        format::{
            backdrop::BackdropModel, geometry::GeometryModel, light::LightModel,
            picture::PictureFileModel, scene::Model, texture::TextureModel,
        },
        options::ReadOptions,
        place::Place,
        problem::Problem,
    },
    tracer::{light::picture::SkyPicture, texels::Texels},
};

/// The longest file of a picture: that of the largest one, with four floats a pixel.
const LONGEST: u64 = 1 << 32;

/// Reads all pictures of a scene into its model, each file once, and returns their problems.
pub(crate) fn read(model: &mut Model, files: &Folder<'_>, options: &ReadOptions) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut known: BTreeMap<Box<str>, Texels> = BTreeMap::new();
    let mut read = |place: &Place| -> Option<Texels> {
        if options.is_cancelled() {
            return None;
        }
        if let Some(texels) = known.get(place.file) {
            return Some(texels.clone());
        }
        match open(place, files, options) {
            Ok((texels, ignored)) => {
                problems.extend(ignored.map(|what| ignored_colors(place, what)));
                known.insert(place.file.into(), texels.clone());
                Some(texels)
            }
            Err(problem) => {
                problems.push(problem);
                None
            }
        }
    };
    let mut black = Vec::new();
    model.each_picture_mut(|variant, named| {
        let place = Place {
            file: &named.path,
            field: "image",
            variant,
        };
        let texels = read(&place);
        let built = texels.and_then(|it| SkyPicture::until(it, || options.is_cancelled()));
        match built {
            Some(Ok(picture)) => named.content = Some(picture),
            Some(Err(error)) => {
                black.push(place.problem(Code::InvalidImage, error.to_string()));
            }
            None => {}
        }
    });
    model.each_texture_mut(|variant, named| {
        let place = Place {
            file: &named.path,
            field: "file",
            variant,
        };
        named.content = read(&place);
    });
    problems.extend(black);
    problems
}

/// Warns about what a file says of its colors.
fn ignored_colors(place: &Place, what: &str) -> Problem {
    let message = format!("the {what} has no effect: the colors are those of sRGB");
    let problem = place.problem(Code::NoEffect, message);
    problem.help("convert the picture to sRGB")
}

/// Reads a picture. Also returns what is ignored of the colors in its file.
fn open(
    place: &Place,
    files: &Folder<'_>,
    options: &ReadOptions,
) -> Result<(Texels, Option<&'static str>), Problem> {
    let unreadable = |error| place.problem(Code::FileNotFound, files::cause(error));
    let (_, file, length) = place.open_data(files, Code::InvalidImage)?;
    if length > LONGEST {
        let message = format!("the file has {length} bytes, the maximum is {LONGEST}");
        return Err(place.problem(Code::InvalidImage, message));
    }
    let mut bytes = Vec::new();
    let reserved = bytes.try_reserve_exact(usize::try_from(length).unwrap_or(usize::MAX));
    reserved.map_err(|error| unreadable(error.into()))?;
    let read = options
        .until_cancelled(file)
        .take(LONGEST)
        .read_to_end(&mut bytes);
    read.map_err(unreadable)?;
    let invalid = |what: &str| place.problem(Code::InvalidImage, what);
    let (limits, cancel) = (PictureOptions::new(), options.canceller());
    let picture = Picture::until_cancelled(&bytes, &limits, cancel);
    let picture = picture.map_err(|error| invalid(error.cause()))?;
    let ignored = other_than_srgb(&bytes, cancel);
    drop(bytes);
    let size = picture.size();
    let light = picture.into_light(cancel);
    let light = light.map_err(|error| invalid(error.cause()))?;
    let texels = Texels::new(size.width(), size.height(), light);
    let texels = texels.map_err(|error| invalid(&error.to_string()))?;
    Ok((texels, ignored))
}

impl Model {
    /// Returns the pictures that the scene names.
    pub(crate) fn pictures(&self) -> impl Iterator<Item = &PictureFileModel<SkyPicture>> {
        let lights = self.lights.iter().flatten();
        lights.filter_map(|light| match light {
            LightModel::Environment(environment) => environment.image.as_ref(),
            _ => None,
        })
    }

    /// Calls `see` with each picture that the scene names and the path of what names it.
    pub(crate) fn each_picture_mut(
        &mut self,
        mut see: impl FnMut(Path, &mut PictureFileModel<SkyPicture>),
    ) {
        for (index, light) in self.lights.iter_mut().flatten().enumerate() {
            if let LightModel::Environment(environment) = light
                && let Some(picture) = &mut environment.image
            {
                let path = Path::ROOT.field("lights");
                see(path.index(index), picture);
            }
        }
    }

    /// Drops the pictures that were read, and returns their number.
    pub(crate) fn forget_pictures(&mut self) -> usize {
        let mut forgotten = 0;
        self.each_picture_mut(|_, named| {
            forgotten += usize::from(named.content.take().is_some());
        });
        self.each_texture_mut(|_, named| {
            forgotten += usize::from(named.content.take().is_some());
        });
        forgotten
    }

    /// Returns the pictures of the textures of materials with names, and that of the backdrop.
    pub(crate) fn named_textures(&self) -> impl Iterator<Item = &PictureFileModel<Texels>> {
        let named = self.materials.iter().flat_map(|materials| &materials.0);
        let backdrop = self.backdrop.as_ref().and_then(BackdropModel::file);
        let named = named.filter_map(|(_, material)| material.described().ok()?.texture()?.file());
        named.chain(backdrop)
    }

    /// Returns the pictures of all textures, and that of the backdrop.
    pub(crate) fn textures(&self) -> impl Iterator<Item = &PictureFileModel<Texels>> {
        let own = self.walk();
        let own = own.filter_map(|(_, geometry)| geometry.surface().own_texture()?.file());
        self.named_textures().chain(own)
    }

    /// Calls `see` with each picture of a texture or the backdrop and the path of what names it. Geometries that share a material
    /// share it afterwards.
    pub(crate) fn each_texture_mut(
        &mut self,
        mut see: impl FnMut(Path, &mut PictureFileModel<Texels>),
    ) {
        if let Some(file) = self.backdrop.as_mut().and_then(BackdropModel::file_mut) {
            see(Path::ROOT.field("backdrop"), file);
        }
        for (name, material) in self
            .materials
            .iter_mut()
            .flat_map(|materials| &mut materials.0)
        {
            if let Some(file) = material.texture_mut().and_then(TextureModel::file_mut) {
                let path = Path::ROOT.field("materials");
                see(path.key(name).field("texture"), file);
            }
        }
        let all = self.walk().filter(|(_, geometry)| is_textured(geometry));
        let all: Vec<_> = all.map(|(at, _)| at).collect();
        let (mut materials, mut textures) =
            (ChangedArcs(HashMap::new()), ChangedArcs(HashMap::new()));
        for at in all {
            let path = self.path_of(at);
            let Some(geometry) = self.geometry_mut(at) else {
                continue;
            };
            if let Some(texture) = geometry.texture_mut() {
                textures.change(texture, |texture| {
                    if let Some(file) = texture.file_mut() {
                        see(path.field("texture"), file);
                    }
                });
            } else if let Some(material) = geometry.material_mut() {
                materials.change(material, |material| {
                    if let Some(file) = material.texture_mut().and_then(TextureModel::file_mut) {
                        see(path.field("material").field("texture"), file);
                    }
                });
            }
        }
    }
}

/// Shared values that were changed, by their places before: the values before, which stay so that no other
/// takes their places, and those after.
struct ChangedArcs<T>(HashMap<*const T, [Arc<T>; 2]>);

impl<T: Clone> ChangedArcs<T> {
    /// Changes a value, once for all that share it.
    fn change(&mut self, shared: &mut Arc<T>, change: impl FnOnce(&mut T)) {
        let [_, after] = self.0.entry(Arc::as_ptr(shared)).or_insert_with(|| {
            let mut own = T::clone(shared);
            change(&mut own);
            [Arc::clone(shared), Arc::new(own)]
        });
        shared.clone_from(after);
    }
}

/// Returns true if a geometry has a texture from a file, beside its color or in a material without a name.
#[inline]
pub(crate) fn is_textured(geometry: &GeometryModel) -> bool {
    let texture = geometry.surface().own_texture();
    texture.is_some_and(|texture| texture.file().is_some())
}
