//! Comparison of shaded pictures with the plain definition: no bit of their light may differ.

mod paths;
mod worlds;

use std::{f64::consts::PI, iter};

use glam::DVec3;

use crate::{
    accel::{kept::Kept, raster::first_hits::Work},
    film::{
        Centers, Film, Outlines, Samples, Wanted, crop::Crop, light::LightRun, parts::LightParts,
        resolve::Resolver, size::Size,
    },
    integrator::{Integrate, Integrator, direct::Shaded},
    parallel::{
        Cancel, Pool,
        timings::{Stage, Timings},
    },
    render::{
        explained::PixelSource,
        ray_tracer::RayTracer,
        tests::worlds::{camera, color, touching_world, world},
    },
    simd::isa::Isa,
    tracer::{
        camera::{Camera, perspective::PerspectiveCamera},
        color::Color,
        hit::Hit,
        radiance::Radiance,
        random::{Rng, cases},
        ray::Ray,
        tone::{Tone, ToneMapping},
        world::World,
    },
};

/// The light of a pixel, as in [`LightPlanes`](crate::film::light::LightPlanes).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LitPixel {
    pub(super) parts: LightParts,
    pub(super) albedo: Radiance,
    pub(super) coverage: f64,
    pub(super) behind: f64,
    pub(super) error: Radiance,
    pub(super) samples: f64,
}

impl LitPixel {
    /// Returns the pixels of a run.
    fn of_run(light: LightRun) -> impl Iterator<Item = Self> {
        (0..light.coverage.len()).map(move |place| {
            let number = |plane: &[f64]| plane.get(place).copied().unwrap_or_default();
            let color = |[r, g, b]: [&[f64]; 3]| Radiance::new(number(r), number(g), number(b));
            Self {
                parts: LightParts::new(light.parts.map(color)),
                albedo: color(light.albedo),
                coverage: number(light.coverage),
                behind: number(light.behind),
                error: color(light.error),
                samples: number(light.samples),
            }
        })
    }
}

/// A picture of a random scene.
#[derive(Clone)]
pub(super) struct Case {
    pub(super) camera: Camera,
    pub(super) world: World,
    /// The same world, which is drawn.
    pub(super) drawn: World,
    pub(super) size: Size,
    samples: Samples,
    outlines: Option<Outlines>,
    pub(super) tone: Tone,
    pub(super) is_transparent: bool,
}

impl Case {
    /// Creates a picture whose middle shows where surfaces meet.
    fn touching(random: &mut Rng) -> Self {
        let (world, corners) = touching_world(random);
        let at = random.below(corners.len().max(1));
        let to = corners.get(at).copied().unwrap_or(DVec3::ZERO);
        let away = random.vector() * 4.0 + DVec3::new(0.01, 0.02, 3.0);
        let eye = to + away * random.one(&[1.0, 1.0, 0.1, 100.0]);
        let camera = PerspectiveCamera::new(eye, to - eye, DVec3::Y, 0.3);
        Self {
            camera: camera.unwrap().into(),
            drawn: world.without_indices(),
            world,
            size: Size::new(5, 3).unwrap(),
            samples: Samples::new(1).unwrap(),
            outlines: None,
            tone: Tone::new(0.0, ToneMapping::Clip),
            is_transparent: random.below(4) == 0,
        }
    }

    pub(super) fn new(random: &mut Rng) -> Self {
        let size = random.one(&[1e-6, 1e-3, 1.0, 1.0, 1.0, 50.0, 1e6, 1e8]);
        let middle = random.vector() * size * random.one(&[0.0, 1.0, 100.0]);
        let outlines = Outlines {
            width: random.one(&[0.4, 1.0, 1.5, 2.5]),
            color: color(random),
            depth: random.one(&[None, Some(0.05 * size)]),
            creases: random.one(&[None, Some(20.0)]),
        };
        let world = world(random, middle, size);
        Self {
            camera: camera(random, middle, size),
            drawn: world.without_indices(),
            world,
            size: random
                .one(&[Size::new(12, 9), Size::new(17, 5), Size::new(8, 21)])
                .unwrap(),
            samples: Samples::new(random.one(&[1, 1, 1, 4, 9])).unwrap(),
            outlines: random.one(&[None, None, None, Some(outlines)]),
            tone: Tone::new(random.one(&[0.0, 0.0, 6.0, -6.0]), ToneMapping::Clip),
            is_transparent: random.below(4) == 0,
        }
    }

