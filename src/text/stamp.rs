//! The key that every JSON object of this program begins with, by which it is never taken for a
//! scene.

use std::fmt;

use serde::Serialize;

/// The key.
pub(crate) const KEY: &str = "strahl";

/// A kind of JSON object that the program writes. Displayed, it is the key with the kind and its
/// version, as an object written by hand has to begin.
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
    /// A line of the record of a run
    #[serde(rename = "record/1")]
    Record,
    /// `strahl render --report` of one picture
    #[serde(rename = "report/1")]
    Report,
    /// `strahl render --report` of a run of many pictures
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

/// A value that becomes a JSON object which begins with a stamp.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Stamped<T> {
    /// The kind of object.
    pub strahl: Stamp,
    /// Everything else in it.
    #[serde(flatten)]
    pub value: T,
}

impl<T> Stamped<T> {
    /// The value with a stamp.
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
