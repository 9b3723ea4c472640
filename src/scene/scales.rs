//! The values of tables and meshes that determine colors.

use std::sync::Arc;

use crate::{
    data::table::{Table, Values},
    scene::{
        format::geometry::GeometryModel,
        origin::Origin,
        origins::Origins,
        part::{PartPlace, Places},
    },
    tracer::{
        color::Color, colormap::scale::ColorScale, material::binding::VertexColors, world::World,
    },
};

/// The values of a table or a mesh that determine its colors.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ColorValues<'a> {
    /// The place in the scene of the geometry that names the file of the values; of one in a part, the
    /// place of the part.
    pub origin: Origin,
    /// Its name in the scene.
    pub name: Option<&'a str>,
    /// The place of the geometry in the file of a part, the innermost one; `None` if the scene names
    /// the file itself.
    pub part: Option<PartPlace<'a>>,
    /// The colors of the values.
    pub scale: &'a ColorScale,
    /// The smallest and the largest finite value; `None` if there is none.
    pub data: Option<[f64; 2]>,
    /// The number of rows or vertices without a value.
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

    /// Replaces the values of the table whose first row has an index in the world.
    pub(crate) fn replace(&mut self, first: usize, scale: Scale) {
        let found = self.0.iter_mut().find(|placed| placed.first == first);
        if let Some(placed) = found {
            placed.scale = scale.into();
        }
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

    /// Returns the values of each table and each mesh, in the order of the world; `origins` are those
    /// of the scene.
    pub(crate) fn all<'a>(
        &'a self,
        world: &'a World,
        origins: &'a Origins,
    ) -> Vec<ColorValues<'a>> {
        let tables = self.0.iter().map(|placed| {
            let part = placed.part.as_ref();
            let part = part.map(|(part, origin)| part.at(origin.clone()));
            let colors = &placed.scale.colors;
            let values = of(placed.origin.clone(), part, colors, &placed.scale.about);
            (placed.first, values)
        });
        let geometries = world
            .has_varying_materials()
            .then(|| world.geometries().iter());
        let meshes = geometries.into_iter().flatten().enumerate();
        let meshes = meshes.filter_map(|(index, geometry)| {
            let index = world.id_of(index, 0);
            let (_, binding) = geometry.parts();
            // Copies have the colors of a mesh that is there as well.
            let vertices = binding
                .vertices()
                .filter(|_| geometry.shape().copies().is_none());
            let Some(VertexColors::Values(values, colors)) = vertices else {
                return None;
            };
            let part = origins.innermost_part_of(index);
            let part = part.map(|(part, index)| part.at(part.origins.of(index)));
            let about = Values::of(values);
            Some((index, of(origins.of(index), part, colors, &about)))
        });
        let mut all: Vec<_> = tables.chain(meshes).collect();
        all.sort_by_key(|(index, _)| *index);
        let named = all.into_iter().map(|(_, mut values)| {
            values.name = origins.names_at(&values.origin).0;
            values
        });
        named.collect()
    }

    /// Returns the value of a geometry of the world, and the colors of its table.
    pub(crate) fn of(&self, index: usize) -> Option<(f64, &ColorScale)> {
        let before = self.0.partition_point(|placed| placed.first <= index);
        let placed = self.0.get(before.checked_sub(1)?)?;
        let value = placed.scale.values.get(index - placed.first)?;
        Some((*value, &placed.scale.colors))
    }
}

/// Returns the values of a table or a mesh, without its name in the scene.
fn of<'a>(
    origin: Origin,
    part: Option<PartPlace<'a>>,
    scale: &'a ColorScale,
    about: &Values,
) -> ColorValues<'a> {
    ColorValues {
        origin,
        name: None,
        part,
        scale,
        data: about.range(),
        missing: about.missing,
    }
}
