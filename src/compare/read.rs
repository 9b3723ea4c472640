//! Reading pictures of any format.

use std::{io::Cursor, path::Path};

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use tiff::{ColorType, decoder::DecodingResult};

use crate::{
    compare::{
        exr,
        limit::{self, PictureOptions, broken},
        numpy, pfm,
        picture::{Picture, Samples},
    },
    diagnostic::error::{Error, ErrorKind},
    image_file::{check_memory, format::is_decoded},
    parallel::{Cancel, reader::UntilCancelled},
};

impl Picture {
    /// Reads a picture file; its first bytes determine the format.
    ///
    /// # Errors
    ///
    /// Fails if the file cannot be read, is not a picture, is broken, has more pixels than
    /// [`PictureOptions`] allow, or does not fit into memory.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read_with(path, &PictureOptions::new())
    }

    /// Reads a picture file with other limits.
    ///
    /// # Errors
    ///
    /// Fails like [`Picture::read`].
    pub fn read_with(path: impl AsRef<Path>, options: &PictureOptions) -> Result<Self, Error> {
        let path = path.as_ref();
        let file = options.bytes(path)?;
        Self::from_bytes(&file, options).map_err(|error| error.at(path))
    }

    /// Reads a picture from the bytes of a file.
    ///
    /// # Errors
    ///
    /// Fails like [`Picture::read`].
    pub fn from_bytes(file: &[u8], options: &PictureOptions) -> Result<Self, Error> {
        Self::until_cancelled(file, options, None)
    }

    /// The same until cancelled, which is asked as far as the decoder of the format reads on.
    pub(crate) fn until_cancelled(
        file: &[u8],
        options: &PictureOptions,
        cancel: Option<&Cancel>,
    ) -> Result<Self, Error> {
        if pfm::is_pfm(file) {
            return pfm::decode(file, options, cancel);
        }
        if numpy::is_npy(file) {
            return Self::of_layers(numpy::npy(file, options)?, numpy::ARRAY);
        }
        if numpy::is_npz(file) {
            return Self::of_layers(numpy::npz(file, options)?, "color");
        }
        let format = image::guess_format(file).ok();
        let format = format.filter(|format| is_decoded(*format)).ok_or_else(|| {
            let message = "is not a picture in a supported format: PNG, JPEG, BMP, TIFF, PPM, PFM, QOI, \
                               WebP, HDR, EXR, NPY and NPZ";
            Error::new(ErrorKind::Unreadable, message)
        })?;
        let broken = |error| broken(format.extensions_str()[0], error);
        // The decoder fills the missing part of a truncated file with gray.
        if format == ImageFormat::Jpeg && !file.windows(2).any(|two| two == END_OF_JPEG) {
            return Err(limit::broken("jpg", "the end is missing"));
        }
        if format == ImageFormat::Tiff
            && let Some(gray) = gray_floats(file, options, cancel)?
        {
            return Ok(gray);
        }
        if format == ImageFormat::WebP {
            options.check_webp(file)?;
        }
        let layers = if format == ImageFormat::OpenExr {
            let (layers, has_colors) = exr::layers(file, options, cancel)?;
            if !has_colors {
                return Self::of_layers(layers, "");
            }
            Some(layers)
        } else {
            None
        };
        let file = UntilCancelled::new(Cursor::new(file), cancel);
        let mut reader = ImageReader::with_format(file, format);
        // The size is not known yet, so this limit covers only what is not pixels.
        reader.limits(PictureOptions::decoder_limits(0));
        let decoder = reader.into_decoder();
        let mut decoder = decoder.map_err(broken)?;
        let (width, height) = decoder.dimensions();
        let size = options.size(width, height)?;
        check_memory(size, decoder.total_bytes())?;
        let limits = PictureOptions::decoder_limits(size.pixels());
        decoder.set_limits(limits).map_err(broken)?;
        let image = DynamicImage::from_decoder(decoder);
        let (channels, samples) = samples(image.map_err(broken)?);
        let mut picture = Self::new(size, channels, samples, format == ImageFormat::OpenExr)?;
        picture.layers = layers;
        Ok(picture)
    }
}

