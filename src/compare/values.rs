//! The common form in which two pictures are compared.

use std::convert::identity;

use crate::{
    compare::{
        picture::{Picture, Samples},
        plane::{Plane, Region},
    },
    tracer::srgb::{to_display, to_linear},
};

/// The value of white. A step of a channel is one of an 8-bit file, so that differences of such
/// files are whole.
pub(super) const WHITE: f64 = 255.0;

/// The red, green, blue and alpha planes of a region.
pub(super) type Channels = [Plane; 4];

/// The common form of two pictures: display values for two files of integers, linear light for two
/// of floats. If only one has floats, they become the values of a file with the other's integer
/// type.
pub(super) struct Form {
    pub(super) is_linear: bool,
    pub(super) has_alpha: bool,
    /// True if values may lie outside 0 to [`WHITE`].
    has_floats: bool,
    /// True if colors are multiplied by alpha.
    premultiplied: bool,
    /// The largest integer, if floats become integers.
    rounded_to: Option<f64>,
    /// Linear light by display value, in equal steps over 0..1.
    linear: Vec<f64>,
}

impl Form {
    pub(super) fn new(a: &Picture, b: &Picture) -> Self {
        let most = [&a.samples, &b.samples].map(|samples| match samples {
            Samples::Bytes(_) => Some(255_u16),
            Samples::Words(_) => Some(65_535),
            Samples::Floats(_) => None,
        });
        let is_linear = most == [None, None];
        let entries = most.into_iter().flatten().max();
        let linear = entries.map_or_else(Vec::new, |last| {
            let display = (0..=last).map(|entry| f64::from(entry) / f64::from(last));
            display.map(to_linear).collect()
        });
        let rounded_to = match most {
            [Some(most), None] | [None, Some(most)] => Some(most.into()),
            _ => None,
        };
        Self {
            is_linear,
            has_alpha: a.has_alpha() || b.has_alpha(),
            has_floats: most.contains(&None),
            premultiplied: a.premultiplied && b.premultiplied,
            rounded_to,
            linear,
        }
    }

    /// Returns the number of channels that may differ.
    pub(super) fn channels(&self) -> usize {
        if self.has_alpha { 4 } else { 3 }
    }

    /// Returns the values of both pictures in a region.
    pub(super) fn read(&self, a: &Picture, b: &Picture, region: Region) -> [Channels; 2] {
        [a, b].map(|picture| self.read_one(picture, region))
    }

    fn read_one(&self, picture: &Picture, region: Region) -> Channels {
        let mut planes = [(); 4].map(|()| Plane::new(region));
        for y in region.top..region.bottom {
            let samples = row(picture, region, y);
            let mut rows = planes.each_mut().map(|plane| plane.row_mut(y));
            match &picture.samples {
                Samples::Bytes(all) => {
                    let of = |byte: u8| f64::from(byte);
                    fill(&mut rows, picture.channels, &all[samples], of, identity);
                }
                Samples::Words(all) => {
                    let of = |word: u16| part(f64::from(word), 65_535.0);
                    fill(&mut rows, picture.channels, &all[samples], of, identity);
                }
                Samples::Floats(all) => {
                    let of = |float: f32| f64::from(float) * WHITE;
                    fill(&mut rows, picture.channels, &all[samples], of, |pixel| {
                        self.float(picture, pixel)
                    });
                }
            }
        }
        planes
    }

    /// Converts a pixel of floats to the common form.
    fn float(&self, picture: &Picture, mut pixel: [f64; 4]) -> [f64; 4] {
        let alpha = pixel[3] / WHITE;
        if picture.premultiplied && !self.premultiplied && alpha > 0.0 {
            pixel[..3].iter_mut().for_each(|color| *color /= alpha);
        }
        let Some(most) = self.rounded_to else {
            return pixel;
        };
        let round = |value: f64| part((value * most + 0.5).floor(), most);
        // Not f64::max, which would replace NaN with a number.
        let [r, g, b, a] = pixel.map(|value| (value / WHITE).clamp(0.0, 1.0));
        let [r, g, b] = [r, g, b].map(|linear| round(to_display(linear)));
        [r, g, b, round(a)]
    }

