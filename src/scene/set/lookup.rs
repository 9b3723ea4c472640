//! Lookup of a word in the place of a setting's path: the field with this or a similar name.

use crate::{
    scene::{
        animation::target::Owner,
        format::{
            animation::AnimationModel,
            field::{Field, Fields},
            lighting::DirectModel,
            map::Map,
            scene::Model,
        },
        path,
    },
    text::nearest::nearest,
};

/// The meaning of a word in the place of a [`Setting`](super::Setting)'s path.
///
/// # Examples
///
/// ```
/// use strahl::{Document, Syntax, scene::FieldLookup};
///
/// let text = "(camera: Orthographic(gaze: (0, 0, -1), eye: (0, 0, 9), scale: 2), geometries: [])";
/// let scene = Document::from_text("mine.ron", text, Syntax::Ron);
/// assert_eq!(scene.look_up("background"), FieldLookup::Found);
/// assert_eq!(scene.look_up("backgrond"), FieldLookup::Misspelt("background"));
/// assert_eq!(scene.look_up("scale"), FieldLookup::Inside("camera.scale".to_owned()));
/// assert_eq!(scene.look_up("id"), FieldLookup::Unknown);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FieldLookup {
    /// A top-level field of the scene, given or not.
    Found,
    /// A misspelling of this top-level field.
    Misspelt(&'static str),
    /// The name, or a misspelling, of a nested field: the path of the first one.
    Inside(String),
    /// No field of the scene.
    Unknown,
}

/// Looks up a word in a scene.
pub(crate) fn look_up(model: &Model, word: &str) -> FieldLookup {
    if !path::parts(word).is_ok_and(|parts| parts.len() == 1) {
        return FieldLookup::Unknown;
    }
    let of_scene = || Model::FIELDS.iter().map(|field| field.name);
    if of_scene().any(|name| name == word) {
        return FieldLookup::Found;
    }
    let path_of = |word: &str| {
        let mut structs = structs(model);
        let (path, _) =
            structs.find(|(_, fields)| fields.iter().any(|field| field.name == word))?;
        Some(FieldLookup::Inside(format!("{path}.{word}")))
    };
    if let Some(inside) = path_of(word) {
        return inside;
    }
    if let Some(field) = nearest(word, &of_scene().collect::<Vec<_>>()) {
        let mut names = of_scene();
        return names
            .find(|name| *name == field)
            .map_or(FieldLookup::Unknown, FieldLookup::Misspelt);
    }
    let fields = structs(model).flat_map(|(_, fields)| fields);
    let mut names: Vec<&str> = fields.map(|field| field.name).collect();
    names.sort_unstable();
    names.dedup();
    let inside = nearest(word, &names).and_then(path_of);
    inside.unwrap_or(FieldLookup::Unknown)
}

/// Returns the path and the fields of every struct in a scene.
fn structs(model: &Model) -> impl Iterator<Item = (String, &'static [Field])> {
    let camera = model.camera.iter();
    let camera = camera.map(|_| ("camera".to_owned(), Owner::Camera));
    let cameras = entries("cameras", model.cameras.as_ref(), Owner::NamedCamera);
    let lights = model.lights.as_ref().map_or(0, Vec::len);
    let lights = (0..lights).map(|index| (format!("lights[{index}]"), Owner::Light(index)));
    let materials = entries("materials", model.materials.as_ref(), Owner::Material);
    let outlines = model.outlines.iter();
    let outlines = outlines.map(|_| ("outlines".to_owned(), Owner::Outlines));
    let geometries = model.walk();
    let geometries = geometries.map(|(at, _)| (model.path_of(at).to_string(), Owner::Geometry(at)));
    let owners = camera.chain(cameras).chain(lights).chain(materials);
    let owners = owners.chain(outlines).chain(geometries);
    let image = [("image".to_owned(), Owner::Image)].into_iter();
    let animation = model.animation.iter();
    let animation = animation.map(|_| ("animation".to_owned(), AnimationModel::FIELDS));
    let lighting = [("lighting".to_owned(), DirectModel::FIELDS)];
    let fields = |(path, owner): (String, Owner)| (path, owner.fields(model));
    image
        .map(fields)
        .chain(animation)
        .chain(owners.map(fields))
        .chain(lighting)
}

/// Returns the path and the owner of every entry of a map.
fn entries<T>(
    field: &str,
    map: Option<&Map<T>>,
    owner: fn(usize) -> Owner,
) -> impl Iterator<Item = (String, Owner)> {
    let names = map.into_iter().flat_map(|map| &map.0).enumerate();
    names.map(move |(index, (name, _))| (format!("{field}[{name:?}]"), owner(index)))
}
