//! A mesh: triangles that share their corners.

use std::fmt;

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    ray::{BUNDLE, Bundle, Ray},
    shape::{
        Membership,
        around::{Around, farthest, triangle_holds},
        contact::{ContactPoint, NearFace},
        face::{Crossing, Faces, Leaving, in_front},
        indexed::Indexed,
        plane::Plane,
        triangle::{Sheared, see_triangle},
        working::{Term, Working},
    },
    vector::{finite, is_direction, unit, weighted},
};

/// A triangle mesh, seen from both sides.
///
/// A ray hits what it hits of the triangles alone, as [`Triangle`](super::Triangle) defines it: the
/// smallest `t`, and at equal `t` the triangle that comes first. Face `i` is triangle `i`. A triangle
/// whose corners lie on a line is never hit.
pub struct Mesh {
    vertices: Box<[DVec3]>,
    triangles: Box<[[u32; 3]]>,
    around: Around,
    /// The unit normals of the vertices if the mesh is smooth; 0 where there is none.
    normals: Option<Box<[DVec3]>>,
    uv: MeshUv,
    groups: Box<[MeshGroup]>,
    index: Indexed<dyn Index>,
}

/// The texture coordinates of the corners of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MeshUv {
    /// All coordinates, in any order.
    pub(crate) all: Vec<[f64; 2]>,
    /// The numbers of those of the corners of each triangle; a triangle with a corner without any, whose number
    /// does not exist, has none. Empty if no triangle has some.
    pub(crate) corners: Vec<[u32; 3]>,
}

/// A name for triangles of a mesh: from one on, up to the first of the next name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshGroup {
    /// The name; it may be empty, and groups may have equal names.
    pub name: String,
    /// The number of the first triangle.
    pub first: usize,
}

/// The factor that turns a smooth normal to the side of the face: what it has along the ray becomes
/// 1024 times less and changes its sign.
const TURN: f64 = 1.0 + 1.0 / 1024.0;

/// Finds the crossings of a ray with a mesh faster than the loop over all triangles, with the same
/// bits.
pub(crate) trait Index: fmt::Debug + Send + Sync {
    /// Returns the crossing with the smallest `t`, `0 < t < t_max`; at equal `t` the one with the
    /// lowest number.
    fn first(&self, passage: &Passage, t_max: f64) -> Option<Crossing>;

    /// Returns [`Index::first`] for each ray of a bundle.
    fn first_of_each(
        &self,
        mesh: &Mesh,
        bundle: &Bundle,
        leaving: &[Leaving; BUNDLE],
    ) -> [Option<Crossing>; BUNDLE];

    /// Returns the corners of a triangle. Those of one that a ray has just met are near at hand.
    fn corners(&self, face: u64) -> Option<[DVec3; 3]>;

    /// Calls `see` with each crossing with `0 < t < t_max`, in any order.
    fn each(&self, passage: &Passage, t_max: f64, see: &mut dyn FnMut(Crossing));

    /// Calls `see` with each triangle whose box meets another one, and maybe with others near it.
    fn each_near(&self, corners: [DVec3; 2], see: &mut dyn FnMut(u64, [DVec3; 3]));
}

/// The traversal of a mesh by a ray.
#[derive(Debug)]
pub(crate) struct Passage<'a> {
    mesh: &'a Mesh,
    ray: &'a Ray,
    leaving: Leaving<'a>,
}

