//! The values of strings, characters and names with escapes resolved. The lexer checks escapes with
//! the same functions.

use std::borrow::Cow;
use std::ops::Range;

use super::language::Syntax;

/// An invalid escape: its byte range, relative to the start of the content, and what to write
/// instead.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct BadEscape {
    pub(crate) range: Range<usize>,
    pub(crate) help: &'static str,
}

/// The kind of quotes around the content, which determines the valid escapes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Quote {
    Json,
    /// RON `".."`.
    Ron,
    /// RON `b".."`: `\x` is a byte, not part of a UTF-8 sequence.
    RonBytes,
    /// RON `'.'`.
    RonChar,
    /// RON `b'.'`.
    RonByte,
}

/// Decodes a string; `token` is the source text, quotes included.
///
/// Returns `None` if it is not a string, not closed, or has an escape that the syntax does not
/// support.
#[must_use]
pub(crate) fn string(token: &str, syntax: Syntax) -> Option<Cow<'_, str>> {
    if syntax == Syntax::Ron
        && let Some(raw) = token.strip_prefix('r')
    {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        let inner = raw.get(hashes..raw.len().checked_sub(hashes)?)?;
        return Some(Cow::Borrowed(inner.strip_prefix('"')?.strip_suffix('"')?));
    }
    let content = token.strip_prefix('"')?.strip_suffix('"')?;
    if !content.contains(['\\', '"']) {
        let plain = syntax == Syntax::Ron || content.bytes().all(|b| b >= b' ');
        return plain.then_some(Cow::Borrowed(content));
    }
    let quote = if syntax == Syntax::Ron {
        Quote::Ron
    } else {
        Quote::Json
    };
    let bytes = unescape(content, quote).ok()?;
    String::from_utf8(bytes).ok().map(Cow::Owned)
}

/// Returns the name of an identifier, without RON's `r#`.
#[must_use]
pub(crate) fn name(token: &str) -> &str {
    token.strip_prefix("r#").unwrap_or(token)
}

const UNFINISHED: &str = "write `\\\\` for a backslash";

/// Resolves the escapes in the text between two quotes.
pub(super) fn unescape(content: &str, quote: Quote) -> Result<Vec<u8>, BadEscape> {
    let bytes = content.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let start = at;
        at += 1;
        // A quote in the content means that the token is not a single string.
        let ends = byte == b'"' && !matches!(quote, Quote::RonChar | Quote::RonByte);
        if ends || (quote == Quote::Json && byte < b' ') {
            return Err(BadEscape {
                range: start..at,
                help: "write it as an escape",
            });
        }
        if byte != b'\\' {
            out.push(byte);
            continue;
        }
        match escape(content, at, quote, &mut out) {
            Ok(end) => at = end,
            Err(help) => {
                let letter = content
                    .get(at..)
                    .and_then(|rest| rest.chars().next())
                    .map_or(0, char::len_utf8);
                return Err(BadEscape {
                    range: start..at + letter,
                    help,
                });
            }
        }
    }
    Ok(out)
}

/// Resolves one escape and returns its end; `at` is the byte after the backslash.
fn escape(
    content: &str,
    at: usize,
    quote: Quote,
    out: &mut Vec<u8>,
) -> Result<usize, &'static str> {
    let bytes = content.as_bytes();
    let json = quote == Quote::Json;
    let letter = *bytes.get(at).ok_or(UNFINISHED)?;
    let simple = match letter {
        b'"' | b'\\' => letter,
        b'n' => b'\n',
        b'r' => b'\r',
        b't' => b'\t',
        b'/' if json => b'/',
        b'b' if json => 8,
        b'f' if json => 12,
        b'u' if json => return json_unicode(bytes, at + 1, out),
        b'\'' if !json => b'\'',
        b'0' if !json => 0,
        b'x' if !json => return ron_hex(bytes, at + 1, quote, out),
        b'u' if !json && quote != Quote::RonByte => return ron_unicode(bytes, at + 1, out),
        b'\n' | b'\r' if matches!(quote, Quote::Ron | Quote::RonBytes) => {
            let line = at
                + if bytes.get(at..at + 2) == Some(b"\r\n") {
                    2
                } else {
                    1
                };
            if letter == b'\r' && line == at + 1 {
                return Err(UNFINISHED);
            }
            let rest = bytes.get(line..).unwrap_or_default();
            let space = rest
                .iter()
                .take_while(|b| matches!(b, b' ' | b'\t' | b'\n' | b'\r'))
                .count();
            return Ok(line + space);
        }
        _ => return Err(UNFINISHED),
    };
    out.push(simple);
    Ok(at + 1)
}

