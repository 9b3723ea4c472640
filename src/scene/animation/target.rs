//! Resolution of a track's path to the value that it changes.

use crate::{
    diagnostic::{Code, Diagnostic, path::Step},
    scene::{
        format::{
            camera::CameraModel,
            color_by::ColorByModel,
            field::{Field, FieldKind, Slot},
            fit::ProjectionModel,
            geometry::{GeometryModel, nesting::Ordinal},
            image::ImageModel,
            material::MaterialModel,
            scene::Model,
            thing::Thing,
            transform::{ScaleModel, TransformModel},
        },
        path::{self, PathPart},
        unknown,
    },
    text::nearest::{list, nearest, quote},
};

/// The owner of fields that change over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Owner {
    /// The scene itself.
    Scene,
    /// The picture.
    Image,
    /// The outlines.
    Outlines,
    /// The camera without a name.
    Camera,
    /// One of `cameras`, by its index.
    NamedCamera(usize),
    /// The projection of the camera without a name.
    Projection,
    /// The projection of one of `cameras`, by its index.
    NamedProjection(usize),
    /// A light, by its index.
    Light(usize),
    /// One of `materials`, by its index.
    Material(usize),
    /// A geometry, by its number.
    Geometry(Ordinal),
    /// The material of a geometry, by the number of the geometry.
    Surface(Ordinal),
    /// The colors by value of a geometry, by the number of the geometry.
    ColorBy(Ordinal),
    /// The transform of a geometry, by the number of the geometry; or that of one of the instances that
    /// it is, by the index in their list.
    Transform(Ordinal, Option<usize>),
    /// The rotation in that transform.
    Rotation(Ordinal, Option<usize>),
}

/// The target of a track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub(crate) owner: Owner,
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
        let mut steps = path::parts(path).map_err(|expected| {
            unknown_path(format!(
                "{} is not a path, expected {expected}",
                quote(path)
            ))
        })?;
        unknown::index_of_name(model, &mut steps)?;
        let (owner, rest) = owner(model, &steps)?;
        let (field, component) = match rest {
            [field] => (field, None),
            [field, component] => (field, Some(component)),
            _ => return Err(does_not_change(path)),
        };
        let name = field.name().unwrap_or_default();
        let fields = owner.fields(model);
        let Some(Field {
            name: field, kind, ..
        }) = fields.iter().copied().find(|field| field.name == name)
        else {
            return Err(unknown_field(name, fields));
        };
        if !kind.changes() {
            return Err(does_not_change(path));
        }
        if !owner.has_value(model, field) {
            return Err(match owner.transform(model) {
                Some(TransformModel {
                    matrix: Some(_), ..
                }) => in_matrix(),
                _ => not_given(model, owner, field),
            });
        }
        let count = if kind == FieldKind::Interval { 2 } else { 3 };
        let component = match component.map(|part| &part.step) {
            None => None,
            Some(Step::Index(index)) if *index < count && !kind.is_number() => Some(*index),
            Some(Step::Index(index)) if !kind.is_number() => {
                let message = format!("there is no element {index}, there are {count}");
                return Err(unknown_path(message));
            }
            Some(_) => return Err(does_not_change(path)),
        };
        if kind == FieldKind::Scale && component.is_some() && !owner.has_three_scales(model) {
            let message = "`scale` is one number: no element of it can change".to_owned();
            let help = "give the transform three numbers as `scale`";
            return Err(unknown_path(message).with_help(help));
        }
        Ok(Self {
            owner,
            field,
            kind,
            component,
        })
    }

    /// Returns true if the world changes, and not only a camera or the picture.
    pub(crate) const fn is_of_world(&self) -> bool {
        match self.owner {
            Owner::Scene
            | Owner::Light(_)
            | Owner::Material(_)
            | Owner::Geometry(_)
            | Owner::Surface(_)
            | Owner::ColorBy(_)
            | Owner::Transform(..)
            | Owner::Rotation(..) => true,
            Owner::Image
            | Owner::Outlines
            | Owner::Camera
            | Owner::NamedCamera(_)
            | Owner::Projection
            | Owner::NamedProjection(_) => false,
        }
    }

    /// The geometry that changes, if it is one.
    pub(crate) const fn geometry(&self) -> Option<Ordinal> {
        match self.owner {
            Owner::Geometry(at)
            | Owner::Surface(at)
            | Owner::ColorBy(at)
            | Owner::Transform(at, _)
            | Owner::Rotation(at, _) => Some(at),
            _ => None,
        }
    }

    /// Returns true if an orbit changes it as well.
    pub(crate) const fn is_turned_by_orbit(&self) -> bool {
        self.owner.is_camera() && matches!(self.kind, FieldKind::Point | FieldKind::Direction)
    }

    /// Returns the slot of the value; a missing optional field gets its default.
    pub(crate) fn slot<'m>(&self, model: &'m mut Model) -> Option<Slot<'m>> {
        let whole = self.owner.thing_mut(model)?.slot(self.field)?;
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

