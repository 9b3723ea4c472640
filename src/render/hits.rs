//! The hits of the camera's rays in a part of a picture, sample by sample.

use std::ops::Range;

use glam::DVec3;

use crate::{
    accel::raster::first_hits::{FirstHits, Slab, Work},
    diagnostic::error::Error,
    film::{Centers, Film, samples::Samples, size::Size},
    simd::{F64x8, Kernel, LANES, Simd, isa::Isa},
    tracer::{camera::Camera, ray::Ray},
};

/// The hits of the camera's rays in a rectangle of samples.
#[derive(Default)]
pub(super) struct Hits {
    /// The columns and rows of the rectangle, counted from the top left of the picture.
    pub(super) columns: Range<u32>,
    pub(super) rows: Range<u32>,
    pub(super) ids: Vec<u32>,
    pub(super) t: Vec<f64>,
}

impl Hits {
    /// Searches the hits in a rectangle, which may be a part of a slab, in the memory of others.
    pub(super) fn new(
        search: &FirstHits,
        slab: Option<&Slab>,
        (columns, rows): (Range<u32>, Range<u32>),
        work: Work,
        others: Self,
    ) -> Result<Self, Error> {
        let Self { mut ids, mut t, .. } = others;
        ids.clear();
        t.clear();
        let count = columns.len() * rows.len();
        ids.reserve_exact(count);
        t.reserve_exact(count);
        let work = Work {
            centers: Centers::Hits,
            progress: None,
            ..work
        };
        let drawn = slab.map_or(rows.clone(), |slab| slab.around(rows.clone()));
        let mut next = drawn.start;
        let mut take = |film: Film| {
            for (line, row) in (next..).enumerate().take(film.height()) {
                next += 1;
                for run in film.row(line).filter(|_| rows.contains(&row)) {
                    ids.extend_from_slice(run.ids);
                    t.extend_from_slice(run.t);
                }
            }
            Ok(())
        };
        match slab {
            Some(slab) => search.draw_slab(slab, drawn, work, &mut take)?,
            None => search.draw(columns.clone(), drawn, work, &mut take)?,
        }
        Ok(Self {
            columns,
            rows,
            ids,
            t,
        })
    }

    /// Returns the place of a sample in the planes.
    pub(super) fn place(&self, column: u32, row: u32) -> usize {
        let (column, row) = (column - self.columns.start, row - self.rows.start);
        row as usize * self.columns.len() + column as usize
    }

    /// Returns a value for each sample, in the order of the planes, from its ray, the geometry that
    /// it hits, and the t of the hit.
    pub(super) fn map<T>(&self, rays: &Rays, value: impl Fn(Ray, u32, f64) -> T) -> Vec<T> {
        let places = (0..self.rows.len())
            .flat_map(|row| (0..self.columns.len()).map(move |column| (column, row)));
        let hits = self.ids.iter().zip(&self.t);
        let mut values = Vec::with_capacity(self.ids.len());
        values.extend(
            places
                .zip(hits)
                .map(|((column, row), (id, t))| value(rays.ray(column, row), *id, *t)),
        );
        values
    }
}

/// The rays of a rectangle of samples, as columns and rows that add up to them.
pub(crate) struct Rays<'a> {
    pub(super) camera: &'a Camera,
    /// The parts that columns share, by axis.
    pub(super) columns: [Vec<f64>; 3],
    /// The parts that rows share.
    pub(super) rows: Vec<DVec3>,
}

impl<'a> Rays<'a> {
    /// Creates the rays of the samples in these columns and rows of samples, of a picture of this size.
    pub(crate) fn new(
        camera: &'a Camera,
        size: Size,
        samples: Samples,
        [columns, rows]: [&Range<u32>; 2],
    ) -> Self {
        let (width, height) = (size.width(), size.height());
        let side = samples.side();
        let pixels = |range: &Range<u32>| range.start / side..range.end / side;
        let mut shared = [const { Vec::new() }; 3];
        for x in pixels(columns).flat_map(|column| samples.offsets(column.into())) {
            let column = camera.column(width, height, x);
            for (axis, column) in shared.iter_mut().zip(column.to_array()) {
                axis.push(column);
            }
        }
        let rows = pixels(rows).flat_map(|row| {
            let offsets: Vec<_> = samples.offsets(f64::from(height - 1 - row)).collect();
            offsets.into_iter().rev()
        });
        Self {
            camera,
            columns: shared,
            rows: rows.map(|y| camera.row(height, y)).collect(),
        }
    }

    /// Returns a point, and a distance from it that no hit exceeds.
    pub(super) fn reach(&self, hits: &Hits, isa: Isa) -> (DVec3, f64) {
        let farthest = isa.run(Farthest(&hits.t));
        let eye = self.ray(0, 0).origin();
        let (right, bottom) = (hits.columns.len() - 1, hits.rows.len() - 1);
        let corners = [(right, 0), (0, bottom), (right, bottom)];
        let apart = corners.map(|(column, row)| (self.ray(column, row).origin() - eye).length());
        (eye, apart.into_iter().fold(0.0, f64::max) + farthest)
    }

    /// Returns the ray of a sample, counted from the top left of the rectangle.
    pub(super) fn ray(&self, column: usize, row: usize) -> Ray {
        let [x, y, z] = &self.columns;
        let column = DVec3::new(x[column], y[column], z[column]);
        self.camera.ray_of(column + self.rows[row])
    }
}

/// The kernel that finds the largest finite t of hits.
struct Farthest<'a>(&'a [f64]);

impl Kernel for Farthest<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> f64 {
        let (mut most, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
        let (eights, rest) = self.0.as_chunks();
        for t in eights {
            let t = simd.load(t);
            most = S::F64::select(t.lt(infinity), most.max(t), most);
        }
        let mut lanes = [0.0; LANES];
        most.store(&mut lanes);
        let finite = rest.iter().filter(|t| **t < f64::INFINITY);
        let all = lanes.iter().chain(finite);
        all.fold(0.0, |most, t| t.max(most))
    }
}
