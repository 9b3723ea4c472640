//! `strahl legend`: the color bar of a table's values.

use std::path::{Path, PathBuf};

use strahl::{Scene, Size, image_file::write_file, parallel::Cancel, render::Legend};

use super::{
    Failure,
    frame::FrameArgs,
    paths::is_dash,
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
    /// Write the legend to a file: .svg, or any image format by its ending
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Geometry with `color_by`, by its name or its index in the scene, or the part with it; required
    /// where several have one
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
    if is_dash(output) {
        return Err(Failure::usage(
            "a legend is written to a file: `-o legend.png` or `-o legend.svg`",
        ));
    }
    let is_svg = output
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
    if !is_svg {
        strahl::ImageFormat::of_path(output)?;
    }
    let document = args.input.read(0, false)?;
    let scene = args.frame.of(Scene::try_from(document)?)?;
    let legend = legend(&scene, &args)?;
    let no_room = |error| Failure::refused(output, error);
    if is_svg {
        let svg = legend.svg().map_err(no_room)?;
        write_file(output, svg.as_bytes(), &Cancel::new())?;
    } else {
        legend.image().map_err(no_room)?.save(output)?;
    }
    report_written(Path::new(output), "", false);
    Ok(())
}

/// Returns the legend of the geometry that is meant.
fn legend(scene: &Scene, args: &Args) -> Result<Legend, Failure> {
    let tables: Vec<_> = scene.color_values().collect();
    let named: Vec<_> = tables
        .iter()
        .map(
            |table| match table.part.as_ref().map_or(table.name, |part| part.name) {
                Some(name) => format!("{name:?}"),
                None if table.origin.in_groups.is_empty() => table.origin.geometry.to_string(),
                None => table.origin.to_string(),
            },
        )
        .collect();
    let list = named.join(", ");
    let wanted = args.geometry.as_deref();
    let all: Vec<_> = match wanted {
        Some(wanted) => tables
            .iter()
            .filter(|table| is_wanted(table, wanted))
            .collect(),
        None => tables.iter().collect(),
    };
    let table = match (wanted, all.as_slice()) {
        _ if tables.is_empty() => {
            return Err(Failure::refused(
                &args.input.scene.scene,
                "no geometry has colors by value; give one `color_by: (column: \"…\")`",
            ));
        }
        (_, [table]) => *table,
        (Some(wanted), []) => {
            return Err(Failure::usage(format!(
                "geometry `{wanted}` has no colors by value; those that have: {list}"
            )));
        }
        _ => {
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

fn is_wanted(table: &strahl::scene::ColorValues<'_>, wanted: &str) -> bool {
    let inner = table.part.as_ref().and_then(|part| part.name);
    let origin = &table.origin;
    let is_index = origin.in_groups.is_empty() && wanted.parse() == Ok(origin.geometry);
    table.name == Some(wanted) || inner == Some(wanted) || is_index || wanted == origin.to_string()
}
