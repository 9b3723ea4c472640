//! Conversion of a scene to the other syntax, through the model.

use std::fmt;

use serde::Serialize;

use crate::{
    scene::format::scene::Model,
    text::{
        lines::Lines,
        print,
        syntax::{NodeKind, Syntax, Tree, parse},
    },
};

/// A scene converted to another syntax.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Converted {
    /// The text in the canonical format.
    pub text: String,
    /// The lost comments, if any.
    pub lost: Option<LostComments>,
    /// Everything else that was dropped, one sentence each.
    pub dropped: Vec<String>,
    /// The reason why the text is not a scene: JSON has more brackets in each other than RON.
    pub(crate) fault: Option<String>,
}

/// The comments that a scene loses in a conversion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LostComments {
    /// The number of comments.
    pub count: usize,
    /// The line of the first one, from 1.
    pub line: usize,
}

impl LostComments {
    /// Returns the comments of a text, given its tree.
    pub(crate) fn of(text: &str, tree: &Tree) -> Option<Self> {
        let comments = tree.comments();
        comments.first().map(|first| Self {
            count: comments.len(),
            line: Lines::new(text).position(first.range().start).line,
        })
    }
}

impl Model {
    /// Returns the scene as text in the canonical format. RON cannot write `$schema`.
    ///
    /// Nothing is checked: [`Document::from_text`](crate::Document::from_text) reports the faults
    /// of the scene. A number that is not finite becomes `inf` or `NaN` in RON and `null` in JSON,
    /// which are invalid in a scene.
    pub fn to_text(&self, syntax: Syntax) -> String {
        convert(self.clone(), syntax).text
    }
}

/// Writes a model in a syntax, without the comments of its text.
pub(crate) fn convert(mut model: Model, syntax: Syntax) -> Converted {
    let mut dropped = Vec::new();
    if syntax == Syntax::Ron && model.schema.take().is_some() {
        dropped.push("`$schema`: RON does not support it".to_owned());
    }
    let text = short(&model, syntax);
    let tree = parse(&text, syntax);
    Converted {
        text: print::format(&text, &tree),
        lost: None,
        dropped,
        fault: tree.faults().first().map(|fault| fault.message.clone()),
    }
}

/// Writes a part of a model on one line, as short as in the canonical format.
pub(crate) fn short(part: &impl Serialize, syntax: Syntax) -> String {
    short_numbers(&write(part, syntax), syntax)
}

/// Writes a model, or a part of one, on one line. The serializers never fail: every key is a string
/// and every number finite.
pub(crate) fn write(model: &impl Serialize, syntax: Syntax) -> String {
    match syntax {
        Syntax::Json => serde_json::to_string(model).unwrap_or_default(),
        Syntax::Ron => {
            let extensions = ron::extensions::Extensions::IMPLICIT_SOME
                | ron::extensions::Extensions::UNWRAP_VARIANT_NEWTYPES;
            let options = ron::Options::default().with_default_extension(extensions);
            let mut text = String::new();
            // Each type of the format has a copy of the serializer, which a direct writer makes larger.
            let writer: &mut dyn fmt::Write = &mut text;
            let serializer = ron::Serializer::with_options(writer, None, &options);
            let written = serializer.and_then(|mut serializer| model.serialize(&mut serializer));
            written.map(|()| text).unwrap_or_default()
        }
    }
}

/// Removes the `.0` that the serializers write after whole numbers.
fn short_numbers(text: &str, syntax: Syntax) -> String {
    let tree = parse(text, syntax);
    let mut short = String::with_capacity(text.len());
    let mut done = 0;
    for id in tree.ids() {
        let node = tree.node(id);
        let written = text.get(node.range()).unwrap_or("");
        if node.kind() == NodeKind::Number
            && let Some(whole) = written.strip_suffix(".0")
        {
            short.push_str(text.get(done..node.range().start).unwrap_or(""));
            short.push_str(whole);
            done = node.range().end;
        }
    }
    short.push_str(text.get(done..).unwrap_or(""));
    short
}
