//! The shapes that a ray can hit, one per file.
//!
//! Everything that the rest of the crate needs from a shape is a method here, implemented in the
//! file of the shape. No other code matches on the shape, except for the fast paths of spheres and
//! planes.

#[cfg(test)]
pub(crate) mod any;
pub(crate) mod around;
pub(crate) mod axis;
pub(crate) mod capsule;
pub(crate) mod cone;
pub(crate) mod contact;
pub(crate) mod cuboid;
pub(crate) mod cylinder;
pub(crate) mod disc;
pub(crate) mod ellipsoid;
pub(crate) mod face;
pub(crate) mod indexed;
pub(crate) mod instances;
pub(crate) mod mesh;
pub(crate) mod placed;
pub(crate) mod plane;
pub(crate) mod rectangle;
pub(crate) mod solid;
pub(crate) mod span;
pub(crate) mod sphere;
pub(crate) mod target;
#[cfg(test)]
mod tests;
pub(crate) mod torus;
pub(crate) mod triangle;
pub(crate) mod uv;
pub(crate) mod working;

pub use self::{
    capsule::Capsule,
    cone::Cone,
    cuboid::Cuboid,
    cylinder::Cylinder,
    disc::Disc,
    ellipsoid::Ellipsoid,
    face::FaceId,
    instances::Instances,
    mesh::{Mesh, MeshGroup},
    placed::Placed,
    rectangle::Rectangle,
    solid::{Operation, Solid},
    torus::Torus,
    triangle::Triangle,
};
pub use crate::tracer::transform::Transform;

use std::{borrow::Borrow, sync::Arc};

use glam::DVec3;

use crate::tracer::{
    ray::{BUNDLE, Bundle, Ray},
    shape::{
        around::Around,
        contact::{ContactPoint, NearFace},
        face::{Crossing, Faces, Leaving},
        plane::{Planar, Plane},
        span::{Convex, Side, Span, Spans},
        sphere::Sphere,
        working::Working,
    },
    vector::unit,
};

/// Defines the enum of all shapes and the methods that each shape implements in its own file.
macro_rules! shapes {
    ($($(#[$doc:meta])* $shape:ident($content:ty) $(= $name:literal)?,)*) => {
        /// A surface without a color.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Shape {
            $($(#[$doc])* $shape($content)),*
        }

        impl Shape {
            /// The names of all kinds of shapes, in lowercase.
            pub const KINDS: &'static [&'static str] = &[$($($name,)?)*];

            /// Returns the name and the faces of a kind of shape: those of the inner shape for one
            /// that is placed.
            #[inline]
            fn about(&self) -> (&'static str, Faces) {
                match self {
                    $($(Self::$shape(_) => ($name, $shape::FACES),)?)*
                    Self::Placed(placed) => placed.shape().about(),
                }
            }

            /// Returns the box and the ball around the shape, if it is bounded.
            #[inline]
            pub(crate) fn around(&self) -> Option<Around> {
                match self {
                    $(Self::$shape(shape) => shape.around()),*
                }
            }

            /// Returns a point of the shape that is farthest in a direction of unit length, or
            /// `None` if the shape is unbounded (the support mapping of E. Gilbert, D. Johnson and
            /// S. Keerthi, A fast procedure for computing the distance between complex objects in
            /// three-dimensional space, 1988).
            #[inline]
            pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
                match self {
                    $(Self::$shape(shape) => shape.support(direction)),*
                }
            }

            /// Returns the first crossing with `0 < t < t_max` of a ray that leaves a face.
            #[inline]
            pub(crate) fn meet(
                &self,
                ray: &Ray,
                leaving: Leaving,
                t_max: f64,
            ) -> Option<Crossing> {
                // All others have their crossings, of which the first is taken.
                if let Self::Rectangle(rectangle) = self {
                    return rectangle.first(ray, leaving, t_max);
                }
                match self {
                    $(Self::$shape(shape) => shape.crossings(ray, leaving).first(t_max)),*
                }
            }

            /// Calls `see` with every crossing with `0 < t < t_max` of a ray that leaves a face, from
            /// near to far.
            pub(crate) fn each_crossing(
                &self,
                ray: &Ray,
                leaving: Leaving,
                t_max: f64,
                see: impl FnMut(Crossing),
            ) {
                match self {
                    $(Self::$shape(shape) => {
                        shape.crossings(ray, leaving).in_front(t_max).for_each(see);
                    })*
                }
            }

            /// Calls `see` with each face and its place beside a point.
            pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
                match self {
                    $(Self::$shape(shape) => shape.each_face(at, see)),*
                }
            }

            /// Returns the unit normal at the point of the ray at `t`, on a face: outward for a closed
            /// shape, along `n` for a flat one.
            pub(crate) fn normal_at(&self, ray: &Ray, Crossing { t, face }: Crossing) -> DVec3 {
                match self {
                    $(Self::$shape(shape) => shape.normal_on(face, ray, t)),*
                }
            }

            /// Returns the solution of the shape's equation for a ray, step by step.
            #[doc(hidden)]
            pub fn working(&self, ray: &Ray) -> Working {
                match self {
                    $(Self::$shape(shape) => shape.working(ray)),*
                }
            }

            /// Calls `see` with every number that defines the shape.
            pub(crate) fn each_number(&self, see: impl FnMut(f64)) {
                match self {
                    $(Self::$shape(shape) => shape.numbers().into_iter().for_each(see)),*
                }
            }

            /// Returns the distance from a point to the farthest point of the shape; infinite if
            /// the shape is unbounded.
            #[inline]
            pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
                match self {
                    $(Self::$shape(shape) => shape.farthest_from(point)),*
                }
            }

            /// Returns the position of an eye relative to the shape.
            #[inline(always)]
            pub(crate) fn membership(&self, eye: DVec3) -> Membership {
                match self {
                    $(Self::$shape(shape) => shape.membership(eye)),*
                }
            }
        }

        $(impl $shape {
            /// Returns the lower and upper corners of the axis-aligned bounding box, or `None` if
            /// the shape is unbounded or the box is not finite in f64.
            pub fn bounds(&self) -> Option<[DVec3; 2]> {
                self.around()?.bounds()
            }

            /// Returns the smallest `t` with `0 < t < t_max` at which the ray hits the shape. An
            /// infinite `t_max` excludes nothing, as an infinite `t` is never a hit.
            pub fn intersect(&self, ray: &Ray, t_max: f64) -> Option<f64> {
                Some(self.crossings(ray, Leaving::NOTHING).first(t_max)?.t)
            }
        })*

        $(impl From<$shape> for Shape {
            fn from(shape: $shape) -> Self {
                Self::$shape(shape.into())
            }
        })*
    };
}

