//! The page of `--html`: a single self-contained file that shows the differences.

use std::{
    fmt::Write as _,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use strahl::report::escaped;

use super::row::{PicturePair, Shown, Verdict};

/// The maximum number of bytes of pictures, as encoded in the page.
const MOST_BYTES: usize = 64 << 20;

const HEAD: &str = "<!DOCTYPE html>
<html lang=\"en\">
<head>
<meta charset=\"utf-8\">
<meta name=\"viewport\" content=\"width=device-width\">
<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\">
<title>strahl diff</title>
<style>
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; margin: 2rem; }
section { border-top: 1px solid #8888; margin-top: 1.5rem; }
h2 { font-size: 1.1rem; overflow-wrap: anywhere; }
.pictures { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 1rem; }
figure { margin: 0; }
img { width: 100%; image-rendering: pixelated; border: 1px solid #8888; box-sizing: border-box;
  background: repeating-conic-gradient(#8884 0 25%, #8881 0 50%) 0 0 / 16px 16px; }
li { overflow-wrap: anywhere; }
</style>
</head>
<body>
";

/// The page so far.
#[derive(Default)]
pub(super) struct Page {
    body: String,
    bytes: usize,
    left_out: usize,
    /// True once no more pictures will be shown; all threads read it.
    full: Arc<AtomicBool>,
}

impl Page {
    pub(super) fn full(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.full)
    }

    /// Adds a picture that differs. Once one does not fit, no more are shown.
    pub(super) fn add(&mut self, row: &PicturePair, shown: Option<&Shown>) {
        if row.result != Verdict::Different {
            return;
        }
        let name = escaped(&row.name.to_string_lossy());
        let about = escaped(&row.about());
        let _ = write!(
            self.body,
            "<section>\n<h2>{name}</h2>\n<p>{about}</p>\n<div class=\"pictures\">\n"
        );
        let pictures = shown.map_or_else(Vec::new, |shown| {
            let golden = [("golden", &*shown.golden), ("new", &*shown.new)];
            let heat = shown.heat.as_deref().map(|heat| ("heat", heat));
            golden.into_iter().chain(heat).collect()
        });
        let bytes: usize = pictures
            .iter()
            .map(|(_, png)| png.len().div_ceil(3) * 4)
            .sum();
        if self.full.load(Ordering::Relaxed) || self.bytes + bytes > MOST_BYTES {
            self.full.store(true, Ordering::Relaxed);
            self.left_out += 1;
            self.body += "<p>not shown</p>\n";
        } else {
            self.bytes += bytes;
            for (what, png) in pictures.iter().filter(|(_, png)| !png.is_empty()) {
                let _ = write!(
                    self.body,
                    "<figure><figcaption>{what}</figcaption><img alt=\"{what} of {name}\" \
                     src=\"data:image/png;base64,"
                );
                append_base64(png, &mut self.body);
                self.body += "\"></figure>\n";
            }
        }
        self.body += "</div>\n</section>\n";
    }

    /// Returns the whole page.
    pub(super) fn finish(&self, sides: [&Path; 2], rows: &[PicturePair], summary: &str) -> String {
        let [golden, new] = sides.map(|side| escaped(&side.to_string_lossy()));
        let mut page = format!(
            "{HEAD}<h1>{golden} and {new}</h1>\n<p>{}</p>\n",
            escaped(summary)
        );
        if self.left_out > 0 {
            let (count, most) = (self.left_out, MOST_BYTES >> 20);
            let _ = writeln!(
                page,
                "<p>The page holds at most {most} MiB of pictures; the pictures of {count} failures are left out.</p>"
            );
        }
        for kind in [Verdict::Missing, Verdict::Extra, Verdict::Unreadable] {
            let mut rows = rows.iter().filter(|row| row.result == kind).peekable();
            if rows.peek().is_none() {
                continue;
            }
            let _ = write!(page, "<section>\n<h2>{}</h2>\n<ul>\n", kind.name());
            for row in rows {
                let name = escaped(&row.name.to_string_lossy());
                let about = escaped(row.error.as_deref().unwrap_or_default());
                let colon = if about.is_empty() { "" } else { ": " };
                let _ = writeln!(page, "<li>{name}{colon}{about}</li>");
            }
            page += "</ul>\n</section>\n";
        }
        page + &self.body + "</body>\n</html>\n"
    }
}

/// Appends bytes in base64 (RFC 4648).
fn append_base64(bytes: &[u8], text: &mut String) {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    text.reserve(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |at| three.get(at).map_or(0, |byte| u32::from(*byte));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            text.push(if digit > three.len() {
                '='
            } else {
                char::from(DIGITS[(bits >> (18 - 6 * digit)) as usize & 63])
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_rfc() {
        for (bytes, expected) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ] {
            let mut text = String::new();
            append_base64(bytes.as_bytes(), &mut text);
            assert_eq!(text, expected);
        }
    }
}
