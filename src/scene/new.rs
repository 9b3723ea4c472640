//! A starter scene.

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::document::Document;

    #[test]
    fn new_scenes_have_no_faults_and_are_formatted() {
        for syntax in Syntax::ALL {
            let text = new_scene(*syntax);
            let document = Document::from_text("new", text, *syntax);
            assert_eq!(document.diagnostics(), []);
            assert_eq!(document.format().as_deref(), Some(text));
        }
    }
}
