//! The names of many pictures: a pattern with placeholders for the parts that differ.

use std::fmt;

use super::super::failure::Failure;

/// A name with placeholders, such as `out/{scene}_{frame:04}.png`; `{{` and `}}` are braces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pattern {
    text: String,
    parts: Vec<PatternPart>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum PatternPart {
    Text(String),
    /// A placeholder for a value, with a width to which numbers are padded with zeros.
    Place(String, usize),
}

impl Pattern {
    /// Parses a pattern.
    pub(crate) fn parse(text: &str) -> Result<Self, Failure> {
        let wrong = |what: &str| {
            let help = "write a placeholder as {frame} or {frame:04}, a brace as {{ or }}";
            Failure::usage(format!("{text}: {what}; {help}"))
        };
        let mut parts = Vec::new();
        let mut literal = String::new();
        let mut rest = text;
        while let Some(at) = rest.find(['{', '}']) {
            let (before, brace) = rest.split_at(at);
            literal.push_str(before);
            if brace.starts_with("{{") || brace.starts_with("}}") {
                literal.push_str(&brace[..1]);
                rest = &brace[2..];
                continue;
            }
            let place = brace
                .strip_prefix('{')
                .ok_or_else(|| wrong("`}` without `{`"))?;
            let (place, behind) = place
                .split_once('}')
                .ok_or_else(|| wrong("`{` without `}`"))?;
            let (name, width) = match place.split_once(':') {
                None => (place, 0),
                Some((name, width)) => {
                    let digits = width.strip_prefix('0').unwrap_or(width);
                    let width = digits.parse().ok().filter(|width| *width < 100);
                    (
                        name,
                        width.ok_or_else(|| wrong("the width is not a number"))?,
                    )
                }
            };
            if !literal.is_empty() {
                parts.push(PatternPart::Text(std::mem::take(&mut literal)));
            }
            parts.push(PatternPart::Place(name.trim().to_owned(), width));
            rest = behind;
        }
        literal.push_str(rest);
        if !literal.is_empty() {
            parts.push(PatternPart::Text(literal));
        }
        Ok(Self {
            text: text.to_owned(),
            parts,
        })
    }

    /// Returns the names of the placeholders.
    pub(crate) fn places(&self) -> impl Iterator<Item = &str> + Clone {
        self.parts.iter().filter_map(|part| match part {
            PatternPart::Place(name, _) => Some(&**name),
            PatternPart::Text(_) => None,
        })
    }

    /// Returns true if there is a placeholder for a value.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.places().any(|place| place == name)
    }

    /// Returns the text before the first placeholder.
    pub(crate) fn beginning(&self) -> &str {
        match self.parts.first() {
            Some(PatternPart::Text(text)) => text,
            _ => "",
        }
    }

    /// Returns the pattern with values for its placeholders; those with `None` stay as they are.
    pub(crate) fn fill(&self, mut value: impl FnMut(&str) -> Option<String>) -> String {
        let mut filled = String::new();
        for part in &self.parts {
            match part {
                PatternPart::Text(text) => filled.push_str(text),
                PatternPart::Place(name, width) => match value(name) {
                    Some(value) if value.bytes().all(|byte| byte.is_ascii_digit()) => {
                        filled.push_str(&format!("{value:0>width$}", width = *width));
                    }
                    Some(value) => filled.push_str(&value),
                    None => filled.push_str(&format!("{{{name}}}")),
                },
            }
        }
        filled
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(text: &str) -> String {
        Pattern::parse(text).unwrap().fill(|name| match name {
            "frame" => Some("7".to_owned()),
            "scene" => Some("a".to_owned()),
            _ => None,
        })
    }

    #[test]
    fn placeholders_are_filled() {
        for (text, expected) in [
            ("x.png", "x.png"),
            ("{scene}_{frame:04}.png", "a_0007.png"),
            ("{frame}{frame:2}{scene:04}", "707a"),
            ("{{scene}}-{camera}", "{scene}-{camera}"),
            ("", ""),
        ] {
            assert_eq!(filled(text), expected, "{text}");
        }
    }

    #[test]
    fn wrong_patterns_are_rejected() {
        for text in ["{", "}", "a{b", "a}b", "{a:b}", "{a:}", "{a:0999}"] {
            assert!(Pattern::parse(text).is_err(), "{text}");
        }
    }
}