impl Mesh {
    /// Creates a mesh from the corners of its triangles and, for each triangle, the numbers of its
    /// three corners, from 0. Its normal is `(b - a) × (c - a)`.
    ///
    /// Corners that no triangle has are dropped.
    ///
    /// # Errors
    ///
    /// Returns an error if a coordinate of a corner is not finite, if a triangle has a corner that does not
    /// exist, or if there is no triangle.
    pub fn new(vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self, GeometryError> {
        let (mesh, _) = Self::with(vertices, triangles, Vec::<()>::new())?;
        Ok(mesh)
    }

    /// The same with a value for each corner, or with no values. Also returns the values of the corners
    /// that were not dropped.
    pub(crate) fn with<T>(
        vertices: Vec<DVec3>,
        mut triangles: Vec<[u32; 3]>,
        of_vertices: Vec<T>,
    ) -> Result<(Self, Vec<T>), GeometryError> {
        let count = triangles.len();
        if count == 0 || u32::try_from(count).is_err() {
            return Err(GeometryError::OutOfRange {
                name: "number of triangles",
                value: count as f64,
                range: [1.0, f64::from(u32::MAX)],
            });
        }
        let mut is_used = vec![false; vertices.len()];
        for (triangle, corner) in (0..).zip(&triangles).flat_map(|(number, corners)| {
            let corners = corners.iter();
            corners.map(move |corner| (number, *corner))
        }) {
            match is_used.get_mut(corner as usize) {
                Some(is_used) => *is_used = true,
                None => {
                    return Err(GeometryError::NoVertex {
                        triangle,
                        vertex: corner,
                        vertices: vertices.len(),
                    });
                }
            }
        }
        renumber(&is_used, &mut triangles);
        let vertices = used(vertices, &is_used);
        for vertex in &vertices {
            finite(*vertex, "vertices")?;
        }
        let mesh = Self {
            around: Around::points(&vertices),
            vertices: vertices.into(),
            triangles: triangles.into(),
            normals: None,
            uv: MeshUv::default(),
            groups: Box::default(),
            index: Indexed::none(),
        };
        Ok((mesh, used(of_vertices, &is_used)))
    }

    /// Shades the mesh like a curved surface: the normal of a hit is interpolated between those of the
    /// corners, which are the means of the triangles around them, by area. It lies on the side of the
    /// ray on which the triangle's own normal lies.
    #[must_use]
    pub fn smooth(self) -> Self {
        let mut sums = vec![DVec3::ZERO; self.vertices.len()];
        for (face, corners) in (0..).zip(&self.triangles) {
            let Some(plane) = self.plane(face) else {
                continue;
            };
            for corner in corners {
                if let Some(sum) = sums.get_mut(*corner as usize) {
                    *sum += plane.normal();
                }
            }
        }
        let normals = sums.into_iter().map(|sum| match is_direction(sum) {
            true => unit(sum),
            false => DVec3::ZERO,
        });
        Self {
            normals: Some(normals.collect()),
            ..self
        }
    }

    /// Gives the corners of triangles texture coordinates.
    #[must_use]
    pub(crate) fn with_uv(self, uv: MeshUv) -> Self {
        Self { uv, ..self }
    }

    /// Returns the texture coordinates of the corners of a triangle, if it has some.
    pub(crate) fn corner_uv(&self, face: u64) -> Option<[[f64; 2]; 3]> {
        let numbers = *self.uv.corners.get(face as usize)?;
        let [a, b, c] = numbers.map(|number| self.uv.all.get(number as usize).copied());
        Some([a?, b?, c?])
    }

    /// Returns true if triangles have texture coordinates.
    pub(crate) const fn has_uv(&self) -> bool {
        !self.uv.corners.is_empty()
    }

    /// Gives names to triangles. What the mesh looks like, and whether it is equal to another, does not
    /// depend on them. Groups without triangles are dropped.
    #[must_use]
    pub fn with_groups(mut self, mut groups: Vec<MeshGroup>) -> Self {
        groups.sort_by_key(|group| group.first);
        let firsts: Vec<_> = groups.iter().skip(1).map(|group| group.first).collect();
        let mut ends = firsts.into_iter().chain([self.triangles.len()]);
        groups.retain(|group| ends.next().is_some_and(|end| group.first < end));
        self.groups = groups.into();
        self
    }

    /// The names of triangles, in ascending order. Those before the first one have none.
    pub const fn groups(&self) -> &[MeshGroup] {
        &self.groups
    }

    /// Returns the group of a triangle, if it has one.
    pub fn group_of(&self, triangle: usize) -> Option<&MeshGroup> {
        let after = self.groups.partition_point(|group| group.first <= triangle);
        self.groups.get(after.checked_sub(1)?)
    }

    /// Returns true if the mesh is shaded like a curved surface.
    pub const fn is_smooth(&self) -> bool {
        self.normals.is_some()
    }

    /// The corners of the triangles.
    pub const fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// The numbers of the corners of each triangle.
    pub const fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns the corners of a triangle.
    #[inline]
    pub(crate) fn corners(&self, face: u64) -> Option<[DVec3; 3]> {
        match self.index.get() {
            Some(index) => index.corners(face),
            None => self.of_corners(&self.vertices, face),
        }
    }

    /// Returns what the corners of a triangle have.
    #[inline]
    fn of_corners(&self, all: &[DVec3], face: u64) -> Option<[DVec3; 3]> {
        let [a, b, c] = *self.triangles.get(face as usize)?;
        let corner = |number: u32| all.get(number as usize).copied();
        Some([corner(a)?, corner(b)?, corner(c)?])
    }

    /// Returns the lower and upper corners of the box around a triangle.
    pub(crate) fn box_of(&self, face: u64) -> Option<[DVec3; 2]> {
        Some(box_around(self.corners(face)?))
    }

    /// Answers with an index from now on, unless there is one already.
    pub(crate) fn index_with(&self, build: impl FnOnce(&Self) -> Option<Box<dyn Index>>) {
        self.index.build(|| build(self));
    }

    pub(crate) const fn around(&self) -> Option<Around> {
        Some(self.around)
    }

    pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
        let farther = |one: DVec3, other: DVec3| match other.dot(direction) > one.dot(direction) {
            true => other,
            false => one,
        };
        self.vertices.iter().copied().reduce(farther)
    }

