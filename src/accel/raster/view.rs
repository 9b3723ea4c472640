//! The projection of a camera's picture, for finding the pixels that a shape may cover.

use std::{array, f64::consts::SQRT_2};

use glam::DVec3;

use crate::{
    accel::raster::{
        footprint::Region,
        grouping::{ACROSS, WIDE},
    },
    film::{samples::Samples, size::Size},
    tracer::camera::{
        Camera,
        orthographic::{OrthographicCamera, pixels},
        perspective::PerspectiveCamera,
    },
};

/// A camera's picture of a given size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RasterView<'a> {
    pub(super) camera: &'a Camera,
    pub(super) size: Size,
    pub(super) samples: Samples,
    /// The number of columns and rows for each of the camera's picture.
    fineness: u32,
    /// The screen; `None` if its bounds cannot be trusted because the camera's numbers are extreme.
    pub(super) screen: Option<Screen>,
}

/// What the pixels that a shape may cover depend on, beside the fineness.
pub(crate) type ViewKey = (Camera, Size, Samples, Region);

/// The position of a picture in space.
///
/// The point `eye + x·u + y·v + z·forward` is seen at pixel `middle + zoom·(x, y)`, counted from
/// the bottom left; in perspective the zoom is `distance/z`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    pub(super) eye: DVec3,
    pub(super) u: DVec3,
    pub(super) v: DVec3,
    pub(super) forward: DVec3,
    pub(super) middle: [f64; 2],
    pub(super) lens: Lens,
    /// The amount by which the square of a sphere's radius has to grow, in units of the squared
    /// lengths in the terms of its equation.
    ///
    /// A ray may hit a sphere that it should miss for two reasons. The discriminant `B² - 4AC` is a
    /// small difference of large numbers: each of its terms is near `4·|o-c|²` or `4·r²` and has at
    /// most a dozen rounding errors of 2⁻⁵³, so that it may be above 0 where the true one is below
    /// by 4·1.4e-15 of the larger. And the direction of a ray has a few rounding errors, which at
    /// the distance |o-c| move it by 1e-15·|o-c|, and that squared distance by at most 4e-15 of
    /// itself. 4e-14 covers both several times over. The deviation of the camera's unit vectors
    /// from perpendicular and from unit length is added to this.
    pub(super) inflation: f64,
    /// The largest error of the bounds on the screen, in pixels.
    pub(super) slack: f64,
    /// The largest rounding error of a ray's origin, in units of the scene.
    pub(super) blur: f64,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Lens {
    /// A picture this many pixels in front of the eye.
    Perspective { distance: f64 },
    /// Pixels per unit, to the right and upwards; the farthest origin of a ray is `reach` from the
    /// eye.
    Orthographic { zoom: [f64; 2], reach: f64 },
}

/// The largest deviation of a camera's unit vectors from perpendicular and from unit length.
const SKEW: f64 = 1e-8;
/// The bound for numbers: those above it, or below its reciprocal, overflow somewhere.
pub(super) const HUGE: f64 = 1e100;

impl<'a> RasterView<'a> {
    pub(crate) fn new(camera: &'a Camera, size: Size, samples: Samples) -> Self {
        let mut screen = Screen::new(camera, size);
        if let Some(screen) = &mut screen
            && samples != Samples::ONE
        {
            // The bounds include a pixel's samples, which lie up to half a pixel from its center.
            screen.slack += 0.5;
        }
        Self {
            camera,
            size,
            samples,
            fineness: 1,
            screen,
        }
    }

    /// Creates a view whose columns and rows are those of the samples of a camera's picture.
    pub(crate) fn fine(camera: &'a Camera, size: Size, samples: Samples) -> Self {
        let mut view = Self::new(camera, size, Samples::ONE);
        view.fineness = samples.side();
        if let Some(screen) = &mut view.screen {
            screen.refine(f64::from(samples.side()));
        }
        view
    }

    /// Returns the fineness of the view and the key of a region.
    pub(super) fn key(&self, region: Region) -> (u32, ViewKey) {
        let Self { size, samples, .. } = *self;
        (self.fineness, (*self.camera, size, samples, region))
    }

    /// Returns the shared part of a column's rays, `x` counted from the left.
    pub(super) fn column(&self, x: f64) -> DVec3 {
        let (width, height) = (self.size.width(), self.size.height());
        self.camera.column(width, height, self.place(x))
    }

