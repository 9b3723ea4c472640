//! The light of many hits of a camera's rays, eight at a time: the equations of
//! [`direct`](crate::integrator::direct), in their order of operations, for surfaces that send no ray
//! onward.

mod surfaces;

use glam::DVec3;

use crate::{
    accel::{
        lanes::{bits, dot, splat3, sub, unit},
        near_faces::NearFaces,
        pow::pow,
        shadow::{Last, Points, Shadowed, Shadows, casters::Toward},
    },
    integrator::direct::{Queries, Shadow},
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        camera::Camera,
        light::{
            Light,
            falloff::{Fading, Falloff},
            source::Source,
        },
        radiance::{Bytes, Radiance},
        ray::Ray,
        shape::{
            contact::REACH,
            face::{Crossing, FaceId},
        },
        srgb::{BLOCK, Levels},
        tone::Tone,
        vector,
        world::World,
    },
};

pub(crate) use self::surfaces::Cache;
use self::surfaces::Surfaces;

/// A row of samples and their hits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleRow<'a> {
    pub(crate) camera: &'a Camera,
    /// The parts of the rays that columns share, by axis.
    pub(crate) columns: [&'a [f64]; 3],
    /// The part that the row shares.
    pub(crate) row: DVec3,
    pub(crate) ids: &'a [u32],
    pub(crate) t: &'a [f64],
}

/// Rays that begin anywhere, and their hits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnwardRow<'a> {
    /// By axis.
    pub(crate) origins: [&'a [f64]; 3],
    pub(crate) directions: [&'a [f64]; 3],
    /// The indices of the geometries.
    pub(crate) indices: &'a [u32],
    pub(crate) faces: &'a [u64],
    pub(crate) t: &'a [f64],
}

/// Hits to be shaded.
#[derive(Clone, Copy, Debug)]
pub(crate) enum HitRow<'a> {
    Samples(SampleRow<'a>),
    Onward(OnwardRow<'a>),
}

/// Shades a row. In a world without lights, each geometry shows its color.
pub(crate) struct ShadeRow<'a, Q> {
    pub(crate) world: &'a World,
    /// The shadows of each light, unless it casts none.
    pub(crate) shadows: &'a [Option<Shadows<'a>>],
    pub(crate) queries: &'a Q,
    pub(crate) row: HitRow<'a>,
    pub(crate) known: &'a mut Cache,
    /// Red, green and blue of each sample.
    pub(crate) light: [&'a mut [f64]; 3],
    pub(crate) others: &'a mut Others,
}

/// The samples of a row that are to be shaded one by one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Others {
    places: Vec<usize>,
    /// For each of these samples, the shadow of each light.
    shadows: Vec<Shadow>,
}

impl Others {
    /// Removes all samples.
    pub(crate) fn clear(&mut self) {
        self.places.clear();
        self.shadows.clear();
    }

    /// Adds some of eight samples, given the shadows of each light.
    fn push(&mut self, start: usize, lanes: u8, shadows: &[[Shadow; LANES]]) {
        for lane in bits(lanes) {
            self.places.push(start + lane);
            let shadows = shadows.iter().map(|shadows| shadows[lane]);
            self.shadows.extend(shadows);
        }
    }

    /// Returns the samples and the shadows of all lights on each.
    pub(crate) fn each(&self) -> impl Iterator<Item = (usize, &[Shadow])> {
        let lights = self.shadows.len() / self.places.len().max(1);
        let shadows = (0..).map(move |number| &self.shadows[number * lights..][..lights]);
        self.places.iter().copied().zip(shadows)
    }
}

/// Eight hits.
struct Hits<S: Simd> {
    /// The indices of the geometries.
    indices: [u32; LANES],
    faces: [u64; LANES],
    point: [S::F64; 3],
    /// The rays that arrived there: their origins and directions, and the `t` of the hits.
    rays: ([[S::F64; 3]; 2], S::F64),
    /// The unit vector to the viewer, if it is asked for.
    v: [S::F64; 3],
    /// The unit normal, and that on the side of the viewer.
    normal: [S::F64; 3],
    n: [S::F64; 3],
    surfaces: Surfaces<S>,
}

impl<'a> SampleRow<'a> {
    /// Returns the indices of the geometries hit from `start` on. Lanes behind the end repeat the last sample.
    #[inline(always)]
    fn indices(&self, world: &World, start: usize) -> [u32; LANES] {
        let ids = lanes(self.ids, start);
        match world.has_copies() {
            true => ids.map(|id| world.index_of(id as usize) as u32),
            false => ids,
        }
    }

