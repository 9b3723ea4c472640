//! The value of a setting, as it is written.

use std::ops::Range;

use super::Setting;
use crate::{
    diagnostic::{Code, Diagnostic},
    scene::problem::syntax_fault,
    text::syntax::{self, Syntax},
};

/// The value of a setting and its range in the setting.
pub(super) struct Value {
    pub(super) range: Range<usize>,
    pub(super) text: String,
    /// True if a field is removed.
    pub(super) removes: bool,
}

impl Value {
    /// Returns the value of a setting as a text without quotes, if it may be one.
    pub(super) fn bare(setting: &Setting) -> Option<Self> {
        let range = setting.bare()?;
        let text = setting.text.get(range.clone())?;
        Some(Self {
            text: serde_json::Value::from(text).to_string(),
            range,
            removes: false,
        })
    }

    /// Reads the value of a setting.
    pub(super) fn of(setting: &Setting, syntax: Syntax) -> Result<Self, Vec<Diagnostic>> {
        let start = setting.value;
        if setting.value().trim().is_empty() {
            let message = "expected a value after `=`";
            return Err(vec![Diagnostic::new(Code::Syntax, start..start, message)]);
        }
        // A removal may be written as in either syntax.
        let trimmed = setting.value().trim();
        if ["null", "None"].contains(&trimmed) {
            let start = start + setting.value().find(trimmed).unwrap_or_default();
            return Ok(Self {
                range: start..start + trimmed.len(),
                text: match syntax {
                    Syntax::Ron => "None".to_owned(),
                    Syntax::Json => "null".to_owned(),
                },
                removes: true,
            });
        }
        let tree = syntax::parse(setting.value(), syntax);
        if let [_, ..] = tree.faults() {
            let faults = tree.faults().iter().map(|fault| {
                let range = fault.range.start + start..fault.range.end + start;
                let labels = Vec::new();
                let fault = syntax_fault(fault);
                Diagnostic {
                    range,
                    labels,
                    ..fault
                }
            });
            return Err(faults.collect());
        }
        let range = tree.root().map_or(0..0, |root| tree.node(root).range());
        let text = setting.value().get(range.clone()).unwrap_or("");
        Ok(Self {
            range: range.start + start..range.end + start,
            text: text.to_owned(),
            removes: false,
        })
    }
}
