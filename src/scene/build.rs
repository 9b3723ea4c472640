//! Builds a world from a model without faults.

use glam::DVec3;

use crate::{
    scene::{
        format::{
            color::ColorModel, light::LightModel, lighting::LightingModel, material::Materials,
            scene::Model,
        },
        names::Names,
        scales::{Scale, Scales},
        table::Table,
        tables::Tables,
    },
    tracer::{
        color::Color,
        error::GeometryError,
        geometry::Geometry,
        material::Material,
        shape::sphere::Sphere,
        world::{Lighting, World},
    },
};

/// Builds the world of a scene. Without tables it reuses the memory of the model: a million spheres
/// are not held twice. The rows of a table replace the geometry that names it; each table is
/// dropped once its rows are built. The names of the geometries are returned in a separate table, and
/// so are the values that determine colors.
pub(crate) fn world(model: Model, mut tables: Tables) -> Result<Built, GeometryError> {
    let background = model
        .background
        .as_ref()
        .map_or(Color::BLACK, ColorModel::build);
    let materials = Materials::of(model.materials.as_ref())?;
    let lighting = lighting(&model)?;
    let lit = |world: World| match lighting {
        Some(lighting) => world.lit(lighting),
        None => world,
    };
    let mut names = Names::default();
    let list = model.geometries.into_iter().enumerate();
    if tables.is_empty() {
        // The sizes are equal, so the elements are replaced in place.
        let geometries = list.filter_map(|(index, mut model)| {
            names.add(index, model.take_name());
            model.build(&materials)
        });
        let geometries = geometries.collect::<Result<_, _>>()?;
        return Ok(Built {
            world: lit(World::new(geometries, background)),
            names,
            scales: Scales::default(),
        });
    }
    let mut scales = Scales::default();
    let rows: usize = tables.iter().map(|(_, table)| table.rows()).sum();
    let mut geometries = Vec::with_capacity(list.len() + rows);
    for (index, mut model) in list {
        names.add(index, model.take_name());
        match tables.take(index) {
            Some(table) => {
                let material = model
                    .surface()
                    .material
                    .map(|material| materials.of_model(material));
                let mut scale = Scale::new(&model, &table, (index, geometries.len()));
                spheres(
                    &table,
                    material.transpose()?.as_ref(),
                    scale.as_mut(),
                    &mut geometries,
                )?;
                scales.0.extend(scale);
            }
            None => geometries.extend(model.build(&materials).transpose()?),
        }
    }
    Ok(Built {
        world: lit(World::new(geometries, background)),
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

/// Builds the lighting of a scene, if it is lit.
fn lighting(model: &Model) -> Result<Option<Lighting>, GeometryError> {
    let Some(lights) = &model.lights else {
        return Ok(None);
    };
    let lights = lights
        .iter()
        .map(LightModel::build)
        .collect::<Result<_, _>>()?;
    let depth = model.lighting.as_ref().and_then(LightingModel::max_depth);
    let max_depth = depth.unwrap_or(Lighting::MAX_DEPTH);
    Ok(Some(Lighting { lights, max_depth }))
}

/// Builds the spheres of a table. The color of a row replaces the first color of the material.
fn spheres(
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
    table.any_block(|block| {
        let mut values = block.values().iter();
        for (center, radius, [r, g, b]) in block.spheres() {
            let color = match (&mut scale, values.next()) {
                (Some(scale), Some(value)) => scale.add(*value),
                _ => Color::new(r, g, b),
            };
            match Sphere::new(DVec3::from(center), radius) {
                Ok(sphere) => {
                    geometries.push(Geometry::new(sphere, of_row(color)));
                }
                Err(error) => refused = Some(error),
            }
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
