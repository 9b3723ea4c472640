//! Decimal numbers in the common syntax of RON and JSON, parsed to the nearest f64.
//!
//! Nearly every number has at most 19 digits and a decimal exponent from -27 to 0. It is an exact
//! quotient of two 64-bit integers and is rounded once. All other numbers are left to the standard
//! library.

use std::num::NonZeroU64;

/// A number that is valid in both RON and JSON: `-?(0|[1-9]\d*)(\.\d+)?([eE][+-]?\d+)?`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Decimal {
    start: usize,
    /// The end offset.
    pub(crate) end: usize,
    /// True if there is neither a fraction nor an exponent.
    is_integer: bool,
    is_negative: bool,
    /// True if `digits` has not overflowed.
    is_exact: bool,
    /// The digits as an integer.
    digits: u64,
    /// The power of ten by which `digits` is scaled, clamped to a limit far from 0.
    exponent: i32,
}

impl Decimal {
    /// Scans the number at an offset of a text. Returns `None` if it has another form or is
    /// followed by a character that would be part of it.
    #[inline(always)]
    pub(crate) fn scan(text: &str, start: usize) -> Option<Self> {
        let bytes = text.as_bytes();
        let byte = |at: usize| bytes.get(at).copied().unwrap_or(0);
        let is_negative = byte(start) == b'-';
        let first = start + usize::from(is_negative);
        let (mut digits, mut point) = (0_u64, first);
        // Usually one or two digits: too few to read eight at once.
        while let Some(digit @ b'0'..=b'9') = bytes.get(point) {
            digits = digits
                .wrapping_mul(10)
                .wrapping_add(u64::from(digit - b'0'));
            point += 1;
        }
        if point == first || (point > first + 1 && byte(first) == b'0') {
            return None;
        }
        let (mut end, mut exponent) = (point, 0);
        if byte(point) == b'.' {
            end = run_of_digits(bytes, point + 1, &mut digits);
            let fraction = end - point - 1;
            if fraction == 0 {
                return None;
            }
            exponent = -(fraction.min(FAR as usize) as i32);
        }
        if matches!(byte(end), b'e' | b'E') {
            let (power, behind) = power(bytes, end + 1)?;
            exponent += power;
            end = behind;
        }
        if continues_a_number(byte(end)) {
            return None;
        }
        Some(Self {
            start,
            end,
            is_integer: end == point,
            is_negative,
            is_exact: end - first <= MOST_DIGITS + usize::from(point < end)
                || has_few_digits(bytes, first),
            digits,
            exponent,
        })
    }

    /// Returns the nearest f64 if it is finite; `text` is the text that was scanned.
    #[inline(always)]
    pub(crate) fn float(&self, text: &str) -> Option<f64> {
        let magnitude = match self.exponent {
            _ if !self.is_exact => return other(text, self.start, self.end),
            0 => self.digits as f64,
            SMALLEST_POWER..=-1 => quotient(self.digits, self.exponent.unsigned_abs()),
            _ => return other(text, self.start, self.end),
        };
        // Set the sign bit without a branch: the sign of a coordinate is unpredictable.
        let sign = u64::from(self.is_negative) << 63;
        Some(f64::from_bits(magnitude.to_bits() | sign))
    }

    /// Returns the value of a number without sign, fraction and exponent.
    pub(crate) fn unsigned(&self) -> Option<u64> {
        (self.is_integer && self.is_exact && !self.is_negative).then_some(self.digits)
    }
}

/// Parses a range of a text with the standard library; returns `None` if the number is not finite.
#[cold]
fn other(text: &str, start: usize, end: usize) -> Option<f64> {
    let token = text.get(start..end)?;
    token.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Limit for powers of ten; beyond it, every number is 0 or infinite.
const FAR: i32 = 1 << 24;

#[inline]
fn continues_a_number(byte: u8) -> bool {
    matches!(byte, b'0'..=b'9' | b'a'..=b'z' | b'A'..=b'Z' | b'_' | b'.' | b'+' | b'-' | 0x80..)
}

/// Returns true if the digits of a number, without leading zeros, fit in 64 bits.
fn has_few_digits(bytes: &[u8], first: usize) -> bool {
    let rest = bytes.get(first..).unwrap_or_default().iter();
    let digits = rest
        .take_while(|byte| matches!(byte, b'0'..=b'9' | b'.'))
        .filter(|byte| **byte != b'.');
    digits
        .skip_while(|digit| **digit == b'0')
        .nth(MOST_DIGITS)
        .is_none()
}

/// Number of digits that always fit in 64 bits.
const MOST_DIGITS: usize = 19;
/// 5^27 is the largest power of 5 that fits in 64 bits.
const SMALLEST_POWER: i32 = -27;

/// Appends a run of digits to a number, eight at a time, and returns the end of the run. Wraps on
/// overflow.
#[inline(always)]
fn run_of_digits(bytes: &[u8], start: usize, number: &mut u64) -> usize {
    let mut at = start;
    while let Some(chunk) = bytes.get(at..).and_then(<[u8]>::first_chunk) {
        let chunk = u64::from_le_bytes(*chunk);
        let count = leading_digits(chunk);
        if count == 8 {
            let eight = value_of_eight(chunk);
            *number = number.wrapping_mul(100_000_000).wrapping_add(eight);
            at += 8;
            continue;
        }
        // Shifting the digits to the end puts zeros in front of them. It also works if there are
        // none, which saves an unpredictable branch.
        let fewer = value_of_eight(chunk << (56 - 8 * count) << 8);
        let scale = POWERS_OF_TEN[count as usize & 7];
        *number = number.wrapping_mul(scale).wrapping_add(fewer);
        return at + count as usize;
    }
    while let Some(digit @ b'0'..=b'9') = bytes.get(at) {
        *number = number
            .wrapping_mul(10)
            .wrapping_add(u64::from(digit - b'0'));
        at += 1;
    }
    at
}

const POWERS_OF_TEN: [u64; 8] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000];

