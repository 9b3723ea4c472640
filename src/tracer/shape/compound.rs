//! Several shapes as one, such as the copy of a group.

use std::ptr;

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::Ray,
    shape::{
        Extent, Shape, Standing,
        around::Around,
        face::{Crossing, Faces, Leaving, Own},
        plane::Plane,
        working::{Term, Working},
    },
};

/// Several shapes as one.
///
/// A ray hits what it hits of the shapes alone: the smallest `t`, and at equal `t` the shape that
/// comes first. The faces of all shapes are numbered through, in their order.
#[derive(Clone, Debug)]
pub struct Compound {
    parts: Vec<Part>,
    /// The box and the ball around all of them, if they are bounded.
    around: Option<Around>,
}

/// A shape, and the number that its first face has among all.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    shape: Shape,
    first: u32,
}

impl Compound {
    /// Puts shapes together.
    ///
    /// # Errors
    ///
    /// Returns an error if there is no shape, or if their faces are more than 2³² - 1.
    pub fn new(shapes: impl IntoIterator<Item: Into<Shape>>) -> Result<Self, GeometryError> {
        let mut parts = Vec::new();
        let mut first: u32 = 0;
        for shape in shapes {
            let shape: Shape = shape.into();
            let count = shape.face_count();
            let next = first.checked_add(count);
            parts.push(Part { shape, first });
            first = next.ok_or(GeometryError::OutOfRange {
                name: "number of faces",
                value: f64::from(first) + f64::from(count),
                range: [1.0, f64::from(u32::MAX)],
            })?;
        }
        if parts.is_empty() {
            return Err(GeometryError::NoOperand);
        }
        let arounds: Vec<_> = parts
            .iter()
            .map(|part| Around::shape(&part.shape))
            .collect();
        let around = Around::union(&arounds).filter(Around::is_finite);
        Ok(Self { parts, around })
    }

    /// The shapes, in their order.
    pub fn parts(&self) -> impl ExactSizeIterator<Item = &Shape> {
        self.parts.iter().map(|part| &part.shape)
    }

    /// Returns the number of faces of all shapes.
    pub(crate) fn face_count(&self) -> u32 {
        let last = self.parts.last();
        last.map_or(0, |last| last.first + last.shape.face_count())
    }

    /// Returns the shape that a face belongs to, and its number there.
    pub(crate) fn part_of(&self, face: u32) -> Option<(&Shape, u32)> {
        let behind = self.parts.partition_point(|part| part.first <= face);
        let part = self.parts.get(behind.checked_sub(1)?)?;
        Some((&part.shape, face - part.first))
    }

    pub(crate) fn bounds(&self) -> Option<[DVec3; 2]> {
        self.around?.bounds()
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        let mut farthest: Option<DVec3> = None;
        for shape in self.parts() {
            let point = shape.support(direction)?;
            let is_farther = |other: DVec3| other.dot(direction) >= point.dot(direction);
            farthest = farthest.filter(|other| is_farther(*other)).or(Some(point));
        }
        farthest
    }

    /// Returns the smallest `t` with `0 < t < t_max` at which the ray hits a shape.
    pub fn intersect(&self, ray: &Ray, t_max: f64) -> Option<f64> {
        let met = self.crossings(ray, Leaving::NOTHING).first(t_max)?;
        Some(met.t)
    }

    pub(crate) const FACES: Faces = Faces::Several;

    pub(crate) fn crossings<'a>(
        &'a self,
        ray: &'a Ray,
        leaving: Leaving<'a>,
    ) -> CompoundCrossings<'a> {
        let own = leaving.face.and_then(|face| self.part_of(face));
        CompoundCrossings {
            compound: self,
            ray,
            leaving,
            own: own.map(|(shape, face)| Own::new(shape, face)),
        }
    }

    /// The plane of a face, if its shape is not placed: planes in other spaces are compared here
    /// alone, see [`CompoundCrossings`].
    pub(crate) fn plane(&self, face: u32) -> Option<Plane> {
        let (shape, face) = self.part_of(face)?;
        match shape.transform() {
            None => shape.plane(face),
            Some(_) => None,
        }
    }

    pub(crate) fn normal_on(&self, face: u32, ray: &Ray, t: f64) -> DVec3 {
        match self.part_of(face) {
            Some((shape, face)) => shape.normal_at(ray, Crossing { t, face }),
            None => -ray.direction(),
        }
    }

    /// Returns the working of the shape that the ray hits first.
    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let number = |number: usize| number as f64;
        let shapes = Term::number("shapes", "shapes", number(self.parts.len()));
        let first = self.crossings(ray, Leaving::NOTHING).first(f64::INFINITY);
        let Some(face) = first.map(|crossing| crossing.face) else {
            return Working {
                parts: vec![shapes],
                lines: Vec::new(),
                solutions: Err("the ray misses all shapes"),
                name: None,
            };
        };
        let place = self.parts.partition_point(|part| part.first <= face) - 1;
        let mut working = self.parts[place].shape.working(ray);
        let met = Term::number("shape", "shape", number(place));
        working.parts.splice(0..0, [shapes, met]);
        working
    }

    pub(crate) fn numbers(&self) -> Vec<f64> {
        let mut all = Vec::new();
        for shape in self.parts() {
            shape.each_number(|number| all.push(number));
        }
        all
    }

    pub(crate) fn extent(&self) -> Extent<'static> {
        match &self.around {
            Some(around) => around.extent(),
            None => Extent::EVERYWHERE,
        }
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        let distances = self.parts().map(|shape| shape.farthest_from(point));
        distances.fold(0.0, f64::max)
    }

    pub(crate) fn standing(&self, eye: DVec3) -> Standing {
        let mut all = self.parts().map(|shape| shape.standing(eye));
        all.find(|standing| *standing != Standing::Free)
            .unwrap_or(Standing::Free)
    }
}

