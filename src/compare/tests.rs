//! Comparisons of pictures made by a few lines each, with the results of other programs.

use crate::{
    compare::{
        CompareOptions, Comparison,
        picture::{Picture, Samples},
    },
    film::size::Size,
    simd::isa::Isa,
};

fn picture(width: u32, height: u32, mut of: impl FnMut(i32, i32) -> [u8; 3]) -> Picture {
    let rows = 0..height as i32;
    let pixels = rows.flat_map(|y| (0..width as i32).map(move |x| (x, y)));
    let bytes = pixels.flat_map(|(x, y)| of(x, y)).collect();
    let size = Size::new(width, height).unwrap();
    Picture::new(size, 3, Samples::Bytes(bytes), false).unwrap()
}

/// Returns a source of bytes: the linear congruential generator of Numerical Recipes.
fn noise(seed: u32) -> impl FnMut() -> u8 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state.to_be_bytes()[0]
    }
}

fn noises(width: u32, height: u32) -> [Picture; 2] {
    [1, 2].map(|seed| {
        let mut next = noise(seed);
        picture(width, height, |_, _| [next(), next(), next()])
    })
}

/// Returns slowly changing colors, and the same with each slightly increased.
fn nudged() -> [Picture; 2] {
    let color = |x: i32, y: i32| [x * 2 + y, x + y * 3, 255 - x].map(|part| (part & 255) as u8);
    let mut next = noise(3);
    [
        picture(300, 150, color),
        picture(300, 150, |x, y| {
            color(x, y).map(|part| part.saturating_add(next() / 32))
        }),
    ]
}

/// Returns disks in front of a checkerboard, this far to the right.
fn disks(right: i32) -> impl Fn(i32, i32) -> [u8; 3] {
    const DISKS: [(i32, i32, i32, [u8; 3]); 4] = [
        (30, 30, 20, [255, 0, 0]),
        (90, 50, 35, [0, 120, 255]),
        (200, 70, 50, [250, 250, 30]),
        (260, 20, 15, [255, 255, 255]),
    ];
    move |x, y| {
        let inside = |(cx, cy, r, _): &&(i32, i32, i32, _)| {
            let (x, y) = (x - cx - right, y - cy);
            x * x + y * y < r * r
        };
        match DISKS.iter().find(inside) {
            Some((.., color)) => *color,
            None if (x / 8 + y / 8) % 2 == 1 => [20, 40, 60],
            None => [40, 60, 90],
        }
    }
}

fn line() -> [Picture; 2] {
    let line = |x: i32, _| if x == 32 { [255, 0, 0] } else { [255; 3] };
    [picture(64, 64, line), picture(64, 64, |_, _| [255; 3])]
}

fn one_step() -> [Picture; 2] {
    [0, 1].map(|step| {
        picture(64, 64, |x, y| {
            let mut color = disks(0)(x, y);
            color[2] += if (x, y) == (7, 5) { step } else { 0 };
            color
        })
    })
}

fn compare([a, b]: &[Picture; 2]) -> Comparison {
    a.compare(b, &CompareOptions::new()).unwrap().unwrap()
}

/// The expected values are those of flip-evaluator 1.7, NVIDIA's own: `evaluate(a, b, "LDR",
/// applyMagma=False)` on the bytes divided by 255, which computes in f32; and of scikit-image
/// 0.26.0: `structural_similarity(a, b, gaussian_weights=True, sigma=1.5,
/// use_sample_covariance=False, data_range=255, channel_axis=2)`.
#[test]
fn flip_and_ssim_match_other_implementations() {
    let shifted = [0, 2].map(|right| picture(300, 150, disks(right)));
    for (pair, flip, ssim) in [
        (noises(48, 33), 0.450_031_161_308, 0.013_086_528_833_591),
        (noises(12, 11), 0.519_943_535_328, -0.052_858_984_718_909),
        (nudged(), 0.102_789_700_031, 0.941_424_298_292),
        (shifted, 0.078_850_723_803, 0.905_725_311_825),
        (line(), 0.053_368_560_970, 0.879_390_672_537),
        (one_step(), 0.000_022_257_822, 0.999_999_834_257),
    ] {
        let found = compare(&pair);
        assert!((found.flip - flip).abs() < 1e-6, "{flip}: {found:?}");
        assert!((found.ssim - ssim).abs() < 1e-11, "{ssim}: {found:?}");
        let [a, b] = pair;
        let back = compare(&[b, a]);
        assert_eq!(back.flip, found.flip, "the order does not matter");
    }
    // Smaller than a window.
    let tiny = compare(&noises(5, 3));
    assert!((tiny.flip - 0.637_168_645_865).abs() < 1e-6);
    assert!(tiny.ssim < 0.5);
}

#[test]
fn differences_are_counted_and_measured() {
    let found = compare(&one_step());
    assert_eq!((found.different, found.not_finite), (1, 0));
    assert_eq!(found.first, Some([7, 5]));
    assert_eq!(found.bounds, Some([7, 5, 1, 1]));
    assert_eq!(found.max_delta, 1.0);
    assert_eq!(found.mean_delta, 1.0 / (3.0 * 64.0 * 64.0));
    let decibels = 10.0 * libm::log10(255.0 * 255.0 * 3.0 * 64.0 * 64.0);
    assert!((found.psnr - decibels).abs() < 1e-9);

    // The first pixel in reading order is in the right one of two tiles.
    let corners = picture(300, 150, |x, y| {
        let far = matches!((x, y), (290, 3) | (1, 60) | (40, 149));
        if far { [9, 0, 5] } else { [0; 3] }
    });
    let found = compare(&[corners, picture(300, 150, |_, _| [0; 3])]);
    assert_eq!((found.different, found.max_delta), (3, 9.0));
    assert_eq!(found.first, Some([290, 3]));
    assert_eq!(found.bounds, Some([1, 3, 290, 147]));
}

