//! Search for geometries that surround a sphere with the eye inside.

use glam::DVec3;

use crate::{
    scene::{format::scene::Model, tables::Tables},
    tracer::shape::{Shape, sphere::Sphere},
};

/// The geometries around a sphere with the eye inside; nothing is computed before it is needed.
pub(crate) struct Surroundings<'a> {
    model: &'a Model,
    tables: &'a Tables,
    /// The largest radius of the balls that enclose the shapes; infinite if a shape is unbounded.
    largest: Option<f64>,
    /// The last of the largest spheres, and the result for it.
    last: Option<(DVec3, bool)>,
}

impl<'a> Surroundings<'a> {
    /// Creates the search among a scene's geometries and the tables and parts that they name.
    pub(crate) fn new(model: &'a Model, tables: &'a Tables) -> Self {
        Self {
            model,
            tables,
            largest: None,
            last: None,
        }
    }

    fn largest(&mut self) -> f64 {
        if let Some(largest) = self.largest {
            return largest;
        }
        let mut largest = 0.0;
        self.any_shape(|shape| {
            largest = f64::max(largest, shape.extent().radius());
            false
        });
        self.largest = Some(largest);
        largest
    }

    /// Returns true if a geometry lies wholly or partly outside of the sphere.
    pub(crate) fn reach_beyond(&mut self, center: DVec3, radius: f64) -> bool {
        // A larger sphere cannot lie inside of a smaller one, so only the largest are tested
        // against all others; the result for one holds for those equal to it.
        if radius < self.largest() {
            return true;
        }
        match self.last {
            Some((other, beyond)) if other == center => beyond,
            _ => {
                let beyond = self.any_shape(|shape| shape.farthest_from(center) > radius);
                self.last = Some((center, beyond));
                beyond
            }
        }
    }

    /// Returns true if `is_it` does for any shape.
    fn any_shape(&self, mut is_it: impl FnMut(&Shape) -> bool) -> bool {
        let mut shapes = self.model.leaves().filter_map(|leaf| leaf.shape());
        let mut in_parts = self.tables.parts().flat_map(|(_, part)| &part.geometries);
        shapes.any(|shape| is_it(&shape))
            || in_parts.any(|geometry| is_it(geometry.shape()))
            || self.tables.any_block(|block| {
                let mut rows = block.spheres();
                rows.any(|(center, radius, _)| {
                    let sphere = Sphere::new(center.into(), radius);
                    sphere.is_ok_and(|sphere| is_it(&sphere.into()))
                })
            })
    }
}
