//! Builds a world from a model without faults.

use std::{collections::HashMap, ops::Range, sync::Arc};

use crate::{
    data::table::Table,
    parallel::Cancel,
    scene::{
        copies::Prototypes,
        format::{
            backdrop::BackdropModel,
            color::ColorModel,
            geometry::{
                GeometryModel, GroupModel, kind::CopiesModel, ordinal::Ordinal,
                placement::Placement, walk::Leaf,
            },
            light::LightModel,
            material::Materials,
            scene::Model,
        },
        origin::Origin,
        origins::{Origins, SpanContent},
        scales::{Scale, Scales},
        tables::{Content, Tables},
    },
    tracer::{
        color::Color,
        error::GeometryError,
        geometry::Geometry,
        material::{Material, texture::MappedTexture},
        world::{Lighting, World},
    },
};

/// Builds the world of a scene. The names and origins of the geometries are returned apart, and so are
/// the values that determine colors. Once cancelled, the world lacks some geometries.
pub(crate) fn world(
    model: Model,
    tables: Tables,
    cancel: Option<&Cancel>,
) -> Result<Built, GeometryError> {
    let materials = Materials::of(model.materials.as_ref())?;
    let surroundings = surroundings(&model, &tables)?;
    let list = geometries(model.geometries, &materials, tables, cancel)?;
    let mut world = World::new(list.geometries, Color::BLACK);
    world.surround(surroundings);
    Ok(Built {
        world,
        origins: list.origins,
        scales: list.scales,
    })
}

/// A world with what belongs to its geometries.
pub(crate) struct Built {
    pub(crate) world: World,
    pub(crate) origins: Origins,
    pub(crate) scales: Scales,
}

/// Geometries with what belongs to them.
pub(crate) struct BuiltList {
    pub(crate) geometries: Vec<Geometry>,
    pub(crate) origins: Origins,
    pub(crate) scales: Scales,
}

/// Builds the geometries of a scene. Without tables, parts and groups this reuses the memory of the
/// list: a million spheres are not held twice. The rows of a table, and the geometries of a part or
/// a group, replace the geometry that names or holds them; each table is dropped once its rows are
/// built. Once cancelled, it ends, and some geometries are missing.
pub(crate) fn geometries(
    list: Vec<GeometryModel>,
    materials: &Materials,
    tables: Tables,
    cancel: Option<&Cancel>,
) -> Result<BuiltList, GeometryError> {
    let mut origins = Origins::default();
    let mut several = Vec::new();
    let mut count = 0;
    // The sizes are equal, so the elements are replaced in place.
    let geometries = list
        .into_iter()
        .take_while(|_| !cancel.is_some_and(Cancel::is_cancelled))
        .enumerate()
        .filter_map(|(index, mut model)| {
            origins.add_name(index, model.take_name());
            let mut built = model.build(materials);
            if model.transform().is_some() {
                let placement = Placement::default().within(model.transform());
                built = built.map(|built| built.and_then(|built| placed(built, &placement)));
            }
            match built {
                Some(_) => count += 1,
                None => several.push((count, index, model)),
            }
            built
        });
    let geometries: Vec<_> = geometries.collect::<Result<_, _>>()?;
    if several.is_empty() {
        return Ok(BuiltList {
            geometries,
            origins,
            scales: Scales::default(),
        });
    }
    let of_files: usize = tables.contents().map(|(_, content)| content.count()).sum();
    let mut builder = Builder {
        materials,
        tables,
        scales: Scales::default(),
        all: Vec::with_capacity(geometries.len() + of_files),
        ids: 0,
        cancel,
    };
    let mut geometries = geometries.into_iter();
    let mut taken = 0;
    for (before, index, model) in several {
        builder.all.extend(geometries.by_ref().take(before - taken));
        builder.ids += before - taken;
        taken = before;
        let (origin, placement) = (Origin::of(index), Placement::default());
        let (indices, content) = builder.content(model, &mut index.into(), &origin, &placement)?;
        origins.add(index, indices, content);
    }
    builder.all.extend(geometries);
    Ok(BuiltList {
        geometries: builder.all,
        origins,
        scales: builder.scales,
    })
}

/// Follows a change of some leaves of a scene in its tables, parts and copies.
///
/// # Errors
///
/// The first part that f64 cannot place as it is asked. The copies are made anyway.
pub(crate) fn renew(
    model: &Model,
    tables: &mut Tables,
    changed: &[Ordinal],
) -> Result<(), GeometryError> {
    let placed = changed.iter().try_for_each(|at| tables.renew(*at, model));
    let copies = changed.iter().filter_map(|at| {
        let named = model.geometry(*at)?.copies()?;
        tables.copies(*at).map(|_| (*at, named))
    });
    copy(model, tables, copies.collect(), |_, _| true);
    placed
}

