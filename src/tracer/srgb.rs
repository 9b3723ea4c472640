//! The sRGB curve (IEC 61966-2-1) between linear light and display values, both in 0..1, and the
//! conversion of display values to integers.

use std::{array, sync::OnceLock};

/// Returns the linear light of a display value: `c/12.92` for `c <= 0.04045`, else
/// `((c+0.055)/1.055)^2.4`.
pub(crate) fn to_linear(display: f64) -> f64 {
    if display <= 0.04045 {
        display / 12.92
    } else {
        libm::pow((display + 0.055) / 1.055, 2.4)
    }
}

/// Returns [`to_linear`] of a display value, but faster for bytes, which most colors consist of.
pub(crate) fn linear_of(display: f64) -> f64 {
    static BYTES: OnceLock<[(f64, f64); 256]> = OnceLock::new();
    let bytes = BYTES.get_or_init(|| {
        array::from_fn(|byte| {
            let display = byte as f64 / 255.0;
            (display, to_linear(display))
        })
    });
    match bytes[quantize(display, u8::MAX.into()) as usize] {
        (same, linear) if same == display => linear,
        _ => to_linear(display),
    }
}

/// Returns the display value of light: `12.92·l` for `l <= 0.0031308`, else `1.055·l^(1/2.4) -
/// 0.055`.
pub(crate) fn to_display(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    }
}

/// Returns the integer in 0..=`most` of a display value: `floor(c · most + 0.5)`, where c is
/// clamped to 0..1 and NaN counts as 0.
///
/// No other code turns colors into integers.
pub(crate) fn quantize(display: f64, most: u32) -> u32 {
    // The cast truncates, which equals floor here, and turns NaN into 0.
    (display.clamp(0.0, 1.0) * f64::from(most) + 0.5) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_curve_inverts_the_other() {
        for byte in 0..=255 {
            let display = f64::from(byte) / 255.0;
            assert_eq!(linear_of(display), to_linear(display));
            let back = to_display(to_linear(display));
            assert!((back - display).abs() < 1e-7, "{byte}: {back}");
        }
        // Middle gray, the 18 % of a print.
        assert!((to_display(0.18) * 255.0 - 117.65).abs() < 0.01);
    }

    #[test]
    fn integers_round_half_up() {
        assert_eq!(
            [-1.0, f64::NAN, 0.499 / 255.0].map(|c| quantize(c, 255)),
            [0; 3]
        );
        assert_eq!(
            [0.5 / 255.0, 0.5, 7.0].map(|c| quantize(c, 255)),
            [1, 128, 255]
        );
        assert_eq!([0.5, 1.0].map(|c| quantize(c, 65_535)), [32_768, 65_535]);
    }
}