    /// Returns the rays from `start` on: their origins and directions, and the `t` of the hits.
    #[inline(always)]
    fn rays<S: Simd>(&self, simd: S, start: usize) -> ([[S::F64; 3]; 2], S::F64) {
        let sum = add(load_row(simd, self.columns, start), splat3(simd, self.row));
        let rays = match self.camera {
            Camera::Perspective(camera) => [splat3(simd, camera.basis.eye), unit(sum)],
            Camera::Orthographic(camera) => [sum, splat3(simd, -camera.basis.w)],
        };
        (rays, load(simd, self.t, start))
    }
}

impl HitRow<'_> {
    const fn len(&self) -> usize {
        match self {
            Self::Samples(row) => row.ids.len(),
            Self::Onward(row) => row.indices.len(),
        }
    }

    /// Returns the indices of the geometries hit from `start` on. Lanes behind the end repeat the last ray.
    #[inline(always)]
    fn indices(&self, world: &World, start: usize) -> [u32; LANES] {
        match self {
            Self::Samples(row) => row.indices(world, start),
            Self::Onward(row) => lanes(row.indices, start),
        }
    }

    /// Returns the hits of these geometries from `start` on, with `v` if a light needs it or a surface.
    #[inline(always)]
    fn hits<S: Simd>(
        &self,
        simd: S,
        world: &World,
        (indices, mut surfaces): ([u32; LANES], Surfaces<S>),
        (start, needs_v): (usize, bool),
    ) -> Hits<S> {
        let (rays, t) = match self {
            Self::Samples(row) => row.rays(simd, start),
            Self::Onward(row) => {
                let rays = [row.origins, row.directions].map(|axes| load_row(simd, axes, start));
                (rays, load(simd, row.t, start))
            }
        };
        let [o, d] = rays;
        let faces = match (surfaces.others, self) {
            (0, _) => [0; LANES],
            (_, Self::Samples(_)) => surfaces.find_others(simd, world, &indices, (o, d, t), None),
            (_, Self::Onward(row)) => {
                let faces = lanes(row.faces, start);
                surfaces.find_others(simd, world, &indices, (o, d, t), Some(faces))
            }
        };
        let along = [t * d[0], t * d[1], t * d[2]];
        let normal = normal(simd, o, along, d, &surfaces);
        let is_front = dot(d, normal).le(simd.splat(0.0));
        Hits {
            indices,
            faces,
            point: add(o, along),
            rays: (rays, t),
            v: match needs_v || surfaces.kinds.glossy != 0 {
                true => negate(unit(d)),
                false => d,
            },
            normal,
            n: select(is_front, normal, negate(normal)),
            surfaces,
        }
    }
}

impl<S: Simd> Hits<S> {
    /// Returns `max(0, r·v)^exponent` in some lanes, given the unit vector to a light and its product with
    /// the normal; 0 in all others.
    #[inline(always)]
    fn highlight(&self, simd: S, lanes: u8, l: [S::F64; 3], cosine: S::F64) -> S::F64 {
        let twice = simd.splat(2.0) * cosine;
        let [x, y, z] = self.n;
        let r = sub([twice * x, twice * y, twice * z], l);
        let (zero, mut cosines) = (simd.splat(0.0), [0.0; LANES]);
        let cosine = dot(r, self.v).max(zero);
        S::F64::select(simd.mask(lanes), cosine, zero).store(&mut cosines);
        let (_, exponents) = &self.surfaces.highlight;
        simd.load(&pow(&cosines, exponents))
    }
}

/// Returns rays and the `t` of their hits in memory.
#[inline(always)]
fn stored<V: F64x8>((rays, t): &([[V; 3]; 2], V)) -> ([[[f64; LANES]; 3]; 2], [f64; LANES]) {
    let (mut stored, mut of_t) = ([[[0.0; LANES]; 3]; 2], [0.0; LANES]);
    for (to, from) in stored
        .as_flattened_mut()
        .iter_mut()
        .zip(rays.as_flattened())
    {
        from.store(to);
    }
    t.store(&mut of_t);
    (stored, of_t)
}

fn ray_of([origins, directions]: &[[[f64; LANES]; 3]; 2], lane: usize) -> Ray {
    let [origin, direction] =
        [origins, directions].map(|vectors| DVec3::from(vectors.map(|axis| axis[lane])));
    Ray::new(origin, direction)
}

