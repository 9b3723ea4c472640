//! Radiance HDR: three numbers with a common exponent, one byte each, and runs of equal bytes.
//!
//! The format is described by Greg Ward, "Real Pixels", Graphics Gems II, 1991. The header has no
//! date. It states the primaries, which are those of sRGB and not Radiance's default.

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        Content, Encoding, Form, Format, ImageFormat,
        output::{Draw, Output},
        pixel::{Pixel, Sample},
        runs::{ByteRun, runs},
    },
};

impl ImageFormat {
    /// Radiance HDR: floats of 8 bits each with a common exponent.
    pub const HDR: Self = Self(&Format {
        endings: &["hdr"],
        content: Content::Floats,
        holds: |pixel| pixel == PIXEL,
        has_signs: false,
        has_metadata: true,
        decoder: Some(image::ImageFormat::Hdr),
        encode,
        ..Format::PLAIN
    });
}

/// The row widths that are written as runs; the format does not support runs for others.
const WITH_RUNS: std::ops::RangeInclusive<u32> = 8..=32_767;

/// The only supported pixel type.
const PIXEL: Pixel = Pixel::Rgb(Sample::F32);

fn encode(output: Output, form: Form, draw: Draw) -> Result<(), Error> {
    let Form { size, encoding, .. } = form;
    let header = header(size, encoding);
    let width = size.width() as usize;
    output.write_rows(header.as_bytes(), draw, |rows| {
        let (mut file, mut columns) = (Vec::new(), vec![0; width]);
        let (pixels, _) = rows.as_chunks::<12>();
        for row in pixels.chunks(width) {
            let pixels: Vec<[u8; 4]> = row.iter().map(|pixel| rgbe(numbers(pixel))).collect();
            if WITH_RUNS.contains(&size.width()) {
                let [high, low] = (size.width() as u16).to_be_bytes();
                file.extend([2, 2, high, low]);
                for part in 0..4 {
                    let all = columns.iter_mut().zip(&pixels);
                    all.for_each(|(byte, pixel)| *byte = pixel[part]);
                    append_runs(&columns, &mut file);
                }
            } else {
                file.extend(pixels.as_flattened());
            }
        }
        file.into()
    })
}

fn header(size: Size, encoding: Encoding) -> String {
    let mut header = "#?RADIANCE\n".to_owned();
    for line in encoding.lines() {
        header += &format!("# {line}\n");
    }
    header += "FORMAT=32-bit_rle_rgbe\n";
    if encoding.colors {
        header += "PRIMARIES=0.6400 0.3300 0.3000 0.6000 0.1500 0.0600 0.3127 0.3290\n";
    }
    header + &format!("\n-Y {} +X {}\n", size.height(), size.width())
}

fn append_runs(bytes: &[u8], file: &mut Vec<u8>) {
    for run in runs(bytes, 4) {
        match run {
            ByteRun::Equal(count, byte) => file.extend([128 + count, byte]),
            ByteRun::Unequal(bytes) => {
                file.push(bytes.len() as u8);
                file.extend(bytes);
            }
        }
    }
}

fn numbers(pixel: &[u8; 12]) -> [f32; 3] {
    let (numbers, _) = pixel.as_chunks::<4>();
    std::array::from_fn(|place| f32::from_ne_bytes(numbers[place]))
}

/// Returns three numbers as the nearest bytes with a common exponent. Negative numbers become zero;
/// numbers that are too large become the largest one.
fn rgbe(color: [f32; 3]) -> [u8; 4] {
    /// The largest number, with the largest exponent, whose byte does not round beyond 255.
    const LARGEST: f64 = 255.0 / 256.0 * (1_u128 << 127) as f64;
    let color = color.map(|number| f64::from(number).clamp(0.0, LARGEST));
    let color = color.map(|number| if number.is_nan() { 0.0 } else { number });
    let most = color.into_iter().fold(0.0, f64::max);
    // `most` is from 2^(power - 1) up to 2^power, by the exponent bits of the double.
    let mut power = (most.to_bits() >> 52) as i32 - 1022;
    // 256 / 2^power.
    let scale = |power: i32| f64::from_bits(((1023 + 8 - power) as u64) << 52);
    if most * scale(power.max(-127)) >= 255.5 {
        power += 1;
    }
    if power <= -128 {
        return [0; 4];
    }
    let [r, g, b] = color.map(|number| (number * scale(power) + 0.5) as u8);
    [r, g, b, (power + 128) as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_known() {
        assert_eq!(rgbe([0.0; 3]), [0; 4]);
        assert_eq!(rgbe([1.0, 0.5, 0.25]), [128, 64, 32, 129]);
        assert_eq!(rgbe([255.0, 1.0, 0.4]), [255, 1, 0, 136]);
        assert_eq!(rgbe([255.6, 0.0, 0.0]), [128, 0, 0, 137], "rounded up");
        assert_eq!(rgbe([0.75, f32::NAN, -1.0]), [192, 0, 0, 128]);
        assert_eq!(rgbe([f32::INFINITY, 0.0, 0.0]), [255, 0, 0, 255]);
        assert_eq!(rgbe([1e-40, 0.0, 0.0]), [0; 4], "too small");
        let smallest = f32::from_bits(1 << 23) / 2.0;
        assert_eq!(rgbe([smallest, 0.0, 0.0]), [128, 0, 0, 2]);
    }
}
