//! A shape with its material.

use std::sync::Arc;

use glam::DVec3;

use crate::tracer::{
    color::Color,
    error::GeometryError,
    hit::Hit,
    material::{
        Material,
        binding::{MaterialBinding, VertexColors},
        texture::{MappedTexture, Texture, TextureMapping, Textured},
    },
    ray::Ray,
    shape::{
        Shape,
        face::{Crossing, Leaving},
        instances::{Instances, Rows},
    },
    transform::Transform,
};

/// A [`Shape`] with its [`Material`].
///
/// # Examples
///
/// ```
/// use strahl::{Color, Geometry, Ray, Sphere, Vec3};
///
/// let red = Color::new(1.0, 0.0, 0.0);
/// let ball = Geometry::new(Sphere::new(Vec3::new(0.0, 0.0, -3.0), 0.5)?, red);
/// let hit = ball.hit(&Ray::new(Vec3::ZERO, Vec3::NEG_Z)).expect("it is straight ahead");
/// assert_eq!(hit.t, 2.5);
/// assert_eq!(hit.geometry.color(), red);
/// # Ok::<(), strahl::GeometryError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    shape: Shape,
    binding: MaterialBinding,
}

impl Geometry {
    /// Creates a shape with a material; a [`Color`] alone is a matte one.
    pub fn new(shape: impl Into<Shape>, material: impl Into<Material>) -> Self {
        Self {
            shape: shape.into(),
            binding: MaterialBinding::Plain(material.into()),
        }
    }

    /// Gives some faces materials of their own, in the order of their numbers.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::shape::Cuboid;
    /// use strahl::{Color, Geometry, Ray, Vec3};
    ///
    /// let [red, white] = [Color::new(1.0, 0.0, 0.0), Color::WHITE];
    /// let cube = Geometry::new(Cuboid::new(Vec3::ZERO, Vec3::ONE)?, white).by_face([red]);
    /// let from = |x, direction| cube.hit(&Ray::new(Vec3::new(x, 0.5, 0.5), direction));
    /// assert_eq!(from(-1.0, Vec3::X).expect("it is ahead").color(), red);
    /// assert_eq!(from(2.0, Vec3::NEG_X).expect("it is ahead").color(), white);
    /// # Ok::<(), strahl::GeometryError>(())
    /// ```
    #[must_use]
    pub fn by_face(self, materials: impl IntoIterator<Item: Into<Material>>) -> Self {
        let others = self.material().clone();
        Self {
            binding: MaterialBinding::by_face(materials.into_iter().map(Into::into), others),
            ..self
        }
    }

    /// Gives the vertices of a mesh what determines the first color of the material.
    #[must_use]
    pub(crate) fn by_vertex(self, vertices: VertexColors) -> Self {
        Self {
            binding: MaterialBinding::by_vertex(self.material(), vertices),
            ..self
        }
    }

    /// Gives the material a texture. The coordinates on the surface are those of the shape as it is now, and move
    /// with it where it is placed.
    #[must_use]
    pub fn textured(self, texture: Texture, mapping: TextureMapping) -> Self {
        let textured = Textured::new(
            self.material().clone(),
            (texture, mapping),
            self.shape.clone(),
        );
        Self {
            binding: MaterialBinding::Textured(textured.into()),
            ..self
        }
    }

    /// Gives the material a texture, if there is one, and if it is the same everywhere.
    pub(crate) fn dressed(self, texture: Option<MappedTexture>) -> Self {
        match (texture, self.binding.plain()) {
            (Some((texture, mapping)), Some(_)) => self.textured(texture, mapping),
            _ => self,
        }
    }