/// Reads a TIFF file with one float per pixel, which `image` does not support.
fn gray_floats(
    file: &[u8],
    options: &PictureOptions,
    cancel: Option<&Cancel>,
) -> Result<Option<Picture>, Error> {
    let file = UntilCancelled::new(Cursor::new(file), cancel);
    let Ok(mut tiff) = tiff::decoder::Decoder::new(file) else {
        return Ok(None);
    };
    let (Ok(ColorType::Gray(32)), Ok((width, height))) = (tiff.colortype(), tiff.dimensions())
    else {
        return Ok(None);
    };
    let size = options.size(width, height)?;
    check_memory(size, size.pixels() * 4)?;
    let mut tiff = tiff.with_limits(PictureOptions::tiff_limits(size));
    let image = tiff.read_image();
    match image.map_err(|error| broken("tiff", error))? {
        DecodingResult::F32(floats) => {
            Picture::new(size, 1, Samples::Floats(floats), false).map(Some)
        }
        _ => Ok(None),
    }
}

const END_OF_JPEG: [u8; 2] = [0xff, 0xd9];

fn samples(image: DynamicImage) -> (usize, Samples) {
    match image {
        DynamicImage::ImageLuma8(image) => (1, Samples::Bytes(image.into_raw())),
        DynamicImage::ImageLumaA8(image) => (2, Samples::Bytes(image.into_raw())),
        DynamicImage::ImageRgb8(image) => (3, Samples::Bytes(image.into_raw())),
        DynamicImage::ImageRgba8(image) => (4, Samples::Bytes(image.into_raw())),
        DynamicImage::ImageLuma16(image) => (1, Samples::Words(image.into_raw())),
        DynamicImage::ImageLumaA16(image) => (2, Samples::Words(image.into_raw())),
        DynamicImage::ImageRgb16(image) => (3, Samples::Words(image.into_raw())),
        DynamicImage::ImageRgba16(image) => (4, Samples::Words(image.into_raw())),
        DynamicImage::ImageRgb32F(image) => (3, Samples::Floats(image.into_raw())),
        image => (4, Samples::Floats(image.into_rgba32f().into_raw())),
    }
}

#[cfg(test)]
mod tests {
    use image::{GrayImage, Rgb, Rgb32FImage, RgbImage, RgbaImage};

    use super::*;
    use crate::{
        compare::CompareOptions,
        tracer::{
            random::{Rng, cases},
            srgb::to_linear,
        },
    };

    const WIDTH: u32 = 7;

    fn decode(file: &[u8]) -> Result<Picture, Error> {
        Picture::from_bytes(file, &PictureOptions::new())
    }

    fn colors() -> RgbImage {
        RgbImage::from_fn(WIDTH, 5, |x, y| {
            Rgb([x * 40, y * 60, (x + y) * 20].map(|part| part as u8))
        })
    }

    fn light() -> Rgb32FImage {
        let colors = colors();
        Rgb32FImage::from_fn(WIDTH, 5, |x, y| {
            let bytes = colors.get_pixel(x, y).0;
            Rgb(bytes.map(|byte| to_linear(f64::from(byte) / 255.0) as f32))
        })
    }

    fn file(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        image.into().write_to(&mut file, format).unwrap();
        file.into_inner()
    }

    /// Returns the same pixels in every lossless format and every depth.
    fn files() -> Vec<Vec<u8>> {
        use ImageFormat::{Bmp, Hdr, OpenExr, Png, Pnm, Qoi, Tiff, WebP};
        let plain = || DynamicImage::from(colors());
        let mut files: Vec<_> = [Png, Bmp, Tiff, Pnm, Qoi, WebP]
            .map(|format| file(plain(), format))
            .into();
        files.extend([Png, Tiff, Pnm].map(|format| file(plain().to_rgb16(), format)));
        files.extend([Png, Tiff, Qoi, WebP].map(|format| file(plain().to_rgba8(), format)));
        files.extend([Hdr, OpenExr, Tiff].map(|format| file(light(), format)));
        let mut pfm = b"PF\n7 5\n-1.0\n".to_vec();
        for row in light().rows().rev() {
            pfm.extend(row.flat_map(|pixel| pixel.0).flat_map(f32::to_le_bytes));
        }
        files.push(pfm);
        files
    }

