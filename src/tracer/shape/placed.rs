//! A shape seen through a transform.

use std::sync::Arc;

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        Membership, Shape,
        around::Around,
        axis::outward,
        contact::{ContactPoint, NearFace},
        face::{Crossing, Leaving},
        working::{Term, Working},
    },
    transform::Transform,
};

/// A shape that is mapped by a transform, created by [`Shape::placed`].
///
/// A ray meets it where the ray that is mapped back meets the shape: `o' = L⁻¹·(o - s)`, `d' =
/// L⁻¹·d`, which is not normalized, so that `t` is the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// Not a placed one.
    shape: Shape,
    transform: Arc<Transform>,
    /// The box and the ball outside of which a crossing does not count: mapping back magnifies the
    /// rounding errors of the shape's equation, and with them how far from it they find crossings.
    /// `None` if the shape is unbounded or too large for f64; then every crossing counts.
    around: Option<Around>,
}

impl Shape {
    /// Returns the shape mapped by a transform. A shape that is placed already has the product of
    /// both transforms then, and one under the identity is not placed at all.
    ///
    /// # Errors
    ///
    /// Returns an error if the product cannot be inverted.
    pub fn placed(self, transform: &Arc<Transform>) -> Result<Self, GeometryError> {
        match self {
            Self::Placed(placed) => {
                let product = transform.times(&placed.transform)?;
                Ok(place(placed.shape.clone(), Arc::new(product)))
            }
            Self::Instances(copies) => Ok(copies.placed(transform)?.into()),
            shape => Ok(place(shape, Arc::clone(transform))),
        }
    }

    /// Returns the shape before it is placed, if it is.
    #[inline]
    pub(crate) fn unplaced(&self) -> &Self {
        match self {
            Self::Placed(placed) => &placed.shape,
            shape => shape,
        }
    }

    /// Returns the transform that the shape is placed by, if any.
    pub fn transform(&self) -> Option<&Transform> {
        match self {
            Self::Placed(placed) => Some(&placed.transform),
            _ => None,
        }
    }
}

impl Placed {
    /// The shape before it is mapped.
    pub const fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The transform.
    pub fn transform(&self) -> &Transform {
        &self.transform
    }

    /// Returns the smallest box around a solid: [`Solid::smallest_box`](super::solid::Solid).
    pub(crate) fn smallest_box_of_solid(&self) -> Option<[DVec3; 2]> {
        match &self.shape {
            Shape::Solid(solid) => solid.smallest_box(Some(&self.transform)),
            _ => None,
        }
    }

    pub(crate) const fn around(&self) -> Option<Around> {
        self.around
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        self.around?;
        let along = self.transform.steepest(direction);
        Some(self.transform.point(self.shape.support(along)?))
    }

    pub(crate) const fn crossings<'a>(
        &'a self,
        ray: &'a Ray,
        leaving: Leaving<'a>,
    ) -> PlacedCrossings<'a> {
        PlacedCrossings {
            placed: self,
            ray,
            leaving,
        }
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        self.shape.each_face_near(&at.before(&self.transform), see);
    }

    pub(crate) fn normal_on(&self, face: u64, ray: &Ray, t: f64) -> DVec3 {
        let inner = self.transform.ray_back(ray);
        let normal = self.shape.normal_at(&inner, Crossing { t, face });
        outward(self.transform.normal(normal), ray)
    }

    pub(crate) fn weights_at(&self, ray: &Ray, face: u64) -> Option<[f64; 3]> {
        self.shape.weights_at(&self.transform.ray_back(ray), face)
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let mut working = self.shape.working(&self.transform.ray_back(ray));
        let (terms, line) = placement_terms(&self.transform, ray);
        working.parts.splice(0..0, terms);
        working.lines.insert(0, line);
        if let (Some(around), Ok(solutions)) = (&self.around, &mut working.solutions) {
            solutions.retain(|t| around.holds(ray, *t));
            if solutions.is_empty() {
                working.solutions = Err("the ray misses it");
            }
        }
        working
    }

    pub(crate) fn numbers(&self) -> Vec<f64> {
        let mut all = self.transform.rows().as_flattened().to_vec();
        self.shape.each_number(|number| all.push(number));
        all
    }

    /// Returns an upper bound: the shape lies in a box and in a ball.
    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        let around = self.around.as_ref();
        around.map_or(f64::INFINITY, |around| around.farthest_from(point))
    }

    pub(crate) fn membership(&self, eye: DVec3) -> Membership {
        match (
            self.shape.membership(self.transform.point_back(eye)),
            &self.around,
        ) {
            (Membership::Inside(..), Some(around)) => around.inside(),
            (membership, _) => membership,
        }
    }
}

