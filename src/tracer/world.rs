//! The geometries, the background and the lights of a scene.

use std::{mem, sync::Arc};

use glam::DVec3;

use crate::tracer::{
    color::Color,
    contact::{Departure, Passed},
    geometry::Geometry,
    hit::Hit,
    light::{
        Light,
        backdrop::Backdrop,
        transport::{PathOptions, Transport},
    },
    material::{
        Material,
        glass::Glass,
        lobes::{LightOfMaterials, Lobes},
    },
    radiance::Radiance,
    ray::Ray,
    shape::{
        Shape,
        face::{Crossing, FaceId, Leaving},
    },
    tone::Tone,
    vector::unit,
};

/// The geometries, the background and the lights of a scene.
///
/// A world without [`Lighting`] is flat: each geometry shows its color. In a lit world, what a ray
/// sees is [`World::radiance`].
///
/// # Examples
///
/// ```
/// use strahl::{Color, Geometry, Ray, Sphere, Vec3, World};
///
/// let red = Color::new(1.0, 0.0, 0.0);
/// let mut world = World::default();
/// world.push(Geometry::new(Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5)?, red));
/// assert_eq!(world.color_of(&Ray::new(Vec3::ZERO, Vec3::NEG_Z)), red);
/// assert_eq!(world.color_of(&Ray::new(Vec3::ZERO, Vec3::Z)), Color::BLACK);
/// # Ok::<(), strahl::GeometryError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct World {
    geometries: Vec<Geometry>,
    background: Color,
    /// What rays see in place of the background.
    backdrop: Option<Backdrop>,
    lighting: Option<Lighting>,
    /// The number of geometries whose material depends on the point.
    varying: usize,
    /// The lists of copies, in their order.
    lists: Vec<List>,
}

/// A list of copies.
#[derive(Clone, Copy, Debug, PartialEq)]
struct List {
    /// Its index among the geometries.
    index: usize,
    /// The id of the first copy.
    first: usize,
    count: usize,
}

/// The lights of a world, and how they are evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    /// The lights, in file order.
    pub lights: Vec<Light>,
    /// The largest depth of a ray: that of a camera is at depth 0, and each reflection or
    /// refraction adds 1. A deeper ray sees the background. By paths, each scattering adds 1, and a
    /// deeper path brings no light.
    pub max_depth: u32,
    /// How light goes on from surface to surface.
    pub transport: Transport,
}

impl Lighting {
    /// The default of the largest depth of a ray.
    pub const MAX_DEPTH: u32 = 8;

    /// Creates the direct lighting of some lights, with [`Lighting::MAX_DEPTH`].
    pub const fn new(lights: Vec<Light>) -> Self {
        Self {
            lights,
            max_depth: Self::MAX_DEPTH,
            transport: Transport::Direct,
        }
    }
}

impl World {
    /// Creates a world of geometries and a background; [`World::default`] is empty and black.
    pub fn new(geometries: Vec<Geometry>, background: Color) -> Self {
        let mut world = Self {
            background,
            ..Self::default()
        };
        for (index, geometry) in geometries.iter().enumerate() {
            world.varying += usize::from(has_varying_materials(geometry));
            world.note(index, geometry);
        }
        world.geometries = geometries;
        world
    }

    /// Returns the world with lights. It is lit even if there are none: dark.
    #[must_use]
    pub fn lit(mut self, lighting: Lighting) -> Self {
        self.lighting = Some(lighting);
        self
    }

    /// Returns the world with a backdrop, which rays that hit nothing see in place of the background.
    #[must_use]
    pub fn with_backdrop(self, backdrop: Backdrop) -> Self {
        let backdrop = Some(backdrop);
        Self { backdrop, ..self }
    }

    /// Returns an equal world whose meshes have no index, so that its loops are plain ones.
    #[cfg(test)]
    pub(crate) fn without_indices(&self) -> Self {
        let mut world = self.clone();
        for geometry in &mut world.geometries {
            if let Some(copy) = geometry.shape().without_index() {
                let copied = geometry.clone().map_shape(|_| Ok::<_, ()>(copy));
                *geometry = copied.unwrap_or_else(|()| geometry.clone());
            }
        }
        world
    }

