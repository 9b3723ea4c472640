//! Whether something stands around a sphere that the eye is in.

use glam::DVec3;

use crate::{
    scene::{format::geometry::GeometryModel, tables::Tables},
    tracer::shape::Shape,
};

/// What stands around a sphere that the eye is in; nothing is looked at before it is asked for.
pub(crate) struct Surroundings<'a> {
    geometries: &'a [GeometryModel],
    tables: &'a Tables,
    /// Whether there are planes, and the largest radius.
    summary: Option<(bool, f64)>,
    /// The last of the largest spheres, and what was found for it.
    last: Option<(DVec3, bool)>,
}

impl<'a> Surroundings<'a> {
    /// Of a scene's geometries, with the tables that they name.
    pub(crate) fn new(geometries: &'a [GeometryModel], tables: &'a Tables) -> Self {
        Self {
            geometries,
            tables,
            summary: None,
            last: None,
        }
    }

    fn summary(&mut self) -> (bool, f64) {
        if let Some(summary) = self.summary {
            return summary;
        }
        let is_plane = |geometry: &GeometryModel| match geometry.shape() {
            Some(Shape::Plane(_)) => true,
            Some(Shape::Sphere(_)) | None => false,
        };
        let mut largest = 0.0;
        self.any_sphere(|_, radius| {
            largest = f64::max(largest, radius);
            false
        });
        let summary = (self.geometries.iter().any(is_plane), largest);
        self.summary = Some(summary);
        summary
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
                let beyond = self.any_sphere(|c, r| (c - center).length() + r > radius);
                self.last = Some((center, beyond));
                beyond
            }
        }
    }

    /// Whether `is_it` says so of the center and radius of any sphere.
    fn any_sphere(&self, mut is_it: impl FnMut(DVec3, f64) -> bool) -> bool {
        let of_scene = self
            .geometries
            .iter()
            .any(|geometry| match geometry.shape() {
                Some(Shape::Sphere(sphere)) => is_it(sphere.center(), sphere.radius()),
                Some(Shape::Plane(_)) | None => false,
            });
        of_scene
            || self.tables.any_block(|block| {
                let mut spheres = block.spheres();
                spheres.any(|(center, radius, _)| is_it(center.into(), radius))
            })
    }
}
