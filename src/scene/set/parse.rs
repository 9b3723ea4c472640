//! Parser of `PATH=VALUE`.

use std::{error::Error, fmt, str::FromStr};

use super::Setting;
use crate::scene::path::parts_before;

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

/// Same as `Display`, because a `main` that returns an error prints it with `Debug`.
impl fmt::Debug for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Error for SettingError {}

impl FromStr for Setting {
    type Err = SettingError;

    fn from_str(text: &str) -> Result<Self, SettingError> {
        let read = parts_before(text).and_then(|(steps, rest)| {
            let value = rest.strip_prefix('=').ok_or("`=` after the path")?;
            Ok((steps, text.len() - value.len()))
        });
        let (steps, value) = read.map_err(|expected| SettingError { expected })?;
        Ok(Self {
            text: text.to_owned(),
            steps,
            value,
            syntax: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::path::Step;

    fn read(text: &str) -> String {
        let setting: Setting = text.parse().unwrap();
        for part in &setting.steps {
            let shown = &text[part.range.clone()];
            match part.name() {
                Some(name) => assert!(shown.contains(name) || shown.contains('\\')),
                None => assert_eq!(part.step, Step::Index(shown.parse().unwrap())),
            }
        }
        let steps = setting.steps.iter().map(|part| match part.name() {
            Some(name) => format!("<{name}>"),
            None => format!("<#{}>", &text[part.range.clone()]),
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
    fn wrong_paths_are_rejected() {
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