    /// Appends a geometry.
    pub fn push(&mut self, geometry: Geometry) {
        self.varying += usize::from(has_varying_materials(&geometry));
        self.note(self.geometries.len(), &geometry);
        self.geometries.push(geometry);
    }

    /// Replaces geometries by as many others; copies by copies.
    pub(crate) fn replace(&mut self, first: usize, by: Vec<Geometry>) {
        for (place, geometry) in self.geometries.iter_mut().skip(first).zip(by) {
            self.varying += usize::from(has_varying_materials(&geometry));
            self.varying -= usize::from(has_varying_materials(place));
            *place = geometry;
        }
        let geometries = mem::take(&mut self.geometries);
        for list in mem::take(&mut self.lists) {
            self.note(list.index, &geometries[list.index]);
        }
        self.geometries = geometries;
    }

    /// Replaces all but the geometries by that of another world.
    pub(crate) fn surround(&mut self, other: Self) {
        *self = Self {
            geometries: mem::take(&mut self.geometries),
            varying: self.varying,
            lists: mem::take(&mut self.lists),
            ..other
        };
    }

    /// Notes a geometry with an index behind all others, if it is a list of copies.
    #[inline]
    fn note(&mut self, index: usize, geometry: &Geometry) {
        if let Some(copies) = geometry.shape().copies() {
            self.lists.push(List {
                index,
                first: self.id_of(index, 0),
                count: copies.len(),
            });
        }
    }

    /// The number of ids: those of all geometries, each of which has one, and of all copies in their
    /// lists.
    pub fn ids(&self) -> usize {
        self.id_of(self.geometries.len(), 0)
    }

    /// Returns the id of a geometry, given its index, or of the copy in a list that a face belongs to.
    /// Ids count all of these from 0, in file order.
    #[inline]
    pub fn id_of(&self, index: usize, face: u64) -> usize {
        if self.lists.is_empty() {
            return index;
        }
        let before = self.lists.partition_point(|list| list.index < index);
        let first = match before.checked_sub(1).and_then(|last| self.lists.get(last)) {
            Some(list) => list.first + list.count + (index - list.index - 1),
            None => index,
        };
        let copies = self.geometries.get(index);
        let copies = copies.and_then(|geometry| geometry.shape().copies());
        first + copies.map_or(0, |copies| copies.copy_of(face))
    }

    /// Returns the index of the geometry that has an id, or one of whose copies has it.
    #[inline]
    pub fn index_of(&self, id: usize) -> usize {
        let before = self.lists.partition_point(|list| list.first <= id);
        match before.checked_sub(1).and_then(|last| self.lists.get(last)) {
            Some(list) if id < list.first + list.count => list.index,
            Some(list) => list.index + 1 + (id - list.first - list.count),
            None => id,
        }
    }

    /// Returns the geometry that has an id, or one of whose copies has it.
    #[inline]
    pub fn with_id(&self, id: usize) -> Option<&Geometry> {
        self.geometries.get(self.index_of(id))
    }

    /// Returns true if there are copies, so that ids are not indices.
    #[inline]
    pub(crate) const fn has_copies(&self) -> bool {
        !self.lists.is_empty()
    }

    /// Returns every field, for callers that must not miss one.
    pub(crate) fn parts(&self) -> (&[Geometry], Color, Option<&Backdrop>, Option<&Lighting>) {
        let Self {
            geometries,
            background,
            backdrop,
            lighting,
            varying: _,
            lists: _,
        } = self;
        (
            geometries,
            *background,
            backdrop.as_ref(),
            lighting.as_ref(),
        )
    }

    /// The geometries, in file order.
    pub fn geometries(&self) -> &[Geometry] {
        &self.geometries
    }