/// Copies of one are compared at once.
impl PartialEq for Compound {
    fn eq(&self, other: &Self) -> bool {
        ptr::eq(self, other) || self.parts == other.parts
    }
}

/// The crossings of a ray with several shapes.
///
/// A ray that leaves one of them leaves the same surface of the others as it would if each stood in a
/// scene of its own.
pub(crate) struct CompoundCrossings<'a> {
    compound: &'a Compound,
    ray: &'a Ray,
    leaving: Leaving<'a>,
    /// The face that the ray leaves, if it is one of these.
    own: Option<Own<'a>>,
}

impl CompoundCrossings<'_> {
    /// Returns what the ray leaves of a shape.
    fn leaving(&self, shape: &Shape) -> Leaving<'_> {
        match &self.own {
            Some(own) => own.on(shape),
            None if shape.transform().is_none() => self.leaving,
            None => Leaving::NOTHING,
        }
    }

    /// Returns the first crossing with `0 < t < t_max`.
    #[inline(never)]
    pub(crate) fn first(&self, t_max: f64) -> Option<Crossing> {
        let mut nearest: Option<Crossing> = None;
        for Part { shape, first } in &self.compound.parts {
            let t_max = nearest.map_or(t_max, |nearest| nearest.t);
            if let Some(met) = shape.meet(self.ray, self.leaving(shape), t_max) {
                let face = first + met.face;
                nearest = Some(Crossing { face, ..met });
            }
        }
        nearest
    }

    /// Returns the crossings with `0 < t < t_max`, from near to far.
    pub(crate) fn in_front(&self, t_max: f64) -> impl Iterator<Item = Crossing> + use<> {
        let mut all = Vec::new();
        for Part { shape, first } in &self.compound.parts {
            shape.each_crossing(self.ray, self.leaving(shape), t_max, |met| {
                let face = first + met.face;
                all.push(Crossing { face, ..met });
            });
        }
        all.sort_by(|one, other| one.t.total_cmp(&other.t));
        all.into_iter()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::tracer::{
        shape::{cuboid::Cuboid, disc::Disc, sphere::Sphere},
        transform::Transform,
    };

    fn ball(x: f64) -> Shape {
        Sphere::new(DVec3::new(x, 0.0, 0.0), 1.0).unwrap().into()
    }

    fn cube(x: f64) -> Shape {
        let center = DVec3::new(x, 0.0, 0.0);
        Cuboid::new(center - 1.0, center + 1.0).unwrap().into()
    }

    #[test]
    fn the_nearest_shape_is_hit_and_at_equal_t_the_first() {
        let shape: Shape = Compound::new([ball(0.0), cube(4.0), ball(4.0)])
            .unwrap()
            .into();
        let from = |x| Ray::new(DVec3::new(x, 0.0, 0.0), DVec3::NEG_X);
        let met = |x| {
            shape
                .meet(&from(x), Leaving::NOTHING, f64::INFINITY)
                .unwrap()
        };
        assert_eq!(met(3.0), Crossing { t: 2.0, face: 0 });
        // The cube and the ball are both met at 5.
        let both = met(9.0);
        assert!(both.t == 4.0 && (1..9).contains(&both.face), "{both:?}");
        assert_eq!(shape.normal_at(&from(9.0), both), DVec3::X);
        let mut all = Vec::new();
        shape.each_crossing(&from(9.0), Leaving::NOTHING, 99.0, |at| all.push(at.t));
        assert_eq!(all, [4.0, 4.0, 6.0, 6.0, 8.0, 10.0]);
        let [low, high] = shape.bounds().unwrap();
        assert_eq!((low.x, high.x), (-1.0, 5.0));
        assert_eq!(shape.support(DVec3::NEG_X), Some(DVec3::NEG_X));
    }

    // A ray that leaves one of two discs in a plane leaves the other one too, in the same space only.
    #[test]
    fn flat_faces_are_left_as_in_a_scene() {
        let disc = |x: f64| -> Shape {
            let center = DVec3::new(x, 0.0, 0.0);
            Disc::new(center, DVec3::Z, 1.0).unwrap().into()
        };
        let turn = Transform::new(DVec3::ZERO, Some((DVec3::Y, 0.7)), DVec3::ONE);
        let turn = Arc::new(turn.unwrap());
        let placed = [disc(0.0), disc(0.5)].map(|disc| disc.placed(&turn).unwrap());
        let shape: Shape = Compound::new(placed.into_iter().chain([disc(0.0)]))
            .unwrap()
            .into();
        let ray = Ray::new(DVec3::new(0.1, 0.1, 0.0), DVec3::new(-1e-9, 0.0, -1.0));
        let own = |face| Own::new(&shape, face);
        let met = |face| shape.meet_from(Some(&own(face)), &ray, f64::INFINITY);
        assert_eq!(met(2).map(|met| met.face), Some(0));
        assert_eq!((met(0), met(1)), (None, None));
    }

    #[test]
    fn nothing_is_no_compound() {
        assert!(Compound::new(Vec::<Shape>::new()).is_err());
    }
}
