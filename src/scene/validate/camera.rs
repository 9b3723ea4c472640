//! Checks of a single camera.

use glam::DVec3;

use crate::{
    diagnostic::{Code, path::Path},
    scene::{
        format::{
            camera::CameraModel, fit::ProjectionModel, perspective::PerspectiveModel, scene::Model,
            sight::Sight, thing::Thing,
        },
        framing::Framing,
        problem::{Focus, Problem},
        validate::{
            found::Found,
            material::{WITHOUT_PATHS, both},
            names,
        },
    },
    tracer::{
        camera::{basis::are_parallel, lens::LARGEST},
        error::GeometryError,
        vector::is_direction,
    },
};

/// The eye of a perspective camera.
pub(super) struct Eye<'a> {
    pub(super) point: DVec3,
    /// The name of the camera, if it is one of `cameras`.
    pub(super) camera: Option<&'a str>,
}

/// The eyes of all perspective cameras, at the first frame.
pub(super) fn eyes<'a>(model: &'a Model, framing: &Framing) -> Vec<Eye<'a>> {
    let eyes = model.all_cameras().filter_map(|(name, camera)| {
        let point = match camera {
            CameraModel::Perspective(camera) => DVec3::from(camera.eye),
            CameraModel::Orthographic(_) => return None,
            CameraModel::Fit(fit) => match framing.explicit(fit, model.sides()) {
                Ok(CameraModel::Perspective(camera)) => DVec3::from(camera.eye),
                _ => return None,
            },
        };
        Some(Eye {
            point,
            camera: name,
        })
    });
    eyes.collect()
}

impl Found {
    /// Checks every camera and its name. A part needs none.
    pub(super) fn cameras(&mut self, model: &Model, is_part: bool) {
        for (name, camera) in model.all_cameras() {
            self.camera(camera, Model::path_of_camera(name));
            self.extend(name.and_then(names::of_camera));
        }
        if is_part || model.all_cameras().next().is_some() {
            return;
        }
        let path = |field| Path::ROOT.field(field);
        let problem = |path, focus, message| {
            Problem::new(Code::MissingField, path, focus, message)
                .help("give a `camera`, or several with their names as `cameras`")
        };
        self.push(if model.cameras.is_some() {
            let message = "there is no camera: `cameras` is empty, and `camera` is missing";
            problem(path("cameras"), Focus::Value, message)
        } else {
            problem(path("camera"), Focus::Bracket, "missing field `camera`")
        });
    }

    /// Reports the cameras that cannot frame the scene.
    pub(super) fn framing(&mut self, model: &Model, framing: &Framing) {
        for (name, camera) in model.all_cameras() {
            let CameraModel::Fit(fit) = camera else {
                continue;
            };
            let (message, help) = match framing.explicit(fit, model.sides()) {
                Ok(_) => continue,
                Err(GeometryError::NothingToFit) => (
                    "the camera has nothing to frame: no geometry is bounded",
                    "add a bounded geometry, such as a sphere, or use a `Perspective` camera, which \
                     has an `eye`",
                ),
                Err(_) => (
                    "the camera cannot frame the geometries: they are too large, or too small for \
                     their distance from the origin, for 64-bit floats",
                    "use other units, or move the geometries nearer to the origin",
                ),
            };
            let place = Model::path_of_camera(name);
            let problem = Problem::new(Code::CannotFit, place, Focus::Name, message);
            self.push(problem.help(help));
        }
    }

    pub(super) fn camera(&mut self, camera: &CameraModel, path: Path) {
        camera.each(|field, value| self.field(field, value, || path.clone()));
        match (camera, camera.projection()) {
            (CameraModel::Perspective(camera), _) => self.radians(camera.fov, &path),
            (_, Some(projection)) => {
                let path = path.field("projection");
                projection.each(|field, value| self.field(field, value, || path.clone()));
                if let ProjectionModel::Perspective(projection) = projection {
                    self.radians(projection.fov, &path);
                }
            }
            (_, None) => {}
        }
        let helps = [
            "`gaze` is a direction, `look_at` a point; leave one of them out",
            "add `gaze`, a direction such as (0, 0, -1), or `look_at`, a point",
        ];
        let one = self.one_of(camera, Code::GazeOrLookAt, &path, helps);
        let sight = camera.sight();
        // A point that is not finite has already been reported.
        if let Some(target) = sight.target()
            && target.is_finite()
            && sight.eye.is_finite()
        {
            let (name, what) = sight.name();
            self.direction(sight.gaze, what, || path.field(name));
        }
        if one && is_direction(sight.gaze) && is_direction(sight.up) {
            self.parallel_vectors(&sight, &path);
        }
        if !self.follows_paths {
            self.no_lens(camera, &path);
        }
        if let CameraModel::Perspective(camera) = camera {
            self.focus(camera, &sight, &path);
        }
    }

