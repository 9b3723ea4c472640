//! `--fit`: a camera that frames the scene.

use strahl::{ReadOptions, scene::format::FitModel};

/// The camera that frames a scene.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct FitArgs {
    /// Frame all bounded geometries, seen from this direction, instead of the place of the camera;
    /// default: 1,0.6,1. A scene needs no camera for this; it keeps its projection
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_parser = direction,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "1,0.6,1",
        allow_hyphen_values = true
    )]
    fit: Option<[f64; 3]>,
}

impl FitArgs {
    /// Adds it to the options for reading scenes.
    pub(super) fn of(&self, options: ReadOptions) -> ReadOptions {
        match self.fit {
            Some(from) => options.fit(from),
            None => options,
        }
    }
}

fn direction(text: &str) -> Result<[f64; 3], String> {
    let bare = text.trim();
    let bare = bare
        .strip_prefix('(')
        .and_then(|bare| bare.strip_suffix(')'))
        .unwrap_or(bare);
    let numbers: Option<Vec<f64>> = bare
        .split(',')
        .map(|number| number.trim().parse().ok())
        .collect();
    let direction = numbers.and_then(|numbers| numbers.try_into().ok());
    direction.filter(FitModel::is_direction).ok_or_else(|| {
        "expected a direction of three numbers, not all 0, such as 1,0.6,1".to_owned()
    })
}
