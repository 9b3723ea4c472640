//! Non-ASCII characters that text processors and keyboards put in place of punctuation, and those
//! that look like a space.

/// Returns the ASCII character that a lookalike replaces, and its name.
pub(super) fn punctuation(c: char) -> Option<(u8, &'static str)> {
    Some(match c {
        '，' | '、' | '‚' | '،' => (b',', "a comma `,`"),
        '；' => (b',', "a comma `,`"),
        '：' | '∶' | '＝' => (b':', "a colon `:`"),
        '（' | '❨' => (b'(', "an opening parenthesis `(`"),
        '）' | '❩' => (b')', "a closing parenthesis `)`"),
        '［' | '【' | '〔' => (b'[', "an opening bracket `[`"),
        '］' | '】' | '〕' => (b']', "a closing bracket `]`"),
        '｛' => (b'{', "an opening brace `{`"),
        '｝' => (b'}', "a closing brace `}`"),
        '“' | '”' | '„' | '‟' | '″' | '＂' | '«' | '»' | '「' | '」' | '‘' | '’' | '＇' => {
            (b'"', "a straight quote `\"`")
        }
        '−' | '–' | '—' | '‐' | '‑' | '－' => (b'-', "an ASCII minus `-`"),
        _ => return None,
    })
}

/// Returns true if `ron` treats a non-ASCII character as white space.
pub(super) fn is_ron_space(c: char) -> bool {
    matches!(
        c,
        '\u{85}' | '\u{200e}' | '\u{200f}' | '\u{2028}' | '\u{2029}'
    )
}

/// Returns true if a character looks like white space or is invisible.
pub(super) fn is_odd_space(c: char) -> bool {
    c.is_whitespace()
        || is_ron_space(c)
        || matches!(
            c,
            '\u{200b}'..='\u{200d}' | '\u{2060}' | '\u{feff}' | '\u{ad}'
        )
}
