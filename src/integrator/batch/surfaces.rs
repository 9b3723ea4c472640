//! The geometries of eight hits, and the normals that only their own shapes can compute.

use glam::DVec3;

use crate::{
    accel::{
        face_of_each,
        lanes::{load3, splat3},
    },
    film::colors::NOTHING,
    simd::{F64x8, LANES, Simd},
    tracer::{
        hit::Hit, material::lobes::Lobes, radiance::Radiance, ray::Bundle, shape::face::Crossing,
        world::World,
    },
};

/// A cache of the geometries that were seen lately, by the lowest bits of their indices.
pub(crate) struct Cache(Vec<Known>);

/// The largest number of geometries in a [`Cache`]: many times those that a row of pixels sees.
const KNOWN: usize = 1 << 14;

impl Cache {
    pub(crate) fn new(world: &World) -> Self {
        let count = (world.geometries().len() + 1).next_power_of_two();
        Self(vec![Known::new(world, NOTHING); count.min(KNOWN)])
    }

    /// Returns true if a geometry sends on light and scatters none.
    pub(crate) fn is_clear(&mut self, world: &World, index: u32) -> bool {
        self.of(world, index).kind == SurfaceKind::Clear
    }

    #[inline(always)]
    fn of(&mut self, world: &World, index: u32) -> &Known {
        let place = index as usize & (self.0.len() - 1);
        let known = &mut self.0[place];
        if known.index != index {
            *known = Known::new(world, index);
        }
        known
    }
}

/// The data of a geometry that a hit needs.
#[derive(Clone, Copy)]
struct Known {
    index: u32,
    /// The center of a sphere, else the unit normal of a flat shape.
    vector: [f64; 3],
    is_sphere: bool,
    /// True if the normal depends on the hit, by an equation other than that of a sphere.
    is_other: bool,
    /// The linear color of a surface that is shaded here, or the light of one that needs none.
    color: [f64; 3],
    /// The linear color and the exponent of highlights.
    highlight: ([f64; 3], f64),
    kind: SurfaceKind,
}

#[derive(Clone, Copy, PartialEq)]
enum SurfaceKind {
    /// Scatters the light that arrives evenly.
    Matte,
    /// Scatters it also as highlights, and reflects nothing else.
    Glossy,
    /// Has a light of its own, whatever arrives.
    Constant,
    /// Is shaded by the plain function, and may scatter light.
    Scattering,
    /// Is shaded by the plain function, and scatters none.
    Clear,
    /// Depends on the point.
    Varied,
}

impl Known {
    #[inline(never)]
    fn new(world: &World, index: u32) -> Self {
        let Some(geometry) = world.geometries().get(index as usize) else {
            return Self {
                index,
                vector: [0.0, 0.0, 1.0],
                is_sphere: false,
                is_other: false,
                color: world.background().to_linear().channels,
                highlight: ([0.0; 3], 1.0),
                kind: SurfaceKind::Constant,
            };
        };
        let shape = geometry.shape();
        let lobes = geometry
            .only_material()
            .map(|material| world.lobes(material));
        let is_sphere = shape.sphere().is_some();
        let (color, kind) = match lobes {
            Some(lobes) => SurfaceKind::shown(lobes),
            // The kernel finds the normals of spheres itself.
            None if is_sphere => (Radiance::BLACK, SurfaceKind::Scattering),
            None => (Radiance::BLACK, SurfaceKind::Varied),
        };
        let highlight = highlight_of(lobes);
        let is_in_place = shape.is_flat() && shape.transform().is_none();
        let flat = shape.plane().filter(|_| is_in_place);
        let vector = match (shape.sphere(), flat) {
            (Some(sphere), _) => sphere.center(),
            (None, Some(plane)) => plane.unit_normal(),
            (None, None) => DVec3::Z,
        };
        Self {
            index,
            vector: vector.to_array(),
            is_sphere,
            is_other: !is_sphere && (flat.is_none() || kind == SurfaceKind::Varied),
            color: color.channels,
            highlight,
            kind,
        }
    }
}

/// Returns the linear color and the exponent of the highlights of a material.
fn highlight_of(lobes: Option<Lobes>) -> ([f64; 3], f64) {
    let highlight = lobes.and_then(|lobes| lobes.highlight);
    let highlight = highlight.map(|it| (it.color.to_linear().channels, it.exponent));
    highlight.unwrap_or(([0.0; 3], 1.0))
}

