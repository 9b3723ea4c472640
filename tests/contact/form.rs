//! Shapes with equations of their own.

use std::sync::Arc;

use strahl::{
    Plane, Shape, Sphere, Vec3,
    shape::{
        Capsule, Cuboid, Cylinder, Disc, Instances, Mesh, Operation, Rectangle, Solid, Transform,
        Triangle,
    },
};

use crate::line::{
    ALL, Crossing, Line, Span, back, ball, both, combined, half_space, mantle, normal_after, pairs,
    plane, slab, triangle,
};

/// A shape.
#[derive(Clone, Debug)]
pub(crate) enum Form {
    /// A point and the normal; in a solid, the half-space behind it.
    Plane(Vec3, Vec3),
    Disc(Vec3, Vec3, f64),
    /// A corner and two edges.
    Rectangle(Vec3, Vec3, Vec3),
    Triangle([Vec3; 3]),
    Mesh {
        vertices: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        is_smooth: bool,
    },
    Ball(Vec3, f64),
    Cuboid(Vec3, Vec3),
    /// With caps.
    Cylinder(Vec3, Vec3, f64),
    Capsule(Vec3, Vec3, f64),
    Solid(Operation, Vec<Form>),
    Placed(Box<Form>, Transform),
    Copies(Box<Form>, Vec<Transform>),
}

