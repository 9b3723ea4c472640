//! Completion of files.

use super::{Completion, CompletionKind};
use crate::scene::options::ReadOptions;

/// The number of files that are offered.
const MOST: usize = 1000;

/// Returns the tables or parts, and the folders with more of them, that a scene may name; `typed` is
/// the path so far, and `endings` are those of their names.
pub(super) fn files(typed: &str, endings: &[&str], options: &ReadOptions) -> Vec<Completion> {
    let Some(files) = options.tables() else {
        return Vec::new();
    };
    let folder = typed.rfind('/').map_or("", |end| &typed[..=end]);
    let mut listed = files.list(folder);
    listed.retain(|(name, is_folder)| {
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
        let is_known = endings
            .iter()
            .any(|known| known.eq_ignore_ascii_case(ending));
        !name.starts_with('.') && (*is_folder || is_known)
    });
    listed.sort_by(|one, other| (one.1, &one.0).cmp(&(other.1, &other.0)));
    let items = listed.into_iter().take(MOST).map(|(name, is_folder)| {
        let slash = if is_folder { "/" } else { "" };
        let label = format!("{folder}{name}{slash}");
        Completion {
            insert: format!("{label:?}"),
            label,
            kind: match is_folder {
                true => CompletionKind::Folder,
                false => CompletionKind::File,
            },
            detail: String::new(),
            docs: String::new(),
        }
    });
    items.collect()
}
