//! `--depfile`: the files that a scene depends on, as a rule for make and ninja.
//!
//! The escapes are those that GNU make 4.3 reads as the same name, on either side of a rule. Of
//! these, ninja 1.11 knows the ones of a blank, `#`, `$` and `:`.

use std::{
    io::{self, Write},
    iter,
    path::{Component, Path, PathBuf},
    slice,
};

use strahl::{image_file::write_file, parallel::Cancel};

use super::{failure::Failure, paths::is_dash};

/// The rule that files depend on sources, as text.
pub(super) struct Rule(Vec<u8>);

/// The side of a rule.
#[derive(Clone, Copy)]
enum Side {
    Target,
    Source,
}

impl Rule {
    /// Creates the rule, and an empty one for each source, so that make does not fail when a source is
    /// removed together with the last mention of it. Rejects names that make cannot read.
    pub(super) fn new(targets: &[PathBuf], sources: &[PathBuf]) -> Result<Self, Failure> {
        let names = |names: &[PathBuf], side| -> Result<Vec<_>, Failure> {
            names.iter().map(|name| escaped(name, side)).collect()
        };
        let mut text = names(targets, Side::Target)?.join(&b" \\\n"[..]);
        text.push(b':');
        for source in names(sources, Side::Source)? {
            text.extend([b" \\\n  ", &*source].concat());
        }
        text.push(b'\n');
        for source in names(sources, Side::Target)? {
            text.extend([b"\n", &*source, b":\n"].concat());
        }
        Ok(Self(text))
    }

    /// Writes the rule to a file or to standard output.
    pub(super) fn write(&self, path: &Path, cancel: &Cancel) -> Result<(), Failure> {
        if is_dash(path) {
            let mut stdout = io::stdout().lock();
            let written = stdout.write_all(&self.0);
            return written
                .and_then(|()| stdout.flush())
                .map_err(Failure::stdout);
        }
        Ok(write_file(path, &self.0, cancel)?)
    }
}

/// Returns a name as make reads it.
fn escaped(path: &Path, side: Side) -> Result<Vec<u8>, Failure> {
    if let Some(why) = why_unreadable(path) {
        let message = format!("--depfile: make cannot read the name {path:?}: {why}");
        return Err(Failure::usage(message));
    }
    let mut text = Vec::new();
    let mut backslashes = 0;
    for byte in path.as_os_str().as_encoded_bytes() {
        let (escape, is_quoted): (&[u8], _) = match (byte, side) {
            (b' ', _) => (b"\\ ", true),
            (b'#', _) => (b"\\#", true),
            (b':', _) => (b"\\:", true),
            (b'*', _) => (b"\\*", true),
            (b'?', _) => (b"\\?", true),
            (b'[', _) => (b"\\[", true),
            (b'%', Side::Target) => (b"\\%", true),
            (b'|', Side::Source) => (b"\\|", true),
            // make looks for a recipe again in the expanded line.
            (b';', _) => (b"$(or \\;)", true),
            // A line with a plain one would set a variable.
            (b'=', _) => (b"$(or =)", false),
            (b'$', _) => (b"$$", false),
            (other, _) => (slice::from_ref(other), false),
        };
        // Before a quoted character, a backslash would quote as well.
        let doubled = if is_quoted { backslashes } else { 0 };
        text.extend(iter::repeat_n(b'\\', doubled));
        text.extend_from_slice(escape);
        backslashes = if *byte == b'\\' { backslashes + 1 } else { 0 };
    }
    Ok(text)
}

/// Returns the reason why make cannot read a name, however it is written.
fn why_unreadable(path: &Path) -> Option<String> {
    let name = path.as_os_str().as_encoded_bytes();
    let mut parts = path.components();
    let first = parts.find(|part| *part != Component::CurDir)?;
    let first = first.as_os_str().as_encoded_bytes();
    if let Some(control) = name.iter().find(|byte| byte.is_ascii_control()) {
        let control = char::from(*control);
        return Some(format!("it has the control character {control:?}"));
    }
    match (first, name) {
        ([b'~', ..], _) => Some("`~` at its start is a home folder".to_owned()),
        (_, [.., b'\\']) => Some("it ends with `\\`".to_owned()),
        (_, [.., b'&']) => Some("it ends with `&`".to_owned()),
        (_, [.., b')']) if name.contains(&b'(') => {
            Some("with brackets at its end it is a member of an archive".to_owned())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(targets: &[&str], sources: &[&str]) -> String {
        let paths = |names: &[&str]| -> Vec<_> { names.iter().map(PathBuf::from).collect() };
        let rule = Rule::new(&paths(targets), &paths(sources)).unwrap();
        String::from_utf8(rule.0).unwrap()
    }

    #[test]
    fn names_are_escaped() {
        let expected = "out.png: \\\n  a\\ b.ron \\\n  c\\#$$.csv \\\n  50%.ron\n\
            \na\\ b.ron:\n\nc\\#$$.csv:\n\n50\\%.ron:\n";
        assert_eq!(
            text(&["out.png"], &["a b.ron", "c#$.csv", "50%.ron"]),
            expected
        );
        assert_eq!(
            text(&["%.png", "a=|b.png"], &["a|b"]),
            "\\%.png \\\na$(or =)|b.png: \\\n  a\\|b\n\na|b:\n"
        );
        let backslashes = r"a\b\ \\:\%\=";
        assert_eq!(
            text(&[backslashes], &[]),
            format!("{}:\n", r"a\b\\\ \\\\\:\\\%\$(or =)")
        );
    }

    #[test]
    fn names_that_make_cannot_read_are_refused() {
        for (name, word) in [
            ("a\nb.png", "'\\n'"),
            ("a\tb.png", "'\\t'"),
            ("./~/a.png", "`~`"),
            ("~me", "`~`"),
            ("a\\", "`\\`"),
            ("a&", "`&`"),
            ("a(1)", "archive"),
        ] {
            let why = why_unreadable(Path::new(name)).unwrap();
            assert!(why.contains(word), "{name:?}: {why}");
            assert!(Rule::new(&[], &[name.into()]).is_err());
        }
        for name in ["a(1).png", "a~", "a&b", "./a", "/~"] {
            assert_eq!(why_unreadable(Path::new(name)), None, "{name}");
        }
    }
}
