//! The geometries of a scene file: one file for each kind, with its fields and its construction.

pub(crate) mod capsule;
pub(crate) mod cone;
pub(crate) mod cuboid;
pub(crate) mod cylinder;
pub(crate) mod disc;
pub(crate) mod ellipsoid;
mod faults;
pub(crate) mod group;
pub(crate) mod inside;
pub(crate) mod instances;
pub(crate) mod kind;
pub(crate) mod mesh;
pub(crate) mod ordinal;
pub(crate) mod part;
pub(crate) mod placement;
pub(crate) mod plane;
pub(crate) mod rectangle;
pub(crate) mod solid;
pub(crate) mod sphere;
pub(crate) mod table;
pub(crate) mod torus;
pub(crate) mod triangle;
pub(crate) mod walk;

pub use self::{
    capsule::CapsuleModel,
    cone::ConeModel,
    cuboid::BoxModel,
    cylinder::CylinderModel,
    disc::DiscModel,
    ellipsoid::EllipsoidModel,
    group::GroupModel,
    instances::InstancesModel,
    mesh::{MeshFileModel, MeshModel},
    part::PartModel,
    plane::PlaneModel,
    rectangle::RectangleModel,
    solid::{DifferenceModel, IntersectionModel, UnionModel},
    sphere::{SphereModel, SphereRest},
    table::{CylindersModel, SpheresModel},
    torus::TorusModel,
    triangle::TriangleModel,
};

use glam::DVec3;

use std::sync::Arc;

use crate::{
    scene::{
        format::{
            color_by::ColorByModel,
            field::{FieldKind, Name, Value},
            geometry::{
                inside::Inside,
                kind::{Coat, CopiesModel, GeometryKind, SeveralWords, TableModel},
            },
            material::{MaterialModel, Materials, Surface},
            texture::TextureModel,
            thing::Thing,
            transform::TransformModel,
            variants::variants,
        },
        problem::Problem,
    },
    tracer::{
        error::GeometryError,
        geometry::Geometry,
        shape::{Membership, Shape, solid::Operation},
    },
};

variants! {
    /// A geometry.
    pub enum GeometryModel = "Geometry" for of_each {
        /// An infinite plane, seen from both sides.
        Plane(Box<PlaneModel>),
        /// A sphere.
        Sphere(SphereModel) | Ball | SphereGeometry,
        /// A disc, seen from both sides.
        Disc(Box<DiscModel>) | Circle,
        /// A parallelogram, seen from both sides.
        Rectangle(Box<RectangleModel>) | Quad | Parallelogram,
        /// A triangle, seen from both sides.
        Triangle(Box<TriangleModel>),
        /// A box along the axes.
        Box(Box<BoxModel>) | Cuboid | Cube | BoxGeometry,
        /// A cylinder.
        Cylinder(Box<CylinderModel>) | CylinderGeometry,
        /// A cone, or a truncated cone.
        Cone(Box<ConeModel>) | ConeGeometry,
        /// A capsule: a cylinder with hemispherical ends.
        Capsule(Box<CapsuleModel>) | CapsuleGeometry,
        /// An ellipsoid.
        Ellipsoid(Box<EllipsoidModel>),
        /// A torus: a round tube that is bent to a ring.
        Torus(Box<TorusModel>) | TorusGeometry,
        /// A triangle mesh, seen from both sides.
        Mesh(Box<MeshModel>) | TriangleMesh,
        /// Many spheres from a table, a file beside the scene: one in each row.
        Spheres(Box<SpheresModel>),
        /// Many cylinders from a table, a file beside the scene: one in each row, such as the bonds of a
        /// molecule.
        Cylinders(Box<CylindersModel>),
        /// The geometries of another scene file, with their own materials.
        Part(PartModel) | Include,
        /// Geometries that belong together.
        Group(GroupModel),
        /// Copies of another geometry.
        Instances(Box<InstancesModel>),
        /// The union of several solids.
        Union(Box<UnionModel>) | Merge,
        /// The intersection of several solids.
        Intersection(Box<IntersectionModel>),
        /// The difference of a solid and others.
        Difference(Box<DifferenceModel>),
    }
}

