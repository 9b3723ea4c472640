//! Starter scenes.

use crate::text::syntax::Syntax;

/// Returns a small scene without faults; in RON, comments explain possible changes.
///
/// # Examples
///
/// ```
/// use strahl::{Document, Syntax, scene::new_scene};
///
/// let document = Document::from_text("new.ron", new_scene(Syntax::Ron), Syntax::Ron);
/// assert!(document.diagnostics().is_empty());
/// ```
pub const fn new_scene(syntax: Syntax) -> &'static str {
    match syntax {
        Syntax::Ron => include_str!("new.ron"),
        Syntax::Json => include_str!("new.json"),
    }
}

/// Returns a small scene with lights and materials; in RON, comments explain them.
///
/// # Examples
///
/// ```
/// use strahl::{Document, Syntax, scene::new_lit_scene};
///
/// let document = Document::from_text("new.ron", new_lit_scene(Syntax::Ron), Syntax::Ron);
/// assert!(document.diagnostics().is_empty() && document.has_lights());
/// ```
pub const fn new_lit_scene(syntax: Syntax) -> &'static str {
    match syntax {
        Syntax::Ron => include_str!("new_lit.ron"),
        Syntax::Json => include_str!("new_lit.json"),
    }
}

/// Returns a small scene whose light follows paths; in RON, comments explain it.
///
/// # Examples
///
/// ```
/// use strahl::{Document, Syntax, scene::new_path_scene};
///
/// let document = Document::from_text("new.ron", new_path_scene(Syntax::Ron), Syntax::Ron);
/// assert!(document.diagnostics().is_empty() && document.has_lights());
/// ```
pub const fn new_path_scene(syntax: Syntax) -> &'static str {
    match syntax {
        Syntax::Ron => include_str!("new_path.ron"),
        Syntax::Json => include_str!("new_path.json"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::document::Document;

    #[test]
    fn new_scenes_have_no_faults_and_are_formatted() {
        for syntax in Syntax::ALL {
            for new in [new_scene, new_lit_scene, new_path_scene] {
                let text = new(*syntax);
                let document = Document::from_text("new", text, *syntax);
                assert_eq!(document.diagnostics(), []);
                assert_eq!(document.format().as_deref(), Some(text));
            }
        }
    }
}
