//! Files large enough to be read in blocks give the same results as texts.

use std::fs;

use strahl::{Document, Syntax};

/// A scene larger than one mebibyte.
fn scene(syntax: Syntax) -> String {
    let geometry = |index: u32| match syntax {
        Syntax::Ron => format!("Sphere(center: ({index}, 0.5, 0), radius: 1, color: \"#fff\")"),
        _ => format!(
            "{{\"Sphere\": {{\"center\": [{index}, 0.5, 0], \"radius\": 1, \"color\": \"#fff\"}}}}"
        ),
    };
    let geometries: Vec<_> = (0..20_000).map(geometry).collect();
    let geometries = geometries.join(",\n");
    match syntax {
        Syntax::Ron => format!(
            "(camera: Perspective(eye: (0, 0, -9), gaze: (0, 0, 1), fov: 60), geometries: [\n{geometries}\n], \
             background: \"#012\")\n"
        ),
        _ => format!(
            "{{\"camera\": {{\"Perspective\": {{\"eye\": [0, 0, -9], \"gaze\": [0, 0, 1], \"fov\": 60}}}}, \
             \"geometries\": [\n{geometries}\n], \"background\": \"#012\"}}\n"
        ),
    }
}

#[test]
fn a_large_file_is_checked_like_its_text() {
    let folder = tempfile::tempdir().unwrap();
    for syntax in [Syntax::Ron, Syntax::Json] {
        let valid = scene(syntax);
        assert!(valid.len() > 1 << 20);
        let path = folder.path().join("large").with_extension(syntax.name());
        let name = path.display().to_string();
        let fault = |place: &str, by: &str| {
            let at = valid.find(place).unwrap();
            format!("{}{by}{}", &valid[..at], &valid[at + place.len()..])
        };
        let texts = [
            valid.clone(),
            format!("\u{feff}{valid}"),
            // Far from the start: inside the list, and after it.
            fault("15000", "15000, 3"),
            fault("15000", "1e999"),
            fault("15000", "14999"),
            fault("15000", "1\u{0}"),
            fault("\"#012\"", "\"#01\""),
            fault("background", "backgruond"),
            format!("{valid} x"),
            valid[..valid.len() - 3].to_owned(),
            // The whole scene is in the first part of the file, and more follows.
            format!("{}{}", empty(syntax), " ".repeat(1 << 20)),
            format!("{}{}x", empty(syntax), " ".repeat(1 << 20)),
        ];
        for (index, text) in texts.into_iter().enumerate() {
            fs::write(&path, &text).unwrap();
            let read = Document::from_path(&path).unwrap();
            let expected = Document::from_reader(&name, text.as_bytes(), &options(syntax)).unwrap();
            assert_eq!(
                read.diagnostics(),
                expected.diagnostics(),
                "{syntax:?}, text {index}"
            );
            assert!(read.text() == expected.text());
            assert_eq!(
                read.diagnostics().is_empty(),
                index < 2,
                "{syntax:?}, text {index}"
            );
        }
    }
}

fn options(syntax: Syntax) -> strahl::ReadOptions {
    strahl::ReadOptions::new().syntax(syntax)
}

fn empty(syntax: Syntax) -> &'static str {
    match syntax {
        Syntax::Ron => {
            "(camera: Perspective(eye: (0, 0, -9), gaze: (0, 0, 1), fov: 60), geometries: [])"
        }
        _ => {
            "{\"camera\": {\"Perspective\": {\"eye\": [0, 0, -9], \"gaze\": [0, 0, 1], \"fov\": 60}}, \"geometries\": []}"
        }
    }
}