/// Returns eight numbers; those behind the end are the last.
#[inline(always)]
fn load<S: Simd>(simd: S, from: &[f64], start: usize) -> S::F64 {
    match from[start..].first_chunk() {
        Some(lanes) => simd.load(lanes),
        None => simd.load(&last_lanes(from, start)),
    }
}

/// Returns eight vectors; those behind the end are the last.
#[inline(always)]
fn load_row<S: Simd>(simd: S, [x, y, z]: [&[f64]; 3], start: usize) -> [S::F64; 3] {
    [
        load(simd, x, start),
        load(simd, y, start),
        load(simd, z, start),
    ]
}

/// Stores eight numbers; those behind the end are left out.
#[inline(always)]
fn store<V: F64x8>(lanes: V, to: &mut [f64]) {
    match to.first_chunk_mut() {
        Some(to) => lanes.store(to),
        None => {
            let mut all = [0.0; LANES];
            lanes.store(&mut all);
            store_some(&all, to);
        }
    }
}

/// Stores fewer than eight numbers. The program is smaller if this is not inlined.
#[cold]
#[inline(never)]
fn store_some(lanes: &[f64; LANES], to: &mut [f64]) {
    to.copy_from_slice(&lanes[..to.len()]);
}

/// Returns eight values; those behind the end are the last.
#[inline(always)]
fn lanes<T: Copy>(from: &[T], start: usize) -> [T; LANES] {
    match from[start..].first_chunk() {
        Some(lanes) => *lanes,
        None => last_lanes(from, start),
    }
}

/// Returns the last values, and the last one for all that are behind it. The program is smaller if this is
/// not inlined.
#[cold]
#[inline(never)]
fn last_lanes<T: Copy>(from: &[T], start: usize) -> [T; LANES] {
    std::array::from_fn(|lane| from[(start + lane).min(from.len() - 1)])
}

/// Returns the stored normals: those of spheres as
/// [`Sphere::normal_at`](crate::Sphere::normal_at) does.
#[inline(always)]
fn normal<S: Simd>(
    simd: S,
    o: [S::F64; 3],
    along: [S::F64; 3],
    d: [S::F64; 3],
    surfaces: &Surfaces<S>,
) -> [S::F64; 3] {
    if surfaces.is_sphere.bits() == 0 {
        return surfaces.vector;
    }
    let outward = add(sub(o, surfaces.vector), along);
    let has_direction = is_direction(simd, dot(outward, outward));
    let outward = select(has_direction, outward, negate(d));
    select(surfaces.is_sphere, unit(outward), surfaces.vector)
}

/// Returns true for squared lengths of vectors that have a direction.
#[inline(always)]
fn is_direction<S: Simd>(simd: S, squared: S::F64) -> S::Mask {
    simd.splat(0.0).lt(squared) & squared.lt(simd.splat(f64::INFINITY))
}

#[inline(always)]
fn add<V: F64x8>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn negate<V: F64x8>(v: [V; 3]) -> [V; 3] {
    [-v[0], -v[1], -v[2]]
}

#[inline(always)]
fn select<V: F64x8>(mask: V::Mask, yes: [V; 3], no: [V; 3]) -> [V; 3] {
    [
        V::select(mask, yes[0], no[0]),
        V::select(mask, yes[1], no[1]),
        V::select(mask, yes[2], no[2]),
    ]
}

/// Light that arrives at eight points.
struct Arriving<S: Simd> {
    /// The weakening by distance and cone, `falloff · cone`; `None` if it is 1 everywhere.
    weight: Option<S::F64>,
    /// The unit vector to the light.
    l: [S::F64; 3],
    /// The points that the light reaches.
    reaches: S::Mask,
}

