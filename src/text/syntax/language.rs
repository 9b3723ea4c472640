//! The two syntaxes of scene files.

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
    /// All syntaxes.
    pub const ALL: &'static [Self] = &[Self::Ron, Self::Json];

    /// Returns the name, which is also the file extension: `ron` or `json`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ron => "ron",
            Self::Json => "json",
        }
    }

    /// Returns the syntax for a file extension, ignoring case; `None` for any other extension.
    pub fn of_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?;
        let mut all = Self::ALL.iter().copied();
        all.find(|syntax| syntax.name().eq_ignore_ascii_case(ending))
    }

    /// Guesses the syntax of a scene without a file name: JSON if it starts with a brace, which a
    /// RON scene never does; otherwise RON.
    pub fn of_text(text: &str) -> Self {
        let text = text.trim_start_matches('\u{feff}').trim_start();
        if text.starts_with('{') {
            Self::Json
        } else {
            Self::Ron
        }
    }

    /// Returns the name of a field or a variant as it is written.
    pub(crate) fn word(self, name: &str) -> String {
        match self {
            Self::Ron => name.to_owned(),
            Self::Json => format!("\"{name}\""),
        }
    }

    /// Returns the name of a field with the colon behind it.
    pub(crate) fn key(self, name: &str) -> String {
        self.word(name) + ": "
    }

    /// Returns the brackets around the fields of an object.
    pub(crate) const fn brackets(self) -> [&'static str; 2] {
        match self {
            Self::Ron => ["(", ")"],
            Self::Json => ["{", "}"],
        }
    }

    /// Returns an object with these fields.
    pub(crate) fn object(self, fields: &str) -> String {
        let [open, close] = self.brackets();
        format!("{open}{fields}{close}")
    }

    /// Returns a tuple of these values.
    pub(crate) fn tuple(self, values: &str) -> String {
        match self {
            Self::Ron => format!("({values})"),
            Self::Json => format!("[{values}]"),
        }
    }

    /// Returns a variant that is an object with these fields.
    pub(crate) fn variant(self, name: &str, fields: &str) -> String {
        match self {
            Self::Ron => format!("{name}({fields})"),
            Self::Json => self.holding(name, &self.object(fields)),
        }
    }

    /// Returns a variant that holds a value which is not an object.
    pub(crate) fn holding(self, name: &str, value: &str) -> String {
        match self {
            Self::Ron => format!("{name}({value})"),
            Self::Json => format!("{{\"{name}\": {value}}}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_selects_the_syntax() {
        let of = |path: &str| Syntax::of_path(Path::new(path));
        assert_eq!(of("a.ron"), Some(Syntax::Ron));
        assert_eq!(of("b/a.b.JSON"), Some(Syntax::Json));
        assert_eq!(of("ron"), None);
        assert_eq!(of("a.txt"), None);
    }
}
