//! Many files at once, in their order.

pub(crate) mod search;

use crate::{
    diagnostic::error::Error,
    jobs::batch::search::SceneFile,
    parallel::in_order,
    scene::{document::Document, options::ReadOptions},
};

/// How many files are read ahead of the one that is reported: enough to keep all cores busy, few
/// enough that memory stays flat.
const AT_ONCE: usize = 256;

/// What became of a file.
#[derive(Debug)]
pub enum Checked {
    /// It was read; what is wrong with it stands in the document.
    Document(SceneFile, Document),
    /// It could not be read; the document says so as well.
    Unreadable(Document, Error),
    /// It was found in a folder, and none of the fields of a scene stands in it.
    Skipped(SceneFile),
}

/// Checks files on `threads` threads, 0 for all cores, and hands them over in their order. The
/// documents do not hold their tables, which many at once may have no room for.
///
/// # Errors
///
/// What `each` returns, after which no more files are read.
pub fn check_files<E: From<Error>>(
    files: &[SceneFile],
    options: &ReadOptions,
    threads: usize,
    each: impl FnMut(Checked) -> Result<(), E>,
) -> Result<(), E> {
    // Those who have enough to do with many files do not share one.
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
