//! Linear light of three channels.

use std::{
    array,
    ops::{Add, Div, Mul},
    sync::OnceLock,
};

use crate::tracer::srgb::{quantize, to_display, to_linear};

/// Linear light: red, green and blue, proportional to an amount of light.
///
/// A screen can show 0..1, but values are not clamped to that range. Amounts of light can be added
/// and averaged; display values ([`Color`](crate::Color)) cannot: the mean of black and white is
/// `0.5` here and 188 of 255 there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Radiance {
    /// Red, green and blue.
    pub(crate) channels: [f64; 3],
}

impl Radiance {
    /// No light.
    pub const BLACK: Self = Self::new(0.0, 0.0, 0.0);
    /// The light of a white surface: 1 in all channels.
    pub const WHITE: Self = Self::new(1.0, 1.0, 1.0);

    /// Creates light of three channels.
    pub const fn new(r: f64, g: f64, b: f64) -> Self {
        Self {
            channels: [r, g, b],
        }
    }

    /// The red channel.
    pub const fn r(self) -> f64 {
        self.channels[0]
    }

    /// The green channel.
    pub const fn g(self) -> f64 {
        self.channels[1]
    }

    /// The blue channel.
    pub const fn b(self) -> f64 {
        self.channels[2]
    }

    /// Returns the largest channel.
    pub(crate) fn max_channel(self) -> f64 {
        let [r, g, b] = self.channels;
        r.max(g).max(b)
    }

    /// Returns the bytes of `Color::from_linear`, but faster: without a power per channel.
    pub(crate) fn to_rgb8(self) -> [u8; 3] {
        self.channels.map(byte_of)
    }
}

impl Add for Radiance {
    type Output = Self;

    /// Adds channel by channel.
    fn add(self, other: Self) -> Self {
        Self {
            channels: array::from_fn(|channel| self.channels[channel] + other.channels[channel]),
        }
    }
}

impl Mul for Radiance {
    type Output = Self;

    /// Multiplies channel by channel, as light that goes through a color.
    fn mul(self, other: Self) -> Self {
        Self {
            channels: array::from_fn(|channel| self.channels[channel] * other.channels[channel]),
        }
    }
}

impl Mul<f64> for Radiance {
    type Output = Self;

    /// Multiplies every channel by a number.
    fn mul(self, factor: f64) -> Self {
        Self {
            channels: self.channels.map(|channel| channel * factor),
        }
    }
}

impl Div<f64> for Radiance {
    type Output = Self;

    /// Divides every channel by a number.
    fn div(self, divisor: f64) -> Self {
        Self {
            channels: self.channels.map(|channel| channel / divisor),
        }
    }
}

/// The light levels at which bytes change, and a table to find them.
struct Bytes {
    /// Byte b becomes b+1 at this light, the display value (b+½)/255; the last is infinite.
    ends: [f64; 256],
    /// The byte at the lower end of each cell.
    cells: [u8; CELLS],
}

/// The exponent of the smallest light in the cells; all below has the byte 0.
const LEAST: u64 = 1023 - 13;
/// Each octave of light has 2⁸ cells, in which the byte changes at most once.
const SHIFT: u32 = 52 - 8;
/// From 2⁻¹³ to 1.
const CELLS: usize = 13 << 8;

impl Bytes {
    fn new() -> Self {
        let end = |byte: usize| match byte {
            255 => f64::INFINITY,
            byte => to_linear((byte as f64 + 0.5) / 255.0),
        };
        let ends: [f64; 256] = array::from_fn(end);
        let lowest = |cell: usize| f64::from_bits((cell as u64 + (LEAST << 8)) << SHIFT);
        Self {
            cells: array::from_fn(|cell| {
                ends.partition_point(|end| *end < lowest(cell) * (1.0 - CLEAR)) as u8
            }),
            ends,
        }
    }
}

/// The relative distance to a change below which light takes the exact path. Rounding errors are
/// thousands of times smaller.
const CLEAR: f64 = 1e-12;

/// Returns the byte of light, by comparison with the light levels at which the byte changes.
fn byte_of(light: f64) -> u8 {
    static BYTES: OnceLock<Box<Bytes>> = OnceLock::new();
    let bytes = BYTES.get_or_init(|| Box::new(Bytes::new()));
    let exact = || quantize(to_display(light), u8::MAX.into()) as u8;
    // Negative numbers and NaN have larger bits than 1.
    let Some(cell) = (light.to_bits() >> SHIFT).checked_sub(LEAST << 8) else {
        return 0;
    };
    let Some(low) = bytes.cells.get(cell as usize) else {
        return if light >= 1.0 { u8::MAX } else { exact() };
    };
    let end = bytes.ends[usize::from(*low)];
    if light * (1.0 + CLEAR) < end {
        *low
    } else if light * (1.0 - CLEAR) > end {
        low + 1
    } else {
        exact()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::color::Color;
    use crate::tracer::random::{Rng, cases};

    #[test]
    fn bytes_of_light_are_those_of_its_color() {
        let plain = |light: f64| Color::from_linear(Radiance::new(light, 0.0, 0.0)).to_rgb8()[0];
        let mut random = Rng(3);
        for _ in 0..cases(20_000) {
            let light = random.magnitude(-6.0, 0.5);
            assert_eq!(byte_of(light), plain(light), "{light}");
        }
        for byte in 0..=255_u8 {
            let end = to_linear((f64::from(byte) + 0.5) / 255.0);
            for ulps in -40..40_i64 {
                let light = f64::from_bits(end.to_bits().wrapping_add_signed(ulps));
                assert_eq!(byte_of(light), plain(light), "{byte} {ulps}");
            }
        }
        assert_eq!(
            [0.0, 1.0, 7.0, -1.0, f64::NAN].map(byte_of),
            [0, 255, 255, 0, 0]
        );
        assert_eq!(byte_of(f64::INFINITY), 255);
        for cell in 0..CELLS {
            let light = f64::from_bits((cell as u64 + (LEAST << 8)) << SHIFT);
            for light in [light, light.next_down(), light.next_up()] {
                assert_eq!(byte_of(light), plain(light), "{light}");
            }
        }
    }

    #[test]
    fn light_adds_up() {
        let light = Radiance::new(0.25, 0.5, 1.0) + Radiance::new(0.25, 0.0, 2.0);
        assert_eq!(light / 2.0, Radiance::new(0.25, 0.25, 1.5));
        assert_eq!((light.r(), light.g(), light.b()), (0.5, 0.5, 3.0));
    }
}
