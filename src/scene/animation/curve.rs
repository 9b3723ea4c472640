//! Interpolation between keys.

use glam::DVec3;

use crate::{
    scene::format::{
        animation::{Interpolation, Key},
        color::ColorModel,
        numbers::{Interval, ScaleModel, Triple},
    },
    tracer::{
        srgb::{to_display, to_linear},
        vector::{is_direction, unit},
    },
};

/// A number at a time.
pub(super) fn number(keys: &[Key<f64>], time: f64) -> Option<f64> {
    at(keys, time, |span| span.blend(|number| *number))
}

/// Returns a scale at a time: a number between two numbers, else three, each interpolated separately.
pub(super) fn scale(keys: &[Key<ScaleModel>], time: f64) -> Option<ScaleModel> {
    at(keys, time, |span| {
        match [&span.from.value, &span.to().value] {
            [ScaleModel::Uniform(_), ScaleModel::Uniform(_)] => {
                ScaleModel::Uniform(span.blend(|scale| scale.factors().x))
            }
            _ => ScaleModel::Axes([0, 1, 2].map(|axis| span.blend(|scale| scale.factors()[axis]))),
        }
    })
}

/// Returns a point at a time, each coordinate interpolated separately.
pub(super) fn point(keys: &[Key<Triple>], time: f64) -> Option<Triple> {
    at(keys, time, |span| {
        [0, 1, 2].map(|axis| span.blend(|point| point[axis]))
    })
}

/// Returns a range at a time, each bound interpolated separately.
pub(super) fn interval(keys: &[Key<Interval>], time: f64) -> Option<Interval> {
    at(keys, time, |span| {
        [0, 1].map(|bound| span.blend(|range| range[bound]))
    })
}

/// Returns a direction at a time: a unit vector, except at a key, whose value is unchanged.
pub(super) fn direction(keys: &[Key<Triple>], time: f64) -> Option<Triple> {
    at(keys, time, |span| {
        let [from, to] = [span.from.value, span.to().value];
        if from == to {
            return from;
        }
        if span.is_smooth() {
            let curve = [0, 1, 2].map(|axis| span.blend(|vector| unit((*vector).into())[axis]));
            if is_direction(curve.into()) {
                return unit(curve.into()).into();
            }
        }
        turn(from.into(), to.into(), span.part).into()
    })
}

/// Returns a color at a time, interpolated in linear light.
pub(super) fn color(keys: &[Key<ColorModel>], time: f64) -> Option<ColorModel> {
    let channels = |color: &ColorModel| {
        let color = color.build();
        [color.r(), color.g(), color.b()]
    };
    at(keys, time, |span| {
        let [from, to] = [&span.from.value, &span.to().value].map(channels);
        if from == to {
            return span.from.value.clone();
        }
        ColorModel::Channels([0, 1, 2].map(|index| {
            // The conversion to linear light and back is not exact.
            if from[index] == to[index] {
                return from[index];
            }
            to_display(span.blend(|color| to_linear(channels(color)[index])))
        }))
    })
}

/// Returns the value at a time: that of the first key before it, that of the last key after it, and
/// the result of `between` between two keys, unless the second is a step.
fn at<T: Clone>(keys: &[Key<T>], time: f64, between: impl Fn(&Span<T>) -> T) -> Option<T> {
    let next = keys.partition_point(|key| key.time <= time);
    let Some(from) = next.checked_sub(1).and_then(|index| keys.get(index)) else {
        return keys.first().map(|key| key.value.clone());
    };
    Some(match keys.get(next) {
        Some(to) if from.time < time && to.step != Some(Interpolation::Step) => between(&Span {
            keys,
            next,
            from,
            part: (time - from.time) / (to.time - from.time),
        }),
        _ => from.value.clone(),
    })
}

/// A time between two keys.
struct Span<'k, T> {
    keys: &'k [Key<T>],
    /// The index of the second key.
    next: usize,
    from: &'k Key<T>,
    /// The elapsed fraction of the time from the first key to the second, in 0..1.
    part: f64,
}