    /// Returns red, green and blue of a pixel as linear light in 0..1, over a gray background.
    pub(super) fn linear(&self, [colors @ .., alpha]: [f64; 4], background: f64) -> [f64; 3] {
        let alpha = alpha / WHITE;
        let covers = if self.premultiplied { 1.0 } else { alpha };
        colors.map(|color| {
            let light = if self.is_linear {
                color / WHITE
            } else {
                let last = self.linear.len() - 1;
                self.linear[(color * (last as f64 / WHITE) + 0.5) as usize]
            };
            light * covers + background * (1.0 - alpha)
        })
    }

    /// Returns the display value of a color value, from 0 to [`WHITE`].
    pub(super) fn display(&self, color: f64) -> f64 {
        if self.is_linear {
            to_display(color / WHITE) * WHITE
        } else {
            color
        }
    }

    /// Limits all values to 0 to [`WHITE`], for metrics that support no others. A NaN in only one
    /// picture becomes a value far from the other picture's, so that it is noticed.
    pub(super) fn limit(&self, [a, b]: &mut [Channels; 2]) {
        if !self.has_floats {
            return;
        }
        for (a, b) in a.iter_mut().zip(b) {
            for (a, b) in a.values_mut().iter_mut().zip(b.values_mut()) {
                (*a, *b) = limited(*a, *b);
            }
        }
    }
}

/// Maps an integer from 0 to `most` to the scale from 0 to [`WHITE`]. A single operation rounds, so
/// that equal integers give equal numbers wherever they come from.
fn part(integer: f64, most: f64) -> f64 {
    integer / (most / WHITE)
}

fn limited(a: f64, b: f64) -> (f64, f64) {
    let far = |other: f64| if other < WHITE / 2.0 { WHITE } else { 0.0 };
    let (a, b) = match (a.is_nan(), b.is_nan()) {
        (true, true) => (0.0, 0.0),
        (true, false) => (far(b), b),
        (false, true) => (a, far(a)),
        (false, false) => (a, b),
    };
    (a.clamp(0.0, WHITE), b.clamp(0.0, WHITE))
}

/// Returns the range of the samples in a row of a region.
fn row(picture: &Picture, region: Region, y: usize) -> std::ops::Range<usize> {
    let start = y * picture.size().width() as usize;
    (start + region.left) * picture.channels..(start + region.right) * picture.channels
}

fn fill<T: Copy>(
    rows: &mut [&mut [f64]; 4],
    channels: usize,
    samples: &[T],
    of: impl Fn(T) -> f64,
    pixel: impl Fn([f64; 4]) -> [f64; 4],
) {
    for (at, samples) in samples.chunks_exact(channels).enumerate() {
        let values = match *samples {
            [gray] => [of(gray), of(gray), of(gray), WHITE],
            [gray, alpha] => [of(gray), of(gray), of(gray), of(alpha)],
            [r, g, b] => [of(r), of(g), of(b), WHITE],
            [r, g, b, alpha, ..] => [of(r), of(g), of(b), of(alpha)],
            [] => return,
        };
        for (row, value) in rows.iter_mut().zip(pixel(values)) {
            row[at] = value;
        }
    }
}

/// Returns true if two pictures have the same bits in a region. If not, their values may still be
/// equal.
pub(super) fn same_bits(a: &Picture, b: &Picture, region: Region) -> bool {
    if a.channels != b.channels || a.premultiplied != b.premultiplied {
        return false;
    }
    (region.top..region.bottom).all(|y| {
        let row = row(a, region, y);
        match (&a.samples, &b.samples) {
            (Samples::Bytes(a), Samples::Bytes(b)) => a[row.clone()] == b[row],
            (Samples::Words(a), Samples::Words(b)) => a[row.clone()] == b[row],
            (Samples::Floats(a), Samples::Floats(b)) => {
                let bits = |floats: &[f32]| floats.iter().map(|float| float.to_bits()).collect();
                let (a, b): (Vec<u32>, Vec<u32>) = (bits(&a[row.clone()]), bits(&b[row]));
                a == b
            }
            _ => false,
        }
    })
}

