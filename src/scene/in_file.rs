//! The places of faults in the text of a table or a mesh.
//!
//! The readers of tables and meshes note the lines of faults. Here, once all problems of a file are
//! known, these lines are read again, so that reports can show them.

use std::{
    collections::BTreeMap,
    io::{self, BufRead, BufReader, Read},
    ops::Range,
    path::PathBuf,
};

use crate::{
    data::fault::{LinePart, Spot},
    diagnostic::InFile,
    scene::{files::Folder, problem::Problem},
};

/// The longest line that is shown.
const LONGEST: u64 = 1 << 16;

/// Places problems in the file that they are about, as far as it is a text. `written` is the path of the
/// file in the scene, and `name` returns that from the current folder.
pub(super) fn place(
    problems: &mut [Problem],
    written: &str,
    name: impl FnOnce() -> PathBuf,
    files: &Folder<'_>,
) {
    let wanted = problems.iter().filter_map(|problem| {
        let (spot, _) = problem.in_file.as_deref()?;
        Some((spot.line, None))
    });
    let mut texts: BTreeMap<u64, Option<String>> = wanted.collect();
    if texts.is_empty() {
        return;
    }
    let Ok((content, _)) = files.open(written) else {
        return;
    };
    let name = name().display().to_string();
    // The problems keep their place in the scene if the file has changed meanwhile.
    let _ = read_lines(content, &mut texts);
    for problem in problems {
        if let Some((Spot { line, part }, message)) = problem.in_file.as_deref()
            && let Some(Some(text)) = texts.get(line)
        {
            problem.diagnostic.in_file = Some(Box::new(InFile {
                file: name.clone(),
                line: usize::try_from(*line).unwrap_or(usize::MAX),
                text: text.clone(),
                range: range_in(text, part),
                message: message.clone(),
            }));
        }
    }
}

/// Reads the lines with these numbers, from 1.
fn read_lines(content: impl Read, texts: &mut BTreeMap<u64, Option<String>>) -> io::Result<()> {
    let mut reader = BufReader::new(content);
    let mut before = 0;
    for (line, text) in texts {
        while before + 1 < *line {
            reader.skip_until(b'\n')?;
            before += 1;
        }
        let mut bytes = Vec::new();
        let read = reader
            .by_ref()
            .take(LONGEST)
            .read_until(b'\n', &mut bytes)?;
        before += 1;
        if read == 0 {
            break;
        }
        if !bytes.ends_with(b"\n") {
            reader.skip_until(b'\n')?;
        }
        let found = String::from_utf8_lossy(&bytes);
        *text = Some(found.trim_end_matches(['\n', '\r']).to_owned());
    }
    Ok(())
}

/// Returns the place of a part of a line: all of the line, if it is not there or not only once.
fn range_in(text: &str, part: &LinePart) -> Range<usize> {
    let only = |is_it: &dyn Fn(&str) -> bool| {
        let mut found = words(text).filter(|word| text.get(word.clone()).is_some_and(is_it));
        found.next().filter(|_| found.next().is_none())
    };
    let found = match part {
        LinePart::All => None,
        // A line may end before its last columns.
        LinePart::Bytes(range) => Some(range.start.min(text.len())..range.end.min(text.len())),
        LinePart::Cell { at, of } => {
            let cells = cells(text);
            (cells.len() == *of)
                .then(|| cells.get(*at).cloned())
                .flatten()
        }
        LinePart::Word(wanted) => only(&|word| word == wanted),
        LinePart::Number(wanted) => only(&|word| {
            let number = word.parse::<f64>();
            number.is_ok_and(|number| number == *wanted || number.is_nan() && wanted.is_nan())
        }),
    };
    found
        .filter(|range| text.get(range.clone()).is_some())
        .unwrap_or_else(|| {
            let start = text.len() - text.trim_start().len();
            start..text.trim_end().len().max(start)
        })
}

/// Returns the words of a line, which blanks and commas separate.
fn words(text: &str) -> impl Iterator<Item = Range<usize>> {
    let is_between = |letter: char| letter.is_whitespace() || ",;".contains(letter);
    let mut words = text.split(is_between).scan(0, |start, word| {
        let range = *start..*start + word.len();
        // All letters that separate words have one byte, except for rare blanks.
        *start = range.end
            + text
                .get(range.end..)?
                .chars()
                .next()
                .map_or(0, char::len_utf8);
        Some(range)
    });
    std::iter::from_fn(move || words.find(|word| !word.is_empty()))
}

/// Returns the cells of a line of a CSV file, without surrounding blanks; its words, if it has no
/// commas.
fn cells(text: &str) -> Vec<Range<usize>> {
    if !text.contains(',') {
        return words(text).collect();
    }
    let mut is_quoted = false;
    let ends = text.bytes().enumerate().filter(|(_, byte)| {
        is_quoted ^= *byte == b'"';
        *byte == b',' && !is_quoted
    });
    let mut start = 0;
    let mut cells = Vec::new();
    for end in ends.map(|(at, _)| at).chain([text.len()]) {
        let cell = text.get(start..end).unwrap_or_default();
        let first = start + (cell.len() - cell.trim_start().len());
        cells.push(first..first + cell.trim().len());
        start = end + 1;
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_line_has_a_range() {
        let cell = |at| LinePart::Cell { at, of: 3 };
        let word = |word: &str| LinePart::Word(word.to_owned());
        for (text, part, place) in [
            ("1, a ,a", cell(1), "a"),
            ("1,a,b", cell(2), "b"),
            ("1,2,", cell(2), ""),
            ("1 2\t3", cell(2), "3"),
            ("\"1,2\",3,4", cell(1), "3"),
            (" 1,2 ", cell(1), "1,2"),
            (" 1,2 ", LinePart::All, "1,2"),
            ("f 1 x/y 3", word("x/y"), "x/y"),
            ("f x x 3", word("x"), "f x x 3"),
            ("H 0 0 -1.0", LinePart::Number(-1.0), "-1.0"),
            ("H 0 0 nan", LinePart::Number(f64::NAN), "nan"),
            ("H 0 0 1", LinePart::Number(0.0), "H 0 0 1"),
            ("a b cd", LinePart::Bytes(2..5), "b c"),
            ("a b cd", LinePart::Bytes(2..9), "b cd"),
            ("äb", LinePart::Bytes(1..2), "äb"),
        ] {
            assert_eq!(&text[range_in(text, &part)], place, "{text}: {part:?}");
        }
        assert_eq!(range_in("1,a,a", &cell(2)), 4..5);
    }

    #[test]
    fn lines_are_read_by_their_numbers() {
        let mut texts = BTreeMap::from([(2, None), (4, None), (9, None)]);
        read_lines(&b"a\r\nb b\r\n\nd"[..], &mut texts).unwrap();
        let found: Vec<_> = texts.values().map(Option::as_deref).collect();
        assert_eq!(found, [Some("b b"), Some("d"), None]);
    }
}
