//! The cameras, lights and geometries of a scene, and edits that hide or add one.

use std::{ops::Range, sync::OnceLock};

use crate::{
    diagnostic::error::Error,
    scene::{
        assist::{Symbol, SymbolKind},
        document::Document,
        format::scene::Model,
        locate::items,
        options::ReadOptions,
        recover::name_of,
        source::Source,
    },
    session::{Checked, refused},
    text::{
        edit::Edit,
        syntax::{NodeId, Syntax},
    },
};

/// A camera, a light or a geometry of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// The kind: a camera, a light or a geometry.
    pub kind: SymbolKind,
    /// The name, or the index in brackets.
    pub name: String,
    /// The variant.
    pub variant: String,
    /// The number of geometries around it.
    pub level: usize,
    /// True if it is in a comment that [`Checked::hide_or_show`] wrote.
    pub is_hidden: bool,
    /// The range of the text.
    pub range: Range<usize>,
}

/// The start and the end of the comment around a hidden part.
const HIDDEN: [&str; 2] = ["/* hidden: ", " */"];

/// A list of parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartList {
    /// The named cameras.
    Cameras,
    /// The lights.
    Lights,
    /// The geometries.
    Geometries,
}

impl PartList {
    /// All, in the order of their names in a scene.
    pub const ALL: [Self; 3] = [Self::Cameras, Self::Lights, Self::Geometries];

    /// Returns the name of the field.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cameras => "cameras",
            Self::Lights => "lights",
            Self::Geometries => Model::LONG,
        }
    }

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
        let key = |name: &str| match syntax {
            Syntax::Ron => format!("{name}: "),
            Syntax::Json => format!("\"{name}\": "),
        };
        let (open, close, camera, ball) = match syntax {
            Syntax::Ron => (
                '(',
                ')',
                "Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 60)",
                "Sphere(center: (0, 0, 0), radius: 1, color: \"#fff\")",
            ),
            Syntax::Json => (
                '{',
                '}',
                r#"{"Perspective": {"eye": [0, 0, 9], "gaze": [0, 0, -1], "fov": 60}}"#,
                r##"{"Sphere": {"center": [0, 0, 0], "radius": 1, "color": "#fff"}}"##,
            ),
        };
        let camera = format!("{}{camera}", key("camera"));
        let ball = format!("{}[{ball}]", key(Model::LONG));
        let others = match self {
            Self::Cameras => ball,
            Self::Lights => format!("{camera}, {ball}"),
            Self::Geometries => camera,
        };
        let (before, after) = match self {
            Self::Cameras => (
                format!("{open}{others}, {}", key("camera")),
                close.to_string(),
            ),
            _ => (
                format!("{open}{others}, {}[", key(self.name())),
                format!("]{close}"),
            ),
        };
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
    /// Returns the parts of the text, in its order, those that are hidden among them.
    pub fn parts(&self) -> Vec<Part> {
        let mut parts = Vec::new();
        for symbol in self.document.source().symbols() {
            if symbol.kind == SymbolKind::Camera {
                add(&mut parts, &symbol, 0);
            } else if PartList::ALL.iter().any(|list| list.name() == symbol.name) {
                let children = symbol.children.iter();
                children.for_each(|child| add(&mut parts, child, 0));
                parts.extend(self.hidden(&symbol));
            }
        }
        parts.sort_by_key(|part| part.range.start);
        parts
    }

    /// Returns the hidden parts of a list.
    fn hidden(&self, list: &Symbol) -> Vec<Part> {
        let (text, tree) = (self.document.text(), self.document.source().tree());
        let comments = tree.comments_in(list.range.clone()).iter();
        let parts = comments.filter_map(|comment| {
            let range = comment.range();
            let content = text.get(range.clone())?.strip_prefix(HIDDEN[0])?;
            let content = format!("({}: [{}])", list.name, content.strip_suffix(HIDDEN[1])?);
            let symbols = Source::new(content, Syntax::Ron).symbols();
            let symbol = symbols.first()?.children.first()?.clone();
            Some(Part {
                kind: symbol.kind,
                name: symbol.name,
                variant: symbol.detail,
                level: level_at(&list.children, range.start),
                is_hidden: true,
                range,
            })
        });
        parts.collect()
    }

    /// Returns the edits that put the light or the geometry at an offset into a comment, or take it out again.
    ///
    /// # Errors
    ///
    /// A JSON text, which has no comments, and an offset where neither starts.
    pub fn hide_or_show(&self, offset: usize) -> Result<Vec<Edit>, Error> {
        let mut parts = self.parts().into_iter();
        let part = parts.find(|part| part.range.start == offset && part.kind != SymbolKind::Camera);
        let part = part.ok_or_else(|| refused("a light or a geometry can be hidden"))?;
        let Range { start, end } = part.range;
        let [open, close] = HIDDEN;
        if part.is_hidden {
            return Ok(vec![
                Edit::remove(start..start + open.len()),
                Edit::remove(end - close.len()..end),
            ]);
        }
        if self.document.syntax() == Syntax::Json {
            return Err(refused(
                "nothing can be hidden in JSON, which has no comments; RON has",
            ));
        }
        let end = self.comma_after(end).unwrap_or(end);
        let text = self.document.text().get(start..end).unwrap_or_default();
        if text.matches("/*").count() != text.matches("*/").count() {
            return Err(refused(
                "a text with half a comment cannot be hidden in one",
            ));
        }
        Ok(vec![Edit::insert(start, open), Edit::insert(end, close)])
    }

    /// Returns the end of the comma that follows an offset, after blanks and comments.
    fn comma_after(&self, mut at: usize) -> Option<usize> {
        let (text, tree) = (self.document.text(), self.document.source().tree());
        loop {
            let rest = text.get(at..)?;
            at += rest.len() - rest.trim_start().len();
            match tree.comments_in(at..at + 1).first() {
                Some(comment) => at = comment.range().end,
                None => return text.get(at..)?.starts_with(',').then_some(at + 1),
            }
        }
    }

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
            .ok_or_else(|| refused("this cannot be added"))?;
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
            .ok_or_else(|| refused("the scene has no list of geometries"))?;
        let start = tree.node(key).range().start;
        let indent =
            indent(text, start).map_or_else(|| " ".to_owned(), |indent| format!("\n{indent}"));
        let name = match syntax {
            Syntax::Ron => list.name().to_owned(),
            Syntax::Json => format!("\"{}\"", list.name()),
        };
        let (open, close) = match list {
            PartList::Cameras => ('{', '}'),
            _ => ('[', ']'),
        };
        let field = format!("{name}: {open}{part}{close},{indent}");
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

