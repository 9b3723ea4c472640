//! The first key of every JSON object that this program writes. It keeps the object from being
//! mistaken for a scene.

use std::fmt;

use serde::Serialize;

/// The name of the key.
pub(crate) const KEY: &str = "strahl";

/// A kind of JSON object that the program writes. Its `Display` form is the key with the kind and
/// the version, the required start of an object written by hand.
///
/// # Examples
///
/// ```
/// use strahl::text::Stamp;
///
/// assert_eq!(Stamp::Info.to_string(), r#""strahl": "info/1""#);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Stamp {
    /// `strahl diff`
    #[serde(rename = "diff/1")]
    Diff,
    /// `strahl diff` of two folders
    #[serde(rename = "diff-folder/1")]
    DiffFolder,
    /// One diagnostic of `strahl validate --output-format jsonl`
    #[serde(rename = "diagnostic/1")]
    Diagnostic,
    /// `strahl info`
    #[serde(rename = "info/1")]
    Info,
    /// `strahl pixel`
    #[serde(rename = "pixel/1")]
    Pixel,
    /// One line of a run record
    #[serde(rename = "record/1")]
    Record,
    /// `strahl render --report` for a single image
    #[serde(rename = "report/1")]
    Report,
    /// `strahl render --report` for a run of several images
    #[serde(rename = "run/1")]
    Run,
    /// `strahl status`
    #[serde(rename = "status/1")]
    Status,
    /// `strahl render --timings=json`
    #[serde(rename = "timings/1")]
    Timings,
    /// `strahl validate --output-format json`
    #[serde(rename = "validate/1")]
    Validate,
}

impl fmt::Display for Stamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{KEY}\": \"")?;
        self.serialize(&mut *f)?;
        f.write_str("\"")
    }
}

/// A value that serializes to a JSON object starting with a stamp.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Stamped<T> {
    /// The kind of object.
    pub strahl: Stamp,
    /// The remaining fields of the object.
    #[serde(flatten)]
    pub value: T,
}

impl<T> Stamped<T> {
    /// Adds a stamp to a value.
    pub const fn new(strahl: Stamp, value: T) -> Self {
        Self { strahl, value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stamp_comes_first() {
        #[derive(Serialize)]
        struct Values {
            a: u8,
        }
        let stamped = Stamped::new(Stamp::Pixel, Values { a: 1 });
        let text = serde_json::to_string(&stamped).unwrap();
        assert_eq!(text, r#"{"strahl":"pixel/1","a":1}"#);
        assert!(text.contains(&format!("\"{KEY}\"")));
    }
}
