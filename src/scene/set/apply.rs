//! Applies settings to a model, and reports faults in values at their place in the setting.

use std::{mem, ops::Range, slice};

use super::{Setting, Value, fill::fill};
use crate::{
    diagnostic::{
        Code, Diagnostic,
        path::{Path, Step},
    },
    scene::{
        format::scene::Model,
        locate::Locator,
        problem::{Focus, Problem},
        recover::text::Repairs,
        unknown::index_of_name,
    },
    text::syntax::{self, Syntax},
};

/// Settings and the result of applying them.
pub(crate) struct Applied<'s> {
    settings: Vec<One<'s>>,
}

struct One<'s> {
    setting: &'s Setting,
    /// The syntax of its value.
    syntax: Syntax,
    /// The path, with the index of a geometry or a light in the place of its name.
    steps: Vec<Step>,
    is_applied: bool,
    /// True if it removes a value.
    removes: bool,
    /// The place of its text, if that has no quotes.
    bare: Option<Range<usize>>,
    faults: Vec<Diagnostic>,
}

impl<'s> Applied<'s> {
    /// Applies settings to a model, in order.
    pub(crate) fn to(model: &mut Model, settings: &'s [Setting], syntax: Syntax) -> Self {
        let settings = settings.iter().map(|setting| {
            let mut steps = setting.steps.clone();
            let (mut removes, mut bare) = (false, None);
            let syntax = setting.syntax.unwrap_or(syntax);
            let done = index_of_name(model, &mut steps)
                .map_err(|fault| vec![fault])
                .and_then(|()| {
                    let done = Value::of(setting, syntax).and_then(|value| {
                        removes = value.removes;
                        fill(model, &steps, &value, syntax)
                    });
                    let Some(text) = Value::bare(setting).filter(|_| done.is_err()) else {
                        return done;
                    };
                    // The fault of a word that is not a value is its type.
                    let is_word = !setting.value().contains(['(', '[', '{', '"']);
                    let is_syntax = |fault: &Diagnostic| fault.code == Code::Syntax;
                    let is_text = is_word
                        && done
                            .as_ref()
                            .is_err_and(|faults| faults.iter().all(is_syntax));
                    // Where a text is expected, a word is one.
                    let as_text = fill(model, &steps, &text, syntax);
                    match &as_text {
                        Err(faults) if !is_text && faults.iter().any(is_no_text) => done,
                        _ => {
                            bare = Some(text.range);
                            as_text
                        }
                    }
                });
            One {
                setting,
                syntax,
                steps: steps.into_iter().map(|part| part.step).collect(),
                is_applied: done.is_ok(),
                removes,
                bare,
                faults: done.err().unwrap_or_default(),
            }
        });
        Self {
            settings: settings.collect(),
        }
    }

    /// Returns the diagnostics of each setting, and the problems located elsewhere.
    pub(crate) fn placed(mut self, problems: Vec<Problem>) -> (Vec<Vec<Diagnostic>>, Vec<Problem>) {
        let mut others = Vec::new();
        for mut problem in problems {
            // The last setting determines the value in the model.
            let setting_of = |path: &Path, focus: Focus| {
                let mut settings = self.settings.iter();
                settings.rposition(|one| one.is_applied && one.is_about(path, focus))
            };
            let mut setting = setting_of(&problem.diagnostic.path, problem.focus).or_else(|| {
                let mut settings = self.settings.iter();
                settings.rposition(|one| one.leaves_missing(&problem))
            });
            if setting.is_none() {
                // Of two values that clash, the one from a setting is at fault.
                let mut labels = problem.labels.iter_mut();
                let label = labels.find_map(|label| Some((setting_of(&label.0, label.1)?, label)));
                if let Some((index, (path, focus, message))) = label {
                    mem::swap(&mut problem.diagnostic.path, path);
                    mem::swap(&mut problem.focus, focus);
                    "the other of them".clone_into(message);
                    setting = Some(index);
                }
            }
            match setting.and_then(|index| self.settings.get_mut(index)) {
                Some(one) => one.faults.extend(one.place(problem)),
                None => others.push(problem),
            }
        }
        let faults = self.settings.into_iter().map(|one| one.faults);
        (faults.collect(), others)
    }
}

