//! One slip, one fault: each structural character of valid scenes is omitted, doubled or mistyped,
//! one at a time.
use super::common::{JSON, RON, check};
use crate::text::syntax::{Syntax, parse};

fn count(
    seeds: &[&str],
    syntax: Syntax,
    what: &str,
    edit: impl Fn(&mut String, usize),
) -> [usize; 4] {
    let mut counts = [0; 4];
    for seed in seeds {
        for (at, c) in seed.char_indices() {
            if !"()[]{},:\"".contains(c) {
                continue;
            }
            let mut text = (*seed).to_owned();
            edit(&mut text, at);
            let tree = parse(&text, syntax);
            check(&text, &tree);
            let faults = tree.faults();
            if faults.len() > 1 && std::env::var("STRAHL_SHOW").is_ok() {
                eprintln!("=== {what} `{c}` at {at}\n{text}");
                for f in faults {
                    eprintln!("    {}..{} {}", f.range.start, f.range.end, f.message);
                }
            }
            counts[faults.len().min(3)] += 1;
        }
    }
    eprintln!("{what} {syntax:?}: {counts:?} (none, one, two, more)");
    counts
}

fn wrong(c: u8) -> &'static str {
    match c {
        b'(' => "[",
        b')' => "]",
        b'[' => "(",
        b']' => ")",
        b'{' => "[",
        b'}' => "]",
        b',' => ";",
        b':' => "=",
        _ => "'",
    }
}

/// Checks that at most `more_than_one` percent of the slips give more than one fault.
fn judge(counts: [usize; 4], more_than_one: usize) {
    let all: usize = counts.iter().sum();
    let bad = counts[2] + counts[3];
    assert!(bad * 100 <= all * more_than_one, "{counts:?}");
}

#[test]
fn left_out() {
    for (seeds, syntax) in [(RON, Syntax::Ron), (JSON, Syntax::Json)] {
        judge(
            count(seeds, syntax, "left out", |text, at| {
                text.replace_range(at..=at, "")
            }),
            5,
        );
    }
}

#[test]
fn doubled() {
    for (seeds, syntax) in [(RON, Syntax::Ron), (JSON, Syntax::Json)] {
        let double =
            |text: &mut String, at: usize| text.insert(at, text[at..].chars().next().unwrap());
        judge(count(seeds, syntax, "doubled", double), 5);
    }
}

#[test]
fn mistyped() {
    for (seeds, syntax) in [(RON, Syntax::Ron), (JSON, Syntax::Json)] {
        let mistype =
            |text: &mut String, at: usize| text.replace_range(at..=at, wrong(text.as_bytes()[at]));
        judge(count(seeds, syntax, "mistyped", mistype), 5);
    }
}

#[test]
fn cut_off() {
    for (seeds, syntax) in [(RON, Syntax::Ron), (JSON, Syntax::Json)] {
        for seed in seeds {
            for (at, _) in seed.char_indices() {
                let tree = parse(&seed[..at], syntax);
                check(&seed[..at], &tree);
                // A truncated string over several lines looks like one that lost its closing quote
                // on the first line.
                let most = if seed.contains("multi\n") || seed.contains("a\\\n") {
                    3
                } else {
                    1
                };
                assert!(
                    tree.faults().len() <= most,
                    "{:?}\nin {}",
                    tree.faults(),
                    &seed[..at]
                );
            }
        }
    }
}
