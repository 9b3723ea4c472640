//! Comparison of pictures whose light follows paths with the plain definition.

use crate::{
    film::crop::Crop,
    integrator::{
        direct::Shaded,
        path::{PathTracer, sampler::Sampler},
    },
    parallel::Pool,
    render::tests::{Case, LitPixel, same},
    simd::isa::Isa,
    tracer::{
        camera::Camera,
        color::Color,
        light::transport::{PathOptions, PixelFilter, Transport},
        radiance::Radiance,
        random::{Rng, cases},
        world::Lighting,
    },
};

/// Gives the light of a case paths.
fn by_paths(case: &mut Case, random: &mut Rng) {
    let options = PathOptions {
        samples: random.one(&[1, 2, 5]),
        diffuse_depth: random.one(&[None, Some(0), Some(2)]),
        caustics: random.below(2) == 0,
        clamp: random.one(&[None, Some(0.5)]),
        seed: random.below(1000) as u32,
        filter: random.one(&[PixelFilter::Box, PixelFilter::Gaussian(0.7)]),
    };
    if let Camera::Perspective(camera) = case.camera {
        let aperture = random.one(&[0.0, 0.4]);
        case.camera = camera.with_lens(aperture, 5.0).unwrap().into();
    }
    let lighting = Lighting {
        max_depth: random.one(&[0, 1, 4, 9]) as u32,
        transport: Transport::Path(options),
        ..Lighting::new(case.world.lights().to_vec())
    };
    case.world = case.world.clone().lit(lighting.clone());
    case.drawn = case.drawn.clone().lit(lighting);
}

/// Returns the light of a pixel by plain loops.
fn plain(case: &Case, [column, row]: [u32; 2]) -> LitPixel {
    let world = &case.world;
    let (lighting, options) = (world.lighting().unwrap(), *world.paths().unwrap());
    let paths = PathTracer::new(world, lighting, options, world, case.is_transparent);
    let (width, height) = (case.size.width(), case.size.height());
    let y = height - 1 - row;
    let (mut sum, mut albedo, mut hits) = (Shaded::default(), Radiance::BLACK, 0.0);
    for sample in 0..options.samples {
        let sampler = Sampler::new([column, y], sample, options.seed);
        let [right, up] = options.filter.place(sampler.pair(0));
        let place = [f64::from(column) + right, f64::from(y) + up];
        let ray = case
            .camera
            .ray_from_lens((width, height), place, sampler.pair(1));
        let traced = paths.sample(ray, &sampler);
        sum = sum + traced.light;
        albedo = albedo + traced.color.map_or(Radiance::BLACK, Color::to_linear);
        assert_eq!(traced.first.is_some(), world.hit(&ray).is_some());
        hits += f64::from(u8::from(traced.first.is_some()));
    }
    let count = f64::from(options.samples);
    if let Some(outlines) = &case.outlines {
        let side = case.samples.side();
        let fine = |at: u32| at * side..(at + 1) * side;
        let inked = fine(column).flat_map(|x| fine(y).map(move |y| (x, y)));
        let inked = inked.filter(|(x, y)| case.outlined_by(*x, *y).is_some());
        let inked = inked.count() as f64 / f64::from(case.samples.count());
        let parts = sum.parts.map(|part| part * (1.0 - inked));
        let ink = Shaded::direct(outlines.color.to_linear() * (inked * count));
        sum = Shaded { parts, ..sum } + ink;
    }
    let shown = match case.is_transparent {
        true => hits.max(1.0),
        false => count,
    };
    LitPixel {
        parts: sum.parts.map(|part| part / shown),
        albedo: albedo / count,
        coverage: hits / count,
        behind: (sum.behind.mean() / hits.max(1.0)).min(1.0),
    }
}

#[test]
fn pictures_by_paths_are_those_of_plain_loops() {
    let pools = [1, 3].map(|threads| Pool::new(Some(threads)));
    let isas = Isa::all();
    let (mut lit, mut clear) = (0, 0);
    for seed in 0..cases(600) as u64 {
        let mut random = Rng(seed.wrapping_mul(0x1234_5679) | 1);
        let mut case = match random.below(3) {
            0 => Case::touching(&mut random),
            _ => Case::new(&mut random),
        };
        by_paths(&mut case, &mut random);
        let isa = isas[random.below(isas.len())];
        let crop = Crop::new(1, 1, 3, 2).unwrap();
        let drawn = pools
            .each_ref()
            .map(|pool| case.drawn(crop, isa, pool, None));
        let pixels = crop
            .rows()
            .flat_map(|row| crop.columns().map(move |column| [column, row]));
        for (place, pixel) in pixels.enumerate() {
            let plain = plain(&case, pixel);
            for drawn in &drawn {
                let found = &drawn[place];
                assert!(
                    same(found, &plain),
                    "seed {seed}, {isa}, pixel {pixel:?}: {found:?} is not {plain:?}"
                );
            }
            lit += u32::from(plain.parts.sum() != Radiance::BLACK);
            clear += u32::from(plain.behind > 0.0);
        }
    }
    assert!(lit > 100, "only {lit} pixels are lit");
    assert!(clear > 2, "only {clear} pixels show what is behind");
}
