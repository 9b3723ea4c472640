//! A display color of three channels in 0..1.

use std::ops::{Add, Mul, Sub};

use crate::tracer::{
    radiance::Radiance,
    srgb::{linear_of, quantize, to_display},
};

/// A color: red, green and blue in 0..1, as display values (sRGB).
///
/// Every color lies in that range: [`Color::new`] and all operators clamp, and NaN becomes 0.
///
/// # Examples
///
/// ```
/// use strahl::Color;
///
/// let orange = Color::new(1.0, 0.5, 0.0);
/// assert_eq!(orange + Color::new(0.5, 0.25, 0.0), Color::new(1.0, 0.75, 0.0));
/// assert_eq!(orange * 0.5, Color::new(0.5, 0.25, 0.0));
/// assert_eq!(Color::new(-1.0, f64::NAN, 7.0), Color::new(0.0, 0.0, 1.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Color {
    r: f64,
    g: f64,
    b: f64,
}

impl Color {
    /// Black, the default background.
    pub const BLACK: Self = Self::new(0.0, 0.0, 0.0);
    /// White: all channels at 1.
    pub const WHITE: Self = Self::new(1.0, 1.0, 1.0);

    /// Creates a color from three channels, clamped to 0..1; NaN becomes 0.
    pub const fn new(r: f64, g: f64, b: f64) -> Self {
        Self {
            r: clamp(r),
            g: clamp(g),
            b: clamp(b),
        }
    }

    /// The red channel, in 0..1.
    pub const fn r(self) -> f64 {
        self.r
    }

    /// The green channel, in 0..1.
    pub const fn g(self) -> f64 {
        self.g
    }

    /// The blue channel, in 0..1.
    pub const fn b(self) -> f64 {
        self.b
    }

    /// Returns the bytes of red, green and blue: `floor(c * 255 + 0.5)` for each channel c.
    pub fn to_rgb8(self) -> [u8; 3] {
        [self.r, self.g, self.b].map(|channel| quantize(channel, u8::MAX.into()) as u8)
    }

    /// Returns the linear light of each channel, in 0..1, by the transfer function of sRGB (IEC
    /// 61966-2-1): `c/12.92` for `c <= 0.04045`, else `((c+0.055)/1.055)^2.4`.
    pub fn to_linear(self) -> Radiance {
        Radiance::new(linear_of(self.r), linear_of(self.g), linear_of(self.b))
    }

    /// Returns the color of linear light in 0..1, by the inverse of [`Color::to_linear`]: `12.92·l`
    /// for `l <= 0.0031308`, else `1.055·l^(1/2.4) - 0.055`.
    pub fn from_linear(light: Radiance) -> Self {
        let [r, g, b] = light.channels.map(to_display);
        Self::new(r, g, b)
    }

    /// Parses `#rrggbb` or `#rgb`, in either case.
    pub(crate) fn parse_hex(text: &str) -> Option<[u8; 3]> {
        let digits = text.strip_prefix('#')?;
        if !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return None;
        }
        let number = u32::from_str_radix(digits, 16).ok()?;
        let [_, r, g, b] = match digits.len() {
            6 => number.to_be_bytes(),
            // #rgb is #rrggbb with every digit twice.
            3 => {
                let [high, low] = [(number >> 8) & 15, number & 0xff];
                [0, high, low >> 4, low & 15].map(|digit| (digit * 17) as u8)
            }
            _ => return None,
        };
        Some([r, g, b])
    }
}

// Not `f64::clamp`, which lets NaN and -0 through.
const fn clamp(channel: f64) -> f64 {
    if channel > 0.0 {
        if channel < 1.0 { channel } else { 1.0 }
    } else {
        0.0
    }
}

impl Add for Color {
    type Output = Self;

    /// Adds channel by channel.
    fn add(self, other: Self) -> Self {
        Self::new(self.r + other.r, self.g + other.g, self.b + other.b)
    }
}

