//! Maps from a number in 0..=1 to a color.

pub(crate) mod scale;
mod tables;

use std::sync::Arc;

use crate::tracer::color::Color;

/// Colors at equal steps from 0 to 1, with linear interpolation of their display values between two
/// neighbors.
///
/// # Examples
///
/// ```
/// use strahl::render::Colormap;
///
/// let gray = Colormap::gray();
/// assert_eq!(gray.color(0.5).to_rgb8(), [128; 3]);
/// assert_eq!(gray.color(7.0), gray.color(1.0));
/// assert_eq!(Colormap::viridis().color(0.0).to_rgb8(), [0x44, 0x01, 0x54]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Colormap {
    /// At least one.
    colors: Arc<[Color]>,
}

macro_rules! named {
    ($($(#[doc = $doc:literal])* $name:ident = $table:ident;)*) => {
        impl Colormap {
            $($(#[doc = $doc])*
            pub fn $name() -> Self {
                Self::from_table(&tables::$table)
            })*
        }
    };
}

named! {
    /// Viridis, from dark blue through green to yellow: even steps for the eye, also in gray.
    viridis = VIRIDIS;
    /// Cividis, from dark blue to yellow: the same to most people with a color vision deficiency.
    cividis = CIVIDIS;
    /// Inferno, from black through red to light yellow.
    inferno = INFERNO;
    /// Turbo, a rainbow without false edges.
    turbo = TURBO;
    /// Coolwarm, from blue through light gray to red, for values with a middle.
    coolwarm = COOLWARM;
    /// Gray, from black to white.
    gray = GRAY;
}

impl Colormap {
    /// Creates a map of these colors, at equal steps from 0 to 1; `None` for no colors. A single
    /// one is the color of all numbers.
    pub fn new(colors: impl Into<Arc<[Color]>>) -> Option<Self> {
        let colors = colors.into();
        (!colors.is_empty()).then_some(Self { colors })
    }

    fn from_table(table: &[u32]) -> Self {
        let channel = |color: u32, shift: u32| f64::from(color >> shift & 0xff) / 255.0;
        let color =
            |color: &u32| Color::new(channel(*color, 16), channel(*color, 8), channel(*color, 0));
        Self {
            colors: table.iter().map(color).collect(),
        }
    }

    /// Returns the color of a number, which is clamped to 0..=1; NaN is 0.
    ///
    /// With n colors and `s = t * (n - 1)`, each channel is `a * (1 - f) + b * f`, where a and b are
    /// the colors at the whole numbers around s, and f is the fraction of s.
    pub fn color(&self, t: f64) -> Color {
        let last = self.colors.len() - 1;
        // A cast of NaN is 0.
        let s = t.clamp(0.0, 1.0) * last as f64;
        let index = (s as usize).min(last.saturating_sub(1));
        let fraction = s - index as f64;
        let color = |index: usize| self.colors.get(index).copied().unwrap_or(Color::BLACK);
        let (a, b) = (color(index), color(last.min(index + 1)));
        if fraction == 0.0 || a == b || fraction.is_nan() {
            return a;
        }
        let between = |a: f64, b: f64| a * (1.0 - fraction) + b * fraction;
        Color::new(
            between(a.r(), b.r()),
            between(a.g(), b.g()),
            between(a.b(), b.b()),
        )
    }

    /// Returns the colors at equal steps from 0 to 1.
    pub fn colors(&self) -> &[Color] {
        &self.colors
    }
}

/// Returns the place of a value in a range, in 0..=1: `(value - low) / (high - low)`, clamped. In a
/// range of one value, every value is in the middle.
///
/// The result is NaN for NaN only.
pub(crate) fn position(value: f64, [low, high]: [f64; 2]) -> f64 {
    if low >= high {
        return if value.is_nan() { value } else { 0.5 };
    }
    // Halves, because the length of a range may be too large for an f64.
    let (value, low, high) = if (high - low).is_finite() {
        (value, low, high)
    } else {
        (value / 2.0, low / 2.0, high / 2.0)
    };
    // Infinite values first: their difference from a bound is too.
    ((value - low) / (high - low)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_at_steps_are_those_of_the_table() {
        for (map, table) in [
            (Colormap::viridis(), &tables::VIRIDIS[..]),
            (Colormap::coolwarm(), &tables::COOLWARM),
            (Colormap::gray(), &tables::GRAY),
        ] {
            let last = (table.len() - 1) as f64;
            for (index, expected) in table.iter().enumerate() {
                let [r, g, b] = map.color(index as f64 / last).to_rgb8().map(u32::from);
                assert_eq!(r << 16 | g << 8 | b, *expected, "{index}");
            }
        }
    }

    #[test]
    fn display_values_are_interpolated() {
        let map = Colormap::new([Color::BLACK, Color::new(1.0, 0.5, 0.0), Color::WHITE]).unwrap();
        for (t, expected) in [
            (-1.0, [0.0, 0.0, 0.0]),
            (0.125, [0.25, 0.125, 0.0]),
            (0.5, [1.0, 0.5, 0.0]),
            (0.75, [1.0, 0.75, 0.5]),
            (1.0, [1.0, 1.0, 1.0]),
            (f64::INFINITY, [1.0, 1.0, 1.0]),
            (f64::NAN, [0.0, 0.0, 0.0]),
        ] {
            let color = map.color(t);
            assert_eq!([color.r(), color.g(), color.b()], expected, "{t}");
        }
        let one = Colormap::new([Color::WHITE]).unwrap();
        assert_eq!(one.color(0.7), Color::WHITE);
        assert_eq!(Colormap::new([]), None);
    }

    #[test]
    fn a_position_is_in_0_to_1() {
        const MAX: f64 = f64::MAX;
        for (value, range, expected) in [
            (0.5, [-1.0, 1.0], 0.75),
            (7.0, [-1.0, 1.0], 1.0),
            (f64::NEG_INFINITY, [-1.0, 1.0], 0.0),
            (f64::INFINITY, [-MAX, MAX], 1.0),
            (0.0, [-MAX, MAX], 0.5),
            (3.0, [3.0, 3.0], 0.5),
            (5e-324, [0.0, 5e-324], 1.0),
        ] {
            assert_eq!(position(value, range), expected, "{value} in {range:?}");
        }
        assert!(position(f64::NAN, [0.0, 1.0]).is_nan());
        assert!(position(f64::NAN, [1.0, 1.0]).is_nan());
    }
}
