//! The values of tables that determine colors.

use std::sync::Arc;

use crate::{
    scene::{
        format::{color_by::ColorScale, geometry::GeometryModel},
        origin::{Origin, Origins},
        part::{PartPlace, Places},
        table::{Table, Values},
    },
    tracer::color::Color,
};

/// The values of a table that determine its colors.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TableValues<'a> {
    /// The place in the scene of the geometry that names the table; of a table in a part, the place
    /// of the part.
    pub origin: Origin,
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
    origin: Origin,
    /// The index of the first row in the world.
    first: usize,
    /// The innermost part that holds the table, and the place in its file.
    part: Option<(Arc<Places>, Origin)>,
    scale: Arc<Scale>,
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
        let (by, values) = (model.table()?.color_by.as_ref()?, table.values()?);
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
    /// Adds the values of a table: the place of the geometry that names it, and the index of its
    /// first row in the world.
    pub(crate) fn add(&mut self, origin: Origin, first: usize, scale: Scale) {
        self.0.push(Placed {
            origin,
            first,
            part: None,
            scale: scale.into(),
        });
    }

    /// Adds the tables of a part, which are not copied.
    pub(crate) fn add_part(&mut self, origin: &Origin, first: usize, part: &Arc<Places>) {
        let place = |placed: &Placed| (Arc::clone(part), placed.origin.clone());
        self.0.extend(part.scales.0.iter().map(|placed| Placed {
            origin: origin.clone(),
            first: first + placed.first,
            part: Some(placed.part.clone().unwrap_or_else(|| place(placed))),
            scale: Arc::clone(&placed.scale),
        }));
    }

    /// Returns each table; `origins` are those of the scene.
    pub(crate) fn tables<'a>(
        &'a self,
        origins: &'a Origins,
    ) -> impl Iterator<Item = TableValues<'a>> {
        self.0.iter().map(|placed| TableValues {
            origin: placed.origin.clone(),
            name: origins.names_at(&placed.origin).0,
            part: placed.part.as_ref().map(|(part, origin)| {
                let (name, groups) = part.origins.names_at(origin);
                PartPlace {
                    file: &part.file,
                    origin: origin.clone(),
                    name,
                    groups,
                }
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