impl SurfaceKind {
    /// Returns the color and the kind of a surface that has one material.
    fn shown(lobes: Lobes) -> (Radiance, Self) {
        let Lobes {
            emission,
            diffuse,
            highlight,
            layered: _,
            mirror: _,
            interface: _,
        } = lobes;
        let ends = !lobes.sends_rays();
        match (emission, diffuse, highlight) {
            (Some(emission), None, None) if ends => (emission.radiance(), Self::Constant),
            (None, Some(color), None) if ends => (color.to_linear(), Self::Matte),
            (None, Some(color), Some(_)) if ends => (color.to_linear(), Self::Glossy),
            _ if lobes.scatters() => (Radiance::BLACK, Self::Scattering),
            _ => (Radiance::BLACK, Self::Clear),
        }
    }
}

/// The geometries of eight hits.
pub(super) struct Surfaces<S: Simd> {
    /// The centers of spheres, else the unit normals.
    pub(super) vector: [S::F64; 3],
    pub(super) is_sphere: S::Mask,
    /// The hits whose normals are yet to be found.
    pub(super) others: u8,
    pub(super) color: [S::F64; 3],
    /// The linear colors and the exponents of highlights.
    pub(super) highlight: ([S::F64; 3], [f64; LANES]),
    /// The hits that scatter the light that arrives and are shaded here.
    pub(super) is_matte: S::Mask,
    pub(super) kinds: Kinds,
}

/// The hits of each [`SurfaceKind`] but constant ones, lane i as bit i.
#[derive(Clone, Copy, Default)]
pub(super) struct Kinds {
    /// Also those that are glossy.
    pub(super) matte: u8,
    pub(super) glossy: u8,
    pub(super) scattering: u8,
    pub(super) clear: u8,
    /// Those whose kind is found with the normals.
    pub(super) varied: u8,
}

impl Kinds {
    /// Returns the hits that scatter light, and those of which that is not known yet.
    #[inline(always)]
    pub(super) const fn may_scatter(&self) -> u8 {
        self.matte | self.scattering | self.varied
    }

    #[inline(always)]
    fn add(&mut self, kind: SurfaceKind, lanes: u8) {
        match kind {
            SurfaceKind::Matte => self.matte |= lanes,
            SurfaceKind::Glossy => {
                self.matte |= lanes;
                self.glossy |= lanes;
            }
            SurfaceKind::Constant => {}
            SurfaceKind::Scattering => self.scattering |= lanes,
            SurfaceKind::Clear => self.clear |= lanes,
            SurfaceKind::Varied => self.varied |= lanes,
        }
    }
}

impl<S: Simd> Surfaces<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, world: &World, cache: &mut Cache, indices: &[u32; LANES]) -> Self {
        let half = simd.splat(0.5);
        let mut kinds = Kinds::default();
        if indices
            .iter()
            .fold(0, |other, index| other | (index ^ indices[0]))
            == 0
        {
            let known = cache.of(world, indices[0]);
            kinds.add(known.kind, u8::MAX);
            let flag = |is_set: bool| half.lt(simd.splat(f64::from(u8::from(is_set))));
            return Self {
                vector: splat3(simd, DVec3::from(known.vector)),
                is_sphere: flag(known.is_sphere),
                others: if known.is_other { u8::MAX } else { 0 },
                color: splat3(simd, DVec3::from(known.color)),
                highlight: (
                    splat3(simd, DVec3::from(known.highlight.0)),
                    [known.highlight.1; LANES],
                ),
                is_matte: flag(kinds.matte != 0),
                kinds,
            };
        }
        let (mut vector, mut color) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        let (mut highlight, mut exponents) = ([[0.0; LANES]; 3], [1.0; LANES]);
        let mut is_sphere = [0.0; LANES];
        let mut others = 0;
        for lane in 0..LANES {
            let known = cache.of(world, indices[lane]);
            for axis in 0..3 {
                vector[axis][lane] = known.vector[axis];
                color[axis][lane] = known.color[axis];
            }
            is_sphere[lane] = f64::from(u8::from(known.is_sphere));
            others |= u8::from(known.is_other) << lane;
            kinds.add(known.kind, 1 << lane);
            if known.kind == SurfaceKind::Glossy {
                let (color, exponent) = known.highlight;
                for (lanes, channel) in highlight.iter_mut().zip(color) {
                    lanes[lane] = channel;
                }
                exponents[lane] = exponent;
            }
        }
        Self {
            vector: load3(simd, &vector),
            is_sphere: half.lt(simd.load(&is_sphere)),
            others,
            color: load3(simd, &color),
            highlight: (load3(simd, &highlight), exponents),
            is_matte: simd.mask(kinds.matte),
            kinds,
        }
    }

    /// Finds the normals of the other hits, and what depends on their points. Returns the faces of all, unless they
    /// are known.
    #[inline(always)]
    pub(super) fn find_others(
        &mut self,
        simd: S,
        world: &World,
        indices: &[u32; LANES],
        (o, d, t): ([S::F64; 3], [S::F64; 3], S::F64),
        known: Option<[u64; LANES]>,
    ) -> [u64; LANES] {
        let mut normals = stored(self.vector);
        let mut varied = None;
        if self.kinds.varied != 0 {
            varied = Some(VariedSurfaces {
                colors: stored(self.color),
                highlights: (stored(self.highlight.0), self.highlight.1),
                kinds: self.kinds,
            });
        }
        let mut at = [0.0; LANES];
        t.store(&mut at);
        let rays = (&stored(o), &stored(d), &at);
        let hits = (indices, known, self.others);
        let found = (&mut normals, varied.as_mut());
        let faces = find_surfaces(simd, world, hits, rays, found);
        self.vector = load3(simd, &normals);
        if let Some(varied) = varied {
            self.kinds = varied.kinds;
            self.color = load3(simd, &varied.colors);
            self.highlight = (load3(simd, &varied.highlights.0), varied.highlights.1);
            self.is_matte = simd.mask(self.kinds.matte);
        }
        faces
    }
}