/// Returns the fault of a setting whose path leads nowhere in a model.
pub(crate) fn path_fault(model: &Model, setting: &Setting, syntax: Syntax) -> Option<Diagnostic> {
    let mut model = model.clone();
    let applied = Applied::to(&mut model, slice::from_ref(setting), syntax);
    let faults = applied.settings.into_iter().flat_map(|one| one.faults);
    faults
        .into_iter()
        .find(|fault| fault.code == Code::UnknownPath)
}

/// Returns true if no text is expected in the place of a value, or the place does not exist.
fn is_no_text(fault: &Diagnostic) -> bool {
    matches!(fault.code, Code::WrongType | Code::UnknownPath)
}

impl One<'_> {
    /// Returns the path from the set value to a value inside of it.
    fn rest_of(&self, path: &Path) -> Option<Path> {
        let (begin, rest) = path.steps().split_at_checked(self.steps.len())?;
        lead_alike(begin, &self.steps).then(|| rest.into())
    }

    /// Returns true if it sets a number of a vector that is a field of a struct.
    fn is_inside(&self, path: &Path, focus: Focus) -> bool {
        let is_index = |step: &Step| step.name().is_none();
        match (
            self.steps.split_at_checked(path.steps().len()),
            path.steps(),
        ) {
            // Not an element of a list of the scene.
            (Some((begin, rest)), [_, _, ..]) if focus == Focus::Value => {
                lead_alike(begin, path.steps()) && rest.iter().all(is_index)
            }
            _ => false,
        }
    }

    /// Returns true if it sets the value at a path, one around it, or a number of it.
    fn is_about(&self, path: &Path, focus: Focus) -> bool {
        self.rest_of(path).is_some() || self.is_inside(path, focus)
    }

    /// Returns true if the problem is a missing value that the setting removed.
    fn leaves_missing(&self, problem: &Problem) -> bool {
        let path = problem.diagnostic.path.steps();
        let begin = self.steps.get(..path.len());
        self.is_applied
            && self.removes
            && matches!(
                problem.code(),
                Code::MissingField | Code::GazeOrLookAt | Code::OneOf
            )
            && begin.is_some_and(|begin| lead_alike(begin, path))
    }

    /// Converts a problem of the set value to a diagnostic at its place.
    fn place(&self, problem: Problem) -> Option<Diagnostic> {
        let tree = syntax::parse(self.setting.value(), self.syntax);
        let repairs = Repairs::default();
        let locator = Locator::new(self.setting.value(), &tree, &repairs);
        let locate = |path: &Path, focus: Focus| -> Option<Range<usize>> {
            let rest = match self.rest_of(path) {
                None if self.is_inside(path, focus) => Path::ROOT,
                rest => rest?,
            };
            let is_whole = rest.steps().is_empty();
            if is_whole && matches!(focus, Focus::Key | Focus::Bracket) {
                return Some(0..self.setting.path().len());
            }
            if let Some(text) = &self.bare {
                return Some(text.clone());
            }
            let range = locator.range(&rest, focus)?;
            let start = self.setting.value;
            Some(range.start + start..range.end + start)
        };
        let range = match locate(&problem.diagnostic.path, problem.focus) {
            None if self.leaves_missing(&problem) => 0..self.setting.path().len(),
            range => range?,
        };
        // Places in another text cannot be shown in this one.
        let others = problem.labels.iter();
        let others = others.filter(|(path, focus, _)| locate(path, *focus).is_none());
        let others: Vec<_> = others.map(|(path, ..)| format!("`{path}`")).collect();
        let mut placed = problem.placed(range, self.setting.text(), locate);
        let others = match &*others {
            [] => return Some(placed),
            [other] => format!("the other is {other}"),
            others => format!("the others are {}", others.join(", ")),
        };
        placed.message = format!("{}; {others}", placed.message);
        Some(placed)
    }
}

