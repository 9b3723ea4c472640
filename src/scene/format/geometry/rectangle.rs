//! The rectangle of a scene file.

use glam::DVec3;

use crate::{
    diagnostic::Code,
    scene::{
        format::geometry::{
            faults::NoArea,
            kind::{GeometryKind, colored},
        },
        problem::Problem,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, rectangle::Rectangle},
        vector::is_direction,
    },
};

colored! {
    /// A parallelogram, seen from both sides.
    pub struct RectangleModel = "Rectangle" {
        /// A corner.
        corner: Point,
        /// The edge from the corner to one of its neighbors.
        edge_u | u: Edge,
        /// The edge from the corner to the other neighbor.
        edge_v | v: Edge,
    } not solid
}

impl GeometryKind for RectangleModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let [corner, u, v] = [&self.corner, &self.edge_u, &self.edge_v].map(|at| DVec3::from(*at));
        Some(Rectangle::new(corner, u, v).map(Shape::from))
    }

    fn faults(&self) -> Vec<Problem> {
        let [u, v] = [&self.edge_u, &self.edge_v].map(|edge| DVec3::from(*edge));
        let edges = [("edge_u", u), ("edge_v", v)].into_iter();
        let short = edges.filter(|(_, edge)| edge.is_finite() && !is_direction(*edge));
        let short = short.map(|(field, _)| {
            let message = format!(
                "`{field}` has no direction, its squared length is 0 or not finite in an f64"
            );
            let help = "give the way from the corner to its neighbor";
            Problem::of_field(Code::ZeroVector, field, message).help(help)
        });
        let have_lengths = is_direction(u) && is_direction(v);
        let no_area = NoArea::of([u, v]).filter(|_| have_lengths);
        let corner = DVec3::from(self.corner);
        let reaches_too_far = corner.is_finite() && !(corner + u + v).is_finite();
        let flat = no_area.map(|reason| {
            let fault = reason.fault("edge_v", "edges", "`edge_u` × `edge_v`");
            let parallel = || {
                let message =
                    "`edge_u` and `edge_v` are parallel, so that the rectangle has no area";
                let help = "give an edge in another direction";
                Problem::of_field(Code::ParallelVectors, "edge_v", message).help(help)
            };
            let fault = fault.unwrap_or_else(parallel);
            fault.beside("edge_u", "the other edge")
        });
        let too_far = (reaches_too_far && u.is_finite() && v.is_finite()).then(|| {
            let message = "the opposite corner is not finite in an f64";
            let fault = Problem::of_field(Code::NotFinite, "corner", message);
            let fault = fault.help("numbers are finite 64-bit floats, up to about 1.8e308");
            let fault = fault.beside("edge_u", "an edge");
            fault.beside("edge_v", "an edge")
        });
        short.chain(flat).chain(too_far).collect()
    }
}
