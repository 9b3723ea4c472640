//! Linear light of three channels.

use std::{
    array,
    ops::{Add, Div, Mul, Sub},
    sync::OnceLock,
};

use crate::tracer::srgb::{BLOCK, of_neighbors, quantize, to_display, to_linear};

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

    /// Returns the mean of the channels.
    pub(crate) fn mean(self) -> f64 {
        let [r, g, b] = self.channels;
        (r + g + b) / 3.0
    }

    /// Returns the bytes of `Color::from_linear`.
    pub(crate) fn to_rgb8(self) -> [u8; 3] {
        Bytes::table().of(self)
    }
}

impl Add for Radiance {
    type Output = Self;

    /// Adds channel by channel.
    #[inline]
    fn add(self, other: Self) -> Self {
        let ([r, g, b], [x, y, z]) = (self.channels, other.channels);
        Self::new(r + x, g + y, b + z)
    }
}

impl Sub for Radiance {
    type Output = Self;

    /// Subtracts channel by channel.
    #[inline]
    fn sub(self, other: Self) -> Self {
        let ([r, g, b], [x, y, z]) = (self.channels, other.channels);
        Self::new(r - x, g - y, b - z)
    }
}

impl Mul for Radiance {
    type Output = Self;

    /// Multiplies channel by channel, as light that goes through a color.
    #[inline]
    fn mul(self, other: Self) -> Self {
        let ([r, g, b], [x, y, z]) = (self.channels, other.channels);
        Self::new(r * x, g * y, b * z)
    }
}

impl Mul<f64> for Radiance {
    type Output = Self;

    /// Multiplies every channel by a number.
    #[inline]
    fn mul(self, factor: f64) -> Self {
        let [r, g, b] = self.channels;
        Self::new(r * factor, g * factor, b * factor)
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

/// A table that finds the byte of light by comparison with the light at which the byte changes.
pub(crate) struct Bytes {
    /// For each cell, an f64: the light at which the byte changes there or later. Its lowest eight
    /// bits are replaced by the byte before.
    cells: [u64; CELLS],
}

/// The lowest light in the cells, 2⁻¹³; all below has the byte 0.
const LEAST: u64 = (1023 - 13) << 52;
/// The largest light in the cells: the last below 8.
const MOST: u64 = ((1023 + 3) << 52) - 1;
/// Each octave of light has 2⁷ cells, in which the byte changes at most once.
const SHIFT: u32 = 52 - 7;
/// 16 octaves.
const CELLS: usize = 16 << 7;
/// The relative distance to a change below which light takes the exact path. Rounding errors and
/// replaced bits are much smaller.
const CLEAR: f64 = 1e-12;

impl Bytes {
    fn new() -> Self {
        // Byte b becomes b+1 at the display value (b+½)/255.
        let ends: Vec<_> = (0..255)
            .map(|byte| to_linear((f64::from(byte) + 0.5) / 255.0))
            .collect();
        let cell = |cell: usize| {
            let lowest = f64::from_bits(LEAST + ((cell as u64) << SHIFT));
            let byte = ends.partition_point(|end| *end < lowest * (1.0 - CLEAR));
            let end = ends.get(byte).copied().unwrap_or(f64::INFINITY);
            end.to_bits() & !0xff | byte as u64
        };
        Self {
            cells: array::from_fn(cell),
        }
    }

    /// Returns the table.
    pub(crate) fn table() -> &'static Self {
        static BYTES: OnceLock<Box<Bytes>> = OnceLock::new();
        BYTES.get_or_init(|| Box::new(Self::new()))
    }

    /// Returns the bytes of `Color::from_linear`, but faster: without a power per channel.
    #[inline(always)]
    pub(crate) fn of(&self, light: Radiance) -> [u8; 3] {
        let [r, g, b] = light.channels;
        [self.byte_of(r), self.byte_of(g), self.byte_of(b)]
    }

    /// Sets the bytes of a block, by channel.
    #[inline(always)]
    pub(crate) fn of_block(&self, light: &[[f64; BLOCK]; 3], bytes: &mut [[u8; BLOCK]; 3]) {
        let (light, bytes) = (light.as_flattened(), bytes.as_flattened_mut());
        let mut cells = [0; 3 * BLOCK];
        for (cell, light) in cells.iter_mut().zip(light) {
            *cell = cell_of(inside(*light));
        }
        let mut found = [0; 3 * BLOCK];
        for (found, cell) in found.iter_mut().zip(cells) {
            *found = self.cells[cell as usize % CELLS];
        }
        let mut is_unclear = 0;
        for ((byte, found), light) in bytes.iter_mut().zip(&found).zip(light) {
            let (next, unclear) = next(*found, inside(*light));
            *byte = next;
            is_unclear |= u8::from(unclear);
        }
        if is_unclear != 0 {
            of_neighbors(light, bytes, |light| self.byte_of(light));
        }
    }

    #[inline(always)]
    fn byte_of(&self, light: f64) -> u8 {
        match next(
            self.cells[cell_of(inside(light)) as usize % CELLS],
            inside(light),
        ) {
            (byte, false) => byte,
            _ => exact(light),
        }
    }
}

/// Returns light within the cells; NaN becomes the least.
#[inline(always)]
fn inside(light: f64) -> f64 {
    let (least, most) = (f64::from_bits(LEAST), f64::from_bits(MOST));
    let light = if light > least { light } else { least };
    if light < most { light } else { most }
}

/// Returns the cell of light.
#[inline(always)]
fn cell_of(inside: f64) -> u64 {
    (inside.to_bits() - LEAST) >> SHIFT
}

/// Returns the byte of light from its cell, and whether it is too close to a change.
#[inline(always)]
fn next(found: u64, inside: f64) -> (u8, bool) {
    // With the byte 255, the end is NaN.
    let end = f64::from_bits(found);
    let byte = found as u8 + u8::from(inside > end);
    (byte, (inside - end).abs() <= end * CLEAR)
}

#[cold]
fn exact(light: f64) -> u8 {
    quantize(to_display(light), u8::MAX.into()) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::color::Color;
    use crate::tracer::random::{Rng, cases};

    #[test]
    fn bytes_of_light_are_those_of_its_color() {
        let plain = |light: f64| Color::from_linear(Radiance::new(light, 0.0, 0.0)).to_rgb8()[0];
        let byte_of = |light| Bytes::table().byte_of(light);
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
            let light = f64::from_bits(LEAST + ((cell as u64) << SHIFT));
            let next = f64::from_bits(LEAST + ((cell as u64 + 1) << SHIFT)).next_down();
            assert!(plain(next) - plain(light) <= 1, "{light}");
            for light in [light, light.next_down(), light.next_up(), next] {
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
