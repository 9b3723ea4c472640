//! File names as URI references (RFC 3986, RFC 8089).

use std::fmt::Write as _;

/// Converts a file name. A relative name stays relative: readers of the log know its base.
///
/// Standard input has no URI; its name becomes `%3Cstdin%3E`, which viewers show as `<stdin>`. With
/// `windows`, a backslash is a separator and a drive or a share may come first.
pub(in crate::report) fn of_file(file: &str, windows: bool) -> String {
    let slashed = if windows {
        file.replace('\\', "/")
    } else {
        file.to_owned()
    };
    let mut uri = String::with_capacity(slashed.len());
    let path = if let Some(share) = slashed.strip_prefix("//").filter(|_| windows) {
        uri.push_str("file://");
        share
    } else if windows && has_drive(&slashed) {
        let (drive, path) = slashed.split_at(2);
        uri.push_str("file:///");
        uri.push_str(drive);
        path
    } else if slashed.starts_with('/') {
        uri.push_str("file://");
        &slashed
    } else {
        let mut path = slashed.as_str();
        while let Some(rest) = path.strip_prefix("./") {
            path = rest.trim_start_matches('/');
        }
        path
    };
    for byte in path.bytes() {
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

/// Returns true if a name starts with `C:/`. `C:name` is relative to a folder that no URI can name.
fn has_drive(file: &str) -> bool {
    matches!(file.as_bytes(), [letter, b':', b'/', ..] if letter.is_ascii_alphabetic())
}

#[cfg(test)]
mod tests {
    use super::of_file;

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