impl Owner {
    /// Its fields.
    fn fields(self, model: &Model) -> &'static [Field] {
        self.thing(model).map_or(&[], Thing::fields)
    }

    /// The owner itself.
    fn thing(self, model: &Model) -> Option<&dyn Thing> {
        Some(match self {
            Self::Scene => model,
            Self::Image => model.image.as_ref().unwrap_or(&ImageModel::NONE),
            Self::Outlines => &model.outlines,
            Self::Camera | Self::NamedCamera(_) => self.camera(model)?,
            Self::Projection | Self::NamedProjection(_) => self.projection(model)?,
            Self::Light(index) => model.lights.as_ref()?.get(index)?,
            Self::Material(_) | Self::Surface(_) => self.material(model)?,
            Self::Geometry(at) => model.geometry(at)?,
            Self::ColorBy(_) => self.color_by(model)?,
            Self::Transform(..) => self.transform(model)?,
            Self::Rotation(..) => &self.transform(model)?.rotate,
        })
    }

    /// The same, writable.
    fn thing_mut(self, model: &mut Model) -> Option<&mut dyn Thing> {
        Some(match self {
            Self::Scene => model,
            Self::Image => model.image.get_or_insert_default(),
            Self::Outlines => &mut model.outlines,
            Self::Camera => &mut model.camera,
            Self::NamedCamera(index) => &mut model.cameras.as_mut()?.0.get_mut(index)?.1,
            Self::Projection => model.camera.as_mut()?.projection_mut()?,
            Self::NamedProjection(index) => {
                let (_, camera) = model.cameras.as_mut()?.0.get_mut(index)?;
                camera.projection_mut()?
            }
            Self::Light(index) => model.lights.as_mut()?.get_mut(index)?,
            Self::Material(index) => &mut model.materials.as_mut()?.0.get_mut(index)?.1,
            Self::Geometry(at) => model.geometry_mut(at)?,
            Self::Surface(at) => model.geometry_mut(at)?.material_mut()?,
            Self::ColorBy(at) => model.geometry_mut(at)?.color_by_mut()?,
            Self::Transform(at, instance) => model.geometry_mut(at)?.transform_of_mut(instance)?,
            Self::Rotation(at, instance) => {
                let transform = model.geometry_mut(at)?.transform_of_mut(instance)?;
                &mut transform.rotate
            }
        })
    }

    /// Returns true for a camera or its projection.
    pub(crate) const fn is_camera(self) -> bool {
        matches!(
            self,
            Self::Camera | Self::NamedCamera(_) | Self::Projection | Self::NamedProjection(_)
        )
    }

    /// The projection, if it is one.
    fn projection(self, model: &Model) -> Option<&ProjectionModel> {
        self.camera(model)?.projection()
    }

    /// The camera, if it is one or its projection.
    pub(crate) fn camera(self, model: &Model) -> Option<&CameraModel> {
        match self {
            Self::Camera | Self::Projection => model.camera.as_ref(),
            Self::NamedCamera(index) | Self::NamedProjection(index) => {
                Some(&model.cameras.as_ref()?.0.get(index)?.1)
            }
            _ => None,
        }
    }

    /// The material, if it is one.
    fn material(self, model: &Model) -> Option<&MaterialModel> {
        match self {
            Self::Material(index) => Some(&model.materials.as_ref()?.0.get(index)?.1),
            Self::Surface(at) => model.geometry(at)?.surface().material,
            _ => None,
        }
    }

    /// The colors by value, if it has some.
    fn color_by(self, model: &Model) -> Option<&ColorByModel> {
        match self {
            Self::ColorBy(at) => model.geometry(at)?.color_by(),
            _ => None,
        }
    }

    /// The transform, if it is one or its rotation.
    fn transform(self, model: &Model) -> Option<&TransformModel> {
        match self {
            Self::Transform(at, instance) | Self::Rotation(at, instance) => {
                model.geometry(at)?.transform_of(instance)
            }
            _ => None,
        }
    }

    /// Returns true if it is a transform whose scale is three numbers.
    fn has_three_scales(self, model: &Model) -> bool {
        let transform = self.transform(model);
        transform.is_some_and(|it| matches!(it.scale, Some(ScaleModel::Axes(_))))
    }

    /// Returns true if a field is given or has a default. The other fields of a matrix are not used.
    fn has_value(self, model: &Model, field: &str) -> bool {
        let is_matrix = || self.transform(model).is_some_and(|it| it.matrix.is_some());
        let is_in_matrix = matches!(self, Self::Transform(..)) && is_matrix();
        !is_in_matrix && self.thing(model).is_some_and(|thing| thing.has(field))
    }
}

