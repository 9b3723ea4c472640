//! Contact: the faces that a point lies on, and what a ray crosses where it begins.
//!
//! A point where a ray has arrived lies on every face that is nearer to it than the rounding of its own
//! numbers (see [`shape::contact`](crate::tracer::shape)). A ray that leaves it leaves them all: for that
//! ray, the equation of each of these faces is 0 at its origin. It begins on the side from which the point
//! was seen, or on the other side if it goes through glass there. So it crosses at its origin, before all
//! else,
//!
//! - the surface of a solid if the ray begins inside of it and goes on outside, or the other way round;
//! - a face without thickness if the side on which the ray begins is not the one on which it goes on,
//!   unless it is the face that was hit or one that is parallel to it. Beside an edge of a face, the path of
//!   both rays must pass through the face.
//!
//! Glass that meets at a point is one interface: between the first solid of glass in the list that is left
//! there, else air, and the first that is entered, else air. Where none is, the first pane counts.

use std::{cell::Cell, ops::Range, slice, sync::Arc};

use glam::DVec3;

use crate::tracer::{
    hit::Hit,
    material::{
        glass::{Fresnel, Glass},
        microfacet::Microfacets,
    },
    radiance::Radiance,
    ray::Ray,
    shape::{
        Body,
        contact::{ContactPoint, NearFace},
        face::{Crossing, FaceId, Leaving},
        span::Side,
    },
    vector::unit,
    world::World,
};

/// The sine of the largest angle at which two faces count as parallel: 2⁻²⁰.
const PARALLEL: f64 = 1.0 / (1 << 20) as f64;

/// The part of the numbers of a crossing by which two crossings may lie apart and be one: 64 roundings.
const TOGETHER: f64 = 64.0 * f64::EPSILON;

/// Several faces that the point of a hit lies on.
#[derive(Debug)]
pub(crate) struct Contact {
    /// In ascending order.
    ids: Vec<FaceId>,
    /// In the same order.
    faces: Vec<NearFace>,
    /// The arriving ray.
    ray: Ray,
    t: f64,
}

/// Where a ray begins: on the faces that its origin lies on, and on one side of each.
#[derive(Clone, Debug)]
pub(crate) struct Departure {
    /// The face that was hit.
    own: FaceId,
    /// All of the faces, if there are more.
    contact: Option<Arc<Contact>>,
    /// The origin of the arriving ray and its `t`, as long as it is not known whether there are more.
    arrival: Cell<Option<(DVec3, f64)>>,
    /// The direction of the arriving ray: this one begins just before or just after its origin on that line.
    along: DVec3,
    side: Side,
}

/// What a ray crosses at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Crossed {
    Nothing,
    /// A face that is not glass.
    Opaque(FaceId),
    Glass(Interface),
}

/// A surface of glass: between glass and air, between two glasses, or a pane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interface {
    /// The face whose normal counts.
    pub(crate) face: FaceId,
    /// The glass before it; `None` for air.
    before: Option<Glass>,
    /// The glass behind it. That of a pane lies behind it and ends there.
    behind: Option<Glass>,
    pub(crate) is_pane: bool,
}

/// Something in the way of light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passed {
    pub(crate) face: FaceId,
    /// The ray parameter.
    pub(crate) t: f64,
    /// The part of the light that comes through.
    pub(crate) factor: Radiance,
    /// The glass that it is, if it is some.
    pub(crate) glass: Option<Interface>,
}

/// The glass that a ray crosses at one point: the first of each kind in the list.
#[derive(Default)]
struct GlassCrossed {
    left: Option<(FaceId, Glass)>,
    entered: Option<(FaceId, Glass)>,
    pane: Option<(FaceId, Glass)>,
}