/// Replaces some leaves of a scene, given with the indices of their geometries in a world, by what they
/// are now; so are the background, the backdrop and the lights. The values of tables follow. Returns false, and leaves
/// the world unfinished, if a leaf has another number of geometries now.
///
/// # Errors
///
/// Those of [`world`].
pub(crate) fn replace(
    changed: &[(Ordinal, Range<usize>)],
    (model, tables): (&Model, &Tables),
    world: &mut World,
    scales: &mut Arc<Scales>,
) -> Result<bool, GeometryError> {
    let materials = Materials::of(model.materials.as_ref())?;
    world.surround(surroundings(model, tables)?);
    for changed in changed.chunk_by(|(one, _), (next, _)| one.index == next.index) {
        let mut changed = changed.iter().peekable();
        let index = changed.peek().map_or(0, |(at, _)| at.index);
        for leaf in model.leaves_in(index.into()) {
            let Some((_, indices)) = changed.next_if(|(at, _)| *at == leaf.at) else {
                continue;
            };
            let mut built = Vec::new();
            let scale = add_leaf(&leaf, tables, &materials, &mut built)?;
            if built.len() != indices.len() {
                return Ok(false);
            }
            if let Some(scale) = scale {
                Arc::make_mut(scales).replace(world.id_of(indices.start, 0), scale);
            }
            world.replace(indices.start, built);
        }
    }
    Ok(true)
}

/// Adds lists of copies to the tables and parts of a scene, which have been read. `admits` is asked before
/// each list, with the number of shapes that it is.
pub(crate) fn copy(
    model: &Model,
    tables: &mut Tables,
    lists: Vec<(Ordinal, CopiesModel)>,
    mut admits: impl FnMut(Ordinal, usize) -> bool,
) {
    if lists.is_empty() {
        return;
    }
    let mut prototypes = Prototypes::new(model);
    let mut built: HashMap<Ordinal, Vec<Geometry>> = HashMap::new();
    for (at, named) in lists {
        // What is invalid has its own diagnostics.
        let Ok(of) = prototypes.of(named.of, at) else {
            continue;
        };
        let prototype = built
            .entry(of)
            .or_insert_with(|| prototype(model, tables, of).unwrap_or_default());
        let inside = prototype.iter().map(|geometry| geometry.shape().total());
        if !admits(at, inside.fold(1, usize::saturating_add)) {
            continue;
        }
        tables.add_copies(at, named, prototype);
    }
}

/// Builds a geometry in its own space, without what is around it; a table, a part and a group are
/// several.
fn prototype(model: &Model, tables: &Tables, at: Ordinal) -> Result<Vec<Geometry>, GeometryError> {
    let materials = Materials::of(model.materials.as_ref())?;
    let own = model.geometry(at).and_then(GeometryModel::transform);
    let outer = model.transforms(at).len() - usize::from(own.is_some());
    let mut all = Vec::new();
    for leaf in model.leaves_in(at) {
        match tables.get(leaf.at) {
            Some(Content::Part {
                read, transforms, ..
            }) if outer > 0 => {
                let inner = transforms.get(outer..).unwrap_or_default();
                all.extend(read.placed(inner)?.geometries);
            }
            _ => drop(add_leaf(&leaf, tables, &materials, &mut all)?),
        }
    }
    Ok(all)
}

/// The building of geometries that stand for several.
struct Builder<'a> {
    materials: &'a Materials,
    tables: Tables,
    scales: Scales,
    /// The geometries of the world so far.
    all: Vec<Geometry>,
    /// The number of their ids.
    ids: usize,
    cancel: Option<&'a Cancel>,
}

impl Builder<'_> {
    /// Builds the geometries that one of the scene stands for: a table, a part, a group or instances.
    /// Returns their indices in the world and what they are. `at` is its number, and afterwards that of
    /// the last one inside of it.
    fn content(
        &mut self,
        model: GeometryModel,
        at: &mut Ordinal,
        origin: &Origin,
        placement: &Placement,
    ) -> Result<(Range<usize>, SpanContent), GeometryError> {
        let first = self.ids;
        let placement = &placement.within(model.transform());
        let found = self.tables.take(*at);
        if let Some(content) = &found {
            let (materials, all) = (self.materials, &mut self.all);
            let scale = add(content, &model, placement, materials, all, self.cancel)?;
            if let Some(scale) = scale {
                self.scales.add(origin.clone(), first, scale);
            }
            if let Some(part) = content.part() {
                self.scales.add_part(origin, first, &part.places);
            }
            self.ids += content.count();
        }
        let content = match (found, model) {
            (Some(content), _) => content.into_span(),
            (None, GeometryModel::Group(group)) => {
                SpanContent::Group(self.group(group, at, origin, placement)?)
            }
            // A table or a part that was not read, or copies of nothing.
            (None, _) => SpanContent::Group(Origins::default()),
        };
        Ok((first..self.ids, content))
    }

    fn group(
        &mut self,
        group: GroupModel,
        at: &mut Ordinal,
        origin: &Origin,
        placement: &Placement,
    ) -> Result<Origins, GeometryError> {
        let first = self.ids;
        let mut origins = Origins::default();
        for (index, mut model) in group.geometries.into_iter().enumerate() {
            if self.cancel.is_some_and(Cancel::is_cancelled) {
                break;
            }
            at.inner += 1;
            origins.add_name(index, model.take_name());
            match model.build(self.materials) {
                Some(geometry) => {
                    let placement = placement.within(model.transform());
                    self.all.push(placed(geometry?, &placement)?);
                    self.ids += 1;
                    at.inner += model.total() - 1;
                }
                None => {
                    let origin = origin.inside(index);
                    let (indices, content) = self.content(model, at, &origin, placement)?;
                    origins.add(index, indices.start - first..indices.end - first, content);
                }
            }
        }
        Ok(origins)
    }
}

