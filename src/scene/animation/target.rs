//! Resolution of a track's path to the value that it changes.

use crate::{
    diagnostic::{
        Code, Diagnostic,
        path::{Path, Step},
    },
    scene::{
        format::{
            animation::CHANGING,
            field::{Field, FieldKind, Slot},
            geometry::{GeometryModel, ordinal::Ordinal},
            image::ImageModel,
            material::MaterialModel,
            numbers::ScaleModel,
            scene::Model,
            thing::{Follow, Record, Thing, Type},
            transform::TransformModel,
        },
        path, unknown,
    },
    text::nearest::{list, quote},
};

/// What a track changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aspect {
    /// The scene itself.
    Scene,
    /// The picture, or the outlines in it.
    Picture,
    /// A camera or its projection.
    Camera,
    /// A light.
    Light,
    /// A material, of a geometry or by its name.
    Material,
    /// The shape or the color of a geometry.
    Geometry,
    /// The colors by value of a geometry.
    ColorBy,
    /// The transform of a geometry, or one of several.
    Transform,
}

/// The target of a track.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    /// The path of the thing that has the field.
    pub(crate) owner: Path,
    pub(crate) aspect: Aspect,
    /// The geometry that the thing is or is in.
    pub(crate) geometry: Option<Ordinal>,
    pub(crate) field: &'static str,
    pub(crate) kind: FieldKind,
    /// The index of one number of a vector or a color; `None` for all of it.
    pub(crate) component: Option<usize>,
}

impl Target {
    /// Resolves a path in a scene.
    ///
    /// # Errors
    ///
    /// The reason why the path leads to nothing that can change.
    pub(crate) fn of(model: &Model, path: &str) -> Result<Self, Diagnostic> {
        let mut parts = path::parts(path).map_err(|expected| {
            unknown_path(format!(
                "{} is not a path, expected {expected}",
                quote(path)
            ))
        })?;
        unknown::index_of_name(model, &mut parts)?;
        let steps: Vec<_> = parts.into_iter().map(|part| part.step).collect();
        let owner = Owner::of(model, &steps)?;
        let (field, component) = match owner.rest(&steps) {
            [field] => (field, None),
            [field, component] => (field, Some(component)),
            _ => return Err(does_not_change(path)),
        };
        let name = field.name().unwrap_or_default();
        let fields = owner.thing.fields();
        let Some(Field {
            name: field, kind, ..
        }) = fields.iter().copied().find(|field| field.name == name)
        else {
            return Err(unknown_field(name, fields));
        };
        if !kind.changes() {
            return Err(does_not_change(path));
        }
        let transform = owner.transform();
        if transform.is_some_and(|transform| transform.matrix.is_some()) {
            return Err(in_matrix());
        }
        if !owner.thing.has(field) {
            return Err(owner.not_given(field));
        }
        let count = if kind == FieldKind::Interval { 2 } else { 3 };
        let component = match component {
            None => None,
            Some(Step::Index(index)) if *index < count && !kind.is_number() => Some(*index),
            Some(Step::Index(index)) if !kind.is_number() => {
                let message = format!("there is no element {index}, there are {count}");
                return Err(unknown_path(message));
            }
            Some(_) => return Err(does_not_change(path)),
        };
        let has_three = transform.is_some_and(|it| matches!(it.scale, Some(ScaleModel::Axes(_))));
        if kind == FieldKind::Scale && component.is_some() && !has_three {
            let message = "`scale` is one number: no element of it can change".to_owned();
            let help = "give the transform three numbers as `scale`";
            return Err(unknown_path(message).with_help(help));
        }
        Ok(Self {
            aspect: owner.aspect(),
            geometry: model.geometry_on(owner.path.steps()).map(|(at, _)| at),
            owner: owner.path,
            field,
            kind,
            component,
        })
    }

    /// Returns true if the world changes, and not only a camera or the picture.
    pub(crate) const fn is_of_world(&self) -> bool {
        !matches!(self.aspect, Aspect::Picture | Aspect::Camera)
    }

    /// Returns the geometry that it moves or whose size it changes.
    pub(crate) fn moved_geometry(&self) -> Option<Ordinal> {
        let moves = match self.aspect {
            Aspect::Geometry => self.kind != FieldKind::Color,
            aspect => aspect == Aspect::Transform,
        };
        self.geometry.filter(|_| moves)
    }

    /// Returns true if an orbit changes it as well.
    pub(crate) fn is_turned_by_orbit(&self) -> bool {
        let turns = matches!(self.kind, FieldKind::Point | FieldKind::Direction);
        turns && self.aspect == Aspect::Camera
    }