    /// Returns the lower and upper corners of the smallest axis-aligned box around all bounded
    /// geometries; `None` if there are none. An intersection counts with the box of its operands, and a
    /// difference with its first one.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        Shape::smallest_box_around(self.geometries.iter().map(Geometry::shape))
    }

    /// The color of rays that hit nothing, unless there is a backdrop.
    pub const fn background(&self) -> Color {
        self.background
    }

    /// The surroundings that rays see where they hit nothing.
    pub const fn backdrop(&self) -> Option<&Backdrop> {
        self.backdrop.as_ref()
    }

    /// Returns the light of a ray that hits nothing.
    pub(crate) fn behind(&self, ray: &Ray) -> Radiance {
        match &self.backdrop {
            None => self.background.to_linear(),
            Some(backdrop) => backdrop.radiance(unit(ray.direction())),
        }
    }

    /// The lights, if the world is lit.
    pub const fn lighting(&self) -> Option<&Lighting> {
        self.lighting.as_ref()
    }

    /// The options of paths, if light follows paths.
    pub(crate) fn paths(&self) -> Option<&PathOptions> {
        match &self.lighting()?.transport {
            Transport::Direct => None,
            Transport::Path(options) => Some(options),
        }
    }

    /// Returns true if there is rough glass.
    pub(crate) fn has_rough_glass(&self) -> bool {
        let mut materials = self.geometries.iter().flat_map(Geometry::materials);
        materials.any(|material| {
            material
                .glass()
                .is_some_and(|glass| glass.roughness() > 0.0)
        })
    }

    /// Returns true if there is glass that takes nothing away from light: white glass that does not bend it.
    pub(crate) fn has_clear_glass(&self) -> bool {
        let mut materials = self.geometries.iter().flat_map(Geometry::materials);
        materials.any(|material| {
            let is_clear =
                |glass: &Glass| glass.ior() == 1.0 && glass.color().to_linear() == Radiance::WHITE;
            material.glass().is_some_and(is_clear)
        })
    }

    /// Returns true if there is glass other than panes.
    pub(crate) fn has_solid_glass(&self) -> bool {
        let is_solid = |it: &Geometry| it.has_glass() && !it.shape().is_flat();
        self.geometries.iter().any(is_solid)
    }

    /// The lights; none if the world is flat.
    pub(crate) fn lights(&self) -> &[Light] {
        self.lighting().map_or(&[], |lighting| &lighting.lights)
    }

    /// Returns what the light that a ray meets is measured by: the largest of 1, of the intensities of
    /// all lights and of all surfaces that shine, and of the light of the backdrop.
    pub(crate) fn brightest(&self) -> f64 {
        let materials = self.geometries.iter().flat_map(Geometry::materials);
        let all = materials.map(|material| LightOfMaterials::new(&self.lobes(material)));
        let of_materials = all.fold(LightOfMaterials::default(), LightOfMaterials::and);
        self.brightest_light().max(of_materials.brightest)
    }

    /// The part of the lights and the backdrop in [`World::brightest`].
    pub(crate) fn brightest_light(&self) -> f64 {
        let lights = self.lights().iter();
        let backdrop = self.backdrop.as_ref().map(Backdrop::brightest);
        lights
            .map(|light| light.glow().intensity())
            .chain(backdrop)
            .fold(1.0, f64::max)
    }

    /// Returns what a surface does with light: in a flat world, it shows its first color.
    pub(crate) fn lobes<'m>(&self, material: &'m Material) -> Lobes<'m> {
        match self.lighting {
            Some(_) => material.lobes(),
            None => Lobes::shown(material.color()),
        }
    }

    /// Returns the tone of a picture: the requested one if the world is lit.
    pub(crate) fn tone(&self, requested: Tone) -> Tone {
        match self.lighting {
            Some(_) => requested,
            None => Tone::FLAT,
        }
    }

    /// Returns true if all that a ray sees are the colors of geometries, each of which has one, and the
    /// background.
    pub(crate) const fn is_plain(&self) -> bool {
        self.lighting.is_none() && self.backdrop.is_none() && !self.has_varying_materials()
    }

    /// Returns true if the material of some geometry depends on the point.
    pub(crate) const fn has_varying_materials(&self) -> bool {
        self.varying > 0
    }

    /// Returns the nearest hit in front of the ray's origin, with the index of the geometry: the
    /// smallest `t` of all geometries. At equal `t` the first geometry wins.
    ///
    /// This plain loop defines every picture.
    pub fn hit(&self, ray: &Ray) -> Option<(usize, Hit<'_>)> {
        self.hit_from(ray, None)
    }

    /// Returns the hit of [`World::hit`] of a ray that leaves a face of a geometry, `own`: at its
    /// origin it does not meet this face.
    pub fn hit_from(&self, ray: &Ray, own: Option<FaceId>) -> Option<(usize, Hit<'_>)> {
        let (index, crossing) = self.nearest(ray, f64::INFINITY, own.as_slice())?;
        Some((index, self.geometries[index].hit_at(ray, crossing)))
    }

    /// Returns true if a ray meets the geometry or the copy that has an id, whatever lies before it.
    pub(crate) fn meets(&self, id: usize, ray: &Ray) -> bool {
        let index = self.index_of(id);
        let shape = self.geometries.get(index).map(Geometry::shape);
        shape.is_some_and(|shape| match shape.copies() {
            None => shape.meet(ray, Leaving::NOTHING, f64::INFINITY).is_some(),
            Some(_) => {
                let mut is_met = false;
                shape.each_crossing(ray, Leaving::NOTHING, f64::INFINITY, |crossing| {
                    is_met |= self.id_of(index, crossing.face) == id;
                });
                is_met
            }
        })
    }

    /// Returns the faces that the point of a hit lies on: the one that was hit, and all others that are
    /// nearer to the point than its rounding errors, in file order.
    pub fn faces_at(&self, ray: &Ray, index: usize, hit: &Hit) -> Vec<FaceId> {
        let (t, face) = (hit.t, hit.face);
        let contact = self.contact_among_all(ray, (index, Crossing { t, face }));
        let own = FaceId {
            geometry: index,
            face,
        };
        Departure::at_hit(own, contact.map(Arc::new), ray.direction())
            .left()
            .into()
    }

    /// Returns the index of the geometry and the nearest crossing with `0 < t < t_max` of a ray that leaves
    /// faces, given in ascending order.
    #[inline(always)]
    pub(crate) fn nearest(
        &self,
        ray: &Ray,
        t_max: f64,
        left: &[FaceId],
    ) -> Option<(usize, Crossing)> {
        let mut nearest: Option<(usize, Crossing)> = None;
        for (index, geometry) in self.geometries.iter().enumerate() {
            let t_max = nearest.map_or(t_max, |(_, crossing)| crossing.t);
            let leaving = Leaving::of(left, index);
            if let Some(crossing) = geometry.shape().meet(ray, leaving, t_max) {
                nearest = Some((index, crossing));
            }
        }
        nearest
    }

    /// Returns the part of the light that comes through along a ray with `0 <= t < t_max`: none if
    /// something opaque is in the way, and the product of what each crossing of glass lets through,
    /// from near to far.
    pub(crate) fn transmission(&self, ray: &Ray, t_max: f64, start: &Departure) -> Radiance {
        self.transmission_among(ray, t_max, start, 0..self.geometries.len())
    }

    /// The same if all that the ray meets behind its origin is among some geometries.
    pub(crate) fn transmission_among(
        &self,
        ray: &Ray,
        t_max: f64,
        start: &Departure,
        among: impl Iterator<Item = usize>,
    ) -> Radiance {
        let mut light = match self.at_origin(ray, start) {
            Some(passed) => passed.factor,
            None => Radiance::WHITE,
        };
        if light == Radiance::BLACK {
            return light;
        }
        let mut all = Vec::new();
        for geometry in among {
            let of = &self.geometries[geometry];
            let leaving = Leaving::of(start.left(), geometry);
            if of.has_glass() {
                of.shape()
                    .each_crossing(ray, leaving, t_max, |Crossing { t, face }| {
                        all.push((FaceId { geometry, face }, t));
                    });
            } else if of.shape().meet(ray, leaving, t_max).is_some() {
                return Radiance::BLACK;
            }
        }
        self.each_passed(ray, all, |passed| light = light * passed.factor);
        light
    }

    /// Calls `see` with all that is in the way of the light in [`World::transmission`].
    pub(crate) fn each_in_the_way(
        &self,
        ray: &Ray,
        t_max: f64,
        start: &Departure,
        mut see: impl FnMut(Passed),
    ) {
        self.at_origin(ray, start).into_iter().for_each(&mut see);
        let mut all = Vec::new();
        for (geometry, of) in self.geometries.iter().enumerate() {
            let leaving = Leaving::of(start.left(), geometry);
            of.shape()
                .each_crossing(ray, leaving, t_max, |Crossing { t, face }| {
                    all.push((FaceId { geometry, face }, t));
                });
        }
        self.each_passed(ray, all, see);
    }

    /// Returns the color that the ray sees in a flat world: that of the nearest hit, else the
    /// background, or that of the backdrop.
    pub fn color_of(&self, ray: &Ray) -> Color {
        match (self.hit(ray), &self.backdrop) {
            (Some((_, hit)), _) => hit.color(),
            (None, None) => self.background,
            (None, Some(_)) => Color::from_linear(self.behind(ray)),
        }
    }

    /// Returns the light that the ray sees in a flat world.
    pub(crate) fn flat_light(&self, ray: &Ray) -> Radiance {
        match self.hit(ray) {
            Some((_, hit)) => hit.color().to_linear(),
            None => self.behind(ray),
        }
    }
}