    #[test]
    fn every_format_is_read() {
        let expected = decode(&file(colors(), ImageFormat::Png)).unwrap();
        for file in files() {
            let picture = decode(&file).unwrap();
            let found = expected.compare(&picture, &CompareOptions::new()).unwrap();
            // HDR has 8 bits per color, of linear light: less precise than PNG.
            let allowed = if file.starts_with(b"#?") { 3.0 } else { 0.0 };
            let found = found.unwrap();
            assert!(found.max_delta <= allowed, "{:?}: {found:?}", &file[..4]);
        }
        let jpeg = decode(&file(colors(), ImageFormat::Jpeg)).unwrap();
        let found = expected.compare(&jpeg, &CompareOptions::new()).unwrap();
        assert!(found.unwrap().mean_delta < 20.0);
    }

    #[test]
    fn reading_and_conversion_end_once_cancelled() {
        use ImageFormat::{Hdr, OpenExr, Png};
        let cancel = Cancel::new();
        cancel.cancel();
        let mut files = vec![file(colors(), Png), b"Pf\n1 1\n-1.0\n1234".to_vec()];
        files.extend([Hdr, OpenExr].map(|format| file(light(), format)));
        for file in files {
            let read = |cancel| Picture::until_cancelled(&file, &PictureOptions::new(), cancel);
            let error = read(Some(&cancel)).unwrap_err();
            assert!(error.to_string().contains("interrupted"), "{error}");
            let picture = read(None).unwrap();
            assert!(picture.clone().into_light(None).is_ok());
            let error = picture.into_light(Some(&cancel)).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Interrupted);
        }
    }

    #[test]
    fn gray_floats_of_tiff_are_read() {
        let mut file = Cursor::new(Vec::new());
        let mut tiff = tiff::encoder::TiffEncoder::new(&mut file).unwrap();
        let depths = [0.5_f32, 2.0, f32::INFINITY, 1e9, 0.0, 3.25];
        tiff.write_image::<tiff::encoder::colortype::Gray32Float>(3, 2, &depths)
            .unwrap();
        let picture = decode(file.get_ref()).unwrap();
        assert_eq!((picture.channels, picture.size().width()), (1, 3));
        assert!(matches!(&picture.samples, Samples::Floats(floats) if **floats == depths));
    }

    #[test]
    fn gray_and_alpha_are_read() {
        let gray = file(GrayImage::new(3, 2), ImageFormat::Png);
        assert_eq!(decode(&gray).unwrap().channels, 1);
        let alpha = file(RgbaImage::new(3, 2), ImageFormat::Png);
        assert!(decode(&alpha).unwrap().has_alpha());
        let exr = DynamicImage::from(RgbaImage::new(3, 2)).to_rgba32f();
        let exr = decode(&file(exr, ImageFormat::OpenExr)).unwrap();
        assert!(exr.has_alpha() && exr.premultiplied);
    }

    #[test]
    fn truncated_files_are_rejected() {
        let mut files = files();
        files.push(file(colors(), ImageFormat::Jpeg));
        for file in files {
            for length in [0, 2, 9, file.len() / 2] {
                let error = decode(&file[..length]).unwrap_err();
                assert_eq!(error.kind(), ErrorKind::Unreadable);
                assert_eq!(error.to_string().lines().count(), 1, "{error}");
            }
        }
    }

    #[test]
    fn broken_files_are_either_rejected_or_read() {
        let mut rng = Rng(5);
        let mut files = files();
        files.push(file(colors(), ImageFormat::Jpeg));
        for _ in 0..cases(500) {
            let mut file = files[rng.below(files.len())].clone();
            // A side of a million pixels is allowed but takes long.
            let at = rng.below(file.len());
            file[at] ^= 1 << rng.below(5);
            if let Ok(picture) = decode(&file) {
                assert!(picture.size().pixels() > 0);
            }
        }
    }

    #[test]
    fn other_files_are_reported() {
        for file in [&b""[..], b"(camera: ())", b"GIF89a12345678901234567890"] {
            let error = decode(file).unwrap_err();
            assert!(
                error.to_string().contains("supported format: PNG"),
                "{error}"
            );
        }
    }
}