impl Form {
    /// Returns a mesh.
    pub(crate) fn mesh(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Self {
        Self::Mesh {
            vertices: vertices.iter().map(|v| Vec3::from_array(*v)).collect(),
            triangles: triangles.to_vec(),
            is_smooth: false,
        }
    }

    /// Returns the form mapped by a transform.
    pub(crate) fn placed(self, by: Transform) -> Self {
        Self::Placed(Box::new(self), by)
    }

    /// Returns the form with all numbers scaled and moved.
    pub(crate) fn moved(&self, scale: f64, shift: Vec3) -> Self {
        let at = |p: &Vec3| scale * *p + shift;
        let along = |v: &Vec3| scale * *v;
        match self {
            Self::Plane(a, n) => Self::Plane(at(a), *n),
            Self::Disc(c, n, r) => Self::Disc(at(c), *n, scale * r),
            Self::Rectangle(c, u, v) => Self::Rectangle(at(c), along(u), along(v)),
            Self::Triangle(of) => Self::Triangle(of.map(|p| at(&p))),
            Self::Mesh {
                vertices,
                triangles,
                is_smooth,
            } => Self::Mesh {
                vertices: vertices.iter().map(at).collect(),
                triangles: triangles.clone(),
                is_smooth: *is_smooth,
            },
            Self::Ball(c, r) => Self::Ball(at(c), scale * r),
            Self::Cuboid(low, high) => Self::Cuboid(at(low), at(high)),
            Self::Cylinder(a, b, r) => Self::Cylinder(at(a), at(b), scale * r),
            Self::Capsule(a, b, r) => Self::Capsule(at(a), at(b), scale * r),
            Self::Solid(operation, of) => {
                let of = of.iter().map(|form| form.moved(scale, shift));
                Self::Solid(*operation, of.collect())
            }
            Self::Placed(form, by) => {
                let all = Transform::new(shift, None, Vec3::splat(scale)).unwrap();
                form.as_ref().clone().placed(all.times(by).unwrap())
            }
            Self::Copies(form, by) => {
                let all = Transform::new(shift, None, Vec3::splat(scale)).unwrap();
                let by = by.iter().map(|by| all.times(by).unwrap());
                Self::Copies(form.clone(), by.collect())
            }
        }
    }

    /// Returns a smooth mesh.
    pub(crate) fn smooth(self) -> Self {
        match self {
            Self::Mesh {
                vertices,
                triangles,
                ..
            } => Self::Mesh {
                vertices,
                triangles,
                is_smooth: true,
            },
            other => other,
        }
    }

    /// Returns the shape of the library.
    pub(crate) fn shape(&self) -> Shape {
        match self {
            Self::Plane(a, n) => Plane::new(*a, *n).unwrap().into(),
            Self::Disc(c, n, r) => Disc::new(*c, *n, *r).unwrap().into(),
            Self::Rectangle(c, u, v) => Rectangle::new(*c, *u, *v).unwrap().into(),
            Self::Triangle([a, b, c]) => Triangle::new(*a, *b, *c).unwrap().into(),
            Self::Mesh {
                vertices,
                triangles,
                is_smooth,
            } => {
                let mesh = Mesh::new(vertices.clone(), triangles.clone()).unwrap();
                match is_smooth {
                    true => mesh.smooth().into(),
                    false => mesh.into(),
                }
            }
            Self::Ball(c, r) => Sphere::new(*c, *r).unwrap().into(),
            Self::Cuboid(low, high) => Cuboid::new(*low, *high).unwrap().into(),
            Self::Cylinder(a, b, r) => Cylinder::new(*a, *b, *r, true).unwrap().into(),
            Self::Capsule(a, b, r) => Capsule::new(*a, *b, *r).unwrap().into(),
            Self::Solid(operation, of) => {
                let of = of.iter().map(Self::shape);
                Solid::new(*operation, of).unwrap().into()
            }
            Self::Placed(form, by) => form.shape().placed(&Arc::new(*by)).unwrap(),
            Self::Copies(form, by) => Instances::new([form.shape()], by.iter().copied())
                .unwrap()
                .into(),
        }
    }

    /// True if it has an inside.
    pub(crate) fn is_solid(&self) -> bool {
        match self {
            Self::Plane(..)
            | Self::Disc(..)
            | Self::Rectangle(..)
            | Self::Triangle(_)
            | Self::Mesh { .. } => false,
            Self::Ball(..)
            | Self::Cuboid(..)
            | Self::Cylinder(..)
            | Self::Capsule(..)
            | Self::Solid(..) => true,
            Self::Placed(form, _) | Self::Copies(form, _) => form.is_solid(),
        }
    }

    /// True if it is a smooth mesh.
    pub(crate) fn is_smooth(&self) -> bool {
        match self {
            Self::Mesh { is_smooth, .. } => *is_smooth,
            Self::Placed(form, _) | Self::Copies(form, _) => form.is_smooth(),
            _ => false,
        }
    }

    /// Returns the normal of a triangle of a mesh, given its number.
    pub(crate) fn normal_of(&self, face: u64) -> Vec3 {
        match self {
            Self::Mesh {
                vertices,
                triangles,
                ..
            } => {
                let corners = triangles[face as usize % triangles.len()];
                let [a, b, c] = corners.map(|corner| vertices[corner as usize]);
                (b - a).cross(c - a)
            }
            Self::Placed(form, by) => normal_after(by, form.normal_of(face)),
            Self::Copies(form, by) => {
                let copy = face / form.parts();
                normal_after(&by[copy as usize], form.normal_of(face))
            }
            _ => Vec3::ZERO,
        }
    }

    /// The number of triangles of a mesh, else 1.
    fn parts(&self) -> u64 {
        match self {
            Self::Mesh { triangles, .. } => triangles.len() as u64,
            _ => 1,
        }
    }

    /// Returns all crossings of a line.
    pub(crate) fn crossings(&self, line: &Line) -> Vec<Crossing> {
        if self.is_solid() {
            return self.spans(line).into_iter().flatten().collect();
        }
        match self {
            Self::Plane(a, n) => plane(line, *a, *n).into_iter().collect(),
            Self::Disc(c, n, r) => {
                let near = |at: &Crossing| (line.at(at.t) - c).length() <= *r;
                plane(line, *c, *n).into_iter().filter(near).collect()
            }
            Self::Rectangle(c, u, v) => {
                let found = [[*c, c + u, c + u + v], [*c, c + u + v, c + v]];
                let mut found = found.iter().filter_map(|of| triangle(line, of, 0));
                found.next().into_iter().collect()
            }
            Self::Triangle(of) => triangle(line, of, 0).into_iter().collect(),
            Self::Mesh {
                vertices,
                triangles,
                ..
            } => {
                let corners = triangles
                    .iter()
                    .map(|of| of.map(|corner| vertices[corner as usize]));
                (0..)
                    .zip(corners)
                    .filter_map(|(number, of)| triangle(line, &of, number))
                    .collect()
            }
            Self::Placed(form, by) => back(by, line, |line| form.crossings(line)),
            Self::Copies(form, by) => {
                let copies = (0..).zip(by).flat_map(|(copy, by)| {
                    let first = copy * form.parts();
                    let found = back(by, line, |line| form.crossings(line)).into_iter();
                    found.map(move |at| Crossing {
                        part: first + at.part,
                        ..at
                    })
                });
                copies.collect()
            }
            _ => Vec::new(),
        }
    }

    /// Returns the parts of a line inside of a solid.
    pub(crate) fn spans(&self, line: &Line) -> Vec<Span> {
        match self {
            Self::Ball(c, r) => ball(line, *c, *r).into_iter().collect(),
            Self::Cuboid(low, high) => [Vec3::X, Vec3::Y, Vec3::Z]
                .into_iter()
                .map(|n| slab(line, [low.dot(n), high.dot(n)], n))
                .fold(Some(ALL), both)
                .into_iter()
                .collect(),
            Self::Cylinder(a, b, r) => {
                let axis = *b - *a;
                let caps = slab(line, [a.dot(axis), b.dot(axis)], axis);
                both(mantle(line, *a, axis, *r), caps).into_iter().collect()
            }
            Self::Capsule(a, b, r) => {
                let middle = Self::Cylinder(*a, *b, *r).spans(line);
                let ends = [*a, *b].into_iter().filter_map(|c| ball(line, c, *r));
                let all: Vec<_> = middle.into_iter().chain(ends).flatten().collect();
                let by = |a: &&Crossing, b: &&Crossing| a.t.total_cmp(&b.t);
                let ends = all.iter().min_by(by).zip(all.iter().max_by(by));
                ends.map(|(from, to)| [*from, *to]).into_iter().collect()
            }
            Self::Plane(a, n) => half_space(line, *a, *n).into_iter().collect(),
            Self::Solid(operation, of) => {
                let of: Vec<_> = of.iter().map(|form| form.spans(line)).collect();
                combined(line, *operation, &of)
            }
            Self::Placed(form, by) => {
                let ends = |line: &Line| form.spans(line).into_iter().flatten().collect();
                pairs(back(by, line, ends))
            }
            Self::Copies(form, by) => {
                let ends = |line: &Line| form.spans(line).into_iter().flatten().collect();
                let of: Vec<_> = by.iter().map(|by| pairs(back(by, line, ends))).collect();
                combined(line, Operation::Union, &of)
            }
            _ => Vec::new(),
        }
    }
}
