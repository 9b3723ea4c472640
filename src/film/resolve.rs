//! The combined value of several samples of a pixel.

use crate::{
    film::colors::NOTHING,
    tracer::{color::Color, geometry::Geometry, radiance::Radiance, world::World},
};

/// A color in its original form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PixelColor {
    Display(Color),
    Light(Radiance),
}

impl PixelColor {
    /// Returns the color as display values.
    pub(crate) fn color(self) -> Color {
        match self {
            Self::Display(color) => color,
            Self::Light(light) => Color::from_linear(light),
        }
    }

    /// Returns the same bytes as [`Color::to_rgb8`] of [`PixelColor::color`].
    pub(crate) fn to_rgb8(self) -> [u8; 3] {
        match self {
            Self::Display(color) => color.to_rgb8(),
            Self::Light(light) => light.to_rgb8(),
        }
    }
}

/// A pixel whose samples see several things.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Resolved {
    /// The mean linear light of the samples.
    pub(crate) light: Radiance,
    /// The mean color of all samples, or of those that hit something if the background is
    /// transparent.
    pub(crate) color: PixelColor,
    /// The fraction of the samples that hit something.
    pub(crate) coverage: f64,
    /// The geometries that the samples see, with the fraction of the samples for each, largest
    /// first; ties are in the order of the world. Empty unless requested.
    pub(crate) ranks: Vec<(u32, f64)>,
}

/// Combines the samples of pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resolver<'a> {
    pub(crate) world: &'a World,
    /// True if samples that hit nothing add nothing, instead of the background.
    pub(crate) is_transparent: bool,
    /// True if [`Resolved::ranks`] is requested.
    pub(crate) ranks: bool,
}

impl<'a> Resolver<'a> {
    /// Creates a resolver that shows the background where nothing is hit.
    pub(crate) const fn new(world: &'a World) -> Self {
        Self {
            world,
            is_transparent: false,
            ranks: false,
        }
    }
}

/// The number of colors that a [`Resolver`] caches as light, because neighbors see the same ones.
const KNOWN: usize = 256;

impl Resolver<'_> {
    /// Returns the resolved pixels, from the geometries that their samples see, in the order of
    /// rows, and the number of samples of each.
    ///
    /// The light of the samples is added in that order and divided by their number, as in a sensor.
    /// Display values are not amounts of light: their mean at an edge of black and white would show
    /// a fifth of the light instead of half of it. If all samples have the same color, the result
    /// is exactly that color.
    pub(crate) fn resolve(
        self,
        mut seen: &[u32],
        counts: impl Iterator<Item = usize>,
    ) -> impl Iterator<Item = Resolved> {
        let mut known = [(None, Color::BLACK, Radiance::BLACK); KNOWN];
        let of_pixels = counts.map(move |count| {
            let (of_pixel, others) = seen.split_at(count);
            seen = others;
            of_pixel
        });
        of_pixels.map(move |seen| {
            let samples = seen.len();
            let mut known = |index: u32| {
                let place = &mut known[index as usize % KNOWN];
                if place.0 != Some(index) {
                    let color = self.color(index);
                    *place = (Some(index), color, color.to_linear());
                }
                (place.1, place.2)
            };
            let mut sum = Radiance::BLACK;
            let mut hits = 0;
            let (mut first, mut is_one_color) = (None, true);
            let mut last = None;
            for &index in seen {
                hits += u32::from(index != NOTHING);
                if self.is_transparent && index == NOTHING {
                    continue;
                }
                // Adjacent samples mostly see the same geometry.
                let (_, light) = match last {
                    Some((same, known)) if same == index => known,
                    _ => {
                        let known = known(index);
                        is_one_color &= first.get_or_insert(known).0 == known.0;
                        last = Some((index, known));
                        known
                    }
                };
                sum = sum + light;
            }
            let of = |count: f64| sum / count;
            let (all, hit) = (samples as f64, f64::from(hits));
            let is_full = !self.is_transparent || hits as usize == samples;
            let (color, light) = match first {
                Some((color, light)) if is_one_color && is_full => {
                    (PixelColor::Display(color), light)
                }
                Some((color, _)) if is_one_color => (PixelColor::Display(color), of(all)),
                _ if is_full => (PixelColor::Light(of(all)), of(all)),
                _ => (PixelColor::Light(of(hit)), of(all)),
            };
            Resolved {
                light,
                color,
                coverage: hit / all,
                ranks: if self.ranks { ranks(seen) } else { Vec::new() },
            }
        })
    }

    fn color(&self, index: u32) -> Color {
        let geometry = self.world.with_id(index as usize);
        geometry.map_or(self.world.background(), Geometry::color)
    }
}

/// Returns the geometries seen, with the fraction of the samples for each, largest first.
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

#[cfg(test)]
mod tests {
    use std::iter;

    use glam::DVec3;

    use super::*;
    use crate::tracer::shape::sphere::Sphere;

    #[test]
    fn half_black_and_half_white_is_half_the_light() {
        let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let world = World::new(vec![Geometry::new(ball, Color::WHITE)], Color::BLACK);
        let mix = |resolver: Resolver, seen: &[u32]| {
            resolver.resolve(seen, iter::once(4)).next().unwrap()
        };
        let half = mix(Resolver::new(&world), &[0, NOTHING, NOTHING, 0]);
        assert_eq!((half.light.channels, half.coverage), ([0.5; 3], 0.5));
        assert_eq!(half.color.to_rgb8(), [188; 3], "not 128");
        let clear = Resolver {
            is_transparent: true,
            ranks: true,
            world: &world,
        };
        let half = mix(clear, &[0, NOTHING, NOTHING, 0]);
        assert_eq!((half.light.channels, half.coverage), ([0.5; 3], 0.5));
        assert_eq!(
            half.color,
            PixelColor::Display(Color::WHITE),
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
        let mut resolved = Resolver::new(&world).resolve(&seen, iter::once(9));
        let resolved = resolved.next().unwrap();
        assert_eq!(resolved.color, PixelColor::Display(color));
        assert_eq!(resolved.light, color.to_linear());
    }
}
