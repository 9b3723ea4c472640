//! Animated PNG: the frames of a movie, repeated forever by a browser.

use std::io::{self, Write};

use png::{
    BitDepth, ColorType, DeflateCompression, Encoder, EncodingError, Filter, SrgbRenderingIntent,
};

use super::{FrameSink, Reel, fraction::fraction};
use crate::{diagnostic::error::Error, film::Image};

pub(super) fn write<E: From<Error>>(
    writer: impl Write,
    reel: Reel,
    draw: impl FnOnce(FrameSink) -> Result<(), E>,
) -> Result<(), E> {
    let mut encoder = Encoder::new(writer, reel.size.width(), reel.size.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    // As for a single picture with fast compression.
    encoder.set_deflate_compression(DeflateCompression::FdeflateUltraFast);
    encoder.set_filter(Filter::Up);
    // 0 means forever. The time of a frame is a fraction of 16-bit integers.
    encoder.set_animated(reel.frames, 0).map_err(error)?;
    let (below, above) = fraction(reel.fps, u16::MAX.into());
    let delay = encoder.set_frame_delay(above as u16, below as u16);
    delay.map_err(error)?;
    let mut writer = encoder.write_header().map_err(error)?;
    draw(&mut |image: &Image| writer.write_image_data(image.pixels()).map_err(error))?;
    Ok(writer.finish().map_err(error)?)
}

fn error(error: EncodingError) -> Error {
    Error::writing(match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    })
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::{film::size::Size, image_file::movie::MovieFormat};

    #[test]
    fn frames_come_back() {
        let size = Size::new(3, 2).unwrap();
        let images: Vec<_> = (0..4_u8)
            .map(|number| Image::new(size, vec![number * 50; 18]))
            .collect();
        let reel = Reel {
            size,
            fps: 25.0,
            frames: 4,
        };
        let mut file = Vec::new();
        let draw = |sink: FrameSink| images.iter().try_for_each(sink);
        MovieFormat::Apng.write(&mut file, reel, draw).unwrap();
        let mut reader = png::Decoder::new(Cursor::new(&file)).read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames, 4);
        let mut pixels = vec![0; 18];
        for image in &images {
            reader.next_frame(&mut pixels).unwrap();
            assert_eq!(pixels, image.pixels());
            let frame = reader.info().frame_control().unwrap();
            assert_eq!((frame.delay_num, frame.delay_den), (1, 25));
        }

        let few = |sink: FrameSink| images.iter().take(3).try_for_each(sink);
        assert!(MovieFormat::Apng.write(Vec::new(), reel, few).is_err());
    }
}
