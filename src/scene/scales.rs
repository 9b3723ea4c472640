//! The values of tables that determine colors.

use std::sync::Arc;

use crate::{
    scene::{
        format::{color_by::ColorScale, geometry::GeometryModel},
        origin::Origin,
        part::{PartPlace, Places},
        table::{Table, Values},
    },
    tracer::color::Color,
};

/// The values of a table that determine its colors.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TableValues<'a> {
    /// The index of the geometry that names the table in the scene's list of geometries, from 0; of
    /// a table in a part, the index of the part.
    pub geometry: usize,
    /// Its name in the scene.
    pub name: Option<&'a str>,
    /// The place of the geometry in the file of a part, the innermost one; `None` if the scene names
    /// the table itself.
    pub part: Option<PartPlace<'a>>,
    /// The colors of the values.
    pub scale: &'a ColorScale,
    /// The smallest and the largest finite value; `None` if there is none.
    pub data: Option<[f64; 2]>,
    /// The number of rows without a value.
    pub missing: usize,
}

/// The values of all tables whose colors they determine, in the order of their geometries.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scales(Vec<Placed>);

/// The values of a table, and its place in a scene.
#[derive(Clone, Debug)]
struct Placed {
    geometry: usize,
    /// The index of the first row in the world.
    first: usize,
    part: Option<Arc<InPart>>,
    scale: Arc<Scale>,
}

/// The place of a geometry that names a table in the file of a part.
#[derive(Debug)]
struct InPart {
    file: Box<str>,
    geometry: usize,
    name: Option<Box<str>>,
}

/// The values of a table.
#[derive(Debug)]
pub(crate) struct Scale {
    colors: ColorScale,
    about: Values,
    values: Vec<f64>,
}

impl Scale {
    /// Creates the scale of a geometry, if values determine its colors.
    pub(crate) fn new(model: &GeometryModel, table: &Table) -> Option<Self> {
        let (by, values) = (model.color_by()?, table.values()?);
        Some(Self {
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
    /// Adds the values of a table: the index of the geometry that names it, and of its first row in
    /// the world.
    pub(crate) fn add(&mut self, geometry: usize, first: usize, scale: Scale) {
        self.0.push(Placed {
            geometry,
            first,
            part: None,
            scale: scale.into(),
        });
    }

    /// Adds the tables of a part, which are not copied.
    pub(crate) fn add_part(&mut self, geometry: usize, first: usize, part: &Places) {
        let place = |placed: &Placed| InPart {
            file: part.file.clone(),
            geometry: placed.geometry,
            name: part.names.of(placed.geometry).map(Into::into),
        };
        self.0.extend(part.scales.0.iter().map(|placed| Placed {
            geometry,
            first: first + placed.first,
            part: Some(placed.part.clone().unwrap_or_else(|| place(placed).into())),
            scale: Arc::clone(&placed.scale),
        }));
    }

    /// Returns each table; `name` returns the name of a geometry of the scene.
    pub(crate) fn tables<'a>(
        &'a self,
        name: impl Fn(usize) -> Option<&'a str>,
    ) -> impl Iterator<Item = TableValues<'a>> {
        self.0.iter().map(move |placed| TableValues {
            geometry: placed.geometry,
            name: name(placed.geometry),
            part: placed.part.as_ref().map(|part| PartPlace {
                file: &part.file,
                origin: Origin {
                    geometry: part.geometry,
                    row: None,
                },
                name: part.name.as_deref(),
            }),
            scale: &placed.scale.colors,
            data: placed.scale.about.range(),
            missing: placed.scale.about.missing,
        })
    }

    /// Returns the value of a geometry of the world, and the colors of its table.
    pub(crate) fn of(&self, index: usize) -> Option<(f64, &ColorScale)> {
        let before = self.0.partition_point(|placed| placed.first <= index);
        let placed = self.0.get(before.checked_sub(1)?)?;
        let value = placed.scale.values.get(index - placed.first)?;
        Some((*value, &placed.scale.colors))
    }
}
