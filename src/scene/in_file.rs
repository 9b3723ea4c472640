//! The places of faults in the text of a table or a mesh.
//!
//! The readers of tables and meshes begin their messages with the line: `line 7: …` or `row 5 (line 7),
//! column …`. Here, once all problems of a file are known, the lines are read again, and the problems
//! get their places in them.

use std::{
    collections::BTreeMap,
    io::{self, BufRead, BufReader, Read},
    ops::Range,
    path::PathBuf,
};

use crate::{
    diagnostic::InFile,
    scene::{files::Folder, problem::Problem},
    text::nearest::quote,
};

/// The longest line that is shown.
const LONGEST: u64 = 1 << 16;

/// Places problems in the file that they are about, as far as their messages name a line of it.
/// `written` is the path of the file in the scene, `name` returns that from the current folder, and
/// `columns` are the names of its columns.
pub(super) fn place(
    problems: &mut [Problem],
    written: &str,
    name: impl FnOnce() -> PathBuf,
    columns: &[String],
    files: &Folder<'_>,
) {
    let prefix = format!("{}: ", quote(written));
    let message_of = |problem: &Problem| {
        // The other fields are the scene's own faults.
        let field = problem.diagnostic.path.steps().last()?;
        let problem = (field.name() == Some("file")).then_some(problem)?;
        let message = problem.diagnostic.message.strip_prefix(&prefix)?;
        Some((line_of(message)?, message.to_owned()))
    };
    let wanted = problems.iter().filter_map(message_of);
    let mut texts: BTreeMap<usize, Option<String>> = wanted.map(|(line, _)| (line, None)).collect();
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
        if let Some((line, message)) = message_of(problem)
            && let Some(Some(text)) = texts.get(&line)
        {
            problem.diagnostic.in_file = Some(Box::new(InFile {
                file: name.clone(),
                line,
                text: text.clone(),
                range: range_in(text, &message, columns),
                message,
            }));
        }
    }
}

/// Reads the lines with these numbers, from 1.
fn read_lines(content: impl Read, texts: &mut BTreeMap<usize, Option<String>>) -> io::Result<()> {
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

/// Returns the parts of a message that are not quoted.
fn plain(message: &str) -> impl Iterator<Item = &str> {
    message.split('`').step_by(2)
}

/// Returns the number at the start of a text.
fn number(text: &str) -> Option<usize> {
    let end = text.find(|letter: char| !letter.is_ascii_digit());
    text.get(..end.unwrap_or(text.len()))?.parse().ok()
}

/// Returns the line that a message names.
fn line_of(message: &str) -> Option<usize> {
    let line = match message.strip_prefix("line ") {
        Some(rest) => number(rest),
        None => plain(message).find_map(|part| number(part.split_once("(line ")?.1)),
    };
    line.filter(|line| *line > 0)
}

/// Returns the place in a line that a message is about: a cell, a quoted text or a number that is
/// there only once; otherwise all of the line.
fn range_in(text: &str, message: &str, columns: &[String]) -> Range<usize> {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let columns_of = || {
        let (_, rest) = plain(message).find_map(|part| part.split_once(", columns "))?;
        let (first, last) = rest.split_once('-')?;
        // A line may end before its last columns.
        let [first, last] = [number(first)?.checked_sub(1)?, number(last)?];
        let range = first.min(text.len())..last.min(text.len());
        text.get(range.clone()).map(|_| range)
    };
    let cell = || {
        let name = message.split_once(", column `")?.1.split('`').next()?;
        let at = columns.iter().position(|column| column == name)?;
        let cells = cells(text);
        (cells.len() == columns.len()).then(|| cells.get(at).cloned())?
    };
    let words = || words(text);
    let same = |word: &Range<usize>, wanted: &str| {
        let word = text.get(word.clone()).unwrap_or_default();
        let numbers = [word, wanted].map(|text| text.parse::<f64>().ok());
        let is_number = match numbers {
            [Some(one), Some(other)] => one == other || one.is_nan() && other.is_nan(),
            _ => false,
        };
        word == wanted || is_number
    };
    let word = || {
        quoted.iter().rev().find_map(|wanted| {
            let mut found = words().filter(|word| same(word, wanted));
            found.next().filter(|_| found.next().is_none())
        })
    };
    let whole = || {
        let start = text.len() - text.trim_start().len();
        start..text.trim_end().len().max(start)
    };
    columns_of()
        .or_else(cell)
        .or_else(word)
        .unwrap_or_else(whole)
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
    fn a_message_leads_to_a_line_and_a_place_in_it() {
        let columns = ["x", "y", "radius"].map(str::to_owned);
        for (message, text, line, place) in [
            (
                "row 5 (line 7), column `y`: `a` is not a number",
                "1, a ,a",
                7,
                "a",
            ),
            (
                "row 5 (line 7), column `radius`: the cell is empty",
                "1,2,",
                7,
                "",
            ),
            ("row 5 (line 7): 2 columns, expected 3", " 1,2 ", 7, "1,2"),
            (
                "line 12: `x/y` is not a corner of a face",
                "f 1 x/y 3",
                12,
                "x/y",
            ),
            ("row 0 (line 3): found `-1`", "H 0 0 -1.0", 3, "-1.0"),
            ("row 0 (line 3): found `NaN`", "H 0 0 nan", 3, "nan"),
            ("row 0 (line 3): found `0`", "H 0 0 1", 3, "H 0 0 1"),
            ("row 1 (line 2, columns 3-5): `b c`", "a b cd", 2, "b c"),
            ("row 1 (line 2, columns 3-9): `b c`", "a b cd", 2, "b cd"),
        ] {
            assert_eq!(line_of(message), Some(line), "{message}");
            let range = range_in(text, message, &columns);
            assert_eq!(&text[range], place, "{message}");
        }
        let range = range_in("1,a,a", "row 5 (line 7), column `radius`: `a`", &columns);
        assert_eq!(range, 4..5);
        for message in [
            "row 5: 2 columns",
            "`(line 7)` is unknown",
            "line 0: x",
            "line x",
        ] {
            assert_eq!(line_of(message), None, "{message}");
        }
    }

    #[test]
    fn lines_are_read_by_their_numbers() {
        let mut texts = BTreeMap::from([(2, None), (4, None), (9, None)]);
        read_lines(&b"a\r\nb b\r\n\nd"[..], &mut texts).unwrap();
        let found: Vec<_> = texts.values().map(Option::as_deref).collect();
        assert_eq!(found, [Some("b b"), Some("d"), None]);
    }
}