#[test]
fn equal_pictures_are_equal_in_every_measure() {
    let [a, _] = nudged();
    let found = compare(&[a.clone(), a]);
    assert!(found.is_equal() && !found.is_linear);
    assert_eq!((found.first, found.bounds), (None, None));
    assert_eq!((found.max_delta, found.mean_delta), (0.0, 0.0));
    assert_eq!(
        (found.psnr, found.ssim, found.flip),
        (f64::INFINITY, 1.0, 0.0)
    );
}

#[test]
fn threads_and_instruction_sets_do_not_change_the_result() {
    let [a, b] = nudged();
    let expected = compare(&[a.clone(), b.clone()]);
    for threads in [1, 2, 5] {
        for isa in Isa::all() {
            let mut options = CompareOptions::new().threads(threads);
            options.isa = isa;
            let found = a.compare(&b, &options).unwrap().unwrap();
            assert_eq!(found, expected, "{threads} {isa}");
        }
    }
}

#[test]
fn sizes_may_differ() {
    let [a, b] = [(3, 2), (2, 3)].map(|(width, height)| picture(width, height, |_, _| [0; 3]));
    assert_eq!(a.compare(&b, &CompareOptions::new()).unwrap(), None);
}

fn pixels(channels: usize, samples: Samples) -> Picture {
    let found = match &samples {
        Samples::Bytes(bytes) => bytes.len(),
        Samples::Words(words) => words.len(),
        Samples::Floats(floats) => floats.len(),
    };
    let size = Size::new((found / channels) as u32, 1).unwrap();
    Picture::new(size, channels, samples, false).unwrap()
}

#[test]
fn nan_and_infinity_neither_hide_nor_spoil_differences() {
    let floats = |floats: [f32; 6]| pixels(3, Samples::Floats(floats.to_vec()));
    let plain = floats([0.0, 0.5, 1.0, 0.0, 0.5, 1.0]);
    for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let broken = floats([0.0, 0.5, 1.0, 0.0, odd, 1.0]);
        let same = compare(&[broken.clone(), broken.clone()]);
        assert!(same.is_equal() && same.is_linear, "{odd}");
        let found = compare(&[plain.clone(), broken]);
        assert_eq!((found.different, found.not_finite), (1, 1), "{odd}");
        assert_eq!(found.max_delta, f64::INFINITY);
        assert_eq!(found.psnr, f64::NEG_INFINITY);
        assert!(found.ssim < 0.999 && found.flip > 0.1, "{odd}: {found:?}");
    }
}

#[test]
fn every_measure_sees_alpha() {
    let [clear, opaque] = [0, 255].map(|alpha| {
        let colors = [[0, 0, 0, alpha], [255, 255, 255, alpha]];
        pixels(4, Samples::Bytes(colors.concat()))
    });
    let found = compare(&[clear, opaque.clone()]);
    assert_eq!(
        (found.different, found.max_delta, found.mean_delta),
        (2, 255.0, 63.75)
    );
    assert!(found.flip > 0.5 && found.ssim < 0.9, "{found:?}");
    // A picture without alpha is opaque.
    let without = pixels(3, Samples::Bytes(vec![0, 0, 0, 255, 255, 255]));
    assert!(compare(&[opaque, without]).is_equal());
}

#[test]
fn floats_are_compared_as_displayed() {
    // Half of the light displays as 188, more than half of white.
    let half = pixels(1, Samples::Floats(vec![0.5; 4]));
    let display = pixels(1, Samples::Bytes(vec![188; 4]));
    assert!(compare(&[half.clone(), display.clone()]).is_equal());
    let black = pixels(1, Samples::Floats(vec![0.0; 4]));
    let shown = compare(&[display, pixels(1, Samples::Bytes(vec![0; 4]))]);
    let found = compare(&[half, black]);
    assert_eq!(found.max_delta, 127.5);
    assert!((found.flip - shown.flip).abs() < 1e-3 && (found.ssim - shown.ssim).abs() < 1e-3);
}

#[test]
fn the_heat_picture_shows_where_they_differ() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("heat.png");
    let dot = |x: i32, y: i32| {
        if (x, y) == (280, 100) {
            [1, 0, 0]
        } else {
            [0; 3]
        }
    };
    let [a, b] = [picture(300, 150, dot), picture(300, 150, |_, _| [0; 3])];
    let options = CompareOptions::new().heat(&path);
    a.compare(&b, &options).unwrap().unwrap();
    let heat = image::open(&path).unwrap().to_rgb8();
    assert_eq!(heat.dimensions(), (300, 150));
    let brightest = heat.enumerate_pixels().max_by_key(|(.., color)| color.0[0]);
    let (x, y, color) = brightest.unwrap();
    assert!((x, y) == (280, 100) && color.0[0] > 50, "{color:?}");
    assert_eq!(heat.get_pixel(0, 0).0, [0, 0, 4]);
}
