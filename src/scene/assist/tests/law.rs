//! The law of paths: whatever leads from a path to a value, or from a value to a path, knows the same
//! paths. Those of the format's description are compared with all of them, in every scene here.

use std::{
    collections::BTreeSet,
    fs,
    ops::{ControlFlow, Range},
    path::Path as File,
};

use serde_json::{Value, json};

use crate::{
    diagnostic::path::{Path, Step},
    scene::{
        animation::target::Target,
        assist::{paths::paths, spot::Finder},
        convert,
        format::{field::FieldKind, geometry::GeometryModel, scene::Model, thing::Thing},
        locate::{path_at, range_of},
        schema::schema,
        set::{Applied, Setting},
        tests::oracle,
    },
    text::syntax::{Syntax, Tree, parse},
};

/// The valid scenes of the tests, read.
fn scenes() -> Vec<(String, Model)> {
    let folders = ["tests/valid", "scenes", "tests/golden"];
    let mut found = Vec::new();
    for folder in folders {
        let folder = File::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        for entry in fs::read_dir(folder).unwrap() {
            let file = entry.unwrap().path();
            let Some(syntax) = Syntax::of_path(&file) else {
                continue;
            };
            let text = fs::read_to_string(&file).unwrap();
            if let (true, Ok(mut model)) = (text.len() < 20_000, oracle::model(&text, syntax)) {
                // Only JSON has this field.
                model.schema = None;
                found.push((file.display().to_string(), model));
            }
        }
    }
    assert!(found.len() > 100);
    found
}

/// A field of a thing in a scene.
struct Found<'m> {
    path: Path,
    kind: FieldKind,
    can_change: bool,
    is_given: bool,
    model: &'m Model,
}

/// Returns true for a path to a transform that is a matrix: nothing in it changes.
fn is_matrix(model: &Model, path: &Path) -> bool {
    let Some((at, count)) = model.geometry_on(path.steps()) else {
        return false;
    };
    let index = match &path.steps()[count..] {
        [name] if name.name() == Some("transform") => None,
        [_, Step::Index(index)] => Some(*index),
        _ => return false,
    };
    let transform = model
        .geometry(at)
        .and_then(|geometry| match (geometry, index) {
            (GeometryModel::Instances(instances), Some(index)) => {
                instances.transforms.as_ref()?.get(index)
            }
            (geometry, _) => geometry.transform(),
        });
    transform.is_some_and(|transform| transform.matrix.is_some())
}

/// Calls `see` with every field of everything in a scene.
fn each(model: &Model, see: &mut dyn FnMut(Found)) {
    fn visit(model: &Model, path: &Path, thing: &dyn Thing, see: &mut dyn FnMut(Found)) {
        let is_matrix = is_matrix(model, path);
        let is_still = path.to_string().starts_with("animation");
        let mut inside = BTreeSet::new();
        let _ = thing.things(&mut |step, thing| {
            inside.insert(step.name().unwrap_or_default().to_owned());
            visit(model, &path.then(step), thing, see);
            ControlFlow::Continue(())
        });
        for field in thing.fields() {
            see(Found {
                path: path.field(field.name),
                kind: field.kind,
                can_change: field.kind.changes()
                    && thing.has(field.name)
                    && !is_matrix
                    && !is_still,
                is_given: thing.has(field.name) && !field.has_start || inside.contains(field.name),
                model,
            });
        }
    }
    visit(model, &Path::ROOT, model, see);
}

#[test]
fn a_track_is_accepted_where_the_field_can_change() {
    for (file, model) in scenes() {
        each(&model, &mut |found| {
            let target = Target::of(found.model, &found.path.to_string());
            assert_eq!(target.is_ok(), found.can_change, "{file}: {}", found.path);
        });
    }
}

