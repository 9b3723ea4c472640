//! Geometries of equal kind and numbers, whatever their color.

use std::{
    collections::HashMap,
    mem::{self, Discriminant},
    num::NonZeroU64,
};

use crate::{
    scene::format::{
        geometry::{GeometryModel, PartModel, ordinal::Ordinal, placement::Placement},
        scene::Model,
    },
    tracer::error::GeometryError,
};

/// The search for leaves that equal earlier ones.
pub(crate) struct Duplicates {
    /// The hash of each leaf.
    hashes: Vec<Option<NonZeroU64>>,
    /// False if a leaf is in a group.
    is_flat: bool,
}

impl Duplicates {
    /// Starts the search in a scene.
    pub(crate) fn of(model: &Model) -> Self {
        Self {
            hashes: Vec::with_capacity(model.geometries.len()),
            is_flat: true,
        }
    }

    /// Adds a leaf by its number and its parts: each, in the order of the file.
    #[inline]
    pub(crate) fn add(&mut self, at: Ordinal, geometry: &GeometryModel, placement: &Placement) {
        self.is_flat &= at == Ordinal::from(self.hashes.len());
        self.hashes.push(hash(geometry, placement));
    }

    /// Returns, for each leaf of a scene that equals an earlier one, the number of the first and its
    /// own.
    pub(crate) fn found(self, model: &Model) -> Vec<(Ordinal, Ordinal)> {
        let mut sieve = Sieve::new(self.hashes.len());
        for hash in self.hashes.iter().flatten() {
            sieve.add(*hash);
        }
        // A list without groups is not walked again.
        let places: Vec<_> = match self.is_flat {
            true => Vec::new(),
            false => model.leaves().map(|leaf| leaf.at).collect(),
        };
        let mut firsts = HashMap::new();
        let mut found = Vec::new();
        for (index, hash) in self.hashes.into_iter().enumerate() {
            let Some(hash) = hash.filter(|hash| sieve.keeps(*hash)) else {
                continue;
            };
            let first = *firsts.entry(hash).or_insert(index);
            if first == index {
                continue;
            }
            let place = |index| places.get(index).copied().unwrap_or(Ordinal::from(index));
            let (first, at) = (place(first), place(index));
            let numbers = |at| {
                let leaf = model.leaf(at)?;
                Some(numbers(leaf.geometry, &leaf.placement))
            };
            if numbers(first) == numbers(at) {
                found.push((first, at));
            }
        }
        found
    }
}

/// A filter that keeps the hashes that may have been added twice: some 60,000 of a million
/// different ones. It fits into the cache, unlike a map of all geometries, which made `strahl
/// validate` take 1.5 times as long for a million spheres.
struct Sieve {
    /// For each group of hashes, a bit if one was added, and in the second word a bit if another was.
    words: Vec<[u64; 2]>,
    shift: u32,
}

impl Sieve {
    /// Creates a filter for this many hashes.
    fn new(count: usize) -> Self {
        const BITS_EACH: usize = 16;
        let words = (count * BITS_EACH / 64).next_power_of_two();
        Self {
            words: vec![[0; 2]; words],
            shift: 58 - words.trailing_zeros(),
        }
    }

    /// Returns the word and the bit of a hash, from its highest bits.
    fn place(&self, hash: NonZeroU64) -> (usize, u64) {
        let group = hash.get() >> self.shift;
        ((group >> 6) as usize, 1 << (group & 63))
    }

    fn add(&mut self, hash: NonZeroU64) {
        let (word, bit) = self.place(hash);
        let Some([once, twice]) = self.words.get_mut(word) else {
            return;
        };
        *twice |= *once & bit;
        *once |= bit;
    }

    fn keeps(&self, hash: NonZeroU64) -> bool {
        let (word, bit) = self.place(hash);
        let words = self.words.get(word);
        words.is_some_and(|[_, twice]| twice & bit != 0)
    }
}

/// Returns a hash that equal geometries share and others almost never do; `None` if a number is NaN
/// or infinite. Rows of tables are not compared: data may well hold a point twice.
#[inline]
fn hash(geometry: &GeometryModel, placement: &Placement) -> Option<NonZeroU64> {
    // An odd number without a pattern; any other would do as well.
    const KEY: u64 = 0x9e37_79b9_7f4a_7c15;
    // A part that brings its lights does more than a copy of it.
    let has_lights = geometry.part().is_some_and(PartModel::lights);
    let is_alike = geometry.table().is_none() && !has_lights;
    let (mut sum, mut finite) = (KEY, is_alike);
    let mut add = |bits: u64| {
        // The upper half of a product depends on all bits of both factors.
        let product = u128::from(sum ^ bits) * u128::from(KEY);
        sum = (product as u64) ^ ((product >> 64) as u64);
    };
    let mut see = |number: f64| {
        finite &= number.is_finite();
        add(bits(number));
    };
    geometry.numbers(&mut see);
    place(placement, see).ok()?;
    if let Some(file) = geometry.file() {
        file.bytes().map(u64::from).for_each(add);
    }
    // An `Option` of this takes no more memory than a number.
    NonZeroU64::new(sum | 1).filter(|_| finite)
}

