//! From the path of a track to the value that it changes.

use crate::{
    diagnostic::{Code, Diagnostic},
    scene::{
        animation::model::Kind,
        build,
        model::{CameraModel, ColorModel, GeometryModel, Model, Triple},
        nearest::{list, nearest, quote},
        set::{Step, To, index_of_geometry, path_steps},
        unknown,
    },
};

/// What has fields that change over time.
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

/// What a track changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub(crate) owner: Owner,
    pub(crate) field: &'static str,
    /// One number of a vector or a color, instead of all of it.
    pub(crate) component: Option<usize>,
}

/// Where a value is written.
pub(crate) enum Slot<'m> {
    Number(&'m mut f64),
    Vector(&'m mut Triple),
    Color(&'m mut ColorModel),
}

// The fields of each type, as the model has them.
pub(crate) const SCENE: &[&str] = &[
    "$schema",
    "version",
    "image",
    "camera",
    "cameras",
    "background",
    "geometries",
    "animation",
    "allow",
];
pub(super) const PERSPECTIVE: &[&str] = &["eye", "gaze", "look_at", "up", "fov"];
pub(super) const ORTHOGRAPHIC: &[&str] = &["eye", "gaze", "look_at", "up", "scale", "stretch"];
pub(super) const PLANE: &[&str] = &["point", "normal", "color", "name"];
pub(super) const SPHERE: &[&str] = &["center", "radius", "color", "name"];
pub(super) const SPHERES: &[&str] = &["file", "radius", "color", "name"];

impl Target {
    /// What a path leads to in a scene; else why it leads to nothing that can change.
    pub(crate) fn of(model: &Model, path: &str) -> Result<Self, Diagnostic> {
        let mut steps = path_steps(path).map_err(|expected| {
            unknown_path(format!("{} is no path, expected {expected}", quote(path)))
        })?;
        index_of_geometry(model, &mut steps)?;
        let (owner, rest) = owner(model, &steps)?;
        let (field, component) = match rest {
            [field] => (field, None),
            [field, component] => (field, Some(component)),
            _ => return Err(does_not_change(path)),
        };
        let name = field.name().unwrap_or_default();
        let fields = owner.fields(model);
        let Some(field) = fields.iter().copied().find(|field| *field == name) else {
            return Err(unknown_field(name, fields));
        };
        let Some(kind) = Kind::of_field(field) else {
            return Err(does_not_change(path));
        };
        given(owner.camera(model), field)?;
        let component = match component.map(|step| &step.to) {
            None => None,
            Some(To::Index(index)) if *index < 3 && kind != Kind::Number => Some(*index),
            Some(To::Index(index)) if kind != Kind::Number => {
                let message = format!("there is no element {index}, there are 3");
                return Err(unknown_path(message));
            }
            Some(_) => return Err(does_not_change(path)),
        };
        Ok(Self {
            owner,
            field,
            component,
        })
    }

    /// Whether the world changes, and not only a camera.
    pub(crate) fn is_of_world(&self) -> bool {
        matches!(self.owner, Owner::Scene | Owner::Geometry(_))
    }

    /// Whether an orbit changes it as well.
    pub(crate) fn is_turned_by_orbit(&self) -> bool {
        matches!(self.owner, Owner::Camera | Owner::NamedCamera(_))
            && matches!(
                Kind::of_field(self.field),
                Some(Kind::Point | Kind::Direction)
            )
    }

    /// Where the value is written; optional fields that are not given become so.
    pub(crate) fn slot<'m>(&self, model: &'m mut Model) -> Option<Slot<'m>> {
        let whole = match self.owner {
            Owner::Scene => Slot::Color(model.background.get_or_insert(ColorModel::Hex([0; 3]))),
            Owner::Camera => of_camera(model.camera.as_mut()?, self.field)?,
            Owner::NamedCamera(index) => {
                let (_, camera) = model.cameras.as_mut()?.0.get_mut(index)?;
                of_camera(camera, self.field)?
            }
            Owner::Geometry(index) => of_geometry(model.geometries.get_mut(index)?, self.field)?,
        };
        let Some(index) = self.component else {
            return Some(whole);
        };
        let triple = match whole {
            Slot::Vector(triple) => triple,
            Slot::Color(color) => channels(color)?,
            Slot::Number(_) => return None,
        };
        triple.get_mut(index).map(Slot::Number)
    }
}