#[test]
fn completion_offers_the_paths_that_a_track_accepts() {
    for (file, model) in scenes() {
        let mut expected = BTreeSet::new();
        each(&model, &mut |found| {
            // What is not there at all is not offered.
            if found.can_change {
                expected.insert(format!(
                    "{:?}",
                    Target::of(found.model, &found.path.to_string()).unwrap()
                ));
            }
        });
        for syntax in [Syntax::Ron, Syntax::Json] {
            let text = convert::write(&model, syntax);
            let tree = parse(&text, syntax);
            let finder = Finder {
                text: &text,
                tree: &tree,
            };
            let offered = paths(&finder, true, usize::MAX);
            let offered = offered.iter().map(|item| {
                let target = Target::of(&model, &item.label);
                format!(
                    "{:?}",
                    target.unwrap_or_else(|fault| panic!("{file}: {fault:?}"))
                )
            });
            let offered: BTreeSet<_> = offered.collect();
            assert_eq!(offered, expected, "{file}");
        }
    }
}

/// Calls `see` with every field that is given in a scene, the text of the scene in either syntax, and
/// the range of the field's value.
fn each_given(mut see: impl FnMut(&str, &Tree, Found, Range<usize>)) {
    for (file, model) in scenes() {
        for syntax in [Syntax::Ron, Syntax::Json] {
            let text = convert::write(&model, syntax);
            let tree = parse(&text, syntax);
            each(&model, &mut |found| {
                if found.is_given {
                    let range = range_of(&text, &tree, found.path.steps());
                    let range = range.unwrap_or_else(|| panic!("{file}: {}", found.path));
                    see(&text, &tree, found, range);
                }
            });
        }
    }
}

#[test]
fn a_value_is_found_by_its_path_and_its_path_by_the_value() {
    each_given(|text, tree, found, range| {
        let (path, back) = (found.path, path_at(text, tree, range.start));
        assert!(
            back.steps().starts_with(path.steps()),
            "{back} for {path} in {text}"
        );
    });
}

#[test]
fn a_value_that_is_set_to_itself_changes_nothing() {
    each_given(|text, tree, found, range| {
        let setting = format!("{}={}", found.path, &text[range]);
        let setting = [setting.parse::<Setting>().unwrap()];
        let mut changed = found.model.clone();
        let applied = Applied::to(&mut changed, &setting, tree.syntax());
        let (faults, _) = applied.placed(Vec::new());
        let setting = setting[0].text();
        assert!(faults.iter().all(Vec::is_empty), "{setting}: {faults:?}");
        assert_eq!(changed, *found.model, "{setting}");
    });
}

#[test]
fn the_schema_accepts_the_paths_of_fields_that_can_change() {
    let schema: Value = serde_json::from_str(&schema()).unwrap();
    let tracks = &schema["$defs"]["Animation"]["properties"]["tracks"];
    let alone = json!({"$defs": schema["$defs"], "allOf": [tracks]});
    let validator = jsonschema::validator_for(&alone).unwrap();
    let accepts = |path: &str, value: Value| validator.is_valid(&json!({path: [[0, value]]}));
    let values = [json!(1), json!([1, 2, 3]), json!("#fff"), json!([1, 2])];
    let [number, vector, color, range] = values.clone();
    for (file, model) in scenes() {
        each(&model, &mut |found| {
            let path = found.path.to_string();
            let value = match found.kind {
                FieldKind::Color => color.clone(),
                FieldKind::Interval => range.clone(),
                kind if kind.is_vector() => vector.clone(),
                _ => number.clone(),
            };
            if found.can_change {
                assert!(accepts(&path, value), "{file}: {path}");
            }
            if !found.kind.changes() {
                let mut values = values.iter();
                assert!(
                    values.all(|value| !accepts(&path, value.clone())),
                    "{file}: {path}"
                );
            }
        });
    }
    for (path, value) in [
        ("camera.radius", &number),
        ("geometries[0].fov", &number),
        ("image.radius", &number),
        ("camera.fov[0]", &number),
        ("camera.eye", &number),
        ("animation.fps", &number),
        ("color", &color),
    ] {
        assert!(!accepts(path, value.clone()), "{path}");
    }
    for (path, value) in [
        ("camera.projection.fov", &number),
        ("geometries.ball.transform.translate", &vector),
        ("cameras[\"a b\"].eye [2]", &number),
        (" background [ 0 ]", &number),
    ] {
        assert!(accepts(path, value.clone()), "{path}");
    }
}
