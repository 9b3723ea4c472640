//! `strahl render --report`: the visible geometries and their places, by the numbers of the id
//! layer.

use std::{
    fmt::{self, Write},
    io,
    path::{Path, PathBuf},
};

use serde::Serialize;
use strahl::{
    Error, RenderOptions, Scene, Size,
    diagnostic::{folder_of, is_named_pipe},
    film::Crop,
    image_file::write_file,
    parallel::Cancel,
    render::Seen,
    scene::Origin,
    text::Stamp,
};

use super::{failure::Failure, paths::is_dash};

/// A geometry of the world, and its place in the scene.
#[derive(Clone, Serialize)]
pub(super) struct GeometryPlace<'a> {
    /// The index in the world, which is the value in the id layer.
    id: usize,
    #[serde(flatten)]
    listed: Listed<'a>,
    #[serde(skip_serializing_if = "InParts::is_empty")]
    parts: InParts<'a>,
}

impl<'a> GeometryPlace<'a> {
    pub(super) fn new(scene: &'a Scene, id: usize) -> Self {
        Self {
            id,
            listed: Listed {
                origin: scene.origin(id),
                name: scene.name(id),
                groups: scene.groups(id),
            },
            parts: InParts::new(scene, id),
        }
    }
}

/// The place of a geometry in the lists of a file.
#[derive(Clone, Serialize)]
struct Listed<'a> {
    #[serde(flatten)]
    origin: Origin,
    /// The name.
    name: Option<&'a str>,
    /// The names of the groups that hold it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    groups: Vec<&'a str>,
}

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.origin.fmt(f)?;
        write_names(f, self.name, &self.groups)
    }
}

/// Writes the name of a geometry and those of the groups that hold it, the innermost first.
pub(super) fn write_names(
    f: &mut fmt::Formatter<'_>,
    name: Option<&str>,
    groups: &[&str],
) -> fmt::Result {
    name.map_or(Ok(()), |name| write!(f, " {name:?}"))?;
    let mut groups = groups.iter().rev();
    groups.try_for_each(|group| write!(f, " in {group:?}"))
}

/// The places of a geometry in the files of the parts that hold it.
#[derive(Clone, Serialize)]
#[serde(transparent)]
pub(super) struct InParts<'a>(Vec<InPart<'a>>);

#[derive(Clone, Serialize)]
struct InPart<'a> {
    /// The path of the file from the current folder.
    file: &'a str,
    #[serde(flatten)]
    listed: Listed<'a>,
}

impl<'a> InParts<'a> {
    pub(super) fn new(scene: &'a Scene, id: usize) -> Self {
        let places = scene.places_in_parts(id).into_iter();
        let places = places.map(|place| InPart {
            file: place.file,
            listed: Listed {
                origin: place.origin,
                name: place.name,
                groups: place.groups,
            },
        });
        Self(places.collect())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl fmt::Display for InParts<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for place in &self.0 {
            write!(f, ", {:?} {}", place.file, place.listed)?;
        }
        Ok(())
    }
}

impl fmt::Display for GeometryPlace<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.listed.fmt(f)?;
        self.parts.fmt(f)
    }
}

/// The picture that a report describes.
#[derive(Serialize)]
pub(super) struct ImageTerms<'a> {
    #[serde(flatten)]
    size: Size,
    /// The column, row, width and height of the drawn part, if it is not the whole picture.
    crop: Option<[u32; 4]>,
    /// The name of the camera, if it has one.
    camera: Option<&'a str>,
    /// The number of paths of a pixel, if light follows paths.
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<u32>,
}

impl<'a> ImageTerms<'a> {
    pub(super) fn new(size: Size, crop: Option<Crop>, camera: Option<&'a str>) -> Self {
        Self {
            size,
            crop: crop.map(|crop| {
                let size = crop.size();
                [crop.column(), crop.row(), size.width(), size.height()]
            }),
            camera,
            samples: None,
        }
    }

    /// Adds the number of paths of a pixel.
    pub(super) fn by_paths(self, samples: Option<u32>) -> Self {
        Self { samples, ..self }
    }
}

#[derive(Serialize)]
struct SeenTerms<'a> {
    #[serde(flatten)]
    place: GeometryPlace<'a>,
    pixels: u64,
    #[serde(rename = "box")]
    bounds: [u32; 4],
    depth: [f64; 2],
}

/// Returns the report on a picture: each visible geometry on its own line, in the order of ids.
fn text(scene: &Scene, image: &ImageTerms, seen: &[Seen]) -> serde_json::Result<String> {
    let image = serde_json::to_string(image)?;
    let mut text = format!(
        "{{\n  {},\n  \"format\": 1,\n  \"image\": {image},\n  \"geometries\": [",
        Stamp::Report
    );
    for (index, seen) in seen.iter().enumerate() {
        let geometry = serde_json::to_string(&SeenTerms {
            place: GeometryPlace::new(scene, seen.id),
            pixels: seen.pixels,
            bounds: seen.bounds,
            depth: [seen.nearest, seen.farthest],
        })?;
        let comma = if index == 0 { "" } else { "," };
        // Writing to a string never fails.
        let _ = write!(text, "{comma}\n    {geometry}");
    }
    text.push_str(if seen.is_empty() {
        "]\n}\n"
    } else {
        "\n  ]\n}\n"
    });
    Ok(text)
}

/// Traces the centers of all pixels once more and writes the report on them.
pub(super) fn write(
    path: &Path,
    scene: &Scene,
    image: &ImageTerms,
    options: &RenderOptions,
    cancel: &Cancel,
) -> Result<(), Failure> {
    let seen = scene.seen(options)?;
    write_text(path, &text(scene, image, &seen)?, cancel)
}

/// Writes a report to its destination.
pub(super) fn write_text(path: &Path, text: &str, cancel: &Cancel) -> Result<(), Failure> {
    if is_dash(path) {
        return super::output::print(text);
    }
    Ok(write_file(path, text.as_bytes(), cancel)?)
}

/// Rejects a place where no report can be, or where one of the files in use is.
pub(super) fn check(report: &Path, used: &[PathBuf]) -> Result<(), Failure> {
    let refused = |error| Failure::Library(Error::writing_failed(report, error));
    if is_dash(report) {
        return Ok(());
    }
    if report.is_dir() {
        return Err(refused(io::ErrorKind::IsADirectory.into()));
    }
    if is_named_pipe(report) {
        let message = "is a named pipe, which may never get a reader; use a file or `>(…)`";
        return Err(refused(io::Error::other(message)));
    }
    let place = real(report).map_err(refused)?;
    let is_there = |other: &&PathBuf| real(other).is_ok_and(|other| other == place);
    used.iter().rfind(is_there).map_or(Ok(()), |other| {
        let message = format!("the report would overwrite {other:?}");
        Err(refused(io::Error::other(message)))
    })
}

/// Returns the place of a file without links; the file need not exist.
fn real(path: &Path) -> io::Result<PathBuf> {
    if let Ok(found) = path.canonicalize() {
        return Ok(found);
    }
    let folder = folder_of(path);
    Ok(folder
        .canonicalize()?
        .join(path.file_name().unwrap_or_default()))
}
