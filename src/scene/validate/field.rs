//! Checks of values by the kinds of their fields.

use glam::DVec3;

use crate::{
    diagnostic::{Code, path::Path},
    scene::{
        format::{
            color::ColorModel,
            color_names,
            field::{Field, FieldKind, Range, Value},
            numbers::{Interval, Triple},
        },
        problem::{Cure, Focus, Problem},
        recover::text::NO_NUMBER,
        validate::found::Found,
    },
    tracer::vector::is_direction,
};

impl Found {
    pub(super) fn direction(&mut self, vector: DVec3, what: &str, path: impl Fn() -> Path) -> bool {
        let fine = is_direction(vector);
        if !fine {
            let length = if vector == DVec3::ZERO {
                "is 0"
            } else {
                "is 0 or not finite in an f64"
            };
            let message = format!("{what} has no direction, its squared length {length}");
            let problem = Problem::new(Code::ZeroVector, path(), Focus::Value, message);
            self.push(problem);
        }
        fine
    }

    /// Checks a value against the kind of its field.
    #[inline]
    pub(super) fn field(&mut self, field: &'static Field, value: Value, path: impl Fn() -> Path) {
        let kind = field.kind;
        let is_fine = match value {
            Value::Number(number) => {
                number.is_finite() && kind.range().is_none_or(|range| range.holds(number))
            }
            Value::Vector(vector) => {
                kind != FieldKind::Direction && vector.iter().all(|number| number.is_finite())
            }
            Value::Interval([low, high]) => low.is_finite() && high.is_finite() && low < high,
            Value::Color(color) => matches!(color, ColorModel::Hex(_)),
        };
        if !is_fine {
            let (name, path) = (field.name, || path().field(field.name));
            self.fault(kind, name, value, &path);
        }
    }

    /// Reports what is wrong with a value, if anything is.
    #[cold]
    pub(super) fn fault(
        &mut self,
        kind: FieldKind,
        name: &str,
        value: Value,
        path: &dyn Fn() -> Path,
    ) {
        match value {
            Value::Number(number) => self.number_of(kind, number, path, name),
            Value::Vector(vector) => {
                if self.finite(vector, path) && kind == FieldKind::Direction {
                    let what = format!("`{name}`");
                    self.direction(DVec3::from(*vector), &what, path);
                }
            }
            Value::Interval(range) => self.interval(range, name, path),
            Value::Color(color) => self.color(color, path),
        }
    }

    /// Checks a range.
    pub(super) fn interval(&mut self, [low, high]: Interval, name: &str, path: impl Fn() -> Path) {
        let mut is_finite = true;
        for (index, number) in [low, high].into_iter().enumerate() {
            is_finite &= self.number(number, || path().index(index));
        }
        if !is_finite || low < high {
            return;
        }
        let message = format!("`{name}` must rise, found `{low}` to `{high}`");
        let problem = Problem::new(Code::OutOfRange, path(), Focus::Value, message);
        self.push(if low == high {
            problem.help("write the values of the first and the last color, such as (0, 1)")
        } else {
            problem.help(format!(
                "write `{high}` first, then `{low}`; to reverse the colors, list them in \
                 `map: Colors([…])`"
            ))
        });
    }

    /// Checks one number against a kind.
    pub(super) fn number_of(
        &mut self,
        kind: FieldKind,
        number: f64,
        path: impl Fn() -> Path,
        name: &str,
    ) {
        let is_wrong = |range: &Range| !range.holds(number);
        let is_finite = self.number(number, &path);
        let range = kind.range().filter(|range| is_finite && is_wrong(range));
        let Some(range) = range.filter(|_| !self.tally.only_counts(Code::OutOfRange)) else {
            return;
        };
        let message = format!("`{name}` must be {range}");
        let problem = Problem::of_value(Code::OutOfRange, path(), message);
        self.push(match kind {
            FieldKind::Angle if name == "fov" => problem.help(format!(
                "`{name}` is the full vertical angle of view, in degrees"
            )),
            _ => problem,
        });
    }

