//! Completion of files.

use super::{Completion, CompletionKind, schema_type::Type};
use crate::scene::options::ReadOptions;

/// The number of files that are offered.
const MOST: usize = 1000;

/// Returns the tables or parts, and the folders with more of them, that a scene may name; `typed` is
/// the path so far, and `value` the type of the field.
pub(super) fn files(typed: &str, value: Type, options: &ReadOptions) -> Vec<Completion> {
    let Some(files) = options.tables() else {
        return Vec::new();
    };
    let folder = typed.rfind('/').map_or("", |end| &typed[..=end]);
    let mut listed = files.list(folder);
    listed.retain(|(name, is_folder)| {
        !name.starts_with('.') && (*is_folder || value.is_ending_of(name))
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