/// Returns the number of symbols around an offset.
fn level_at(symbols: &[Symbol], at: usize) -> usize {
    let mut around = symbols.iter().filter(|symbol| symbol.range.contains(&at));
    around
        .next()
        .map_or(0, |symbol| 1 + level_at(&symbol.children, at))
}

fn add(parts: &mut Vec<Part>, symbol: &Symbol, level: usize) {
    parts.push(Part {
        kind: symbol.kind,
        name: symbol.name.clone(),
        variant: symbol.detail.clone(),
        level,
        is_hidden: false,
        range: symbol.range.clone(),
    });
    let children = symbol.children.iter();
    children.for_each(|child| add(parts, child, level + 1));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::tests::{checked, edited};

    const TEXT: &str = r##"(
    camera: Fit(), // mine
    geometries: [
        Sphere(center: (0, 0, 0), radius: 1, color: "#f00"), // red
        Group(geometries: [Sphere(center: (3, 0, 0), radius: 1, color: "#0f0", name: "green") /* , */ ,
            Sphere(center: (6, 0, 0), radius: 1, color: "#00f")]),
    ],
)
"##;

    #[test]
    fn a_part_is_hidden_in_a_comment_and_shown_again() {
        let found = checked(TEXT);
        let parts = found.parts();
        let names = parts
            .iter()
            .map(|part| (&*part.name, &*part.variant, part.level));
        let expected = [
            ("camera", "Fit", 0),
            ("[0]", "Sphere", 0),
            ("[1]", "Group", 0),
            ("green", "Sphere", 1),
            ("[1]", "Sphere", 1),
        ];
        assert_eq!(names.collect::<Vec<_>>(), expected);
        for part in &parts[1..] {
            let edits = found.hide_or_show(part.range.start).unwrap();
            let hidden = edited(TEXT, &edits);
            let again = checked(&hidden);
            assert!(!again.document().has_errors(), "{hidden}");
            let parts = again.parts();
            let found: Vec<_> = parts.iter().filter(|part| part.is_hidden).collect();
            let [one] = found[..] else {
                panic!("{hidden}: {parts:?}");
            };
            assert_eq!((&one.variant, one.level), (&part.variant, part.level));
            let edits = again.hide_or_show(one.range.start).unwrap();
            assert_eq!(edited(&hidden, &edits), TEXT);
        }
        assert!(found.hide_or_show(parts[0].range.start).is_err());
        assert!(found.hide_or_show(0).is_err());
    }

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
            for list in PartList::ALL {
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