/// Returns the owner of the field at a path, and the remaining steps.
fn owner<'s>(model: &Model, steps: &'s [PathPart]) -> Result<(Owner, &'s [PathPart]), Diagnostic> {
    let names: Vec<_> = steps.iter().map(PathPart::name).collect();
    let index = steps.get(1).and_then(PathPart::index);
    match (&*names, steps, index) {
        ([Some("image"), _, ..], [_, rest @ ..], _) => Ok((Owner::Image, rest)),
        ([Some("outlines"), _, ..], [_, rest @ ..], _) => match model.outlines {
            Some(_) => Ok((Owner::Outlines, rest)),
            None => Err(unknown_path("the scene has no `outlines`".to_owned())),
        },
        ([Some("camera"), _, ..], [_, rest @ ..], _) => match model.camera {
            Some(_) => inner(model, Owner::Camera, Owner::Projection, rest),
            None => Err(unknown_path("the scene has no `camera`".to_owned())),
        },
        ([Some("cameras"), Some(name), ..], [_, _, rest @ ..], _) => {
            let cameras = model.cameras.iter().flat_map(|cameras| &cameras.0);
            let known = cameras.map(|(name, _)| &**name);
            let index = entry("camera", name, known)?;
            let projection = Owner::NamedProjection(index);
            inner(model, Owner::NamedCamera(index), projection, rest)
        }
        ([Some("materials"), Some(name), ..], [_, _, rest @ ..], _) => {
            let materials = model.materials.iter().flat_map(|materials| &materials.0);
            let known = materials.map(|(name, _)| &**name);
            Ok((Owner::Material(entry("material", name, known)?), rest))
        }
        ([Some("lights"), ..], [_, _, rest @ ..], Some(index)) => Ok((Owner::Light(index), rest)),
        _ => match unknown::geometry_on(model, steps) {
            Some((at, rest)) => of_geometry(model, at, rest),
            None => Ok((Owner::Scene, steps)),
        },
    }
}

/// Returns the projection of a camera and the steps in it, if they lead there, else the camera.
///
/// # Errors
///
/// A projection that is not given.
fn inner<'s>(
    model: &Model,
    camera: Owner,
    projection: Owner,
    steps: &'s [PathPart],
) -> Result<(Owner, &'s [PathPart]), Diagnostic> {
    const FIELD: &str = "projection";
    let has_it = |camera: Owner| camera.fields(model).iter().any(|field| field.name == FIELD);
    match steps {
        [field, rest @ ..] if field.name() == Some(FIELD) && !rest.is_empty() && has_it(camera) => {
            match projection.projection(model) {
                Some(_) => Ok((projection, rest)),
                None => Err(not_given(model, camera, FIELD)),
            }
        }
        _ => Ok((camera, steps)),
    }
}

/// Returns the owner of the field at the remaining steps in a geometry: the geometry itself, its
/// material, or its colors by value.
fn of_geometry<'s>(
    model: &Model,
    at: Ordinal,
    steps: &'s [PathPart],
) -> Result<(Owner, &'s [PathPart]), Diagnostic> {
    let owner = Owner::Geometry(at);
    let [field, rest @ ..] = steps else {
        return Ok((owner, steps));
    };
    match field.name().filter(|_| !rest.is_empty()) {
        Some("material") => {
            surface(model, at)?;
            Ok((Owner::Surface(at), rest))
        }
        Some("color_by") => match Owner::ColorBy(at).color_by(model) {
            Some(_) => Ok((Owner::ColorBy(at), rest)),
            None => Err(not_given(model, owner, "color_by")),
        },
        Some("transform") => transform(model, (at, None), rest),
        Some(INSTANCES) => instance(model, at, rest),
        _ => Ok((owner, steps)),
    }
}

