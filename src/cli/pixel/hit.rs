//! The part of an explanation that is about the row and the corners that a hit has its color from.

use std::fmt;

use serde::Serialize;
use strahl::{
    Hit, Scene,
    material::{Corners, Interpolation},
    parallel::Cancel,
};

use crate::cli::camera::vector;

/// The cells of the row of a table.
#[derive(Serialize)]
pub(super) struct Columns {
    #[serde(skip_serializing_if = "Vec::is_empty")]
    columns: Vec<ColumnTerms>,
    /// The number of columns that are not listed.
    #[serde(skip_serializing_if = "is_zero")]
    more_columns: usize,
}

#[derive(Serialize)]
struct ColumnTerms {
    name: String,
    text: String,
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes a reference"
)]
const fn is_zero(count: &usize) -> bool {
    *count == 0
}

impl Columns {
    pub(super) fn new(scene: &Scene, id: usize, hit: &Hit<'_>, cancel: &Cancel) -> Self {
        let cells = scene.row_cells_in_file(id, hit.geometry.shape(), cancel);
        let columns = cells.shown.into_iter();
        Self {
            columns: columns
                .map(|(name, text)| ColumnTerms { name, text })
                .collect(),
            more_columns: cells.more,
        }
    }
}

impl fmt::Display for Columns {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut between = "  columns      ";
        for ColumnTerms { name, text } in &self.columns {
            write!(out, "{between}{name} = {text}")?;
            between = ", ";
        }
        match (self.columns.len(), self.more_columns) {
            (0, _) => Ok(()),
            (_, 0) => writeln!(out),
            (_, more) => writeln!(out, ", and {more} more"),
        }
    }
}

/// How the color follows from the corners of a triangle.
#[derive(Serialize)]
pub(super) struct CornerTerms {
    weights: [f64; 3],
    /// The linear light of each corner.
    #[serde(skip_serializing_if = "Option::is_none")]
    light: Option<[[f64; 3]; 3]>,
    /// The value of each corner; `None` for NaN.
    #[serde(skip_serializing_if = "Option::is_none")]
    values: Option<[Option<f64>; 3]>,
}

impl CornerTerms {
    pub(super) fn new(interpolation: &Interpolation<'_>) -> Self {
        let (mut light, mut values) = (None, None);
        match interpolation.corners {
            Corners::Colors(colors) => {
                light = Some(colors.map(|color| [color.r(), color.g(), color.b()]));
            }
            Corners::Values(numbers, _) => {
                values = Some(numbers.map(|value| (!value.is_nan()).then_some(value)));
            }
        }
        Self {
            weights: interpolation.weights,
            light,
            values,
        }
    }
}

impl fmt::Display for CornerTerms {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            out,
            "  weights      (U/D, V/D, W/D) = {}",
            vector(self.weights)
        )?;
        for (name, light) in ["a", "b", "c"].iter().zip(self.light.iter().flatten()) {
            writeln!(out, "  lin({name})       {}", vector(*light))?;
        }
        match self.values {
            Some(values) => {
                let values = values.map(|value| value.unwrap_or(f64::NAN));
                writeln!(out, "  values       {}", vector(values))
            }
            None => Ok(()),
        }
    }
}
