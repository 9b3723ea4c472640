//! What an option speaks of and the scene does not have.

use crate::{
    diagnostic::{Code, Diagnostic},
    text::nearest::{list, nearest, quote},
};

/// A name that nothing of a kind has, where it stands in the text of the option.
pub(crate) fn name(kind: &str, name: &str, known: &[&str]) -> Diagnostic {
    let found = quote(name);
    let message = match known {
        [] => format!("unknown {kind} {found}, the scene has none with a name"),
        _ => format!("unknown {kind} {found}, expected one of {}", list(known)),
    };
    let diagnostic = Diagnostic::new(Code::UnknownName, 0..name.len(), message);
    match nearest(name, known) {
        Some(meant) => diagnostic.with_help(format!("did you mean {}?", quote(meant))),
        None => diagnostic,
    }
}
