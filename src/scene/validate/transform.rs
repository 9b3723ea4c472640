//! Checks of transforms.

use super::Found;
use crate::{
    diagnostic::{Code, path::Path},
    scene::{
        format::{
            field::Fields,
            geometry::nesting::Ordinal,
            scene::Model,
            transform::{ScaleModel, TransformModel},
        },
        problem::{Focus, Problem},
        validate::material::both,
    },
    tracer::error::GeometryError,
};

impl Found {
    /// Checks the transform of a geometry at a path.
    pub(super) fn transform(&mut self, transform: &TransformModel, path: &Path) {
        let TransformModel {
            translate,
            rotate,
            scale,
            matrix,
        } = transform;
        let before = self.list.len();
        transform.each(|field, value| self.field(field, value, || path.clone()));
        if let Some(rotate) = rotate {
            let path = path.clone().field("rotate");
            rotate.each(|field, value| self.field(field, value, || path.clone()));
        }
        if let Some(scale) = scale {
            self.scale(scale, path);
        }
        if let Some(matrix) = matrix {
            let place = || path.clone().field("matrix");
            for (row, numbers) in matrix.0.iter().enumerate() {
                for (column, number) in numbers.iter().enumerate() {
                    self.number(*number, || place().index(row).index(column));
                }
            }
            let others = [
                ("translate", translate.is_some()),
                ("rotate", rotate.is_some()),
                ("scale", scale.is_some()),
            ];
            if let Some((other, _)) = others.into_iter().find(|(_, is_given)| *is_given) {
                let problem = both(path, [other, "matrix"]);
                self.push(problem.help(
                    "a matrix holds the scale, the rotation and the shift; leave the others out",
                ));
            }
        }
        if self.list.len() == before
            && let Err(GeometryError::NotInvertible { determinant }) = transform.build()
        {
            let message = format!(
                "this transform cannot be inverted: the determinant of its matrix is {determinant:?} \
                 in an f64"
            );
            let place = match matrix {
                Some(_) => path.clone().field("matrix"),
                None => path.clone(),
            };
            let problem = Problem::new(Code::OutOfRange, place, Focus::Value, message);
            self.push(problem.help("the rows of a matrix must not lie in one plane"));
        }
    }

    /// Checks that the product of the transform of a group with those around it can be inverted. The
    /// places of parts are checked when they are read.
    pub(super) fn placement(&mut self, transform: &TransformModel, at: Ordinal, model: &Model) {
        let group = model
            .leaf(at)
            .filter(|leaf| leaf.geometry.group().is_some());
        let Some(around) = group.map(|group| group.placement) else {
            return;
        };
        if around.transform().is_err() || transform.build().is_err() {
            return;
        }
        if let Err(error) = around.within(Some(transform)).transform() {
            let message = format!("cannot be placed: {error}");
            let place = model.path_of(at).field("transform");
            self.push(Problem::new(Code::OutOfRange, place, Focus::Value, message));
        }
    }

    fn scale(&mut self, scale: &ScaleModel, path: &Path) {
        let path = path.clone().field("scale");
        let factors = match scale {
            ScaleModel::Uniform(factor) => vec![(*factor, path)],
            ScaleModel::Axes(factors) => {
                let factors = factors.iter().enumerate();
                let factors = factors.map(|(axis, factor)| (*factor, path.clone().index(axis)));
                factors.collect()
            }
        };
        for (factor, path) in factors {
            if factor == 0.0 {
                let problem = Problem::of_value(Code::OutOfRange, path, "`scale` must not be 0");
                self.push(problem.help("write a number close to 0 to flatten, such as 0.001"));
            }
        }
    }
}