impl Sub for Color {
    type Output = Self;

    /// Subtracts channel by channel.
    fn sub(self, other: Self) -> Self {
        Self::new(self.r - other.r, self.g - other.g, self.b - other.b)
    }
}

impl Mul for Color {
    type Output = Self;

    /// Multiplies channel by channel, like one color seen through the other.
    fn mul(self, other: Self) -> Self {
        Self::new(self.r * other.r, self.g * other.g, self.b * other.b)
    }
}

impl Mul<f64> for Color {
    type Output = Self;

    /// Multiplies every channel by a number.
    fn mul(self, scale: f64) -> Self {
        Self::new(self.r * scale, self.g * scale, self.b * scale)
    }
}

impl Mul<Color> for f64 {
    type Output = Color;

    /// Multiplies every channel by a number.
    fn mul(self, color: Color) -> Color {
        color * self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn grey(channel: f64) -> Color {
        Color::new(channel, channel, channel)
    }

    #[test]
    fn new_clamps() {
        let color = Color::new(-0.25, 0.25, 1.25);
        assert_eq!((color.r(), color.g(), color.b()), (0.0, 0.25, 1.0));
        let color = Color::new(f64::NAN, f64::INFINITY, f64::NEG_INFINITY);
        assert_eq!((color.r(), color.g(), color.b()), (0.0, 1.0, 0.0));
        assert!(Color::new(-0.0, 0.0, 0.0).r().is_sign_positive());
    }

    #[test]
    fn bytes_round_half_up() {
        let grey = |channel| grey(channel).to_rgb8()[0];
        assert_eq!(grey(0.0), 0);
        assert_eq!(grey(1.0), 255);
        assert_eq!(grey(0.5), 128);
        assert_eq!(grey(0.4 / 255.0), 0);
        assert_eq!(grey(0.5 / 255.0), 1);
        for byte in 0..=255_u8 {
            assert_eq!(grey(f64::from(byte) / 255.0), byte);
        }
    }

    #[test]
    fn half_the_light_is_not_half_the_display_value() {
        let half = Color::from_linear(Radiance::new(0.5, 0.5, 0.5));
        // IEC 61966-2-1: 1.055·0.5^(1/2.4) - 0.055 = 0.735356...
        assert!((half.r() - 0.735_356_983_052_45).abs() < 1e-13);
        assert_eq!(half.to_rgb8(), [188; 3]);
        assert_eq!(Color::BLACK.to_linear(), Radiance::BLACK);
        assert_eq!(Color::WHITE.to_linear().channels, [1.0; 3]);
    }

    #[test]
    fn every_byte_round_trips_through_linear_light() {
        for byte in 0..=255_u8 {
            let color = grey(f64::from(byte) / 255.0);
            assert_eq!(Color::from_linear(color.to_linear()).to_rgb8(), [byte; 3]);
        }
        // The two pieces of the function must meet.
        for c in [0.04045, 0.04045_f64.next_up()] {
            let light = grey(c).to_linear();
            assert!((Color::from_linear(light).r() - c).abs() < 1e-7);
        }
    }

    #[test]
    fn operators_work_by_channel_and_clamp() {
        let a = Color::new(0.5, 0.25, 1.0);
        let b = Color::new(0.75, 0.5, 0.5);
        assert_eq!(a + b, Color::new(1.0, 0.75, 1.0));
        assert_eq!(a - b, Color::new(0.0, 0.0, 0.5));
        assert_eq!(a * b, Color::new(0.375, 0.125, 0.5));
        assert_eq!(a * 2.0, Color::new(1.0, 0.5, 1.0));
        assert_eq!(0.5 * a, Color::new(0.25, 0.125, 0.5));
        assert_eq!(a * -1.0, Color::BLACK);
        assert_eq!(a * f64::NAN, Color::BLACK);
        assert_eq!(
            Color::BLACK * f64::INFINITY,
            Color::BLACK,
            "0 times infinity is NaN"
        );
    }
}
