//! Clouds of points in files called .xyz: text tables, unlike the atoms that such files hold otherwise.

/// A cloud of points.
pub(crate) struct Cloud {
    /// The names of the columns; none if the file has a header.
    names: Vec<Box<str>>,
}

impl Cloud {
    /// Recognizes a cloud by the start of its file: its first line is not the number of atoms, but has
    /// three or more numbers, or it names columns, or it is a comment.
    pub(crate) fn of(start: &[u8]) -> Option<Self> {
        let text = String::from_utf8_lossy(start);
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text).trim_start();
        let first = text.split(['\n', '\r']).next()?;
        let words = first.split(|letter: char| letter.is_whitespace() || letter == ',');
        let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
        let is_named = |name: &str| words.iter().any(|word| word.eq_ignore_ascii_case(name));
        let has_header = ["x", "y", "z"].into_iter().all(is_named);
        if has_header || first.starts_with('#') || first.starts_with("//") {
            return Some(Self { names: Vec::new() });
        }
        let is_row = words.len() >= 3 && words.iter().all(|word| word.parse::<f64>().is_ok());
        is_row.then(|| Self {
            names: (0..words.len())
                .map(|at| ["x", "y", "z"].get(at).map_or("_", |name| name).into())
                .collect(),
        })
    }

    /// Returns the names of the columns of a file without a header: coordinates, and columns to skip.
    pub(crate) fn names(&self) -> Option<&[Box<str>]> {
        (!self.names.is_empty()).then_some(&*self.names)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clouds_differ_from_atoms() {
        let names = |text: &str| Cloud::of(text.as_bytes()).map(|cloud| cloud.names.join(" "));
        let named = |text: &str| names(text).unwrap();
        assert_eq!(named("0.1 0.2 0.3\n1 2 3\n"), "x y z");
        assert_eq!(named("\u{feff}1,2,3,9,9,9\r\n"), "x y z _ _ _");
        assert_eq!(named("//X Y Z\n1 2 3\n"), "");
        assert_eq!(named("X,Y,Z,Intensity\n1,2,3,4\n"), "");
        for atoms in [
            "3\n\nC 0 0 0\n",
            "  3 \n",
            "3 water\n",
            "C 0 0 0\n",
            "",
            "1 2\n",
        ] {
            assert_eq!(names(atoms), None, "{atoms}");
        }
    }
}
