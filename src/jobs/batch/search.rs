//! Which files are meant by paths and folders.

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
    /// Where it is.
    pub path: PathBuf,
    /// Which of the paths is the folder that it was found in; a file that was not named itself
    /// is skipped if it is no scene.
    pub folder: Option<usize>,
}

/// The files that paths mean: each file itself, and in each folder every `.ron` and `.json` file,
/// sorted by name.
///
/// In folders, hidden entries, what a `.gitignore` names and what one of the `excluded` patterns
/// matches are left out, and what a `strahl.toml` excludes. The patterns are those of a `.gitignore`.
///
/// # Errors
///
/// A malformed pattern, a `strahl.toml` in which something is wrong, a folder that cannot be read, and a folder without any such file. What a
/// path that does not exist is, reading it will tell.
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
        // By bytes: to compare paths by their components takes longer than to find them.
        let found = files.get_mut(before..).unwrap_or_default();
        found.sort_unstable_by(|one, other| one.path.as_os_str().cmp(other.path.as_os_str()));
        if files.len() == before {
            return Err(no_scene(path));
        }
    }
    Ok(files)
}

/// The error of a folder in which there is no scene.
pub fn no_scene(folder: &Path) -> Error {
    let message = "there is no scene in this folder, expected files .ron or .json";
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
        // To `ignore` a pattern with an exclamation mark is one that leaves out.
        overrides.add(&format!("!{pattern}")).map_err(|error| {
            let message = format!("`{pattern}` is not a pattern");
            Error::new(ErrorKind::Usage, message).caused_by(error)
        })?;
    }
    let overrides = overrides.build().map_err(|error| {
        Error::new(ErrorKind::Usage, "the patterns are too many").caused_by(error)
    })?;
    let entries = WalkBuilder::new(folder)
        .overrides(overrides)
        // A .gitignore counts whether or not there is a repository around it.
        .require_git(false)
        // What a person has configured for other tools does not change what is checked.
        .git_global(false)
        .git_exclude(false)
        .ignore(false)
        .filter_entry(move |entry| {
            let is_folder = entry.file_type().is_some_and(|kind| kind.is_dir());
            // The folder that was named is searched in any case.
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
    fn a_named_file_is_taken_whatever_it_is_called() {
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