shapes! {
    /// An infinite plane.
    Plane(Arc<Plane>) = "plane",
    /// The surface of a ball.
    Sphere(Sphere) = "sphere",
    /// A round piece of a plane. It is shared, so that no shape needs more memory than a sphere.
    Disc(Arc<Disc>) = "disc",
    /// A parallelogram.
    Rectangle(Arc<Rectangle>) = "rectangle",
    /// A triangle.
    Triangle(Arc<Triangle>) = "triangle",
    /// A box along the axes of the world.
    Cuboid(Arc<Cuboid>) = "box",
    /// A cylinder.
    Cylinder(Arc<Cylinder>) = "cylinder",
    /// A cone or the frustum of one.
    Cone(Arc<Cone>) = "cone",
    /// A capsule: a cylinder with hemispherical ends.
    Capsule(Arc<Capsule>) = "capsule",
    /// An ellipsoid.
    Ellipsoid(Arc<Ellipsoid>) = "ellipsoid",
    /// A torus.
    Torus(Arc<Torus>) = "torus",
    /// Triangles that share their corners.
    Mesh(Arc<Mesh>) = "mesh",
    /// The union, the intersection or the difference of solids.
    Solid(Arc<Solid>) = "solid",
    /// Copies of shapes.
    Instances(Arc<Instances>) = "instances",
    /// Any other shape, mapped by a transform.
    Placed(Arc<Placed>),
}

/// Evaluates an expression for a solid that is not combined from others, and another one for any other
/// shape.
macro_rules! of_solid {
    ($shape:expr, $solid:ident => $value:expr, else $other:expr) => {
        match $shape {
            Shape::Plane($solid) => $value,
            Shape::Sphere($solid) => $value,
            Shape::Cuboid($solid) => $value,
            Shape::Cylinder($solid) if $solid.capped() => $value,
            Shape::Cone($solid) if $solid.capped() => $value,
            Shape::Capsule($solid) => $value,
            Shape::Ellipsoid($solid) => $value,
            Shape::Torus($solid) => $value,
            Shape::Disc(_)
            | Shape::Rectangle(_)
            | Shape::Triangle(_)
            | Shape::Cylinder(_)
            | Shape::Cone(_)
            | Shape::Mesh(_)
            | Shape::Solid(_)
            | Shape::Instances(_)
            | Shape::Placed(_) => $other,
        }
    };
}

