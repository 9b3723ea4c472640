//! What stands where a camera cannot see it, or where it hides all else.

use glam::DVec3;

use crate::{
    diagnostic::Code,
    scene::{
        animation::frames::Frames,
        model::{GeometryModel, Model},
        nearest::quote,
        path::Path,
        problem::{Focus, Problem},
        surroundings::Surroundings,
        table::{Block, Table},
        tables::Tables,
        validate::{Found, camera::Eye, geometry_path},
        view::View,
    },
    tracer::vector::is_direction,
};

impl Eye<'_> {
    fn name(&self) -> String {
        match self.camera {
            None => "the eye of the camera".to_owned(),
            Some(name) => format!("the eye of the camera {}", quote(name)),
        }
    }
}

impl Found {
    /// Whether a geometry stands in the way of an eye.
    pub(super) fn eye(
        &mut self,
        eye: &Eye,
        geometry: &GeometryModel,
        index: usize,
        table: Option<&Table>,
        surroundings: &mut Surroundings,
    ) {
        let mut hides = |center: DVec3, radius: f64| {
            // False for a number that is not one.
            (eye.point - center).length() < radius && surroundings.reach_beyond(center, radius)
        };
        match geometry {
            GeometryModel::Sphere { center, radius, .. } => {
                if hides(DVec3::from(*center), *radius) {
                    self.eye_inside(eye, geometry_path(geometry, index), "this sphere");
                }
            }
            // Told once for a table.
            GeometryModel::Spheres { .. } => {
                let mut first = None;
                let has_one = |block: &Block| {
                    let mut rows = block.spheres();
                    let at = rows.position(|(center, radius, _)| hides(center.into(), radius));
                    first = at.map(|at| block.first + at);
                    first.is_some()
                };
                let table = table.filter(|table| table.may_enclose(eye.point));
                table.map(|table| table.any_block(has_one));
                if let Some(row) = first {
                    let sphere = format!("the sphere of row {row}");
                    self.eye_inside(eye, geometry_path(geometry, index), &sphere);
                }
            }
            GeometryModel::Plane { point, normal, .. } => {
                let normal = DVec3::from(**normal);
                if is_direction(normal) && (DVec3::from(*point) - eye.point).dot(normal) == 0.0 {
                    self.eye_on_plane(eye, geometry_path(geometry, index));
                }
            }
        }
    }

    fn eye_inside(&mut self, eye: &Eye, path: Path, sphere: &str) {
        let message = format!("{} lies inside of {sphere}", eye.name());
        let problem = Problem::new(Code::EyeInside, path, Focus::Name, message);
        self.0
            .push(problem.help("what lies outside of the sphere cannot be seen"));
    }

    fn eye_on_plane(&mut self, eye: &Eye, path: Path) {
        let eye = eye.name();
        let message = format!("{eye} lies exactly on this plane, which hides it");
        let problem = Problem::new(Code::EyeOnPlane, path, Focus::Name, message);
        self.0
            .push(problem.help("move the eye or the plane, even if only a little"));
    }

    /// What no camera can see, at any frame.
    pub(super) fn never_visible(
        &mut self,
        model: &Model,
        tables: &Tables,
        frames: Option<&Frames>,
    ) {
        let cameras = match (model.all_cameras().count(), frames) {
            (0, _) => return,
            (1, None) => "the camera",
            (_, None) => "every camera",
            (1, Some(_)) => "the camera in every frame",
            (_, Some(_)) => "every camera in every frame",
        };
        let unseen = match frames {
            None => unseen(
                model,
                &model.geometries,
                tables,
                (0..model.geometries.len()).collect(),
            ),
            Some(frames) => unseen_by_frames(model, tables, frames),
        };
        for index in unseen.into_iter().flatten() {
            if let Some(geometry) = model.geometries.get(index) {
                let path = geometry_path(geometry, index);
                let what = match geometry {
                    GeometryModel::Spheres { .. } => "all spheres of this table lie",
                    _ => "this geometry lies",
                };
                let message = format!("{what} outside of the view of {cameras}");
                self.0
                    .push(Problem::new(Code::NeverVisible, path, Focus::Name, message));
            }
        }
    }
}

/// The most times that a geometry is held against a camera at a frame.
const MOST_WORK: usize = 10_000_000;

/// Those of some geometries that no camera of a scene can see; `None` where a camera is not valid.
fn unseen(
    cameras: &Model,
    geometries: &[GeometryModel],
    tables: &Tables,
    mut those: Vec<usize>,
) -> Option<Vec<usize>> {
    let image = cameras.image.as_ref();
    let views = cameras.all_cameras();
    let views = views.map(|(_, camera)| View::of(camera, image));
    let views = views.collect::<Option<Vec<_>>>()?;
    those.retain(|index| {
        let misses = |view: &View, geometry| view.certainly_misses(geometry, tables.of(*index));
        let geometry = geometries.get(*index);
        geometry.is_some_and(|geometry| views.iter().all(|view| misses(view, geometry)))
    });
    Some(those)
}

/// The geometries that no camera can see at any frame; `None` where that would last too long.
fn unseen_by_frames(model: &Model, tables: &Tables, frames: &Frames) -> Option<Vec<usize>> {
    let rows: usize = tables.iter().map(|(_, table)| table.rows()).sum();
    let work = (model.geometries.len() + rows) * model.all_cameras().count();
    if work.saturating_mul(frames.count() as usize) > MOST_WORK {
        return None;
    }
    // The rows of a table may change their size with its `radius`.
    let moves = |index: &usize| tables.of(*index).is_some() && frames.move_geometry(*index);
    let all = 0..model.geometries.len();
    let mut left: Vec<usize> = all.filter(|index| !moves(index)).collect();
    let mut shown = frames.copy(model);
    for number in 0..frames.count() {
        if left.is_empty() {
            break;
        }
        frames.show(number, &mut shown);
        let geometries = if frames.move_the_world() {
            &shown.geometries
        } else {
            &model.geometries
        };
        left = unseen(&shown, geometries, tables, left)?;
    }
    Some(left)
}
