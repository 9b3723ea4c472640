//! `strahl legend`: the color bar of a table's values.

use std::{
    io,
    path::{Path, PathBuf},
};

use strahl::{
    Error, ImageFormat, Scene, Size,
    image_file::write_file,
    parallel::Cancel,
    render::Legend,
    scene::{ColorValues, Origin},
};

use super::{
    failure::{Failure, STDOUT},
    frame::FrameArgs,
    paths::is_dash,
    render::one,
    scene::{InputArgs, report_written},
};

/// Draw the color bar of a table's values
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    frame: FrameArgs,
    /// Write the legend to a file: .svg, or a format of 8-bit colors by its ending; `-` for PNG on
    /// standard output
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Geometry with `color_by`, by its name or its index in the scene; one in a part by `PART.NAME`.
    /// Required where several have one
    #[arg(long, value_name = "NAME|INDEX")]
    geometry: Option<String>,
    /// Label above the bar; default: the name of the column
    #[arg(long, value_name = "TEXT")]
    label: Option<String>,
    /// Size of the legend in pixels; default: a bar of 320 pixels and room for its text
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Draw the bar from left to right
    #[arg(long)]
    horizontal: bool,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let output = &args.output;
    let form = form_of(output)?;
    let document = args.input.read(0, false)?;
    one::check_sources(output, &one::sources(&document, &args.input.scene.scene))?;
    let scene = args.frame.of(Scene::try_from(document)?)?;
    let legend = legend(&scene, &args)?;
    let at = |error: Error| error.of_file(output);
    match form {
        Form::Stream => {
            let written = legend.image()?.write(io::stdout().lock(), ImageFormat::PNG);
            return Ok(written.map_err(|error| error.of_file(STDOUT))?);
        }
        Form::Svg => {
            let svg = legend.svg().map_err(at)?;
            write_file(output, svg.as_bytes(), &Cancel::new())?;
        }
        Form::Picture => legend.image().map_err(at)?.save(output)?,
    }
    report_written(Path::new(output), "", false);
    Ok(())
}

/// What a legend is written as.
enum Form {
    /// PNG to standard output.
    Stream,
    Svg,
    Picture,
}

/// Returns the form of a file by its name; rejects an impossible one before anything is read.
fn form_of(output: &Path) -> Result<Form, Failure> {
    if is_dash(output) {
        one::check_stream("legend")?;
        return Ok(Form::Stream);
    }
    let ending = output.extension().map(|ending| ending.to_string_lossy());
    let ending = ending.as_deref().unwrap_or_default();
    if ending.eq_ignore_ascii_case("svg") {
        return Ok(Form::Svg);
    }
    if ImageFormat::of_ending(ending).is_some_and(ImageFormat::has_rgb8) {
        return Ok(Form::Picture);
    }
    let can = ImageFormat::list(ImageFormat::has_rgb8);
    let message = format!("a legend is a file of svg, {can}, or `-` for PNG on standard output");
    Err(Failure::refused(output, message))
}

/// Returns the legend of the geometry that is meant.
fn legend(scene: &Scene, args: &Args) -> Result<Legend, Failure> {
    let tables: Vec<_> = scene.color_values().collect();
    let wanted = args.geometry.as_deref();
    let is_wanted = |table: &&ColorValues| {
        wanted.is_none_or(|wanted| names(table).iter().any(|name| name == wanted))
    };
    let found: Vec<_> = tables.iter().filter(is_wanted).collect();
    let table = match (wanted, found.as_slice()) {
        _ if tables.is_empty() => {
            return Err(Failure::refused(
                &args.input.scene.scene,
                "no geometry has colors by value; give one `color_by: (column: \"…\")`",
            ));
        }
        (_, [table]) => *table,
        (Some(wanted), []) => {
            let list = list(&tables, &tables);
            return Err(Failure::usage(format!(
                "geometry `{wanted}` has no colors by value; those that have: {list}"
            )));
        }
        _ => {
            let found: Vec<_> = found.into_iter().cloned().collect();
            let list = list(&found, &tables);
            return Err(Failure::usage(format!(
                "several geometries have colors by value; choose one by `--geometry`: {list}"
            )));
        }
    };
    let scale = table.scale;
    let range = scale.range.ok_or_else(|| {
        Failure::usage(format!(
            "column `{}` has no finite number; give `color_by` a `range`",
            scale.column
        ))
    })?;
    let label = args.label.as_deref().unwrap_or(&scale.column);
    let legend = Legend::new(scale.map.clone(), range)
        .label(label)
        .horizontal(args.horizontal)
        .size(args.size);
    Ok(match table.missing {
        0 => legend,
        _ => legend.missing(scale.missing),
    })
}

/// Returns what a table may be called, the shortest first: its name or its index; in a part also what
/// the part is called, a point, and what the table is called there.
fn names(table: &ColorValues) -> Vec<String> {
    let called = |name: Option<&str>, origin: &Origin| {
        let index = match origin.in_groups.is_empty() {
            true => origin.geometry.to_string(),
            false => origin.to_string(),
        };
        let path = origin.to_string();
        name.map(str::to_owned)
            .into_iter()
            .chain([index, path])
            .collect::<Vec<_>>()
    };
    let outer = called(table.name, &table.origin);
    let Some(part) = &table.part else {
        return outer;
    };
    let inner = called(part.name, &part.origin);
    let both = outer
        .iter()
        .flat_map(|outer| inner.iter().map(move |inner| format!("{outer}.{inner}")));
    let both: Vec<_> = both.collect();
    let name = part.name.map(str::to_owned);
    name.into_iter().chain(both).chain(outer).collect()
}

/// Lists what some of the tables are called so that no other is meant.
fn list(some: &[ColorValues], all: &[ColorValues]) -> String {
    let shown = some.iter().map(|table| {
        let mut names = names(table).into_iter();
        let is_alone = |name: &String| {
            let others = all.iter().filter(|other| self::names(other).contains(name));
            others.count() == 1
        };
        let name = names.find(is_alone);
        format!("`{}`", name.unwrap_or_else(|| table.origin.to_string()))
    });
    shown.collect::<Vec<_>>().join(", ")
}