/// The field of the transforms of instances.
const INSTANCES: &str = "transforms";

/// Returns the owner of the field at the remaining steps in the list of the transforms of instances.
fn instance<'s>(
    model: &Model,
    at: Ordinal,
    steps: &'s [PathPart],
) -> Result<(Owner, &'s [PathPart]), Diagnostic> {
    let Some(GeometryModel::Instances(instances)) = model.geometry(at) else {
        return Ok((Owner::Geometry(at), steps));
    };
    let Some(transforms) = &instances.transforms else {
        return Err(not_given(model, Owner::Geometry(at), INSTANCES));
    };
    let count = transforms.len();
    match steps {
        [element, rest @ ..] => match element.index() {
            Some(index) if index < count => transform(model, (at, Some(index)), rest),
            Some(index) => Err(unknown_path(format!(
                "there is no transform {index}, there are {count}"
            ))),
            None => Err(unknown_path(
                "expected the index of a transform, such as `transforms[0]`".to_owned(),
            )),
        },
        [] => Ok((Owner::Geometry(at), steps)),
    }
}

/// Returns the owner of the field at the remaining steps in the transform of a geometry, or of one of
/// the instances that it is.
fn transform<'s>(
    model: &Model,
    (at, instance): (Ordinal, Option<usize>),
    steps: &'s [PathPart],
) -> Result<(Owner, &'s [PathPart]), Diagnostic> {
    let owner = Owner::Transform(at, instance);
    let Some(transform) = owner.transform(model) else {
        return Err(not_given(model, Owner::Geometry(at), "transform"));
    };
    match steps {
        [field, rest @ ..] if field.name() == Some("rotate") && !rest.is_empty() => {
            match transform.rotate {
                Some(_) => Ok((Owner::Rotation(at, instance), rest)),
                None => Err(not_given(model, owner, "rotate")),
            }
        }
        _ => Ok((owner, steps)),
    }
}

/// Returns the index of a name in a map.
fn entry<'m>(
    kind: &str,
    name: &str,
    known: impl Iterator<Item = &'m str>,
) -> Result<usize, Diagnostic> {
    let known: Vec<_> = known.collect();
    let index = known.iter().position(|known| *known == name);
    index.ok_or_else(|| Diagnostic {
        code: Code::UnknownPath,
        ..unknown::name(kind, name, &known)
    })
}

/// Rejects the material of a geometry that has none of its own.
fn surface(model: &Model, at: Ordinal) -> Result<(), Diagnostic> {
    match Owner::Surface(at).material(model) {
        None => Err(not_given(model, Owner::Geometry(at), "material")),
        Some(material) => material.named().map_or(Ok(()), |name| {
            let message = "this material is a name: nothing in it can change".to_owned();
            Err(unknown_path(message).with_help(format!("change `materials[{name:?}]`")))
        }),
    }
}

/// Returns the diagnostic of a field that is not given and has no default.
fn not_given(model: &Model, owner: Owner, field: &str) -> Diagnostic {
    let fault = unknown_path(format!("`{field}` is not given: nothing in it can change"));
    let what = match owner {
        Owner::Camera | Owner::NamedCamera(_) => "the camera",
        Owner::Light(_) => "the light",
        Owner::Geometry(_) => "the geometry",
        Owner::Scene
        | Owner::Image
        | Owner::Outlines
        | Owner::Projection
        | Owner::NamedProjection(_)
        | Owner::Material(_)
        | Owner::Surface(_)
        | Owner::ColorBy(_)
        | Owner::Rotation(..) => "it",
        Owner::Transform(..) => "the transform",
    };
    let sets = owner.thing(model).map(Thing::sets).unwrap_or_default();
    let other = sets.iter().find_map(|(set, _)| set.instead_of(field));
    fault.with_help(match other {
        Some(other) => format!("change `{other}`, or give {what} `{field}` instead of it"),
        None => format!("give {what} `{field}`"),
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
    let fault = unknown_path(message);
    match nearest(name, &known) {
        Some(meant) => fault.with_help(format!("did you mean `{meant}`?")),
        None => fault,
    }
}