impl World {
    /// Returns the faces that the point of a crossing lies on; `None` if it lies on one alone. `each` calls
    /// back with the index of every geometry that may meet a box around the point.
    pub(crate) fn contact(
        &self,
        ray: &Ray,
        (index, crossing): (usize, Crossing),
        each: impl Fn([DVec3; 2], &mut dyn FnMut(usize)),
    ) -> Option<Contact> {
        let own = FaceId {
            geometry: index,
            face: crossing.face,
        };
        // Nearly always, the point is far from all others.
        let point = ContactPoint::vague(ray, crossing.t);
        let shape = self.geometries()[index].shape();
        let has_faces = shape.has_faces();
        let mut is_alone = true;
        each(point.around(), &mut |geometry| {
            if is_alone && (geometry != index || has_faces) {
                let shape = self.geometries()[geometry].shape();
                shape.each_face_near(&point, &mut |near| {
                    let is_own = geometry == index && near.face == own.face;
                    is_alone &= is_own || !near.is_touched;
                });
            }
        });
        if is_alone {
            return None;
        }
        let mut distance = f64::INFINITY;
        shape.each_face(&point, &mut |near| {
            if near.face == own.face {
                distance = near.distance;
            }
        });
        let point = point.at_distance(distance);
        let mut all = Vec::new();
        each(point.around(), &mut |geometry| {
            let shape = self.geometries()[geometry].shape();
            shape.each_face_near(&point, &mut |near| {
                let face = near.face;
                let id = FaceId { geometry, face };
                if near.is_touched || id == own {
                    all.push((id, *near));
                }
            });
        });
        if !all.iter().any(|(id, _)| *id == own) {
            all.push((own, NearFace::far(own.face)));
        }
        all.sort_unstable_by_key(|(id, _)| *id);
        let (ids, faces): (Vec<_>, _) = all.into_iter().unzip();
        (ids.len() > 1).then_some(Contact {
            ids,
            faces,
            ray: *ray,
            t: crossing.t,
        })
    }

    /// The same among all geometries: the definition.
    pub(crate) fn contact_among_all(&self, ray: &Ray, hit: (usize, Crossing)) -> Option<Contact> {
        self.contact(ray, hit, |_, see| {
            (0..self.geometries().len()).for_each(see)
        })
    }

