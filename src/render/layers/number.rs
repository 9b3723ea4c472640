//! One number of a pixel: its quantity, and how it is written.

use half::f16;

use crate::{image_file::pixel::Sample, tracer::srgb::quantize};

/// The quantity of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Quantity {
    /// Red, green or blue as a display value; in a partly transparent pixel, of the opaque part.
    Display(Light, usize),
    /// The same channel as linear light.
    Light(Light, usize),
    /// The linear light of the whole pixel, which is less if part of it is transparent.
    Premultiplied(usize),
    /// The part of the pixel that hides the background.
    Alpha,
    /// The fraction of the pixel where something is hit.
    Coverage,
    Depth,
    Z,
    Position(usize),
    Normal(usize),
    Id,
    /// The number of samples.
    Samples,
    /// The Cryptomatte number of a geometry, by rank: 0 covers most of the pixel.
    Matte(usize),
    /// The fraction of the pixel that this geometry covers.
    MatteCoverage(usize),
}

/// A kind of light of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Light {
    /// All that the pixel shows.
    All,
    /// A part of that, by its place among [`LightParts::NAMES`](crate::film::parts::LightParts::NAMES).
    Part(usize),
    /// The first color of the material.
    Albedo,
    /// The standard error of the mean of all light.
    Error,
}

/// The conversion of a quantity to an integer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Range {
    /// From 0 to 1.
    Unit,
    /// From -1 to 1.
    Signed,
    /// From one depth to another; depths outside are clamped.
    Depth(f64, f64),
    /// Unchanged.
    Same,
    /// The id plus 1; nothing is 0.
    FromOne,
}

/// A number in each pixel of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number {
    pub(super) quantity: Quantity,
    pub(super) sample: Sample,
    pub(super) range: Range,
}

/// The number of geometries per pixel in Cryptomatte layers.
pub(super) const MATTES: usize = 6;

impl Number {
    /// Writes this number of pixels into the first of `size` bytes each, in native byte order.
    pub(super) fn write(&self, values: &[f64], bytes: &mut [u8], size: usize) {
        let range = self.range;
        let integer = |value: f64, most: u32| -> u32 {
            let part = match range {
                Range::Unit => value,
                Range::Signed => (value + 1.0) / 2.0,
                Range::Depth(near, far) => (value - near) / (far - near),
                Range::Same => return value as u32,
                Range::FromOne => return (value as u32).wrapping_add(1),
            };
            quantize(part, most)
        };
        let byte = |value| integer(value, u8::MAX.into()) as u8;
        let short = |value| integer(value, u16::MAX.into()) as u16;
        let long = |value| integer(value, u32::MAX);
        match self.sample {
            Sample::U8 => put(values, bytes, size, |value| [byte(value)]),
            Sample::U16 => put(values, bytes, size, |value| short(value).to_ne_bytes()),
            Sample::U32 => put(values, bytes, size, |value| long(value).to_ne_bytes()),
            Sample::F16 => put(values, bytes, size, |value| {
                f16::from_f64(value).to_ne_bytes()
            }),
            Sample::F32 => put(values, bytes, size, |value| (value as f32).to_ne_bytes()),
            Sample::F64 => put(values, bytes, size, f64::to_ne_bytes),
        }
    }
}

/// Writes values into the first of `size` bytes each.
fn put<const N: usize>(values: &[f64], bytes: &mut [u8], size: usize, of: impl Fn(f64) -> [u8; N]) {
    if size == N {
        // Planes, which the compiler takes many at a time.
        for (to, value) in bytes.as_chunks_mut().0.iter_mut().zip(values) {
            *to = of(*value);
        }
        return;
    }
    for (to, value) in bytes.chunks_mut(size).zip(values) {
        to[..N].copy_from_slice(&of(*value));
    }
}
