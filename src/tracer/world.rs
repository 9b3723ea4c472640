//! The geometries, the background and the lights of a scene.

use crate::tracer::{
    color::Color, geometry::Geometry, hit::Hit, light::Light, radiance::Radiance, ray::Ray,
};

/// The geometries, the background and the lights of a scene.
///
/// A world without [`Lighting`] is flat: each geometry shows its color. In a lit world, what a ray
/// sees is [`World::radiance`].
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
    lighting: Option<Lighting>,
}

/// The lights of a world, and how they are evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    /// The lights, in file order.
    pub lights: Vec<Light>,
    /// The largest depth of a ray: that of a camera is at depth 0, and each reflection or
    /// refraction adds 1. A deeper ray sees the background.
    pub max_depth: u32,
}

impl Lighting {
    /// The largest depth of a ray unless told otherwise.
    pub const MAX_DEPTH: u32 = 8;

    /// Creates the lighting of some lights, with [`Lighting::MAX_DEPTH`].
    pub const fn new(lights: Vec<Light>) -> Self {
        Self {
            lights,
            max_depth: Self::MAX_DEPTH,
        }
    }
}

impl World {
    /// Creates a world of geometries and a background; [`World::default`] is empty and black.
    pub const fn new(geometries: Vec<Geometry>, background: Color) -> Self {
        Self {
            geometries,
            background,
            lighting: None,
        }
    }

    /// Returns the world with lights. It is lit even if there are none: dark.
    #[must_use]
    pub fn lit(mut self, lighting: Lighting) -> Self {
        self.lighting = Some(lighting);
        self
    }

    /// Appends a geometry.
    pub fn push(&mut self, geometry: Geometry) {
        self.geometries.push(geometry);
    }

    /// Returns every field, for callers that must not miss one.
    pub(crate) fn parts(&self) -> (&[Geometry], Color, Option<&Lighting>) {
        let Self {
            geometries,
            background,
            lighting,
        } = self;
        (geometries, *background, lighting.as_ref())
    }

    /// The geometries, in file order.
    pub fn geometries(&self) -> &[Geometry] {
        &self.geometries
    }

    /// The color of rays that hit nothing.
    pub const fn background(&self) -> Color {
        self.background
    }

    /// The lights, if the world is lit.
    pub const fn lighting(&self) -> Option<&Lighting> {
        self.lighting.as_ref()
    }

    /// Returns the nearest hit in front of the ray's origin, with the index of the geometry: the
    /// smallest `t` of all geometries. At equal `t` the first geometry wins.
    ///
    /// This plain loop defines every picture.
    pub fn hit(&self, ray: &Ray) -> Option<(usize, Hit<'_>)> {
        self.hit_from(ray, None)
    }

    /// Returns the hit of [`World::hit`] of a ray that leaves the surface of a geometry, whose index
    /// is `own`: at its origin it does not meet this surface.
    pub fn hit_from(&self, ray: &Ray, own: Option<usize>) -> Option<(usize, Hit<'_>)> {
        self.nearest(ray, f64::INFINITY, own)
            .map(|(index, geometry, t)| (index, geometry.hit_at(ray, t)))
    }

    /// Returns the index, the geometry and the `t` of [`World::hit_from`] if `t` is below `t_max`.
    pub(crate) fn nearest(
        &self,
        ray: &Ray,
        t_max: f64,
        own: Option<usize>,
    ) -> Option<(usize, &Geometry, f64)> {
        let own = own.and_then(|own| self.geometries.get(own));
        let own = own.map(Geometry::shape);
        let mut nearest: Option<(usize, &Geometry, f64)> = None;
        for (index, geometry) in self.geometries.iter().enumerate() {
            let t_max = nearest.map_or(t_max, |(_, _, t)| t);
            if let Some(t) = geometry.shape().intersect_from(own, ray, t_max) {
                nearest = Some((index, geometry, t));
            }
        }
        nearest
    }

    /// Returns the part of the light that comes through along a ray with `0 < t < t_max`, which
    /// leaves the surface of the geometry `own`: none if an opaque geometry is in the way, and the
    /// product of what each crossing of glass lets through, in file order and from near to far.
    pub(crate) fn transmission(&self, ray: &Ray, t_max: f64, own: usize) -> Radiance {
        self.crossings(ray, t_max, own)
            .fold(Radiance::WHITE, |light, (_, _, factor)| light * factor)
    }

    /// Returns what is in the way of the light in [`World::transmission`]: the index of a geometry,
    /// the `t` of a crossing, and the part of the light that it lets through.
    pub(crate) fn crossings(
        &self,
        ray: &Ray,
        t_max: f64,
        own: usize,
    ) -> impl Iterator<Item = (usize, f64, Radiance)> {
        let own = self.geometries.get(own).map(Geometry::shape);
        let geometries = self.geometries.iter().enumerate();
        own.into_iter().flat_map(move |own| {
            geometries.clone().flat_map(move |(index, geometry)| {
                let crossings = geometry.shape().crossings_from(own, ray, t_max);
                let crossings = crossings.into_iter().map_while(|t| t);
                crossings.map(move |t| (index, t, geometry.transmission(ray, t)))
            })
        })
    }

    /// Returns the color that the ray sees in a flat world: that of the nearest hit, else the
    /// background.
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
