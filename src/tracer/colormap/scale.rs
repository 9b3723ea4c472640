//! The colors of values.

use crate::tracer::{
    color::Color,
    colormap::{Colormap, position},
};

/// The colors of the values of a column.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ColorScale {
    /// The name of the column.
    pub column: Box<str>,
    /// The values of the first and the last color; `None` if the scene gives no range and the
    /// column has no finite value.
    pub range: Option<[f64; 2]>,
    /// The colors from the first to the last.
    pub map: Colormap,
    /// The color of a row without a value.
    pub missing: Color,
}

impl ColorScale {
    /// Returns the place of a value in the range, in 0..=1; `None` for NaN.
    pub fn position(&self, value: f64) -> Option<f64> {
        let position = position(value, self.range.unwrap_or_default());
        (!position.is_nan()).then_some(position)
    }

    /// Returns the color of a value.
    pub fn color(&self, value: f64) -> Color {
        let position = self.position(value);
        position.map_or(self.missing, |position| self.map.color(position))
    }
}
