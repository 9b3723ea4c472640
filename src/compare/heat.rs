//! The colors of a heat picture.

/// The minimum heat of a pixel that differs, however little: dark violet must be distinguishable
/// from black.
const FAINT: f64 = 0.25;

/// Every fifteenth color of magma, the color map by Nathaniel Smith and Stéfan van der Walt (CC0):
/// brighter means more.
const MAGMA: [[u8; 3]; 18] = [
    [0, 0, 4],
    [9, 7, 32],
    [26, 16, 66],
    [49, 17, 101],
    [74, 16, 121],
    [98, 25, 128],
    [121, 34, 130],
    [145, 43, 129],
    [170, 51, 125],
    [194, 59, 117],
    [217, 70, 107],
    [236, 88, 96],
    [247, 114, 92],
    [252, 142, 100],
    [254, 170, 116],
    [254, 198, 138],
    [253, 226, 163],
    [252, 253, 191],
];

/// Returns the color of an error in 0..1.
pub(super) fn color(error: f64, differs: bool) -> [u8; 3] {
    let error = if differs { error.max(FAINT) } else { error };
    let place = error.clamp(0.0, 1.0) * (MAGMA.len() - 1) as f64;
    let below = (place as usize).min(MAGMA.len() - 2);
    let part = place - below as f64;
    std::array::from_fn(|channel| {
        let [from, to] = [below, below + 1].map(|at| f64::from(MAGMA[at][channel]));
        (from + (to - from) * part + 0.5) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_goes_from_black_to_bright() {
        assert_eq!(color(0.0, false), MAGMA[0]);
        assert_eq!(color(1.0, true), MAGMA[17]);
        assert_eq!(color(2.5 / 17.0, false), [38, 17, 84]);
        assert_eq!(color(0.0, true), color(0.25, false));
        assert_eq!(color(0.5, true), color(0.5, false));
    }
}
