//! Which of a scene's cameras are used, and the pictures that they make.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

use strahl::{Scene, report::Suppressed};

use super::{Failure, scene};

/// What stands in the name of a file for that of a camera.
const PLACE: &str = "{camera}";

/// The camera that a command uses.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct CameraArgs {
    /// One of the scene's `cameras`, by its name, instead of its `camera`
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
}

impl CameraArgs {
    /// The scene as the camera sees it.
    pub(super) fn of(&self, scene: Scene) -> Result<Scene, Failure> {
        match &self.camera {
            Some(name) => see_by(scene, name),
            None if scene.has_camera() => Ok(scene),
            None => Err(no_camera(&scene, "choose one of its `cameras` by --camera")),
        }
    }
}

/// The cameras that a command uses.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct CamerasArgs {
    #[command(flatten)]
    one: CameraArgs,
    /// Draw a picture by each of the scene's `cameras`; `{camera}` in FILE stands for its name
    #[arg(long, conflicts_with = "camera")]
    all_cameras: bool,
}

impl CamerasArgs {
    /// What stands behind the name of the scene in that of a picture, where nobody gives one.
    pub(super) fn default_ending(&self) -> &'static str {
        if self.all_cameras {
            "_{camera}.png"
        } else {
            ".png"
        }
    }

    /// Refuses a target that several pictures would go to.
    pub(super) fn check(&self, target: &Path) -> Result<(), Failure> {
        let has_place = target.to_str().is_some_and(|name| name.contains(PLACE));
        if self.all_cameras && !has_place {
            return Err(Failure::Usage(format!(
                "{}: --all-cameras makes several pictures; write {PLACE} where the name of the \
                 camera is to stand",
                target.display()
            )));
        }
        Ok(())
    }

    /// The names of the cameras that draw; `None` is the one without a name.
    pub(super) fn names(&self, scene: &Scene) -> Result<Vec<Option<String>>, Failure> {
        let names: Vec<_> = scene.cameras().map(|name| Some(name.to_owned())).collect();
        match &self.one.camera {
            Some(name) => Ok(vec![Some(name.clone())]),
            None if !self.all_cameras && scene.has_camera() => Ok(vec![None]),
            None if !self.all_cameras => {
                let cure = "choose one of its `cameras` by --camera, or --all-cameras";
                Err(no_camera(scene, cure))
            }
            None if names.is_empty() => {
                let message = "--all-cameras: the scene has no `cameras`";
                Err(Failure::Usage(message.to_owned()))
            }
            None => Ok(names),
        }
    }
}

/// The file of a picture by a camera.
pub(super) fn file_of(pattern: &Path, camera: Option<&str>) -> PathBuf {
    match (pattern.to_str(), camera) {
        (Some(text), Some(camera)) => text.replace(PLACE, camera).into(),
        _ => pattern.to_owned(),
    }
}

/// Refuses files of which two are the same.
pub(super) fn check_files(files: &[PathBuf]) -> Result<(), Failure> {
    let mut seen = HashMap::new();
    for file in files {
        let place = file.canonicalize().unwrap_or_else(|_| file.clone());
        if let Some(first) = seen.insert(place, file) {
            return Err(Failure::Usage(format!(
                "{} and {} are the same file: each picture needs its own",
                first.display(),
                file.display()
            )));
        }
    }
    Ok(())
}

/// The scene as one of its `cameras` sees it.
pub(super) fn see_by(scene: Scene, name: &str) -> Result<Scene, Failure> {
    scene.with_camera(name).map_err(|error| {
        scene::print_report("--camera", name, error.diagnostics(), Suppressed::default());
        Failure::Reported
    })
}

fn no_camera(scene: &Scene, cure: &str) -> Failure {
    let names: Vec<_> = scene.cameras().map(|name| format!("`{name}`")).collect();
    let names = names.join(", ");
    Failure::Usage(format!("the scene has no `camera`; {cure}: {names}"))
}
