//! The selection of a scene's cameras, and the names of their pictures.

use strahl::{Scene, report::FileReport};

use super::{failure::Failure, scene};

/// The placeholder for the name of a camera in a file name.
const PLACE: &str = "{camera}";

/// The camera that a command uses.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct CameraArgs {
    /// Use one of the scene's `cameras`, by name, instead of its `camera`
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
}

impl CameraArgs {
    /// Returns the name, if one is given.
    pub(super) fn name(&self) -> Option<&str> {
        self.camera.as_deref()
    }

    /// Returns the scene as the camera sees it.
    pub(super) fn of(&self, scene: Scene) -> Result<Scene, Failure> {
        match &self.camera {
            Some(name) => see_by(scene, name),
            None if scene.has_camera() => Ok(scene),
            None => Err(no_camera(
                &scene,
                "choose one of its `cameras` with --camera",
            )),
        }
    }
}

/// The cameras that a command uses.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct CamerasArgs {
    #[command(flatten)]
    one: CameraArgs,
    /// Render one picture per camera in the scene's `cameras`; `{camera}` in FILE is its name
    #[arg(long, conflicts_with = "camera")]
    all_cameras: bool,
}

impl CamerasArgs {
    /// Returns true if all of a scene's `cameras` draw.
    pub(super) fn is_all(&self) -> bool {
        self.all_cameras
    }

    /// Returns true if each picture is by a camera with a name.
    pub(super) fn has_name(&self) -> bool {
        self.all_cameras || self.one.camera.is_some()
    }

    /// Returns the one camera, if only one draws.
    pub(super) fn one(&self) -> &CameraArgs {
        &self.one
    }

    /// Returns the scene as the one camera sees it.
    pub(super) fn of(&self, scene: Scene) -> Result<Scene, Failure> {
        match self.names(&scene)?.pop().flatten() {
            Some(name) => see_by(scene, &name),
            None => Ok(scene),
        }
    }

    /// Returns the names of the cameras that draw; `None` is the one without a name.
    pub(super) fn names(&self, scene: &Scene) -> Result<Vec<Option<String>>, Failure> {
        let names: Vec<_> = scene.cameras().map(|name| Some(name.to_owned())).collect();
        match &self.one.camera {
            Some(name) => Ok(vec![Some(name.clone())]),
            None if !self.all_cameras && scene.has_camera() => Ok(vec![None]),
            None if !self.all_cameras => {
                let cure = "choose one of its `cameras` with --camera, or --all-cameras";
                Err(no_camera(scene, cure))
            }
            None if names.is_empty() => {
                Err(Failure::usage("--all-cameras: the scene has no `cameras`"))
            }
            None => Ok(names),
        }
    }
}

/// Returns the name of a picture by a camera.
pub(super) fn name_of(name: &str, camera: Option<&str>) -> String {
    camera.map_or_else(|| name.to_owned(), |camera| name.replace(PLACE, camera))
}

/// Returns the scene as one of its `cameras` sees it.
pub(super) fn see_by(scene: Scene, name: &str) -> Result<Scene, Failure> {
    let file = scene.file().to_owned();
    scene.with_camera(name).map_err(|error| {
        let report = FileReport {
            file: &file,
            option: Some("--camera"),
            text: name,
            diagnostics: error.diagnostics(),
            ..FileReport::default()
        };
        scene::print_report(&report, false);
        Failure::Reported
    })
}

fn no_camera(scene: &Scene, cure: &str) -> Failure {
    let names: Vec<_> = scene.cameras().map(|name| format!("`{name}`")).collect();
    let names = names.join(", ");
    Failure::usage(format!("the scene has no `camera`; {cure}: {names}"))
}