/// Returns the light that arrives at eight points, before shadows; `None` for light from everywhere.
#[inline(always)]
fn arriving<S: Simd>(simd: S, light: &Light, hits: &Hits<S>) -> Option<Arriving<S>> {
    let evenly = |l| Arriving {
        weight: None,
        l,
        reaches: simd.splat(0.0).lt(simd.splat(1.0)),
    };
    let (position, falloff, cone) = match light.source() {
        Source::Everywhere => return None,
        Source::Viewer => return Some(evenly(hits.v)),
        Source::Direction(to_light) => return Some(evenly(splat3(simd, vector::unit(to_light)))),
        Source::Point {
            position,
            falloff,
            cone,
        } => (position, falloff, cone),
    };
    let to_light = sub(splat3(simd, position), hits.point);
    let squared = dot(to_light, to_light);
    let l = S::F64::over_length(to_light, squared.sqrt());
    let falloff = match falloff {
        Falloff::InverseSquare => Some(simd.splat(1.0) / squared),
        Falloff::Constant => None,
    };
    let cone = cone.map(|cone| fade(simd, cone, l));
    let weight = match (falloff, cone) {
        (Some(falloff), Some(cone)) => Some(falloff * cone),
        (falloff, cone) => falloff.or(cone),
    };
    Some(Arriving {
        weight,
        l,
        reaches: is_direction(simd, squared),
    })
}

/// Returns the part of the light that a cone lets through, as
/// [`Light::arriving`](crate::tracer::light::Light) does.
#[inline(always)]
fn fade<S: Simd>(simd: S, cone: Fading, l: [S::F64; 3]) -> S::F64 {
    let [inner, outer] = cone.cosines;
    let cosine = -dot(l, splat3(simd, cone.axis));
    let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
    if inner <= outer {
        return S::F64::select(simd.splat(outer).le(cosine), one, zero);
    }
    let s = (cosine - simd.splat(outer)) / simd.splat(inner - outer);
    let s = one.min(zero.max(s));
    s * s * (simd.splat(3.0) - simd.splat(2.0) * s)
}

impl<Q: Queries> Kernel for ShadeRow<'_, Q> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let count = self.row.len();
        let lights = self.world.lights();
        let needs_v = lights.iter().any(|light| light.source() == Source::Viewer);
        let mut last = vec![Last::default(); lights.len()];
        let mut shadows = vec![[Shadow::Lit; LANES]; lights.len()];
        for start in (0..count).step_by(LANES) {
            let width = LANES.min(count - start);
            let inside = u8::MAX >> (LANES - width);
            let indices = self.row.indices(self.world, start);
            let surfaces = Surfaces::new(simd, self.world, self.known, &indices);
            let kinds = surfaces.kinds;
            let scatters = (kinds.matte | kinds.scattering) & inside;
            if scatters == 0 {
                for (light, color) in self.light.iter_mut().zip(surfaces.color) {
                    store(color, &mut light[start..start + width]);
                }
                self.others.push(start, kinds.clear & inside, &shadows);
                continue;
            }
            let hits = self
                .row
                .hits(simd, self.world, (indices, surfaces), (start, needs_v));
            let mut others = kinds.scattering | kinds.clear;
            let zero = simd.splat(0.0);
            let (mut sums, mut highlights) = ([zero; 3], [zero; 3]);
            let most = Points::most_of(simd, scatters, [hits.point, hits.rays.0[0]]);
            let touching = match hits.surfaces.others & scatters {
                0 => 0,
                others => self.touching(simd, &hits, (others, most)),
            };
            for (number, light) in lights.iter().enumerate() {
                let radiance = light.glow().radiance().channels;
                let Some(arriving) = arriving(simd, light, &hits) else {
                    for (sum, radiance) in sums.iter_mut().zip(radiance) {
                        *sum = *sum + simd.splat(radiance);
                    }
                    continue;
                };
                let cosine = dot(hits.n, arriving.l);
                let mut shines = arriving.reaches & zero.lt(cosine);
                let asked = shines.bits() & scatters;
                if let Some(of_light) = &self.shadows[number]
                    && asked != 0
                {
                    let points = Points {
                        at: hits.point,
                        own: &hits.indices,
                        faces: &hits.faces,
                        center: hits.surfaces.vector,
                        is_sphere: hits.surfaces.is_sphere,
                        rays: hits.rays,
                        asked: asked & !touching,
                        most,
                    };
                    let mut found = of_light.on(simd, points, &mut last[number]);
                    found.open |= asked & touching;
                    if found.open != 0 {
                        self.trace(simd, light, &hits, &mut found);
                    }
                    shadows[number] = found.each();
                    others |= found.glass;
                    if found.dark != 0 {
                        shines = shines & !simd.mask(found.dark);
                    }
                }
                let glossy = kinds.glossy & shines.bits();
                let highlight = match glossy {
                    0 => None,
                    _ => Some(hits.highlight(simd, glossy, arriving.l, cosine)),
                };
                for channel in 0..3 {
                    let mut radiance = simd.splat(radiance[channel]);
                    if let Some(weight) = arriving.weight {
                        radiance = radiance * weight;
                    }
                    let sum = &mut sums[channel];
                    *sum = S::F64::select(shines, *sum + radiance * cosine, *sum);
                    if let Some(highlight) = highlight {
                        let sum = &mut highlights[channel];
                        *sum = S::F64::select(shines, *sum + radiance * highlight, *sum);
                    }
                }
            }
            self.others.push(start, others & inside, &shadows);
            for (channel, light) in self.light.iter_mut().enumerate() {
                let color = hits.surfaces.color[channel];
                let mut scattered = color * sums[channel];
                if kinds.glossy != 0 {
                    let (highlight, _) = hits.surfaces.highlight;
                    scattered = scattered + highlight[channel] * highlights[channel];
                }
                let shown = S::F64::select(hits.surfaces.is_matte, scattered, color);
                store(shown, &mut light[start..start + width]);
            }
        }
    }
}

