//! The box of a scene file.

use glam::DVec3;

use crate::{
    diagnostic::Code,
    scene::{
        format::geometry::{
            faults::value,
            faults::{number, shown},
            kind::{GeometryKind, colored},
        },
        problem::{Cure, Focus, Problem},
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, cuboid::Cuboid},
    },
};

/// The names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

colored! {
    /// A box along the axes.
    pub struct BoxModel = "Box" {
        /// The corner with the smallest coordinates.
        min | lower: Point,
        /// The corner with the largest coordinates: each is above that of `min`.
        max | upper: Point,
    }
}

impl GeometryKind for BoxModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        Some(Cuboid::new(DVec3::from(self.min), DVec3::from(self.max)).map(Shape::from))
    }

    fn faults(&self) -> Vec<Problem> {
        let (min, max) = (self.min, self.max);
        let is_finite = |axis: &usize| min[*axis].is_finite() && max[*axis].is_finite();
        let axes = (0..3).filter(is_finite);
        let axes: Vec<_> = axes.filter(|axis| max[*axis] <= min[*axis]).collect();
        let (flat, exchanged): (Vec<_>, Vec<_>) =
            axes.into_iter().partition(|axis| max[*axis] == min[*axis]);
        let fault = |axis: usize| {
            let (of_min, of_max) = (number(min[axis]), number(max[axis]));
            let message =
                format!("`max` must be above `min`, which is `{of_min}`, found `{of_max}`");
            Problem::new(
                Code::OutOfRange,
                value("max", [axis]),
                Focus::Value,
                message,
            )
            .label(value("min", [axis]), Focus::Value, "`min`")
        };
        let flat = flat.into_iter().map(|axis| {
            let name = AXES[axis];
            let help =
                format!("a box has a length above 0 along {name}; a flat one is a `Rectangle`");
            fault(axis).help(help)
        });
        let mut faults: Vec<_> = flat.collect();
        // One slip, one fault.
        let fault = match *exchanged {
            [] => return faults,
            [axis] => fault(axis),
            _ => {
                let names: Vec<_> = exchanged.iter().map(|axis| AXES[*axis]).collect();
                let names = match &*names {
                    [one, other] => format!("{one} and {other}"),
                    _ => "x, y and z".to_owned(),
                };
                let message = format!("`max` must be above `min`, found it below along {names}");
                Problem::of_field(Code::OutOfRange, "max", message).beside("min", "`min`")
            }
        };
        let [mut low, mut high] = [min, max];
        for axis in &exchanged {
            (low[*axis], high[*axis]) = (max[*axis], min[*axis]);
        }
        let help = format!("write `min: {}, max: {}`", shown(low), shown(high));
        let pairs = exchanged.iter();
        let pairs = pairs.map(|axis| ["min", "max"].map(|field| value(field, [*axis])));
        faults.push(fault.help(help).cure(Cure::Exchange(pairs.collect())));
        faults
    }
}
