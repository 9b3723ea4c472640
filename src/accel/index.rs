//! The index of a shape of many parts, which it is given when a world is prepared.

use crate::{
    accel::{bvh::build::Builder, instances::index_copies, mesh::index_mesh, solid::index_solid},
    tracer::{geometry::Geometry, shape::Shape},
};

/// Gives the shapes of geometries an index, if they may have one.
pub(crate) fn index_shapes<'a>(
    geometries: impl IntoIterator<Item = &'a Geometry>,
    builder: Builder<'_>,
) {
    let geometries = geometries.into_iter();
    geometries.for_each(|geometry| index_shape(geometry.shape(), builder));
}

fn index_shape(shape: &Shape, builder: Builder<'_>) {
    if let Some(mesh) = shape.mesh() {
        index_mesh(mesh, builder);
    }
    if let Some(solid) = shape.solid() {
        index_solid(solid, builder);
    }
    if let Some(copies) = shape.copies() {
        copies
            .shapes()
            .for_each(|shape| index_shape(shape, builder));
        index_copies(copies, builder);
    }
}