/// Returns true if two paths of equal length lead to the same value.
fn lead_alike(one: &[Step], other: &[Step]) -> bool {
    one.iter()
        .zip(other)
        .all(|(one, other)| one.leads_as(other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        scene::{
            convert,
            format::{
                camera::CameraModel,
                fit::{FitModel, PerspectiveProjectionModel, ProjectionModel},
            },
            recover::text::name_of,
            tests::oracle,
        },
        text::syntax::{NodeId, NodeKind, Tree},
    };

    const RON: &str = r##"(
        version: 1,
        image: (width: 64, samples: 4, exposure: -1.5, tone_mapping: Neutral),
        camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
        cameras: {
            "a.b=[c]": Perspective(eye: (0, 0, 0), look_at: (0, 0, -1), up: (1, 2, 3), fov: 9),
            "Top": Orthographic(eye: (0, 9, 0), gaze: (0, -1, 0), up: (0, 0, -1), scale: 4),
        },
        background: (0, 0.5, 1),
        lights: [
            Ambient(intensity: 0.3),
            Spot(position: (0, 3, 2), look_at: (0, 0, 0), angle: 30, falloff: Constant),
            Point(position: (0, 3, 2), color: "#ffddaa", shadows: false, name: "key"),
        ],
        materials: {
            "Gold": Phong(diffuse: "#b8860b", exponent: 60, reflection: (0, 0.5, 0)),
            "a.b": Mirror(color: "#fff"),
        },
        lighting: Direct(max_depth: 3),
        outlines: (width: 2, color: "#123", creases: 60),
        geometries: [
            Sphere(center: (0, 0, -3), radius: 0.25, material: Named("Gold")),
            Sphere(center: (0, 0, -4), radius: 0.25, material: Glass(ior: 1.25)),
            Plane(point: (0, -1, 0), normal: (0, 1, 0), color: "#00ff00"),
            Sphere(center: (0, 0, -3), radius: 0.5, color: (1, 0, 0), name: "ball"),
            Spheres(file: "atoms.csv", radius: 1e-3),
            Part(file: "tree.ron", lights: true, name: "tree"),
        ],
        allow: ["eye-inside"],
        animation: (fps: 24, frames: 48, tracks: {
            "camera.eye": [(0, (0, 0, 0)), (1.5, (0, 1, 0), Smooth)],
            "background": [(0, (0, 0.5, 1))],
            "geometries[\"ball\"].radius": [(0, 0.5), (2, 1, Step)],
        }),
    )"##;

    /// The same scene in both syntaxes.
    fn scenes() -> [(String, Syntax); 2] {
        let model = model(RON, Syntax::Ron);
        let json = convert::convert(model, Syntax::Json).text;
        [(RON.to_owned(), Syntax::Ron), (json, Syntax::Json)]
    }

    fn model(text: &str, syntax: Syntax) -> Model {
        oracle::model(text, syntax).unwrap()
    }

    /// Collects every path of a scene with its value as written.
    fn paths(text: &str, tree: &Tree, node: NodeId, path: &str, all: &mut Vec<(String, String)>) {
        let source = |id| text[tree.node(id).range()].to_owned();
        match tree.node(node).kind() {
            // `Named("Gold")`, which has no elements.
            NodeKind::Tuple if tree.node(node).name().is_some() => {}
            NodeKind::List | NodeKind::Tuple => {
                for (index, child) in tree.children(node).enumerate() {
                    let path = format!("{path}[{index}]");
                    all.push((path.clone(), source(child)));
                    paths(text, tree, child, &path, all);
                }
            }
            _ => {
                for (key, value) in tree.fields(node) {
                    let name = name_of(text, tree, key);
                    let is_variant = name.starts_with(|first: char| first.is_ascii_uppercase());
                    let path = match path {
                        "" => name.into_owned(),
                        "cameras" | "materials" | "animation.tracks" => format!("{path}[{name:?}]"),
                        _ if is_variant => {
                            paths(text, tree, value, path, all);
                            continue;
                        }
                        _ => format!("{path}.{name}"),
                    };
                    all.push((path.clone(), source(value)));
                    paths(text, tree, value, &path, all);
                }
            }
        }
    }

    #[test]
    fn every_value_of_a_scene_can_be_set() {
        for (text, syntax) in scenes() {
            let text = &*text;
            let tree = syntax::parse(text, syntax);
            let mut all = Vec::new();
            paths(text, &tree, tree.root().unwrap(), "", &mut all);
            assert!(all.len() > 30, "{all:?}");
            for (path, value) in all {
                let before = model(text, syntax);
                let mut after = before.clone();
                // Setting the same value changes nothing.
                let same: Setting = format!("{path} = {value}").parse().unwrap();
                let applied = Applied::to(&mut after, std::slice::from_ref(&same), syntax);
                assert_eq!(applied.settings[0].faults, [], "{path}");
                assert_eq!(after, before, "{path}");
                // A value that fits nowhere is reported at the value, and changes nothing either.
                let wrong: Setting = format!("{path} = [[{value}]]").parse().unwrap();
                let applied = Applied::to(&mut after, std::slice::from_ref(&wrong), syntax);
                let faults = &applied.settings[0].faults;
                assert!(!faults.is_empty(), "{path}");
                for fault in faults {
                    assert!(
                        fault.range.start > path.len() && fault.code != Code::UnknownPath,
                        "{path}: {fault:?}"
                    );
                    assert!(wrong.text().get(fault.range.clone()).is_some());
                    assert!(
                        fault.path.to_string().starts_with(&path),
                        "{} in {path}",
                        fault.path
                    );
                }
                assert_eq!(after, before, "{path}");
                // An unknown name leads nowhere.
                let nowhere: Setting = format!("{path}.x = {value}").parse().unwrap();
                let applied = Applied::to(&mut after, std::slice::from_ref(&nowhere), syntax);
                let codes: Vec<_> = applied.settings[0].faults.iter().map(|f| f.code).collect();
                assert_eq!(codes, [Code::UnknownPath], "{path}");
                assert_eq!(after, before, "{path}");
            }
        }
    }

    #[test]
    fn fields_that_are_not_given_are_added() {
        for (text, syntax) in scenes() {
            let before = model(&text, syntax);
            let set = |setting: &str| {
                let mut model = before.clone();
                model.lighting = None;
                model.outlines = None;
                let setting: Setting = setting.parse().unwrap();
                let applied = Applied::to(&mut model, std::slice::from_ref(&setting), syntax);
                assert_eq!(applied.settings[0].faults, [], "{}", setting.text());
                model
            };
            assert_eq!(set("lighting.max_depth=3").lighting, before.lighting);
            assert_eq!(set("outlines.width=2").outlines.unwrap().width, Some(2.0));
            for (light, setting) in [
                "lights[0].color=#fff",
                "lights[1].blend=1",
                "lights.key.intensity=9",
            ]
            .into_iter()
            .enumerate()
            {
                let lights = [set(setting), before.clone()].map(|model| model.lights.unwrap());
                let changed = |index: &usize| lights[0][*index] != lights[1][*index];
                assert_eq!((0..3).filter(changed).collect::<Vec<_>>(), [light]);
            }
        }
    }

    #[test]
    fn the_variant_that_is_meant_is_added() {
        for syntax in [Syntax::Ron, Syntax::Json] {
            let mut model = Model {
                camera: Some(CameraModel::Fit(FitModel::default())),
                ..Model::default()
            };
            let setting: Setting = "camera.projection.fov=60".parse().unwrap();
            let applied = Applied::to(&mut model, std::slice::from_ref(&setting), syntax);
            assert_eq!(applied.settings[0].faults, []);
            let camera = model.camera.unwrap();
            assert_eq!(
                camera.projection(),
                Some(&ProjectionModel::Perspective(PerspectiveProjectionModel {
                    fov: 60.0,
                    aperture: None,
                }))
            );
        }
    }

    #[test]
    fn geometries_stay_where_they_are() {
        let mut model = model(RON, Syntax::Ron);
        let before = model.geometries.as_ptr();
        let settings = [
            "camera.eye[0]=3",
            "geometries[0].color=\"#123456\"",
            "image=null",
        ];
        let settings = settings.map(|setting| setting.parse().unwrap());
        let applied = Applied::to(&mut model, &settings, Syntax::Ron);
        assert!(applied.settings.iter().all(|one| one.is_applied));
        assert_eq!((model.geometries.as_ptr(), model.image), (before, None));
    }
}
