//! What pixels show: the colors of a world, as the bytes of a file, and the mean of several.

use std::{array, collections::HashMap, iter, sync::OnceLock};

use crate::tracer::{color::Color, geometry::Geometry, world::World};

/// What a pixel or a sample holds that sees no geometry.
pub(crate) const NOTHING: u32 = u32::MAX;

/// What a pixel shows.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shown<'a> {
    /// One color, and whether it is that of a geometry.
    Flat(Color, bool),
    /// What its samples see.
    Mixed(&'a Mixed),
}

impl Shown<'_> {
    /// The color as display values; where something is transparent, without what is behind.
    pub(crate) fn color(self) -> Tone {
        match self {
            Self::Flat(color, _) => Tone::Display(color),
            Self::Mixed(mixed) => mixed.color,
        }
    }

    /// The linear light of the whole pixel: where something is transparent, less of it.
    pub(crate) fn light(self) -> [f64; 3] {
        match self {
            Self::Flat(color, _) => color.to_linear(),
            Self::Mixed(mixed) => mixed.light,
        }
    }

    /// The part of the pixel that geometries cover, in 0..1.
    pub(crate) fn coverage(self) -> f64 {
        match self {
            Self::Flat(_, is_covered) => f64::from(u8::from(is_covered)),
            Self::Mixed(mixed) => mixed.coverage,
        }
    }
}

/// The bytes of a pixel for whatever it may see: the background first, then the geometries in
/// the order of the file.
///
/// A geometry is large, so that a picture of many of them would wait for memory at each pixel:
/// the table is a small part of that, and it is made in the order in which they lie there.
#[derive(Clone, Debug)]
pub(crate) struct ColorTable<const N: usize> {
    flat: Vec<[u8; N]>,
    mixed: fn(&Mixed) -> [u8; N],
}

impl<const N: usize> ColorTable<N> {
    /// The bytes for what a pixel of a film holds: the index of a geometry, or `u32::MAX` where
    /// it sees the background.
    pub(crate) fn of(&self, index: u32) -> [u8; N] {
        let place = index.wrapping_add(1) as usize;
        self.flat.get(place).copied().unwrap_or([0; N])
    }

    /// The bytes of a pixel whose samples see several things.
    pub(crate) fn mixed(&self, mixed: &Mixed) -> [u8; N] {
        (self.mixed)(mixed)
    }
}

impl ColorTable<3> {
    /// Red, green and blue.
    pub(crate) fn rgb8(world: &World) -> Self {
        let geometries = world.geometries().iter().map(Geometry::color);
        let colors = iter::once(world.background()).chain(geometries);
        Self {
            flat: colors.map(Color::to_rgb8).collect(),
            mixed: |mixed| mixed.color.to_rgb8(),
        }
    }
}

/// A color in the form that it was found in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Tone {
    Display(Color),
    Light([f64; 3]),
}

impl Tone {
    /// As display values.
    pub(crate) fn color(self) -> Color {
        match self {
            Self::Display(color) => color,
            Self::Light(light) => Color::from_linear(light),
        }
    }

    /// As [`Color::to_rgb8`] of [`Tone::color`].
    pub(crate) fn to_rgb8(self) -> [u8; 3] {
        match self {
            Self::Display(color) => color.to_rgb8(),
            Self::Light(light) => light.map(byte_of),
        }
    }
}

/// The byte of light in 0..1: that of [`Color::from_linear`], without a power for each.
fn byte_of(light: f64) -> u8 {
    /// How near light may be to where the byte changes for that place to decide, in units of it:
    /// thousands of times as far as rounding moves it.
    const CLEAR: f64 = 1e-12;
    static ENDS: OnceLock<[f64; 255]> = OnceLock::new();
    // Byte b becomes b+1 at the display value (b+½)/255.
    let ends = ENDS.get_or_init(|| {
        array::from_fn(|byte| {
            let end = (byte as f64 + 0.5) / 255.0;
            Color::new(end, end, end).to_linear()[0]
        })
    });
    let low = ends.partition_point(|end| *end < light * (1.0 - CLEAR));
    let is_clear = ends.get(low).is_none_or(|end| light * (1.0 + CLEAR) < *end);
    if is_clear {
        low as u8
    } else {
        Color::from_linear([light; 3]).to_rgb8()[0]
    }
}

/// What a pixel is whose samples see several things.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mixed {
    /// The linear light of the samples, divided by their number.
    pub(crate) light: [f64; 3],
    /// Their mean color, or that of those that hit something if the rest is transparent.
    pub(crate) color: Tone,
    /// The part of the samples that hit something.
    pub(crate) coverage: f64,
    /// Which geometries are seen by which part of the samples, the most first; of equally many, the first
    /// in the order of the world. Empty unless it was asked for.
    pub(crate) ranks: Vec<(u32, f64)>,
}

