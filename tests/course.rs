//! The page that maps the course to Strahl, docs/course.md, holds what it says: each link leads to
//! the line that defines its name, and the sample is what the program prints.
//! `STRAHL_BLESS=1 cargo test --test course` corrects the numbers of lines.

use std::{env, fs, ops::Range, path::Path, process::Command};

const PAGE: &str = "docs/course.md";

/// A link such as ``[`Ray::at`](../src/tracer/ray.rs#L52)``.
struct Link {
    name: String,
    file: String,
    line: usize,
    /// The range of the number of the line in the page.
    number: Range<usize>,
}

fn links(page: &str) -> Vec<Link> {
    let link = |(start, _): (usize, &str)| {
        let rest = &page[start + 2..];
        let (name, rest) = rest.split_once("`](../src/")?;
        let (file, rest) = rest.split_once("#L")?;
        let digits = rest.find(')')?;
        let at = page.len() - rest.len();
        Some(Link {
            name: name.to_owned(),
            file: format!("src/{file}"),
            line: rest[..digits].parse().unwrap(),
            number: at..at + digits,
        })
    };
    page.match_indices("[`").filter_map(link).collect()
}

/// The line, from 1, on which a file defines the last part of a name.
fn definition(link: &Link) -> usize {
    let code = fs::read_to_string(&link.file).unwrap();
    let name = link.name.rsplit("::").next().unwrap();
    let is_definition = |line: &str| {
        let words: Vec<_> = line
            .split(|letter: char| !(letter.is_alphanumeric() || letter == '_'))
            .collect();
        line.trim_start().starts_with("pub")
            && words
                .windows(2)
                .any(|pair| ["fn", "struct", "enum", "as"].contains(&pair[0]) && pair[1] == name)
    };
    let line = code.lines().position(is_definition);
    line.map_or_else(
        || panic!("{} does not define {}", link.file, link.name),
        |line| line + 1,
    )
}

#[test]
fn each_link_leads_to_the_definition_of_its_name() {
    let mut page = fs::read_to_string(PAGE).unwrap();
    let links = links(&page);
    assert!(links.len() > 15, "only {} links are found", links.len());
    let is_blessed = env::var_os("STRAHL_BLESS").is_some();
    for link in links.iter().rev() {
        let line = definition(link);
        if is_blessed {
            page.replace_range(link.number.clone(), &line.to_string());
        } else {
            assert_eq!(link.line, line, "{} in {}", link.name, link.file);
        }
    }
    if is_blessed {
        fs::write(PAGE, page).unwrap();
    }
}

#[test]
fn the_sample_is_what_the_program_prints() {
    let page = fs::read_to_string(PAGE).unwrap();
    let command = page
        .lines()
        .find(|line| line.starts_with("strahl pixel"))
        .unwrap();
    let args = command.split(' ').skip(1);
    let output = Command::new(env!("CARGO_BIN_EXE_strahl"))
        .args(args)
        .output()
        .unwrap();
    let printed = String::from_utf8(output.stdout).unwrap();
    let sample = page.split_once("```text\n").unwrap().1;
    let sample = sample.split_once("```").unwrap().0;
    assert!(printed.contains(sample), "{printed}");
}

#[test]
fn each_world_is_the_golden_one() {
    for name in [
        "sphere",
        "plane",
        "two-spheres-perspective",
        "two-spheres-orthographic",
    ] {
        let [scene, golden] =
            ["scenes", "tests/golden/worlds"].map(|folder| format!("{folder}/{name}.ron"));
        let read = |path: &str| strahl::Scene::from_path(Path::new(path)).unwrap();
        let (scene, golden) = (read(&scene), read(&golden));
        assert_eq!(scene.world(), golden.world(), "{name}");
        assert_eq!(scene.camera(), golden.camera(), "{name}");
        assert_eq!(scene.size(), golden.size(), "{name}");
        assert_eq!(scene.samples(), golden.samples(), "{name}");
    }
}
