//! All metrics for one tile of two pictures.

use crate::{
    compare::{
        flip::{Flip, color::to_opponents},
        heat,
        picture::Picture,
        plane::{Plane, Region},
        ssim::Windows,
        tally::Tally,
        values::{Channels, Form, WHITE, delta, same_bits},
    },
    simd::isa::Isa,
};

const WIDTH: usize = 256;
const HEIGHT: usize = 64;

/// Two pictures of the same size, with everything needed to measure their differences.
pub(super) struct Pair<'a> {
    a: &'a Picture,
    b: &'a Picture,
    pub(super) form: Form,
    flip: Flip,
    pub(super) windows: Windows,
    /// The width and height.
    pub(super) sides: (usize, usize),
    with_heat: bool,
    isa: Isa,
}

/// The results for a tile.
pub(super) struct Measured {
    pub(super) tile: Region,
    pub(super) tally: Tally,
    /// The sum of the FLIP errors of all pixels.
    pub(super) flip: f64,
    /// The sum of the similarities over all windows and channels.
    pub(super) ssim: f64,
    /// The RGB bytes of the heat picture; empty if it is not wanted.
    pub(super) heat: Vec<u8>,
}

impl<'a> Pair<'a> {
    pub(super) fn new(a: &'a Picture, b: &'a Picture, with_heat: bool, isa: Isa) -> Self {
        let sides = (a.size().width() as usize, a.size().height() as usize);
        Self {
            a,
            b,
            form: Form::new(a, b),
            flip: Flip::new(),
            windows: Windows::new(sides),
            sides,
            with_heat,
            isa,
        }
    }

    /// Returns all tiles, in rows from the top left.
    pub(super) fn tiles(&self) -> impl Iterator<Item = Region> + Send + use<> {
        let (width, height) = self.sides;
        let tops = (0..height).step_by(HEIGHT);
        tops.flat_map(move |top| {
            let lefts = (0..width).step_by(WIDTH);
            lefts.map(move |left| Region {
                left,
                top,
                right: (left + WIDTH).min(width),
                bottom: (top + HEIGHT).min(height),
            })
        })
    }

    pub(super) fn measure(&self, tile: Region) -> Measured {
        let seen = tile.with_neighbors(self.sides);
        if same_bits(self.a, self.b, seen) {
            return self.equal(tile);
        }
        let mut both = self.form.read(self.a, self.b, seen);
        let differs = |[a, b]: [f64; 2]| [delta(a, b)];
        let deltas: Channels = std::array::from_fn(|channel| {
            let [deltas] = Plane::from_planes([&both[0][channel], &both[1][channel]], differs);
            deltas
        });
        if deltas.iter().all(|plane| plane.is_all(0.0)) {
            return self.equal(tile);
        }
        self.form.limit(&mut both);
        let errors = self.errors(&both, tile);
        Measured {
            tile,
            tally: Tally::of(&deltas, tile),
            flip: errors.iter().sum(),
            ssim: self.ssim(&both, tile),
            heat: self.heat(&errors, &deltas, tile),
        }
    }

    /// Returns the results for a tile where the pictures are equal, as far as any filter reaches.
    fn equal(&self, tile: Region) -> Measured {
        let pixels = if self.with_heat {
            tile.width() * tile.height()
        } else {
            0
        };
        Measured {
            tile,
            tally: Tally::default(),
            flip: 0.0,
            ssim: (self.windows.count(tile) * self.form.channels() as u64) as f64,
            heat: heat::color(0.0, false).repeat(pixels),
        }
    }

    fn ssim(&self, [a, b]: &[Channels; 2], tile: Region) -> f64 {
        let mut sum = 0.0;
        for channel in 0..self.form.channels() {
            if a[channel] == b[channel] {
                sum += self.windows.count(tile) as f64;
                continue;
            }
            let display = |[value]: [f64; 1]| {
                let is_color = channel < 3;
                [if is_color {
                    self.form.display(value)
                } else {
                    value
                }]
            };
            let [a, b] = [a, b].map(|planes| Plane::from_planes([&planes[channel]], display));
            sum += self.windows.sum(&a[0], &b[0], tile, self.isa);
        }
        sum
    }

    /// Returns the FLIP error of each pixel. If a picture is transparent anywhere, this is the
    /// larger of the errors over black and over white.
    fn errors(&self, both: &[Channels; 2], tile: Region) -> Vec<f64> {
        let before = |background: f64| {
            let [a, b] = both.each_ref().map(|planes| {
                Plane::from_planes(planes.each_ref(), |pixel| {
                    to_opponents(self.form.linear(pixel, background))
                })
            });
            self.flip.errors(&a, &b, tile, self.isa)
        };
        let mut errors = before(0.0);
        if both.iter().any(|[.., alpha]| !alpha.is_all(WHITE)) {
            for (error, other) in errors.iter_mut().zip(before(1.0)) {
                *error = error.max(other);
            }
        }
        errors
    }

    fn heat(&self, errors: &[f64], deltas: &Channels, tile: Region) -> Vec<u8> {
        if !self.with_heat {
            return Vec::new();
        }
        let mut heat = Vec::with_capacity(errors.len() * 3);
        for (y, errors) in (tile.top..).zip(errors.chunks_exact(tile.width())) {
            let deltas = deltas.each_ref().map(|plane| plane.row_from(tile.left, y));
            for (x, error) in errors.iter().enumerate() {
                let differs = deltas.iter().any(|row| row[x] > 0.0);
                heat.extend(heat::color(*error, differs));
            }
        }
        heat
    }
}