    /// Returns the hit of a ray at a `t` on a face.
    pub(crate) fn hit_on(&self, ray: &Ray, t: f64, id: FaceId) -> Hit<'_> {
        let FaceId { geometry, face } = id;
        self.geometries()[geometry].hit_at(ray, Crossing { t, face })
    }

    /// Returns what is in the way of light at the origin of a ray.
    pub(crate) fn at_origin(&self, ray: &Ray, start: &Departure) -> Option<Passed> {
        let hit = |face| self.hit_on(ray, 0.0, face);
        let (face, factor, glass) = match start.crossed(self, ray.direction()) {
            Crossed::Nothing => return None,
            Crossed::Opaque(face) => (face, Radiance::BLACK, None),
            Crossed::Glass(interface) => {
                let passes = interface.passes(hit(interface.face), ray);
                (interface.face, passes, Some(interface))
            }
        };
        Some(Passed {
            face,
            t: 0.0,
            factor,
            glass,
        })
    }

    /// Calls `see` with what is in the way of light at some crossings of a ray, from near to far. Those that
    /// only rounding errors may have parted are one.
    pub(crate) fn each_passed(
        &self,
        ray: &Ray,
        mut all: Vec<(FaceId, f64)>,
        mut see: impl FnMut(Passed),
    ) {
        all.sort_by(|(one, t), (other, last)| t.total_cmp(last).then(one.cmp(other)));
        let hits = all.into_iter().map(|(id, t)| (id, self.hit_on(ray, t, id)));
        let hits: Vec<_> = hits.collect();
        let l = unit(ray.direction());
        let length = ray.direction().length();
        let cosine = |hit: &Hit| l.dot(hit.normal).abs();
        let are_one = |(_, one): &(FaceId, Hit), (_, other): &(FaceId, Hit)| {
            let far = (ray.origin().abs()).max((other.t * ray.direction()).abs());
            let apart = (other.t - one.t) * length;
            apart * cosine(one).min(cosine(other)) <= TOGETHER * far.max_element()
        };
        for group in hits.chunk_by(are_one) {
            let Some(&(face, hit)) = group.first() else {
                continue;
            };
            let (factor, glass) = match self.crossed_together(group) {
                Crossed::Nothing => (Radiance::WHITE, None),
                Crossed::Opaque(_) => (Radiance::BLACK, None),
                Crossed::Glass(interface) => {
                    let hit = match interface.face == face {
                        true => hit,
                        false => self.hit_on(ray, hit.t, interface.face),
                    };
                    (interface.passes(hit, ray), Some(interface))
                }
            };
            let t = hit.t;
            see(Passed {
                face,
                t,
                factor,
                glass,
            });
        }
    }

    /// Returns what a ray crosses at crossings that are one, given its hits.
    fn crossed_together(&self, group: &[(FaceId, Hit)]) -> Crossed {
        if let [(id, hit)] = group
            && let Some(glass) = hit.material().glass()
        {
            // As nearly always.
            let is_pane = self.body_of(id) == Body::None;
            return Crossed::Glass(Interface::alone(*id, *glass, hit.front_face, is_pane));
        }
        let mut all = group.to_vec();
        all.sort_by_key(|(id, _)| *id);
        let normals = all.iter().map(|(id, hit)| self.sided(id, hit.normal));
        let normals: Vec<_> = normals.collect();
        let shown = (0..all.len()).find(|place| !is_joint(&normals, *place));
        let mut found = GlassCrossed::default();
        for body in all.chunk_by(|(one, _), (other, _)| self.are_of_one(one, other)) {
            let Some((id, hit)) = body.first() else {
                continue;
            };
            let glass = hit.material().glass().copied();
            if glass.is_none() || body.iter().any(|(_, hit)| hit.material().glass().is_none()) {
                return Crossed::Opaque(*id);
            }
            let depth = match self.body_of(id) {
                Body::None => None,
                // How often it is entered more than left.
                _ => Some(
                    body.iter()
                        .map(|(_, hit)| if hit.front_face { 1 } else { -1 })
                        .sum(),
                ),
            };
            found.add(*id, glass, depth);
        }
        found.crossed(shown.map(|place| all[place].0))
    }

    fn body_of(&self, id: &FaceId) -> Body {
        self.geometries()[id.geometry].shape().body(id.face)
    }

    /// Returns the normal of a face, and 0 if its sides are alike.
    fn sided(&self, id: &FaceId, normal: DVec3) -> DVec3 {
        match self.body_of(id) {
            Body::None => DVec3::ZERO,
            Body::Solid(_) | Body::Shell(_) => normal,
        }
    }

    /// Returns true if two faces bound the same body.
    fn are_of_one(&self, one: &FaceId, other: &FaceId) -> bool {
        let body = self.body_of(one);
        one.geometry == other.geometry && body != Body::None && body == self.body_of(other)
    }
}

/// Returns true if another face lies against the one at a place, turned the other way: then it shows only
/// if no other face does.
fn is_joint(normals: &[DVec3], place: usize) -> bool {
    let is_against = |n: &DVec3| normals[place].dot(*n) < 0.0 && are_parallel(normals[place], *n);
    normals.iter().any(is_against)
}

/// Returns true if two unit vectors are parallel.
fn are_parallel(one: DVec3, other: DVec3) -> bool {
    one.cross(other).length() <= PARALLEL
}

impl GlassCrossed {
    /// Adds glass that is crossed at a face: a pane, or a solid that is entered (above 0), left (below 0), or
    /// neither.
    fn add(&mut self, face: FaceId, glass: Option<Glass>, depth: Option<i32>) {
        let place = match depth {
            None => &mut self.pane,
            Some(1..) => &mut self.entered,
            Some(..0) => &mut self.left,
            Some(0) => return,
        };
        *place = place.or(glass.map(|glass| (face, glass)));
    }

