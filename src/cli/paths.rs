//! The paths given to a command: files, and folders to search.

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use strahl::{Error, diagnostic::open_file};

use super::{bounded, failure::Failure};

/// The maximum size of a list of paths, in MiB.
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
    pub(super) files_from: Option<PathBuf>,
    /// Skip files and folders that match a pattern, as in a .gitignore
    #[arg(long, value_name = "GLOB")]
    pub(super) exclude: Vec<String>,
    /// List skipped files that are not scenes
    #[arg(long)]
    pub(super) verbose: bool,
}

impl PathArgs {
    /// Returns all paths that were named, in order.
    pub(super) fn all(&self) -> Result<Vec<PathBuf>, Failure> {
        let mut paths = self.paths.clone();
        if let Some(list) = &self.files_from {
            paths.extend(read_list(list)?);
        }
        Ok(paths)
    }

    /// Returns true if standard input is among the paths, or lists them.
    pub(super) fn names_stdin(&self) -> bool {
        let mut all = self.paths.iter().chain(&self.files_from);
        all.any(|path| is_dash(path))
    }

    /// Prints the name of a skipped file, if requested.
    pub(super) fn skip(&self, path: &Path) {
        if self.verbose {
            let reason = Error::reading_failed(path, io::Error::other("not a scene"));
            // Whoever closed standard error does not want the message.
            let _ = writeln!(io::stderr(), "skipped: {reason}");
        }
    }

    /// Returns the path, if a single file was named.
    pub(super) fn single(&self) -> Option<&Path> {
        match &*self.paths {
            [path] if self.files_from.is_none() && !path.is_dir() => Some(path),
            _ => None,
        }
    }
}

/// Returns true if a path is `-`, which means standard input or output.
pub(super) fn is_dash(path: &Path) -> bool {
    path == Path::new("-")
}

/// Returns true if two paths lead to the same existing file or folder.
pub(super) fn is_same(one: &Path, other: &Path) -> bool {
    matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}

fn read_list(list: &Path) -> Result<Vec<PathBuf>, Failure> {
    let text = if is_dash(list) {
        bounded::read(io::stdin(), LONGEST_LIST)
    } else {
        open_file(list).and_then(|file| bounded::read(file, LONGEST_LIST))
    };
    let text = text.and_then(|text| io::read_to_string(&*text));
    let text = text.map_err(|error| Error::reading_failed(list, error))?;
    let lines = text.lines().filter(|line| !line.is_empty());
    Ok(lines.map(PathBuf::from).collect())
}
