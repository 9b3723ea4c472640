//! The published JSON Schema: up to date, and consistent with the loader.

use std::{env, fs, path::Path};

use jsonschema::Validator;
use serde_json::Value;
use strahl::{
    Document, Syntax,
    diagnostic::{Code, Severity},
};

const PUBLISHED: &str = "schemas/scene.schema.json";

/// Codes that a schema cannot detect, with the reason; it rejects every case of all other codes.
const BEYOND_A_SCHEMA: &[(Code, &str)] = &[
    (Code::Syntax, "a text that is no JSON never reaches it"),
    (Code::Unreadable, "nor does a file that cannot be read"),
    (
        Code::DuplicateField,
        "to a schema the later key has replaced the first",
    ),
    (
        Code::NotFinite,
        "1e999 has become infinite or an error before",
    ),
    (Code::DuplicateName, "it does not compare values"),
    (Code::UnknownName, "it does not compare values"),
    (Code::ParallelVectors, "it does not compare values"),
    (Code::UnsortedKeys, "it does not compare values"),
    (Code::FileNotFound, "it opens no file"),
    (Code::InvalidMesh, "it opens no file"),
    (Code::InvalidImage, "it opens no file"),
    (Code::MissingUv, "it does not resolve materials"),
    (Code::OutsideFolder, "it follows no path"),
    (Code::InvalidTable, "it opens no table"),
    (Code::CannotFit, "it does not know what is bounded"),
    (Code::PartRing, "it opens no part"),
];

/// Single cases that it cannot detect, of codes that it usually detects.
const BEYOND_A_SCHEMA_CASES: &[(&str, &str)] = &[
    ("too-many-pixels", "it does not multiply width and height"),
    ("look-at", "it does not compare values"),
    ("too-long", "it does not square numbers"),
    ("of-a-table", "it opens no table"),
    ("errors", "it opens no part"),
    ("syntax", "it opens no part"),
    ("ring", "it opens no part"),
    ("of-a-key", "the values of keys have no ranges"),
    ("between-keys", "it draws no frames"),
    ("triangle-without-area", "it does not compare values"),
    ("cylinder-without-length", "it does not compare values"),
    ("cone-without-length", "it does not compare values"),
    ("capsule-without-length", "it does not compare values"),
    ("box-inside-out", "it does not compare values"),
    ("ellipsoid-askew", "it does not multiply vectors"),
];

fn validator() -> Validator {
    let schema: Value = serde_json::from_str(&strahl::scene::schema()).unwrap();
    jsonschema::draft202012::new(&schema).unwrap()
}

#[test]
fn the_published_schema_is_up_to_date() {
    if env::var_os("STRAHL_BLESS").is_some() {
        fs::create_dir_all("schemas").unwrap();
        fs::write(PUBLISHED, strahl::scene::schema()).unwrap();
    }
    let published = fs::read_to_string(PUBLISHED).unwrap();
    assert!(
        published == strahl::scene::schema(),
        "{PUBLISHED} is stale: `STRAHL_BLESS=1 cargo test --test schema` writes it anew"
    );
}

#[test]
fn the_schema_is_a_schema() {
    let schema: Value = serde_json::from_str(&strahl::scene::schema()).unwrap();
    assert!(jsonschema::meta::is_valid(&schema));
}

#[test]
fn the_schema_accepts_what_the_loader_accepts() {
    let validator = validator();
    let mut count = 0;
    for folder in ["tests/valid", "scenes", "src/scene"] {
        for path in files(Path::new(folder)) {
            let document = Document::from_path(&path).unwrap();
            assert!(!document.has_errors(), "{}", path.display());
            let text = document.convert(Syntax::Json).unwrap().text;
            let scene: Value = serde_json::from_str(&text).unwrap();
            let fault = validator
                .validate(&scene)
                .err()
                .map(|fault| fault.to_string());
            assert_eq!(fault, None, "{}", path.display());
            // Also as written: null and whole floats do not survive the conversion.
            if document_syntax(&path) == Syntax::Json {
                let text = fs::read_to_string(&path).unwrap();
                let scene: Value =
                    serde_json::from_str(text.trim_start_matches('\u{feff}')).unwrap();
                assert!(validator.is_valid(&scene), "{}", path.display());
            }
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}

#[test]
fn the_schema_refuses_what_the_loader_refuses() {
    let validator = validator();
    let (mut refused, mut wrong) = (0, Vec::new());
    for code in Code::ALL {
        let folder = Path::new("tests/invalid").join(code.name());
        for path in files(&folder) {
            if document_syntax(&path) != Syntax::Json {
                continue;
            }
            let Ok(text) = fs::read_to_string(&path) else {
                continue;
            };
            let Ok(scene) = serde_json::from_str::<Value>(&text) else {
                assert!(beyond(*code, &path), "{}", path.display());
                continue;
            };
            let expected = code.severity() == Severity::Error && !beyond(*code, &path);
            if validator.is_valid(&scene) == expected {
                wrong.push(path.display().to_string());
            }
            refused += usize::from(expected);
        }
    }
    assert_eq!(wrong, [""; 0]);
    assert!(refused > 10, "{refused}");
}

fn beyond(code: Code, path: &Path) -> bool {
    let name = path.file_stem().unwrap().to_str().unwrap();
    let by_code = BEYOND_A_SCHEMA.iter().any(|(other, _)| *other == code);
    by_code || BEYOND_A_SCHEMA_CASES.iter().any(|(stem, _)| name == *stem)
}

fn document_syntax(path: &Path) -> Syntax {
    Syntax::of_path(path).unwrap()
}

/// Returns the scenes directly in a folder.
fn files(folder: &Path) -> Vec<std::path::PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = paths
        .filter(|path| Syntax::of_path(path).is_some())
        .collect();
    paths.sort();
    paths
}