    /// Returns what is crossed, with the normal of a face if that is given.
    fn crossed(&self, shown: Option<FaceId>) -> Crossed {
        let solids = [self.left, self.entered].into_iter().flatten();
        let first = solids.map(|(face, _)| face).min();
        Crossed::Glass(match (first, self.pane) {
            (Some(first), _) => Interface {
                face: shown.unwrap_or(first),
                before: self.left.map(|(_, glass)| glass),
                behind: self.entered.map(|(_, glass)| glass),
                is_pane: false,
            },
            (None, Some((face, glass))) => Interface::pane(face, glass),
            (None, None) => return Crossed::Nothing,
        })
    }
}

impl Interface {
    /// Creates a pane, whose other side counts for nothing.
    const fn pane(face: FaceId, glass: Glass) -> Self {
        Self {
            face,
            before: None,
            behind: Some(glass),
            is_pane: true,
        }
    }

    /// Creates the surface of a single solid of glass, or a pane.
    pub(crate) const fn alone(face: FaceId, glass: Glass, is_entered: bool, is_pane: bool) -> Self {
        match (is_pane, is_entered) {
            (true, _) => Self::pane(face, glass),
            (false, true) => Self {
                face,
                before: None,
                behind: Some(glass),
                is_pane,
            },
            (false, false) => Self {
                face,
                before: Some(glass),
                behind: None,
                is_pane,
            },
        }
    }

    /// Returns the indices of refraction before and behind it.
    pub(crate) fn media(&self) -> [f64; 2] {
        [self.before, self.behind].map(|glass| glass.map_or(1.0, |glass| glass.ior()))
    }

    /// Returns true if light goes on as if there were nothing, but for the color.
    pub(crate) fn is_joint(&self) -> bool {
        let [before, behind] = self.media();
        self.before.is_some() && self.behind.is_some() && before == behind
    }

    /// Returns the normals of its tiny mirrors: those of the rougher glass. Where light is not bent, there is
    /// nothing to see of them.
    pub(crate) fn facets(&self) -> Option<Microfacets> {
        let [one, other] = self.media();
        if one == other {
            return None;
        }
        let all = [self.before, self.behind].into_iter().flatten();
        let rough = all.filter(|glass| !glass.facets().is_smooth());
        let rougher = rough.max_by(|one, other| one.roughness().total_cmp(&other.roughness()));
        Some(*rougher?.facets())
    }

    /// The factor of light that comes through.
    pub(crate) fn color(&self) -> Radiance {
        let mut all = [self.before, self.behind].into_iter().flatten();
        let first = all.next().map(|glass| glass.color().to_linear());
        let first = first.unwrap_or(Radiance::WHITE);
        all.fold(first, |color, glass| color * glass.color().to_linear())
    }

    /// Returns what light does there that arrives at an angle with this cosine.
    pub(crate) fn fresnel(&self, cosine: f64) -> Fresnel {
        match (self.before, self.behind) {
            (Some(before), None) => before.fresnel(cosine, false),
            (None, Some(behind)) => behind.fresnel(cosine, true),
            _ => {
                let [before, behind] = self.media();
                Fresnel::new(cosine, behind / before)
            }
        }
    }

    /// Returns the part of the light on a shadow ray that comes through: as if it came from outside, or
    /// out of the thinner of two glasses.
    fn passes(&self, hit: Hit, ray: &Ray) -> Radiance {
        let cosine = unit(ray.direction()).dot(hit.normal).abs();
        // A direction so short that its square is 0 has no angle.
        let cosine = if cosine.is_nan() { 1.0 } else { cosine };
        let fresnel = match (self.before, self.behind) {
            (Some(glass), None) | (None, Some(glass)) => glass.fresnel(cosine, true),
            _ => {
                let [one, other] = self.media();
                Fresnel::new(cosine, one.max(other) / one.min(other))
            }
        };
        let reflected = if self.is_joint() {
            0.0
        } else {
            fresnel.reflected
        };
        self.color() * (1.0 - reflected)
    }
}

