//! Whether something stands around a sphere that the eye is in.

use glam::DVec3;

use crate::{scene::model::GeometryModel, tracer::vector::is_direction};

/// What stands around a sphere that the eye is in; nothing is looked at before it is asked for.
pub(crate) struct Surroundings<'a> {
    geometries: &'a [GeometryModel],
    /// Whether there are planes, and the largest radius.
    summary: Option<(bool, f64)>,
    /// The last of the largest spheres, and what was found for it.
    last: Option<(DVec3, bool)>,
}

impl<'a> Surroundings<'a> {
    /// Of a scene's geometries.
    pub(crate) fn new(geometries: &'a [GeometryModel]) -> Self {
        Self {
            geometries,
            summary: None,
            last: None,
        }
    }

    fn summary(&mut self) -> (bool, f64) {
        let is_plane = |geometry: &GeometryModel| match geometry {
            GeometryModel::Plane { normal, .. } => is_direction(DVec3::from(*normal)),
            GeometryModel::Sphere { .. } => false,
        };
        *self.summary.get_or_insert_with(|| {
            let planes = self.geometries.iter().any(is_plane);
            let radii = spheres(self.geometries).map(|(_, radius)| radius);
            (planes, radii.fold(0.0, f64::max))
        })
    }

    /// Whether a geometry lies wholly or partly outside of the sphere.
    pub(crate) fn reach_beyond(&mut self, center: DVec3, radius: f64) -> bool {
        // A larger sphere cannot lie inside of a smaller one, so that only the largest are held
        // against all others; and what was found for one is true for those equal to it.
        let (planes, largest) = self.summary();
        if planes || radius < largest {
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
