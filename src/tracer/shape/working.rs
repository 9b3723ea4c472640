//! The intersection of a ray and a shape, for readers who want to check it by hand.

use std::borrow::Cow;

use glam::DVec3;

/// The solution of a shape's equation for a ray.
#[derive(Clone, Debug)]
pub struct Working {
    /// The form of the shape beyond its numbers: the operands of a solid, or `open`.
    pub form: Option<String>,
    /// The parameters of the shape.
    pub parts: Vec<Term>,
    /// The terms of the equation, by line.
    pub lines: Vec<Vec<Term>>,
    /// Every `t` that solves the equation, in any range, or the reason why there is none.
    pub solutions: Result<Vec<f64>, &'static str>,
    /// The name of the solutions in data, if they are more than the one `t`.
    pub name: Option<&'static str>,
}

/// Returns the form of a shape with two ends.
pub(crate) fn open(is_capped: bool) -> Option<String> {
    (!is_capped).then(|| "open".to_owned())
}

/// A number or a vector in an equation.
#[derive(Clone, Debug)]
pub struct Term {
    /// The name in data.
    pub name: Cow<'static, str>,
    /// The symbol on paper.
    pub symbol: Cow<'static, str>,
    /// One number, or the x, y and z of a vector.
    pub numbers: Vec<f64>,
}

impl Term {
    pub(crate) fn number(
        name: impl Into<Cow<'static, str>>,
        symbol: impl Into<Cow<'static, str>>,
        number: f64,
    ) -> Self {
        let numbers = vec![number];
        Self {
            name: name.into(),
            symbol: symbol.into(),
            numbers,
        }
    }

    pub(crate) fn vector(
        name: impl Into<Cow<'static, str>>,
        symbol: impl Into<Cow<'static, str>>,
        vector: DVec3,
    ) -> Self {
        let numbers = vector.to_array().to_vec();
        Self {
            name: name.into(),
            symbol: symbol.into(),
            numbers,
        }
    }
}