impl GeometryModel {
    /// Returns its name in the scene.
    pub(crate) fn name(&self) -> Option<&str> {
        of_each!(self, geometry => geometry.name.as_ref().map(|name| &***name))
    }

    /// Removes its name and returns it.
    #[inline]
    pub(crate) fn take_name(&mut self) -> Option<Name> {
        of_each!(self, geometry => geometry.name.take())
    }

    /// Returns its color, its texture and its material.
    #[inline]
    pub(crate) fn surface(&self) -> Surface<'_> {
        of_each!(self, geometry => geometry.surface())
    }

    /// Returns its own material, for a change.
    pub(crate) fn material_mut(&mut self) -> Option<&mut Arc<MaterialModel>> {
        of_each!(self, geometry => geometry.material_mut())
    }

    /// Returns the texture beside its color, for a change.
    pub(crate) fn texture_mut(&mut self) -> Option<&mut Arc<TextureModel>> {
        of_each!(self, geometry => geometry.texture_mut())
    }

    /// Shares the material or the texture of another geometry if the two are equal: a million geometries
    /// hold one.
    #[inline]
    pub(crate) fn share_material(&mut self, other: &Self) {
        let surface = other.surface();
        if let Some(material) = surface.material {
            share(self.material_mut(), material);
        }
        if let Some(texture) = surface.texture {
            share(self.texture_mut(), texture);
        }
    }

    /// Returns the shape; `None` for a table, a part, a group, instances, and a mesh whose file is not
    /// read.
    #[inline]
    pub(crate) fn any_shape(&self) -> Option<Result<Shape, GeometryError>> {
        of_each!(self, geometry => geometry.shape())
    }

    /// Returns the position of an eye relative to the shape; `None` where [`GeometryModel::shape`] is.
    #[inline(always)]
    fn membership(&self, eye: DVec3) -> Option<Membership> {
        match self {
            // It may be one of a million.
            Self::Sphere(sphere) => Some(sphere.shape()?.ok()?.membership(eye)),
            _ => self.membership_of_few(eye),
        }
    }

    /// The same for a kind of which there are few.
    #[inline(never)]
    fn membership_of_few(&self, eye: DVec3) -> Option<Membership> {
        Some(self.any_shape()?.ok()?.membership(eye))
    }

    /// Returns the faults between fields that are valid alone.
    #[inline]
    pub(crate) fn faults(&self) -> Vec<Problem> {
        of_each!(self, geometry => geometry.faults())
    }

    /// Returns its fields with geometries, in the order of the file.
    #[inline]
    pub(crate) fn inside(&self) -> impl DoubleEndedIterator<Item = Inside<'_>> {
        of_each!(self, geometry => geometry.inside())
            .into_iter()
            .flatten()
    }

    /// The same geometries, writable.
    fn inside_mut(&mut self) -> impl Iterator<Item = &mut [Self]> {
        of_each!(self, geometry => geometry.inside_mut()).into_iter()
    }

    /// Returns what is done with the solids inside, if it is put together from some.
    #[inline]
    pub(crate) fn operation(&self) -> Option<Operation> {
        of_each!(self, geometry => geometry.operation())
    }

    /// Builds the geometry; `None` for a table, a part or a group, which hold geometries, and for a
    /// mesh whose file is not read.
    #[inline]
    pub(crate) fn build(&self, materials: &Materials) -> Option<Result<Geometry, GeometryError>> {
        if self.operation().is_some() {
            let shape = self.any_shape()?;
            return Some(shape.and_then(|shape| self.build_solid(shape, materials)));
        }
        if let Self::Mesh(mesh) = self {
            let material = || materials.build(self.surface());
            let shape = mesh.shape()?;
            return Some(shape.and_then(|shape| {
                let texture = materials.texture(self.surface())?;
                Ok(mesh.build(shape, material()?).dressed(texture))
            }));
        }
        let material = match materials.build(self.surface()) {
            Ok(material) => material,
            Err(error) => return Some(Err(error)),
        };
        let texture = materials.texture(self.surface());
        if !matches!(texture, Ok(None)) {
            return Some(
                self.any_shape()?
                    .and_then(|shape| Ok(Geometry::new(shape, material).dressed(texture?))),
            );
        }
        // For each kind apart: to move a shape would take as long as to build it.
        of_each!(self, geometry => {
            Some(geometry.shape()?.map(|shape| Geometry::new(shape, material)))
        })
    }

    /// Returns the shape, if it is a valid one; `None` for a table, a part, a group, and a mesh whose
    /// file is not read.
    pub(crate) fn shape(&self) -> Option<Shape> {
        self.any_shape()?.ok()
    }

    /// Calls `see` with each number of the geometry, whatever its color and name.
    #[inline]
    pub(crate) fn numbers(&self, mut see: impl FnMut(f64)) {
        self.each(|_, value| match value {
            Value::Number(number) => see(number),
            Value::Vector(vector) => vector.iter().for_each(|number| see(*number)),
            Value::Interval(_) | Value::Color(_) => {}
        });
        of_each!(self, geometry => geometry.more_numbers(&mut see));
    }

    /// Returns its colors by value.
    #[inline]
    pub(crate) fn color_by(&self) -> Option<&ColorByModel> {
        match self {
            Self::Mesh(mesh) => mesh.color_by.as_ref(),
            _ => self.table()?.color_by,
        }
    }

    /// Returns true if the rows of its table or its vertices may have colors of their own.
    pub(crate) fn may_have_colors(&self) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.may_have_colors(),
            _ => self.table().is_some(),
        }
    }

    /// The table that it names.
    #[inline(always)]
    pub(crate) fn table(&self) -> Option<TableModel<'_>> {
        of_each!(self, geometry => geometry.table())
    }

    /// The copies that it is.
    #[inline(always)]
    pub(crate) fn copies(&self) -> Option<CopiesModel<'_>> {
        of_each!(self, geometry => geometry.copies())
    }

    /// The words for what it stands for, if that is several geometries of the world.
    pub(crate) fn words(&self) -> Option<SeveralWords> {
        of_each!(self, geometry => geometry.words())
    }

    /// The part that it names.
    pub(crate) const fn part(&self) -> Option<&PartModel> {
        match self {
            Self::Part(part) => Some(part),
            _ => None,
        }
    }

    /// The mesh file that it names.
    pub(crate) fn mesh_file(&self) -> Option<&MeshFileModel> {
        match self {
            Self::Mesh(mesh) => mesh.file.as_ref(),
            _ => None,
        }
    }

    /// The mesh file that it names, writable.
    pub(crate) fn mesh_file_mut(&mut self) -> Option<&mut MeshFileModel> {
        match self {
            Self::Mesh(mesh) => mesh.file.as_mut(),
            _ => None,
        }
    }

    /// The group, if it is one.
    pub(crate) const fn group(&self) -> Option<&GroupModel> {
        match self {
            Self::Group(group) => Some(group),
            _ => None,
        }
    }

    /// Returns true if no other geometries are inside of it.
    #[inline]
    pub(crate) fn is_single(&self) -> bool {
        self.inside().next().is_none()
    }

    /// Returns true if its color and material are its own; a part, a group and instances have none.
    pub(crate) fn has_surface(&self) -> bool {
        self.fields()
            .iter()
            .any(|field| field.kind == FieldKind::Color)
    }

    /// Its transform.
    #[inline]
    pub(crate) fn transform(&self) -> Option<&TransformModel> {
        of_each!(self, geometry => geometry.transform.as_deref())
    }

    /// The path of the file that it names.
    #[inline]
    pub(crate) fn file(&self) -> Option<&str> {
        let table = self.table().map(|table| table.file);
        let mesh = || self.mesh_file().map(|mesh| &*mesh.path);
        let part = || self.part().map(|part| &*part.file);
        table.or_else(mesh).or_else(part)
    }
}

/// Shares a value if the two are equal.
#[inline]
fn share<T: PartialEq>(own: Option<&mut Arc<T>>, other: &Arc<T>) {
    if let Some(own) = own
        && own == other
    {
        own.clone_from(other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // A million spheres stay below 90 MB.
    #[test]
    fn geometries_are_small() {
        assert!(size_of::<GeometryModel>() <= 88);
    }
}