/// Adds the geometries that a leaf stands for, as [`add`].
fn add_leaf(
    leaf: &Leaf,
    tables: &Tables,
    materials: &Materials,
    all: &mut Vec<Geometry>,
) -> Result<Option<Scale>, GeometryError> {
    if let Some(content) = tables.get(leaf.at) {
        return add(
            content,
            leaf.geometry,
            &leaf.placement,
            materials,
            all,
            None,
        );
    }
    if let Some(built) = leaf.geometry.build(materials) {
        all.push(placed(built?, &leaf.placement)?);
    }
    Ok(None)
}

/// Places a geometry.
fn placed(geometry: Geometry, placement: &Placement) -> Result<Geometry, GeometryError> {
    let transform = placement.transform()?.map(|all| &**all);
    geometry.placed(transform, |shape| placement.place(shape))
}

/// Adds the geometries of a file or the copies that a geometry names. Returns the values of a table
/// that determine its colors.
fn add(
    content: &Content,
    model: &GeometryModel,
    placement: &Placement,
    materials: &Materials,
    all: &mut Vec<Geometry>,
    cancel: Option<&Cancel>,
) -> Result<Option<Scale>, GeometryError> {
    let Some(table) = content.table() else {
        all.extend_from_slice(&content.geometries(placement)?);
        return Ok(None);
    };
    let material = model.surface().material;
    let material = material.map(|material| materials.of_model(material));
    let material = material.transpose()?;
    let texture = materials.texture(model.surface())?;
    let mut scale = Scale::new(model, table);
    rows(
        table,
        (material.as_ref(), texture.as_ref()),
        scale.as_mut(),
        placement,
        all,
        cancel,
    )?;
    Ok(scale)
}

/// Builds a world of the background of a scene, its backdrop and its lighting, if it is lit: its own lights,
/// then those of its parts.
fn surroundings(model: &Model, tables: &Tables) -> Result<World, GeometryError> {
    let background = model.background.as_ref();
    let background = background.map_or(Color::BLACK, ColorModel::build);
    let world = World::new(Vec::new(), background);
    let backdrop = model.backdrop.as_ref();
    let world = match backdrop.map_or(Ok(None), BackdropModel::build)? {
        Some(backdrop) => world.with_backdrop(backdrop),
        None => world,
    };
    let mut of_parts = tables.lights().peekable();
    if model.lights.is_none() && of_parts.peek().is_none() {
        return Ok(world);
    }
    let own = model.lights.iter().flatten();
    let mut lights: Vec<_> = own.map(LightModel::build).collect::<Result<_, _>>()?;
    lights.extend(of_parts.flatten().map(|(_, light)| light.clone()));
    let direct = Lighting::new(lights);
    let lighting = match &model.lighting {
        None => direct,
        Some(lighting) => Lighting {
            max_depth: lighting.max_depth(),
            transport: lighting.transport(),
            ..direct
        },
    };
    Ok(world.lit(lighting))
}

/// Builds the rows of a table. The color of a row replaces the first color of the material.
fn rows(
    table: &Table,
    (material, texture): (Option<&Material>, Option<&MappedTexture>),
    mut scale: Option<&mut Scale>,
    placement: &Placement,
    geometries: &mut Vec<Geometry>,
    cancel: Option<&Cancel>,
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
        let built = row.shape.and_then(|shape| {
            let geometry = Geometry::new(shape, of_row(color));
            placed(geometry.dressed(texture.cloned()), placement)
        });
        match built {
            Ok(geometry) => geometries.push(geometry),
            Err(error) => refused = Some(error),
        }
        refused.is_some() || cancel.is_some_and(Cancel::is_cancelled)
    });
    refused.map_or(Ok(()), Err)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::format::{
        geometry::{GeometryModel, sphere::SphereModel},
        rare::Rare,
    };

    #[test]
    fn a_world_takes_over_the_memory_of_its_model() {
        let sphere = |index: u32| {
            GeometryModel::Sphere(SphereModel {
                center: [0.0, 0.0, f64::from(index)],
                radius: 1.0,
                color: Some(ColorModel::BLACK),
                material: None,
                rare: Rare::default(),
                name: (index == 5).then(|| Box::new("five".into())),
            })
        };
        let model = Model {
            geometries: (0..9).map(sphere).collect(),
            ..Model::default()
        };
        let before = model.geometries.as_ptr().addr();
        let Built { world, origins, .. } = world(model, Tables::default(), None).unwrap();
        assert_eq!(world.geometries().len(), 9);
        assert_eq!(world.geometries().as_ptr().addr(), before);
        assert_eq!((origins.name(5), origins.name(4)), (Some("five"), None));
    }
}
