//! A scene in the other syntax, through the model.

use serde::Serialize;

use crate::scene::{
    fmt,
    model::Model,
    syntax::{Kind, Syntax, Tree, parse},
};

/// A scene in another syntax.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Converted {
    /// The text, in the one layout.
    pub text: String,
    /// What could not come along, a sentence each.
    pub dropped: Vec<String>,
}

/// Writes a model in a syntax; `tree` is that of the text that it was read from.
pub(crate) fn convert(mut model: Model, tree: &Tree, syntax: Syntax) -> Converted {
    let mut dropped = Vec::new();
    let comments = tree.comments().len();
    if comments > 0 {
        let comments = match comments {
            1 => "1 comment".to_owned(),
            count => format!("{count} comments"),
        };
        dropped.push(match syntax {
            Syntax::Json => format!("{comments}: JSON has none"),
            Syntax::Ron => comments,
        });
    }
    if syntax == Syntax::Ron && model.schema.take().is_some() {
        dropped.push("`$schema`: RON has no way to write it".to_owned());
    }
    let text = short_numbers(&write(&model, syntax), syntax);
    let text = fmt::format(&text, &parse(&text, syntax));
    Converted { text, dropped }
}

/// The model on one line. Neither of the serializers fails on it: every key is a string and every
/// number finite.
fn write(model: &Model, syntax: Syntax) -> String {
    match syntax {
        Syntax::Json => serde_json::to_string(model).unwrap_or_default(),
        Syntax::Ron => {
            let extensions = ron::extensions::Extensions::IMPLICIT_SOME
                | ron::extensions::Extensions::UNWRAP_VARIANT_NEWTYPES;
            let options = ron::Options::default().with_default_extension(extensions);
            let mut text = String::new();
            let serializer = ron::Serializer::with_options(&mut text, None, &options);
            let written = serializer.and_then(|mut serializer| model.serialize(&mut serializer));
            written.map(|()| text).unwrap_or_default()
        }
    }
}

/// Whole numbers without the `.0` that the serializers write behind them.
fn short_numbers(text: &str, syntax: Syntax) -> String {
    let tree = parse(text, syntax);
    let mut short = String::with_capacity(text.len());
    let mut done = 0;
    for id in tree.ids() {
        let node = tree.node(id);
        let written = text.get(node.range()).unwrap_or("");
        if node.kind() == Kind::Number
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
