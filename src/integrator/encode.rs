//! The light of many pixels as integers of a file.

use crate::{
    simd::{Kernel, Simd},
    tracer::{
        radiance::Bytes,
        srgb::{BLOCK, Levels},
        tone::Tone,
    },
};

/// Turns light into the integers of a file.
pub(crate) struct Encode<'a> {
    pub(crate) tone: Tone,
    /// Red, green and blue.
    pub(crate) light: [&'a [f64]; 3],
    /// True for integers of 16 bits, false for bytes.
    pub(crate) is_wide: bool,
    /// The number of integers of a pixel: three, or four, the last of which becomes 0.
    pub(crate) channels: usize,
    /// The integers of each pixel, in native byte order.
    pub(crate) bytes: &'a mut [u8],
}

impl Kernel for Encode<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let (table, levels) = (Bytes::table(), Levels::table());
        let mut light = [[0.0; BLOCK]; 3];
        let (mut bytes, mut numbers) = ([[0; BLOCK]; 3], [[0; BLOCK]; 3]);
        let size = self.channels << u8::from(self.is_wide);
        let blocks = self.bytes.chunks_mut(BLOCK * size);
        for (start, pixels) in (0..).step_by(BLOCK).zip(blocks) {
            let count = pixels.len() / size;
            for (to, from) in light.iter_mut().zip(self.light) {
                to[..count].copy_from_slice(&from[start..start + count]);
            }
            self.tone.apply(&mut light);
            if self.is_wide {
                levels.of_block(&light, &mut numbers);
                interleave(&numbers, self.channels, u16::to_ne_bytes, pixels);
            } else {
                table.of_block(&light, &mut bytes);
                interleave(&bytes, self.channels, u8::to_ne_bytes, pixels);
            }
        }
    }
}

/// Sets the integers of pixels that have three of them or four.
fn interleave<T: Copy, const BYTES: usize>(
    [r, g, b]: &[[T; BLOCK]; 3],
    channels: usize,
    of: impl Fn(T) -> [u8; BYTES],
    pixels: &mut [u8],
) {
    let integers = pixels.as_chunks_mut().0;
    let colors = r.iter().zip(g).zip(b);
    let colors = colors.map(|((r, g), b)| [of(*r), of(*g), of(*b)]);
    if channels == 3 {
        let pixels = integers.as_chunks_mut().0.iter_mut();
        pixels.zip(colors).for_each(|(pixel, color)| *pixel = color);
    } else {
        let pixels = integers.as_chunks_mut().0.iter_mut();
        pixels
            .zip(colors)
            .for_each(|(pixel, [r, g, b])| *pixel = [r, g, b, [0; BYTES]]);
    }
}
