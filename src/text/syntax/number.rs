//! The grammar of numbers, and their values as parsed by `ron` and `serde_json`.

use std::borrow::Cow;

use super::language::Syntax;

/// The reason a number is not a value of the requested type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NumberError {
    /// Not a number in this syntax.
    Malformed,
    /// A number that the parser rejects for the type: `0x5A`, `90f32` or `b'x'` for an f64; `1.0`
    /// or JSON's `-0` for an integer.
    OtherType,
    /// Out of range for an f64 (JSON only; RON reads such a number as infinite) or an i128.
    OutOfRange,
}

/// The value of an integer, and the type named by its RON suffix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Integer {
    /// The value, not checked against the type of the suffix.
    pub(crate) value: i128,
    /// The suffix: `u32` in `5u32`, `u8` for `b'x'`. `ron` reads the number only as this type.
    pub(crate) suffix: Option<&'static str>,
}

impl Integer {
    /// Returns true if the value is in the range of the type named by its suffix.
    pub(crate) fn fits_its_suffix(&self) -> bool {
        let Some((sign, bits)) = self.suffix.map(|suffix| suffix.split_at(1)) else {
            return true;
        };
        let bits = bits.parse::<u32>().unwrap_or(i64::BITS);
        let values = match sign {
            "u" => 0..1_i128 << bits,
            _ => -(1 << (bits - 1))..1 << (bits - 1),
        };
        values.contains(&self.value)
    }
}

const SUFFIXES: [&str; 8] = ["i8", "i16", "i32", "i64", "u8", "u16", "u32", "u64"];

/// Parses a number as the f64 that the syntax's own parser would return, bit for bit.
///
/// # Errors
///
/// See [`NumberError`].
pub(crate) fn float(token: &str, syntax: Syntax) -> Result<f64, NumberError> {
    if syntax == Syntax::Json {
        json(token)?;
        let value: f64 = token.parse().map_err(|_| NumberError::Malformed)?;
        return if value.is_finite() {
            Ok(value)
        } else {
            Err(NumberError::OutOfRange)
        };
    }
    if let Some((value, narrow)) = ron_word(token) {
        return if narrow {
            Err(NumberError::OtherType)
        } else {
            Ok(value)
        };
    }
    match ron_float(token) {
        Some((_, true)) => Err(NumberError::OtherType),
        Some((digits, false)) => digits.parse().map_err(|_| NumberError::Malformed),
        None if ron_integer(token).is_some() => Err(NumberError::OtherType),
        None => Err(NumberError::Malformed),
    }
}

/// Parses a number as an integer.
///
/// # Errors
///
/// See [`NumberError`].
pub(crate) fn integer(token: &str, syntax: Syntax) -> Result<Integer, NumberError> {
    if syntax == Syntax::Json {
        json(token)?;
        // serde_json reads `-0` as a float, to keep its sign.
        if token.contains(['.', 'e', 'E']) || token == "-0" {
            return Err(NumberError::OtherType);
        }
        return token
            .parse()
            .map(|value| Integer {
                value,
                suffix: None,
            })
            .map_err(|_| NumberError::OutOfRange);
    }
    match ron_integer(token) {
        Some(parts) => parts.value(),
        None if ron_word(token).is_some() || ron_float(token).is_some() => {
            Err(NumberError::OtherType)
        }
        None => Err(NumberError::Malformed),
    }
}

/// Parses a whole number: an integer, or a float without a fraction, as programs write it.
///
/// # Errors
///
/// See [`NumberError`].
pub(crate) fn whole(token: &str, syntax: Syntax) -> Result<Integer, NumberError> {
    match integer(token, syntax) {
        Err(NumberError::OtherType) => {
            let number = float(token, syntax)?;
            let value = Integer {
                value: number as i128,
                suffix: None,
            };
            let is_whole = number.fract() == 0.0;
            is_whole.then_some(value).ok_or(NumberError::OtherType)
        }
        other => other,
    }
}

/// Checks that a token is a number; the error says what to write instead.
pub(super) fn check(token: &str, syntax: Syntax) -> Result<(), &'static str> {
    if syntax == Syntax::Json {
        return json(token).map_err(|_| json_help(token));
    }
    if ron_float(token).is_some() || ron_integer(token).is_some() || ron_word(token).is_some() {
        return Ok(());
    }
    Err(match token {
        _ if token.starts_with("...") => "write every value out",
        _ if token.contains("..") => "a range is not a value of a scene",
        _ if token.starts_with(['-', '+']) && token.len() == 1 => {
            "a sign is written directly before its digits"
        }
        _ => "a number is written as `1`, `-0.5` or `1e-3`",
    })
}

fn json_help(token: &str) -> &'static str {
    let digits = token.trim_start_matches(['-', '+']);
    match digits {
        _ if token.contains("..") => "write every value out",
        _ if token.starts_with('+') => "JSON does not allow `+` before a number",
        "" => "a sign is written directly before its digits",
        "Infinity" | "inf" | "NaN" | "nan" => "a number must be finite",
        _ if digits.starts_with('.') => "JSON requires a digit before the point: `0.5`",
        _ if digits.contains("._") || digits.contains('_') => "JSON does not allow `_` in numbers",
        _ if digits.starts_with("0x") => "JSON only supports decimal numbers",
        _ if digits.starts_with('0')
            && digits.as_bytes().get(1).is_some_and(u8::is_ascii_digit) =>
        {
            "JSON does not allow leading zeros"
        }
        _ if digits.ends_with('.') || digits.contains(".e") || digits.contains(".E") => {
            "JSON requires a digit after the point: `1.0`"
        }
        _ => "a number is written as `1`, `-0.5` or `1e-3`",
    }
}

