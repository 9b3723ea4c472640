//! Lookup of a word in the place of a setting's path: the field with this or a similar name.

use crate::{
    scene::{
        animation::target::Owner,
        format::{
            animation::AnimationModel,
            field::{Field, Fields},
            image::ImageModel,
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
    let of_scene = || Model::FIELDS.iter().map(|(name, _)| *name);
    if of_scene().any(|name| name == word) {
        return FieldLookup::Found;
    }
    let path_of = |word: &str| {
        let mut structs = structs(model);
        let (path, _) = structs.find(|(_, fields)| fields.iter().any(|(name, _)| *name == word))?;
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
    let mut names: Vec<&str> = fields.map(|(name, _)| *name).collect();
    names.sort_unstable();
    names.dedup();
    let inside = nearest(word, &names).and_then(path_of);
    inside.unwrap_or(FieldLookup::Unknown)
}

/// Returns the path and the fields of every struct in a scene.
fn structs(model: &Model) -> impl Iterator<Item = (String, &'static [Field])> {
    let camera = model
        .camera
        .as_ref()
        .map(|_| ("camera".to_owned(), Owner::Camera));
    let cameras = model
        .cameras
        .iter()
        .flat_map(|cameras| &cameras.0)
        .enumerate();
    let cameras = cameras.map(|(index, (name, _))| {
        let path = format!("cameras[{name:?}]");
        (path, Owner::NamedCamera(index))
    });
    let geometries = (0..model.geometries.len())
        .map(|index| (format!("geometries[{index}]"), Owner::Geometry(index)));
    let owners = camera.into_iter().chain(cameras).chain(geometries);
    let animation = model
        .animation
        .as_ref()
        .map(|_| ("animation".to_owned(), AnimationModel::FIELDS));
    [("image".to_owned(), ImageModel::FIELDS)]
        .into_iter()
        .chain(animation)
        .chain(owners.map(|(path, owner)| (path, owner.fields(model))))
}