/// Stores vectors by axis.
#[inline(always)]
fn stored<V: F64x8>(vector: [V; 3]) -> [[f64; LANES]; 3] {
    let mut lanes = [[0.0; LANES]; 3];
    for (lanes, axis) in lanes.iter_mut().zip(vector) {
        axis.store(lanes);
    }
    lanes
}

/// What depends on the points of hits.
struct VariedSurfaces {
    colors: [[f64; LANES]; 3],
    highlights: ([[f64; LANES]; 3], [f64; LANES]),
    kinds: Kinds,
}

impl VariedSurfaces {
    /// Notes the material of a hit in a lane, of those whose materials depend on the point.
    fn note(&mut self, world: &World, lane: usize, hit: &Hit) {
        let material = hit.material();
        let lobes = world.lobes(&material);
        let (color, kind) = SurfaceKind::shown(lobes);
        let (highlight, exponent) = highlight_of(Some(lobes));
        let numbers = self.colors.iter_mut().zip(color.channels);
        let highlights = self.highlights.0.iter_mut().zip(highlight);
        for (lanes, number) in numbers.chain(highlights) {
            lanes[lane] = number;
        }
        self.highlights.1[lane] = exponent;
        self.kinds.add(kind, 1 << lane);
    }
}

/// Finds the normals of some hits and what depends on their points, and returns their faces.
#[inline(never)]
fn find_surfaces<S: Simd>(
    simd: S,
    world: &World,
    (indices, known, lanes): (&[u32; LANES], Option<[u64; LANES]>, u8),
    (o, d, t): (&[[f64; LANES]; 3], &[[f64; LANES]; 3], &[f64; LANES]),
    (normals, mut varied): (&mut [[f64; LANES]; 3], Option<&mut VariedSurfaces>),
) -> [u64; LANES] {
    let mut faces = [0; LANES];
    let mut rest = lanes;
    while rest != 0 {
        // All hits of one geometry at once.
        let index = indices[rest.trailing_zeros() as usize];
        let is_same = |lane: usize| rest >> lane & 1 == 1 && indices[lane] == index;
        let same: [bool; LANES] = std::array::from_fn(is_same);
        let geometry = &world.geometries()[index as usize];
        let shape = geometry.shape();
        let bundle = Bundle::to(*o, *d, t, same);
        let found = known.unwrap_or_else(|| face_of_each(simd, shape, &bundle));
        for lane in (0..LANES).filter(|lane| same[*lane]) {
            let (ray, crossing) = (
                bundle.ray(lane),
                Crossing {
                    t: t[lane],
                    face: found[lane],
                },
            );
            let normal = shape.normal_at(&ray, crossing);
            for (lanes, x) in normals.iter_mut().zip(normal.to_array()) {
                lanes[lane] = x;
            }
            if let Some(varied) = &mut varied
                && varied.kinds.varied >> lane & 1 == 1
            {
                varied.note(world, lane, &Hit::new(geometry, &ray, crossing, normal));
            }
            faces[lane] = crossing.face;
            rest &= !(1 << lane);
        }
    }
    faces
}