fn has_varying_materials(geometry: &Geometry) -> bool {
    geometry.only_material().is_none()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::tracer::{
        shape::{Shape, capsule::Capsule, ellipsoid::Ellipsoid, plane::Plane, sphere::Sphere},
        transform::Transform,
    };

    const RED: Color = Color::new(1.0, 0.0, 0.0);
    const BLUE: Color = Color::new(0.0, 0.0, 1.0);
    const AHEAD: Ray = Ray::new(DVec3::ZERO, DVec3::NEG_Z);

    fn ball(z: f64, color: Color) -> Geometry {
        Geometry::new(Sphere::new(DVec3::new(0.0, 0.0, z), 1.0).unwrap(), color)
    }

    #[test]
    fn bounds_of_turned_shapes_are_the_smallest() {
        let turn = Transform::new(
            DVec3::ZERO,
            Some((DVec3::Z, std::f64::consts::FRAC_PI_4)),
            DVec3::ONE,
        )
        .unwrap();
        let capsule = Capsule::new(DVec3::ZERO, DVec3::new(2.0, 2.0, 0.0), 1.0).unwrap();
        let ellipsoid = Ellipsoid::new(DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z]).unwrap();
        let plane = Plane::new(DVec3::ZERO, DVec3::Y).unwrap();
        let bounds = |shapes: Vec<Shape>| {
            let geometries = shapes.into_iter().map(|shape| Geometry::new(shape, RED));
            World::new(geometries.collect(), BLUE).bounds()
        };
        let turned = Shape::from(capsule).placed(&Arc::new(turn)).unwrap();
        let [low, high] = bounds(vec![ellipsoid.into(), plane.into()]).unwrap();
        assert_eq!([low, high], [DVec3::NEG_ONE, DVec3::ONE]);
        let [low, high] = bounds(vec![turned, ellipsoid.into()]).unwrap();
        assert!((low - DVec3::NEG_ONE).length() < 1e-12, "{low}");
        let top = DVec3::new(1.0, 1.0 + 8.0_f64.sqrt(), 1.0);
        assert!((high - top).length() < 1e-12, "{high}");
        assert_eq!(bounds(vec![plane.into()]), None);
    }

    #[test]
    fn the_smallest_t_wins_whatever_the_order() {
        for geometries in [
            vec![ball(-3.0, RED), ball(-6.0, BLUE)],
            vec![ball(-6.0, BLUE), ball(-3.0, RED)],
        ] {
            let world = World::new(geometries, Color::BLACK);
            assert_eq!(world.hit(&AHEAD).unwrap().1.t, 2.0);
            assert_eq!(world.color_of(&AHEAD), RED);
        }
    }

    #[test]
    fn at_equal_t_the_first_wins() {
        let wall = Plane::new(DVec3::new(0.0, 0.0, -2.0), DVec3::Z).unwrap();
        let world = World::new(
            vec![ball(3.0, RED), Geometry::new(wall, BLUE), ball(-3.0, RED)],
            Color::BLACK,
        );
        let (index, hit) = world.hit(&AHEAD).unwrap();
        assert_eq!((index, hit.t), (1, 2.0));
        assert_eq!(hit.geometry.color(), BLUE);
    }

    #[test]
    fn a_ray_without_a_hit_sees_the_background() {
        let world = World::new(vec![ball(3.0, RED)], BLUE);
        assert_eq!(world.hit(&AHEAD), None);
        assert_eq!(world.color_of(&AHEAD), BLUE);
        assert_eq!(World::default().color_of(&AHEAD), Color::BLACK);
    }
}