    /// Returns the light of a part of the picture.
    fn drawn(&self, crop: Crop, isa: Isa, pool: &Pool, kept: Option<&Kept>) -> Vec<LitPixel> {
        let mut light = Vec::new();
        self.draw((crop, Centers::Unneeded), isa, (pool, kept), |film| {
            for run in film.runs() {
                light.extend(run.light.into_iter().flat_map(LitPixel::of_run));
            }
        });
        light
    }

    /// Passes on the bands of a part of the picture, with the light of each pixel.
    pub(super) fn draw(
        &self,
        (crop, centers): (Crop, Centers),
        isa: Isa,
        (pool, kept): (&Pool, Option<&Kept>),
        mut take: impl FnMut(Film),
    ) {
        let (cancel, timings) = (Cancel::new(), Timings::new());
        let work = Work {
            pool,
            cancel: &cancel,
            progress: None,
            watch: &timings.shared_watch(Stage::Trace),
            kept,
            resolver: Resolver {
                is_transparent: self.is_transparent,
                ..Resolver::new(&self.drawn)
            },
            centers,
            wanted: Wanted::Parts,
        };
        let tracer = RayTracer::with_size(&self.camera, &self.drawn, self.size)
            .samples(self.samples)
            .outlines(self.outlines)
            .tone(self.tone)
            .isa(isa);
        let take = |film| {
            take(film);
            Ok(())
        };
        tracer.draw_bands(crop, work, take).unwrap();
    }

    /// Returns the ray of a sample, counted from the bottom left of the picture.
    fn ray(&self, column: u32, row: u32) -> Ray {
        let side = self.samples.side();
        let place = |x: u32| {
            let offsets: Vec<_> = self.samples.offsets(f64::from(x / side)).collect();
            offsets[(x % side) as usize]
        };
        let (width, height) = (self.size.width(), self.size.height());
        self.camera
            .ray_for(width, height, place(column), place(row))
    }

    /// Returns the sides of the picture in samples.
    fn sides(&self) -> [u32; 2] {
        [self.size.width(), self.size.height()].map(|side| side * self.samples.side())
    }

    /// Returns the neighbor that outlines a sample, by comparing it with all others: its distance to the right and
    /// upwards, and what it sees.
    fn outlined_by(&self, column: u32, row: u32) -> Option<([i64; 2], Option<usize>)> {
        let outlines = self.outlines?;
        let seen = |column, row| {
            let (index, hit) = self.world.hit(&self.ray(column, row))?;
            Some((self.world.id_of(index, hit.face), hit))
        };
        let (id, hit) = seen(column, row)?;
        let reach = outlines.width * f64::from(self.samples.side());
        let [columns, rows] = self.sides();
        // From the top left, as the nearest are compared.
        let all = (0..rows)
            .rev()
            .flat_map(|y| (0..columns).map(move |x| (x, y)));
        let apart = |(x, y): (u32, u32)| {
            let [x, y] = [
                i64::from(x) - i64::from(column),
                i64::from(y) - i64::from(row),
            ];
            (x * x + y * y) as f64
        };
        let near = all.filter(|at| apart(*at) > 0.0 && apart(*at) < reach * reach);
        let mut near: Vec<_> = near.collect();
        near.sort_by(|one, other| apart(*one).total_cmp(&apart(*other)));
        let mut met = vec![];
        let own_ray = self.ray(column, row);
        near.into_iter().find_map(|(x, y)| {
            let away = [x, y].map(i64::from);
            let away = [away[0] - i64::from(column), away[1] - i64::from(row)];
            let Some((other, there)) = seen(x, y) else {
                return Some((away, None));
            };
            let ray = self.ray(x, y);
            let cosine = |hit: &Hit, ray: &Ray| {
                (hit.normal.dot(ray.direction()) / ray.direction().length()).abs()
            };
            let (a, b) = (cosine(&hit, &own_ray), cosine(&there, &ray));
            let seam = if a + b == 0.0 { 0.5 } else { b / (a + b) };
            let behind = |one: f64, other: f64| {
                let depth = outlines.depth;
                depth.is_some_and(|depth| other > one + depth)
            };
            let is_crease = outlines.creases.is_some_and(|angle| {
                hit.normal.dot(there.normal) < libm::cos(angle * (PI / 180.0))
            });
            let share = if other == id {
                match (behind(hit.t, there.t), behind(there.t, hit.t)) {
                    (true, _) => 1.0,
                    (_, true) => 0.0,
                    _ if is_crease => seam,
                    _ => 0.0,
                }
            } else if met.contains(&other) {
                0.0
            } else {
                met.push(other);
                match [(id, &ray), (other, &own_ray)].map(|(id, ray)| self.world.meets(id, ray)) {
                    [false, true] => 1.0,
                    [true, false] => 0.0,
                    _ => seam,
                }
            };
            let reach = 0.5 + (reach - 0.5) * share;
            (apart((x, y)) <= reach * reach).then_some((away, Some(other)))
        })
    }

