//! File names as URI references (RFC 3986, RFC 8089).

use std::fmt::Write as _;

/// Converts a file name. A relative name stays relative: readers of the log know its base.
///
/// Standard input has no URI; its name becomes `%3Cstdin%3E`, which viewers show as `<stdin>`. With
/// `windows`, a backslash is a separator and a drive or a share may come first. A name need not be
/// UTF-8.
pub(in crate::report) fn of_bytes(file: &[u8], windows: bool) -> String {
    let slashed: Vec<_> = file
        .iter()
        .map(|byte| {
            if windows && *byte == b'\\' {
                b'/'
            } else {
                *byte
            }
        })
        .collect();
    let mut uri = String::with_capacity(slashed.len());
    let path = match &*slashed {
        [b'/', b'/', share @ ..] if windows => {
            uri.push_str("file://");
            share
        }
        // `C:name` is relative to a folder that no URI can name.
        [letter, b':', path @ ..]
            if windows && letter.is_ascii_alphabetic() && path.starts_with(b"/") =>
        {
            uri.push_str("file:///");
            uri.extend([char::from(*letter), ':']);
            path
        }
        [b'/', ..] => {
            uri.push_str("file://");
            &slashed
        }
        _ => {
            let mut path = &*slashed;
            while let Some(rest) = path.strip_prefix(b"./") {
                let slashes = rest.iter().take_while(|byte| **byte == b'/').count();
                path = rest.get(slashes..).unwrap_or_default();
            }
            path
        }
    };
    for byte in path.iter().copied() {
        // A colon is escaped too: in the first segment it would end a scheme.
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            // Writing to a string cannot fail.
            let _ = write!(uri, "%{byte:02X}");
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::of_bytes;

    fn of_file(file: &str, windows: bool) -> String {
        of_bytes(file.as_bytes(), windows)
    }

    #[test]
    fn relative_names() {
        assert_eq!(of_file("scenes/a b.ron", false), "scenes/a%20b.ron");
        assert_eq!(of_file("./a.ron", false), "a.ron");
        assert_eq!(of_file("../日.ron", false), "../%E6%97%A5.ron");
        assert_eq!(of_file("a:b%#?.ron", false), "a%3Ab%25%23%3F.ron");
        assert_eq!(of_file("a\\b.ron", false), "a%5Cb.ron");
        assert_eq!(of_file("a\\b.ron", true), "a/b.ron");
        assert_eq!(of_file("<stdin>", false), "%3Cstdin%3E");
    }

    #[test]
    fn names_that_are_not_text() {
        assert_eq!(of_bytes(b"caf\xe9/a.ron", false), "caf%E9/a.ron");
        assert_eq!(of_bytes(b"/\xff", false), "file:///%FF");
    }

    #[test]
    fn absolute_names() {
        assert_eq!(of_file("/home/a b.ron", false), "file:///home/a%20b.ron");
        assert_eq!(of_file("C:\\s\\a.ron", true), "file:///C:/s/a.ron");
        assert_eq!(of_file("C:\\s\\a.ron", false), "C%3A%5Cs%5Ca.ron");
        assert_eq!(
            of_file("\\\\host\\share\\a.ron", true),
            "file://host/share/a.ron"
        );
    }
}
