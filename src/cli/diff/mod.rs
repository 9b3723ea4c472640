//! `strahl diff`: comparison of two pictures or of the pictures in two folders.

mod args;
mod folder;
mod limits;
mod page;
mod pair;
mod results;
mod row;

use std::{path::Path, time::Instant};

use strahl::{ImageFormat, compare::CompareOptions};

pub(crate) use args::Args;

use self::{
    folder::Pairs,
    results::Results,
    row::{Images, PicturePair, compare},
};
use super::{failure::Failure, interrupt, paths::is_same};

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let cancel = interrupt::cancel_on_signal();
    let options = CompareOptions::new()
        .threads(args.threads.count())
        .cancel(cancel.clone());
    let of_folders = args.b.is_dir();
    check(&args, of_folders)?;
    let mut results = Results::new(&args, &cancel, of_folders);
    if of_folders {
        let pairs = Pairs::find(&args)?;
        pairs.compare(&args, &options, &mut results)?;
        return results.finish(pairs.skipped);
    }
    let start = Instant::now();
    let sides = [&*args.a, &*args.b];
    let plain = match &args.output {
        Some(heat) => options.clone().heat(heat),
        None => options.clone(),
    };
    let (report, _) = compare(sides, &args, &plain, Images::default())?;
    let images = Images {
        heat: false,
        pictures: args.html.is_some(),
    };
    let shown = match !report.failed.is_empty() && images.pictures {
        true => compare(sides, &args, &options, images)?.1,
        false => None,
    };
    let row = PicturePair::compared(&args.b, report);
    let time = start.elapsed();
    results.take(PicturePair { time, ..row }, shown)?;
    results.finish(0)
}

/// Rejects impossible arguments before anything is read.
fn check(args: &Args, of_folders: bool) -> Result<(), Failure> {
    let refuse = |path: &Path, why: &str| Err(Failure::refused(path, why));
    if let Some(html) = &args.html {
        let ending = html.extension().unwrap_or_default();
        if !["html", "htm"]
            .iter()
            .any(|known| ending.eq_ignore_ascii_case(known))
        {
            return refuse(html, "the name of the page has to end with .html");
        }
    }
    if !of_folders {
        if args.a.is_dir() {
            return refuse(&args.b, "is not a folder, so compare it with a picture");
        }
        if args.update && ImageFormat::of_path(&args.a).ok() != ImageFormat::of_path(&args.b).ok() {
            return refuse(&args.a, "cannot be updated by a picture of another format");
        }
        return args
            .output
            .as_ref()
            .map_or(Ok(()), |heat| check_output(heat, args));
    }
    if args.a.is_file() || !(args.a.exists() || args.update) {
        return refuse(
            &args.a,
            "is not a folder, but the other path is; `--update` creates it",
        );
    }
    match &args.output {
        Some(heat) if heat.is_file() => refuse(heat, "is a file, not a folder for heat pictures"),
        Some(heat) if [&args.a, &args.b].iter().any(|side| is_within(heat, side)) => refuse(
            heat,
            "the heat pictures would be among the compared pictures",
        ),
        _ => Ok(()),
    }
}

/// Returns true if a folder, which need not exist, is another one or lies in it.
fn is_within(inner: &Path, outer: &Path) -> bool {
    let mut above = inner.ancestors().map(|folder| {
        if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        }
    });
    let inner = above.find_map(|folder| folder.canonicalize().ok());
    match (inner, outer.canonicalize()) {
        (Some(inner), Ok(outer)) => inner.starts_with(outer),
        _ => false,
    }
}

/// Rejects an impossible heat picture before anything is read.
fn check_output(heat: &Path, args: &Args) -> Result<(), Failure> {
    if heat.is_dir() {
        return Err(Failure::refused(heat, "is a folder, not a file"));
    }
    ImageFormat::of_path(heat)?;
    if [&args.a, &args.b].iter().any(|side| is_same(heat, side)) {
        let why = "the heat picture would overwrite one of the compared pictures";
        return Err(Failure::refused(heat, why));
    }
    Ok(())
}