    pub(crate) const FACES: Faces = Faces::Several;

    #[inline]
    pub(crate) fn crossings<'a>(&'a self, ray: &'a Ray, leaving: Leaving<'a>) -> Passage<'a> {
        Passage {
            mesh: self,
            ray,
            leaving,
        }
    }

    /// Returns the first crossing of each ray of a bundle.
    pub(crate) fn first_of_each(
        &self,
        bundle: &Bundle,
        leaving: &[Leaving; BUNDLE],
    ) -> [Option<Crossing>; BUNDLE] {
        match self.index.get() {
            Some(index) => index.first_of_each(self, bundle, leaving),
            None => bundle.each(|lane, ray, t_max| {
                let passage = self.crossings(ray, leaving[lane]);
                passage.first_of_all(t_max)
            }),
        }
    }

    pub(crate) fn plane(&self, face: u64) -> Option<Plane> {
        plane_of(self.corners(face)?)
    }

    pub(crate) fn normal_on(&self, face: u64, ray: &Ray, _: f64) -> DVec3 {
        // Every face that is hit has a plane.
        let plane = self.plane(face);
        let flat = plane.map_or(DVec3::Z, |plane| plane.unit_normal());
        self.smooth_normal(face, ray, flat).unwrap_or(flat)
    }

    pub(crate) fn each_face(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        self.each_near(at.around(), &mut |face, corners| {
            if at.is_near(box_around(corners)) {
                see_triangle(at, face, corners, see);
            }
        });
    }

    /// Calls `see` with the corners of each triangle whose box meets another one, and maybe with those of
    /// others.
    pub(crate) fn each_near(&self, around: [DVec3; 2], see: &mut dyn FnMut(u64, [DVec3; 3])) {
        match self.index.get() {
            Some(index) => index.each_near(around, see),
            None => (0..self.triangles.len() as u64).for_each(|face| {
                if let Some(corners) = self.corners(face) {
                    see(face, corners);
                }
            }),
        }
    }

    /// Returns the weights of the corners of a triangle at the point where a ray hits it.
    pub(crate) fn weights(&self, face: u64, ray: &Ray) -> Option<[f64; 3]> {
        Some(
            Sheared::new(ray)
                .edges(self.corners(face)?.each_ref())
                .weights(),
        )
    }

    /// Returns the normal that is interpolated between the corners, if the mesh is smooth and there is
    /// one on the side of the face.
    fn smooth_normal(&self, face: u64, ray: &Ray, flat: DVec3) -> Option<DVec3> {
        let normals = self.of_corners(self.normals.as_ref()?, face)?;
        let mean = weighted(normals, self.weights(face, ray)?);
        let d = ray.direction();
        let is_front = |normal: DVec3| d.dot(normal) < 0.0;
        let on_side = |normal: DVec3| {
            let normal = is_direction(normal).then(|| unit(normal))?;
            (is_front(normal) == is_front(flat)).then_some(normal)
        };
        on_side(mean).or_else(|| on_side(mean - (TURN * (mean.dot(d) / d.dot(d))) * d))
    }

    pub(crate) fn working(&self, ray: &Ray) -> Working {
        let passage = self.crossings(ray, Leaving::NOTHING);
        let all: Vec<Crossing> = passage.in_front(f64::INFINITY).collect();
        let mut parts = vec![
            Term::number("triangles", "triangles", self.triangles.len() as f64),
            Term::number("vertices", "vertices", self.vertices.len() as f64),
        ];
        let mut lines = Vec::new();
        let first = all.first().map(|crossing| crossing.face);
        if let Some(face) = first
            && let Some(corners) = self.corners(face)
        {
            let [a, b, c] = corners;
            parts.extend([
                Term::number("triangle", "triangle", face as f64),
                Term::vector("a", "a", a),
                Term::vector("b", "b", b),
                Term::vector("c", "c", c),
            ]);
            let sheared = Sheared::new(ray);
            lines.push(vec![sheared.term()]);
            lines.extend(sheared.terms("", corners));
            let normals = self.normals.as_ref();
            if let Some([a, b, c]) = normals.and_then(|all| self.of_corners(all, face)) {
                lines.push(vec![
                    Term::vector("normal_a", "n_a", a),
                    Term::vector("normal_b", "n_b", b),
                    Term::vector("normal_c", "n_c", c),
                ]);
            }
        }
        Working {
            form: None,
            parts,
            lines,
            solutions: match all.is_empty() {
                true => Err("the ray misses all triangles"),
                false => Ok(all.iter().map(|crossing| crossing.t).collect()),
            },
            name: Some("crossings"),
        }
    }

    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        let vertices = self.vertices.iter().flat_map(|vertex| vertex.to_array());
        let corners = self.triangles.iter().flatten();
        let is_smooth = f64::from(u8::from(self.is_smooth()));
        let corners = corners.map(|corner| f64::from(*corner));
        let uv = self.uv.all.iter().flatten().copied();
        let of_uv = self.uv.corners.iter().flatten();
        let of_uv = of_uv.map(|number| f64::from(*number));
        let flat = vertices.chain(corners).chain([is_smooth]);
        flat.chain(uv).chain(of_uv)
    }

    pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
        farthest(&self.vertices, point)
    }

    pub(crate) const fn membership(&self, _: DVec3) -> Membership {
        Membership::Outside
    }
}

