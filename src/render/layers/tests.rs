//! Comparison of the rows of files with the plain definition of each number.

use std::sync::Mutex;

use crate::{
    film::{crop::Crop, samples::Samples},
    image_file::ImageFormat,
    parallel::Pool,
    render::{
        hits::Rays,
        layers::{
            Layer,
            layout::{Layout, Settings},
            rows::Painter,
        },
        tests::{Case, LitPixel},
    },
    simd::isa::Isa,
    tracer::{
        color::Color,
        radiance::Radiance,
        random::{Rng, cases},
        srgb::quantize,
    },
};

/// Returns the rows of a file of the picture with these layers.
fn rows(case: &Case, (format, layers): (ImageFormat, &[Layer]), bits: u8, isa: Isa) -> Vec<u8> {
    let settings = Settings {
        bits: Some(bits),
        is_transparent: case.is_transparent,
        depth_range: None,
    };
    let layout = Layout::new(format, layers, settings, &case.drawn).unwrap();
    let crop = Crop::whole(case.size);
    let pixels = [&crop.columns(), &crop.rows()];
    let painter = Painter {
        world: &case.drawn,
        rays: layout
            .has_places()
            .then(|| Rays::new(&case.camera, case.size, Samples::ONE, pixels)),
        tone: case.drawn.tone(case.tone),
        background: (!case.is_transparent).then(|| case.drawn.background()),
        layout: &layout,
        mattes: &[],
        isa,
        known: Mutex::default(),
    };
    let pool = &Pool::Calling;
    let (mut bytes, mut top) = (Vec::new(), 0);
    case.draw((crop, layout.centers()), isa, (pool, None), |film| {
        let rows = painter.rows(&film, top, pool);
        top += rows.len();
        bytes.extend(rows.concat());
    });
    bytes
}

/// Calls a function with the column and the row of each pixel, from the top left.
fn each(case: &Case, mut of: impl FnMut(u32, u32)) {
    for row in 0..case.size.height() {
        (0..case.size.width()).for_each(|column| of(column, row));
    }
}

#[test]
fn numbers_are_those_of_the_plain_definition() {
    let isas = Isa::all();
    let (mut hits, mut blends) = (0, 0);
    for seed in 0..cases(400) as u64 {
        let mut random = Rng(seed.wrapping_mul(0x1f35_79bd) | 1);
        let case = Case::new(&mut random);
        let isa = isas[random.below(isas.len())];
        let (width, height) = (case.size.width(), case.size.height());
        let (eye, w) = (case.camera.eye(), case.camera.w());
        type Value<'a> = &'a dyn Fn(u32, u32, &LitPixel) -> Vec<f64>;
        let hit = |column: u32, row: u32| {
            let y = f64::from(height - 1 - row);
            let ray = case.camera.ray_for(width, height, column.into(), y);
            case.world.hit(&ray).map(|(_, hit)| hit)
        };
        let exposed = |light| {
            let light: Radiance = case.drawn.tone(case.tone).expose(light);
            light.channels.to_vec()
        };
        let all: [(Layer, Value); 9] = [
            (Layer::Color, &|_, _, pixel| {
                let mut light = exposed(pixel.parts.sum());
                if case.is_transparent {
                    let alpha = pixel.coverage * (1.0 - pixel.behind);
                    for light in &mut light {
                        *light = match alpha {
                            0.0 => 0.0,
                            alpha => *light * pixel.coverage / alpha,
                        };
                    }
                    light.push(alpha);
                }
                light
            }),
            (Layer::Depth, &|column, row, _| {
                vec![hit(column, row).map_or(f64::INFINITY, |hit| hit.t)]
            }),
            (Layer::Z, &|column, row, _| {
                vec![hit(column, row).map_or(f64::INFINITY, |hit| (hit.point - eye).dot(-w))]
            }),
            (Layer::Position, &|column, row, _| {
                hit(column, row).map_or(vec![0.0; 3], |hit| hit.point.to_array().to_vec())
            }),
            (Layer::Normal, &|column, row, _| {
                hit(column, row).map_or(vec![0.0; 3], |hit| hit.normal.to_array().to_vec())
            }),
            (Layer::Coverage, &|_, _, pixel| vec![pixel.coverage]),
            (Layer::Albedo, &|_, _, pixel| pixel.albedo.channels.to_vec()),
            (Layer::Direct, &|_, _, pixel| exposed(pixel.parts.direct)),
            (Layer::Specular, &|_, _, pixel| {
                exposed(pixel.parts.specular)
            }),
        ];
        for (layer, value) in all {
            let found = rows(&case, (ImageFormat::NPY, &[layer]), 32, isa);
            // Colors have 32 bits.
            let size = if layer == Layer::Color { 4 } else { 8 };
            let mut found = found.chunks(size);
            each(&case, |column, row| {
                let pixel = case.plain(column, row);
                blends += u32::from(case.is_transparent && pixel.coverage.fract() != 0.0);
                for expected in value(column, row, &pixel) {
                    let (found, expected) = match found.next().unwrap() {
                        &[a, b, c, d] => {
                            let found = f32::from_ne_bytes([a, b, c, d]);
                            (f64::from(found), f64::from(expected as f32))
                        }
                        bytes => (f64::from_ne_bytes(bytes.try_into().unwrap()), expected),
                    };
                    assert!(
                        found.to_bits() == expected.to_bits(),
                        "seed {seed}, {isa}, {layer} at {column},{row}: {found}, not {expected}"
                    );
                }
                hits += u32::from(hit(column, row).is_some());
            });
            assert_eq!(found.next(), None);
        }
    }
    assert!(hits > 1000, "only {hits} hits");
    assert!(
        blends > 100,
        "only {blends} pixels show a part of what is behind"
    );
}

#[test]
fn integers_are_those_of_the_plain_color() {
    let isas = Isa::all();
    for seed in 0..cases(100) as u64 {
        let mut random = Rng(seed.wrapping_mul(0x2f46_8ace) | 1);
        let case = Case::new(&mut random);
        let isa = isas[random.below(isas.len())];
        let layer = random.one(&[Layer::Color, Layer::Direct, Layer::Albedo]);
        let tone = case.drawn.tone(case.tone);
        for (bits, most) in [(8, 255), (16, 65_535)] {
            let found = rows(&case, (ImageFormat::PNG, &[layer]), bits, isa);
            let mut found = found.chunks(usize::from(bits) / 8);
            each(&case, |column, row| {
                let pixel = case.plain(column, row);
                let color = match layer {
                    Layer::Direct => tone.color(pixel.parts.direct),
                    Layer::Albedo => Color::from_linear(pixel.albedo),
                    _ if pixel.behind < 1.0 => tone.color(pixel.parts.sum() / (1.0 - pixel.behind)),
                    _ => Color::BLACK,
                };
                let mut expected = vec![color.r(), color.g(), color.b()];
                if layer == Layer::Color && case.is_transparent {
                    expected.push(pixel.coverage * (1.0 - pixel.behind));
                }
                for expected in expected {
                    let found: u32 = match found.next() {
                        Some(&[byte]) => byte.into(),
                        Some(&[one, other]) => u16::from_ne_bytes([one, other]).into(),
                        _ => panic!("too few"),
                    };
                    assert_eq!(
                        found,
                        quantize(expected, most),
                        "seed {seed}, {isa}, {layer} of {bits} bits at {column},{row}"
                    );
                }
            });
            assert_eq!(found.next(), None);
        }
    }
}
