//! The two syntaxes that a scene can be written in.

use std::path::Path;

/// The syntax of a scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Syntax {
    /// Rusty Object Notation, `.ron`.
    Ron,
    /// JSON, `.json`.
    Json,
}

impl Syntax {
    /// Every syntax.
    pub const ALL: &'static [Self] = &[Self::Ron, Self::Json];

    /// The name, which is also the ending of a file: `ron` or `json`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ron => "ron",
            Self::Json => "json",
        }
    }

    /// The syntax of a file by its ending, in either case.
    pub fn of_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?;
        let mut all = Self::ALL.iter().copied();
        all.find(|syntax| syntax.name().eq_ignore_ascii_case(ending))
    }

    /// The syntax that a scene without a name is written in: JSON if it begins with a brace, else
    /// RON, whose scenes never do.
    pub fn of_text(text: &str) -> Self {
        let text = text.trim_start_matches('\u{feff}').trim_start();
        if text.starts_with('{') {
            Self::Json
        } else {
            Self::Ron
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_tells_the_syntax() {
        let of = |path: &str| Syntax::of_path(Path::new(path));
        assert_eq!(of("a.ron"), Some(Syntax::Ron));
        assert_eq!(of("b/a.b.JSON"), Some(Syntax::Json));
        assert_eq!(of("ron"), None);
        assert_eq!(of("a.txt"), None);
    }
}
