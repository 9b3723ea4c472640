//! Resolution of a track's path to the value that it changes.

use crate::{
    diagnostic::{Code, Diagnostic, path::Step},
    scene::{
        format::{
            camera::CameraModel,
            field::{Field, Fields, Kind, Slot},
            geometry::GeometryModel,
            scene::Model,
        },
        path::{self, Part},
        unknown,
    },
    text::nearest::{list, nearest, quote},
};

/// The owner of fields that change over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Owner {
    /// The scene itself.
    Scene,
    /// The camera without a name.
    Camera,
    /// One of `cameras`, by its index.
    NamedCamera(usize),
    /// A geometry, by its index.
    Geometry(usize),
}

/// The target of a track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub(crate) owner: Owner,
    pub(crate) field: &'static str,
    pub(crate) kind: Kind,
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
        let mut steps = path::parts(path).map_err(|expected| {
            unknown_path(format!(
                "{} is not a path, expected {expected}",
                quote(path)
            ))
        })?;
        unknown::index_of_geometry(model, &mut steps)?;
        let (owner, rest) = owner(model, &steps)?;
        let (field, component) = match rest {
            [field] => (field, None),
            [field, component] => (field, Some(component)),
            _ => return Err(does_not_change(path)),
        };
        let name = field.name().unwrap_or_default();
        let fields = owner.fields(model);
        let Some((field, kind)) = fields.iter().copied().find(|(field, _)| *field == name) else {
            return Err(unknown_field(name, fields));
        };
        if kind == Kind::Fixed {
            return Err(does_not_change(path));
        }
        given(owner.camera(model), field)?;
        let component = match component.map(|part| &part.step) {
            None => None,
            Some(Step::Index(index)) if *index < 3 && !kind.is_number() => Some(*index),
            Some(Step::Index(index)) if !kind.is_number() => {
                let message = format!("there is no element {index}, there are 3");
                return Err(unknown_path(message));
            }
            Some(_) => return Err(does_not_change(path)),
        };
        Ok(Self {
            owner,
            field,
            kind,
            component,
        })
    }

    /// Returns true if the world changes, and not only a camera.
    pub(crate) fn is_of_world(&self) -> bool {
        matches!(self.owner, Owner::Scene | Owner::Geometry(_))
    }

    /// Returns true if an orbit changes it as well.
    pub(crate) fn is_turned_by_orbit(&self) -> bool {
        matches!(self.owner, Owner::Camera | Owner::NamedCamera(_))
            && matches!(self.kind, Kind::Point | Kind::Direction)
    }

    /// Returns the slot of the value; a missing optional field gets its default.
    pub(crate) fn slot<'m>(&self, model: &'m mut Model) -> Option<Slot<'m>> {
        let whole = match self.owner {
            Owner::Scene => model.slot(self.field)?,
            Owner::Camera => model.camera.as_mut()?.slot(self.field)?,
            Owner::NamedCamera(index) => {
                let (_, camera) = model.cameras.as_mut()?.0.get_mut(index)?;
                camera.slot(self.field)?
            }
            Owner::Geometry(index) => model.geometries.get_mut(index)?.slot(self.field)?,
        };
        let Some(index) = self.component else {
            return Some(whole);
        };
        let triple = match whole {
            Slot::Vector(triple) => triple,
            Slot::Color(color) => color.channels()?,
            Slot::Number(_) => return None,
        };
        triple.get_mut(index).map(Slot::Number)
    }
}

impl Owner {
    /// Its fields.
    pub(crate) fn fields(self, model: &Model) -> &'static [Field] {
        match self {
            Self::Scene => Model::FIELDS,
            Self::Camera | Self::NamedCamera(_) => {
                self.camera(model).map_or(&[], CameraModel::fields)
            }
            Self::Geometry(index) => {
                let geometry = model.geometries.get(index);
                geometry.map_or(&[], GeometryModel::fields)
            }
        }
    }

    /// The camera, if it is one.
    pub(crate) fn camera(self, model: &Model) -> Option<&CameraModel> {
        match self {
            Self::Camera => model.camera.as_ref(),
            Self::NamedCamera(index) => Some(&model.cameras.as_ref()?.0.get(index)?.1),
            Self::Scene | Self::Geometry(_) => None,
        }
    }
}

/// Returns the owner of the field at a path, and the remaining steps.
fn owner<'s>(model: &Model, steps: &'s [Part]) -> Result<(Owner, &'s [Part]), Diagnostic> {
    let names: Vec<_> = steps.iter().map(Part::name).collect();
    match (&*names, steps) {
        ([Some("camera"), _, ..], [_, rest @ ..]) => match model.camera {
            Some(_) => Ok((Owner::Camera, rest)),
            None => Err(unknown_path("the scene has no `camera`".to_owned())),
        },
        ([Some("cameras"), Some(name), ..], [_, _, rest @ ..]) => {
            let cameras = model.cameras.iter().flat_map(|cameras| &cameras.0);
            let known: Vec<_> = cameras.map(|(name, _)| &**name).collect();
            match known.iter().position(|known| known == name) {
                Some(index) => Ok((Owner::NamedCamera(index), rest)),
                None => Err(Diagnostic {
                    code: Code::UnknownPath,
                    ..unknown::name("camera", name, &known)
                }),
            }
        }
        (
            [Some("geometries"), None, ..],
            [
                _,
                Part {
                    step: Step::Index(index),
                    ..
                },
                rest @ ..,
            ],
        ) => Ok((Owner::Geometry(*index), rest)),
        _ => Ok((Owner::Scene, steps)),
    }
}

/// Rejects `gaze` or `look_at` if the camera does not have it.
fn given(camera: Option<&CameraModel>, field: &str) -> Result<(), Diagnostic> {
    let Some((gaze, look_at)) = camera.map(CameraModel::aims) else {
        return Ok(());
    };
    let other = match field {
        "gaze" if !gaze => "look_at",
        "look_at" if !look_at => "gaze",
        _ => return Ok(()),
    };
    let fault = unknown_path(format!("`{field}` is not given: nothing in it can change"));
    Err(fault.with_help(format!(
        "change `{other}`, or give the camera `{field}` instead of it"
    )))
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
    let changing = fields.iter().filter(|(_, kind)| *kind != Kind::Fixed);
    let known: Vec<_> = changing.map(|(name, _)| *name).collect();
    let message = format!(
        "unknown field {}, expected one of {}",
        quote(name),
        list(&known)
    );
    let fault = unknown_path(message);
    match nearest(name, &known) {
        Some(meant) => fault.with_help(format!("did you mean `{meant}`?")),
        None => fault,
    }
}