/// Turns light into the integers of a file.
pub(crate) struct Encode<'a> {
    pub(crate) tone: Tone,
    /// Red, green and blue.
    pub(crate) light: [&'a [f64]; 3],
    /// True for integers of 16 bits, false for bytes.
    pub(crate) is_wide: bool,
    /// The number of integers of a pixel: three, or four, the last of which becomes 0.
    pub(crate) channels: usize,
    /// The integers of each pixel, in native byte order.
    pub(crate) bytes: &'a mut [u8],
}

impl Kernel for Encode<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let (table, levels) = (Bytes::table(), Levels::table());
        let mut light = [[0.0; BLOCK]; 3];
        let (mut bytes, mut numbers) = ([[0; BLOCK]; 3], [[0; BLOCK]; 3]);
        let size = self.channels << u8::from(self.is_wide);
        let blocks = self.bytes.chunks_mut(BLOCK * size);
        for (start, pixels) in (0..).step_by(BLOCK).zip(blocks) {
            let count = pixels.len() / size;
            for (to, from) in light.iter_mut().zip(self.light) {
                to[..count].copy_from_slice(&from[start..start + count]);
            }
            self.tone.apply(&mut light);
            if self.is_wide {
                levels.of_block(&light, &mut numbers);
                interleave(&numbers, self.channels, u16::to_ne_bytes, pixels);
            } else {
                table.of_block(&light, &mut bytes);
                interleave(&bytes, self.channels, u8::to_ne_bytes, pixels);
            }
        }
    }
}

/// Sets the integers of pixels that have three of them or four.
fn interleave<T: Copy, const BYTES: usize>(
    [r, g, b]: &[[T; BLOCK]; 3],
    channels: usize,
    of: impl Fn(T) -> [u8; BYTES],
    pixels: &mut [u8],
) {
    let integers = pixels.as_chunks_mut().0;
    let colors = r.iter().zip(g).zip(b);
    let colors = colors.map(|((r, g), b)| [of(*r), of(*g), of(*b)]);
    if channels == 3 {
        let pixels = integers.as_chunks_mut().0.iter_mut();
        pixels.zip(colors).for_each(|(pixel, color)| *pixel = color);
    } else {
        let pixels = integers.as_chunks_mut().0.iter_mut();
        pixels
            .zip(colors)
            .for_each(|(pixel, [r, g, b])| *pixel = [r, g, b, [0; BYTES]]);
    }
}

/// The places of eight hits: 0 for none, and an infinite distance.
#[derive(Clone, Default)]
pub(crate) struct Places {
    pub(crate) point: [[f64; LANES]; 3],
    pub(crate) normal: [[f64; LANES]; 3],
    /// The distances along the view axis.
    pub(crate) z: [f64; LANES],
}

/// Finds the places of the hits of a row.
pub(crate) struct LocateRow<'a> {
    pub(crate) world: &'a World,
    pub(crate) row: SampleRow<'a>,
    pub(crate) known: &'a mut Cache,
    /// The places of eight neighbors each; those behind the end of the row become any.
    pub(crate) places: &'a mut [Places],
}