impl Departure {
    /// Creates the start of rays that a surface sends back, or to lights, where a ray has arrived along a
    /// direction.
    pub(crate) const fn at_hit(own: FaceId, contact: Option<Arc<Contact>>, along: DVec3) -> Self {
        Self {
            own,
            contact,
            arrival: Cell::new(None),
            along,
            side: Side::Before,
        }
    }

    /// The same where a ray has arrived at `t`, as long as it is not known what other faces are there.
    pub(crate) fn unknown(own: FaceId, ray: &Ray, t: f64) -> Self {
        Self {
            arrival: Cell::new(Some((ray.origin(), t))),
            ..Self::at_hit(own, None, ray.direction())
        }
    }

    /// Returns the same once it is known whether there are more faces.
    pub(crate) fn with(&self, contact: Option<Arc<Contact>>) -> Self {
        Self {
            contact,
            arrival: Cell::new(None),
            ..*self
        }
    }

    /// Notes that there are no more faces.
    pub(crate) fn settle(&self) {
        self.arrival.set(None);
    }

    /// The ray that arrived and its hit, as long as it is not known whether there are more faces.
    pub(crate) fn arrival(&self) -> Option<(Ray, (usize, Crossing))> {
        let FaceId { geometry, face } = self.own;
        let (origin, t) = self.arrival.get()?;
        let ray = Ray::new(origin, self.along);
        Some((ray, (geometry, Crossing { t, face })))
    }

    /// Returns the start of rays that go through the surface, where one has arrived along a direction.
    pub(crate) fn through(&self, along: DVec3) -> Self {
        Self {
            along,
            side: Side::After,
            ..self.clone()
        }
    }

    /// Returns the same for rays from another of the faces.
    pub(crate) fn on(&self, own: FaceId) -> Self {
        Self {
            own,
            ..self.clone()
        }
    }

    /// The face that was hit.
    pub(crate) const fn own(&self) -> FaceId {
        self.own
    }

    /// All faces that the rays leave, in ascending order.
    pub(crate) fn left(&self) -> &[FaceId] {
        match &self.contact {
            Some(contact) => &contact.ids,
            None => slice::from_ref(&self.own),
        }
    }

    /// Returns true if the point is known to lie on one face alone.
    pub(crate) const fn is_alone(&self) -> bool {
        self.contact.is_none()
    }

    /// Returns what is seen at a point of glass that lies on more than one face: an opaque face, as paint on
    /// the glass, or the glass that changes along the arriving ray; `None` if the face is alone.
    pub(crate) fn seen(&self, world: &World) -> Option<Crossed> {
        let contact = self.contact.as_ref()?;
        Some(contact.crossed(world, self, self.along, true))
    }

    /// Returns what a ray that begins here crosses at its origin.
    pub(crate) fn crossed(&self, world: &World, direction: DVec3) -> Crossed {
        match &self.contact {
            Some(contact) => contact.crossed(world, self, direction, false),
            None => Crossed::Nothing,
        }
    }
}