/// Returns the difference of two values: infinite if only one is finite, 0 if both are NaN.
pub(super) fn delta(a: f64, b: f64) -> f64 {
    if a == b || a.is_nan() && b.is_nan() {
        return 0.0;
    }
    let delta = (a - b).abs();
    if delta.is_nan() { f64::INFINITY } else { delta }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::size::Size;

    const ONE: Region = Region {
        left: 0,
        top: 0,
        right: 1,
        bottom: 1,
    };

    fn pixel(channels: usize, samples: Samples, premultiplied: bool) -> Picture {
        Picture::new(Size::new(1, 1).unwrap(), channels, samples, premultiplied).unwrap()
    }

    fn first(channels: Channels) -> [f64; 4] {
        channels.map(|plane| plane.row(0)[0])
    }

    fn values(a: &Picture, b: &Picture) -> [[f64; 4]; 2] {
        let form = Form::new(a, b);
        form.read(a, b, ONE).map(first)
    }

    #[test]
    fn integers_are_steps_of_eight_bits() {
        let bytes = pixel(3, Samples::Bytes(vec![0, 100, 255]), false);
        let words = pixel(3, Samples::Words(vec![0, 100 * 257, 65_535]), false);
        let gray = pixel(2, Samples::Words(vec![257 + 1, 7 * 257]), false);
        assert_eq!(values(&bytes, &words), [[0.0, 100.0, 255.0, 255.0]; 2]);
        let step = 258.0 / 257.0;
        assert_eq!(values(&gray, &bytes)[0], [step, step, step, 7.0]);
        assert!(Form::new(&gray, &bytes).has_alpha && !Form::new(&words, &bytes).has_alpha);
    }

    #[test]
    fn floats_are_compared_with_integers_as_integers() {
        // A byte written as linear light is read back as the same byte.
        for byte in 0..=255_u8 {
            let linear = to_linear(f64::from(byte) / 255.0) as f32;
            let bytes = pixel(3, Samples::Bytes(vec![byte; 3]), false);
            let floats = pixel(3, Samples::Floats(vec![linear; 3]), false);
            let [a, b] = values(&bytes, &floats);
            assert_eq!(a, b);
        }
        let bytes = pixel(4, Samples::Bytes(vec![188, 0, 255, 128]), false);
        let half = 128.0 / 255.0;
        let floats = Samples::Floats(vec![0.5 * half, -1.0, 7.0, half]);
        let [a, b] = values(&bytes, &pixel(4, floats, true));
        assert_eq!(a, b, "divided by alpha, within 0..1, as display values");
    }

    #[test]
    fn floats_are_compared_with_floats_as_floats() {
        let floats = vec![0.25, -1.0, f32::INFINITY, 0.5];
        let one = pixel(4, Samples::Floats(floats.clone()), true);
        let other = pixel(4, Samples::Floats(floats), false);
        let stored = [63.75, -255.0, f64::INFINITY, 127.5];
        assert_eq!(values(&one, &one), [stored; 2]);
        let [straight, stored_straight] = values(&one, &other);
        assert_eq!(stored_straight, stored);
        assert_eq!(straight, [127.5, -510.0, f64::INFINITY, 127.5]);
    }

    #[test]
    fn nan_does_not_hide_differences() {
        assert_eq!(delta(f64::NAN, f64::NAN), 0.0);
        assert_eq!(delta(f64::INFINITY, f64::INFINITY), 0.0);
        assert_eq!(delta(f64::NAN, 0.0), f64::INFINITY);
        assert_eq!(delta(f64::INFINITY, f64::NEG_INFINITY), f64::INFINITY);
        assert_eq!(delta(3.0, 5.5), 2.5);

        let bright = pixel(3, Samples::Floats(vec![0.0, 0.9, f32::NAN]), false);
        let broken = pixel(
            3,
            Samples::Floats(vec![f32::NAN, f32::NAN, f32::NAN]),
            false,
        );
        let form = Form::new(&bright, &broken);
        let mut both = form.read(&bright, &broken, ONE);
        form.limit(&mut both);
        let bright = f64::from(0.9_f32) * 255.0;
        let expected = [[0.0, bright, 0.0, 255.0], [255.0, 0.0, 0.0, 255.0]];
        assert_eq!(both.map(first), expected);
    }

    #[test]
    fn equal_values_may_have_different_bits() {
        let zero = pixel(3, Samples::Floats(vec![0.0; 3]), false);
        let minus = pixel(3, Samples::Floats(vec![-0.0; 3]), false);
        assert!(same_bits(&zero, &zero, ONE) && !same_bits(&zero, &minus, ONE));
        assert_eq!(values(&zero, &minus)[0], values(&zero, &minus)[1]);
    }
}