    /// Returns the geometry where a transform places it, given how shapes are placed.
    ///
    /// # Errors
    ///
    /// Those of `place`, and a product of transforms that cannot be inverted.
    pub(crate) fn placed(
        self,
        transform: Option<&Transform>,
        place: impl FnOnce(Shape) -> Result<Shape, GeometryError>,
    ) -> Result<Self, GeometryError> {
        // Copies know their own places.
        let is_one = self.shape.copies().is_none();
        let binding = match (self.binding, transform) {
            (MaterialBinding::Textured(textured), Some(transform)) if is_one => {
                MaterialBinding::Textured(textured.placed(transform)?.into())
            }
            (other, _) => other,
        };
        Ok(Self {
            shape: place(self.shape)?,
            binding,
        })
    }

    /// Creates copies of geometries, one of all of them for each transform, with the materials of the
    /// geometries.
    ///
    /// # Errors
    ///
    /// Those of [`Instances::new`].
    pub fn copies<'g>(
        geometries: impl IntoIterator<Item = &'g Self>,
        transforms: impl IntoIterator<Item = Transform>,
    ) -> Result<Self, GeometryError> {
        let rows = transforms.into_iter().map(|transform| transform.rows());
        Self::copies_at(geometries, rows.collect::<Vec<_>>().into())
    }

    /// The same from the rows of transforms, which can be inverted.
    pub(crate) fn copies_at<'g>(
        geometries: impl IntoIterator<Item = &'g Self>,
        rows: Arc<Vec<Rows>>,
    ) -> Result<Self, GeometryError> {
        let all = geometries.into_iter();
        let (shapes, bindings): (Vec<_>, Vec<_>) = all
            .map(|one| (one.shape.clone(), one.binding.clone()))
            .unzip();
        Ok(Self {
            shape: Instances::of_rows(shapes, rows)?.into(),
            binding: MaterialBinding::by_shape(bindings.into()),
        })
    }

    /// The number of ids that it has: one for each copy of a list of [`copies`](Self::copies), else 1.
    #[inline]
    pub fn count(&self) -> usize {
        self.shape.copies().map_or(1, |copies| copies.len())
    }

    /// Returns the shape and the binding at a face, and the number of the face there: in a copy those
    /// of the prototype.
    #[inline]
    pub(crate) fn surface(&self, face: u64) -> (&Shape, &MaterialBinding, u64) {
        self.surface_in_copies(face, |_, _| {})
    }

    /// The same; `enter` is called for each copy that the face is in, with the number of the face there.
    #[inline]
    fn surface_in_copies(
        &self,
        face: u64,
        mut enter: impl FnMut(&Instances, u64),
    ) -> (&Shape, &MaterialBinding, u64) {
        let (mut shape, mut binding, mut face) = (&self.shape, &self.binding, face);
        // What a part holds may be copies itself.
        while let Some(copies) = shape.copies()
            && let Some((index, inner, number)) = copies.part_of(face)
        {
            enter(copies, face);
            (shape, binding, face) = (inner, binding.of_shape(index), number);
        }
        (shape, binding, face)
    }

    /// Returns the material of a texture at a point of a face, if it has one.
    pub(crate) fn textured_at(&self, face: u64, mut point: DVec3) -> Option<Material> {
        let (_, binding, face) = self.surface_in_copies(face, |copies, face| {
            if let Some(transform) = copies.transform(copies.copy_of(face)) {
                point = transform.point_back(point);
            }
        });
        match binding {
            MaterialBinding::Textured(textured) => Some(textured.at(point, face)),
            _ => None,
        }
    }

    /// Returns the number of a face in its shape, which in a copy is one of the prototype; `None` for a
    /// shape with one face.
    pub fn face_of_shape(&self, face: u64) -> Option<u64> {
        let (shape, _, face) = self.surface(face);
        shape.has_faces().then_some(face)
    }

    /// Returns the geometry with another shape in place of its own.
    ///
    /// # Errors
    ///
    /// Those of `map`.
    pub(crate) fn map_shape<E>(
        self,
        map: impl FnOnce(Shape) -> Result<Shape, E>,
    ) -> Result<Self, E> {
        Ok(Self {
            shape: map(self.shape)?,
            ..self
        })
    }

    /// Returns every field, for callers that must not miss one.
    pub(crate) const fn parts(&self) -> (&Shape, &MaterialBinding) {
        let Self { shape, binding } = self;
        (shape, binding)
    }

    /// The shape.
    pub const fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The material, wherever no other was given: see [`Hit::material`]. Where the vertices of a mesh
    /// determine its first color, it has that of the first vertex.
    #[inline]
    pub fn material(&self) -> &Material {
        self.binding.main()
    }

    /// The first color of the material, which the geometry shows in a scene without lights.
    #[inline]
    pub fn color(&self) -> Color {
        self.material().color()
    }

    /// All materials; some may be equal.
    pub fn materials(&self) -> impl Iterator<Item = &Material> {
        self.binding.all()
    }

    /// The material, if it is the same everywhere.
    #[inline]
    pub(crate) const fn only_material(&self) -> Option<&Material> {
        self.binding.plain()
    }

    /// Returns true if some of it is glass, so that its shadow may not be black.
    #[inline]
    pub(crate) fn has_glass(&self) -> bool {
        let is_glass = |material: &Material| material.glass().is_some();
        match self.binding.plain() {
            Some(material) => is_glass(material),
            None => self.materials().any(is_glass),
        }
    }

    /// Returns the first hit of the ray in front of its origin, if any.
    pub fn hit(&self, ray: &Ray) -> Option<Hit<'_>> {
        let crossing = self.shape.meet(ray, Leaving::NOTHING, f64::INFINITY)?;
        Some(self.hit_at(ray, crossing))
    }

    /// Returns the hit at a crossing.
    pub(crate) fn hit_at(&self, ray: &Ray, crossing: Crossing) -> Hit<'_> {
        Hit::new(self, ray, crossing, self.shape.normal_at(ray, crossing))
    }

    /// Returns the color that it shows in a scene without lights where a ray meets it, at a `t` found
    /// by [`Shape::intersect`].
    pub(crate) fn color_at(&self, ray: impl FnOnce() -> Ray, t: f64) -> Color {
        let of_hit = || {
            let ray = ray();
            self.hit_at(&ray, self.crossing_at(&ray, t)).color()
        };
        self.only_material().map_or_else(of_hit, Material::color)
    }

    /// Returns the crossing at a `t` found by [`Shape::intersect`].
    pub(crate) fn crossing_at(&self, ray: &Ray, t: f64) -> Crossing {
        let face = self.shape.face_at(ray, t);
        Crossing { t, face }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::tracer::{
        colormap::{Colormap, scale::ColorScale},
        contact::Departure,
        material::{Emissive, glass::Glass, texture::Checkerboard},
        shape::{
            cuboid::Cuboid, face::FaceId, mesh::Mesh, placed::Placer, plane::Plane, sphere::Sphere,
        },
        world::World,
    };

    #[test]
    fn a_hit_has_its_point_and_geometry() {
        let sphere = Sphere::new(DVec3::new(0.0, 0.0, -3.0), 0.5).unwrap();
        let ball = Geometry::new(sphere, Color::WHITE);
        let hit = ball.hit(&Ray::new(DVec3::ZERO, DVec3::NEG_Z)).unwrap();
        assert_eq!(hit.t, 2.5);
        assert_eq!(hit.point, DVec3::new(0.0, 0.0, -2.5));
        assert_eq!(hit.normal, DVec3::Z);
        assert!(hit.front_face);
        assert_eq!(hit.geometry, &ball);
    }

    // The first vertex belongs to no triangle, so it is dropped, and so is its color.
    #[test]
    fn vertices_determine_colors_between_them() {
        let [x, y] = [DVec3::X, DVec3::Y];
        let vertices = vec![DVec3::ONE, DVec3::ZERO, x * 4.0, y * 4.0];
        let of_vertices = vec![(Color::BLACK, 9.0), (Color::BLACK, 1.0)];
        let of_vertices = [
            of_vertices,
            vec![(Color::WHITE, 3.0), (Color::BLACK, f64::NAN)],
        ]
        .concat();
        let (mesh, kept) = Mesh::with(vertices, vec![[1, 2, 3]], of_vertices).unwrap();
        assert_eq!(kept.len(), 3);
        let shape = Shape::from(mesh);
        let light = kept.iter().map(|(color, _)| color.to_linear()).collect();
        let material = Material::from(Emissive::new(Color::WHITE, 2.0).unwrap());
        let geometry =
            Geometry::new(shape.clone(), material).by_vertex(VertexColors::Colors(light));
        let ray = Ray::new(DVec3::new(1.0, 0.0, 3.0), DVec3::NEG_Z);
        let hit = geometry.hit(&ray).unwrap();
        assert_eq!(hit.interpolation().unwrap().weights, [0.75, 0.25, 0.0]);
        assert_eq!(hit.color().to_rgb8(), [137; 3], "a quarter of the light");
        assert_eq!(hit.material().kind(), "emissive");
        assert_eq!(geometry.color(), Color::BLACK, "that of the first vertex");

        let scale = ColorScale {
            column: "energy".into(),
            range: Some([1.0, 3.0]),
            map: Colormap::gray(),
            missing: Color::new(1.0, 0.0, 1.0),
        };
        let values = |known: usize| {
            let values = kept.iter().enumerate();
            values.map(move |(index, (_, value))| if index < known { *value } else { 1.0 })
        };
        for (values, color) in [(values(2), [64; 3]), (values(3), [255, 0, 255])] {
            let colors = VertexColors::Values(values.collect(), scale.clone());
            let geometry = Geometry::new(shape.clone(), Color::WHITE).by_vertex(colors);
            let hit = geometry.hit(&ray).unwrap();
            assert_eq!(hit.color().to_rgb8(), color);
            let (value, _) = hit.interpolation().unwrap().value().unwrap();
            assert!(value == 1.5 || value.is_nan());
        }
    }

    // A part that is copied may hold copies.
    #[test]
    fn copies_of_copies_have_the_materials_of_their_shapes() {
        let ball = |x: f64, color| {
            let center = DVec3::new(x, 0.0, 0.0);
            Geometry::new(Sphere::new(center, 0.5).unwrap(), color)
        };
        let shift = |y: f64| {
            let shift = DVec3::new(0.0, y, 0.0);
            [Transform::new(shift, None, DVec3::ONE).unwrap()]
        };
        let [red, blue] = [Color::new(1.0, 0.0, 0.0), Color::new(0.0, 0.0, 1.0)];
        let inner = Geometry::copies(&[ball(0.0, red), ball(2.0, blue)], shift(1.0)).unwrap();
        let outer = Geometry::copies(&[inner, ball(0.0, Color::WHITE)], shift(4.0)).unwrap();
        let color = |x, y| {
            let ray = Ray::new(DVec3::new(x, y, 3.0), DVec3::NEG_Z);
            let hit = outer.hit(&ray).unwrap();
            assert_eq!(hit.face_of_shape(), None, "a sphere has one face");
            hit.color()
        };
        let found = [color(0.0, 5.0), color(2.0, 5.0), color(0.0, 4.0)];
        assert_eq!(found, [red, blue, Color::WHITE]);
    }

    // Beyond 41.8 degrees, a ray at this angle inside of the glass would be reflected totally.
    #[test]
    fn a_window_lets_light_through_at_every_angle() {
        let glass = Glass::new(Color::WHITE, 1.5).unwrap();
        let floor = Plane::new(DVec3::NEG_Y, DVec3::Y).unwrap();
        let [low, high] = [DVec3::new(-90.0, 0.0, -90.0), DVec3::new(90.0, 0.1, 90.0)];
        let pane = Geometry::new(Cuboid::new(low, high).unwrap(), glass);
        let world = World::new(vec![Geometry::new(floor, Color::WHITE), pane], Color::BLACK);
        for degrees in [0.0, 45.0, 60.0, 75.0, 85.0_f64] {
            let (sin, cos) = libm::sincos(degrees * (std::f64::consts::PI / 180.0));
            let ray = Ray::new(DVec3::NEG_Y, DVec3::new(sin, cos, 0.0));
            let start = Departure::at_hit(FaceId::of_shape(0), None, DVec3::NEG_Y);
            let light = world
                .transmission(&ray, f64::INFINITY, &start)
                .max_channel();
            let passed = 1.0 - glass.fresnel(cos, true).reflected;
            assert!((light - passed * passed).abs() < 1e-15, "{degrees}");
        }
    }

    #[test]
    fn a_grazing_ray_comes_from_outside() {
        let ball = Geometry::new(Sphere::new(DVec3::ZERO, 1.0).unwrap(), Color::WHITE);
        let ray = Ray::new(DVec3::new(-2.0, 1.0, 0.0), DVec3::X);
        let hit = ball.hit(&ray).unwrap();
        assert_eq!((hit.normal, hit.front_face), (DVec3::Y, true));
    }

    #[test]
    fn from_inside_and_from_behind_the_back_face_is_hit() {
        let sphere = Sphere::new(DVec3::ZERO, 2.0).unwrap();
        let ball = Geometry::new(sphere, Color::WHITE);
        let hit = ball.hit(&Ray::new(DVec3::ZERO, DVec3::X)).unwrap();
        assert_eq!((hit.normal, hit.front_face), (DVec3::X, false));

        let floor = Plane::new(DVec3::ZERO, DVec3::new(0.0, 4.0, 0.0)).unwrap();
        let floor = Geometry::new(floor, Color::WHITE);
        let hit = floor.hit(&Ray::new(DVec3::NEG_Y, DVec3::Y)).unwrap();
        assert_eq!((hit.normal, hit.front_face), (DVec3::Y, false));
    }

    // Two colors at most differ by rounding, where a ray meets a border of the checkerboard.
    #[test]
    fn a_texture_moves_with_its_shape() {
        let checker = Checkerboard::new(Color::WHITE, Color::BLACK, 0.3).unwrap();
        let mapping = TextureMapping::planar(DVec3::new(0.1, 0.2, 0.0), [DVec3::X, DVec3::Y]);
        let still = Geometry::new(Sphere::new(DVec3::ONE, 1.0).unwrap(), Color::WHITE)
            .textured(Texture::Checker(checker), mapping.unwrap());
        let turn = |axis, angle, shift| {
            Transform::new(shift, Some((axis, angle)), DVec3::splat(1.3)).unwrap()
        };
        let inner = turn(DVec3::new(1.0, 2.0, 0.5), 40.0, DVec3::new(1.0, 0.0, -2.0));
        let outer = turn(DVec3::new(0.0, -1.0, 3.0), 110.0, DVec3::new(0.5, 3.0, 0.0));
        let place = |geometry: Geometry, by: Transform| {
            let mut placer = Placer::new(&[by.into()]);
            geometry
                .placed(Some(&by), |shape| placer.place(shape))
                .unwrap()
        };
        let both = place(place(still.clone(), inner), outer);
        let copy = Geometry::copies([&place(still.clone(), inner)], [outer]).unwrap();
        let copies = place(Geometry::copies([&still], [inner]).unwrap(), outer);
        let (mut hits, mut white) = (0, 0);
        for step in 0..2000 {
            let turn = f64::from(step) * 2.4;
            let from = 4.0 * DVec3::new(libm::sin(turn), libm::cos(turn), libm::sin(0.1 * turn));
            let ray = Ray::new(DVec3::ONE + from, -from + 0.2 * DVec3::X);
            let Some(hit) = still.hit(&ray) else { continue };
            let all = outer.times(&inner).unwrap();
            let moved = Ray::new(all.point(ray.origin()), all.direction(ray.direction()));
            for other in [&both, &copy, &copies] {
                let found = other.hit(&moved).unwrap().color();
                hits += i32::from(found == hit.color());
            }
            white += i32::from(hit.color().r() > 0.5);
        }
        assert!(white > 700 && white < 1300, "{white}");
        assert!(hits >= 3 * 2000 - 6, "{hits}");
    }
}
