//! Search for the files that paths and folders refer to.

use std::{
    mem,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

use ignore::{WalkBuilder, overrides::OverrideBuilder};

use crate::{
    diagnostic::error::{Error, ErrorKind},
    jobs::config::Configs,
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
    Error::new(ErrorKind::Usage, message).at(folder)
}

fn search(
    folder: &Path,
    index: usize,
    (excluded, configs): (&[String], &Configs),
    files: &mut Vec<SceneFile>,
) -> Result<(), Error> {
    let configs = configs.clone();
    let wrong = Arc::new(Mutex::new(Ok(())));
    let first = Arc::clone(&wrong);
    let is_wanted = move |path: &Path, is_folder| match configs.exclude(path, is_folder) {
        Ok(excluded) => !excluded,
        Err(error) => {
            let mut first = first.lock().unwrap_or_else(PoisonError::into_inner);
            if first.is_ok() {
                *first = Err(error);
            }
            false
        }
    };
    let mut overrides = OverrideBuilder::new(folder);
    for pattern in excluded {
        // For `ignore`, an override with an exclamation mark excludes.
        overrides.add(&format!("!{pattern}")).map_err(|error| {
            let message = format!("`{pattern}` is not a pattern");
            Error::new(ErrorKind::Usage, message).caused_by(error)
        })?;
    }
    let overrides = overrides
        .build()
        .map_err(|error| Error::new(ErrorKind::Usage, "too many patterns").caused_by(error))?;
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
            entry.depth() == 0 || is_wanted(entry.path(), is_folder)
        })
        .build();
    for entry in entries {
        let entry = entry.map_err(|error| {
            Error::new(ErrorKind::Unreadable, error.to_string()).caused_by(error)
        })?;
        let is_file = entry.file_type().is_some_and(|kind| !kind.is_dir());
        if is_file && Syntax::of_path(entry.path()).is_some() {
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

#[cfg(test)]
mod tests {
    use std::fs;

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