/// Returns the plane of a triangle with these corners.
/// Returns the corners of the box around a triangle.
pub(crate) fn box_around([a, b, c]: [DVec3; 3]) -> [DVec3; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

#[inline(always)]
pub(crate) fn plane_of([a, b, c]: [DVec3; 3]) -> Option<Plane> {
    Plane::at(a, (b - a).cross(c - a))
}

/// Renumbers the corners of triangles for the vertices that are used.
fn renumber(is_used: &[bool], triangles: &mut [[u32; 3]]) {
    if is_used.iter().all(|is_used| *is_used) {
        return;
    }
    let places = is_used.iter().scan(0, |next, is_used| {
        let place = *next;
        *next += u32::from(*is_used);
        Some(place)
    });
    let places: Vec<u32> = places.collect();
    for corner in triangles.iter_mut().flatten() {
        if let Some(place) = places.get(*corner as usize) {
            *corner = *place;
        }
    }
}

/// Returns what the used vertices have.
fn used<T>(mut of_vertices: Vec<T>, is_used: &[bool]) -> Vec<T> {
    let mut is_used = is_used.iter();
    of_vertices.retain(|_| is_used.next().copied().unwrap_or(false));
    of_vertices
}

impl Passage<'_> {
    /// The ray.
    #[inline(always)]
    pub(crate) const fn ray(&self) -> &Ray {
        self.ray
    }

    /// Returns the crossing with a triangle if `0 < t < t_max`.
    #[inline]
    fn cross(&self, sheared: &Sheared, face: u64, t_max: f64) -> Option<Crossing> {
        let corners = self.mesh.corners(face)?;
        let t = in_front(sheared.edges(corners.each_ref()).t()?, t_max)?;
        // Few triangles come so far.
        self.counts(face, corners, t)
            .then_some(Crossing { t, face })
    }

    /// Returns true if the crossing of a triangle's equation counts: the ray does not leave its plane,
    /// and the point lies around it.
    #[inline(always)]
    pub(crate) fn counts(&self, face: u64, corners: [DVec3; 3], t: f64) -> bool {
        plane_of(corners).is_some()
            && !self.leaving.has(face)
            && triangle_holds(corners, self.ray, t)
    }

    /// Returns the ray as the test of triangles needs it.
    #[inline(always)]
    pub(crate) fn sheared(&self) -> Sheared {
        Sheared::new(self.ray)
    }

    /// Returns the first crossing with `0 < t < t_max`.
    pub(crate) fn first(&self, t_max: f64) -> Option<Crossing> {
        match self.mesh.index.get() {
            Some(index) => index.first(self, t_max),
            None => self.first_of_all(t_max),
        }
    }

    /// Returns the first crossing by testing all triangles: the definition.
    // Not inlined: the fast path is short.
    #[inline(never)]
    pub(crate) fn first_of_all(&self, t_max: f64) -> Option<Crossing> {
        let sheared = self.sheared();
        let mut first: Option<Crossing> = None;
        for face in self.faces() {
            let t_max = first.map_or(t_max, |crossing| crossing.t);
            first = self.cross(&sheared, face, t_max).or(first);
        }
        first
    }

    /// Calls `see` with each crossing with `0 < t < t_max`, in the order of the triangles.
    pub(crate) fn each_of_all(&self, t_max: f64, see: &mut dyn FnMut(Crossing)) {
        let sheared = self.sheared();
        self.faces()
            .filter_map(|face| self.cross(&sheared, face, t_max))
            .for_each(see);
    }

    /// Returns the crossings with `0 < t < t_max`, from near to far; at equal `t` in the order of the
    /// triangles.
    pub(crate) fn in_front(&self, t_max: f64) -> impl Iterator<Item = Crossing> + use<> {
        let mut all = Vec::new();
        let mut see = |crossing| all.push(crossing);
        match self.mesh.index.get() {
            Some(index) => index.each(self, t_max, &mut see),
            None => self.each_of_all(t_max, &mut see),
        }
        all.sort_unstable_by(|one, other| {
            let by_t = one.t.total_cmp(&other.t);
            by_t.then(one.face.cmp(&other.face))
        });
        all.into_iter()
    }

    fn faces(&self) -> std::ops::Range<u64> {
        0..self.mesh.triangles.len() as u64
    }
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
            || (self.is_smooth() == other.is_smooth()
                && self.vertices == other.vertices
                && self.triangles == other.triangles
                && self.uv == other.uv)
    }
}

impl fmt::Debug for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mesh")
            .field("vertices", &self.vertices)
            .field("triangles", &self.triangles)
            .field("is_smooth", &self.is_smooth())
            .finish_non_exhaustive()
    }
}