    /// Calls `write` with the slot of the value; a missing optional field gets its default.
    pub(crate) fn change(&self, model: &mut Model, write: &mut dyn FnMut(Slot)) {
        let steps = self.owner.steps();
        let target = self;
        let change = Change {
            target,
            steps,
            write,
        };
        change.thing(model);
    }

    /// Returns the slot of the value in the thing that has it.
    fn slot<'m>(&self, owner: &'m mut dyn Thing) -> Option<Slot<'m>> {
        let whole = owner.slot(self.field)?;
        let Some(index) = self.component else {
            return Some(whole);
        };
        let numbers: &mut [f64] = match whole {
            Slot::Vector(triple) | Slot::Scale(ScaleModel::Axes(triple)) => triple,
            Slot::Interval(range) => range,
            Slot::Color(color) => color.channels()?,
            Slot::Number(_) | Slot::Scale(ScaleModel::Uniform(_)) => return None,
        };
        numbers.get_mut(index).map(Slot::Number)
    }
}

/// A change of a value on its way to the slot.
struct Change<'a> {
    target: &'a Target,
    /// The rest of the way.
    steps: &'a [Step],
    write: &'a mut dyn FnMut(Slot),
}

impl Follow for Change<'_> {
    type Out = ();

    fn thing<T: Record>(mut self, thing: &mut T) {
        // The picture has its defaults without being given.
        if !thing.is_given()
            && let Ok(created) = serde_json::from_value(serde_json::json!({}))
        {
            *thing = created;
        }
        match self.steps {
            [] => self.target.slot(thing).into_iter().for_each(self.write),
            [step, rest @ ..] => {
                self.steps = rest;
                let _ = thing.enter(step, self);
            }
        }
    }

    fn value<T>(self, _: &mut T) {}
}

/// A thing that has fields, and the way to it.
struct Owner<'m> {
    model: &'m Model,
    path: Path,
    thing: &'m dyn Thing,
}

impl<'m> Owner<'m> {
    /// Returns the innermost thing on a path.
    ///
    /// # Errors
    ///
    /// A thing that is not given, and a material that is only a name.
    fn of(model: &'m Model, steps: &[Step]) -> Result<Self, Diagnostic> {
        let mut owner = Self {
            model,
            path: Path::ROOT,
            thing: model,
        };
        let root = steps.first().and_then(Step::name);
        if CHANGING.iter().any(|(field, _)| Some(field.name) == root) {
            while owner.enter(steps)? {}
        }
        Ok(owner)
    }