    /// Warns about a lens where light does not follow paths.
    fn no_lens(&mut self, camera: &CameraModel, path: &Path) {
        let (fields, path) = match camera {
            CameraModel::Perspective(PerspectiveModel {
                aperture,
                focus,
                focus_at,
                ..
            }) => {
                let fields = [
                    ("aperture", aperture.is_some()),
                    ("focus", focus.is_some()),
                    ("focus_at", focus_at.is_some()),
                ];
                (fields.to_vec(), path.clone())
            }
            _ => match camera.projection() {
                Some(ProjectionModel::Perspective(projection)) => {
                    let fields = [("aperture", projection.aperture.is_some())];
                    (fields.to_vec(), path.field("projection"))
                }
                _ => return,
            },
        };
        for (name, _) in fields.into_iter().filter(|(_, is_given)| *is_given) {
            self.no_effect(path.field(name), WITHOUT_PATHS);
        }
    }

    /// Checks the focus of a camera.
    fn focus(&mut self, camera: &PerspectiveModel, sight: &Sight, path: &Path) {
        match (camera.focus, camera.focus_at) {
            (Some(_), Some(_)) => {
                let help = "`focus` is a distance, `focus_at` a point; leave one of them out";
                self.push(both(Code::OneOf, path, ["focus", "focus_at"]).help(help));
            }
            (None, Some(_)) => {
                let distance = camera.focal_distance(sight);
                if distance.is_finite() && !(distance > 0.0 && distance <= LARGEST) {
                    let message = match distance > 0.0 {
                        true => "`focus_at` is too far away from the eye",
                        false => "`focus_at` is not in front of the eye",
                    };
                    let place = path.field("focus_at");
                    let problem = Problem::of_value(Code::OutOfRange, place, message);
                    self.push(problem.help("give a point that the camera looks at"));
                }
            }
            (None, None) if camera.look_at.is_none() && camera.aperture() > 0.0 => {
                let message = "neither `focus` nor `focus_at` is given, expected one of them";
                let place = path.field("aperture");
                let problem = Problem::new(Code::OneOf, place, Focus::Key, message);
                self.push(problem.help(
                    "add `focus`, the distance of the plane of focus, or `focus_at`, a point on it",
                ));
            }
            _ => {}
        }
    }

    /// Warns about an angle of view that is likely in radians.
    fn radians(&mut self, fov: f64, path: &Path) {
        if let Some(degrees) = likely_degrees(fov) {
            let message = "`fov` looks like an angle in radians";
            let problem = Problem::of_value(Code::FovInRadians, path.field("fov"), message);
            self.push(problem.help(format!("`fov` is in degrees: write `{degrees}`")));
        }
    }

    fn parallel_vectors(&mut self, sight: &Sight, path: &Path) {
        if !are_parallel(sight.gaze, sight.up) {
            return;
        }
        let (name, what) = sight.name();
        let (at, message, help) = if sight.aim_is_default {
            // The default cannot be reported where it is not written.
            let (x, y, z) = (DVec3::ZERO - sight.gaze).into();
            let message = format!("`up` is parallel to the default {what}, ({x}, {y}, {z})");
            ("up", message, "give another `up`, or a `from` as well")
        } else if sight.up_is_default {
            let (x, y, z) = sight.up.into();
            let message = format!("{what} is parallel to the default `up`, ({x}, {y}, {z})");
            (name, message, "give another `up`, such as (0, 0, -1)")
        } else {
            let message = format!("{what} is parallel to `up`");
            let help = "`up` must not point along the line of sight";
            (name, message, help)
        };
        let code = Code::ParallelVectors;
        let problem = Problem::new(code, path.field(at), Focus::Value, message).help(help);
        let both_are_given = !sight.aim_is_default && !sight.up_is_default;
        self.push(match both_are_given {
            true => problem.label(path.field("up"), Focus::Value, "this is `up`"),
            false => problem,
        });
    }
}

/// Returns the angle in degrees that `fov` is in radians, if it is a multiple of 5 below 180, with an
/// error of at most half a hundredth of a radian.
fn likely_degrees(fov: f64) -> Option<f64> {
    let exact = fov.to_degrees();
    let degrees = (exact / 5.0).round() * 5.0;
    let is_near = (exact - degrees).abs() <= 0.005_f64.to_degrees();
    (is_near && (5.0..180.0).contains(&degrees)).then_some(degrees)
}