/// Counts the ASCII digits at the start of a text.
fn digits(text: &[u8]) -> usize {
    text.iter().take_while(|b| b.is_ascii_digit()).count()
}

/// Matches `[digits] [. digits] [e [sign] digits]` with at least one digit in the mantissa, or, if
/// `strict`, on each side of the point.
fn decimal(text: &[u8], strict: bool) -> Option<()> {
    let whole = digits(text);
    let mut rest = text.get(whole..)?;
    let mut fraction = 0;
    if let Some(after) = rest.strip_prefix(b".") {
        fraction = digits(after);
        rest = after.get(fraction..)?;
        if strict && fraction == 0 {
            return None;
        }
    }
    if whole + fraction == 0 || (strict && whole == 0) {
        return None;
    }
    if let Some(after) = rest.strip_prefix(b"e").or_else(|| rest.strip_prefix(b"E")) {
        let after = after
            .strip_prefix(b"+")
            .or_else(|| after.strip_prefix(b"-"))
            .unwrap_or(after);
        let exponent = digits(after);
        rest = after.get(exponent..).filter(|_| exponent > 0)?;
    }
    rest.is_empty().then_some(())
}

fn json(token: &str) -> Result<(), NumberError> {
    let text = token.as_bytes();
    let text = text.strip_prefix(b"-").unwrap_or(text);
    let zeros = text.first() == Some(&b'0') && digits(text) > 1;
    decimal(text, true)
        .filter(|()| !zeros)
        .ok_or(NumberError::Malformed)
}

/// Parses `inf`, `-NaN`, `inff64`, …; returns the value, and true if the suffix makes it an f32.
pub(super) fn ron_word(token: &str) -> Option<(f64, bool)> {
    let (word, narrow) = match token.strip_suffix("f32") {
        Some(word) => (word, true),
        None => (token.strip_suffix("f64").unwrap_or(token), false),
    };
    let value = match word {
        "inf" | "+inf" => f64::INFINITY,
        "-inf" => f64::NEG_INFINITY,
        "NaN" | "+NaN" => f64::NAN,
        "-NaN" => -f64::NAN,
        _ => return None,
    };
    Some((value, narrow))
}

/// Returns a decimal number without its underscores, and true if the suffix makes it an f32.
fn ron_float(token: &str) -> Option<(Cow<'_, str>, bool)> {
    let (body, narrow) = match token.strip_suffix("f32") {
        Some(body) => (body, true),
        None => (token.strip_suffix("f64").unwrap_or(token), false),
    };
    let body = if body.contains('_') {
        Cow::Owned(without_underscores(body)?)
    } else {
        Cow::Borrowed(body)
    };
    let text = body.as_bytes();
    decimal(
        text.strip_prefix(b"-")
            .or_else(|| text.strip_prefix(b"+"))
            .unwrap_or(text),
        false,
    )?;
    Some((body, narrow))
}

/// Removes underscores. One may follow a digit, or the exponent's letter and its sign, but not
/// start the number or follow the point.
fn without_underscores(body: &str) -> Option<String> {
    let mut allowed = false;
    let mut out = String::with_capacity(body.len());
    for c in body.chars() {
        match c {
            '_' if allowed => continue,
            '_' => return None,
            '0'..='9' | 'e' | 'E' => allowed = true,
            '.' => allowed = false,
            _ => {}
        }
        out.push(c);
    }
    Some(out)
}

/// The parts of a RON integer.
struct RonInteger<'t> {
    negative: bool,
    base: u32,
    /// The digits with underscores; for `b'x'` the text between the quotes.
    digits: &'t str,
    byte: bool,
    suffix: Option<&'static str>,
}

fn ron_integer(token: &str) -> Option<RonInteger<'_>> {
    if let Some(rest) = token.strip_prefix("b'") {
        let digits = rest.strip_suffix('\'')?;
        return Some(RonInteger {
            negative: false,
            base: 0,
            digits,
            byte: true,
            suffix: Some("u8"),
        })
        .filter(|byte| byte.value().is_ok());
    }
    let rest = token.strip_prefix(['+', '-']).unwrap_or(token);
    let (base, rest) = match rest.get(..2) {
        Some("0b") => (2, rest.get(2..)?),
        Some("0o") => (8, rest.get(2..)?),
        Some("0x") => (16, rest.get(2..)?),
        _ => (10, rest),
    };
    let suffix = SUFFIXES.into_iter().find(|suffix| rest.ends_with(suffix));
    let digits = rest.get(..rest.len() - suffix.map_or(0, str::len))?;
    let valid = digits
        .bytes()
        .all(|b| b == b'_' || (b as char).is_digit(base));
    let negative = token.starts_with('-');
    (valid && !digits.is_empty() && !digits.starts_with('_')).then_some(RonInteger {
        negative,
        base,
        digits,
        byte: false,
        suffix,
    })
}

impl RonInteger<'_> {
    fn value(&self) -> Result<Integer, NumberError> {
        if self.byte {
            let bytes = super::text::unescape(self.digits, super::text::Quote::RonByte).ok();
            return match bytes.as_deref() {
                Some(&[byte]) => Ok(Integer {
                    value: i128::from(byte),
                    suffix: self.suffix,
                }),
                _ => Err(NumberError::Malformed),
            };
        }
        let mut value = 0i128;
        for digit in self.digits.chars().filter_map(|c| c.to_digit(self.base)) {
            let next = value
                .checked_mul(i128::from(self.base))
                .and_then(|v| v.checked_add(i128::from(digit)));
            value = next.ok_or(NumberError::OutOfRange)?;
        }
        Ok(Integer {
            value: if self.negative { -value } else { value },
            suffix: self.suffix,
        })
    }
}
