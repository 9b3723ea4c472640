//! Builds a world from a model without faults.

use crate::{
    scene::{
        format::{
            color::ColorModel, geometry::GeometryModel, light::LightModel, lighting::LightingModel,
            material::Materials, scene::Model,
        },
        names::Names,
        scales::{Scale, Scales},
        table::Table,
        tables::{Content, Tables},
    },
    tracer::{
        color::Color,
        error::GeometryError,
        geometry::Geometry,
        material::Material,
        world::{Lighting, World},
    },
};

/// Builds the world of a scene. The names of the geometries are returned in a separate table, and so
/// are the values that determine colors.
pub(crate) fn world(model: Model, tables: Tables) -> Result<Built, GeometryError> {
    let background = model
        .background
        .as_ref()
        .map_or(Color::BLACK, ColorModel::build);
    let materials = Materials::of(model.materials.as_ref())?;
    let lighting = lighting(&model, &tables)?;
    let BuiltList {
        geometries,
        names,
        scales,
    } = geometries(model.geometries, &materials, tables)?;
    let world = World::new(geometries, background);
    Ok(Built {
        world: match lighting {
            Some(lighting) => world.lit(lighting),
            None => world,
        },
        names,
        scales,
    })
}

/// A world with what belongs to its geometries.
pub(crate) struct Built {
    pub(crate) world: World,
    pub(crate) names: Names,
    pub(crate) scales: Scales,
}

/// Geometries with what belongs to them.
pub(crate) struct BuiltList {
    pub(crate) geometries: Vec<Geometry>,
    pub(crate) names: Names,
    pub(crate) scales: Scales,
}

/// Builds the geometries of a scene. Without tables and parts this reuses the memory of the list: a
/// million spheres are not held twice. The rows of a table, and the geometries of a part, replace
/// the geometry that names it; each table is dropped once its rows are built.
pub(crate) fn geometries(
    list: Vec<GeometryModel>,
    materials: &Materials,
    mut tables: Tables,
) -> Result<BuiltList, GeometryError> {
    let mut names = Names::default();
    let list = list.into_iter().enumerate();
    if tables.is_empty() {
        // The sizes are equal, so the elements are replaced in place.
        let geometries = list.filter_map(|(index, mut model)| {
            names.add(index, model.take_name());
            model.build(materials)
        });
        return Ok(BuiltList {
            geometries: geometries.collect::<Result<_, _>>()?,
            names,
            scales: Scales::default(),
        });
    }
    let mut scales = Scales::default();
    let more: usize = tables.contents().map(|(_, content)| content.count()).sum();
    let mut geometries = Vec::with_capacity(list.len() + more);
    for (index, mut model) in list {
        names.add(index, model.take_name());
        match tables.take(index) {
            Some(Content::Table(table)) => {
                let material = model
                    .surface()
                    .material
                    .map(|material| materials.of_model(material));
                let first = geometries.len();
                let mut scale = Scale::new(&model, &table);
                rows(
                    &table,
                    material.transpose()?.as_ref(),
                    scale.as_mut(),
                    &mut geometries,
                )?;
                if let Some(scale) = scale {
                    scales.add(index, first, scale);
                }
            }
            Some(Content::Part { part, .. }) => {
                scales.add_part(index, geometries.len(), &part.places);
                geometries.extend_from_slice(&part.geometries);
            }
            None => geometries.extend(model.build(materials).transpose()?),
        }
    }
    Ok(BuiltList {
        geometries,
        names,
        scales,
    })
}

/// Builds the lighting of a scene, if it is lit: its own lights, then those of its parts.
fn lighting(model: &Model, tables: &Tables) -> Result<Option<Lighting>, GeometryError> {
    let mut of_parts = tables.lights().peekable();
    if model.lights.is_none() && of_parts.peek().is_none() {
        return Ok(None);
    }
    let own = model.lights.iter().flatten();
    let mut lights: Vec<_> = own.map(LightModel::build).collect::<Result<_, _>>()?;
    lights.extend(of_parts.flatten().map(|(_, light)| *light));
    let depth = model.lighting.as_ref().and_then(LightingModel::max_depth);
    let max_depth = depth.unwrap_or(Lighting::MAX_DEPTH);
    Ok(Some(Lighting { lights, max_depth }))
}

/// Builds the rows of a table. The color of a row replaces the first color of the material.
fn rows(
    table: &Table,
    material: Option<&Material>,
    mut scale: Option<&mut Scale>,
    geometries: &mut Vec<Geometry>,
) -> Result<(), GeometryError> {
    let of_row = |color: Color| match material {
        None => Material::Matte(color),
        Some(material) if material.color() == color => material.clone(),
        Some(material) => material.with_color(color),
    };
    let mut refused = None;
    table.any_row(|row| {
        let [r, g, b] = row.color;
        let color = match (&mut scale, row.value) {
            (Some(scale), Some(value)) => scale.add(value),
            _ => Color::new(r, g, b),
        };
        match row.shape {
            Ok(shape) => geometries.push(Geometry::new(shape, of_row(color))),
            Err(error) => refused = Some(error),
        }
        refused.is_some()
    });
    refused.map_or(Ok(()), Err)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::format::geometry::{GeometryModel, sphere::SphereModel};

    #[test]
    fn a_world_takes_over_the_memory_of_its_model() {
        let sphere = |index: u32| {
            GeometryModel::Sphere(SphereModel {
                center: [0.0, 0.0, f64::from(index)],
                radius: 1.0,
                color: Some(ColorModel::BLACK),
                material: None,
                name: (index == 5).then(|| Box::new("five".into())),
            })
        };
        let model = Model {
            geometries: (0..9).map(sphere).collect(),
            ..Model::default()
        };
        let before = model.geometries.as_ptr().addr();
        let Built { world, names, .. } = world(model, Tables::default()).unwrap();
        assert_eq!(world.geometries().len(), 9);
        assert_eq!(world.geometries().as_ptr().addr(), before);
        assert_eq!((names.of(5), names.of(4)), (Some("five"), None));
    }
}