    pub(super) fn number(&mut self, number: f64, path: impl Fn() -> Path) -> bool {
        let is_read = number.to_bits() != NO_NUMBER.to_bits();
        if !number.is_finite() && is_read && !self.tally.only_counts(Code::NotFinite) {
            let problem = Problem::of_value(Code::NotFinite, path(), "expected a finite number");
            let largest = "numbers are finite 64-bit floats, up to about 1.8e308";
            self.push(problem.help(largest));
        }
        number.is_finite()
    }

    pub(super) fn finite(&mut self, vector: &Triple, path: impl Fn() -> Path) -> bool {
        let mut finite = true;
        for (index, number) in vector.iter().enumerate() {
            finite &= self.number(*number, || path().index(index));
        }
        finite
    }

    pub(super) fn color(&mut self, color: &ColorModel, path: impl Fn() -> Path) {
        match color {
            ColorModel::Hex(_) => {}
            ColorModel::Channels(channels) => {
                for (index, channel) in channels.iter().enumerate() {
                    let path = || path().index(index);
                    let is_wrong = self.number(*channel, path) && !(0.0..=1.0).contains(channel);
                    if is_wrong && !self.tally.only_counts(Code::ColorClamped) {
                        self.push(color_clamped(channels, path()));
                    }
                }
            }
            ColorModel::Invalid(text) => self.push(invalid_color(text, path())),
        }
    }
}

/// Returns the problem of a number of a color that is clamped.
pub(super) fn clamped(path: Path) -> Problem {
    let message = "a color channel is clamped to 0..1";
    Problem::of_value(Code::ColorClamped, path, message)
}

fn color_clamped(channels: &Triple, path: Path) -> Problem {
    let problem = clamped(path);
    let is_byte = |channel: &f64| (0.0..=255.0).contains(channel) && channel.fract() == 0.0;
    if channels.iter().all(is_byte) {
        let [r, g, b] = channels.map(|channel| channel as u8);
        let hex = format!("\"#{r:02x}{g:02x}{b:02x}\"");
        let problem = problem.help(format!("8-bit values? write `{hex}`, or divide by 255"));
        // Small numbers may be light meant to be bright.
        problem.cure((r.max(g).max(b) >= 32).then_some(Cure::WriteAround(hex)))
    } else {
        problem
    }
}

fn invalid_color(text: &str, path: Path) -> Problem {
    let shown: String = text.chars().take(40).collect();
    let message = match &*shown {
        "" => "an empty string is not a color".to_owned(),
        shown => format!("`{}` is not a color", shown.escape_debug()),
    };
    let digits = text.strip_prefix('#').unwrap_or(text);
    let hex = digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    let is_bare = hex && matches!(digits.len(), 3 | 6);
    let meant = match color_names::of_css(text).map(color_names::hex) {
        None if is_bare => Some(format!("#{digits}")),
        meant => meant,
    };
    let opaque = color_names::of_function(text).map(|(bytes, _)| color_names::hex(bytes));
    let problem = Problem::new(Code::InvalidColor, path, Focus::Value, message).cure(
        meant
            .as_ref()
            .map(|meant| Cure::Write(format!("\"{meant}\""))),
    );
    if let (None, Some(opaque)) = (&meant, opaque) {
        return problem.help(format!("a color has no alpha: write `{opaque}`"));
    }
    problem.help(match (digits.len(), meant) {
        (_, Some(meant)) if is_bare => format!("write `{meant}`"),
        (_, Some(meant)) => format!("did you mean `{meant}`?"),
        (8, _) if hex => format!("a color has no alpha: write `#{}`", &digits[..6]),
        (4, _) if hex => format!("a color has no alpha: write `#{}`", &digits[..3]),
        _ if !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphabetic()) => {
            "color names are not supported; write `#rrggbb`, `#rgb` or three numbers in 0..1"
                .to_owned()
        }
        _ => "write `#rrggbb`, `#rgb` or three numbers in 0..1".to_owned(),
    })
}
