//! Conversion of linear light to the color spaces of FLIP.

/// The matrix from linear light of sRGB primaries to X, Y and Z of CIE 1931.
const XYZ: [[f64; 3]; 3] = [
    [
        10_135_552.0 / 24_577_794.0,
        8_788_810.0 / 24_577_794.0,
        4_435_075.0 / 24_577_794.0,
    ],
    [
        2_613_072.0 / 12_288_897.0,
        8_788_810.0 / 12_288_897.0,
        887_015.0 / 12_288_897.0,
    ],
    [
        1_425_312.0 / 73_733_382.0,
        8_788_810.0 / 73_733_382.0,
        70_074_185.0 / 73_733_382.0,
    ],
];

/// The inverse of [`XYZ`].
const RGB: [[f64; 3]; 3] = [
    [3.2410032329763583, -1.537398969488785, -0.4986158819963628],
    [-0.9692242522025163, 1.8759299836951757, 0.04155422634008469],
    [
        0.05563941985197541,
        -0.20401120612390994,
        1.0571489771875333,
    ],
];

fn times(matrix: &[[f64; 3]; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    matrix.map(|[a, b, c]| a * x + b * y + c * z)
}

/// Returns X, Y and Z relative to white.
fn relative_xyz(rgb: [f64; 3]) -> [f64; 3] {
    let (xyz, white) = (times(&XYZ, rgb), times(&XYZ, [1.0; 3]));
    std::array::from_fn(|at| xyz[at] / white[at])
}

/// Converts to Y, Cx and Cz, a linear space of opponent colors: brightness, red-green, blue-yellow.
pub(in crate::compare) fn to_opponents(rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Inverts [`to_opponents`], limited to 0..1.
pub(super) fn from_opponents([y, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    let white = times(&XYZ, [1.0; 3]);
    let rgb = times(&RGB, std::array::from_fn(|at| relative[at] * white[at]));
    rgb.map(|part| part.clamp(0.0, 1.0))
}

/// A color in L*, a* and b* of CIELAB, with a* and b* reduced for dark colors: the Hunt effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lab([f64; 3]);

impl Lab {
    pub(super) fn of(rgb: [f64; 3]) -> Self {
        const DELTA: f64 = 6.0 / 29.0;
        let [x, y, z] = relative_xyz(rgb).map(|part| {
            if part > DELTA * DELTA * DELTA {
                libm::cbrt(part)
            } else {
                part / (3.0 * DELTA * DELTA) + 4.0 / 29.0
            }
        });
        let l = 116.0 * y - 16.0;
        let hunt = 0.01 * l;
        Self([l, hunt * (500.0 * (x - y)), hunt * (200.0 * (y - z))])
    }

    /// Returns the HyAB distance, which suits large differences: that in L* plus that in a* and b*.
    pub(super) fn distance(self, other: Self) -> f64 {
        let [l, a, b] = std::array::from_fn(|at| self.0[at] - other.0[at]);
        l.abs() + libm::sqrt(a * a + b * b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_conversion_round_trips() {
        for rgb in [[0.0; 3], [1.0; 3], [0.25, 0.5, 0.125], [1.0, 0.0, 0.0]] {
            let back = from_opponents(to_opponents(rgb));
            let far = rgb.iter().zip(back).map(|(a, b)| (a - b).abs());
            assert!(far.fold(0.0, f64::max) < 1e-12, "{rgb:?} {back:?}");
        }
        assert_eq!(to_opponents([1.0; 3]), [100.0, 0.0, 0.0]);
    }

    #[test]
    fn white_and_black_are_a_hundred_apart() {
        assert!((Lab::of([1.0; 3]).distance(Lab::of([0.0; 3])) - 100.0).abs() < 1e-12);
    }
}
