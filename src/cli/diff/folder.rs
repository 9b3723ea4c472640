//! Comparison of two folders: pictures are paired by name.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    sync::atomic::Ordering,
    time::Instant,
};

use strahl::{Error, ImageFormat, compare::CompareOptions, parallel::in_order};

use super::{
    super::failure::Failure,
    args::Args,
    results::Results,
    row::{Images, PicturePair, Shown, Verdict, compare, same_bytes},
};

/// The extensions of pictures that are read but not written.
const READ_ALONE: [&str; 3] = ["pgm", "pbm", "pnm"];

/// True for each of the two folders that contains a picture.
type Sides = [bool; 2];

/// All pictures in two folders by their relative names, and the number of other files.
#[derive(Default)]
pub(super) struct Pairs {
    pictures: BTreeMap<PathBuf, Sides>,
    pub(super) skipped: u64,
}

impl Pairs {
    pub(super) fn find(args: &Args) -> Result<Self, Failure> {
        let mut pairs = Self::default();
        for (side, folder) in [&args.a, &args.b].into_iter().enumerate() {
            // The first pictures are accepted into a folder that does not exist yet.
            if side == 1 || folder.exists() {
                pairs.search(folder, side)?;
            }
        }
        if pairs.pictures.is_empty() {
            let (a, b) = (args.a.display(), args.b.display());
            return Err(Failure::usage(format!("no pictures in {a} or {b}")));
        }
        Ok(pairs)
    }

    /// Adds the pictures in a folder. Hidden entries and links to folders are skipped.
    fn search(&mut self, root: &Path, side: usize) -> Result<(), Error> {
        let mut folders = vec![PathBuf::new()];
        while let Some(below) = folders.pop() {
            let folder = root.join(&below);
            let unreadable = |error| Error::reading_failed(&folder, error);
            for entry in fs::read_dir(&folder).map_err(unreadable)? {
                let entry = entry.map_err(unreadable)?;
                let name = below.join(entry.file_name());
                if entry.file_name().as_encoded_bytes().starts_with(b".") {
                    continue;
                }
                if entry.file_type().map_err(unreadable)?.is_dir() {
                    folders.push(name);
                } else if is_picture(&name) && may_be_file(&entry.path()) {
                    self.pictures.entry(name).or_default()[side] = true;
                } else {
                    self.skipped += 1;
                }
            }
        }
        Ok(())
    }

    /// Compares all pairs on all threads, each pair on one.
    pub(super) fn compare(
        &self,
        args: &Args,
        options: &CompareOptions,
        results: &mut Results,
    ) -> Result<(), Failure> {
        let threads = args.threads.count();
        let of_one = if self.pictures.len() == 1 { threads } else { 1 };
        let options = options.clone().threads(of_one);
        let full = results.page_is_full();
        in_order(
            &self.pictures,
            threads,
            16,
            |(name, sides)| {
                let pictures = args.html.is_some() && !full.load(Ordering::Relaxed);
                let heat = args.output.is_some();
                one(args, &options, (name, *sides), Images { heat, pictures })
            },
            |(row, shown)| results.take(row, shown),
        )
    }
}

/// Returns true if a path leads to a file, or to nothing, which is reported when it is read.
fn may_be_file(path: &Path) -> bool {
    fs::metadata(path).map_or(true, |found| found.is_file())
}

fn is_picture(path: &Path) -> bool {
    ImageFormat::of_path(path).is_ok()
        || path.extension().is_some_and(|ending| {
            let mut all = READ_ALONE.iter();
            all.any(|known| ending.eq_ignore_ascii_case(known))
        })
}

fn one(
    args: &Args,
    options: &CompareOptions,
    (name, sides): (&Path, Sides),
    images: Images,
) -> (PicturePair, Option<Shown>) {
    let start = Instant::now();
    let (a, b) = (args.a.join(name), args.b.join(name));
    let (row, shown) = match sides {
        [true, false] => (PicturePair::new(name, Verdict::Missing), None),
        [false, _] => (PicturePair::new(name, Verdict::Extra), None),
        [true, true] if same_bytes(&a, &b).unwrap_or_default() => {
            (PicturePair::new(name, Verdict::Equal), None)
        }
        [true, true] => match compare([&a, &b], args, options, images) {
            Ok((report, shown)) => (PicturePair::compared(name, report), shown),
            Err(error) => (PicturePair::unreadable(name, &error), None),
        },
    };
    let time = start.elapsed();
    (PicturePair { time, ..row }, shown)
}