/// Returns a transform and the ray that it maps back, for readers who want to check them.
pub(super) fn placement_terms(transform: &Transform, ray: &Ray) -> ([Term; 4], Vec<Term>) {
    let inner = transform.ray_back(ray);
    let rows = transform.rows();
    let row = |axis: usize| DVec3::new(rows[axis][0], rows[axis][1], rows[axis][2]);
    let matrix = [
        Term::vector("matrix_x", "L", row(0)),
        Term::vector("matrix_y", "and", row(1)),
        Term::vector("matrix_z", "and", row(2)),
        Term::vector("shift", "s", DVec3::from(rows.map(|[.., shift]| shift))),
    ];
    let line = vec![
        Term::vector("inner_origin", "o'", inner.origin()),
        Term::vector("inner_direction", "d'", inner.direction()),
    ];
    (matrix, line)
}

/// The crossings of a ray with a placed shape.
pub(crate) struct PlacedCrossings<'a> {
    placed: &'a Placed,
    ray: &'a Ray,
    leaving: Leaving<'a>,
}

impl PlacedCrossings<'_> {
    /// Returns the first crossing with `0 < t < t_max`.
    ///
    /// Not inlined: the loops over all shapes are for those that are tested in a few operations.
    #[inline(never)]
    pub(crate) fn first(&self, t_max: f64) -> Option<Crossing> {
        let inner = self.placed.transform.ray_back(self.ray);
        let first = self.placed.shape.meet(&inner, self.leaving, t_max)?;
        match self.counts(&first) {
            true => Some(first),
            false => self.in_front(t_max).next(),
        }
    }

    /// Returns the crossings with `0 < t < t_max`, from near to far.
    pub(crate) fn in_front(&self, t_max: f64) -> impl Iterator<Item = Crossing> + use<> {
        let inner = self.placed.transform.ray_back(self.ray);
        let mut all = Vec::new();
        let see = |crossing| all.push(crossing);
        self.placed
            .shape
            .each_crossing(&inner, self.leaving, t_max, see);
        all.retain(|crossing| self.counts(crossing));
        all.into_iter()
    }

    fn counts(&self, crossing: &Crossing) -> bool {
        let around = self.placed.around.as_ref();
        around.is_none_or(|around| around.holds(self.ray, crossing.t))
    }
}

/// Several shapes to be placed by the same transforms, which share their products.
pub(crate) struct Placer {
    /// From outermost to innermost.
    levels: Vec<Level>,
}

/// A transform of a [`Placer`].
struct Level {
    transform: Arc<Transform>,
    /// The last transform of a shape that was placed by it, and their product.
    last: Option<[Arc<Transform>; 2]>,
}

impl Placer {
    /// Creates a placer by transforms, from outermost to innermost.
    pub(crate) fn new(transforms: &[Arc<Transform>]) -> Self {
        let levels = transforms.iter().map(|transform| Level {
            transform: Arc::clone(transform),
            last: None,
        });
        Self {
            levels: levels.collect(),
        }
    }

    /// Returns the product of the transforms, if there are any.
    ///
    /// # Errors
    ///
    /// Returns an error if it cannot be inverted.
    pub(crate) fn transform(&self) -> Result<Option<Arc<Transform>>, GeometryError> {
        let mut levels = self.levels.iter().rev().map(|level| &level.transform);
        let Some(innermost) = levels.next() else {
            return Ok(None);
        };
        let product = levels.try_fold(Arc::clone(innermost), |inner, level| {
            level.times(&inner).map(Arc::new)
        });
        product.map(Some)
    }

