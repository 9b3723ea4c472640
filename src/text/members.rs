//! The names of the arrays in NPZ files of `NumPy`, which are zip archives.

use std::collections::HashSet;

/// Returns the first name that several arrays of an archive have, of which a reader would keep only
/// one. `start` is the place of its list of files.
pub(crate) fn repeated(file: &[u8], start: u64) -> Option<String> {
    // PKWARE, .ZIP File Format Specification, section 4.3.12.
    const HEADER: usize = 46;
    let mut names = HashSet::new();
    let mut rest = file.get(usize::try_from(start).ok()?..)?;
    loop {
        let (header, after) = rest.split_at_checked(HEADER)?;
        if !header.starts_with(b"PK\x01\x02") {
            return None;
        }
        let length = |at: usize| usize::from(u16::from_le_bytes([header[at], header[at + 1]]));
        let (name, after) = after.split_at_checked(length(28))?;
        let name = name.strip_suffix(b".npy").unwrap_or(name);
        if !names.insert(name) {
            return Some(String::from_utf8_lossy(name).into_owned());
        }
        rest = after.get(length(30) + length(32)..)?;
    }
}