/// Calls `see` with each number of the matrix that places a geometry, if there are transforms.
///
/// # Errors
///
/// A transform that is invalid.
#[inline]
fn place(placement: &Placement, mut see: impl FnMut(f64)) -> Result<(), GeometryError> {
    if let Some(transform) = placement.transform()? {
        let rows = transform.rows();
        rows.iter().flatten().for_each(|number| see(*number));
    }
    Ok(())
}

/// Returns the kind of a geometry, its numbers with those of its place, and its file, which
/// equal geometries share.
fn numbers<'m>(
    geometry: &'m GeometryModel,
    placement: &Placement,
) -> (Discriminant<GeometryModel>, Vec<u64>, Option<&'m str>) {
    let mut numbers = Vec::new();
    geometry.numbers(|number| numbers.push(bits(number)));
    // One that is invalid has no hash.
    let _ = place(placement, |number| numbers.push(bits(number)));
    (mem::discriminant(geometry), numbers, geometry.file())
}

/// Returns the bits of a number: 0 and -0 are equal, and adding 0 makes them the same bits.
fn bits(number: f64) -> u64 {
    (number + 0.0).to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::format::{
        color::ColorModel,
        geometry::{plane::PlaneModel, sphere::SphereModel},
        rare::Rare,
    };

    fn sphere(center: [f64; 3], radius: f64, grey: u8) -> GeometryModel {
        GeometryModel::Sphere(SphereModel {
            center,
            radius,
            color: Some(ColorModel::Hex([grey; 3])),
            material: None,
            rare: Rare::default(),
            name: None,
        })
    }

    fn plane(point: [f64; 3], normal: [f64; 3]) -> GeometryModel {
        GeometryModel::Plane(Box::new(PlaneModel {
            point,
            normal,
            color: Some(ColorModel::Hex([0; 3])),
            texture: None,
            material: None,
            transform: None,
            name: None,
        }))
    }

    fn found(geometries: Vec<GeometryModel>) -> Vec<(usize, usize)> {
        let model = Model {
            geometries,
            ..Model::default()
        };
        let mut duplicates = Duplicates::of(&model);
        for leaf in model.leaves() {
            duplicates.add(leaf.at, leaf.geometry, &leaf.placement);
        }
        let found = duplicates.found(&model).into_iter();
        found.map(|(first, at)| (first.index, at.index)).collect()
    }

    #[test]
    fn equal_numbers_are_found_whatever_the_color() {
        let geometries = [
            sphere([1.0, 2.0, 3.0], 4.0, 0),
            plane([1.0, 2.0, 3.0], [4.0, 0.0, 0.0]),
            sphere([1.0, 2.0, 3.0], 4.0, 1),
            sphere([1.0, 2.0, 3.0], 4.5, 0),
            plane([1.0, 2.0, 3.0], [4.0, -0.0, 0.0]),
            sphere([1.0, 2.0, 3.0], 4.0, 2),
            sphere([f64::NAN, 0.0, 0.0], 1.0, 0),
            sphere([f64::NAN, 0.0, 0.0], 1.0, 0),
        ];
        assert_eq!(found(geometries.to_vec()), [(0, 2), (1, 4), (0, 5)]);
        assert_eq!(found(Vec::new()), []);
    }

    #[test]
    fn a_part_that_brings_lights_is_no_duplicate() {
        let part = |lights| {
            GeometryModel::Part(PartModel {
                file: "room.ron".into(),
                lights,
                transform: None,
                name: None,
            })
        };
        let parts = [None, Some(true), Some(true), Some(false)];
        assert_eq!(found(parts.map(part).to_vec()), [(0, 3)]);
    }

    #[test]
    fn many_that_differ_in_one_number_are_no_duplicates() {
        let geometries: Vec<_> = (0..100_000)
            .map(|index| sphere([0.0, 0.0, f64::from(index)], 1.0, 0))
            .collect();
        assert_eq!(found(geometries), []);
    }
}
