//! Fields that few of many things have.

/// Fields that few of many things have: in a box, where any is given.
#[derive(Clone, Debug, Default)]
pub struct Rare<T>(Option<Box<T>>);

impl<T> Rare<T> {
    /// Returns the fields, if any is given.
    #[inline]
    pub(crate) fn get(&self) -> Option<&T> {
        self.0.as_deref()
    }

    /// Returns the fields for a change.
    pub(crate) fn get_or_insert(&mut self) -> &mut T
    where
        T: Default,
    {
        self.0.get_or_insert_default()
    }
}

impl<T> From<T> for Rare<T> {
    fn from(fields: T) -> Self {
        Some(fields).into()
    }
}

impl<T> From<Option<T>> for Rare<T> {
    #[inline]
    fn from(fields: Option<T>) -> Self {
        Self(fields.map(Box::new))
    }
}

/// A box in which no field is given equals none.
impl<T: Default + PartialEq> PartialEq for Rare<T> {
    fn eq(&self, other: &Self) -> bool {
        match (self.get(), other.get()) {
            (Some(one), Some(other)) => one == other,
            (Some(fields), None) | (None, Some(fields)) => *fields == T::default(),
            (None, None) => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crate::scene::format::{
        geometry::{GeometryModel, SphereModel, SphereRest},
        texture::{CheckerModel, TextureModel},
    };

    use super::*;

    fn sphere(rare: Rare<SphereRest>) -> SphereModel {
        SphereModel {
            center: [0.0; 3],
            radius: 1.0,
            color: None,
            material: None,
            rare,
            name: None,
        }
    }

    fn checker(size: f64) -> Rare<SphereRest> {
        let checker = CheckerModel {
            size: Some(size),
            ..CheckerModel::default()
        };
        let rest = SphereRest {
            texture: Some(Arc::new(TextureModel::Checker(checker))),
            transform: None,
        };
        rest.into()
    }

    #[test]
    fn an_empty_box_equals_none() {
        let none = sphere(Rare::default());
        let mut emptied = sphere(checker(1.0));
        assert_ne!(emptied, none);
        assert_ne!(none, emptied);
        emptied.texture = None;
        assert!(emptied.rare.get().is_some());
        assert_eq!(emptied, none);
        assert_eq!(none, emptied);
        assert_ne!(sphere(checker(1.0)), sphere(checker(2.0)));
        assert_eq!(sphere(SphereRest::default().into()), none);
    }

    #[test]
    fn a_sphere_without_rare_fields_has_no_box() {
        let mut model = GeometryModel::Sphere(sphere(Rare::default()));
        let other = GeometryModel::Sphere(sphere(checker(1.0)));
        model.share_material(&other);
        assert!(model.texture_mut().is_none() && model.take_name().is_none());
        let GeometryModel::Sphere(sphere) = model else {
            unreachable!("it is a sphere");
        };
        assert!(sphere.rare.get().is_none());
        assert!(sphere.texture.is_none() && sphere.transform.is_none());
    }

    #[test]
    fn equal_textures_are_shared() {
        let [first, mut second, mut third] =
            [1.0, 1.0, 2.0].map(|size| GeometryModel::Sphere(sphere(checker(size))));
        second.share_material(&first);
        third.share_material(&first);
        let texture = |model: &GeometryModel| model.surface().texture.map(Arc::as_ptr);
        assert_eq!(texture(&first), texture(&second));
        assert_ne!(texture(&first), texture(&third));
    }
}
