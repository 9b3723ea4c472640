//! The light of many hits of a camera's rays, eight at a time: the equations of
//! [`direct`](crate::integrator::direct), in their order of operations, for surfaces that send no ray
//! onward.

use glam::DVec3;

use crate::{
    accel::lanes::{dot, splat3, sub},
    film::colors::NOTHING,
    integrator::direct::Shadow,
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        camera::Camera,
        light::{Falloff, Light, Spot},
        material::Material,
        radiance::Radiance,
        world::{Lighting, World},
    },
};

/// A row of samples and their hits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<'a> {
    pub(crate) camera: &'a Camera,
    /// The parts of the rays that columns share, by axis.
    pub(crate) columns: [&'a [f64]; 3],
    /// The part that the row shares.
    pub(crate) row: DVec3,
    pub(crate) ids: &'a [u32],
    pub(crate) t: &'a [f64],
}

/// Asks which samples of a row face each light that casts shadows.
pub(crate) struct Facing<'a> {
    pub(crate) world: &'a World,
    pub(crate) lighting: &'a Lighting,
    pub(crate) row: Row<'a>,
    /// The points of the hits, by axis.
    pub(crate) points: [&'a mut [f64]; 3],
    /// For each light, the geometry of each hit that faces it, else [`NOTHING`]; empty if it casts no
    /// shadows.
    pub(crate) own: Vec<&'a mut [u32]>,
}

/// Shades a row. In a world without lights, each geometry shows its color.
pub(crate) struct ShadeRow<'a> {
    pub(crate) world: &'a World,
    pub(crate) lighting: Option<&'a Lighting>,
    pub(crate) row: Row<'a>,
    /// For each light, its shadow on each sample; empty if it casts none.
    pub(crate) shadows: &'a [&'a [Shadow]],
    /// True if the world has glass.
    pub(crate) has_glass: bool,
    /// Red, green and blue of each sample.
    pub(crate) light: [&'a mut [f64]; 3],
    /// The samples that are to be shaded one by one.
    pub(crate) others: &'a mut Vec<usize>,
}

/// What a hit needs of a geometry.
#[derive(Clone, Copy)]
struct Known {
    id: u32,
    /// The center of a sphere, else the unit normal.
    vector: [f64; 3],
    is_sphere: bool,
    /// The linear color of a matte surface, or the light of one that needs none.
    color: [f64; 3],
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Scatters the light that arrives.
    Matte,
    /// Has a light of its own, whatever arrives.
    Constant,
    /// Is shaded by the plain function, and scatters light.
    Scattering,
    /// Is shaded by the plain function, and scatters none.
    Clear,
}

impl Known {
    fn new(world: &World, id: u32) -> Self {
        let Some(geometry) = world.geometries().get(id as usize) else {
            return Self {
                id,
                vector: [0.0, 0.0, 1.0],
                is_sphere: false,
                color: world.background().to_linear().channels,
                kind: Kind::Constant,
            };
        };
        let (shape, material) = geometry.parts();
        let (color, kind) = match material {
            _ if world.lighting().is_none() => (material.color().to_linear(), Kind::Constant),
            Material::Matte(color) => (color.to_linear(), Kind::Matte),
            Material::Flat(color) => (color.to_linear(), Kind::Constant),
            Material::Emissive(emissive) => (emissive.radiance(), Kind::Constant),
            Material::Phong(_) => (Radiance::BLACK, Kind::Scattering),
            Material::Mirror(_) | Material::Glass(_) => (Radiance::BLACK, Kind::Clear),
        };
        let (vector, is_sphere, kind) = match (shape.sphere(), shape.plane()) {
            (Some(sphere), _) => (sphere.center(), true, kind),
            (None, Some(plane)) => (plane.unit_normal(), false, kind),
            (None, None) => (DVec3::Z, false, Kind::Scattering),
        };
        Self {
            id,
            vector: vector.to_array(),
            is_sphere,
            color: color.channels,
            kind,
        }
    }
}

/// Eight hits.
struct Hits<S: Simd> {
    point: [S::F64; 3],
    /// The direction of the ray.
    d: [S::F64; 3],
    /// The unit normal on the side of the viewer.
    n: [S::F64; 3],
    color: [S::F64; 3],
    is_matte: S::Mask,
}

/// Reads eight hits at a time from a row.
struct Reader<'a> {
    world: &'a World,
    row: Row<'a>,
    last: Known,
}

impl<'a> Reader<'a> {
    fn new(world: &'a World, row: Row<'a>) -> Self {
        let last = Known::new(world, NOTHING);
        Self { world, row, last }
    }