/// Mixes what the samples of pixels see.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mixer<'a> {
    pub(crate) world: &'a World,
    /// Whether samples that hit nothing add nothing, instead of the background.
    pub(crate) is_transparent: bool,
    /// Whether it is wanted which geometries are seen by how many.
    pub(crate) ranks: bool,
}

impl<'a> Mixer<'a> {
    /// A mixer that shows the background where nothing is hit.
    pub(crate) const fn new(world: &'a World) -> Self {
        Self {
            world,
            is_transparent: false,
            ranks: false,
        }
    }
}

/// How many colors a [`Mixer`] remembers as light: neighbours see the same.
const KNOWN: usize = 256;

impl Mixer<'_> {
    /// Returns the mix of each pixel, from the geometries that its samples see, in the order of rows.
    ///
    /// The light of the samples is added in that order and divided by their number, as a sensor
    /// would: display values are no amounts of light, and their mean at an edge of black and white
    /// would show a fifth of the light instead of half of it. If all are of the same color, it is
    /// that color itself.
    pub(crate) fn mix(self, seen: &[u32], samples: usize) -> impl Iterator<Item = Mixed> {
        let mut known = [(None, Color::BLACK, [0.0; 3]); KNOWN];
        seen.chunks_exact(samples).map(move |seen| {
            let mut known = |index: u32| {
                let place = &mut known[index as usize % KNOWN];
                if place.0 != Some(index) {
                    let color = self.color(index);
                    *place = (Some(index), color, color.to_linear());
                }
                (place.1, place.2)
            };
            let mut sum = [0.0; 3];
            let mut hits = 0;
            let (mut first, mut is_one_color) = (None, true);
            let mut last = None;
            for &index in seen {
                hits += u32::from(index != NOTHING);
                if self.is_transparent && index == NOTHING {
                    continue;
                }
                // Samples side by side mostly see the same.
                let (_, light) = match last {
                    Some((same, known)) if same == index => known,
                    _ => {
                        let known = known(index);
                        is_one_color &= first.get_or_insert(known).0 == known.0;
                        last = Some((index, known));
                        known
                    }
                };
                for (sum, light) in sum.iter_mut().zip(light) {
                    *sum += light;
                }
            }
            let of = |count: f64| sum.map(|sum| sum / count);
            let (all, hit) = (samples as f64, f64::from(hits));
            let is_full = !self.is_transparent || hits as usize == samples;
            let (color, light) = match first {
                Some((color, light)) if is_one_color && is_full => (Tone::Display(color), light),
                Some((color, _)) if is_one_color => (Tone::Display(color), of(all)),
                _ if is_full => (Tone::Light(of(all)), of(all)),
                _ => (Tone::Light(of(hit)), of(all)),
            };
            Mixed {
                light,
                color,
                coverage: hit / all,
                ranks: if self.ranks { ranks(seen) } else { Vec::new() },
            }
        })
    }

    fn color(&self, index: u32) -> Color {
        let geometry = self.world.geometries().get(index as usize);
        geometry.map_or(self.world.background(), Geometry::color)
    }
}

/// Which geometries are seen how often.
fn ranks(seen: &[u32]) -> Vec<(u32, f64)> {
    let mut sorted: Vec<u32> = seen
        .iter()
        .copied()
        .filter(|index| *index != NOTHING)
        .collect();
    sorted.sort_unstable();
    let runs = sorted.chunk_by(|one, other| one == other);
    let mut ranks: Vec<_> = runs.map(|run| (run[0], run.len())).collect();
    ranks.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let part = |count: usize| count as f64 / seen.len() as f64;
    ranks
        .into_iter()
        .map(|(index, count)| (index, part(count)))
        .collect()
}

/// At most 256 colors, by their place in the order of the file: the background first, then the
/// geometries.
#[derive(Clone, Debug)]
pub(crate) struct Palette {
    /// The colors, each once.
    pub(crate) colors: Vec<[u8; 3]>,
    /// The place in `colors` for whatever a pixel may see.
    pub(crate) places: ColorTable<1>,
}

