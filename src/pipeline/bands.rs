//! One picture rendered by several processes: each renders a band of it, and one joins the bands.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use crate::{
    diagnostic::{
        error::{Error, ErrorKind},
        reading::folder_of,
    },
    film::crop::Crop,
    image_file::{ImageFormat, part, target::Target},
    jobs::shard::{BAND, Shard},
    parallel::timings::Stage,
    pipeline::{Scene, options::RenderOptions},
    render::layers::Layer,
};

impl Scene {
    /// Renders a band of the picture that [`Scene::save_with`] would write to `path`, and returns
    /// true if anything was rendered.
    ///
    /// The band goes to a file next to `path`, such as `out.png.0-of-4.part`, or to several if each
    /// layer has a file of its own. [`Scene::merge`] joins bands from several processes. A band
    /// that already exists is kept unless `again` is set.
    ///
    /// # Errors
    ///
    /// Those of [`Scene::save_with`].
    pub fn save_band(
        &self,
        path: impl AsRef<Path>,
        shard: Shard,
        options: &RenderOptions,
        again: bool,
    ) -> Result<bool, Error> {
        let path = path.as_ref();
        let format = options.format_of(path)?;
        let title = title(&self.hash(path, options)?, shard);
        let mut is_drawn = false;
        for (path, layers) in self.checked_files(path, options)? {
            let part = shard.file(&path);
            if again || !part::is_whole(&part, &title) {
                self.draw_band(&part, &title, (format, &layers), shard, options)
                    .map_err(|error| error.at(&part))?;
                is_drawn = true;
            }
        }
        Ok(is_drawn)
    }

    fn draw_band(
        &self,
        part: &Path,
        title: &str,
        (format, layers): (ImageFormat, &[Layer]),
        shard: Shard,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        let watch = options.timings.watch();
        let mut target = Target::create(part, &options.cancel)?;
        match self.band(shard, options)? {
            Some(band) => {
                let options = options.clone().crop(band);
                self.with_rows(format, layers, &options, &watch, |_, draw| {
                    watch.time(Stage::Encode, || part::write(target.output(), title, draw))
                })?;
            }
            // There are more shards than rows.
            None => part::write(target.output(), title, |_| Ok(()))?,
        }
        watch.time(Stage::Write, || target.finish())
    }

    /// Returns the rows of a shard, or `None` if it has none.
    fn band(&self, shard: Shard, options: &RenderOptions) -> Result<Option<Crop>, Error> {
        let crop = self.crop(options)?;
        let rows = shard.rows(crop.size().height());
        if rows.is_empty() {
            return Ok(None);
        }
        let (top, width) = (crop.row() + rows.start, crop.size().width());
        let band = Crop::new(crop.column(), top, width, rows.end - rows.start);
        let refused = |error: &dyn ToString| Error::refused(error.to_string());
        band.map(Some).map_err(|error| refused(&error))
    }

    /// Joins the bands of a picture to the file that [`Scene::save_with`] would have written.
    ///
    /// The bands must come from [`Scene::save_band`] with the same scene and the same options.
    /// Returns the paths of the band files, which are no longer needed.
    ///
    /// # Errors
    ///
    /// Missing or damaged bands and bands of another scene or other options
    /// ([`ErrorKind::Incomplete`]), and the errors of [`Scene::save_with`].
    pub fn merge(
        &self,
        path: impl AsRef<Path>,
        options: &RenderOptions,
    ) -> Result<Vec<PathBuf>, Error> {
        let hash = self.hash(path.as_ref(), options)?;
        let files = self.checked_files(path.as_ref(), options)?;
        let parts: Result<Vec<_>, _> = files
            .iter()
            .map(|(path, _)| find_parts(path, &hash))
            .collect();
        let parts = parts?;
        for ((path, layers), parts) in files.iter().zip(&parts) {
            self.join(path, layers, parts, options)
                .map_err(|error| error.at(path))?;
        }
        Ok(parts.concat())
    }

