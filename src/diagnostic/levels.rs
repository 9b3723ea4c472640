//! The lint levels: the severity of each warning.

use crate::diagnostic::{Code, Severity};

/// The lint level of each warning; errors are not affected.
///
/// # Examples
///
/// ```
/// use strahl::diagnostic::{Code, Levels, Severity};
///
/// let mut levels = Levels::default();
/// assert_eq!(levels.severity(Code::EmptyScene), Some(Severity::Warning));
/// assert_eq!(levels.severity(Code::NeverVisible), None);
/// levels.deny(Code::EmptyScene);
/// levels.allow(Code::EyeInside);
/// assert_eq!(levels.severity(Code::EmptyScene), Some(Severity::Error));
/// assert_eq!(levels.severity(Code::EyeInside), None);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Levels(Vec<(Code, Option<Severity>)>);

impl Levels {
    /// Reports a warning as an error. A later call for the same code overrides an earlier one.
    pub fn deny(&mut self, code: Code) {
        self.set(code, Some(Severity::Error));
    }

    /// Reports a warning as a warning, even if it is off by default.
    pub fn warn(&mut self, code: Code) {
        self.set(code, Some(Severity::Warning));
    }

    /// Turns a warning off.
    pub fn allow(&mut self, code: Code) {
        self.set(code, None);
    }

    /// Turns all warnings that are on into errors.
    pub fn deny_warnings(&mut self) {
        for code in Code::WARNINGS {
            if self.severity(*code).is_some() {
                self.deny(*code);
            }
        }
    }

    fn set(&mut self, code: Code, severity: Option<Severity>) {
        if code.severity() == Severity::Warning {
            self.0.push((code, severity));
        }
    }

    /// Returns the severity of a code; `None` if it is not reported.
    pub fn severity(&self, code: Code) -> Option<Severity> {
        let set = self.0.iter().rev().find(|(other, _)| *other == code);
        let default = code.on_by_default().then_some(code.severity());
        set.map_or(default, |(_, severity)| *severity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_cannot_be_allowed() {
        let mut levels = Levels::default();
        levels.allow(Code::OutOfRange);
        assert_eq!(levels.severity(Code::OutOfRange), Some(Severity::Error));
    }

    #[test]
    fn the_last_option_wins() {
        let mut levels = Levels::default();
        levels.deny_warnings();
        assert_eq!(levels.severity(Code::EmptyScene), Some(Severity::Error));
        assert_eq!(levels.severity(Code::NeverVisible), None, "it was off");
        levels.warn(Code::EmptyScene);
        assert_eq!(levels.severity(Code::EmptyScene), Some(Severity::Warning));
        levels.warn(Code::NeverVisible);
        assert_eq!(levels.severity(Code::NeverVisible), Some(Severity::Warning));
    }
}
