//! The geometries and the background of a scene.

use crate::tracer::{color::Color, geometry::Geometry, hit::Hit, ray::Ray};

/// The geometries and the background of a scene.
///
/// # Examples
///
/// ```
/// use strahl::{Color, Geometry, Ray, Sphere, Vec3, World};
///
/// let red = Color::new(1.0, 0.0, 0.0);
/// let mut world = World::default();
/// world.push(Geometry::new(Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5)?, red));
/// assert_eq!(world.color_of(&Ray::new(Vec3::ZERO, Vec3::NEG_Z)), red);
/// assert_eq!(world.color_of(&Ray::new(Vec3::ZERO, Vec3::Z)), Color::BLACK);
/// # Ok::<(), strahl::GeometryError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct World {
    geometries: Vec<Geometry>,
    background: Color,
}

impl World {
    /// Creates a world of geometries and a background; [`World::default`] is empty and black.
    pub const fn new(geometries: Vec<Geometry>, background: Color) -> Self {
        Self {
            geometries,
            background,
        }
    }

    /// Appends a geometry.
    pub fn push(&mut self, geometry: Geometry) {
        self.geometries.push(geometry);
    }

    /// Returns every field, for callers that must not miss one.
    pub(crate) fn parts(&self) -> (&[Geometry], Color) {
        let Self {
            geometries,
            background,
        } = self;
        (geometries, *background)
    }

    /// The geometries, in file order.
    pub fn geometries(&self) -> &[Geometry] {
        &self.geometries
    }

    /// The color of rays that hit nothing.
    pub const fn background(&self) -> Color {
        self.background
    }

    /// Returns the nearest hit in front of the ray's origin, with the index of the geometry: the
    /// smallest `t` of all geometries. At equal `t` the first geometry wins.
    ///
    /// This plain loop defines every picture.
    pub fn hit(&self, ray: &Ray) -> Option<(usize, Hit<'_>)> {
        self.nearest(ray, f64::INFINITY)
            .map(|(index, geometry, t)| (index, geometry.hit_at(ray, t)))
    }

    /// Returns the index, the geometry and the `t` of [`World::hit`] if `t` is below `t_max`.
    pub(crate) fn nearest(&self, ray: &Ray, t_max: f64) -> Option<(usize, &Geometry, f64)> {
        let mut nearest: Option<(usize, &Geometry, f64)> = None;
        for (index, geometry) in self.geometries.iter().enumerate() {
            let t_max = nearest.map_or(t_max, |(_, _, t)| t);
            if let Some(t) = geometry.shape().intersect(ray, t_max) {
                nearest = Some((index, geometry, t));
            }
        }
        nearest
    }

    /// Returns the color that the ray sees: that of the nearest hit, else the background.
    pub fn color_of(&self, ray: &Ray) -> Color {
        self.hit(ray)
            .map_or(self.background, |(_, hit)| hit.geometry.color())
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::tracer::shape::{plane::Plane, sphere::Sphere};

    const RED: Color = Color::new(1.0, 0.0, 0.0);
    const BLUE: Color = Color::new(0.0, 0.0, 1.0);
    const AHEAD: Ray = Ray::new(DVec3::ZERO, DVec3::NEG_Z);

    fn ball(z: f64, color: Color) -> Geometry {
        Geometry::new(Sphere::new(DVec3::new(0.0, 0.0, z), 1.0).unwrap(), color)
    }

    #[test]
    fn the_smallest_t_wins_whatever_the_order() {
        for geometries in [
            vec![ball(-3.0, RED), ball(-6.0, BLUE)],
            vec![ball(-6.0, BLUE), ball(-3.0, RED)],
        ] {
            let world = World::new(geometries, Color::BLACK);
            assert_eq!(world.hit(&AHEAD).unwrap().1.t, 2.0);
            assert_eq!(world.color_of(&AHEAD), RED);
        }
    }

    #[test]
    fn at_equal_t_the_first_wins() {
        let wall = Plane::new(DVec3::new(0.0, 0.0, -2.0), DVec3::Z).unwrap();
        let world = World::new(
            vec![ball(3.0, RED), Geometry::new(wall, BLUE), ball(-3.0, RED)],
            Color::BLACK,
        );
        let (index, hit) = world.hit(&AHEAD).unwrap();
        assert_eq!((index, hit.t), (1, 2.0));
        assert_eq!(hit.geometry.color(), BLUE);
    }

    #[test]
    fn a_ray_without_a_hit_sees_the_background() {
        let world = World::new(vec![ball(3.0, RED)], BLUE);
        assert_eq!(world.hit(&AHEAD), None);
        assert_eq!(world.color_of(&AHEAD), BLUE);
        assert_eq!(World::default().color_of(&AHEAD), Color::BLACK);
    }
}
