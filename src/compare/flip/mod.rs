//! FLIP for pictures of low dynamic range: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström
//! and Fairchild, "FLIP: A Difference Evaluator for Alternating Images", Proceedings of the ACM on
//! Computer Graphics and Interactive Techniques 3 (2), 2020. Comments refer to its sections.

pub(super) mod color;

use std::f64::consts::{PI, SQRT_2};

use crate::{
    compare::{
        flip::color::{Lab, from_opponents},
        plane::{Filter, Plane, Region, Taps},
    },
    simd::isa::Isa,
};

/// The pixels per degree of a display 0.7 m wide with 3840 pixels, seen from 0.7 m.
const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * (PI / 180.0);

// Section 4.1.3: the exponent of color differences, and the bend in their scale.
const COLOR_EXPONENT: f64 = 0.7;
const BEND: f64 = 0.4;
const BENT: f64 = 0.95;

/// Section 4.2: the width of an edge or a point, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// The filters, and the largest color difference.
#[derive(Clone, Debug)]
pub(super) struct Flip {
    /// Section 4.1.1: the eye's response to brightness, to red-green, and in two parts to
    /// blue-yellow.
    brightness: Taps,
    red_green: Taps,
    blue_yellow: [Taps; 2],
    /// Section 4.2: a Gaussian and its first and second derivatives.
    gaussian: Taps,
    edge: Taps,
    point: Taps,
    largest: f64,
}

impl Flip {
    pub(super) fn new() -> Self {
        let seen = |b: f64| sensitivity(b).normalized();
        // Table 1. The two parts are weighted by their shares of the total; each filter is applied
        // in two dimensions, hence the root.
        let parts = [(34.1, 0.04), (13.5, 0.025)].map(|(a, b)| {
            let taps = sensitivity(b);
            let weight = a * libm::sqrt(PI / b) * taps.sum() * taps.sum();
            (taps.normalized(), weight)
        });
        let total = parts[0].1 + parts[1].1;
        let blue_yellow = parts.map(|(taps, weight)| taps.scaled(libm::sqrt(weight / total)));

        let sigma = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let reach = (3.0 * sigma).ceil() as usize;
        let gaussian = move |x: f64| libm::exp(-x * x / (2.0 * sigma * sigma));
        let edge = move |x: f64| -x * gaussian(x);
        let point = move |x: f64| (x * x / (sigma * sigma) - 1.0) * gaussian(x);
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Lab::of);
        Self {
            brightness: seen(0.0047),
            red_green: seen(0.0053),
            blue_yellow,
            gaussian: Taps::new(reach, gaussian).normalized(),
            edge: Taps::new(reach, edge).balanced(),
            point: Taps::new(reach, point).balanced(),
            largest: libm::pow(green.distance(blue), COLOR_EXPONENT),
        }
    }

    /// Returns the error of each pixel in a region, row by row, from 0 (equal) to 1 (the largest).
    /// The pictures are given as Y, Cx and Cz.
    pub(super) fn errors(
        &self,
        a: &[Plane; 3],
        b: &[Plane; 3],
        region: Region,
        isa: Isa,
    ) -> Vec<f64> {
        let mut errors = Vec::with_capacity(region.width() * region.height());
        let mut sides = [a, b].map(|planes| SeenPicture::new(planes, region, isa));
        for y in region.top..region.bottom {
            sides.iter_mut().for_each(|side| side.see(self, y));
            let [a, b] = &sides;
            for x in 0..region.width() {
                let color = self.color(a.color(x), b.color(x));
                let feature = feature(a, b, x);
                // Section 4.3.
                errors.push(libm::pow(color, 1.0 - feature));
            }
        }
        errors
    }

    /// Returns the difference of two colors in 0..1 (section 4.1).
    fn color(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        if a == b {
            return 0.0;
        }
        let [a, b] = [a, b].map(|seen| Lab::of(from_opponents(seen)));
        let difference = libm::pow(a.distance(b), COLOR_EXPONENT);
        let bend = BEND * self.largest;
        if difference < bend {
            difference * (BENT / bend)
        } else {
            BENT + (difference - bend) / (self.largest - bend) * (1.0 - BENT)
        }
    }
}

/// Returns the difference of edges and points in 0..1 (section 4.2).
fn feature(a: &SeenPicture, b: &SeenPicture, x: usize) -> f64 {
    let length = |pair: &[Vec<f64>; 2]| {
        let [across, down] = [pair[0][x], pair[1][x]];
        libm::sqrt(across * across + down * down)
    };
    let edges = (length(&a.edges) - length(&b.edges)).abs();
    let points = (length(&a.points) - length(&b.points)).abs();
    libm::sqrt(edges.max(points) / SQRT_2).min(1.0)
}

/// Returns the eye's weights for the neighbors of a color, by the exponent in Table 1.
fn sensitivity(b: f64) -> Taps {
    /// The largest of the exponents.
    const WIDEST: f64 = 0.04;
    let reach = 3.0 * libm::sqrt(WIDEST / (2.0 * PI * PI)) * PIXELS_PER_DEGREE;
    Taps::new(reach.ceil() as usize, move |distance| {
        let degrees = distance / PIXELS_PER_DEGREE;
        libm::exp(-PI * PI * degrees * degrees / b)
    })
}

/// A row of one picture, as the eye sees it.
struct SeenPicture<'a> {
    planes: &'a [Plane; 3],
    from: usize,
    width: usize,
    filter: Filter,
    colors: [Vec<f64>; 3],
    edges: [Vec<f64>; 2],
    points: [Vec<f64>; 2],
}

impl<'a> SeenPicture<'a> {
    fn new(planes: &'a [Plane; 3], region: Region, isa: Isa) -> Self {
        Self {
            planes,
            from: region.left - planes[0].region().left,
            width: region.width(),
            filter: Filter::new(isa),
            colors: Default::default(),
            edges: Default::default(),
            points: Default::default(),
        }
    }

    fn color(&self, x: usize) -> [f64; 3] {
        self.colors.each_ref().map(|row| row[x])
    }

    fn see(&mut self, flip: &Flip, y: usize) {
        let (from, width) = (self.from, self.width);
        let [brightness, red_green, blue_yellow] = self.planes;
        let filter = &mut self.filter;
        let mut blur = |plane: &Plane, taps: &Taps| {
            filter
                .down(plane, y, taps)
                .across(from, width, taps)
                .to_vec()
        };
        self.colors = [
            blur(brightness, &flip.brightness),
            blur(red_green, &flip.red_green),
            blur(blue_yellow, &flip.blue_yellow[0]),
        ];
        let rest = blur(blue_yellow, &flip.blue_yellow[1]);
        for (sum, rest) in self.colors[2].iter_mut().zip(rest) {
            *sum += rest;
        }

        // Brightness from 0 to 1, without its constant offset, which has no edges.
        let mut feature = |down: &Taps, across: &Taps| {
            let row = filter.down(brightness, y, down).across(from, width, across);
            row.iter().map(|value| value / 116.0).collect()
        };
        let Flip {
            gaussian,
            edge,
            point,
            ..
        } = flip;
        self.edges = [feature(gaussian, edge), feature(edge, gaussian)];
        self.points = [feature(gaussian, point), feature(point, gaussian)];
    }
}
