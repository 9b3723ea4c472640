//! `--depfile`: the files that a scene depends on, as a rule for make and ninja.

use std::{
    fmt::Write,
    path::{Path, PathBuf},
};

use strahl::{image_file::write_file, parallel::Cancel};

use super::{Failure, paths::is_dash};

/// Writes a file with the rule that `target` depends on `sources`.
pub(super) fn write(
    path: &Path,
    target: &Path,
    sources: &[PathBuf],
    cancel: &Cancel,
) -> Result<(), Failure> {
    let text = rule(target, sources);
    if is_dash(path) {
        return super::print(&text);
    }
    Ok(write_file(path, text.as_bytes(), cancel)?)
}

/// Returns the rule, and an empty one for each source, so that make does not fail when a source is
/// removed together with the last mention of it.
fn rule(target: &Path, sources: &[PathBuf]) -> String {
    let sources: Vec<_> = sources.iter().map(|source| escaped(source)).collect();
    let mut text = format!("{}:", escaped(target).replace('%', "\\%"));
    for source in &sources {
        // Writing to a string never fails.
        let _ = write!(text, " \\\n  {source}");
    }
    text.push('\n');
    for source in &sources {
        let _ = write!(text, "\n{}:\n", source.replace('%', "\\%"));
    }
    text
}

/// Returns a path as make reads it.
fn escaped(path: &Path) -> String {
    let mut text = String::new();
    for character in path.to_string_lossy().chars() {
        match character {
            ' ' | '#' => text.push('\\'),
            '$' => text.push('$'),
            _ => {}
        }
        text.push(character);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped() {
        let sources = ["a b.ron", "c#$.csv", "50%.ron"].map(PathBuf::from);
        let expected = "out.png: \\\n  a\\ b.ron \\\n  c\\#$$.csv \\\n  50%.ron\n\
            \na\\ b.ron:\n\nc\\#$$.csv:\n\n50\\%.ron:\n";
        assert_eq!(rule(Path::new("out.png"), &sources), expected);
        assert_eq!(rule(Path::new("%.png"), &[]), "\\%.png:\n");
    }
}