    /// Returns the light of a pixel, counted from the top left, by the plain definition.
    pub(super) fn plain(&self, column: u32, row: u32) -> LitPixel {
        let side = self.samples.side();
        let (left, bottom) = (column * side, (self.size.height() - 1 - row) * side);
        let mut sum = LitPixel::default();
        let (mut hits, mut shown, mut behind) = (0.0, 0.0, 0.0);
        for row in bottom..bottom + side {
            for column in left..left + side {
                let ray = self.ray(column, row);
                let hit = self.world.hit(&ray);
                if hit.is_none() && self.is_transparent {
                    continue;
                }
                shown += 1.0;
                if let Some((_, hit)) = hit {
                    hits += 1.0;
                    sum.albedo = sum.albedo + hit.color().to_linear();
                }
                let integrator =
                    Integrator::new(&self.world, &self.world, self.tone, self.is_transparent);
                let light = match self.outlined_by(column, row) {
                    Some(_) => Shaded::direct(self.outlines.unwrap().color.to_linear()),
                    None => integrator.trace(&ray),
                };
                behind += light.behind.mean();
                sum.parts = sum.parts + light.parts;
            }
        }
        let count = f64::from(side * side);
        let mean = |sum: Radiance| if shown > 0.0 { sum / shown } else { sum };
        LitPixel {
            parts: sum.parts.map(mean),
            albedo: sum.albedo / count,
            coverage: hits / count,
            behind: match behind {
                0.0 => 0.0,
                sum => (sum / shown).min(1.0),
            },
            ..LitPixel::default()
        }
    }
}

/// Compares two pixels bit by bit.
fn same(one: &LitPixel, other: &LitPixel) -> bool {
    let bits = |pixel: &LitPixel| {
        let lights = pixel.parts.all().into_iter();
        let lights = lights.chain([pixel.albedo, pixel.error]);
        let channels = lights.flat_map(|light| light.channels);
        let numbers = channels.chain([pixel.coverage, pixel.behind, pixel.samples]);
        let bits = numbers.map(f64::to_bits);
        bits.collect::<Vec<_>>()
    };
    bits(one) == bits(other)
}

#[test]
fn shaded_pictures_are_those_of_the_plain_definition() {
    let pools = [1, 2, 16].map(|threads| Pool::new(Some(threads)));
    let (mut lit, mut clear, mut frames) = (0, 0, 0);
    // In the last picture, frames share copies of tiny flat shapes, far from the camera, on whose faces points lie.
    for seed in (0..cases(150) as u64).chain([1587]) {
        let mut random = Rng(seed.wrapping_mul(0x1234_5677) | 1);
        let case = Case::new(&mut random);
        let isas = Isa::all();
        let isa = isas[random.below(isas.len())];
        let pool = &pools[random.below(pools.len())];
        let crop = match random.below(3) {
            0 => Crop::new(3, 1, 5, 4).unwrap(),
            _ => Crop::whole(case.size),
        };
        let drawn = case.drawn(crop, isa, pool, None);
        let frame = Kept::of_some(&case.drawn, &mut random).map(|(kept, other)| {
            let mut before = case.clone();
            before.drawn = other;
            if random.below(4) == 0 {
                before.camera = Case::new(&mut random).camera;
            }
            before.drawn(crop, isa, pool, Some(&kept));
            case.drawn(crop, isa, pool, Some(&kept))
        });
        frames += u32::from(frame.is_some());
        let pixels = crop
            .rows()
            .flat_map(|row| crop.columns().map(move |column| (column, row)));
        for (place, (column, row)) in pixels.enumerate() {
            let plain = case.plain(column, row);
            for drawn in iter::once(&drawn).chain(&frame) {
                let found = &drawn[place];
                assert!(
                    same(found, &plain),
                    "seed {seed}, {isa}, pixel {column},{row}: {found:?} is not {plain:?}"
                );
            }
            lit += u32::from(plain.parts.direct != Radiance::BLACK);
            clear += u32::from(plain.behind > 0.0);
        }
        assert_eq!(drawn.len(), crop.columns().len() * crop.rows().len());
    }
    assert!(frames as usize * 4 > cases(150), "only {frames} frames");
    assert!(lit > 1000, "only {lit} pixels are lit");
    assert!(
        clear > 10,
        "only {clear} pixels show a transparent background"
    );
}

