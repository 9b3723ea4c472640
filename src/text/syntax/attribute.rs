//! RON attributes at the start of a file: `#![enable(..)]`, `#![type = ".."]`, `#![schema = ".."]`.

use std::ops::Range;

use super::lexer::{Lexer, TokenKind, shorten};

const EXTENSIONS: [&str; 4] = [
    "unwrap_newtypes",
    "implicit_some",
    "unwrap_variant_newtypes",
    "explicit_struct_names",
];

/// Reads all attributes and returns their ranges, each from `#` to `]`; leaves the lexer at the
/// first token of the value.
pub(super) fn read(lexer: &mut Lexer<'_>) -> Vec<Range<usize>> {
    let mut attributes = Vec::new();
    lexer.skip_trivia();
    while lexer.byte(lexer.pos) == Some(b'#') {
        let start = lexer.pos;
        match attribute(lexer) {
            Ok(end) => attributes.push(start..end),
            Err((message, help)) => {
                // Everything before this position was valid.
                let at = lexer.pos;
                let width = lexer.rest().chars().next().map_or(0, char::len_utf8);
                let end = lexer.run_end(at, false).max(at + width);
                let found = match lexer.rest_of(at, end) {
                    "" => "the end of the file".to_owned(),
                    token => format!("`{}`", shorten(token)),
                };
                lexer.faults.add(
                    at as u32..end as u32,
                    format!("{message}, found {found}"),
                    help,
                );
                if lexer.rest_of(start, at).contains('\n') {
                    break;
                }
                // Skip to the bracket that ends the attribute, or else to the end of the line.
                lexer.pos += lexer.rest().find(['\n', ']']).unwrap_or(lexer.rest().len());
                lexer.pos += usize::from(lexer.byte(lexer.pos) == Some(b']'));
                lexer.cut_off = lexer.rest().is_empty();
            }
        }
        lexer.skip_trivia();
    }
    attributes
}

/// Parses an attribute and returns its end.
fn attribute(lexer: &mut Lexer<'_>) -> Result<usize, (String, &'static str)> {
    const FORM: &str =
        "an attribute is `#![enable(..)]`, `#![type = \"..\"]` or `#![schema = \"..\"]`";
    for mark in *b"#![" {
        eat(lexer, mark, FORM)?;
    }
    let has_list = match word(lexer) {
        "enable" => true,
        "type" | "schema" => false,
        other => {
            lexer.pos -= other.len();
            return Err(("expected `enable`, `type` or `schema`".into(), FORM));
        }
    };
    lexer.skip_trivia();
    if has_list {
        eat(lexer, b'(', FORM)?;
        extensions(lexer)?;
        eat(
            lexer,
            b')',
            "separate extensions with commas and close the list",
        )?;
    } else {
        eat(lexer, b'=', FORM)?;
        let start = lexer.pos;
        if !matches!(lexer.byte(start), Some(b'"' | b'r')) || lexer.next().kind != TokenKind::String
        {
            lexer.pos = start;
            return Err(("expected a string".into(), FORM));
        }
    }
    lexer.skip_trivia();
    let end = lexer.pos + 1;
    eat(lexer, b']', "close the attribute")?;
    Ok(end)
}

/// Parses one or more extension names separated by commas; a trailing comma is allowed.
fn extensions(lexer: &mut Lexer<'_>) -> Result<(), (String, &'static str)> {
    loop {
        let name = word(lexer);
        if !EXTENSIONS.contains(&super::text::name(name)) {
            lexer.pos -= name.len();
            return Err((
                "expected the name of an extension".into(),
                "scenes need none: remove the attribute",
            ));
        }
        lexer.skip_trivia();
        let comma = lexer.byte(lexer.pos) == Some(b',');
        if comma {
            lexer.pos += 1;
            lexer.skip_trivia();
        }
        if !comma || lexer.run_end(lexer.pos, false) == lexer.pos {
            return Ok(());
        }
    }
}

fn eat(lexer: &mut Lexer<'_>, mark: u8, help: &'static str) -> Result<(), (String, &'static str)> {
    if lexer.byte(lexer.pos) != Some(mark) {
        return Err((format!("expected `{}`", mark as char), help));
    }
    lexer.pos += 1;
    lexer.fresh = false;
    lexer.skip_trivia();
    Ok(())
}

fn word<'t>(lexer: &mut Lexer<'t>) -> &'t str {
    let start = lexer.pos;
    let head = if lexer.rest().starts_with("r#") { 2 } else { 0 };
    lexer.pos = lexer.run_end(start + head, false);
    lexer.rest_of(start, lexer.pos)
}
