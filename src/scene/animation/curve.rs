//! What stands between two keys.

use glam::DVec3;

use crate::{
    scene::format::{
        animation::{Interpolation, Key},
        color::ColorModel,
        field::Triple,
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

/// A point at a time, each coordinate by itself.
pub(super) fn point(keys: &[Key<Triple>], time: f64) -> Option<Triple> {
    at(keys, time, |span| {
        [0, 1, 2].map(|axis| span.blend(|point| point[axis]))
    })
}

/// A direction at a time: a unit vector, but where it is that of a key.
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

/// A color at a time, in linear light.
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
            // Light and back is not quite the same number.
            if from[index] == to[index] {
                return from[index];
            }
            to_display(span.blend(|color| to_linear(channels(color)[index])))
        }))
    })
}

/// The value at a time: before the first key that of the first, behind the last that of the last;
/// between two keys `between` says it, unless the second is a step.
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
    /// The index of the second.
    next: usize,
    from: &'k Key<T>,
    /// How much of the time from the first to the second has gone by, in 0..1.
    part: f64,
}

impl<T> Span<'_, T> {
    fn to(&self) -> &Key<T> {
        self.keys.get(self.next).unwrap_or(self.from)
    }

    fn is_smooth(&self) -> bool {
        self.to().step == Some(Interpolation::Smooth)
    }

    /// The number that `of` finds in the values, on the way from one to the other and never beyond
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

    /// How much of the way the curve has gone: the cubic of Hermite from 0 to 1, with the slopes of
    /// both ends as multiples of the secant. No slope is more than three times the secant, so that
    /// it is monotone (F. N. Fritsch and R. E. Carlson, Monotone piecewise cubic interpolation,
    /// 1980).
    fn eased(&self, of: impl Fn(&T) -> f64) -> f64 {
        let secant = |index: usize| self.secant(index, &of);
        let here = secant(self.next).unwrap_or_default();
        // A step beside it is rest.
        let slope = |before, behind| match (before, behind) {
            (Some(before), Some(behind)) => slope(before, behind) / here.1,
            _ => 0.0,
        };
        let start = slope(secant(self.next - 1), Some(here));
        let end = slope(Some(here), secant(self.next + 1));
        let s = self.part;
        let eased = s * (start + s * ((3.0 - 2.0 * start - end) + s * (start + end - 2.0)));
        // Of numbers beyond reason the slopes are none.
        if eased.is_finite() {
            eased.clamp(0.0, 1.0)
        } else {
            s
        }
    }

    /// The time from the key before to the key of an index, and the slope of the straight line
    /// between them; `None` where there is no key, or where the value jumps.
    fn secant(&self, index: usize, of: impl Fn(&T) -> f64) -> Option<(f64, f64)> {
        let before = self.keys.get(index.checked_sub(1)?)?;
        let key = self.keys.get(index)?;
        let time = key.time - before.time;
        let rise = of(&key.value) - of(&before.value);
        (key.step != Some(Interpolation::Step)).then_some((time, rise / time))
    }
}

/// The slope at a key between two secants, each with its time: their harmonic mean, weighted; 0
/// where they differ in sign (F. N. Fritsch and J. Butland, A method for constructing local
/// monotone piecewise cubic interpolants, 1984, as in PCHIP).
fn slope((time, before): (f64, f64), (next_time, behind): (f64, f64)) -> f64 {
    let have_one_sign = (before > 0.0 && behind > 0.0) || (before < 0.0 && behind < 0.0);
    if !have_one_sign {
        return 0.0;
    }
    let weights = [2.0 * next_time + time, next_time + 2.0 * time];
    (weights[0] + weights[1]) / (weights[0] / before + weights[1] / behind)
}

/// The unit vector a part of the way from one direction to another, on the great circle (K.
/// Shoemake, Animating rotation with quaternion curves, 1985, section 3.3).
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