fn hex(bytes: &[u8], at: usize, digits: usize) -> Option<u32> {
    let mut value = 0;
    for &byte in bytes.get(at..at + digits)? {
        value = value << 4 | (byte as char).to_digit(16)?;
    }
    Some(value)
}

fn push(c: char, out: &mut Vec<u8>) {
    out.extend_from_slice(c.encode_utf8(&mut [0; 4]).as_bytes());
}

fn json_unicode(bytes: &[u8], at: usize, out: &mut Vec<u8>) -> Result<usize, &'static str> {
    const HALF: &str = "a character above U+FFFF takes two escapes, as `\\ud83d\\ude00`";
    let first = hex(bytes, at, 4).ok_or("write four hexadecimal digits after `\\u`")?;
    if !(0xd800..0xdc00).contains(&first) {
        push(char::from_u32(first).ok_or(HALF)?, out);
        return Ok(at + 4);
    }
    let second = if bytes.get(at + 4..at + 6) == Some(b"\\u") {
        hex(bytes, at + 6, 4)
    } else {
        None
    };
    let low = second
        .filter(|low| (0xdc00..0xe000).contains(low))
        .ok_or(HALF)?;
    push(
        char::from_u32(0x1_0000 + ((first - 0xd800) << 10) + (low - 0xdc00)).ok_or(HALF)?,
        out,
    );
    Ok(at + 10)
}

/// Resolves `\xNN`. In a string, several in a row may be the bytes of one character.
fn ron_hex(
    bytes: &[u8],
    mut at: usize,
    quote: Quote,
    out: &mut Vec<u8>,
) -> Result<usize, &'static str> {
    const DIGITS: &str = "write two hexadecimal digits after `\\x`";
    let mut sequence = [0; 4];
    for count in 1..=4 {
        let byte = hex(bytes, at, 2).ok_or(DIGITS)? as u8;
        at += 2;
        if matches!(quote, Quote::RonBytes | Quote::RonByte) {
            out.push(byte);
            return Ok(at);
        }
        if let Some(slot) = sequence.get_mut(count - 1) {
            *slot = byte;
        }
        let so_far = sequence.get(..count).unwrap_or_default();
        if std::str::from_utf8(so_far).is_ok() {
            out.extend_from_slice(so_far);
            return Ok(at);
        }
        if quote == Quote::RonChar || bytes.get(at..at + 2) != Some(b"\\x") {
            break;
        }
        at += 2;
    }
    Err("write a character outside ASCII as `\\u{..}`")
}

fn ron_unicode(bytes: &[u8], at: usize, out: &mut Vec<u8>) -> Result<usize, &'static str> {
    const FORM: &str = "write `\\u{..}` with one to six hexadecimal digits";
    let rest = bytes
        .get(at..)
        .and_then(|rest| rest.strip_prefix(b"{"))
        .ok_or(FORM)?;
    let digits = rest
        .iter()
        .position(|&b| b == b'}')
        .filter(|&n| (1..=6).contains(&n))
        .ok_or(FORM)?;
    let value = hex(rest, 0, digits).ok_or(FORM)?;
    push(
        char::from_u32(value).ok_or("there is no such character")?,
        out,
    );
    Ok(at + digits + 2)
}
