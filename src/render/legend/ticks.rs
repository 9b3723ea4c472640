//! Ticks of an axis at round numbers.

/// A tick: a multiple of 1, 2 or 5 times a power of ten.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: String,
}

/// The numbers with at most this many digits before or after the point are written without an
/// exponent.
const DIGITS: i32 = 6;

/// Returns ticks in a range from low to high, at most `most`; a range of one value has one.
pub(super) fn ticks([low, high]: [f64; 2], most: usize) -> Vec<Tick> {
    if low >= high {
        return vec![Tick {
            value: low,
            label: exact(low),
        }];
    }
    // Halves, because the length of a range may be too large for an f64.
    let raw = (high / 2.0 - low / 2.0) / most.max(1) as f64 * 2.0;
    let start = exponent(raw.clamp(f64::from_bits(1), f64::MAX));
    let steps = (start..).flat_map(|exponent| [1, 2, 5].map(|digit| (digit, exponent)));
    // The first step of ten times the raw one is always large enough.
    let found = steps.take(9).find_map(|(digit, exponent)| {
        let step = decimal(digit, exponent);
        let (first, last) = within([low, high], step);
        let count = last - first + 1.0;
        (step > 0.0 && count <= most.max(1) as f64).then_some((digit, exponent, first, last))
    });
    let Some((digit, exponent, first, last)) = found else {
        return Vec::new();
    };
    // Below 2^53 times ten: no f64 between low and high is closer to its neighbor.
    let numbers = (first as i64..=last as i64).map(|count| count.saturating_mul(digit));
    let largest = numbers.clone().map(i64::unsigned_abs).max().unwrap_or(0);
    let digits = largest
        .checked_ilog10()
        .map_or(1, |digits| digits as i32 + 1);
    let is_plain = digits + exponent <= DIGITS && exponent >= -DIGITS;
    let ticks = numbers.map(|number| Tick {
        value: decimal(number, exponent),
        label: if is_plain {
            plain(number, exponent)
        } else {
            scientific(number, exponent)
        },
    });
    // The quotients are rounded.
    let mut ticks: Vec<_> = ticks
        .filter(|tick| (low..=high).contains(&tick.value))
        .collect();
    // So are the values: where numbers are too close, several are one.
    let count = ticks.len();
    ticks.dedup_by(|next, tick| next.value <= tick.value);
    if ticks.len() < count {
        for tick in &mut ticks {
            tick.label = exact(tick.value);
        }
    }
    ticks
}

/// Formats a number with all its digits.
fn exact(number: f64) -> String {
    // Without the sign of a zero.
    let number = number + 0.0;
    let plain = number.to_string();
    match plain.len() <= 2 * DIGITS as usize + 2 {
        true => plain,
        false => format!("{number:e}"),
    }
}

/// Returns the first and the last multiple of a step in a range, which may be too far from it for
/// an f64: 0 is not in a range above or below it.
fn within([low, high]: [f64; 2], step: f64) -> (f64, f64) {
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    (
        if low > 0.0 { first.max(1.0) } else { first },
        if high < 0.0 { last.min(-1.0) } else { last },
    )
}

/// Returns the exponent of a positive number in scientific notation.
fn exponent(number: f64) -> i32 {
    let text = format!("{number:e}");
    let exponent = text.split_once('e').map(|(_, exponent)| exponent.parse());
    exponent.and_then(Result::ok).unwrap_or(0)
}

/// Returns `number * 10^exponent`, rounded once.
fn decimal(number: i64, exponent: i32) -> f64 {
    format!("{number}e{exponent}").parse().unwrap_or(0.0)
}

/// Formats `number * 10^exponent` without an exponent, with the same digits after the point for all
/// numbers.
fn plain(number: i64, exponent: i32) -> String {
    if exponent >= 0 {
        let zeros = if number == 0 { 0 } else { exponent as usize };
        return format!("{number}{}", "0".repeat(zeros));
    }
    let places = exponent.unsigned_abs() as usize;
    let digits = format!("{:0width$}", number.unsigned_abs(), width = places + 1);
    let (whole, part) = digits.split_at(digits.len() - places);
    let sign = if number < 0 { "-" } else { "" };
    format!("{sign}{whole}.{part}")
}

/// Formats `number * 10^exponent` with one digit before the point.
fn scientific(number: i64, exponent: i32) -> String {
    if number == 0 {
        return "0".to_owned();
    }
    let digits = number.unsigned_abs().to_string();
    let exponent = exponent + digits.len() as i32 - 1;
    let (first, rest) = digits.split_at(1);
    let rest = rest.trim_end_matches('0');
    let point = if rest.is_empty() { "" } else { "." };
    let sign = if number < 0 { "-" } else { "" };
    format!("{sign}{first}{point}{rest}e{exponent}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        for (range, most, expected) in [
            ([-1.0, 1.0], 5, "-1.0 -0.5 0.0 0.5 1.0"),
            (
                [0.0, 1.0],
                11,
                "0.0 0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1.0",
            ),
            ([0.13, 0.87], 4, "0.2 0.4 0.6 0.8"),
            ([3.0, 1234.0], 7, "200 400 600 800 1000 1200"),
            ([0.0, 4e9], 5, "0 1e9 2e9 3e9 4e9"),
            ([0.0, 1.5e-9], 4, "0 5e-10 1e-9 1.5e-9"),
            ([7.0, 7.0], 5, "7"),
            ([-0.0, -0.0], 5, "0"),
            ([1e300, 1e300], 5, "1e300"),
            ([1e-300, 1e-300], 5, "1e-300"),
            ([-0.125, -0.125], 5, "-0.125"),
            ([-f64::MAX, f64::MAX], 3, "-1e308 0 1e308"),
            ([0.0, 5e-324], 3, "0 5e-324"),
        ] {
            let found: Vec<_> = ticks(range, most)
                .into_iter()
                .map(|tick| tick.label)
                .collect();
            assert_eq!(found.join(" "), expected, "{range:?}");
        }
    }

    #[test]
    fn ticks_of_neighbors_differ() {
        for low in [0.3_f64, 1.0, 1e300, -7.5] {
            let (low, high) = (low, low.next_up());
            let found = ticks([low, high], 9);
            let values: Vec<_> = found.iter().map(|tick| tick.value).collect();
            assert!(
                [&[low][..], &[high], &[low, high]].contains(&&values[..]),
                "{found:?}"
            );
            let labels = found.iter().map(|tick| tick.label.parse().unwrap());
            assert_eq!(labels.collect::<Vec<f64>>(), values);
        }
    }

    #[test]
    fn ticks_lie_in_their_range() {
        use crate::tracer::random::Rng;
        let mut rng = Rng(0x71c4_0000_0000_0001);
        for _ in 0..2000 {
            let number = |rng: &mut Rng| f64::from_bits(rng.next());
            let (one, other) = (number(&mut rng), number(&mut rng));
            if !(one.is_finite() && other.is_finite()) || one == other {
                continue;
            }
            let range = [one.min(other), one.max(other)];
            let most = 2 + rng.below(9);
            let found = ticks(range, most);
            assert!(
                !found.is_empty() && found.len() <= most,
                "{range:?}: {found:?}"
            );
            for pair in found.windows(2) {
                assert!(pair[0].value < pair[1].value, "{range:?}: {found:?}");
            }
            for tick in &found {
                assert!(
                    (range[0]..=range[1]).contains(&tick.value),
                    "{range:?}: {tick:?}"
                );
            }
        }
    }
}
