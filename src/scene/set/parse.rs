//! Reading `PATH=VALUE`, and a path alone.

use std::{error::Error, fmt, str::FromStr};

use super::{Setting, Step, To};
use crate::text::syntax::{Syntax, string};

/// A text that is not `PATH=VALUE`.
#[derive(Clone, PartialEq, Eq)]
pub struct SettingError {
    expected: &'static str,
}

impl fmt::Display for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "expected {}; a setting is written PATH=VALUE, such as camera.fov=60 or \
             geometries[3].radius=0.5",
            self.expected
        )
    }
}

/// As it is displayed: `main` prints an error that it returns this way.
impl fmt::Debug for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Error for SettingError {}

const fn expected<T>(expected: &'static str) -> Result<T, SettingError> {
    Err(SettingError { expected })
}

impl FromStr for Setting {
    type Err = SettingError;

    fn from_str(text: &str) -> Result<Self, SettingError> {
        let mut reader = Reader { text, at: 0 };
        let steps = reader.steps()?;
        if !reader.take('=') {
            return expected("`=` behind the path");
        }
        Ok(Self {
            text: text.to_owned(),
            steps,
            value: reader.at,
        })
    }
}

/// The steps of a path that stands alone, or what would have to stand there.
pub(crate) fn path_steps(text: &str) -> Result<Vec<Step>, &'static str> {
    let mut reader = Reader { text, at: 0 };
    let steps = reader.steps().map_err(|error| error.expected)?;
    if reader.rest().is_empty() {
        Ok(steps)
    } else {
        Err("`.` or `[` between the parts of the path")
    }
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Reader<'t> {
    /// What has not been read yet, behind blanks.
    fn rest(&mut self) -> &'t str {
        let rest = self.text[self.at..].trim_start();
        self.at = self.text.len() - rest.len();
        rest
    }

    /// Whether a character comes next; if so, it is taken.
    fn take(&mut self, character: char) -> bool {
        let found = self.rest().starts_with(character);
        self.at += usize::from(found);
        found
    }

    /// What ends before one of these characters.
    fn until(&mut self, ends: &[char]) -> (&'t str, Step) {
        let rest = self.rest();
        let length = rest.find(ends).unwrap_or(rest.len());
        let found = rest[..length].trim_end();
        let range = self.at..self.at + found.len();
        self.at += length;
        let to = To::Name(found.into());
        (found, Step { to, range })
    }

    /// Names with dots between them, each with what stands in brackets behind it.
    fn steps(&mut self) -> Result<Vec<Step>, SettingError> {
        let mut steps = Vec::new();
        loop {
            steps.push(self.name()?);
            while self.take('[') {
                steps.push(self.in_brackets()?);
            }
            if !self.take('.') {
                return Ok(steps);
            }
        }
    }

    fn name(&mut self) -> Result<Step, SettingError> {
        match self.until(&['.', '[', '=']) {
            ("", _) => expected("the name of a field"),
            (_, step) => Ok(step),
        }
    }

    /// An index, or a name in quotes.
    fn in_brackets(&mut self) -> Result<Step, SettingError> {
        let step = if self.rest().starts_with('"') {
            self.quoted()?
        } else {
            let (digits, step) = self.until(&[']']);
            if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
                return expected("an index or a name in quotes behind `[`");
            }
            let Ok(index) = digits.parse() else {
                return expected("an index that a list can have");
            };
            let to = To::Index(index);
            Step { to, ..step }
        };
        if self.take(']') {
            Ok(step)
        } else {
            expected("`]`")
        }
    }

    fn quoted(&mut self) -> Result<Step, SettingError> {
        let rest = self.rest();
        let mut is_escaped = true;
        let end = rest.find(|character| {
            let ends = character == '"' && !is_escaped;
            is_escaped = character == '\\' && !is_escaped;
            ends
        });
        let source = end.and_then(|end| rest.get(..=end));
        match source.and_then(|source| Some((source, string(source, Syntax::Ron)?))) {
            None => expected("a quote behind the name"),
            Some((source, name)) => {
                let range = self.at..self.at + source.len();
                self.at = range.end;
                let to = To::Name((*name).into());
                Ok(Step { to, range })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> String {
        let setting: Setting = text.parse().unwrap();
        for step in &setting.steps {
            let shown = &text[step.range.clone()];
            match &step.to {
                To::Name(name) => assert!(shown.contains(&**name) || shown.contains('\\')),
                To::Index(index) => assert_eq!(shown, index.to_string()),
            }
        }
        let steps = setting.steps.iter().map(|step| match &step.to {
            To::Name(name) => format!("<{name}>"),
            To::Index(index) => format!("<#{index}>"),
        });
        let steps: String = steps.collect();
        format!("{steps}{}|{}", setting.value(), setting.path())
    }

    #[test]
    fn paths_are_those_of_diagnostics() {
        for (text, expected) in [
            ("camera.fov=60", "<camera><fov>60|camera.fov"),
            ("background=", "<background>|background"),
            (
                "geometries[3].color = \"#0=f\"",
                "<geometries><#3><color> \"#0=f\"|geometries[3].color",
            ),
            ("a[1][2]=x", "<a><#1><#2>x|a[1][2]"),
            (
                "cameras[\"a.b=[c]\"].fov=1",
                "<cameras><a.b=[c]><fov>1|cameras[\"a.b=[c]\"].fov",
            ),
            (
                r#"g["a \"b\" \\"].x=1"#,
                r#"<g><a "b" \><x>1|g["a \"b\" \\"].x"#,
            ),
            (
                "cameras.front 2.fov=1",
                "<cameras><front 2><fov>1|cameras.front 2.fov",
            ),
            ("é . ü = 1", "<é><ü> 1|é . ü"),
        ] {
            assert_eq!(read(text), expected);
        }
    }

    #[test]
    fn what_is_no_path_is_refused() {
        for text in [
            "",
            "=",
            "camera",
            "camera.=1",
            ".fov=1",
            "a[]=1",
            "a[-1]=1",
            "a[99999999999999999999999]=1",
            "a[1=1",
            "a[b]=1",
            "a[\"b]=1",
            "a[\"b\"=1",
            "a[1]b=1",
            "a[\"\\q\"]=1",
            "[0]=1",
        ] {
            assert!(text.parse::<Setting>().is_err(), "{text}");
        }
    }
}
