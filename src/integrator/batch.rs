//! The light of many hits of a camera's rays, eight at a time: the equations of
//! [`direct`](crate::integrator::direct), in their order of operations, for surfaces that send no ray
//! onward.

mod hits;
mod surfaces;

use glam::DVec3;

use crate::{
    accel::{
        lanes::{bits, dot, splat3, sub},
        near_faces::NearFaces,
        shadow::{Last, Points, Shadowed, Shadows, casters::Toward},
    },
    integrator::{direct::Queries, surface::Shadow},
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        light::{
            Light,
            falloff::{Fading, Falloff},
            source::Source,
        },
        radiance::Radiance,
        shape::{
            contact::REACH,
            face::{Crossing, FaceId},
        },
        vector,
        world::World,
    },
};

pub(crate) use self::{
    hits::{HitRow, LocateRow, OnwardRow, Places, SampleRow},
    surfaces::Cache,
};
use self::{
    hits::{Hits, is_direction, ray_of, store, stored},
    surfaces::Surfaces,
};

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
        Source::Surroundings => {
            let nothing = simd.splat(0.0);
            return Some(Arriving {
                reaches: nothing.lt(nothing),
                ..evenly(splat3(simd, DVec3::Z))
            });
        }
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
            if kinds.may_scatter() & inside == 0 {
                for (light, color) in self.light.iter_mut().zip(surfaces.color) {
                    store(color, &mut light[start..start + width]);
                }
                self.others.push(start, kinds.clear & inside, &shadows);
                continue;
            }
            let hits = self
                .row
                .hits(simd, self.world, (indices, surfaces), (start, needs_v));
            let kinds = hits.surfaces.kinds;
            let scatters = (kinds.matte | kinds.scattering) & inside;
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
