//! The page that maps the course to Strahl, docs/course.md, is correct: each link leads to the file
//! that defines its name, and the sample is what the program prints.

use std::{fs, path::Path, process::Command};

const PAGE: &str = "docs/course.md";

/// Returns the names and files of links such as ``[`Ray::at`](../src/tracer/ray.rs)``.
fn links(page: &str) -> Vec<(&str, String)> {
    let link = |link| {
        let (name, rest) = str::split_once(link, "`](../src/")?;
        let (file, _) = rest.split_once(')')?;
        Some((name, format!("src/{file}")))
    };
    page.split("[`").filter_map(link).collect()
}

/// True if a line of code defines a public item of this name.
fn defines(line: &str, name: &str) -> bool {
    let words: Vec<_> = line
        .split(|letter: char| !(letter.is_alphanumeric() || letter == '_'))
        .collect();
    line.trim_start().starts_with("pub")
        && words
            .windows(2)
            .any(|pair| ["fn", "struct", "enum", "as"].contains(&pair[0]) && pair[1] == name)
}

#[test]
fn each_link_leads_to_the_file_that_defines_its_name() {
    let page = fs::read_to_string(PAGE).unwrap();
    let links = links(&page);
    assert!(links.len() > 15, "only {} links are found", links.len());
    for (path, file) in links {
        let code = fs::read_to_string(&file).unwrap();
        let name = path.rsplit("::").next().unwrap();
        assert!(
            code.lines().any(|line| defines(line, name)),
            "{file} does not define {path}"
        );
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