/// Counts the leading digits in eight characters, the first in the lowest byte.
#[inline]
fn leading_digits(chunk: u64) -> u32 {
    const HIGH: u64 = 0xf0f0_f0f0_f0f0_f0f0;
    const THREES: u64 = 0x3030_3030_3030_3030;
    const SIXES: u64 = 0x0606_0606_0606_0606;
    // A digit is a byte 0x3_ that is still 0x3_ after adding 6. A carry only reaches bytes after
    // the first non-digit.
    let high = (chunk & HIGH) ^ THREES;
    let carried = (chunk.wrapping_add(SIXES) & HIGH) ^ THREES;
    (high | carried).trailing_zeros() / 8
}

/// Converts eight digits to a number, the first in the lowest byte; a zero byte counts as 0.
#[inline]
fn value_of_eight(chunk: u64) -> u64 {
    // Pairs, then fours, then all eight: each step scales the earlier half and adds the later one.
    let ones = chunk & 0x0f0f_0f0f_0f0f_0f0f;
    let pairs = (ones.wrapping_mul(10 << 8 | 1) >> 8) & 0x00ff_00ff_00ff_00ff;
    let fours = (pairs.wrapping_mul(100 << 16 | 1) >> 16) & 0x0000_ffff_0000_ffff;
    fours.wrapping_mul(10_000 << 32 | 1) >> 32
}

/// Parses the power of ten after an `e`; returns it, clamped, with its end.
fn power(bytes: &[u8], start: usize) -> Option<(i32, usize)> {
    let sign = bytes.get(start);
    let first = start + usize::from(matches!(sign, Some(b'+' | b'-')));
    let mut at = first;
    let mut power = 0;
    while let Some(digit @ b'0'..=b'9') = bytes.get(at) {
        power = (power * 10 + i32::from(digit - b'0')).min(FAR);
        at += 1;
    }
    let power = if sign == Some(&b'-') { -power } else { power };
    (at > first).then_some((power, at))
}

/// A power of 5, shifted so that its highest bit is set, and its reciprocal.
#[derive(Clone, Copy)]
struct Divisor {
    shift: u32,
    value: u64,
    /// floor((2^128 - 1) / value) - 2^64.
    reciprocal: u64,
}

const DIVISORS: [Divisor; SMALLEST_POWER.unsigned_abs() as usize + 1] = {
    let mut divisors = [Divisor {
        shift: 0,
        value: 0,
        reciprocal: 0,
    }; SMALLEST_POWER.unsigned_abs() as usize + 1];
    let mut power = 1_u64;
    let mut index = 0;
    loop {
        let value = power << power.leading_zeros();
        divisors[index] = Divisor {
            shift: power.leading_zeros(),
            value,
            reciprocal: (u128::MAX / value as u128) as u64,
        };
        index += 1;
        if index == divisors.len() {
            break divisors;
        }
        power *= 5;
    }
};

/// Computes `digits / 10^power`, rounded to nearest, ties to even.
#[inline]
fn quotient(digits: u64, power: u32) -> f64 {
    let (Some(digits), Some(by)) = (NonZeroU64::new(digits), DIVISORS.get(power as usize)) else {
        return 0.0;
    };
    // Both factors fill 64 bits, so the 64-bit quotient q starts with a one: digits / 5^power = q *
    // 2^scale.
    let shift = digits.leading_zeros();
    let high = digits.get() << shift;
    let halved = u64::from(high >= by.value);
    let (q, remainder) = divide(high >> halved, (high & halved) << 63, by);
    let scale = by.shift as i32 - shift as i32 - 64 + halved as i32 - power as i32;
    // The top 53 bits are kept. The others decide the rounding; the remainder shows if they are
    // exact.
    let (kept, rest) = (q >> 11, q & 0x7ff);
    let half = 1 << 10;
    let up = (rest > half) | (rest == half) & ((remainder != 0) | (kept & 1 == 1));
    // A 64-bit number divided by 63 bits and halved 27 times stays far from the smallest and the
    // largest floats. The leading one adds 1 to the exponent, and so does a carry out of the
    // mantissa.
    let exponent = (scale + 11 + 52 + 1023 - 1) as u64;
    f64::from_bits((exponent << 52) + kept + u64::from(up))
}

