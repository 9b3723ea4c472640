//! From a model without faults to a camera and a world: the only file that sees both sides.

use glam::DVec3;

use crate::{
    scene::{
        model::{CameraModel, ColorModel, GeometryModel, Model, Name},
        names::Names,
        table::Table,
        tables::Tables,
    },
    tracer::{
        camera::{
            Camera,
            orthographic::OrthographicCamera,
            perspective::{PerspectiveCamera, half_angle_of},
        },
        color::Color,
        error::GeometryError,
        geometry::Geometry,
        shape::{Shape, plane::Plane, sphere::Sphere},
        world::World,
    },
};

/// The direction that is up where a scene does not say.
pub(crate) const UP: DVec3 = DVec3::Y;

/// The directions of a camera, with the defaults filled in.
pub(crate) struct Sight {
    /// Where the camera looks: `gaze`, or `look_at - eye`.
    pub(crate) gaze: DVec3,
    /// Whether `gaze` comes from `look_at`.
    pub(crate) by_point: bool,
    /// What is up.
    pub(crate) up: DVec3,
    /// Whether the scene does not say what is up.
    pub(crate) up_is_default: bool,
}

impl Sight {
    /// The field that the gaze comes from, and how a message calls it.
    pub(crate) fn name(&self) -> (&'static str, &'static str) {
        if self.by_point {
            ("look_at", "`look_at` - `eye`")
        } else {
            ("gaze", "`gaze`")
        }
    }
}

/// The directions of a camera; a gaze of 0 where neither `gaze` nor `look_at` is given.
pub(crate) fn sight(camera: &CameraModel) -> Sight {
    let (CameraModel::Perspective {
        eye,
        gaze,
        look_at,
        up,
        ..
    }
    | CameraModel::Orthographic {
        eye,
        gaze,
        look_at,
        up,
        ..
    }) = camera;
    let seen = look_at.map(|point| DVec3::from(point) - DVec3::from(*eye));
    Sight {
        gaze: gaze.map(DVec3::from).or(seen).unwrap_or(DVec3::ZERO),
        by_point: gaze.is_none() && seen.is_some(),
        up: up.map_or(UP, DVec3::from),
        up_is_default: up.is_none(),
    }
}

/// The camera of a scene.
pub(crate) fn camera(model: &CameraModel) -> Result<Camera, GeometryError> {
    let Sight { gaze, up, .. } = sight(model);
    Ok(match *model {
        CameraModel::Perspective { eye, fov, .. } => {
            PerspectiveCamera::new(eye.into(), gaze, up, half_angle_of(fov))?.into()
        }
        CameraModel::Orthographic {
            eye,
            scale,
            stretch,
            ..
        } => {
            let new = if stretch.unwrap_or(false) {
                OrthographicCamera::new
            } else {
                OrthographicCamera::with_square_pixels
            };
            new(eye.into(), gaze, up, scale)?.into()
        }
    })
}

/// The world of a scene. Without tables it takes the memory of the model: a million spheres are not
/// held twice. A row of a table stands in the place of the geometry that names it; each table is
/// gone once its rows are built. The names of the geometries go into a table beside.
pub(crate) fn world(model: Model, mut tables: Tables) -> Result<(World, Names), GeometryError> {
    let background = model.background.as_ref().map_or(Color::BLACK, color);
    let mut names = Names::default();
    let list = model.geometries.into_iter().enumerate();
    if tables.is_empty() {
        // Of equal size, the elements are replaced one by one.
        let geometries = list.filter_map(|(index, model)| {
            let (geometry, name) = geometry(model);
            names.add(index, name);
            geometry.transpose()
        });
        let geometries = geometries.collect::<Result<_, _>>()?;
        return Ok((World::new(geometries, background), names));
    }
    let rows: usize = tables.iter().map(|(_, table)| table.rows()).sum();
    let mut geometries = Vec::with_capacity(list.len() + rows);
    for (index, model) in list {
        let (geometry, name) = geometry(model);
        names.add(index, name);
        match tables.take(index) {
            Some(table) => spheres(&table, &mut geometries)?,
            None => geometries.extend(geometry?),
        }
    }
    Ok((World::new(geometries, background), names))
}

