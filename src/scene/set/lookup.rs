//! Lookup of a word in the place of a setting's path: the field with this or a similar name.

use std::{collections::BTreeSet, ops::ControlFlow};

use crate::{
    diagnostic::path::Path,
    scene::{
        format::{
            field::Field, image::ImageModel, lighting::DirectModel, scene::Model, thing::Thing,
        },
        near::near,
        path,
    },
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

/// What is told the path and the fields of a thing; it may end the visit.
type See<'a> = &'a mut dyn FnMut(&Path, &'static [Field]) -> ControlFlow<()>;

/// Looks up a word in a scene.
pub(crate) fn look_up(model: &Model, word: &str) -> FieldLookup {
    if !path::parts(word).is_ok_and(|parts| parts.len() == 1) {
        return FieldLookup::Unknown;
    }
    let of_scene: Vec<_> = Model::FIELDS.iter().map(|field| field.name).collect();
    if of_scene.contains(&word) {
        return FieldLookup::Found;
    }
    if let Some(path) = path_of(model, word) {
        return FieldLookup::Inside(path);
    }
    if let Some(field) = near(word, &of_scene) {
        let meant = of_scene.into_iter().find(|name| *name == field);
        return meant.map_or(FieldLookup::Unknown, FieldLookup::Misspelt);
    }
    let mut names = BTreeSet::new();
    let _ = each(model, &mut |_, fields| {
        names.extend(fields.iter().map(|field| field.name));
        ControlFlow::Continue(())
    });
    let names: Vec<_> = names.into_iter().collect();
    let inside = near(word, &names).and_then(|field| path_of(model, field));
    inside.map_or(FieldLookup::Unknown, FieldLookup::Inside)
}

/// Returns the path of the first field with a name, below the fields of the scene.
fn path_of(model: &Model, word: &str) -> Option<String> {
    let mut found = None;
    let mut see = |path: &Path, fields: &'static [Field]| {
        if !fields.iter().any(|field| field.name == word) {
            return ControlFlow::Continue(());
        }
        found = Some(path.field(word.to_owned()).to_string());
        ControlFlow::Break(())
    };
    let _ = each(model, &mut see);
    found
}

/// Calls `see` with the path and the fields of everything in a scene. The image and the lighting are
/// there without being given.
fn each(model: &Model, see: See) -> ControlFlow<()> {
    if model.image.is_none() {
        see(&Path::ROOT.field("image"), ImageModel::FIELDS)?;
    }
    visit(model, &Path::ROOT, see)?;
    match model.lighting {
        Some(_) => ControlFlow::Continue(()),
        None => see(&Path::ROOT.field("lighting"), DirectModel::FIELDS),
    }
}

/// Calls `see` with the path and the fields of everything inside of a thing.
fn visit(thing: &dyn Thing, path: &Path, see: See) -> ControlFlow<()> {
    thing.things(&mut |step, inside| {
        let path = path.then(step);
        see(&path, inside.fields())?;
        visit(inside, &path, see)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{scene::tests::oracle, text::syntax::Syntax};

    #[test]
    fn a_word_is_found_in_whatever_is_inside() {
        let model = oracle::model(
            r##"(camera: Fit(projection: Perspective(fov: 30)), materials: {"gold": Phong(diffuse: "#fc0")}, geometries: [
                Spheres(file: "a.csv", color_by: (column: "v")),
                Group(geometries: [], transform: (translate: (0, 1, 0), rotate: (axis: (0, 1, 0), angle: 5)))])"##,
            Syntax::Ron,
        );
        let model = model.unwrap();
        for (word, path) in [
            ("fov", "camera.projection.fov"),
            ("diffuse", "materials[\"gold\"].diffuse"),
            ("range", "geometries[0].color_by.range"),
            ("translate", "geometries[1].transform.translate"),
            ("axis", "geometries[1].transform.rotate.axis"),
            ("width", "image.width"),
            ("max_depth", "lighting.max_depth"),
            ("exponnent", "materials[\"gold\"].exponent"),
        ] {
            let found = look_up(&model, word);
            assert_eq!(found, FieldLookup::Inside(path.to_owned()), "{word}");
        }
        assert_eq!(look_up(&model, "depth"), FieldLookup::Unknown);
    }
}
