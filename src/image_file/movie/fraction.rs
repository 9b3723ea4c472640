//! Approximation of a number by a fraction of integers.

/// Returns the simplest fraction within a relative error of 1e-12, or the nearest one whose parts
/// do not exceed `most`. By continued fractions: each step is the best fraction with parts that
/// small.
pub(super) fn fraction(value: f64, most: u32) -> (u32, u32) {
    let (mut one, mut two) = ((0_u64, 1_u64), (1_u64, 0_u64));
    let mut rest = value;
    loop {
        let whole = rest.floor();
        if whole > f64::from(most) {
            break;
        }
        let next = (
            two.0.saturating_mul(whole as u64).saturating_add(one.0),
            two.1.saturating_mul(whole as u64).saturating_add(one.1),
        );
        if next.0.max(next.1) > most.into() {
            break;
        }
        (one, two) = (two, next);
        let error = (two.0 as f64 / two.1 as f64 - value).abs();
        if error <= value * 1e-12 || rest - whole <= 0.0 {
            break;
        }
        rest = 1.0 / (rest - whole);
    }
    match two {
        // Beyond the range of the parts.
        (1, 0) => (most, 1),
        (0, _) => (1, most),
        (above, below) => (above as u32, below as u32),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_match_their_names() {
        for (value, expected) in [
            (24.0, (24, 1)),
            (29.97, (2997, 100)),
            (30_000.0 / 1001.0, (30_000, 1001)),
            (0.5, (1, 2)),
            (12.5, (25, 2)),
            (1e-9, (1, 65_535)),
            (1e9, (65_535, 1)),
        ] {
            assert_eq!(fraction(value, 65_535), expected, "{value}");
        }
        let (above, below) = fraction(std::f64::consts::PI, 65_535);
        assert!((f64::from(above) / f64::from(below) - std::f64::consts::PI).abs() < 3e-7);
    }
}
