//! Numbers of a scene file that belong together.

use std::fmt;

use glam::DVec3;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error as _, SeqAccess, Visitor},
};

/// A point or a direction: x, y and z.
pub type Triple = [f64; 3];

/// A range of numbers: the smaller and the larger one.
pub type Interval = [f64; 2];

/// The factor of all lengths, or the factors along x, y and z.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ScaleModel {
    /// The factor of all lengths.
    Uniform(f64),
    /// The factors along x, y and z.
    Axes(Triple),
}

impl ScaleModel {
    /// What is expected where one is read, as messages say it.
    pub(crate) const EXPECTED: &str = "a number or three numbers";

    /// Returns the factors along x, y and z.
    pub(crate) fn factors(&self) -> DVec3 {
        match self {
            Self::Uniform(factor) => DVec3::splat(*factor),
            Self::Axes(factors) => DVec3::from(*factors),
        }
    }
}

impl<'de> Deserialize<'de> for ScaleModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ScaleVisitor;

        impl<'de> Visitor<'de> for ScaleVisitor {
            type Value = ScaleModel;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(ScaleModel::EXPECTED)
            }

            fn visit_f64<E>(self, factor: f64) -> Result<ScaleModel, E> {
                Ok(ScaleModel::Uniform(factor))
            }

            fn visit_u64<E>(self, factor: u64) -> Result<ScaleModel, E> {
                Ok(ScaleModel::Uniform(factor as f64))
            }

            fn visit_i64<E>(self, factor: i64) -> Result<ScaleModel, E> {
                Ok(ScaleModel::Uniform(factor as f64))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<ScaleModel, A::Error> {
                elements(seq, &self).map(ScaleModel::Axes)
            }
        }

        deserializer.deserialize_any(ScaleVisitor)
    }
}

/// Reads the elements of an array.
#[inline]
pub(crate) fn elements<
    'de,
    A: SeqAccess<'de>,
    T: Deserialize<'de> + Default + Copy,
    const N: usize,
>(
    mut seq: A,
    expected: &dyn serde::de::Expected,
) -> Result<[T; N], A::Error> {
    let mut all = [T::default(); N];
    for (index, element) in all.iter_mut().enumerate() {
        *element = seq
            .next_element()?
            .ok_or_else(|| A::Error::invalid_length(index, expected))?;
    }
    Ok(all)
}
