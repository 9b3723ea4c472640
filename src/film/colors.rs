//! The colors of pixels as the bytes of a file.

use std::{collections::HashMap, iter, ops::Range};

use crate::{
    film::resolve::Resolved,
    tracer::{color::Color, geometry::Geometry, world::World},
};

/// The index of a pixel or sample that hits no geometry.
pub(crate) const NOTHING: u32 = u32::MAX;

/// The bytes of a pixel for everything that it can show: the background first, then the geometries
/// in file order.
///
/// Geometries are large, so reading colors from them would wait for memory at each pixel. The table
/// is much smaller, and it is built in their memory order.
#[derive(Clone, Debug)]
pub(crate) struct ColorTable<const N: usize> {
    flat: Vec<[u8; N]>,
    resolved: fn(&Resolved) -> [u8; N],
}

impl<const N: usize> ColorTable<N> {
    /// Returns the bytes for a pixel of a film: the index of a geometry, or `u32::MAX` for the
    /// background.
    pub(crate) fn of(&self, index: u32) -> [u8; N] {
        let place = index.wrapping_add(1) as usize;
        self.flat.get(place).copied().unwrap_or([0; N])
    }

    /// Returns the bytes of a pixel whose samples see several things.
    pub(crate) fn resolved(&self, resolved: &Resolved) -> [u8; N] {
        (self.resolved)(resolved)
    }
}

impl ColorTable<3> {
    /// Red, green and blue.
    pub(crate) fn rgb8(world: &World) -> Self {
        let of_one = |geometry: &Geometry| iter::repeat_n(geometry.color(), geometry.count());
        let geometries = world.geometries().iter().flat_map(of_one);
        let colors = iter::once(world.background()).chain(geometries);
        Self {
            flat: colors.map(Color::to_rgb8).collect(),
            resolved: |resolved| resolved.color.to_rgb8(),
        }
    }

    /// Returns the table of a world that differs in the background and in some geometries only.
    pub(crate) fn renewed(&self, world: &World, changed: &[Range<usize>]) -> Self {
        let mut table = self.clone();
        table.flat[0] = world.background().to_rgb8();
        for index in changed.iter().cloned().flatten() {
            let geometry = &world.geometries()[index];
            let first = world.id_of(index, 0) + 1;
            let colors = table.flat.get_mut(first..first + geometry.count());
            colors
                .into_iter()
                .for_each(|colors| colors.fill(geometry.color().to_rgb8()));
        }
        table
    }
}

/// A palette of at most 256 colors in file order: the background first, then the geometries.
#[derive(Clone, Debug)]
pub(crate) struct Palette {
    /// The colors, without duplicates.
    pub(crate) colors: Vec<[u8; 3]>,
    /// The index in `colors` for everything that a pixel can show.
    pub(crate) places: ColorTable<1>,
}

impl Palette {
    /// Returns the palette of a table, or `None` if it has more than 256 colors.
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
        // An indexed picture has one sample per pixel.
        let places = ColorTable {
            flat,
            resolved: |_| [0],
        };
        Some(Self { colors, places })
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::tracer::shape::sphere::Sphere;

    fn table(background: Color, colors: &[Color]) -> ColorTable<3> {
        let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let geometries = colors.iter().map(|color| Geometry::new(ball, *color));
        let world = World::new(geometries.collect(), background);
        ColorTable::rgb8(&world)
    }

    /// Returns the color of a number; different numbers give different bytes.
    fn number(number: u32) -> Color {
        let [low, high, ..] = number.to_le_bytes();
        Color::new(f64::from(low) / 255.0, f64::from(high) / 255.0, 0.0)
    }

    #[test]
    fn the_background_is_where_no_geometry_is_hit() {
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
    fn colors_with_the_same_bytes_share_an_entry() {
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
