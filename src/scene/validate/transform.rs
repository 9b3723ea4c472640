//! Checks of transforms.

use crate::{
    diagnostic::{Code, path::Path},
    scene::{
        format::{
            geometry::{ordinal::Ordinal, placement::Placement},
            numbers::ScaleModel,
            scene::Model,
            thing::Thing,
            transform::TransformModel,
        },
        problem::{Focus, Problem},
        validate::{found::Found, material::both},
    },
    tracer::{error::GeometryError, transform::Transform},
};

/// Returns the cure of a transform that cannot be inverted.
fn cure(transform: &TransformModel) -> &'static str {
    let Some(matrix) = &transform.matrix else {
        return "write factors of 1e-100 to 1e100";
    };
    let numbers = || matrix.0.iter().flat_map(|[x, y, z, _]| [*x, *y, *z]);
    let largest = numbers().map(f64::abs).fold(0.0, f64::max);
    let of_one = matrix.0.map(|row| row.map(|number| number / largest));
    match Transform::from_rows(of_one) {
        Ok(_) => "the largest number of a matrix must be from 1e-100 to 1e100",
        Err(_) => "the rows of a matrix must not lie in one plane",
    }
}

impl Found {
    /// Checks the transform of a geometry at a path.
    pub(super) fn transform(&mut self, transform: &TransformModel, path: &dyn Fn() -> Path) {
        let TransformModel {
            translate,
            rotate,
            scale,
            matrix,
        } = transform;
        let before = self.list.len();
        transform.each(|field, value| self.field(field, value, path));
        if let Some(rotate) = rotate {
            rotate.each(|field, value| self.field(field, value, || path().field("rotate")));
        }
        if let Some(scale) = scale {
            self.scale(scale, path);
        }
        if let Some(matrix) = matrix {
            let place = || path().field("matrix");
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
                let problem = both(Code::OneOf, &path(), [other, "matrix"]);
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
                Some(_) => path().field("matrix"),
                None => path(),
            };
            let problem = Problem::new(Code::OutOfRange, place, Focus::Value, message);
            self.push(problem.help(cure(transform)));
        }
    }

    /// Checks that the product of the transform of a geometry with those around it can be inverted. The
    /// places of parts are checked when they are read.
    pub(super) fn placement(&mut self, at: Ordinal, model: &Model) {
        let all = model.transforms(at);
        let product = |all: &[&TransformModel]| {
            let around = Placement::default();
            let whole = all
                .iter()
                .fold(around, |outer, inner| outer.within(Some(inner)));
            whole.transform().map(drop)
        };
        let Some((own, around)) = all.split_last() else {
            return;
        };
        if product(around).is_err() || own.build().is_err() {
            return;
        }
        if let Err(error) = product(&all) {
            self.cannot_be_placed(at, model, &error);
        }
    }

    pub(super) fn cannot_be_placed(&mut self, at: Ordinal, model: &Model, error: &GeometryError) {
        let message = format!("cannot be placed: {error}");
        let place = model.path_of(at).field("transform");
        self.push(Problem::new(Code::OutOfRange, place, Focus::Value, message));
    }

    fn scale(&mut self, scale: &ScaleModel, path: &dyn Fn() -> Path) {
        let factors = match scale {
            ScaleModel::Uniform(factor) => vec![(*factor, None)],
            ScaleModel::Axes(factors) => {
                let factors = factors.iter().enumerate();
                factors
                    .map(|(axis, factor)| (*factor, Some(axis)))
                    .collect()
            }
        };
        for (factor, axis) in factors {
            if factor == 0.0 {
                let path = path().field("scale");
                let path = axis.map_or(path.clone(), |axis| path.index(axis));
                let problem = Problem::of_value(Code::OutOfRange, path, "`scale` must not be 0");
                self.push(problem.help("write a number close to 0 to flatten, such as 0.001"));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cure_fits_the_numbers() {
        let factors = "write factors of 1e-100 to 1e100";
        let largest = "the largest number of a matrix must be from 1e-100 to 1e100";
        let plane = "the rows of a matrix must not lie in one plane";
        for (text, expected) in [
            ("(scale: Some(1e200))", Some(factors)),
            ("(scale: Some((1e-200, -1e-200, 1)))", Some(factors)),
            ("(scale: Some((1e100, -1e100, 1e100)))", None),
            ("(scale: Some(1e-100))", None),
            (
                "(matrix: Some(((1e200, 0, 0, 0), (0, 1e200, 0, 0), (0, 0, 1e200, 0))))",
                Some(largest),
            ),
            (
                "(matrix: Some(((0, 1e-200, 0, 0), (1e-200, 0, 0, 0), (0, 0, 1e-200, 0))))",
                Some(largest),
            ),
            (
                "(matrix: Some(((1, 2, 3, 0), (2, 4, 6, 0), (0, 1, 0, 0))))",
                Some(plane),
            ),
            (
                "(matrix: Some(((0, 0, 0, 1), (0, 0, 0, 1), (0, 0, 0, 1))))",
                Some(plane),
            ),
        ] {
            let transform: TransformModel = ron::from_str(text).unwrap();
            let mut found = Found::new(9);
            found.transform(&transform, &|| Path::ROOT);
            let help = found
                .list
                .first()
                .and_then(|problem| problem.diagnostic.help.as_deref());
            assert_eq!(help, expected, "{text}");
        }
    }
}