    /// Returns the shared part of a row's rays, `y` counted from the bottom.
    pub(super) fn row(&self, y: f64) -> DVec3 {
        self.camera.row(self.size.height(), self.place(y))
    }

    /// Returns the place of a column or row in the camera's picture, in pixels.
    fn place(&self, x: f64) -> f64 {
        if self.fineness == 1 {
            return x;
        }
        let side = f64::from(self.fineness);
        let i = x % side;
        // As in [`Samples::offsets`].
        (x - i) / side + (i + 0.5) / side - 0.5
    }

    /// Returns the y of a row counted from the top.
    pub(super) fn y(&self, row: u32) -> f64 {
        f64::from(self.size.height()) * f64::from(self.fineness) - 1.0 - f64::from(row)
    }

    /// Returns the largest distance of a sample's ray from the ray through the center of its pixel:
    /// the sine of the angle between them or, if they are parallel, in units of the scene. Infinite
    /// if no bound is known.
    pub(super) fn spread(&self) -> f64 {
        // Of n samples per side, the outermost are (n-1)/(2n) pixels from the center.
        let side = f64::from(self.samples.side());
        let half = (side - 1.0) / (2.0 * side) + 1e-6;
        match self.screen.map(|screen| (screen.lens, screen.blur)) {
            Some((Lens::Perspective { distance }, _)) if distance > 8.0 => {
                let diagonal = half * SQRT_2;
                diagonal / (distance - diagonal)
            }
            Some((Lens::Orthographic { zoom: [x, y], .. }, blur)) => {
                let (across, along) = (x.recip(), y.recip());
                half * (across * across + along * along).sqrt() + 2.0 * blur
            }
            _ => f64::INFINITY,
        }
    }

    /// Returns the distance of the farthest ray origin from the eye.
    pub(super) fn reach(&self) -> f64 {
        match self.screen.map(|screen| screen.lens) {
            Some(Lens::Orthographic { reach, .. }) => reach,
            _ => 0.0,
        }
    }

    /// Returns the columns and rows that add up to the rays of a region.
    pub(super) fn grid(&self, region: Region) -> Grid {
        let columns = region.column..region.column + region.width;
        let rows = region.row..region.row + region.height;
        let wide = columns.len().div_ceil(WIDE).next_multiple_of(ACROSS);
        let group = |group: usize| {
            let first = region.column + (group * WIDE) as u32;
            let columns: [DVec3; WIDE] =
                array::from_fn(|column| self.column((first + column as u32).into()));
            [
                columns.map(|c| c.x),
                columns.map(|c| c.y),
                columns.map(|c| c.z),
            ]
        };
        let centers = rows.clone().map(|row| self.row(self.y(row))).collect();
        // A single sample needs only the center.
        let (columns, rows) = match self.samples.count() {
            1 => (0..0, 0..0),
            _ => (columns, rows),
        };
        Grid {
            columns: (0..wide).map(group).collect(),
            rows: centers,
            side: self.samples.side() as usize,
            sample_columns: axes(
                columns
                    .flat_map(|x| self.samples.offsets(x.into()))
                    .map(|x| self.column(x)),
            ),
            sample_rows: axes(
                rows.flat_map(|row| self.samples.offsets(self.y(row)))
                    .map(|y| self.row(y)),
            ),
        }
    }
}

/// The rays of a region: `column + row` is a direction of any length in perspective, otherwise an
/// origin.
#[derive(Debug)]
pub(super) struct Grid {
    /// x, y and z of the columns, by groups of pixels; the last groups may lie outside of the
    /// region.
    pub(super) columns: Vec<[[f64; WIDE]; 3]>,
    /// The rows, from the top.
    pub(super) rows: Vec<DVec3>,
    /// Number of samples per side of a pixel.
    side: usize,
    /// The columns of samples, pixel by pixel from the left.
    sample_columns: [Vec<f64>; 3],
    /// The rows of samples from the top, those of a pixel from the bottom.
    sample_rows: [Vec<f64>; 3],
}

impl Grid {
    /// Returns a column, counted from the left of the region.
    pub(super) fn column(&self, column: usize) -> DVec3 {
        let ([x, y, z], column) = (&self.columns[column / WIDE], column % WIDE);
        DVec3::new(x[column], y[column], z[column])
    }
}

