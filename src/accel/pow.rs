//! Powers of eight numbers at once: [`libm::pow`], bit for bit.
//!
//! These are the operations of libm 0.2, which follows `e_pow.c` of FreeBSD's msun (Sun Microsystems, 1993, 2004),
//! in the same order, with choices in place of branches: the logarithm to base 2 in two parts, its product with the
//! exponent, and the power of 2. Numbers that need another way there take the function itself.

use crate::simd::LANES;

/// Exponents between these are computed here.
const LEAST: f64 = 1e-9;
const MOST: f64 = 2_147_483_648.0;

/// Returns `x^y` for each lane.
#[inline(always)]
pub(crate) fn pow(x: &[f64; LANES], y: &[f64; LANES]) -> [f64; LANES] {
    let mut powers = [0.0; LANES];
    let mut is_odd = [0_u64; LANES];
    for lane in 0..LANES {
        (powers[lane], is_odd[lane]) = usual(x[lane], y[lane]);
    }
    for lane in 0..LANES {
        if is_odd[lane] != 0 {
            powers[lane] = libm::pow(x[lane], y[lane]);
        }
    }
    powers
}

/// Returns the upper half of a number, as if the lower half of its bits were 0.
#[inline(always)]
fn upper(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & !0xffff_ffff)
}

#[inline(always)]
const fn choose(is_one: bool, one: f64, other: f64) -> f64 {
    if is_one { one } else { other }
}

/// Returns a power, and 1 if it has to be computed in another way.
#[inline(always)]
fn usual(x: f64, y: f64) -> (f64, u64) {
    let is_none = x == 0.0;
    let x = choose(is_none, 0.75, x);
    let has_way = (y == 0.5) | (y == 1.0) | (y == 2.0) | (x == 1.0);
    let is_positive = (f64::MIN_POSITIVE..f64::INFINITY).contains(&x);
    let is_usual = is_positive & (LEAST..MOST).contains(&y);
    let is_odd = (has_way & !is_none) | !is_usual;

    // x = 2ⁿ·a, and a is near b, which is 1 or 1.5.
    let bits = x.to_bits();
    let part = (bits >> 32) as u32 & 0xf_ffff;
    let (is_large, is_middle) = (part >= 0xb_b67a, (part > 0x3_988e) & (part < 0xb_b67a));
    let n = (bits >> 52) as i32 - 1023 + i32::from(is_large);
    let exponent = choose(is_large, 0.5, 1.0).to_bits() >> 52;
    let a = f64::from_bits(bits & 0xf_ffff_ffff_ffff | exponent << 52);
    let b = choose(is_middle, 1.5, 1.0);

    // s = (a-b)/(a+b), in two parts.
    let (u, v) = (a - b, 1.0 / (a + b));
    let s = u * v;
    let s_upper = upper(s);
    let half = (a.to_bits() >> 33 | 0x2000_0000) + 0x8_0000 + (u64::from(is_middle) << 18);
    let sum_upper = f64::from_bits(half << 32);
    let sum_lower = a - (sum_upper - b);
    let s_lower = v * ((u - s_upper * sum_upper) - s_upper * sum_lower);

    // log2 a - log2 b = 2/(3 ln 2)·(3s + s³·…), in two parts.
    let s2 = s * s;
    let series = L[0] + s2 * (L[1] + s2 * (L[2] + s2 * (L[3] + s2 * (L[4] + s2 * L[5]))));
    let r = s2 * s2 * series + s_lower * (s_upper + s);
    let s2 = s_upper * s_upper;
    let t_upper = upper(3.0 + s2 + r);
    let t_lower = r - ((t_upper - 3.0) - s2);
    let (u, v) = (s_upper * t_upper, s_lower * t_upper + t_lower * s);
    let p_upper = upper(u + v);
    let p_lower = v - (p_upper - u);
    let z_upper = FACTOR_UPPER * p_upper;
    let z_lower = FACTOR_LOWER * p_upper + p_lower * FACTOR + choose(is_middle, LOG_LOWER, 0.0);
    let (n, log) = (f64::from(n), choose(is_middle, LOG_UPPER, 0.0));
    let log_upper = upper(((z_upper + z_lower) + log) + n);
    let log_lower = z_lower - (((log_upper - n) - log) - z_upper);

    // y·log2 x, in two parts, and the nearest whole number.
    let y_upper = upper(y);
    let p_lower = (y - y_upper) * log_upper + y * log_lower;
    let p_upper = y_upper * log_upper;
    let z = p_lower + p_upper;
    let is_zero = z < -1075.0;
    let is_odd = is_odd | !((z < 1023.0) & (is_zero | (z > -1021.0)));
    let size = upper(z).abs();
    let whole = choose(size > 0.5, (size + 0.5).min(1100.0), 0.0) as i32;
    let n = if z < 0.0 { -whole } else { whole };
    let p_upper = p_upper - f64::from(n);

    // The power of 2 of the rest.
    let t = upper(p_lower + p_upper);
    let (u, v) = (t * LN_UPPER, (p_lower - (t - p_upper)) * LN + t * LN_LOWER);
    let z = u + v;
    let w = v - (z - u);
    let t = z * z;
    let t1 = z - t * (P[0] + t * (P[1] + t * (P[2] + t * (P[3] + t * P[4]))));
    let r = (z * t1) / (t1 - 2.0) - (w + z * w);
    let power = 1.0 - (r - z);
    let power = f64::from_bits(power.to_bits().wrapping_add((i64::from(n) << 52) as u64));
    (choose(is_none | is_zero, 0.0, power), u64::from(is_odd))
}