impl Kernel for LocateRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (zero, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
        let eye = splat3(simd, self.row.camera.eye());
        let forward = splat3(simd, -self.row.camera.w());
        for (start, places) in (0..).step_by(LANES).zip(self.places) {
            let indices = self.row.indices(self.world, start);
            let surfaces = Surfaces::new(simd, self.world, self.known, &indices);
            let row = HitRow::Samples(self.row);
            let hits = row.hits(simd, self.world, (indices, surfaces), (start, false));
            let missed = infinity.le(hits.rays.1);
            let numbers = [hits.point, hits.normal].map(|of| select(missed, [zero; 3], of));
            let to = [&mut places.point, &mut places.normal];
            for (to, numbers) in to.into_iter().zip(numbers) {
                for (to, number) in to.iter_mut().zip(numbers) {
                    number.store(to);
                }
            }
            let z = dot(sub(hits.point, eye), forward);
            S::F64::select(missed, infinity, z).store(&mut places.z);
        }
    }
}

impl<Q: Queries> ShadeRow<'_, Q> {
    /// Finds the shadows of which nothing is known by their rays.
    #[inline(always)]
    fn trace<S: Simd>(&self, _: S, light: &Light, hits: &Hits<S>, found: &mut Shadowed) {
        let (rays, t) = stored(&hits.rays);
        self.trace_each(light, (&rays, &t), (&hits.indices, &hits.faces), found);
    }

    /// Returns which of some points lie on more than one face of their geometry.
    #[inline(always)]
    fn touching<S: Simd>(&self, simd: S, hits: &Hits<S>, (lanes, most): (u8, f64)) -> u8 {
        let mut at = [[0.0; LANES]; 3];
        for (at, from) in at.iter_mut().zip(hits.point) {
            from.store(at);
        }
        let except = hits.faces.map(|face| face as f64);
        let (mut near, mut rest) = (0, lanes);
        while rest != 0 {
            // All hits of one geometry at once.
            let index = hits.indices[rest.trailing_zeros() as usize];
            let same = (0..LANES).fold(0, |same, lane| {
                same | u8::from(hits.indices[lane] == index) << lane
            });
            let shape = self.world.geometries()[index as usize].shape();
            if shape.has_faces() {
                let lanes = same & rest;
                near |= lanes
                    & simd.call(NearFaces {
                        shape,
                        at: &at,
                        lanes,
                        reach: REACH * most,
                        except: Some(&except),
                    });
            }
            rest &= !same;
        }
        if near == 0 {
            return 0;
        }
        let (rays, t) = stored(&hits.rays);
        self.touching_each((&rays, &t), (&hits.indices, &hits.faces), near)
    }

    #[inline(never)]
    fn touching_each(
        &self,
        (rays, t): (&[[[f64; LANES]; 3]; 2], &[f64; LANES]),
        (indices, faces): (&[u32; LANES], &[u64; LANES]),
        lanes: u8,
    ) -> u8 {
        bits(lanes).fold(0, |touching, lane| {
            let index = indices[lane] as usize;
            let crossing = Crossing {
                t: t[lane],
                face: faces[lane],
            };
            let ray = ray_of(rays, lane);
            let contact = self
                .world
                .contact(&ray, (index, crossing), |_, see| see(index));
            touching | u8::from(contact.is_some()) << lane
        })
    }

    #[inline(never)]
    fn trace_each(
        &self,
        light: &Light,
        (rays, t): (&[[[f64; LANES]; 3]; 2], &[f64; LANES]),
        (indices, faces): (&[u32; LANES], &[u64; LANES]),
        found: &mut Shadowed,
    ) {
        let Some(toward) = Toward::of(light) else {
            return;
        };
        self.queries.prepare();
        for lane in bits(found.open) {
            let (geometry, face) = (indices[lane] as usize, faces[lane]);
            let arriving = ray_of(rays, lane);
            let own = FaceId { geometry, face };
            let start = self.queries.start(own, &arriving, t[lane]);
            let ray = toward.ray(arriving.at(t[lane]));
            let transmission = self.queries.transmission(&ray, toward.t_max(), &start);
            match transmission {
                Radiance::BLACK => found.dark |= 1 << lane,
                Radiance::WHITE => {}
                _ => found.glass |= 1 << lane,
            }
        }
        found.open = 0;
    }
}

impl Shadowed {
    /// Returns the shadow on each point.
    #[inline(always)]
    fn each(self) -> [Shadow; LANES] {
        if self.dark | self.glass == 0 {
            return [Shadow::Lit; LANES];
        }
        std::array::from_fn(
            |lane| match (self.dark >> lane & 1, self.glass >> lane & 1) {
                (1, _) => Shadow::Dark,
                (_, 1) => Shadow::Glass,
                _ => Shadow::Lit,
            },
        )
    }
}