impl Grid {
    /// Writes to `points` the sums for the samples of a pixel, counted from the top left of the
    /// region: axis by axis, in rows from the bottom.
    pub(super) fn points_of(&self, column: usize, row: usize, points: &mut [Vec<f64>; 3]) {
        for (axis, points) in points.iter_mut().enumerate() {
            let columns = &self.sample_columns[axis][column * self.side..][..self.side];
            let rows = &self.sample_rows[axis][row * self.side..][..self.side];
            points.clear();
            for row in rows {
                points.extend(columns.iter().map(|column| column + row));
            }
        }
    }
}

/// Returns the coordinates of vectors, separated by axis.
fn axes(vectors: impl Iterator<Item = DVec3>) -> [Vec<f64>; 3] {
    let mut axes = [const { Vec::new() }; 3];
    for vector in vectors {
        for (axis, x) in axes.iter_mut().zip(vector.to_array()) {
            axis.push(x);
        }
    }
    axes
}

impl Screen {
    /// Splits each pixel into `side` times `side` pixels.
    fn refine(&mut self, side: f64) {
        self.middle = self.middle.map(|middle| (middle + 0.5) * side - 0.5);
        self.slack *= side;
        match &mut self.lens {
            Lens::Perspective { distance } => *distance *= side,
            Lens::Orthographic { zoom, .. } => *zoom = zoom.map(|zoom| zoom * side),
        }
    }

    /// Returns the distance of a point from the origins of the rays, at most.
    pub(super) fn away(&self, point: DVec3) -> f64 {
        let reach = match self.lens {
            Lens::Perspective { .. } => 0.0,
            Lens::Orthographic { reach, .. } => reach,
        };
        (point - self.eye).length() + reach
    }

    fn new(camera: &Camera, size: Size) -> Option<Self> {
        let (u, v, w) = (camera.u(), camera.v(), camera.w());
        let skew = [
            u.dot(u) - 1.0,
            v.dot(v) - 1.0,
            w.dot(w) - 1.0,
            u.dot(v),
            u.dot(w),
            v.dot(w),
        ];
        let skew = skew.into_iter().map(f64::abs).fold(0.0, f64::max);
        let eye = camera.eye();
        let middle = [size.width(), size.height()].map(|side| (f64::from(side) - 1.0) / 2.0);
        let (lens, slack, blur) = match camera {
            Camera::Perspective(camera) => perspective(camera, size, middle)?,
            Camera::Orthographic(camera) => orthographic(camera, size, middle)?,
        };
        let sane = skew <= SKEW && eye.abs().max_element() < HUGE;
        sane.then_some(Self {
            eye,
            u,
            v,
            forward: -w,
            middle,
            lens,
            inflation: 4e-14 + 16.0 * skew,
            slack,
            blur,
        })
    }
}

fn perspective(
    camera: &PerspectiveCamera,
    size: Size,
    middle: [f64; 2],
) -> Option<(Lens, f64, f64)> {
    let distance = camera.distance(size.height());
    // Samples lie up to half a pixel outside of the outermost centers.
    let side = middle[0].max(middle[1]) + 0.5;
    // The direction of a tangent is accurate to 1e-12 radians, which at the slope s is 1e-12·(1 +
    // s²) of the distance.
    let slack = 1e-3 + 1e-12 * (distance + side * side / distance);
    let sane = 1e-12 < distance && distance < 1e12;
    sane.then_some((Lens::Perspective { distance }, slack, 0.0))
}

fn orthographic(
    camera: &OrthographicCamera,
    size: Size,
    middle: [f64; 2],
) -> Option<(Lens, f64, f64)> {
    let (width, height) = (size.width(), size.height());
    let across = [camera.pixels_across(width, height), pixels(height)];
    let zoom = across.map(|pixels| pixels / camera.scale());
    // Samples lie up to half a pixel outside of the outermost centers.
    let reach = (middle[0] + 0.5) / zoom[0] + (middle[1] + 0.5) / zoom[1];
    let blur = 1e-15 * (camera.basis.eye.abs().element_sum() + reach);
    let sane = zoom.iter().all(|zoom| 1.0 / HUGE < *zoom && *zoom < HUGE) && reach < HUGE;
    sane.then_some((Lens::Orthographic { zoom, reach }, 1e-3, blur))
}
