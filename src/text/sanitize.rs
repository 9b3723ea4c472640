//! Sanitizes text from a scene or a file name for display.
//!
//! A raw escape character could recolor or rewrite the reader's terminal, and a direction override
//! could make one line look like another.

use std::borrow::Cow;

/// Returns a visible replacement for an invisible or unsafe character; returns any other character
/// unchanged.
pub(crate) const fn shown(character: char) -> char {
    match character {
        // Unicode has a control picture for every C0 control character.
        '\0'..='\u{1f}' => match char::from_u32(0x2400 + character as u32) {
            Some(picture) => picture,
            None => char::REPLACEMENT_CHARACTER,
        },
        '\u{7f}' => '\u{2421}',
        // The other controls: C1, line and paragraph separators, bidirectional controls.
        '\u{80}'..='\u{9f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
            char::REPLACEMENT_CHARACTER
        }
        // Invisible, and often the actual fault: soft hyphen, Arabic letter mark, zero-width space,
        // direction marks, word joiner, a byte order mark inside the text.
        '\u{ad}' | '\u{61c}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{feff}' => {
            char::REPLACEMENT_CHARACTER
        }
        // Also invisible: the Mongolian vowel separator, the word joiner and invisible operators,
        // deprecated controls for digit shapes and joining, annotation controls, and tags, which
        // spell hidden text.
        '\u{180e}' | '\u{2060}'..='\u{2064}' | '\u{206a}'..='\u{206f}' => {
            char::REPLACEMENT_CHARACTER
        }
        '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}' => char::REPLACEMENT_CHARACTER,
        // Noncharacters; XML rejects them.
        '\u{fffe}' | '\u{ffff}' => char::REPLACEMENT_CHARACTER,
        other => other,
    }
}

/// Replaces line breaks, invisible characters and characters that control a terminal; the result is
/// a single line.
///
/// # Examples
///
/// ```
/// assert_eq!(strahl::text::sanitize("\u{1b}[2Ja.png\n"), "␛[2Ja.png␊");
/// ```
pub fn sanitize(text: &str) -> Cow<'_, str> {
    if text.chars().all(|character| shown(character) == character) {
        Cow::Borrowed(text)
    } else {
        Cow::Owned(text.chars().map(shown).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_replaced() {
        assert_eq!(sanitize("\u{1b}[31mred\r\n\t\u{7f}"), "␛[31mred␍␊␉␡");
        for hidden in ['\u{2066}', '\u{2063}', '\u{e0041}', '\u{180e}', '\u{fffa}'] {
            assert_eq!(sanitize(&hidden.to_string()), "\u{fffd}", "{hidden:?}");
        }
        assert_eq!(
            sanitize("a\u{9b}b\u{202e}c\u{200b}d\u{ffff}"),
            "a\u{fffd}b\u{fffd}c\u{fffd}d\u{fffd}"
        );
    }

    #[test]
    fn nothing_else_changes() {
        let text = "radius `-1` 日本 🙂 é";
        assert!(matches!(sanitize(text), Cow::Borrowed(same) if same == text));
    }
}