/// Divides 128 bits by 64 bits, with a quotient of 64 bits (N. Möller, T. Granlund, Improved
/// division by invariant integers, 2011, algorithm 4).
#[inline]
fn divide(high: u64, low: u64, by: &Divisor) -> (u64, u64) {
    let product = u128::from(by.reciprocal) * u128::from(high);
    let sum = product.wrapping_add(u128::from(high) << 64 | u128::from(low));
    let mut quotient = ((sum >> 64) as u64).wrapping_add(1);
    let mut remainder = low.wrapping_sub(quotient.wrapping_mul(by.value));
    if remainder > sum as u64 {
        quotient = quotient.wrapping_sub(1);
        remainder = remainder.wrapping_add(by.value);
    }
    if remainder >= by.value {
        quotient = quotient.wrapping_add(1);
        remainder -= by.value;
    }
    (quotient, remainder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::random::{Rng, cases};

    fn float(text: &str) -> Option<f64> {
        let decimal = Decimal::scan(text, 0)?;
        assert_eq!(decimal.end, text.len());
        decimal.float(text)
    }

    #[track_caller]
    fn is_as_in_std(text: &str) {
        let expected: f64 = text.parse().unwrap();
        let found = float(text).map(f64::to_bits);
        let expected = expected.is_finite().then_some(expected.to_bits());
        assert_eq!(found, expected, "{text}");
    }

    #[test]
    fn numbers_are_rounded_as_the_standard_library_does() {
        for text in [
            "0",
            "-0",
            "0.0",
            "-0.000",
            "0e5",
            "0e-99999999999999999999",
            "1e99999999999999999999",
            "1",
            "-1",
            "0.1",
            "123456789012345678901234567890",
            "9007199254740993",
            "18446744073709551615",
            "9999999999999999999",
            "0.9999999999999999999",
            "99999999999999999999",
            "1.7976931348623157e308",
            "1.8e308",
            "4.9e-324",
            "2e-324",
            "5e-1",
            "1e-27",
            "1e-28",
            "12345e-30",
            "0.000000000000000000000000001",
            "0.0000000000000000000000000012345",
            "9007199254740992.5",
            "9007199254740993.5",
            "4503599627370496.5",
            "4503599627370497.5",
            "0.000000000000000000012345678901234567890123",
            "1.00000000000000011102230246251565404236316680908203125",
            "1.00000000000000011102230246251565404236316680908203124",
        ] {
            is_as_in_std(text);
        }
    }

    #[test]
    fn random_numbers_are_rounded_as_the_standard_library_does() {
        let mut rng = Rng(0x2545_f491_4f6c_dd1d);
        for _ in 0..cases(100_000) {
            // The shortest form of any number, digits with a point at any position, and ties: an
            // odd 54-bit number divided by a power of two has a finite fraction.
            let any = f64::from_bits(rng.next());
            if any.is_finite() {
                is_as_in_std(&format!("{any:e}"));
            }
            let mut digits = (rng.next() >> rng.below(64)).to_string();
            let zeros = rng.below(12);
            digits.insert_str(0, &"0".repeat(zeros));
            digits.insert_str(0, "0.");
            is_as_in_std(&digits);
            let whole = rng.next() >> rng.below(64);
            is_as_in_std(&format!("-{whole}.{}", rng.next() >> rng.below(64)));
            is_as_in_std(&format!("{whole}e-{}", rng.below(40)));
            let tie = (rng.next() >> 10 | 1) as f64;
            let half = 1_u64 << rng.below(8);
            is_as_in_std(&format!("{}", tie / half as f64));
        }
    }

    #[test]
    fn halfway_cases_round_to_even() {
        let mut rng = Rng(7);
        for _ in 0..10_000 {
            // Twice a 53-bit number plus one: halfway between two floats.
            let middle = (rng.next() >> 11 | 1 << 52) * 2 + 1;
            for halvings in 1..=3_u32 {
                let scaled = u128::from(middle) * 5_u128.pow(halvings);
                let split = 10_u128.pow(halvings);
                let (whole, fraction) = (scaled / split, scaled % split);
                let width = halvings as usize;
                is_as_in_std(&format!("{whole}.{fraction:0width$}"));
            }
        }
    }

    #[test]
    fn other_spellings_are_left_alone() {
        for text in [
            "", "-", "+1", ".5", "1.", "01", "-01", "1e", "1e+", "1_0", "1f64", "0x1", "1.5.2",
            "1-", "--1", "inf", "NaN", "1é",
        ] {
            assert!(Decimal::scan(text, 0).is_none(), "{text}");
        }
    }

    #[test]
    fn integers_have_neither_sign_nor_fraction() {
        let unsigned = |text| Decimal::scan(text, 0).and_then(|found| found.unsigned());
        assert_eq!(unsigned("640"), Some(640));
        assert_eq!(unsigned("1234567890123456789"), Some(1234567890123456789));
        for text in ["-1", "1.0", "1e2", "18446744073709551616"] {
            assert_eq!(unsigned(text), None, "{text}");
        }
    }
}
