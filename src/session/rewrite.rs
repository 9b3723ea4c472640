//! Numbers of a text that are written anew.

use glam::DVec3;

use crate::{
    diagnostic::{Path, error::Error},
    scene::{document::Document, locate::range_of},
    text::{edit::Edit, syntax},
};

/// The edits of some numbers of a text.
pub(super) struct Rewrite<'a> {
    document: &'a Document,
    pub(super) edits: Vec<Edit>,
}

impl<'a> Rewrite<'a> {
    pub(super) const fn new(document: &'a Document) -> Self {
        let edits = Vec::new();
        Self { document, edits }
    }

    fn range(&self, path: &Path) -> Option<std::ops::Range<usize>> {
        let (text, source) = (self.document.text(), self.document.source());
        range_of(text, source.tree(), path.steps())
    }

    fn read(&self, path: &Path) -> Option<f64> {
        let text = self.document.text().get(self.range(path)?)?;
        syntax::float(text, self.document.syntax()).ok()
    }

    pub(super) fn read_vector(&self, path: &Path) -> Option<DVec3> {
        let [x, y, z] = [0, 1, 2].map(|index| self.read(&path.index(index)));
        Some(DVec3::new(x?, y?, z?))
    }

    /// Writes a number with as many decimals as `finest` needs, unless its text would stay.
    pub(super) fn number(
        &mut self,
        path: &Path,
        old: f64,
        new: f64,
        finest: f64,
    ) -> Result<(), Error> {
        let range = self.range(path).filter(|_| self.read(path) == Some(old));
        let range = range.ok_or_else(|| {
            let why = "not a number of the text, or an animation or an option changes it";
            Error::refused(format!("`{path}` cannot be written: {why}"))
        })?;
        let text = rounded(new, finest);
        if text != rounded(old, finest) {
            self.edits.push(Edit::replace(range, text));
        }
        Ok(())
    }

    pub(super) fn vector(
        &mut self,
        path: &Path,
        old: DVec3,
        new: DVec3,
        finest: f64,
    ) -> Result<(), Error> {
        for (index, (old, new)) in old.to_array().into_iter().zip(new.to_array()).enumerate() {
            self.number(&path.index(index), old, new, finest)?;
        }
        Ok(())
    }
}

/// Returns a number as text, rounded to the power of ten at or below `finest`.
fn rounded(number: f64, finest: f64) -> String {
    /// The most decimals that a number can need beside its distance.
    const MOST: f64 = 300.0;
    let decimals = (-libm::log10(finest)).ceil().clamp(0.0, MOST);
    let text = format!("{number:.*}", decimals as usize);
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    match text {
        "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_short_as_their_place_allows() {
        assert_eq!(rounded(1.234_567, 1e-4), "1.2346");
        assert_eq!(rounded(-0.000_01, 1e-4), "0");
        assert_eq!(rounded(120.0, 0.01), "120");
        assert_eq!(rounded(123_456.7, 10.0), "123457");
        assert_eq!(rounded(2.5e-9, 1e-10), "0.0000000025");
    }
}