#[test]
fn an_explained_sample_names_the_first_neighbor_that_outlines_it() {
    let mut outlined = 0;
    for seed in 0..cases(600) as u64 {
        let mut random = Rng(seed.wrapping_mul(0x2468_ace1) | 1);
        let case = Case::new(&mut random);
        let (column, row) = (
            random.below(case.size.width() as usize) as u32,
            random.below(case.size.height() as usize) as u32,
        );
        let source = PixelSource {
            camera: &case.camera,
            world: &case.world,
            size: case.size,
            samples: case.samples,
            outlines: case.outlines,
            tone: case.tone,
            is_shaded: true,
            sample: None,
            cancel: &Cancel::new(),
        };
        let explained = source.explain(column, row).unwrap();
        let (side, top) = (case.samples.side(), case.size.height() - row);
        let mut found = explained.samples.iter();
        for y in (0..side).rev() {
            for x in 0..side {
                let (x, y) = (column * side + x, (top - 1) * side + y);
                let plain = case.outlined_by(x, y);
                assert_eq!(
                    found.next().unwrap().outlined_by,
                    plain,
                    "seed {seed}: {x},{y}"
                );
                outlined += usize::from(plain.is_some());
            }
        }
    }
    assert!(
        outlined > cases(150) / 10,
        "only {outlined} samples are outlined"
    );
}

#[test]
fn pictures_of_touching_geometries_are_those_of_the_plain_definition() {
    let pools = [1, 2].map(|threads| Pool::new(Some(threads)));
    let isas = Isa::all();
    let mut touching = 0;
    for seed in 0..cases(5000) as u64 {
        let mut random = Rng(seed.wrapping_mul(0x1357_9bdf) | 1);
        let case = Case::touching(&mut random);
        let isa = isas[random.below(isas.len())];
        let crop = Crop::whole(case.size);
        let drawn = case.drawn(crop, isa, &pools[random.below(2)], None);
        let pixels = crop
            .rows()
            .flat_map(|row| crop.columns().map(move |column| (column, row)));
        for (found, (column, row)) in drawn.iter().zip(pixels) {
            let plain = case.plain(column, row);
            assert!(
                same(found, &plain),
                "seed {seed}, {isa}, pixel {column},{row}: {found:?} is not {plain:?}"
            );
            let ray = case.ray(column, row);
            if let Some((index, hit)) = case.world.hit(&ray) {
                touching += usize::from(case.world.faces_at(&ray, index, &hit).len() > 1);
            }
        }
    }
    assert!(
        touching > cases(5000),
        "only {touching} pixels show where surfaces meet"
    );
}

#[test]
fn a_transparent_picture_in_front_of_its_background_is_the_opaque_one() {
    let pool = Pool::new(Some(1));
    let mut clear = 0;
    // In the last picture, a ray through glass meets surfaces at its own origin again and again.
    for seed in (0..cases(600) as u64 / 10).chain([2845]) {
        let mut random = Rng(seed.wrapping_mul(0x2345_6789) | 1);
        let mut case = Case::new(&mut random);
        // Alpha is one number, so the light behind it is gray.
        let gray = random.one(&[0.1, 0.5, 1.0]);
        let world = World::new(
            case.world.geometries().to_vec(),
            Color::new(gray, gray, gray),
        );
        case.drawn = match case.world.lighting() {
            Some(lighting) => world.lit(lighting.clone()),
            None => world,
        };
        let background = case.drawn.background().to_linear().mean();
        let crop = Crop::whole(case.size);
        let [opaque, transparent] = [false, true].map(|is_transparent| {
            case.is_transparent = is_transparent;
            case.drawn(crop, Isa::best(), &pool, None)
        });
        for (opaque, pixel) in opaque.iter().zip(&transparent) {
            let light = |pixel: &LitPixel| pixel.parts.sum().mean();
            let front = light(pixel) * pixel.coverage;
            let all = front + (1.0 - pixel.coverage * (1.0 - pixel.behind)) * background;
            assert!(
                (all - light(opaque)).abs() <= 1e-9 * light(opaque).max(1.0),
                "seed {seed}: {all} is not {opaque:?}, {pixel:?}"
            );
            clear += u32::from(pixel.behind > 0.0);
        }
    }
    assert!(
        clear as usize > cases(600) / 10,
        "only {clear} pixels show a transparent background"
    );
}
