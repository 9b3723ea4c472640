//! The values of a column that determine colors.

/// The range of values, and the number of missing ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Values {
    low: f64,
    high: f64,
    /// The number of values that are NaN.
    pub(crate) missing: usize,
}

impl Values {
    /// No values.
    pub(super) const NONE: Self = Self {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
        missing: 0,
    };

    /// Returns what is known of some values.
    pub(crate) fn of(values: &[f64]) -> Self {
        let mut all = Self::NONE;
        all.add(values);
        all
    }

    /// Adds values.
    pub(super) fn add(&mut self, values: &[f64]) {
        for value in values {
            if value.is_finite() {
                self.low = if *value < self.low { *value } else { self.low };
                self.high = if *value > self.high {
                    *value
                } else {
                    self.high
                };
            } else {
                self.missing += usize::from(value.is_nan());
            }
        }
    }

    /// Returns the smallest and the largest finite value, if there is one.
    pub(crate) fn range(&self) -> Option<[f64; 2]> {
        (self.low <= self.high).then_some([self.low, self.high])
    }
}
