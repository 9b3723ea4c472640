//! The sRGB curve (IEC 61966-2-1) between linear light and display values, both in 0..1, and the
//! conversion of display values to integers.

use std::{array, cell::Cell, sync::OnceLock};

/// Returns the linear light of a display value: `c/12.92` for `c <= 0.04045`, else
/// `((c+0.055)/1.055)^2.4`.
pub(crate) fn to_linear(display: f64) -> f64 {
    if display <= 0.04045 {
        display / 12.92
    } else {
        libm::pow((display + 0.055) / 1.055, 2.4)
    }
}

thread_local! {
    /// Display values that are no bytes, with their linear light. One of them replaces another.
    static KNOWN: [Cell<(f64, f64)>; 256] = const { [const { Cell::new((0.0, 0.0)) }; 256] };
}

/// Returns [`to_linear`] of a display value, but faster for bytes, which most colors consist of, and for the
/// last values that a thread has asked for.
pub(crate) fn linear_of(display: f64) -> f64 {
    // In a box, as all other tables: memory of its own would be in the file of the program.
    static BYTES: OnceLock<Box<[(f64, f64); 256]>> = OnceLock::new();
    let bytes = BYTES.get_or_init(|| {
        Box::new(array::from_fn(|byte| {
            let display = byte as f64 / 255.0;
            (display, to_linear(display))
        }))
    });
    match bytes[quantize(display, u8::MAX.into()) as usize] {
        (same, linear) if same == display => linear,
        _ => KNOWN.with(|known| {
            // The upper bits of a product depend on all bits of its factors.
            let place = display.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 56;
            let known = &known[place as usize];
            if known.get().0 != display {
                known.set((display, to_linear(display)));
            }
            known.get().1
        }),
    }
}

/// Returns the display value of light: `12.92·l` for `l <= 0.0031308`, else `1.055·l^(1/2.4) -
/// 0.055`.
pub(crate) fn to_display(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    }
}

/// Returns the integer in 0..=`most` of a display value: `floor(c · most + 0.5)`, where c is
/// clamped to 0..1 and NaN counts as 0.
///
/// No other code turns colors into integers.
pub(crate) fn quantize(display: f64, most: u32) -> u32 {
    // The cast truncates, which equals floor here, and turns NaN into 0.
    (display.clamp(0.0, 1.0) * f64::from(most) + 0.5) as u32
}

/// The number of pixels whose integers are found at once. With half as many, compilers unroll the loops
/// entirely, and the program is larger.
pub(crate) const BLOCK: usize = 128;

/// A table that finds [`quantize`] of [`to_display`] for numbers of 16 bits without a power: by a
/// series around the middle of a cell of light.
pub(crate) struct Levels {
    /// For each cell, the power `1.055·m^(1/2.4)` of its middle m.
    powers: [f64; CELLS],
    /// `1/m`.
    reciprocals: [f64; CELLS],
}

/// The lowest light in the cells, 2⁻¹⁵. The curve is a line up to 2⁻⁸.
const LEAST: u64 = (1023 - 15) << 52;
/// Each octave of light has 2⁵ cells.
const SHIFT: u32 = 52 - 5;
/// 16 octaves, up to 2.
const CELLS: usize = 16 << 5;
/// The binomial series of `(1+d)^p`, p = 1/2.4, without the 1 in front. With |d| at most 2⁻⁶, the sum of
/// all further terms is less than 2⁻³⁵.
const P: f64 = 1.0 / 2.4;
const SERIES: [f64; 4] = [
    P,
    P * (P - 1.0) / 2.0,
    P * (P - 1.0) * (P - 2.0) / 6.0,
    P * (P - 1.0) * (P - 2.0) * (P - 3.0) / 24.0,
];
/// The distance from half a level below which a number takes the exact path: more than twice the largest
/// error, 2⁻³⁵ of the largest number.
const CLEAR: f64 = 5e-6;
/// The number to which an integer can be added so that it is the lowest bits of the sum.
const INTEGERS: f64 = (1_u64 << 52) as f64;

impl Levels {
    fn new() -> Self {
        let middle = |cell: usize| {
            let half = 1 << (SHIFT - 1);
            f64::from_bits(LEAST + ((cell as u64) << SHIFT) + half)
        };
        Self {
            powers: array::from_fn(|cell| 1.055 * libm::pow(middle(cell), P)),
            reciprocals: array::from_fn(|cell| 1.0 / middle(cell)),
        }
    }