    fn join(
        &self,
        path: &Path,
        layers: &[Layer],
        parts: &[PathBuf],
        options: &RenderOptions,
    ) -> Result<(), Error> {
        let format = options.format_of(path)?;
        let watch = options.timings.watch();
        let mut target = Target::create(path, &options.cancel)?;
        self.with_rows(format, layers, options, &watch, |form, _| {
            let pixels = usize::try_from(form.size.pixels()).unwrap_or(usize::MAX);
            format.encode(target.output(), form, &mut |sink| {
                let mut left = pixels.saturating_mul(form.pixel.bytes());
                parts.iter().try_for_each(|part| {
                    options.cancel.check()?;
                    part::read(part, &mut left, sink)
                })
            })
        })?;
        target.finish()
    }
}

/// Returns the first line of a band file.
fn title(hash: &str, shard: Shard) -> String {
    format!("strahl part 1 {shard} {hash}")
}

/// Returns the band files of a picture, from top to bottom.
fn find_parts(path: &Path, hash: &str) -> Result<Vec<PathBuf>, Error> {
    let incomplete = |message: String| Error::new(ErrorKind::Incomplete, message).at(path);
    let folder = folder_of(path);
    let entries = fs::read_dir(folder).map_err(|error| Error::unreadable(folder, error))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut counts: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    for entry in entries.flatten() {
        let found = entry.file_name();
        let found = found.to_string_lossy();
        let middle = found
            .strip_prefix(&*name)
            .and_then(|rest| rest.strip_prefix('.'));
        let middle = middle.and_then(|rest| rest.strip_suffix(BAND));
        let shard = middle.and_then(|middle| middle.replacen("-of-", "/", 1).parse::<Shard>().ok());
        if let Some(shard) = shard {
            let found = counts.entry(shard.count()).or_default();
            found.insert(shard.index());
        }
    }
    // If there are bands of several splits, the most complete split counts.
    let most = counts
        .into_iter()
        .max_by_key(|(count, found)| found.len() as u64 * 1000 / u64::from(*count));
    let Some((count, found)) = most else {
        let message =
            "there are no bands of this picture; `strahl render --shard I/N` renders them";
        return Err(incomplete(message.to_owned()));
    };
    let shard = |index: &u32| Shard::new(*index, count).ok();
    // A file name can claim up to four billion shards.
    let absent = (0..count).filter(|index| !found.contains(index));
    let absent: Vec<_> = absent.take(MOST_NAMED).collect();
    let missing = absent
        .iter()
        .filter_map(shard)
        .map(|shard| shard.to_string());
    let missing = shortened(missing.collect(), count as usize - found.len());
    let (mut parts, mut wrong) = (Vec::new(), Vec::new());
    for shard in found.iter().filter_map(shard) {
        let part = shard.file(path);
        if part::is_whole(&part, &title(hash, shard)) {
            parts.push(part);
        } else {
            wrong.push(shard.to_string());
        }
    }
    let count = wrong.len();
    let wrong = shortened(wrong, count);
    let lists = [
        ("missing", missing),
        ("damaged, or of another scene or other options", wrong),
    ];
    let lists = lists.into_iter().filter(|(_, shards)| !shards.is_empty());
    let problems: Vec<_> = lists
        .map(|(what, shards)| format!("{what}: {shards}"))
        .collect();
    if problems.is_empty() {
        Ok(parts)
    } else {
        Err(incomplete(format!(
            "not all bands are there; {}",
            problems.join("; ")
        )))
    }
}

/// Maximum number of shards that a message lists.
const MOST_NAMED: usize = 10;

/// Joins the first entries of a list with `count` entries.
fn shortened(mut first: Vec<String>, count: usize) -> String {
    first.truncate(MOST_NAMED);
    let shown = first.join(", ");
    match count.saturating_sub(first.len()) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}