impl<T> Span<'_, T> {
    fn to(&self) -> &Key<T> {
        self.keys.get(self.next).unwrap_or(self.from)
    }

    fn is_smooth(&self) -> bool {
        self.to().step == Some(Interpolation::Smooth)
    }

    /// Returns the number that `of` extracts, interpolated between the values and never beyond
    /// either.
    fn blend(&self, of: impl Fn(&T) -> f64) -> f64 {
        let [from, to] = [of(&self.from.value), of(&self.to().value)];
        if from == to {
            return from;
        }
        let part = if self.is_smooth() {
            self.eased(of)
        } else {
            self.part
        };
        (from + (to - from) * part)
            .max(from.min(to))
            .min(from.max(to))
    }

    /// Returns the fraction of the way that the curve has covered: the Hermite cubic from 0 to 1,
    /// with the slopes of both ends as multiples of the secant. No slope exceeds three times the
    /// secant, so that the curve is monotone (F. N. Fritsch and R. E. Carlson, Monotone piecewise
    /// cubic interpolation, 1980).
    fn eased(&self, of: impl Fn(&T) -> f64) -> f64 {
        let secant = |index: usize| self.secant(index, &of);
        let here = secant(self.next).unwrap_or_default();
        // Next to a step the slope is 0.
        let slope = |before, behind| match (before, behind) {
            (Some(before), Some(behind)) => slope(before, behind) / here.1,
            _ => 0.0,
        };
        let start = slope(secant(self.next - 1), Some(here));
        let end = slope(Some(here), secant(self.next + 1));
        let s = self.part;
        let eased = s * (start + s * ((3.0 - 2.0 * start - end) + s * (start + end - 2.0)));
        // Extremely large numbers have no slopes.
        if eased.is_finite() {
            eased.clamp(0.0, 1.0)
        } else {
            s
        }
    }

    /// Returns the time from the previous key to the key at an index, and the slope of the straight
    /// line between them; `None` if there is no such key or if the value jumps.
    fn secant(&self, index: usize, of: impl Fn(&T) -> f64) -> Option<(f64, f64)> {
        let before = self.keys.get(index.checked_sub(1)?)?;
        let key = self.keys.get(index)?;
        let time = key.time - before.time;
        let rise = of(&key.value) - of(&before.value);
        (key.step != Some(Interpolation::Step)).then_some((time, rise / time))
    }
}

/// Returns the slope at a key between two secants, each with its time: their weighted harmonic
/// mean; 0 if they differ in sign (F. N. Fritsch and J. Butland, A method for constructing local
/// monotone piecewise cubic interpolants, 1984, as in PCHIP).
fn slope((time, before): (f64, f64), (next_time, behind): (f64, f64)) -> f64 {
    let have_one_sign = (before > 0.0 && behind > 0.0) || (before < 0.0 && behind < 0.0);
    if !have_one_sign {
        return 0.0;
    }
    let weights = [2.0 * next_time + time, next_time + 2.0 * time];
    (weights[0] + weights[1]) / (weights[0] / before + weights[1] / behind)
}

/// Returns the unit vector at a fraction of the way from one direction to another, on the great
/// circle (K. Shoemake, Animating rotation with quaternion curves, 1985, section 3.3).
fn turn(from: DVec3, to: DVec3, part: f64) -> DVec3 {
    let (from, to) = (unit(from), unit(to));
    // acos would lose half of the digits of a small angle (W. Kahan, How futile are mindless
    // assessments of roundoff, 2006, section 12).
    let angle = 2.0 * libm::atan2((from - to).length(), (from + to).length());
    let whole = libm::sin(angle);
    if whole <= 0.0 {
        return from;
    }
    let [rest, gone] = [1.0 - part, part].map(|part| libm::sin(part * angle) / whole);
    unit(from * rest + to * gone)
}