    /// Returns the steps that are left of those on a path.
    fn rest<'s>(&self, steps: &'s [Step]) -> &'s [Step] {
        steps.get(self.path.steps().len()..).unwrap_or_default()
    }

    /// Goes on to the thing in the next field, or in its list or map; returns false if there is none, or
    /// if nothing follows it.
    fn enter(&mut self, steps: &[Step]) -> Result<bool, Diagnostic> {
        let [step, next, ..] = self.rest(steps) else {
            return Ok(false);
        };
        let mut fields = self.thing.fields().iter();
        let Some(field) = fields.find(|field| Some(field.name) == step.name()) else {
            return Ok(false);
        };
        let (name, of_type) = (field.name, (field.of_type)());
        if of_type.innermost().fields().next().is_none() {
            return Ok(false);
        }
        let (mut path, inside) = match self.thing.at(step) {
            Some((step, inside)) => (self.path.then(step), Some(inside)),
            None => (self.path.field(name), None),
        };
        let thing = match (of_type, inside) {
            (Type::Map(..), map) => {
                let Some(key) = next.name() else {
                    return Ok(false);
                };
                let found = map.and_then(|map| map.at(next));
                let (step, thing) = found.ok_or_else(|| {
                    let known = map.map(Thing::steps).unwrap_or_default();
                    let known: Vec<_> = known.iter().filter_map(Step::name).collect();
                    Diagnostic {
                        code: Code::UnknownPath,
                        ..unknown::name(singular(name), key, &known)
                    }
                })?;
                path = path.then(step);
                thing
            }
            (Type::List(..), Some(list)) => {
                let found = list.at(next);
                let (step, thing) = found.ok_or_else(|| no_element(name, next, list))?;
                path = path.then(step);
                thing
            }
            (_, Some(thing)) => thing,
            (_, None) if name == "image" => &ImageModel::NONE,
            (_, None) if self.path == Path::ROOT => {
                return Err(unknown_path(format!("the scene has no `{name}`")));
            }
            (_, None) => return Err(self.not_given(name)),
        };
        (self.path, self.thing) = (path, thing);
        match self.material().and_then(MaterialModel::named) {
            Some(name) => {
                let message = "this material is a name: nothing in it can change".to_owned();
                Err(unknown_path(message).with_help(format!("change `materials[{name:?}]`")))
            }
            None => Ok(true),
        }
    }

    /// Returns the geometry that it is or is in, and the steps from there.
    fn geometry(&self) -> Option<(&'m GeometryModel, &[Step])> {
        let (at, count) = self.model.geometry_on(self.path.steps())?;
        Some((self.model.geometry(at)?, self.path.steps().get(count..)?))
    }

    /// Returns the material of a geometry, if it is one.
    fn material(&self) -> Option<&'m MaterialModel> {
        let (geometry, steps) = self.geometry()?;
        let is_it = matches!(steps, [step] if step.name() == Some("material"));
        Some(geometry.surface().material.filter(|_| is_it)?)
    }

    /// Returns the transform, if it is one.
    fn transform(&self) -> Option<&'m TransformModel> {
        match self.geometry()? {
            (geometry, [step]) if step.name() == Some("transform") => geometry.transform(),
            (geometry, [_, Step::Index(index)]) => geometry.copies()?.transforms?.get(*index),
            _ => None,
        }
    }

    fn aspect(&self) -> Aspect {
        let root = self.path.steps().first().and_then(Step::name);
        let inside = self.geometry().and_then(|(_, steps)| steps.first());
        match (root, inside.and_then(Step::name)) {
            (Some("image" | "outlines"), _) => Aspect::Picture,
            (Some("camera" | "cameras"), _) => Aspect::Camera,
            (Some("lights"), _) => Aspect::Light,
            (Some("materials"), _) | (_, Some("material" | "texture")) => Aspect::Material,
            (_, Some("color_by")) => Aspect::ColorBy,
            (_, Some(_)) => Aspect::Transform,
            (Some(Model::LONG), None) => Aspect::Geometry,
            (_, None) => Aspect::Scene,
        }
    }

    /// Returns the diagnostic of a field that is not given and has no default.
    fn not_given(&self, field: &str) -> Diagnostic {
        let fault = unknown_path(format!("`{field}` is not given: nothing in it can change"));
        let what = match self.aspect() {
            Aspect::Camera => "the camera",
            Aspect::Light => "the light",
            Aspect::Geometry => "the geometry",
            Aspect::Transform => "the transform",
            Aspect::Scene | Aspect::Picture | Aspect::Material | Aspect::ColorBy => "it",
        };
        let sets = self.thing.sets();
        let other = sets
            .iter()
            .find_map(|(set, given)| set.instead_of(field, given));
        fault.with_help(match other {
            Some(other) => format!("change `{other}`, or give {what} `{field}` instead of it"),
            None => format!("give {what} `{field}`"),
        })
    }
}

/// Returns what one of several is called.
fn singular(name: &str) -> &str {
    name.strip_suffix('s').unwrap_or(name)
}

/// Returns the diagnostic of an element that a list does not have.
fn no_element(name: &str, step: &Step, list: &dyn Thing) -> Diagnostic {
    let (kind, count) = (singular(name), list.steps().len());
    unknown_path(match step {
        Step::Index(index) => format!("there is no {kind} {index}, there are {count}"),
        _ => format!("expected the index of a {kind}, such as `{name}[0]`"),
    })
}

/// Returns the diagnostic of a field in a transform that is a matrix.
fn in_matrix() -> Diagnostic {
    let message = "this transform is a matrix: nothing in it can change".to_owned();
    unknown_path(message)
        .with_help("write `translate`, `rotate` and `scale` in place of the matrix")
}

fn unknown_path(message: String) -> Diagnostic {
    Diagnostic::new(Code::UnknownPath, 0..0, message)
}

fn does_not_change(path: &str) -> Diagnostic {
    let what = quote(path);
    unknown_path(format!(
        "{what} is not a number, vector or color that can change over time"
    ))
}

fn unknown_field(name: &str, fields: &[Field]) -> Diagnostic {
    let changing = fields.iter().filter(|field| field.kind.changes());
    let known: Vec<_> = changing.map(|field| field.name).collect();
    if known.is_empty() {
        let name = quote(name);
        return unknown_path(format!(
            "unknown field {name}: no field of it can change over time"
        ));
    }
    let message = format!(
        "unknown field {}, expected one of {}",
        quote(name),
        list(&known)
    );
    unknown_path(message).meaning(name, &known)
}