impl Owner {
    /// The names of its fields.
    pub(crate) fn fields(self, model: &Model) -> &'static [&'static str] {
        if let Some(camera) = self.camera(model) {
            return match camera {
                CameraModel::Perspective { .. } => PERSPECTIVE,
                CameraModel::Orthographic { .. } => ORTHOGRAPHIC,
            };
        }
        let Self::Geometry(index) = self else {
            return SCENE;
        };
        match model.geometries.get(index) {
            Some(GeometryModel::Plane { .. }) => PLANE,
            Some(GeometryModel::Sphere { .. }) => SPHERE,
            Some(GeometryModel::Spheres { .. }) => SPHERES,
            None => &[],
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

/// What has the field that a path leads to, and the steps from there.
fn owner<'s>(model: &Model, steps: &'s [Step]) -> Result<(Owner, &'s [Step]), Diagnostic> {
    let names: Vec<_> = steps.iter().map(Step::name).collect();
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
                Step {
                    to: To::Index(index),
                    ..
                },
                rest @ ..,
            ],
        ) => Ok((Owner::Geometry(*index), rest)),
        _ => Ok((Owner::Scene, steps)),
    }
}

fn of_camera<'m>(camera: &'m mut CameraModel, name: &str) -> Option<Slot<'m>> {
    let number = match camera {
        CameraModel::Perspective { .. } => "fov",
        CameraModel::Orthographic { .. } => "scale",
    };
    let (CameraModel::Perspective {
        eye,
        gaze,
        look_at,
        up,
        fov: size,
    }
    | CameraModel::Orthographic {
        eye,
        gaze,
        look_at,
        up,
        scale: size,
        ..
    }) = camera;
    match name {
        "eye" => Some(Slot::Vector(eye)),
        "gaze" => gaze.as_mut().map(Slot::Vector),
        "look_at" => look_at.as_mut().map(Slot::Vector),
        "up" => Some(Slot::Vector(up.get_or_insert(build::UP.to_array()))),
        name if name == number => Some(Slot::Number(size)),
        _ => None,
    }
}

fn of_geometry<'m>(geometry: &'m mut GeometryModel, name: &str) -> Option<Slot<'m>> {
    match (geometry, name) {
        (GeometryModel::Plane { point, .. }, "point") => Some(Slot::Vector(point)),
        (GeometryModel::Plane { normal, .. }, "normal") => Some(Slot::Vector(normal)),
        (GeometryModel::Sphere { center, .. }, "center") => Some(Slot::Vector(center)),
        (GeometryModel::Sphere { radius, .. }, "radius") => Some(Slot::Number(radius)),
        (GeometryModel::Spheres { radius, .. }, "radius") => {
            Some(Slot::Number(radius.get_or_insert_default()))
        }
        (GeometryModel::Plane { color, .. } | GeometryModel::Sphere { color, .. }, "color") => {
            Some(Slot::Color(color))
        }
        (GeometryModel::Spheres { color, .. }, "color") => {
            Some(Slot::Color(color.get_or_insert(ColorModel::Hex([0; 3]))))
        }
        _ => None,
    }
}

/// The channels of a color, which it is made of from now on.
fn channels(color: &mut ColorModel) -> Option<&mut Triple> {
    if !matches!(color, ColorModel::Channels(_)) {
        let light = build::color(color);
        *color = ColorModel::Channels([light.r(), light.g(), light.b()]);
    }
    match color {
        ColorModel::Channels(channels) => Some(channels),
        ColorModel::Hex(_) | ColorModel::Invalid(_) => None,
    }
}

/// Refuses the one of `gaze` and `look_at` that a camera does not have.
fn given(camera: Option<&CameraModel>, field: &str) -> Result<(), Diagnostic> {
    let Some(
        CameraModel::Perspective { gaze, look_at, .. }
        | CameraModel::Orthographic { gaze, look_at, .. },
    ) = camera
    else {
        return Ok(());
    };
    let other = match field {
        "gaze" if gaze.is_none() => "look_at",
        "look_at" if look_at.is_none() => "gaze",
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
        "{what} is no number, vector or color that can change over time"
    ))
}

fn unknown_field(name: &str, fields: &[&'static str]) -> Diagnostic {
    let can_change = |field: &&&str| Kind::of_field(field).is_some();
    let known: Vec<_> = fields.iter().filter(can_change).copied().collect();
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
