//! Named values of a picture other than its colors: channels of EXR, arrays of NPY and NPZ.

use serde::Serialize;

use crate::{
    compare::{picture::Samples, values::delta},
    data::table::layout::{Endian, Scalar},
    film::size::Size,
};

/// Returns the number of a type in these bytes, in little-endian order.
fn number(kind: Scalar, bytes: &[u8]) -> Number {
    let eight = || bytes.try_into().unwrap_or_default();
    let float = kind.number(bytes, Endian::Little).unwrap_or_default();
    match kind {
        Scalar::F16 | Scalar::F32 | Scalar::F64 => Number::Float(float),
        // Not all of these are f64.
        Scalar::I64 => Number::Whole(i64::from_le_bytes(eight()).into()),
        Scalar::U64 => Number::Whole(u64::from_le_bytes(eight()).into()),
        _ => Number::Whole(float as i128),
    }
}

enum Number {
    Whole(i128),
    Float(f64),
}

impl Number {
    fn delta(&self, other: &Self) -> f64 {
        let float = |number: &Self| match *number {
            Self::Whole(whole) => whole as f64,
            Self::Float(float) => float,
        };
        match (self, other) {
            (Self::Whole(one), Self::Whole(other)) => (one - other).unsigned_abs() as f64,
            _ => delta(float(self), float(other)),
        }
    }
}

/// One or more numbers for each pixel.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    pub(super) name: String,
    pub(super) size: Size,
    /// Number of values per pixel.
    pub(super) count: usize,
    pub(super) kind: Scalar,
    /// The values, pixel by pixel from the top left, in little-endian order.
    pub(super) bytes: Vec<u8>,
}

impl Layer {
    /// Returns the numbers as display values, if they are 8- or 16-bit integers in gray, RGB or
    /// RGBA.
    pub(super) fn as_colors(&self) -> Option<(usize, Samples)> {
        let samples = match (self.count, self.kind) {
            (1 | 3 | 4, Scalar::U8) => Samples::Bytes(self.bytes.clone()),
            (1 | 3 | 4, Scalar::U16) => {
                let (words, _) = self.bytes.as_chunks();
                Samples::Words(words.iter().map(|word| u16::from_le_bytes(*word)).collect())
            }
            _ => return None,
        };
        Some((self.count, samples))
    }
}

/// The differences between a layer of two pictures.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LayerComparison {
    /// The name of the channel or array. In an EXR file with several parts, the name of the part
    /// precedes it.
    pub name: String,
    /// True if both pictures have the layer, with the same size and number of values per pixel. If
    /// false, nothing else is compared.
    pub in_both: bool,
    /// Number of pixels that differ.
    pub different: u64,
    /// The largest difference of a value, in the unit of the layer; infinite if a difference is not
    /// finite.
    pub max_delta: f64,
}

impl LayerComparison {
    /// Returns true if both pictures have the layer and no pixel differs.
    pub fn is_equal(&self) -> bool {
        self.in_both && self.different == 0
    }

    /// Returns the result for a layer that one of the two pictures does not have.
    pub(super) fn missing(name: &str) -> Self {
        Self::of(name, None)
    }

    fn of(name: &str, pair: Option<(&Layer, &Layer)>) -> Self {
        let pair = pair.filter(|(a, b)| (a.size, a.count) == (b.size, b.count));
        let (different, max_delta) = pair.map_or((0, 0.0), |(a, b)| differences(a, b));
        Self {
            name: name.to_owned(),
            in_both: pair.is_some(),
            different,
            max_delta,
        }
    }
}

fn differences(a: &Layer, b: &Layer) -> (u64, f64) {
    let (mut different, mut most) = (0, 0.0);
    if (a.kind, &a.bytes) == (b.kind, &b.bytes) {
        return (different, most);
    }
    let pixels = |layer: &Layer| layer.count * layer.kind.size();
    let all = a.bytes.chunks_exact(pixels(a));
    for (one, other) in all.zip(b.bytes.chunks_exact(pixels(b))) {
        let numbers = one.chunks_exact(a.kind.size());
        let deltas = numbers
            .zip(other.chunks_exact(b.kind.size()))
            .map(|(one, other)| number(a.kind, one).delta(&number(b.kind, other)));
        let largest = deltas.fold(0.0, f64::max);
        different += u64::from(largest > 0.0);
        most = f64::max(most, largest);
    }
    (different, most)
}

/// Compares the layers with the same names.
pub(super) fn compare(a: &[Layer], b: &[Layer]) -> Vec<LayerComparison> {
    let find = |layers: &'_ [Layer], name: &str| layers.iter().position(|layer| layer.name == name);
    let ours = a.iter().map(|layer| {
        let other = find(b, &layer.name).map(|at| (layer, &b[at]));
        LayerComparison::of(&layer.name, other)
    });
    let theirs = b.iter().filter(|layer| find(a, &layer.name).is_none());
    let theirs = theirs.map(|layer| LayerComparison::missing(&layer.name));
    ours.chain(theirs).collect()
}
