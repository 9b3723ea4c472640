//! Whether something stands around a sphere that the eye is in.

use glam::DVec3;

use crate::{scene::model::GeometryModel, tracer::vector::is_direction};

/// What stands around a sphere that the eye is in.
pub(crate) struct Surroundings<'a> {
    geometries: &'a [GeometryModel],
    planes: bool,
    largest: f64,
    /// The last of the largest spheres, and what was found for it.
    last: Option<(DVec3, bool)>,
}

impl<'a> Surroundings<'a> {
    /// Of a scene's geometries.
    pub(crate) fn new(geometries: &'a [GeometryModel]) -> Self {
        let is_plane = |geometry: &GeometryModel| match geometry {
            GeometryModel::Plane { normal, .. } => is_direction(DVec3::from(*normal)),
            GeometryModel::Sphere { .. } => false,
        };
        Self {
            geometries,
            planes: geometries.iter().any(is_plane),
            largest: spheres(geometries)
                .map(|(_, radius)| radius)
                .fold(0.0, f64::max),
            last: None,
        }
    }

    /// Whether a geometry lies wholly or partly outside of the sphere.
    pub(crate) fn reach_beyond(&mut self, center: DVec3, radius: f64) -> bool {
        // A larger sphere cannot lie inside of a smaller one, so that only the largest are held
        // against all others; and what was found for one is true for those equal to it.
        if self.planes || radius < self.largest {
            return true;
        }
        match self.last {
            Some((other, beyond)) if other == center => beyond,
            _ => {
                let is_beyond = |(c, r): (DVec3, f64)| (c - center).length() + r > radius;
                let beyond = spheres(self.geometries).any(is_beyond);
                self.last = Some((center, beyond));
                beyond
            }
        }
    }
}

/// The center and radius of every sphere.
fn spheres(geometries: &[GeometryModel]) -> impl Iterator<Item = (DVec3, f64)> {
    geometries.iter().filter_map(|geometry| match geometry {
        GeometryModel::Sphere { center, radius, .. } => Some((DVec3::from(*center), *radius)),
        GeometryModel::Plane { .. } => None,
    })
}
