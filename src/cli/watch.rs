//! `strahl watch`: a picture that is drawn again after each change of its scene.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use crate::cli::render::{args::DrawArgs, sampling::SamplingArgs};

use super::{
    cameras::CameraArgs,
    failure::Failure,
    frame::FrameArgs,
    paths::is_dash,
    render::one::{Order, Plan},
    rounds::{Round, Rounds, WAITING, print_line},
    scene,
};

/// Render a scene again after each change of it, its tables or its parts
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The scene file, .ron or .json
    scene: PathBuf,
    #[command(flatten, next_help_heading = "Scene")]
    camera: CameraArgs,
    #[command(flatten, next_help_heading = "Scene")]
    frame: FrameArgs,
    /// The picture; the file extension selects the format. Default: the scene's name with .png, in the
    /// current folder. While the scene has errors, the last picture stays
    #[arg(help_heading = "Output", short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    draw: DrawArgs,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let plan = plan(args)?;
    let rounds = Rounds::new()?;
    let mut is_first = true;
    loop {
        let round = rounds.next();
        let failure = match draw(args, &plan, &rounds, &round) {
            // It was begun with outdated files.
            Err(_) if round.cancel.is_cancelled() => continue,
            Err(failure) => failure,
            Ok(()) => {
                is_first = false;
                continue;
            }
        };
        // An edit does not mend a wrong command.
        if matches!(failure, Failure::Closed { .. }) || is_first && failure.status() == 2 {
            return Err(failure);
        }
        is_first = false;
        failure.print();
        if !args.draw.quiet {
            print_line(WAITING)?;
        }
    }
}

fn plan(args: &Args) -> Result<Plan<'_>, Failure> {
    if is_dash(&args.scene) {
        let message = "standard input cannot be watched; write the scene to a file";
        return Err(Failure::usage(message));
    }
    if args.scene.is_dir() {
        let why = "is a folder; name a scene, or check all of them with `strahl validate --watch`";
        return Err(Failure::refused(&args.scene, why));
    }
    if args.output.as_deref().is_some_and(is_dash) {
        let message = "a picture that is drawn again needs a file; name one with -o";
        return Err(Failure::usage(message));
    }
    let plan = Plan::new(Order {
        draw: &args.draw,
        source: &args.scene,
        output: args.output.as_deref(),
        image_format: None,
        camera: args.camera.name(),
        frames: None,
        shard: None,
        resume: false,
        sampling: SamplingArgs::default(),
        report: None,
        depfile: None,
    })?;
    if plan.is_movie() && args.frame.number().is_some() {
        return Err(Failure::usage("--frame is for pictures, not for movies"));
    }
    Ok(plan)
}

/// Draws the picture, unless a file that it is made from changes.
fn draw(args: &Args, plan: &Plan, rounds: &Rounds, round: &Round) -> Result<(), Failure> {
    let start = Instant::now();
    let configs = args.draw.config.configs();
    let settings = configs.files(&args.scene);
    rounds.watch(settings.into_iter().chain([args.scene.clone()]))?;
    scene::forget_printed();
    let document = args.draw.read(&args.scene, &configs, |options| {
        options.files(rounds.files()).cancel(round.cancel.clone())
    })?;
    scene::report(&document, args.draw.quiet)?;
    let view = |scene| args.frame.of(args.camera.of(scene)?);
    let drawn = plan.draw(document, view, &round.cancel)?;
    if !args.draw.quiet {
        let time = start.elapsed().as_secs_f64();
        for file in &drawn.files {
            print_line(&written(file, &drawn.extent, time))?;
        }
    }
    drawn.print_timings(&args.draw, start);
    Ok(())
}

fn written(file: &Path, extent: &str, seconds: f64) -> String {
    format!("wrote {} ({extent}) in {seconds:.3} s", file.display())
}
