//! The curve of sRGB, IEC 61966-2-1: between linear light and display values, both in 0..1.

/// Linear light of a display value: `c/12.92` for `c <= 0.04045`, else `((c+0.055)/1.055)^2.4`.
pub(crate) fn to_linear(display: f64) -> f64 {
    if display <= 0.04045 {
        display / 12.92
    } else {
        libm::pow((display + 0.055) / 1.055, 2.4)
    }
}

/// The display value of linear light: `12.92·l` for `l <= 0.0031308`, else
/// `1.055·l^(1/2.4) - 0.055`.
pub(crate) fn to_display(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_curve_is_the_other_backwards() {
        for byte in 0..=255 {
            let display = f64::from(byte) / 255.0;
            let back = to_display(to_linear(display));
            assert!((back - display).abs() < 1e-7, "{byte}: {back}");
        }
        // The middle gray that a print of 18 % has.
        assert!((to_display(0.18) * 255.0 - 117.65).abs() < 0.01);
    }
}
