//! Edits that add a camera, a light or a geometry to a scene.

use std::sync::OnceLock;

use crate::{
    diagnostic::{error::Error, named::named},
    scene::{
        document::Document, format::scene::Model, locate::items, options::ReadOptions,
        recover::text::name_of, source::Source,
    },
    session::checked::Checked,
    text::{
        edit::Edit,
        syntax::{NodeId, Syntax},
    },
};

named! {
    /// A list of parts, by the name of its field, in the order of their names in a scene.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum PartList {
        /// The named cameras.
        Cameras = "cameras",
        /// The lights.
        Lights = "lights",
        /// The geometries.
        Geometries = "geometries",
    }
}

impl PartList {
    /// Returns the variants that can be added, each with its text. Those that need more than a sample,
    /// such as a file, are left out.
    pub fn samples(self, syntax: Syntax) -> &'static [(String, String)] {
        type Samples = OnceLock<Vec<(String, String)>>;
        static SAMPLES: [[Samples; 3]; 2] = [const { [const { OnceLock::new() }; 3] }; 2];
        let known = SAMPLES.get(syntax as usize);
        let known = known.and_then(|lists| lists.get(self as usize));
        known.map_or(&[], |known| known.get_or_init(|| self.find_samples(syntax)))
    }

    fn find_samples(self, syntax: Syntax) -> Vec<(String, String)> {
        let [open, close] = syntax.brackets();
        let (camera, ball) = match syntax {
            Syntax::Ron => (
                "Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 60)",
                "Sphere(center: (0, 0, 0), radius: 1, color: \"#fff\")",
            ),
            Syntax::Json => (
                r#"{"Perspective": {"eye": [0, 0, 9], "gaze": [0, 0, -1], "fov": 60}}"#,
                r##"{"Sphere": {"center": [0, 0, 0], "radius": 1, "color": "#fff"}}"##,
            ),
        };
        let camera = syntax.key("camera") + camera;
        let ball = format!("{}[{ball}]", syntax.key(Model::LONG));
        let list = syntax.key(self.name()) + "[";
        let (others, field, end) = match self {
            Self::Cameras => (ball, syntax.key("camera"), ""),
            Self::Lights => (format!("{camera}, {ball}"), list, "]"),
            Self::Geometries => (camera, list, "]"),
        };
        let before = format!("{open}{others}, {field}");
        let after = format!("{end}{close}");
        let source = Source::new(format!("{before}{after}"), syntax);
        let found = source.completions(before.len(), &ReadOptions::new());
        let samples = found
            .items
            .into_iter()
            .map(|item| (item.label, item.insert));
        let is_whole = |(_, sample): &(String, String)| {
            let text = format!("{before}{sample}{after}");
            !Document::from_text("sample", text, syntax).has_errors()
        };
        samples.filter(is_whole).collect()
    }
}

impl Checked {
    /// Returns the edits that add a part to the end of a list, by the name of its variant.
    ///
    /// # Errors
    ///
    /// A variant without a sample, and a text without a list of geometries.
    pub fn add_part(&self, list: PartList, variant: &str) -> Result<Vec<Edit>, Error> {
        let syntax = self.document.syntax();
        let mut samples = list.samples(syntax).iter();
        let (_, sample) = samples
            .find(|(name, _)| name == variant)
            .ok_or_else(|| Error::refused("this cannot be added"))?;
        let part = match list {
            PartList::Cameras => format!("{:?}: {sample}", self.new_camera()),
            _ => sample.clone(),
        };
        if let Some((_, value)) = self.field(list.name()) {
            return Ok(self.add_to(list, value, part));
        }
        let (text, tree) = (self.document.text(), self.document.source().tree());
        let (key, _) = self
            .field(Model::LONG)
            .ok_or_else(|| Error::refused("the scene has no list of geometries"))?;
        let start = tree.node(key).range().start;
        let indent =
            indent(text, start).map_or_else(|| " ".to_owned(), |indent| format!("\n{indent}"));
        let name = syntax.key(list.name());
        let (open, close) = match list {
            PartList::Cameras => ('{', '}'),
            _ => ('[', ']'),
        };
        let field = format!("{name}{open}{part}{close},{indent}");
        Ok(vec![Edit::insert(start, field)])
    }

    /// Returns the edits that add the text of a part to a list of the text.
    fn add_to(&self, list: PartList, value: NodeId, part: String) -> Vec<Edit> {
        let (text, tree) = (self.document.text(), self.document.source().tree());
        let last = match list {
            PartList::Cameras => tree.fields(value).last().map(|(_, camera)| camera),
            _ => items(tree, value).last().copied(),
        };
        let last = last.map(|last| tree.node(last).range().end);
        let end = tree.node(value).range().end.saturating_sub(1);
        let lacks_comma = last.filter(|last| self.comma_after(*last).is_none());
        if lacks_comma == Some(end) {
            return vec![Edit::insert(end, format!(", {part}"))];
        }
        let mut edits: Vec<_> = lacks_comma
            .map(|last| Edit::insert(last, ","))
            .into_iter()
            .collect();
        let comma = if self.document.syntax() == Syntax::Ron {
            ","
        } else {
            ""
        };
        edits.push(match (indent(text, end), last) {
            (Some(indent), _) => {
                Edit::insert(end - indent.len(), format!("{indent}    {part}{comma}\n"))
            }
            (None, None) => Edit::insert(end, part),
            (None, Some(_)) => Edit::insert(end, format!(" {part}")),
        });
        edits
    }

    /// Returns the key and the value of a field of the scene.
    fn field(&self, name: &str) -> Option<(NodeId, NodeId)> {
        let (text, tree) = (self.document.text(), self.document.source().tree());
        let mut fields = tree.fields(tree.root()?);
        fields.find(|(key, _)| name_of(text, tree, *key) == name)
    }

    /// Returns a name that no camera has.
    fn new_camera(&self) -> String {
        let mut names = (1..).map(|number| format!("camera {number}"));
        let parts = self.parts();
        let is_new = |name: &String| parts.iter().all(|part| part.name != *name);
        names.find(is_new).unwrap_or_default()
    }
}

/// Returns the blanks before an offset, if nothing else is before it in its line.
fn indent(text: &str, at: usize) -> Option<&str> {
    let before = text.get(..at)?;
    let line = before.rfind('\n').map_or(0, |end| end + 1);
    before
        .get(line..)
        .filter(|line| line.trim().is_empty() && line.len() < before.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::tests::{TEXT, checked, edited};

    #[test]
    fn every_sample_is_added_to_every_text() {
        let json = r##"{
    "camera": {"Fit": {}},
    "geometries": [{"Sphere": {"center": [0, 0, 0], "radius": 1, "color": "#f00"}}]
}
"##;
        let inline = r##"(camera: Fit(), cameras: {"camera 1": Fit()}, lights: [], geometries: [
            Sphere(center: (0, 0, 0), radius: 1, color: "#f00") // last
        ])"##;
        for text in [TEXT, json, inline] {
            let found = checked(text);
            for &list in PartList::ALL {
                let samples = list.samples(found.document().syntax());
                let least = if list == PartList::Geometries { 11 } else { 3 };
                assert!(samples.len() >= least, "{samples:?}");
                for (variant, _) in samples {
                    let new = edited(text, &found.add_part(list, variant).unwrap());
                    let again = checked(&new);
                    assert!(!again.document().has_errors(), "{new}");
                    // A solid has others inside.
                    assert!(again.parts().len() > found.parts().len(), "{new}");
                }
            }
            assert!(found.add_part(PartList::Geometries, "Spheres").is_err());
        }
    }
}
