//! The paths that a command is given: files, and folders that are searched.

use std::{
    fs::File,
    io::{self, Read, Write},
    path::{Path, PathBuf},
};

use strahl::Error;

use super::{Failure, bounded::Bounded};

/// The longest list of paths, in MiB.
const LONGEST_LIST: u64 = 64;

/// The scenes that a command works on.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct PathArgs {
    /// Scene files, folders with .ron and .json files, or `-` for standard input
    #[arg(value_name = "PATH", required_unless_present = "files_from")]
    pub(super) paths: Vec<PathBuf>,
    /// Read more paths from a file, one per line; `-` is standard input
    #[arg(long, value_name = "FILE")]
    files_from: Option<PathBuf>,
    /// Skip files and folders that match a pattern, as in a .gitignore
    #[arg(long, value_name = "GLOB")]
    pub(super) exclude: Vec<String>,
    /// List skipped files that are not scenes
    #[arg(long)]
    pub(super) verbose: bool,
}

impl PathArgs {
    /// All paths that were named, in their order.
    pub(super) fn all(&self) -> Result<Vec<PathBuf>, Failure> {
        let mut paths = self.paths.clone();
        if let Some(list) = &self.files_from {
            paths.extend(read_list(list)?);
        }
        Ok(paths)
    }

    /// Names a file that is skipped, if that is wanted.
    pub(super) fn skip(&self, path: &Path) {
        if self.verbose {
            let reason = Error::reading_failed(path, io::Error::other("not a scene"));
            // Who has closed standard error does not want to know.
            let _ = writeln!(io::stderr(), "skipped: {reason}");
        }
    }

    /// The one file that was named, if it is one.
    pub(super) fn single(&self) -> Option<&Path> {
        match &*self.paths {
            [path] if self.files_from.is_none() && !path.is_dir() => Some(path),
            _ => None,
        }
    }
}

/// Whether a path is `-`, which stands for standard input or output.
pub(super) fn is_dash(path: &Path) -> bool {
    path == Path::new("-")
}

/// The folder of a file, `.` for a bare name.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// The text of a list.
fn read(list: impl Read) -> io::Result<String> {
    io::read_to_string(Bounded::mebibytes(list, LONGEST_LIST))
}

fn read_list(list: &Path) -> Result<Vec<PathBuf>, Failure> {
    let text = if is_dash(list) {
        read(io::stdin())
    } else {
        File::open(list).and_then(read)
    };
    let text = text.map_err(|error| Error::reading_failed(list, error))?;
    let lines = text.lines().filter(|line| !line.is_empty());
    Ok(lines.map(PathBuf::from).collect())
}