    fn known(&mut self, id: u32) -> Known {
        if self.last.id != id {
            self.last = Known::new(self.world, id);
        }
        self.last
    }

    /// Returns the hits from `start` on, and whether each is to be shaded by the plain function, and
    /// scatters light. Lanes behind the end repeat the last sample.
    #[inline(always)]
    fn read<S: Simd>(&mut self, simd: S, start: usize) -> (Hits<S>, [Kind; LANES]) {
        let row = self.row;
        let last = row.ids.len() - 1;
        let is_whole = start + LANES <= row.ids.len();
        let mut numbers = [[0.0; LANES]; 4];
        let [columns_x, columns_y, columns_z] = row.columns;
        for (to, from) in numbers
            .iter_mut()
            .zip([columns_x, columns_y, columns_z, row.t])
        {
            if is_whole {
                to.copy_from_slice(&from[start..start + LANES]);
            } else {
                for (lane, to) in to.iter_mut().enumerate() {
                    *to = from[(start + lane).min(last)];
                }
            }
        }
        let mut vector = [[0.0; LANES]; 3];
        let mut color = [[0.0; LANES]; 3];
        let mut is_sphere = [0.0; LANES];
        let mut is_matte = [0.0; LANES];
        let mut kinds = [Kind::Constant; LANES];
        for lane in 0..LANES {
            let known = self.known(row.ids[(start + lane).min(last)]);
            for axis in 0..3 {
                vector[axis][lane] = known.vector[axis];
                color[axis][lane] = known.color[axis];
            }
            is_sphere[lane] = f64::from(u8::from(known.is_sphere));
            is_matte[lane] = f64::from(u8::from(known.kind == Kind::Matte));
            kinds[lane] = known.kind;
        }
        let sum = splat3(simd, row.row);
        let sum = [
            simd.load(&numbers[0]) + sum[0],
            simd.load(&numbers[1]) + sum[1],
            simd.load(&numbers[2]) + sum[2],
        ];
        let (o, d) = match row.camera {
            Camera::Perspective(camera) => (splat3(simd, camera.basis.eye), unit(sum)),
            Camera::Orthographic(camera) => (sum, splat3(simd, -camera.basis.w)),
        };
        let t = simd.load(&numbers[3]);
        let along = [t * d[0], t * d[1], t * d[2]];
        let vector = [
            simd.load(&vector[0]),
            simd.load(&vector[1]),
            simd.load(&vector[2]),
        ];
        let normal = normal(simd, o, along, d, vector, &is_sphere);
        let is_front = dot(d, normal).lt(simd.splat(0.0));
        let hits = Hits {
            point: add(o, along),
            d,
            n: select(is_front, normal, negate(normal)),
            color: [
                simd.load(&color[0]),
                simd.load(&color[1]),
                simd.load(&color[2]),
            ],
            is_matte: simd.splat(0.5).lt(simd.load(&is_matte)),
        };
        (hits, kinds)
    }
}

/// Returns the stored normals: those of spheres around `vector`, as
/// [`Sphere::normal_at`](crate::Sphere::normal_at) does, else `vector`.
#[inline(always)]
fn normal<S: Simd>(
    simd: S,
    o: [S::F64; 3],
    along: [S::F64; 3],
    d: [S::F64; 3],
    vector: [S::F64; 3],
    is_sphere: &[f64; LANES],
) -> [S::F64; 3] {
    let is_sphere = simd.splat(0.5).lt(simd.load(is_sphere));
    let outward = add(sub(o, vector), along);
    let squared = dot(outward, outward);
    let has_direction = is_direction(simd, squared);
    let outward = select(has_direction, outward, negate(d));
    select(is_sphere, unit(outward), vector)
}

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

