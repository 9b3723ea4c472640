//! Addresses of files.

use std::path::{Path, PathBuf};

use lsp_types::Uri;

/// Returns the path of a file; `None` for what is not one, such as a text without a name.
pub(super) fn path_of(uri: &str) -> Option<PathBuf> {
    let (scheme, rest) = uri.split_once(':')?;
    if !scheme.eq_ignore_ascii_case("file") {
        return None;
    }
    let rest = rest.strip_prefix("//").unwrap_or(rest);
    let rest = rest.split(['?', '#']).next().unwrap_or_default();
    let (host, path) = rest.split_at(rest.find('/')?);
    let path = String::from_utf8(decode(path)).ok()?;
    let path = match host {
        "" | "localhost" => path,
        host if cfg!(windows) => format!("//{host}{path}"),
        _ => return None,
    };
    let path = match path.as_bytes() {
        [b'/', drive, b':', ..] if cfg!(windows) && drive.is_ascii_alphabetic() => {
            path[1..].replace('/', "\\")
        }
        _ => path,
    };
    Some(path.into())
}

fn decode(text: &str) -> Vec<u8> {
    let mut bytes = text.as_bytes().iter();
    let mut decoded = Vec::with_capacity(text.len());
    while let Some(&byte) = bytes.next() {
        let digits = bytes
            .as_slice()
            .get(..2)
            .and_then(|digits| str::from_utf8(digits).ok());
        let escaped = digits.filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
        match escaped.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(value) if byte == b'%' => {
                decoded.push(value);
                bytes.nth(1);
            }
            _ => decoded.push(byte),
        }
    }
    decoded
}

/// Returns the address of a file; `None` if its path is not absolute or not UTF-8.
pub(super) fn of_path(path: &Path) -> Option<Uri> {
    let path = path.is_absolute().then_some(path)?.to_str()?;
    strahl::report::file_uri(path).parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn paths_and_addresses() {
        let path = |uri| path_of(uri).map(|path| path.to_str().unwrap().to_owned());
        assert_eq!(
            path("file:///a%20b/%C3%A9.ron").as_deref(),
            Some("/a b/é.ron")
        );
        assert_eq!(path("file://localhost/a").as_deref(), Some("/a"));
        assert_eq!(path("file:/a%2").as_deref(), Some("/a%2"));
        assert_eq!(path("file:///%ff"), None);
        assert_eq!(path("untitled:Untitled-1"), None);
        assert_eq!(path("file://host/a"), None);
        let uri = of_path(Path::new("/a b/é#%.ron")).unwrap();
        assert_eq!(uri.as_str(), "file:///a%20b/%C3%A9%23%25.ron");
        assert_eq!(path(uri.as_str()).as_deref(), Some("/a b/é#%.ron"));
        assert!(of_path(Path::new("a.ron")).is_none());
    }
}
