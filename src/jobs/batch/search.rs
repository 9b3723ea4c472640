//! Search for the files that paths and folders refer to.

use std::{
    fs, io, mem,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

use ignore::{WalkBuilder, overrides::OverrideBuilder};

use crate::{
    diagnostic::{
        error::{Error, ErrorKind},
        reading::open_file,
    },
    jobs::config::{Configs, are_too_many},
    text::syntax::Syntax,
};

/// A file to check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFile {
    /// The path of the file.
    pub path: PathBuf,
    /// The index of the path whose folder contained the file; `None` if the file itself was named.
    /// A file found in a folder is skipped if it is not a scene.
    pub folder: Option<usize>,
}

/// Returns the files that paths refer to: each file itself, and in each folder every `.ron` and
/// `.json` file, sorted by name.
///
/// In folders, hidden entries are skipped, and entries excluded by a `.gitignore`, a `strahl.toml`
/// or one of the `excluded` patterns. The patterns are those of a `.gitignore`.
///
/// # Errors
///
/// Fails for a malformed pattern, a `strahl.toml` with a fault, a folder that cannot be read, and a
/// folder without any such file. A path that does not exist fails only when it is read.
pub fn find_scenes(
    paths: &[PathBuf],
    excluded: &[String],
    configs: &Configs,
) -> Result<Vec<SceneFile>, Error> {
    let mut files = Vec::new();
    for (index, path) in paths.iter().enumerate() {
        if !path.is_dir() {
            files.push(SceneFile {
                path: path.clone(),
                folder: None,
            });
            continue;
        }
        let before = files.len();
        search(path, index, (excluded, configs), &mut files)?;
        // Sorted by bytes: comparing paths by their components takes longer than finding them.
        let found = files.get_mut(before..).unwrap_or_default();
        found.sort_unstable_by(|one, other| one.path.as_os_str().cmp(other.path.as_os_str()));
        if files.len() == before {
            return Err(no_scene(path));
        }
    }
    Ok(files)
}

/// Returns the error for a folder without scenes.
pub fn no_scene(folder: &Path) -> Error {
    let message = "no scene in this folder, expected .ron or .json files";
    Error::refused(message).at(folder)
}

fn search(
    folder: &Path,
    index: usize,
    (excluded, configs): (&[String], &Configs),
    files: &mut Vec<SceneFile>,
) -> Result<(), Error> {
    let configs = configs.clone();
    let ignored = Mutex::new(IgnoreFiles::above(folder)?);
    let wrong = Arc::new(Mutex::new(Ok(())));
    let first = Arc::clone(&wrong);
    let is_wanted = move |path: &Path, folder_at: Option<usize>| {
        let wanted = configs
            .exclude(path, folder_at.is_some())
            .and_then(|excluded| {
                if let Some(depth) = folder_at.filter(|_| !excluded) {
                    let mut ignored = ignored.lock().unwrap_or_else(PoisonError::into_inner);
                    ignored.enter(path, depth)?;
                }
                Ok(!excluded)
            });
        wanted.unwrap_or_else(|error| {
            let mut first = first.lock().unwrap_or_else(PoisonError::into_inner);
            if first.is_ok() {
                *first = Err(error);
            }
            false
        })
    };
    if are_too_many(excluded.iter().map(String::as_str)) {
        return Err(Error::refused("too many patterns"));
    }
    let mut overrides = OverrideBuilder::new(folder);
    for pattern in excluded {
        // For `ignore`, an override with an exclamation mark excludes.
        overrides.add(&format!("!{pattern}")).map_err(|error| {
            let message = format!("`{pattern}` is not a pattern");
            Error::refused(message).caused_by(error)
        })?;
    }
    let overrides = overrides
        .build()
        .map_err(|error| Error::refused("too many patterns").caused_by(error))?;
    let entries = WalkBuilder::new(folder)
        .overrides(overrides)
        // A .gitignore applies even outside of a repository.
        .require_git(false)
        // A person's settings for other tools do not change the files that are checked.
        .git_global(false)
        .git_exclude(false)
        .ignore(false)
        .filter_entry(move |entry| {
            let is_folder = entry.file_type().is_some_and(|kind| kind.is_dir());
            // The named folder itself is always searched.
            entry.depth() == 0 || is_wanted(entry.path(), is_folder.then(|| entry.depth()))
        })
        .build();
    for entry in entries {
        let entry = entry.map_err(|error| {
            Error::new(ErrorKind::Unreadable, error.to_string()).caused_by(error)
        })?;
        let is_file = entry.file_type().is_some_and(|kind| !kind.is_dir());
        if is_file && Syntax::of_path(entry.path()).is_some() && !is_special(entry.path()) {
            let path = entry.into_path();
            files.push(SceneFile {
                path,
                folder: Some(index),
            });
        }
    }
    let mut wrong = wrong.lock().unwrap_or_else(PoisonError::into_inner);
    mem::replace(&mut *wrong, Ok(()))
}

/// Returns true for a pipe or a device: it cannot be meant by the name of its folder.
fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|about| !about.is_file() && !about.is_dir())
}

/// The sizes of the `.gitignore` files that apply in a folder. `ignore` reads them whole, and their
/// patterns take hundreds of times the memory.
struct IgnoreFiles {
    /// The sizes above the start of the search, and then on the way to the last folder.
    sizes: Vec<u64>,
    /// The number of folders above the first that is found.
    above: usize,
}

impl IgnoreFiles {
    const NAME: &str = ".gitignore";
    /// The maximum size of all that apply in a folder together.
    const MOST: u64 = 256 << 10;