#[inline(always)]
fn unit<V: F64x8>(v: [V; 3]) -> [V; 3] {
    let length = dot(v, v).sqrt();
    [v[0] / length, v[1] / length, v[2] / length]
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
    let everywhere = simd.splat(0.0).lt(simd.splat(1.0));
    let (position, falloff, spot) = match light {
        Light::Ambient(_) => return None,
        Light::Headlight(_) => {
            return Some(Arriving {
                weight: None,
                l: negate(unit(hits.d)),
                reaches: everywhere,
            });
        }
        Light::Directional(directional) => {
            return Some(Arriving {
                weight: None,
                l: splat3(simd, directional.l()),
                reaches: everywhere,
            });
        }
        Light::Point(point) => (point.position(), point.falloff(), None),
        Light::Spot(spot) => (spot.position(), spot.falloff(), Some(spot)),
    };
    let to_light = sub(splat3(simd, position), hits.point);
    let squared = dot(to_light, to_light);
    let length = squared.sqrt();
    let l = [
        to_light[0] / length,
        to_light[1] / length,
        to_light[2] / length,
    ];
    let falloff = match falloff {
        Falloff::InverseSquare => Some(simd.splat(1.0) / squared),
        Falloff::Constant => None,
    };
    let weight = match (falloff, spot) {
        (Some(falloff), Some(spot)) => Some(falloff * fade(simd, spot, l)),
        (None, Some(spot)) => Some(fade(simd, spot, l)),
        (falloff, None) => falloff,
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
fn fade<S: Simd>(simd: S, spot: &Spot, l: [S::F64; 3]) -> S::F64 {
    let (axis, [inner, outer]) = spot.fading();
    let cosine = -dot(l, splat3(simd, axis));
    let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
    if inner <= outer {
        return S::F64::select(simd.splat(outer).le(cosine), one, zero);
    }
    let s = (cosine - simd.splat(outer)) / simd.splat(inner - outer);
    let s = one.min(zero.max(s));
    s * s * (simd.splat(3.0) - simd.splat(2.0) * s)
}

impl Kernel for Facing<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let count = self.row.ids.len();
        let mut reader = Reader::new(self.world, self.row);
        for start in (0..count).step_by(LANES) {
            let (hits, kinds) = reader.read(simd, start);
            let width = LANES.min(count - start);
            for (axis, points) in self.points.iter_mut().enumerate() {
                let mut lanes = [0.0; LANES];
                hits.point[axis].store(&mut lanes);
                points[start..start + width].copy_from_slice(&lanes[..width]);
            }
            for (light, own) in self.lighting.lights.iter().zip(&mut self.own) {
                if own.is_empty() {
                    continue;
                }
                let Some(arriving) = arriving(simd, light, &hits) else {
                    continue;
                };
                let cosine = dot(hits.n, arriving.l);
                let faces = (arriving.reaches & simd.splat(0.0).lt(cosine)).bits();
                for lane in 0..width {
                    let scatters = matches!(kinds[lane], Kind::Matte | Kind::Scattering);
                    let is_asked = scatters && faces >> lane & 1 == 1;
                    own[start + lane] = if is_asked {
                        self.row.ids[start + lane]
                    } else {
                        NOTHING
                    };
                }
            }
        }
    }
}

impl Kernel for ShadeRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let count = self.row.ids.len();
        let mut reader = Reader::new(self.world, self.row);
        for start in (0..count).step_by(LANES) {
            let (hits, kinds) = reader.read(simd, start);
            let width = LANES.min(count - start);
            for (lane, kind) in kinds.iter().enumerate().take(width) {
                let is_behind_glass = || {
                    let shadows = self.shadows.iter();
                    let mut shadows = shadows.filter_map(|shadows| shadows.get(start + lane));
                    self.has_glass && shadows.any(|shadow| *shadow == Shadow::Glass)
                };
                if match kind {
                    Kind::Scattering | Kind::Clear => true,
                    Kind::Matte => is_behind_glass(),
                    Kind::Constant => false,
                } {
                    self.others.push(start + lane);
                }
            }
            let zero = simd.splat(0.0);
            let mut sums = [zero; 3];
            let lights = self.lighting.map_or(&[][..], |lighting| &lighting.lights);
            for (light, shadows) in lights.iter().zip(self.shadows) {
                let radiance = light.glow().radiance().channels;
                let Some(arriving) = arriving(simd, light, &hits) else {
                    for (sum, radiance) in sums.iter_mut().zip(radiance) {
                        *sum = *sum + simd.splat(radiance);
                    }
                    continue;
                };
                let cosine = dot(hits.n, arriving.l);
                let mut shines = arriving.reaches & zero.lt(cosine);
                if !shadows.is_empty() {
                    let mut lit = [0.0; LANES];
                    for (lit, shadow) in lit.iter_mut().zip(&shadows[start..start + width]) {
                        *lit = f64::from(u8::from(*shadow == Shadow::Lit));
                    }
                    shines = shines & zero.lt(simd.load(&lit));
                }
                for (sum, radiance) in sums.iter_mut().zip(radiance) {
                    let mut radiance = simd.splat(radiance);
                    if let Some(weight) = arriving.weight {
                        radiance = radiance * weight;
                    }
                    *sum = S::F64::select(shines, *sum + radiance * cosine, *sum);
                }
            }
            for (channel, light) in self.light.iter_mut().enumerate() {
                let color = hits.color[channel];
                let shown = S::F64::select(hits.is_matte, color * sums[channel], color);
                let mut lanes = [0.0; LANES];
                shown.store(&mut lanes);
                light[start..start + width].copy_from_slice(&lanes[..width]);
            }
        }
    }
}
