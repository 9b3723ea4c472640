//! Portable float maps: a line each for the kind, the size and the scale, then rows of f32 from the
//! bottom. A negative scale means little-endian.

use std::str;

use crate::{
    compare::{
        limit::{PictureOptions, broken},
        picture::{Picture, Samples},
    },
    diagnostic::error::Error,
    image_file::check_memory,
    parallel::Cancel,
};

pub(super) fn is_pfm(file: &[u8]) -> bool {
    matches!(file, [b'P', b'F' | b'f', space, ..] if space.is_ascii_whitespace())
}

pub(super) fn decode(
    file: &[u8],
    options: &PictureOptions,
    cancel: Option<&Cancel>,
) -> Result<Picture, Error> {
    let broken = |why: &str| broken("pfm", why);
    let mut rest = file;
    let mut word = || {
        let word = word(&mut rest).ok_or_else(|| broken("the header ends too soon"))?;
        Ok::<_, Error>(word)
    };
    let channels = if word()? == "PF" { 3 } else { 1 };
    let mut side = || {
        let side = word()?;
        side.parse().map_err(|_| broken("a side is not a number"))
    };
    let (width, height) = (side()?, side()?);
    let size = options.size(width, height)?;
    let scale: f32 = word()?.parse().unwrap_or(0.0);
    if !scale.is_finite() || scale == 0.0 {
        return Err(broken("the scale is not a number other than 0"));
    }
    let bytes = size.pixels() * channels * 4;
    if rest.len() as u64 != bytes {
        let found = rest.len();
        let message = format!("expected {bytes} bytes of pixels, found {found}");
        return Err(broken(&message));
    }
    check_memory(size, bytes)?;
    let number = |bytes: &[u8]| {
        let bytes = bytes.try_into().unwrap_or_default();
        let number = if scale < 0.0 {
            f32::from_le_bytes(bytes)
        } else {
            f32::from_be_bytes(bytes)
        };
        number * scale.abs()
    };
    let rows = rest
        .chunks_exact(width as usize * channels as usize * 4)
        .rev();
    let mut samples = Vec::with_capacity(rest.len() / 4);
    for row in rows {
        cancel.map_or(Ok(()), Cancel::check)?;
        samples.extend(row.chunks_exact(4).map(number));
    }
    Picture::new(size, channels as usize, Samples::Floats(samples), false)
}

/// Returns the next word of the header, which ends at a single whitespace character.
fn word<'a>(rest: &mut &'a [u8]) -> Option<&'a str> {
    let end = rest.iter().position(u8::is_ascii_whitespace)?;
    let (word, after) = rest.split_at(end);
    *rest = &after[1..];
    str::from_utf8(word).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floats(file: &[u8]) -> (usize, Vec<f32>) {
        let picture = decode(file, &PictureOptions::new(), None).unwrap();
        match picture.samples {
            Samples::Floats(floats) => (picture.channels, floats),
            _ => panic!("not floats"),
        }
    }

    #[test]
    fn rows_come_from_the_bottom_in_either_order_of_bytes() {
        let mut little = b"Pf\n2 2\n-1.0\n".to_vec();
        let mut big = b"Pf 2 2 2\n".to_vec();
        for number in [1.0_f32, 2.0, -3.0, 0.5] {
            little.extend(number.to_le_bytes());
            big.extend((number / 2.0).to_be_bytes());
        }
        assert_eq!(floats(&little), (1, vec![-3.0, 0.5, 1.0, 2.0]));
        assert_eq!(floats(&big), floats(&little));
        let mut color = b"PF\n1 1\n-1\n".to_vec();
        color.extend([0; 12]);
        assert_eq!(floats(&color), (3, vec![0.0; 3]));
    }

    #[test]
    fn broken_files_are_rejected() {
        for (file, what) in [
            (&b"PF\n1 1"[..], "ends too soon"),
            (b"PF\nx 1\n-1\n", "not a number"),
            (b"PF\n0 1\n-1\n", "0x1"),
            (b"PF\n1 1\n0\n", "scale"),
            (b"PF\n1 1\nnan\n", "scale"),
            (b"PF\n1 1\n-1\n12345678901", "found 11"),
            (b"PF\n900000 9000\n-1\n", "--max-pixels"),
            (b"PF\n9000 900\n-1\n", "found 0"),
        ] {
            let error = decode(file, &PictureOptions::new(), None)
                .unwrap_err()
                .to_string();
            assert!(error.contains(what), "{error}");
        }
    }
}
