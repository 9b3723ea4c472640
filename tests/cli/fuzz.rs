//! Scenes with random faults are either rejected or rendered.

use std::{fs, path::PathBuf};

use strahl::{Document, ReadOptions, RenderOptions, Scene, Size, Syntax};

use crate::support::{Folder, run_with};

/// The xorshift64* generator: the same faults on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % end
    }
}

fn scenes() -> Vec<(Syntax, Vec<u8>)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let paths = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = paths.collect();
    paths.sort();
    let mut scenes: Vec<(Syntax, Vec<u8>)> = paths
        .iter()
        .filter_map(|path| Some((Syntax::of_path(path)?, fs::read(path).unwrap())))
        .collect();
    scenes.push((Syntax::Ron, crate::support::RON.into()));
    scenes.push((Syntax::Json, crate::support::JSON.into()));
    scenes
}

fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    const PIECES: &[&str] = &[
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        "\"",
        ",",
        ":",
        "/*",
        "*/",
        "//",
        "-",
        "1e999",
        "1e-999",
        "NaN",
        "inf",
        "-0.0",
        "0",
        "99999999999999999999",
        "Some(",
        "None",
        "null",
        "r#\"",
        "r#",
        "\\u{0}",
        "\\ud800",
        "\u{feff}",
        "é",
        "🙂",
        "#![enable(unwrap_newtypes)]",
        "'",
        "0x1f",
        "1_000",
        "()",
        "{}",
        "version: 2,",
        "$schema",
        "\u{2028}",
        "b\"",
        "fov",
        "radius: 1,",
    ];
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len() + 1);
        let end = (at + random.below(12)).min(bytes.len());
        match random.below(6) {
            0 => drop(bytes.drain(at..end)),
            1 => bytes.insert(at, random.below(256) as u8),
            2 => bytes.truncate(at),
            3 if at < bytes.len() => bytes[at] = random.below(256) as u8,
            4 => {
                let copy = bytes[at..end].to_vec();
                let to = random.below(bytes.len() + 1);
                bytes.splice(to..to, copy);
            }
            _ => {
                let piece = PIECES[random.below(PIECES.len())].bytes();
                bytes.splice(at..at, piece);
            }
        }
    }
}

#[test]
fn the_library_survives_random_faults() {
    let (scenes, mut random) = (scenes(), Random(0x5eed));
    let mut drawn = 0;
    for round in 0..6000 {
        let (syntax, mut bytes) = scenes[round % scenes.len()].clone();
        mutate(&mut bytes, &mut random);
        // Shown when the test fails.
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let input = format!("round {round}, {}: {text}", syntax.name());
        for document in [
            Document::from_reader("a", bytes.as_slice(), &ReadOptions::new().syntax(syntax))
                .unwrap(),
            Document::from_reader("a", bytes.as_slice(), &ReadOptions::new()).unwrap(),
            Document::from_text("a", text.as_str(), syntax),
        ] {
            for fault in document.diagnostics() {
                let range = &fault.range;
                assert!(range.start <= range.end, "{input}");
                assert!(range.end <= document.text().len(), "{range:?} in {input}");
                assert!(
                    document.text().is_char_boundary(range.start),
                    "{fault:?} in {input}"
                );
                assert!(
                    !fault.message.contains('\n'),
                    "{:?} in {input}",
                    fault.message
                );
                assert!(!fault.message.is_empty(), "{input}");
            }
            let faulty = document.has_errors();
            let scene = Scene::try_from(document);
            assert_eq!(scene.is_err(), faulty, "{input}");
            if let Ok(scene) = scene {
                let options = RenderOptions::new()
                    .size(Size::new(4, 4).unwrap())
                    .threads(1);
                scene.render_with(&options).unwrap();
                drawn += 1;
            }
        }
    }
    assert!(drawn > 100, "nearly everything was rejected: {drawn}");
}

#[test]
fn the_program_survives_random_faults() {
    let (scenes, mut random) = (scenes(), Random(0xfee1));
    let folder = Folder::new();
    for round in 0..200 {
        let (syntax, mut bytes) = scenes[round % scenes.len()].clone();
        mutate(&mut bytes, &mut random);
        let args = [
            "render",
            "-",
            "--size",
            "4x4",
            "-o",
            "-",
            "--input-format",
            syntax.name(),
        ];
        let done = run_with(&mut folder.strahl(args), &bytes);
        let text = String::from_utf8_lossy(&bytes);
        assert!(matches!(done.status, Some(0 | 1)), "{done:?}: {text}");
        assert_eq!(
            done.stdout.is_empty(),
            done.status == Some(1),
            "{done:?}: {text}"
        );
        assert_eq!(
            done.stderr.contains("error["),
            done.status == Some(1),
            "{done:?}"
        );
        done.no_panic();
    }
}
