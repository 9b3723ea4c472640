//! Checks for invalid and duplicate names.

use std::collections::HashMap;

use crate::{
    diagnostic::{Code, path::Path},
    scene::{
        format::cameras,
        problem::{Focus, Problem},
    },
    text::nearest::quote,
};

/// Checks names, given with the numbers of what has them; `path_of` returns the path of that.
pub(super) fn of<'a, T: Copy>(
    named: impl IntoIterator<Item = (T, &'a str)>,
    path_of: impl Fn(T) -> Path,
) -> Vec<Problem> {
    let mut first_of = HashMap::new();
    let mut problems = Vec::new();
    for (at, name) in named {
        let path = |at| path_of(at).field("name");
        match name {
            "" => problems.push(empty(path(at))),
            name => match first_of.get(name) {
                None => drop(first_of.insert(name, at)),
                Some(first) => problems.push(
                    Problem::new(
                        Code::DuplicateName,
                        path(at),
                        Focus::Value,
                        format!("the name {} is given twice", quote(name)),
                    )
                    .help("give one of the two another name, or none")
                    .label(path(*first), Focus::Value, "the first of them"),
                ),
            },
        }
    }
    problems
}

/// Checks the name of a camera.
pub(super) fn of_camera(name: &str) -> Option<Problem> {
    let message = cameras::fault_of_name(name)?;
    let path = Path::ROOT.field("cameras").key(name);
    let problem = Problem::new(Code::InvalidName, path, Focus::Key, message);
    Some(problem.help("the name becomes part of file names: use letters and digits"))
}

fn empty(path: Path) -> Problem {
    let message = "an empty string is not a name";
    Problem::new(Code::InvalidName, path, Focus::Value, message).help("leave the name out")
}
