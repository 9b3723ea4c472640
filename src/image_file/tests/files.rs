//! Files for other programs to read.

use std::{env, fs, io::Cursor, path::Path};

use super::{Case, SIZE, cases};
use crate::image_file::{cryptomatte, output::Output, pixel::Pixel};

/// Writes every case, and some with metadata, into a folder, for `tests/files/check.py`.
#[test]
#[ignore = "writes into the folder that STRAHL_IMAGE_FILES names"]
fn files_for_other_programs() {
    let folder = env::var("STRAHL_IMAGE_FILES").unwrap();
    let write = |case: &Case, name: &str, metadata: &[(String, String)]| {
        let mut file = Cursor::new(Vec::new());
        case.write(Output::File(&mut file), SIZE, metadata).unwrap();
        fs::write(Path::new(&folder).join(name), file.into_inner()).unwrap();
    };
    for case in cases() {
        write(&case, &case.name, &[]);
    }
    let metadata = [("Software", "strahl 1"), ("Camera", "Grüße\n2")];
    let metadata = metadata.map(|(name, text)| (name.to_owned(), text.to_owned()));
    for ending in ["png", "jpg", "tiff", "hdr", "exr"] {
        let name = match ending {
            "exr" => "channels-fast.exr".to_owned(),
            "hdr" => "rgb-f4-fast.hdr".to_owned(),
            _ => format!("rgb-u1-fast.{ending}"),
        };
        write(&Case::find(&name), &format!("metadata.{ending}"), &metadata);
    }
    let names: Vec<_> = (0..1000).map(|count| format!("name {count}")).collect();
    let names = names
        .iter()
        .map(String::as_str)
        .chain(["\"Grüße\" \\ 世界"]);
    let layer = "CryptoObject";
    let case = Case {
        pixel: Pixel::Channels(cryptomatte::channels(layer, 3).leak()),
        ..Case::find("channels-fast.exr")
    };
    write(
        &case,
        "cryptomatte.exr",
        &cryptomatte::metadata(layer, names),
    );
}