/// The polynomial of 3/2·(ln a - 2s - 2/3·s³).
const L: [f64; 6] = [
    0.599_999_999_999_994_6,
    0.428_571_428_578_550_2,
    0.333_333_329_818_377_43,
    0.272_728_123_808_534,
    0.230_660_745_775_561_75,
    0.206_975_017_800_338_42,
];
/// The polynomial of the power.
const P: [f64; 5] = [
    0.166_666_666_666_666_02,
    -0.002_777_777_777_701_559_3,
    6.613_756_321_437_934e-5,
    -1.653_390_220_546_525_2e-6,
    4.138_136_797_057_238_5e-8,
];
/// log2 1.5.
const LOG_UPPER: f64 = 0.584_962_487_220_764_2;
const LOG_LOWER: f64 = 1.350_039_202_129_749e-8;
/// 2/(3 ln 2).
const FACTOR: f64 = 0.961_796_693_925_975_6;
const FACTOR_UPPER: f64 = 0.961_796_700_954_437_3;
const FACTOR_LOWER: f64 = -7.028_461_650_952_758e-9;
/// ln 2.
const LN: f64 = std::f64::consts::LN_2;
const LN_UPPER: f64 = 0.693_147_182_464_599_6;
const LN_LOWER: f64 = -1.904_654_299_957_768e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::random::{Rng, cases};

    #[test]
    fn powers_are_those_of_the_library() {
        let mut random = Rng(11);
        for case in 0..cases(20_000) {
            let x: [f64; LANES] = std::array::from_fn(|_| match random.below(12) {
                0 => 0.0,
                1 => 1.0,
                2 => random.magnitude(-300.0, 300.0),
                3 => 1.0 - random.magnitude(-16.0, -1.0),
                _ => random.signed().abs(),
            });
            let y: [f64; LANES] = std::array::from_fn(|_| match random.below(6) {
                0 => [0.5, 1.0, 2.0, 3.0, 1e-12, 3e9, 1e-3][random.below(7)],
                1 => random.below(2000) as f64,
                _ => random.magnitude(-1.0, 4.0),
            });
            let found = pow(&x, &y);
            for lane in 0..LANES {
                let (x, y) = (x[lane], y[lane]);
                let expected = libm::pow(x, y);
                assert_eq!(
                    found[lane].to_bits(),
                    expected.to_bits(),
                    "{case}: {x:e}^{y:e}"
                );
            }
        }
    }

    /// At the ends of what is computed here, and where the nearest whole number of the logarithm changes.
    #[test]
    fn powers_at_the_limits_are_those_of_the_library() {
        for exponent in [
            -1080.0, -1075.0, -1074.5, -1022.0, -1021.5, -1021.0, -0.5, -1.5, 0.5, 1022.5, 1023.5,
        ] {
            for x in [0.3, 0.9, 0.999, 1.7, 13.0_f64] {
                let y = exponent / libm::log2(x);
                for step in -300_i64..300 {
                    let y = f64::from_bits(y.to_bits().wrapping_add_signed(step));
                    let found = pow(&[x; LANES], &[y; LANES])[0];
                    assert_eq!(found.to_bits(), libm::pow(x, y).to_bits(), "{x:e}^{y:e}");
                }
            }
        }
    }
}
