//! YUV4MPEG2: a line for the movie, then for each picture a line and its three planes.
//!
//! The planes are those of ITU-R BT.601 in limited range, each at full size (4:4:4). `ffmpeg`
//! assumes this by default, and the format has no field to state it.

use std::io::Write;

use super::{FrameSink, Reel, fraction::fraction};
use crate::{diagnostic::error::Error, film::Image};

pub(super) fn write<E: From<Error>>(
    mut writer: impl Write,
    reel: Reel,
    draw: impl FnOnce(FrameSink) -> Result<(), E>,
) -> Result<(), E> {
    let (width, height) = (reel.size.width(), reel.size.height());
    let (above, below) = fraction(reel.fps, i32::MAX as u32);
    let header =
        format!("YUV4MPEG2 W{width} H{height} F{above}:{below} Ip A1:1 C444 XCOLORRANGE=LIMITED\n");
    writer
        .write_all(header.as_bytes())
        .map_err(Error::writing)?;
    let mut planes = Vec::new();
    draw(&mut |image: &Image| {
        planes.clear();
        planes.extend_from_slice(b"FRAME\n");
        let (pixels, _) = image.pixels().as_chunks::<3>();
        for plane in [luma, blue, red] {
            // Most pixels equal the one before them.
            let mut last = ([0; 3], plane([0.0; 3]));
            planes.extend(pixels.iter().map(|pixel| {
                if *pixel != last.0 {
                    last = (*pixel, plane(pixel.map(f64::from)));
                }
                last.1
            }));
        }
        writer.write_all(&planes).map_err(Error::writing)
    })?;
    Ok(writer.flush().map_err(Error::writing)?)
}

/// Returns the weighted sum of the display values, from 0 to 255.
fn brightness([r, g, b]: [f64; 3]) -> f64 {
    0.299 * r + 0.587 * g + 0.114 * b
}

fn luma(pixel: [f64; 3]) -> u8 {
    (16.0 + brightness(pixel) * 219.0 / 255.0 + 0.5).floor() as u8
}

fn blue(pixel: [f64; 3]) -> u8 {
    chroma((pixel[2] - brightness(pixel)) / 1.772)
}

fn red(pixel: [f64; 3]) -> u8 {
    chroma((pixel[0] - brightness(pixel)) / 1.402)
}

fn chroma(difference: f64) -> u8 {
    (128.0 + difference * 224.0 / 255.0 + 0.5).floor() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The values that the recommendation gives for the primaries.
    #[test]
    fn colors_are_those_of_the_recommendation() {
        for (pixel, expected) in [
            ([0.0, 0.0, 0.0], [16, 128, 128]),
            ([255.0, 255.0, 255.0], [235, 128, 128]),
            ([255.0, 0.0, 0.0], [81, 90, 240]),
            ([0.0, 255.0, 0.0], [145, 54, 34]),
            ([0.0, 0.0, 255.0], [41, 240, 110]),
        ] {
            assert_eq!([luma(pixel), blue(pixel), red(pixel)], expected);
        }
    }
}
