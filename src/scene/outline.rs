//! The tree of a valid text in which only few geometries have to be looked at.
//!
//! Most of a large file is its geometries, and a tree of all of them takes several times as long as
//! reading them. Where something is to be said about some, the others are blanked out first, byte
//! for byte, so that every place stays where it is.

use crate::{
    scene::{path::Step, problem::Problem},
    text::syntax::{self, Syntax, Tree},
};

/// The list whose elements may be left out.
const LIST: &str = "geometries";

/// The bytes that brackets, elements, strings and comments begin or end with.
const IS_MARK: [bool; 256] = {
    let mut table = [false; 256];
    let (marks, mut at) = (br#""'/([{,)]}"#, 0);
    while at < marks.len() {
        table[marks[at] as usize] = true;
        at += 1;
    }
    table
};

/// The tree of a text that has been read without a fault; of the geometries only those that
/// `problems` are about have one, in the place of each other one stands a number.
pub(crate) fn tree(text: &str, syntax: Syntax, problems: &[Problem]) -> Tree {
    let labels = problems.iter().flat_map(|problem| &problem.labels);
    let places = problems.iter().map(|problem| &problem.place);
    let places = places.chain(labels.map(|(place, _)| place));
    let mut wanted: Vec<usize> = places
        .filter_map(|place| match place.path.steps() {
            [Step::Field(list), Step::Index(index), ..] if *list == LIST => Some(*index),
            _ => None,
        })
        .collect();
    wanted.sort_unstable();
    wanted.dedup();
    match outline(text, &wanted) {
        Some(outline) => syntax::parse(&outline, syntax),
        None => syntax::parse(text, syntax),
    }
}

/// The text with a number and blanks in the place of each geometry but those with the sorted indices
/// `wanted`; `None` where something stands in it whose end only the lexer knows.
fn outline(text: &str, wanted: &[usize]) -> Option<String> {
    let bytes = text.as_bytes();
    let mut outline = Vec::with_capacity(bytes.len());
    let mut wanted = wanted.iter().peekable();
    let (mut at, mut depth, mut index) = (0, 0_usize, 0);
    // Where the current element of the list starts.
    let mut element = None;
    while let Some(byte) = bytes.get(at) {
        if !IS_MARK[usize::from(*byte)] {
            at += 1;
            continue;
        }
        match byte {
            b'"' => {
                // A raw string of RON, or one of bytes.
                let before = at.checked_sub(1).and_then(|before| bytes.get(before));
                if matches!(before, Some(b'r' | b'b' | b'#')) {
                    return None;
                }
                at = end_of_string(bytes, at)?;
                continue;
            }
            b'\'' => return None,
            b'/' => {
                at = match bytes.get(at + 1) {
                    Some(b'/') => syntax::line_comment(bytes, at),
                    Some(b'*') => syntax::block_comment(bytes, at)?,
                    _ => return None,
                };
                continue;
            }
            b'(' | b'[' | b'{' => {
                if depth == 1 && *byte == b'[' && is_list(&text[..at]) {
                    element = Some(at + 1);
                }
                depth += 1;
            }
            b',' | b')' | b']' | b'}' => {
                if *byte != b',' {
                    depth = depth.checked_sub(1)?;
                }
                let ends = depth == if *byte == b',' { 2 } else { 1 };
                if let Some(start) = element.filter(|_| ends) {
                    if wanted.next_if_eq(&&index).is_none()
                        && !bytes[start..at].trim_ascii().is_empty()
                    {
                        outline.extend_from_slice(&bytes[outline.len()..start]);
                        outline.push(b'0');
                        outline.resize(at, b' ');
                    }
                    index += 1;
                    element = (*byte == b',').then_some(at + 1);
                }
            }
            _ => {}
        }
        at += 1;
    }
    outline.extend_from_slice(&bytes[outline.len()..]);
    String::from_utf8(outline).ok()
}

/// Whether the list follows whose key is the last of a text.
fn is_list(before: &str) -> bool {
    let key = before.trim_end().strip_suffix(':').map(str::trim_end);
    let name = key.map(|key| key.strip_suffix('"').unwrap_or(key));
    let rest = name.and_then(|name| name.strip_suffix(LIST));
    rest.is_some_and(|rest| !rest.ends_with(|last: char| last.is_alphanumeric() || last == '_'))
}

/// The end of the string that starts at a place.
fn end_of_string(bytes: &[u8], start: usize) -> Option<usize> {
    let mut at = start + 1;
    loop {
        match bytes.get(at)? {
            b'"' => return Some(at + 1),
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_wanted_is_left() {
        for (text, wanted, expected) in [
            (
                r#"{"geometries": [{"a": [1, 2]}, {"b": "],"}, 7 ], "x": [1, 2]}"#,
                &[1][..],
                r#"{"geometries": [0            , {"b": "],"},0  ], "x": [1, 2]}"#,
            ),
            (
                "(geometries : [A(1), /* ] */ B(r#x: 2), // ,\n C,], camera: [1])",
                &[],
                "(geometries : [0   ,0                 ,0       ,], camera: [1])",
            ),
            (
                "(list: [geometries: [1, 2]])",
                &[],
                "(list: [geometries: [1, 2]])",
            ),
            ("(my_geometries: [1, 2])", &[], "(my_geometries: [1, 2])"),
            ("(geometries: [])", &[0], "(geometries: [])"),
            ("(geometries: [1, 2])", &[0, 1], "(geometries: [1, 2])"),
            (
                "(geometries: [\"ü\\\"\", 2])",
                &[1],
                "(geometries: [0     , 2])",
            ),
        ] {
            assert_eq!(outline(text, wanted).as_deref(), Some(expected), "{text}");
        }
    }

    #[test]
    fn what_only_the_lexer_knows_is_left_to_it() {
        for text in [
            "(geometries: [A('\"')])",
            "(geometries: [A(r#\"x\"#)])",
            "(geometries: [A(b\"x\")])",
            "(geometries: [A(\"x",
            "(geometries: [A(1 / 2)])",
            "(geometries: [A /* x",
            "geometries)])",
        ] {
            assert_eq!(outline(text, &[]), None, "{text}");
        }
    }
}
