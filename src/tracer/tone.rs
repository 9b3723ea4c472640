//! From the light of a lit picture to display values.

use std::array;

use crate::tracer::{color::Color, radiance::Radiance};

/// The curve from linear light to what a screen can show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ToneMapping {
    /// Cuts off light above 1.
    #[default]
    Clip,
    /// Keeps hues and compresses highlights; dark and middle tones hardly change (Khronos PBR
    /// Neutral Tone Mapper, 2024).
    Neutral,
}

/// The exposure of a lit picture, and its tone mapping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    exposure: f64,
    /// `2^exposure`
    factor: f64,
    mapping: ToneMapping,
}

impl Tone {
    /// The tone of a flat picture, which shows each color unchanged. Powers and sums of samples are
    /// rounded, so the light is increased slightly: a color at half a level must still be rounded up.
    pub(crate) const FLAT: Self = Self {
        exposure: 0.0,
        factor: 1.0 + 4096.0 * f64::EPSILON,
        mapping: ToneMapping::Clip,
    };

    /// Creates a tone; each stop of `exposure` doubles the light.
    pub fn new(exposure: f64, mapping: ToneMapping) -> Self {
        Self {
            exposure,
            factor: libm::exp2(exposure),
            mapping,
        }
    }

    /// The exposure in stops.
    pub const fn exposure(self) -> f64 {
        self.exposure
    }

    /// The tone mapping.
    pub const fn mapping(self) -> ToneMapping {
        self.mapping
    }

    /// `2^exposure`, by which light is multiplied before tone mapping.
    pub(crate) const fn factor(self) -> f64 {
        self.factor
    }

    /// Returns light after exposure, before tone mapping: `L · 2^exposure`.
    #[inline]
    pub fn expose(self, light: Radiance) -> Radiance {
        light * self.factor
    }

    /// Returns exposed light after tone mapping.
    #[inline]
    pub fn map(self, exposed: Radiance) -> Radiance {
        match self.mapping {
            ToneMapping::Clip => exposed,
            ToneMapping::Neutral => neutral(exposed),
        }
    }

    /// Exposes and maps many colors at once, by channel.
    #[inline(always)]
    pub(crate) fn apply<const N: usize>(self, light: &mut [[f64; N]; 3]) {
        for channel in light.as_flattened_mut() {
            *channel *= self.factor;
        }
        if self.mapping == ToneMapping::Clip {
            return;
        }
        let [r, g, b] = light;
        for ((r, g), b) in r.iter_mut().zip(g).zip(b) {
            [*r, *g, *b] = self.map(Radiance::new(*r, *g, *b)).channels;
        }
    }

    /// Returns the color of light: exposed, mapped, clamped to 0..1 and encoded.
    pub fn color(self, light: Radiance) -> Color {
        Color::from_linear(self.map(self.expose(light)))
    }
}

impl Default for Tone {
    /// Creates a tone that changes nothing.
    fn default() -> Self {
        Self::new(0.0, ToneMapping::Clip)
    }
}

/// The light up to which the curve is a line.
const START: f64 = 0.76;
/// The Fresnel reflection that is subtracted.
const OFFSET: f64 = 0.04;
/// The rate at which compressed highlights lose their hue.
const DESATURATION: f64 = 0.15;

fn neutral(light: Radiance) -> Radiance {
    let [r, g, b] = light.channels;
    let least = r.min(g).min(b);
    let offset = if least < 2.0 * OFFSET {
        least - 6.25 * least * least
    } else {
        OFFSET
    };
    let light = light.channels.map(|channel| channel - offset);
    let peak = light[0].max(light[1]).max(light[2]);
    if peak < START {
        return Radiance { channels: light };
    }
    // (1 - START)² = 0.0576, and 2·START - 1 = 0.52.
    let compressed = 1.0 - 0.0576 / (peak - 0.52);
    let light = light.map(|channel| channel * compressed / peak);
    let gray = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    Radiance {
        channels: array::from_fn(|channel| light[channel] + (compressed - light[channel]) * gray),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_doubles_the_light() {
        let light = Radiance::new(0.1, 0.2, 0.3);
        assert_eq!(Tone::new(1.0, ToneMapping::Clip).expose(light), light * 2.0);
        assert_eq!(
            Tone::new(-1.0, ToneMapping::Clip).expose(light),
            light * 0.5
        );
        assert_eq!(Tone::default().expose(light), light);
    }

    #[test]
    fn clipped_light_is_that_of_the_color() {
        let color = Tone::default().color(Radiance::new(0.5, 1.0, 7.0));
        assert_eq!(color.to_rgb8(), [188, 255, 255]);
    }

    #[test]
    fn neutral_leaves_middle_tones_and_compresses_white() {
        let mapped = |light| Tone::new(0.0, ToneMapping::Neutral).map(light);
        let middle = mapped(Radiance::new(0.5, 0.4, 0.3)).channels;
        assert!(
            [0.46, 0.36, 0.26]
                .iter()
                .zip(middle)
                .all(|(a, b)| (a - b).abs() < 1e-15)
        );
        // 1 - 0.04 = 0.96, and 1 - 0.0576/0.44 = 0.869….
        let white = mapped(Radiance::WHITE).channels;
        assert!((white[0] - 0.869_090_909).abs() < 1e-9, "{white:?}");
        let bright = mapped(Radiance::new(1e6, 1e6, 1e6)).channels;
        assert!(bright[0] < 1.0 && bright[0] > 0.999);
    }
}
