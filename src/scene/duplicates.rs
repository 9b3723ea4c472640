//! Geometries of equal kind and numbers, whatever their color.

use std::{
    collections::{HashMap, hash_map::Entry},
    mem::Discriminant,
};

use crate::scene::format::geometry::GeometryModel;

/// For each geometry that is equal to an earlier one, the index of the first and its own.
pub(crate) fn duplicates(geometries: &[GeometryModel]) -> Vec<(usize, usize)> {
    let mut first = HashMap::with_capacity(geometries.len());
    let mut found = Vec::new();
    for (index, geometry) in geometries.iter().enumerate() {
        let Some(numbers) = numbers(geometry) else {
            continue;
        };
        match first.entry(numbers) {
            Entry::Vacant(entry) => _ = entry.insert(index),
            Entry::Occupied(entry) => found.push((*entry.get(), index)),
        }
    }
    found
}

/// The kind and the bits of the numbers of a geometry; `None` if a number is NaN or infinite. The rows of
/// tables are not compared: data may well hold a point twice.
fn numbers(
    geometry: &GeometryModel,
) -> Option<(Discriminant<GeometryModel>, [u64; GeometryModel::NUMBERS])> {
    let (variant, numbers) = geometry.numbers()?;
    let finite = numbers.iter().all(|number| number.is_finite());
    // 0 and -0 are equal; adding 0 makes them the same bits.
    finite.then(|| (variant, numbers.map(|number| (number + 0.0).to_bits())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::format::{
        color::ColorModel,
        geometry::{plane::PlaneModel, sphere::SphereModel},
    };

    fn sphere(center: [f64; 3], radius: f64, grey: u8) -> GeometryModel {
        GeometryModel::Sphere(SphereModel {
            center,
            radius,
            color: ColorModel::Hex([grey; 3]),
            name: None,
        })
    }

    fn plane(point: [f64; 3], normal: [f64; 3]) -> GeometryModel {
        GeometryModel::Plane(PlaneModel {
            point,
            normal: normal.into(),
            color: ColorModel::Hex([0; 3]),
            name: None,
        })
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
        assert_eq!(duplicates(&geometries), [(0, 2), (1, 4), (0, 5)]);
        assert_eq!(duplicates(&[]), []);
    }

    #[test]
    fn many_that_differ_in_one_number_are_no_duplicates() {
        let geometries: Vec<_> = (0..100_000)
            .map(|index| sphere([0.0, 0.0, f64::from(index)], 1.0, 0))
            .collect();
        assert_eq!(duplicates(&geometries), []);
    }
}
