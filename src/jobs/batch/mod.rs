//! Checking many files at once, with results in order.

pub(crate) mod search;

use crate::{
    diagnostic::error::Error,
    jobs::batch::search::SceneFile,
    parallel::in_order,
    scene::{document::Document, options::ReadOptions},
};

/// The maximum number of files read ahead of the one that is reported: enough to keep all cores
/// busy, few enough to bound memory.
const AT_ONCE: usize = 256;

/// The result for a file.
#[derive(Debug)]
pub enum Checked {
    /// A file that was read; the document holds its faults.
    Document(SceneFile, Document),
    /// A file that could not be read; the document reports that too.
    Unreadable(Document, Error),
    /// A file found in a folder that has none of the fields of a scene.
    Skipped(SceneFile),
}

/// Checks files on `threads` threads, 0 for all cores, and passes the results on in order. The
/// documents do not hold their tables, as many at once might not fit into memory.
///
/// # Errors
///
/// Returns the error of `each`, after which no more files are read.
pub fn check_files<E: From<Error>>(
    files: &[SceneFile],
    options: &ReadOptions,
    threads: usize,
    each: impl FnMut(Checked) -> Result<(), E>,
) -> Result<(), E> {
    // Many files already keep the threads busy, so no file is split among them.
    let each_with = if files.len() == 1 {
        threads
    } else {
        threads.min(1)
    };
    let options = options.clone().threads(each_with);
    let check = |file| check(file, &options);
    in_order(files, threads, AT_ONCE, check, each)
}

fn check(file: &SceneFile, options: &ReadOptions) -> Checked {
    let mut read = Document::from_path_with(&file.path, options);
    if let Ok(document) = &mut read {
        document.forget_tables();
    }
    match read {
        Ok(document) if file.folder.is_some() && document.is_no_scene() => {
            Checked::Skipped(file.clone())
        }
        Ok(document) => Checked::Document(file.clone(), document),
        Err(error) => Checked::Unreadable(Document::unreadable(&file.path, &error), error),
    }
}