pub(crate) use of_solid;

/// What a face bounds, with the first of the faces that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Body {
    /// Nothing: it has no thickness.
    None,
    /// A solid.
    Solid(u64),
    /// What a surface encloses that may be open: a mesh, a cylinder or a cone without ends.
    Shell(u64),
}

/// The extent of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Extent<'a> {
    /// The center and radius of a ball that contains the shape; the radius may be infinite.
    Ball(DVec3, f64),
    /// A plane, which is unbounded.
    Plane(&'a Plane),
}

/// The position of an eye relative to a shape (point membership classification: R. Tilove, Set
/// membership classification, 1980).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Membership {
    /// The eye is outside and sees the shape.
    Outside,
    /// The shape is closed and the eye is inside it. Holds the center and radius of the ball that
    /// it fills.
    Inside(DVec3, f64),
    /// The eye lies exactly on the plane of a flat shape, so no ray hits it. Holds the name of that
    /// plane.
    EdgeOn(&'static str),
}

impl Shape {
    /// Returns the name of the kind of shape.
    pub fn kind(&self) -> &'static str {
        self.about().0
    }

    /// Returns the lower and upper corners of the axis-aligned bounding box, or `None` if the shape is
    /// unbounded or the box is not finite in f64.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        self.around()?.bounds()
    }

    /// Returns the smallest `t` with `0 < t < t_max` at which the ray hits the shape. An infinite
    /// `t_max` excludes nothing, as an infinite `t` is never a hit.
    pub fn intersect(&self, ray: &Ray, t_max: f64) -> Option<f64> {
        Some(self.meet(ray, Leaving::NOTHING, t_max)?.t)
    }

    /// Returns the extent of the shape.
    #[inline]
    pub(crate) fn extent(&self) -> Extent<'_> {
        match (self, self.around()) {
            (Self::Plane(plane), _) => Extent::Plane(plane),
            (_, Some(around)) => around.extent(),
            (_, None) => Extent::Ball(DVec3::ZERO, f64::INFINITY),
        }
    }

    /// Returns the smallest box, given that of [`Shape::bounds`]: that around a shape under a transform
    /// is around its box, and that around an ellipsoid is grown. That around an intersection lies in the
    /// smallest boxes around its operands.
    pub(crate) fn smallest_box(&self, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
        let found = match self {
            Self::Solid(solid) => solid.smallest_box(None),
            Self::Instances(copies) => copies.smallest_box(),
            Self::Placed(placed) if matches!(placed.shape(), Self::Solid(_)) => {
                placed.smallest_box_of_solid()
            }
            Self::Placed(_) | Self::Ellipsoid(_) => Some(self.reach([low, high])),
            _ => None,
        };
        found.unwrap_or([low, high])
    }

    /// Returns the box through the farthest points along the axes.
    fn reach(&self, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
        let end = |sign: f64, at: DVec3| {
            let axes = [DVec3::X, DVec3::Y, DVec3::Z];
            let ends = axes.map(|axis| {
                let farthest = self.support(sign * axis).unwrap_or(at);
                farthest.dot(axis)
            });
            DVec3::from(ends).clamp(low, high)
        };
        [end(-1.0, low), end(1.0, high)]
    }

    /// Returns the smallest box around all of some shapes that are bounded; `None` if there are none.
    pub(crate) fn smallest_box_around(
        shapes: impl IntoIterator<Item = impl Borrow<Self>>,
    ) -> Option<[DVec3; 2]> {
        let mut whole: Option<[DVec3; 2]> = None;
        for shape in shapes {
            let shape = shape.borrow();
            let Some([low, high]) = shape.bounds() else {
                continue;
            };
            // Most lie inside of others.
            let is_inside =
                |[least, most]: [DVec3; 2]| least.cmple(low).all() && most.cmpge(high).all();
            if whole.is_some_and(is_inside) {
                continue;
            }
            let [low, high] = shape.smallest_box([low, high]);
            whole = Some(match whole {
                Some([least, most]) => [least.min(low), most.max(high)],
                None => [low, high],
            });
        }
        whole
    }

    /// Returns the name of the kind of shape, or of one of those that it is: a copy.
    pub(crate) fn kind_of_one(&self) -> &'static str {
        match self.about() {
            (_, Faces::Copies) => "copy",
            (kind, _) => kind,
        }
    }

    /// Returns the kind of faces.
    #[inline]
    pub(crate) fn faces(&self) -> Faces {
        self.about().1
    }

    /// Returns true if the shape has several faces, which [`Hit::face`](crate::tracer::hit::Hit) tells
    /// apart.
    pub fn has_faces(&self) -> bool {
        match self.faces() {
            Faces::Flat | Faces::Curved => false,
            Faces::Several | Faces::Copies => true,
        }
    }

    /// Returns true if the shape is a solid that holds all between two of its points.
    pub(crate) fn is_convex(&self) -> bool {
        of_solid!(self.unplaced(), _solid => !matches!(self.unplaced(), Self::Torus(_)), else false)
    }

    /// Returns true if the shape is flat.
    pub(crate) fn is_flat(&self) -> bool {
        self.faces() == Faces::Flat
    }

    /// Returns the plane that a flat shape lies in, before it is placed.
    pub(crate) fn plane(&self) -> Option<&Plane> {
        match self.unplaced() {
            Self::Plane(plane) => Some(plane),
            Self::Disc(disc) => Some(disc.in_plane()),
            Self::Rectangle(rectangle) => Some(rectangle.in_plane()),
            Self::Triangle(triangle) => Some(triangle.in_plane()),
            _ => None,
        }
    }

    /// Returns what a face bounds, of the faces that belong together.
    pub(crate) fn body(&self, face: u64) -> Body {
        match self {
            Self::Plane(_) => Body::None,
            Self::Solid(_) => Body::Solid(0),
            Self::Mesh(_) => Body::Shell(0),
            Self::Placed(placed) => placed.shape().body(face),
            Self::Instances(copies) => {
                copies
                    .part_of(face)
                    .map_or(Body::None, |(_, shape, inner)| match shape.body(inner) {
                        Body::None => Body::None,
                        Body::Shell(first) => Body::Shell(face - inner + first),
                        Body::Solid(first) => Body::Solid(face - inner + first),
                    })
            }
            shape if shape.is_flat() => Body::None,
            shape => of_solid!(shape, _solid => Body::Solid(0), else Body::Shell(0)),
        }
    }

    /// Returns true if a ray that leaves faces of a solid is inside of it just before or just after its
    /// origin. A solid in copies is told by its first face.
    pub(crate) fn is_inside(&self, ray: &Ray, leaving: Leaving, side: Side, first: u64) -> bool {
        let holds = |span: Span| span.holds(0.0, side);
        match self {
            Self::Solid(solid) => solid.crossings(ray, leaving).is_inside(side),
            Self::Placed(placed) => {
                let inner = placed.transform().ray_back(ray);
                placed.shape().is_inside(&inner, leaving, side, first)
            }
            Self::Instances(copies) => {
                let part = copies.part_of(first);
                let transform = copies.transform(copies.copy_of(first));
                part.zip(transform)
                    .is_some_and(|((_, shape, inner), transform)| {
                        let leaving = leaving.part(first - inner, shape.face_count());
                        shape.is_inside(&transform.ray_back(ray), leaving, side, inner)
                    })
            }
            shape => of_solid!(
                shape,
                solid => match Spans::from(solid.span(ray, leaving)) {
                    Spans::Convex(span) => span.map(Span::around_origin).is_some_and(holds),
                    Spans::Several(spans) => spans.into_iter().flatten().any(holds),
                },
                else false
            ),
        }
    }

    /// Returns true if a face is all of a flat shape: as glass, a pane without thickness.
    pub(crate) fn is_pane(&self, face: u64) -> bool {
        match self {
            Self::Instances(copies) => {
                let part = copies.part_of(face);
                part.is_some_and(|(_, shape, face)| shape.is_pane(face))
            }
            _ => self.is_flat(),
        }
    }

    /// Returns the unit normal of a triangle of a mesh that is shaded as if it were curved.
    pub(crate) fn flat_normal(&self, face: u64) -> Option<DVec3> {
        let mapped = |transform: &Transform, normal| unit(transform.normal(normal));
        match self {
            Self::Mesh(mesh) if mesh.is_smooth() => Some(mesh.plane(face)?.unit_normal()),
            Self::Placed(placed) => {
                let normal = placed.shape().flat_normal(face)?;
                Some(mapped(placed.transform(), normal))
            }
            Self::Instances(copies) => {
                let (_, shape, inner) = copies.part_of(face)?;
                let normal = shape.flat_normal(inner)?;
                Some(mapped(&copies.transform(copies.copy_of(face))?, normal))
            }
            _ => None,
        }
    }

    /// Returns the number of shapes that it is: itself and all inside of it, where copies count as one.
    pub(crate) fn total(&self) -> usize {
        self.copies().map_or(1, |copies| copies.total())
    }

    /// Returns a number that is above those of all faces.
    pub(crate) fn face_count(&self) -> u64 {
        match self {
            Self::Placed(placed) => placed.shape().face_count(),
            Self::Instances(copies) => copies.face_count(),
            Self::Mesh(mesh) => mesh.triangles().len() as u64,
            Self::Solid(solid) => Solid::FACES_OF_PART * solid.parts().len() as u64,
            _ if self.has_faces() => Solid::FACES_OF_PART,
            _ => 1,
        }
    }

    /// Returns the copies, if it is a list of some.
    pub(crate) const fn copies(&self) -> Option<&Arc<Instances>> {
        match self {
            Self::Instances(copies) => Some(copies),
            _ => None,
        }
    }

    /// Returns the sphere, if it is one. Most scenes hold little else, so spheres have fast paths.
    pub(crate) const fn sphere(&self) -> Option<&Sphere> {
        match self {
            Self::Sphere(sphere) => Some(sphere),
            _ => None,
        }
    }

    /// Returns the weights of the corners of the triangle of a mesh at the point where a ray hits it.
    pub(crate) fn weights_at(&self, ray: &Ray, face: u64) -> Option<[f64; 3]> {
        match self {
            Self::Mesh(mesh) => mesh.weights(face, ray),
            Self::Placed(placed) => placed.weights_at(ray, face),
            Self::Instances(copies) => copies.weights_at(ray, face),
            _ => None,
        }
    }

    /// Returns the first crossing of each ray of a bundle. Meshes, solids and copies find all of them at once.
    pub(crate) fn first_of_each(
        &self,
        bundle: &Bundle,
        leaving: &[Leaving; BUNDLE],
    ) -> [Option<Crossing>; BUNDLE] {
        match self {
            Self::Mesh(mesh) => mesh.first_of_each(bundle, leaving),
            Self::Solid(solid) => solid.first_of_each(bundle, leaving),
            Self::Instances(copies) => copies.first_of_each(bundle, leaving),
            _ => bundle.each(|lane, ray, t_max| self.meet(ray, leaving[lane], t_max)),
        }
    }

    /// Returns true if it may get an index.
    pub(crate) fn is_indexed(&self) -> bool {
        self.mesh().is_some() || self.copies().is_some() || self.solid().is_some()
    }

    /// Returns an equal shape without an index, if it may get one.
    #[cfg(test)]
    pub(crate) fn without_index(&self) -> Option<Self> {
        let shape = match self {
            Self::Instances(copies) => {
                let shapes = copies.shapes();
                let shapes = shapes.map(|shape| shape.without_index().unwrap_or(shape.clone()));
                return Some(copies.of_others(shapes).into());
            }
            shape => shape,
        };
        let copy = match (shape.mesh(), shape.solid()) {
            (Some(mesh), _) => {
                let copy = Mesh::new(mesh.vertices().into(), mesh.triangles().into()).ok()?;
                match mesh.is_smooth() {
                    true => copy.smooth().into(),
                    false => copy.into(),
                }
            }
            (None, Some(solid)) => Self::from(solid.clone()),
            (None, None) => return None,
        };
        match self.transform() {
            Some(transform) => copy.placed(&(*transform).into()).ok(),
            None => Some(copy),
        }
    }

    /// Returns the solid that is combined from others, if it is one.
    pub(crate) fn solid(&self) -> Option<&Solid> {
        match self.unplaced() {
            Self::Solid(solid) => Some(solid),
            _ => None,
        }
    }

    /// Returns the mesh, if it is one.
    pub(crate) fn mesh(&self) -> Option<&Mesh> {
        match self {
            Self::Mesh(mesh) => Some(mesh),
            Self::Placed(placed) => placed.shape().mesh(),
            _ => None,
        }
    }
}

impl Extent<'_> {
    /// The radius of the ball; infinite for an unbounded shape.
    pub(crate) const fn radius(&self) -> f64 {
        match self {
            Self::Ball(_, radius) => *radius,
            Self::Plane(_) => f64::INFINITY,
        }
    }
}