    /// Places a shape by the innermost transform first: their product is `A·(B·C)`.
    ///
    /// # Errors
    ///
    /// Returns an error if a product cannot be inverted.
    pub(crate) fn place(&mut self, shape: Shape) -> Result<Shape, GeometryError> {
        let (shape, mut transform) = match shape {
            Shape::Placed(placed) => (placed.shape.clone(), Some(Arc::clone(&placed.transform))),
            Shape::Instances(mut copies) => {
                for level in self.levels.iter().rev() {
                    copies = copies.placed(&level.transform)?.into();
                }
                return Ok(Shape::Instances(copies));
            }
            shape => (shape, None),
        };
        for level in self.levels.iter_mut().rev() {
            let Some(inner) = transform else {
                transform = Some(Arc::clone(&level.transform));
                continue;
            };
            let known = level
                .last
                .as_ref()
                .filter(|[of, _]| Arc::ptr_eq(of, &inner));
            let product = match known {
                Some([_, product]) => Arc::clone(product),
                None => {
                    let product = Arc::new(level.transform.times(&inner)?);
                    level.last = Some([inner, Arc::clone(&product)]);
                    product
                }
            };
            transform = Some(product);
        }
        Ok(match transform {
            Some(transform) => place(shape, transform),
            None => shape,
        })
    }
}

/// Places a shape that is not placed.
fn place(shape: Shape, transform: Arc<Transform>) -> Shape {
    if transform.is_identity() {
        return shape;
    }
    let around = Around::shape(&shape).and_then(|around| around.mapped(&transform));
    let placed = Placed {
        shape,
        transform,
        around,
    };
    placed.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::shape::sphere::Sphere;

    fn transform(shift: DVec3, scale: DVec3) -> Arc<Transform> {
        Arc::new(Transform::new(shift, None, scale).unwrap())
    }

    fn ball() -> Shape {
        Sphere::new(DVec3::ZERO, 1.0).unwrap().into()
    }

    #[test]
    fn a_stretched_ball_is_met_where_it_should_be() {
        let wide = transform(DVec3::new(0.0, 0.0, -8.0), DVec3::new(4.0, 1.0, -2.0));
        let shape = ball().placed(&wide).unwrap();
        let ray = Ray::new(DVec3::ZERO, DVec3::NEG_Z * 2.0);
        let met = shape.meet(&ray, Leaving::NOTHING, f64::INFINITY).unwrap();
        assert_eq!((met.t, shape.normal_at(&ray, met)), (3.0, DVec3::Z));
        let [low, high] = shape.bounds().unwrap();
        assert!(
            (low - DVec3::new(-4.0, -1.0, -10.0)).length() < 1e-12,
            "{low}"
        );
        assert!(
            (high - DVec3::new(4.0, 1.0, -6.0)).length() < 1e-12,
            "{high}"
        );
        assert_eq!(shape.support(DVec3::X), Some(DVec3::new(4.0, 0.0, -8.0)));
        let eye = DVec3::new(3.5, 0.0, -8.0);
        assert!(matches!(shape.membership(eye), Membership::Inside(..)));
        assert_eq!((shape.kind(), shape.has_faces()), ("sphere", false));
        // What is read out begins with the ray that is mapped back.
        let working = shape.working(&ray);
        assert_eq!(working.lines[0][0].numbers, [0.0, 0.0, -4.0]);
        assert_eq!(working.solutions, Ok(vec![3.0, 5.0]));
    }

    #[test]
    fn the_identity_places_nothing_and_products_are_shared() {
        let none = transform(DVec3::ZERO, DVec3::ONE);
        assert_eq!(ball().placed(&none), Ok(ball()));
        let (outer, inner) = (
            transform(DVec3::X, DVec3::splat(3.0)),
            transform(DVec3::Y, DVec3::splat(2.0)),
        );
        let mut placer = Placer::new(&[outer.clone(), inner.clone()]);
        let [one, other] = [0, 1].map(|_| match placer.place(ball()).unwrap() {
            Shape::Placed(placed) => placed,
            shape => panic!("{shape:?}"),
        });
        assert!(Arc::ptr_eq(&one.transform, &other.transform));
        assert_eq!(*one.transform(), outer.times(&inner).unwrap());
        let nested = ball().placed(&inner).unwrap().placed(&outer).unwrap();
        assert_eq!(nested, Shape::Placed(one));
    }
}
