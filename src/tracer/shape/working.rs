//! What there is to say about a ray and a shape, for whoever wants to follow it by hand.

use glam::DVec3;

/// How the equation of a shape is solved for a ray.
#[derive(Clone, Debug)]
pub struct Working {
    /// What the shape is made of.
    pub parts: Vec<Term>,
    /// The terms of its equation, in lines.
    pub lines: Vec<Vec<Term>>,
    /// Every `t` that solves it, wherever that lies; else why there is none.
    pub solutions: Result<Vec<f64>, &'static str>,
    /// The name that the solutions have among data, where they are more than the one `t`.
    pub name: Option<&'static str>,
}

/// A number or a vector of an equation.
#[derive(Clone, Debug)]
pub struct Term {
    /// What it is called among data.
    pub name: &'static str,
    /// What it is called on paper.
    pub symbol: &'static str,
    /// One number, or x, y and z of a vector.
    pub numbers: Vec<f64>,
}

impl Term {
    pub(crate) fn number(name: &'static str, symbol: &'static str, number: f64) -> Self {
        let numbers = vec![number];
        Self {
            name,
            symbol,
            numbers,
        }
    }

    pub(crate) fn vector(name: &'static str, symbol: &'static str, vector: DVec3) -> Self {
        let numbers = vector.to_array().to_vec();
        Self {
            name,
            symbol,
            numbers,
        }
    }
}
