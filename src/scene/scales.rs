//! The values of tables that determine colors.

use crate::{
    scene::{
        format::{color_by::ColorScale, geometry::GeometryModel},
        table::{Table, Values},
    },
    tracer::color::Color,
};

/// The values of a table that determine its colors.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TableValues<'a> {
    /// The index of the geometry that names the table in the scene's list of geometries, from 0.
    pub geometry: usize,
    /// Its name in the scene.
    pub name: Option<&'a str>,
    /// The colors of the values.
    pub scale: &'a ColorScale,
    /// The smallest and the largest finite value; `None` if there is none.
    pub data: Option<[f64; 2]>,
    /// The number of rows without a value.
    pub missing: usize,
}

/// The values of all tables whose colors they determine, in the order of their geometries.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scales(pub(crate) Vec<Scale>);

/// The values of a table.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    geometry: usize,
    /// The index of the first row in the world.
    first: usize,
    colors: ColorScale,
    about: Values,
    values: Vec<f64>,
}

impl Scale {
    /// Creates the scale of a geometry, if values determine its colors. The place is the index of
    /// the geometry in the scene and of its first row in the world.
    pub(crate) fn new(
        model: &GeometryModel,
        table: &Table,
        (geometry, first): (usize, usize),
    ) -> Option<Self> {
        let (by, values) = (model.table()?.color_by.as_ref()?, table.values()?);
        Some(Self {
            geometry,
            first,
            colors: by.build(values.range()),
            about: *values,
            values: Vec::with_capacity(table.rows()),
        })
    }

    /// Adds the value of the next row and returns its color.
    pub(crate) fn add(&mut self, value: f64) -> Color {
        self.values.push(value);
        self.colors.color(value)
    }
}

impl Scales {
    /// Returns each table; `name` returns the name of a geometry of the scene.
    pub(crate) fn tables<'a>(
        &'a self,
        name: impl Fn(usize) -> Option<&'a str>,
    ) -> impl Iterator<Item = TableValues<'a>> {
        self.0.iter().map(move |scale| TableValues {
            geometry: scale.geometry,
            name: name(scale.geometry),
            scale: &scale.colors,
            data: scale.about.range(),
            missing: scale.about.missing,
        })
    }

    /// Returns the value of a geometry of the world, and the colors of its table.
    pub(crate) fn of(&self, index: usize) -> Option<(f64, &ColorScale)> {
        let before = self.0.partition_point(|scale| scale.first <= index);
        let scale = self.0.get(before.checked_sub(1)?)?;
        let value = scale.values.get(index - scale.first)?;
        Some((*value, &scale.colors))
    }
}