    /// Returns the table.
    pub(crate) fn table() -> &'static Self {
        static LEVELS: OnceLock<Box<Levels>> = OnceLock::new();
        LEVELS.get_or_init(|| Box::new(Self::new()))
    }

    /// Sets the numbers of a block, by channel.
    #[inline(always)]
    pub(crate) fn of_block(&self, light: &[[f64; BLOCK]; 3], numbers: &mut [[u16; BLOCK]; 3]) {
        const COUNT: usize = 3 * BLOCK;
        let (light, numbers) = (light.as_flattened(), numbers.as_flattened_mut());
        // Each step by itself is one that compilers take many at a time.
        let mut cells = [0; COUNT];
        for (cell, light) in cells.iter_mut().zip(light) {
            let light = unit(*light).max(f64::from_bits(LEAST));
            *cell = (light.to_bits() - LEAST) >> SHIFT;
        }
        let (mut powers, mut reciprocals) = ([0.0; COUNT], [0.0; COUNT]);
        let both = powers.iter_mut().zip(&mut reciprocals);
        for ((power, reciprocal), cell) in both.zip(&cells) {
            let cell = *cell as usize % CELLS;
            (*power, *reciprocal) = (self.powers[cell], self.reciprocals[cell]);
        }
        let (mut sums, mut unclear) = ([0; COUNT], 0);
        let [a, b, c, d] = SERIES;
        for place in 0..COUNT {
            let light = unit(light[place]);
            let x = light * reciprocals[place] - 1.0;
            let curve = powers[place] * (1.0 + x * (a + x * (b + x * (c + x * d)))) - 0.055;
            let line = 12.92 * light;
            let display = if light <= 0.003_130_8 { line } else { curve };
            let level = display * f64::from(u16::MAX);
            let sum = level + INTEGERS;
            sums[place] = sum.to_bits();
            unclear |= u8::from((level - (sum - INTEGERS)).abs() > 0.5 - CLEAR);
        }
        for (number, sum) in numbers.iter_mut().zip(&sums) {
            *number = *sum as u16;
        }
        if unclear != 0 {
            let exact = |light| quantize(to_display(light), u16::MAX.into()) as u16;
            of_neighbors(light, numbers, exact);
        }
    }
}

/// Sets the numbers of channels, one after the other. Neighbors often have the same light.
#[cold]
#[inline(never)]
pub(super) fn of_neighbors<T: Copy + Default>(
    light: &[f64],
    numbers: &mut [T],
    of: impl Fn(f64) -> T,
) {
    let mut last = (f64::NAN, T::default());
    for (number, light) in numbers.iter_mut().zip(light) {
        if last.0 != *light {
            last = (*light, of(*light));
        }
        *number = last.1;
    }
}

/// Returns light within 0..1; NaN becomes 0.
#[inline(always)]
fn unit(light: f64) -> f64 {
    let light = if light > 0.0 { light } else { 0.0 };
    if light < 1.0 { light } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::random::{Rng, cases};

    #[test]
    fn each_curve_inverts_the_other() {
        for byte in 0..=255 {
            let display = f64::from(byte) / 255.0;
            assert_eq!(linear_of(display), to_linear(display));
            let back = to_display(to_linear(display));
            assert!((back - display).abs() < 1e-7, "{byte}: {back}");
        }
        let mut random = Rng(8);
        let others: Vec<_> = (0..cases(2000)).map(|_| random.signed().abs()).collect();
        for display in others.iter().chain(&others) {
            assert_eq!(linear_of(*display), to_linear(*display));
        }
        // Middle gray, the 18 % of a print.
        assert!((to_display(0.18) * 255.0 - 117.65).abs() < 0.01);
    }

    #[test]
    fn integers_round_half_up() {
        assert_eq!(
            [-1.0, f64::NAN, 0.499 / 255.0].map(|c| quantize(c, 255)),
            [0; 3]
        );
        assert_eq!(
            [0.5 / 255.0, 0.5, 7.0].map(|c| quantize(c, 255)),
            [1, 128, 255]
        );
        assert_eq!([0.5, 1.0].map(|c| quantize(c, 65_535)), [32_768, 65_535]);
    }

    #[test]
    fn numbers_of_16_bits_are_those_of_the_curve() {
        const COUNT: usize = 3 * BLOCK;
        let check = |light: [f64; COUNT]| {
            let mut numbers = [[0; BLOCK]; 3];
            let channels = light.as_chunks().0.try_into().unwrap();
            Levels::table().of_block(channels, &mut numbers);
            for (number, light) in numbers.as_flattened().iter().zip(light) {
                let expected = quantize(to_display(light), u16::MAX.into());
                assert_eq!(u32::from(*number), expected, "{light}");
            }
        };
        let mut random = Rng(5);
        for _ in 0..cases(4_000) {
            check(array::from_fn(|_| random.magnitude(-6.0, 0.3)));
            // Around half a level, and alone among clear ones.
            let half = (random.below(65_535) as f64 + 0.5) / 65_535.0;
            let half = to_linear(half).to_bits();
            let place = random.below(COUNT);
            let shift = random.below(80) as i64 - 40;
            let near = f64::from_bits(half.wrapping_add_signed(shift << random.below(30)));
            check(array::from_fn(
                |lane| if lane == place { near } else { 0.25 },
            ));
        }
        let cells = (0..CELLS as u64).map(|cell| f64::from_bits(LEAST + (cell << SHIFT)));
        cells.for_each(|light| check(array::from_fn(|at| light * (1.0 + at as f64 / 6144.0))));
        check(
            [
                0.0,
                -1.0,
                f64::NAN,
                1.0,
                7.0,
                f64::INFINITY,
                0.003_130_8,
                -0.0,
            ]
            .repeat(COUNT / 8)
            .try_into()
            .unwrap(),
        );
    }
}