impl Contact {
    /// Returns what a ray crosses that begins at the point, or what is seen there along the arriving ray.
    fn crossed(&self, world: &World, start: &Departure, l: DVec3, is_seen: bool) -> Crossed {
        let (mut found, mut opaque, mut own, mut first) = (GlassCrossed::default(), None, None, 0);
        for ids in self.ids.chunk_by(|one, other| world.are_of_one(one, other)) {
            let faces = first..first + ids.len();
            first += ids.len();
            let crossed = faces
                .clone()
                .filter(|place| is_seen || self.crosses(*place, start, l));
            let mut into = crossed.map(|place| self.faces[place].normal.dot(l) < 0.0);
            let depth = match (world.body_of(&ids[0]), into.next()) {
                (Body::None | Body::Shell(_), None) => continue,
                (Body::None, Some(_)) => None,
                // The triangles agree, or it is only grazed.
                (Body::Shell(_), Some(first)) => Some(match into.all(|other| other == first) {
                    true if first => 1,
                    true => -1,
                    false => 0,
                }),
                (Body::Solid(first), _) => {
                    match self.change(world, start, l, (ids[0].geometry, first)) {
                        0 => continue,
                        depth => Some(depth),
                    }
                }
            };
            let place = self.face_of(world, faces, start, (l, depth, is_seen));
            let id = self.ids[place];
            let glass = self.hit(world, place).material().glass().copied();
            match glass {
                None => opaque = opaque.or(Some(id)),
                Some(_) if !matches!(depth, None | Some(0)) && id == start.own => own = Some(id),
                Some(_) => {}
            }
            found.add(id, glass, depth);
        }
        match opaque {
            Some(id) => Crossed::Opaque(id),
            None => found.crossed(own),
        }
    }

    /// Returns 1 if the ray goes into a solid, -1 if it comes out, and 0 if neither.
    fn change(
        &self,
        world: &World,
        start: &Departure,
        l: DVec3,
        (geometry, first): (usize, u64),
    ) -> i32 {
        let shape = world.geometries()[geometry].shape();
        let leaving = Leaving::of(&self.ids, geometry);
        let point = self.ray.at(self.t);
        let is_inside = |direction, side| {
            let ray = Ray::new(point, direction);
            i32::from(shape.is_inside(&ray, leaving, side, first))
        };
        is_inside(l, Side::After) - is_inside(start.along, start.side)
    }

    /// Returns the face at which a body is crossed: the one that was hit, if it is seen there, else the first
    /// that is turned to where the ray comes from. A joint gives way to others.
    fn face_of(
        &self,
        world: &World,
        faces: Range<usize>,
        start: &Departure,
        (l, depth, is_seen): (DVec3, Option<i32>, bool),
    ) -> usize {
        let normals = self.ids.iter().zip(&self.faces);
        let normals: Vec<_> = normals
            .map(|(id, face)| world.sided(id, face.normal))
            .collect();
        let rank = |place: &usize| {
            let along = self.hit(world, *place).normal.dot(l);
            let is_turned =
                depth.is_none_or(|depth| if depth > 0 { along < 0.0 } else { along > 0.0 });
            let is_own = is_seen && self.ids[*place] == start.own;
            match is_own || is_turned {
                true => (u8::from(is_joint(&normals, *place)), !is_own),
                false => (2, true),
            }
        };
        let first = faces.start;
        faces.min_by_key(rank).unwrap_or(first)
    }

    /// Returns true if a ray crosses a face without thickness at its origin.
    fn crosses(&self, place: usize, start: &Departure, l: DVec3) -> bool {
        let face = &self.faces[place];
        let own = self
            .ids
            .binary_search(&start.own)
            .map(|own| self.faces[own].normal);
        let is_own = self.ids[place] == start.own;
        let is_parallel = own.is_ok_and(|own| are_parallel(own, face.normal));
        let before = match start.side {
            Side::Before => start.along,
            Side::After => -start.along,
        };
        let (down, on) = (before.dot(face.normal), l.dot(face.normal));
        let within = down.abs() * l - on.abs() * before;
        let mut edges = face.edges.iter().flatten();
        !is_own && !is_parallel && down * on > 0.0 && edges.all(|inward| inward.dot(within) > 0.0)
    }

    /// Returns a face as the arriving ray meets it.
    fn hit<'w>(&self, world: &'w World, place: usize) -> Hit<'w> {
        world.hit_on(&self.ray, self.t, self.ids[place])
    }
}