    /// Checks those in a folder and above it.
    fn above(folder: &Path) -> Result<Self, Error> {
        let mut files = Self {
            sizes: Vec::new(),
            above: 0,
        };
        // A folder that cannot be searched has an error of its own.
        let real = folder.canonicalize().unwrap_or_default();
        for folder in real.ancestors() {
            files.enter(folder, 1)?;
            files.above += 1;
        }
        Ok(files)
    }

    /// Checks the one in a folder at this depth of the search, from 1.
    fn enter(&mut self, folder: &Path, depth: usize) -> Result<(), Error> {
        let path = folder.join(Self::NAME);
        let size = match open_file(&path) {
            Ok(file) => file.metadata().map_or(0, |about| about.len()),
            // It does not apply if it cannot be read, as in other programs.
            Err(error) if error.kind() != io::ErrorKind::InvalidInput => 0,
            Err(error) => return Err(Error::unreadable(&path, error)),
        };
        self.sizes.truncate(self.above + depth - 1);
        self.sizes.push(size);
        if self.sizes.iter().sum::<u64>() > Self::MOST {
            let message = "with those above it, it is larger than 256 KiB";
            return Err(Error::new(ErrorKind::Unreadable, message).at(&path));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path, excluded: &[&str]) -> Vec<String> {
        let excluded: Vec<_> = excluded
            .iter()
            .map(|pattern| (*pattern).to_owned())
            .collect();
        let files = find_scenes(&[folder.to_owned()], &excluded, &Configs::none()).unwrap();
        let relative = files.iter().map(|file| {
            assert_eq!(file.folder, Some(0));
            file.path
                .strip_prefix(folder)
                .unwrap()
                .to_str()
                .unwrap()
                .replace('\\', "/")
        });
        relative.collect()
    }

    #[test]
    fn patterns_are_few() {
        let folder = tempfile::tempdir().unwrap();
        let paths = [folder.path().to_owned()];
        for (pattern, count) in [("a", 1001), (&*"a".repeat(70), 1000)] {
            let excluded = vec![pattern.to_owned(); count];
            let found = find_scenes(&paths, &excluded, &Configs::none());
            assert!(found.unwrap_err().to_string().contains("too many patterns"));
        }
    }

    #[test]
    fn folders_are_searched_in_order() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        for file in [
            "b.ron",
            "a.JSON",
            "c.txt",
            ".hidden.ron",
            "sub/d.ron",
            "old/e.ron",
            "f.json",
        ] {
            fs::create_dir_all(folder.join(file).parent().unwrap()).unwrap();
            fs::write(folder.join(file), "").unwrap();
        }
        fs::write(folder.join(".gitignore"), "f.json\n").unwrap();
        assert_eq!(
            names(folder, &[]),
            ["a.JSON", "b.ron", "old/e.ron", "sub/d.ron"]
        );
        assert_eq!(names(folder, &["old", "b.*"]), ["a.JSON", "sub/d.ron"]);
    }

    #[cfg(unix)]
    #[test]
    fn pipes_are_no_scenes_and_no_patterns() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let pipe = |name: &str| {
            let made = std::process::Command::new("mkfifo")
                .arg(folder.join(name))
                .status();
            made.is_ok_and(|status| status.success())
        };
        fs::create_dir_all(folder.join("sub/deep")).unwrap();
        fs::write(folder.join("sub/deep/a.ron"), "").unwrap();
        std::os::unix::fs::symlink("/dev/zero", folder.join("zero.ron")).unwrap();
        if !pipe("x.ron") {
            return;
        }
        assert_eq!(names(folder, &[]), ["sub/deep/a.ron"]);
        let refused = |from: &Path| {
            let found = find_scenes(&[from.to_owned()], &[], &Configs::none());
            found.unwrap_err().to_string()
        };
        let ignore = folder.join("sub/.gitignore");
        std::os::unix::fs::symlink("/dev/zero", &ignore).unwrap();
        assert!(refused(folder).ends_with(".gitignore: is a device, not a file"));
        fs::remove_file(&ignore).unwrap();
        assert!(pipe("sub/.gitignore"));
        for from in [folder, &folder.join("sub"), &folder.join("sub/deep")] {
            assert!(refused(from).contains("sub/.gitignore: is a named pipe"));
        }
        let excluded = find_scenes(&[folder.to_owned()], &["sub".to_owned()], &Configs::none());
        assert!(excluded.unwrap_err().to_string().contains("no scene in"));
    }

    #[test]
    fn patterns_are_bounded_together() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::create_dir_all(folder.join("a/b")).unwrap();
        fs::create_dir_all(folder.join("c")).unwrap();
        fs::write(folder.join("a/b/a.ron"), "").unwrap();
        let write = |place: &str, kibibytes: usize| {
            let text = "# pattern\n".repeat(kibibytes * 1024 / 10);
            fs::write(folder.join(place).join(".gitignore"), text).unwrap();
        };
        // Those of neighbors do not add up.
        write("a", 200);
        write("c", 200);
        assert_eq!(names(folder, &[]), ["a/b/a.ron"]);
        write("a/b", 100);
        for from in [folder, &folder.join("a/b")] {
            let error = find_scenes(&[from.to_owned()], &[], &Configs::none()).unwrap_err();
            assert!(error.to_string().contains("larger than 256 KiB"), "{error}");
        }
    }

    #[test]
    fn a_folder_without_scenes_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let error = find_scenes(&[folder.path().to_owned()], &[], &Configs::none()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
    }

    #[test]
    fn a_named_file_is_read_whatever_its_name() {
        let files = find_scenes(&["x.txt".into()], &[], &Configs::none()).unwrap();
        assert_eq!(
            files,
            [SceneFile {
                path: "x.txt".into(),
                folder: None
            }]
        );
    }
}