impl Palette {
    /// The palette of all that may be seen; `None` if that has too many colors.
    pub(crate) fn of(table: &ColorTable<3>) -> Option<Self> {
        let mut colors = Vec::new();
        let mut known = HashMap::new();
        let places = table.flat.iter().map(|color| {
            let place = *known.entry(*color).or_insert_with(|| {
                colors.push(*color);
                colors.len() - 1
            });
            // The 257th color ends the search.
            u8::try_from(place).ok().map(|place| [place])
        });
        let flat = places.collect::<Option<_>>()?;
        // An indexed picture has one sample a pixel.
        let places = ColorTable {
            flat,
            mixed: |_| [0],
        };
        Some(Self { colors, places })
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::tracer::{
        random::{Rng, cases},
        shape::sphere::Sphere,
    };

    fn table(background: Color, colors: &[Color]) -> ColorTable<3> {
        let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let geometries = colors.iter().map(|color| Geometry::new(ball, *color));
        let world = World::new(geometries.collect(), background);
        ColorTable::rgb8(&world)
    }

    /// Colors that differ as bytes, counted from 0.
    fn number(number: u32) -> Color {
        let [low, high, ..] = number.to_le_bytes();
        Color::new(f64::from(low) / 255.0, f64::from(high) / 255.0, 0.0)
    }

    #[test]
    fn bytes_of_light_are_those_of_its_color() {
        let plain = |light: f64| Color::from_linear([light; 3]).to_rgb8()[0];
        let mut random = Rng(3);
        for _ in 0..cases(20_000) {
            let light = random.magnitude(-6.0, 0.0);
            assert_eq!(byte_of(light), plain(light), "{light}");
        }
        for byte in 0..=255_u8 {
            let end = (f64::from(byte) + 0.5) / 255.0;
            let [end, ..] = Color::new(end, end, end).to_linear();
            for ulps in -40..40_i64 {
                let light = f64::from_bits(end.to_bits().wrapping_add_signed(ulps));
                assert_eq!(byte_of(light), plain(light), "{byte} {ulps}");
            }
        }
        assert_eq!([0.0, 1.0].map(byte_of), [0, 255]);
    }

    #[test]
    fn half_of_black_and_white_is_half_of_the_light() {
        let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let world = World::new(vec![Geometry::new(ball, Color::WHITE)], Color::BLACK);
        let mix = |mixer: Mixer, seen: &[u32]| mixer.mix(seen, 4).next().unwrap();
        let half = mix(Mixer::new(&world), &[0, NOTHING, NOTHING, 0]);
        assert_eq!((half.light, half.coverage), ([0.5; 3], 0.5));
        assert_eq!(half.color.to_rgb8(), [188; 3], "not 128");
        let clear = Mixer {
            is_transparent: true,
            ranks: true,
            world: &world,
        };
        let half = mix(clear, &[0, NOTHING, NOTHING, 0]);
        assert_eq!((half.light, half.coverage), ([0.5; 3], 0.5));
        assert_eq!(
            half.color,
            Tone::Display(Color::WHITE),
            "straight, not premultiplied"
        );
        assert_eq!(half.ranks, [(0, 0.5)]);
    }

    #[test]
    fn one_color_stays_itself() {
        let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let color = Color::new(0.1, 0.2, 0.7);
        let geometry = Geometry::new(ball, color);
        let world = World::new(vec![geometry; 3], Color::BLACK);
        let seen = [0, 1, 2, 1, 0, 0, 0, 2, 2];
        let mixed = Mixer::new(&world).mix(&seen, 9).next().unwrap();
        assert_eq!(mixed.color, Tone::Display(color));
        assert_eq!(mixed.light, color.to_linear());
    }

    #[test]
    fn the_background_is_what_nothing_is() {
        let table = table(Color::WHITE, &[Color::BLACK, number(7)]);
        assert_eq!(table.of(u32::MAX), [255, 255, 255]);
        assert_eq!((table.of(0), table.of(1)), ([0, 0, 0], [7, 0, 0]));
    }

    #[test]
    fn a_palette_is_in_the_order_of_the_file_and_has_each_color_once() {
        let colors = [number(9), Color::WHITE, number(3), number(9)];
        let palette = Palette::of(&table(Color::WHITE, &colors)).unwrap();
        assert_eq!(palette.colors, [[255, 255, 255], [9, 0, 0], [3, 0, 0]]);
        let places = [u32::MAX, 0, 1, 2, 3].map(|index| palette.places.of(index));
        assert_eq!(places, [[0], [1], [0], [2], [1]]);
    }

    #[test]
    fn colors_that_give_the_same_bytes_are_one() {
        let palette = Palette::of(&table(Color::BLACK, &[Color::new(0.001, 0.0, 0.0)]));
        assert_eq!(palette.unwrap().colors.len(), 1);
    }

    #[test]
    fn a_palette_has_at_most_256_colors() {
        let colors: Vec<_> = (0..300).map(number).collect();
        let of = |count| Palette::of(&table(number(0), &colors[..count]));
        assert_eq!(of(256).unwrap().colors.len(), 256);
        assert!(of(257).is_none());
    }
}