/// A geometry, none for the name of a table, and what the scene calls it.
#[inline]
fn geometry(model: GeometryModel) -> (Result<Option<Geometry>, GeometryError>, Option<Name>) {
    let build = |shape: Result<Shape, GeometryError>, color: &ColorModel| {
        Ok(Some(Geometry::new(shape?, self::color(color))))
    };
    match model {
        GeometryModel::Plane {
            point,
            normal,
            color,
            name,
        } => {
            let plane = Plane::new(DVec3::from(point), DVec3::from(*normal));
            (build(plane.map(Shape::from), &color), name)
        }
        GeometryModel::Sphere {
            center,
            radius,
            color,
            name,
        } => {
            let sphere = Sphere::new(DVec3::from(center), radius);
            (build(sphere.map(Shape::from), &color), name)
        }
        GeometryModel::Spheres { name, .. } => (Ok(None), name),
    }
}

fn spheres(table: &Table, geometries: &mut Vec<Geometry>) -> Result<(), GeometryError> {
    let mut refused = None;
    table.any_block(|block| {
        for (center, radius, [r, g, b]) in block.spheres() {
            match Sphere::new(DVec3::from(center), radius) {
                Ok(sphere) => geometries.push(Geometry::new(sphere, Color::new(r, g, b))),
                Err(error) => refused = Some(error),
            }
        }
        refused.is_some()
    });
    refused.map_or(Ok(()), Err)
}

/// A color without faults.
pub(crate) fn color(model: &ColorModel) -> Color {
    match model {
        ColorModel::Channels([r, g, b]) => Color::new(*r, *g, *b),
        ColorModel::Hex(bytes) => {
            let [r, g, b] = bytes.map(|byte| f64::from(byte) / 255.0);
            Color::new(r, g, b)
        }
        // Validation has refused it.
        ColorModel::Invalid(_) => Color::BLACK,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::model::Triple;

    fn perspective(gaze: Option<Triple>, look_at: Option<Triple>) -> CameraModel {
        CameraModel::Perspective {
            eye: [1.0, 2.0, 3.0],
            gaze,
            look_at,
            up: None,
            fov: 90.0,
        }
    }

    #[test]
    fn look_at_is_a_point_and_gaze_a_direction() {
        let by_point = camera(&perspective(None, Some([1.0, 2.0, -7.0]))).unwrap();
        assert_eq!(by_point.gaze(), DVec3::new(0.0, 0.0, -10.0));
        assert_eq!(by_point.up(), DVec3::Y);
        let by_direction = camera(&perspective(Some([0.0, 0.0, -2.0]), None)).unwrap();
        assert_eq!(by_direction.w(), by_point.w());
        assert!(camera(&perspective(None, None)).is_err());
    }

    #[test]
    fn pixels_are_square_unless_stretched() {
        let orthographic = |stretch| CameraModel::Orthographic {
            eye: [0.0; 3],
            gaze: Some([0.0, 0.0, -1.0]),
            look_at: None,
            up: None,
            scale: 2.0,
            stretch,
        };
        let corner = |stretch| {
            let camera = camera(&orthographic(stretch)).unwrap();
            camera.ray_for(3, 2, 2.0, 1.0).origin()
        };
        assert_eq!(corner(None), DVec3::new(2.0, 1.0, 0.0));
        assert_eq!(corner(Some(false)), DVec3::new(2.0, 1.0, 0.0));
        assert_eq!(corner(Some(true)), DVec3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn a_world_takes_the_memory_of_its_model() {
        let sphere = |index: u32| GeometryModel::Sphere {
            center: [0.0, 0.0, f64::from(index)],
            radius: 1.0,
            color: ColorModel::Hex([0; 3]),
            name: (index == 5).then(|| Box::new("five".into())),
        };
        let model = Model {
            schema: None,
            version: None,
            image: None,
            camera: Some(perspective(None, None)),
            cameras: None,
            background: None,
            geometries: (0..9).map(sphere).collect(),
            animation: None,
            allow: None,
        };
        let before = model.geometries.as_ptr().addr();
        let (world, names) = world(model, Tables::default()).unwrap();
        assert_eq!(world.geometries().len(), 9);
        assert_eq!(world.geometries().as_ptr().addr(), before);
        assert_eq!((names.of(5), names.of(4)), (Some("five"), None));
    }

    #[test]
    fn hex_colors_are_their_bytes() {
        for byte in 0..=255 {
            assert_eq!(color(&ColorModel::Hex([byte; 3])).to_rgb8(), [byte; 3]);
        }
    }
}
