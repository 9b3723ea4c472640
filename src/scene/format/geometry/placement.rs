//! The place of a geometry in groups that are moved, turned and stretched.

use std::sync::Arc;

use crate::{
    scene::format::transform::TransformModel,
    tracer::{error::GeometryError, shape::Shape, transform::Transform},
};

/// The transforms around a geometry, and their product. It is shared by all geometries of a group.
#[derive(Clone, Debug, Default)]
pub(crate) struct Placement(Option<Arc<Levels>>);

#[derive(Debug)]
struct Levels {
    /// The transforms from outermost to innermost.
    all: Vec<Transform>,
    /// The product of A, B and C is A·(B·C), as that of a part and the transforms in its file.
    product: Result<Arc<Transform>, GeometryError>,
}

impl Placement {
    /// Returns the placement of what is inside of a geometry with a transform.
    #[inline]
    pub(crate) fn within(&self, transform: Option<&TransformModel>) -> Self {
        match transform {
            None => self.clone(),
            Some(transform) => self.and(transform.build()),
        }
    }

    fn and(&self, inner: Result<Transform, GeometryError>) -> Self {
        let mut all = self
            .0
            .as_ref()
            .map_or_else(Vec::new, |levels| levels.all.clone());
        let product = self.transform().map(drop).and(inner).and_then(|inner| {
            let product = all
                .iter()
                .rev()
                .try_fold(inner, |inner, outer| outer.times(&inner));
            all.push(inner);
            product.map(Arc::new)
        });
        Self(Some(Arc::new(Levels { all, product })))
    }

    /// Returns the product of the transforms; `None` without any.
    ///
    /// # Errors
    ///
    /// A transform that is invalid, or a product that cannot be inverted.
    #[inline]
    pub(crate) fn transform(&self) -> Result<Option<&Arc<Transform>>, GeometryError> {
        match &self.0 {
            None => Ok(None),
            Some(levels) => match &levels.product {
                Ok(product) => Ok(Some(product)),
                Err(error) => Err(error.clone()),
            },
        }
    }

    /// Returns true if both are of one group, or of groups without transforms in it.
    pub(crate) fn is_of_group(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            _ => false,
        }
    }

    /// Places a shape.
    ///
    /// # Errors
    ///
    /// Those of [`Placement::transform`].
    #[inline]
    pub(crate) fn place(&self, shape: Shape) -> Result<Shape, GeometryError> {
        match self.transform()? {
            None => Ok(shape),
            Some(transform) => shape.placed(transform),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::shape::sphere::Sphere;
    use glam::DVec3;

    fn transform(text: &str) -> TransformModel {
        ron::from_str(text).unwrap()
    }

    #[test]
    fn the_product_is_from_outermost_to_innermost() {
        let shift = transform("(translate: Some((1, 0, 0)))");
        let double = transform("(scale: Some(2))");
        let [outer, inner] = [(&shift, &double), (&double, &shift)].map(|(outer, inner)| {
            let placement = Placement::default().within(Some(outer)).within(Some(inner));
            let sphere = Sphere::new(DVec3::ONE, 0.5).unwrap();
            let placed = placement.within(None).place(sphere.into()).unwrap();
            placed.transform().unwrap().point(DVec3::ONE)
        });
        assert_eq!(
            (outer, inner),
            (DVec3::new(3.0, 2.0, 2.0), DVec3::new(4.0, 2.0, 2.0))
        );
        let flat = transform("(scale: Some(0))");
        let nowhere = Placement::default()
            .within(Some(&flat))
            .within(Some(&shift));
        assert!(nowhere.transform().is_err());
        assert!(Placement::default().transform().unwrap().is_none());
    }

    // Rounding tells A·(B·C) from (A·B)·C.
    #[test]
    fn the_innermost_product_is_first() {
        let all = [1.1, 0.7, 1.3].map(|scale| {
            transform(&format!(
                "(rotate: Some((axis: (1, {scale}, 3), angle: 20)), scale: Some({scale}))"
            ))
        });
        let built = all.each_ref().map(|one| one.build().unwrap());
        let placement = all
            .iter()
            .fold(Placement::default(), |outer, one| outer.within(Some(one)));
        let expected = built[0].times(&built[1].times(&built[2]).unwrap()).unwrap();
        assert_eq!(**placement.transform().unwrap().unwrap(), expected);
    }
}
