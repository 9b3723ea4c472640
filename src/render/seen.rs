//! What a picture shows of each geometry: how many pixels, where, and how far away.

use std::ops::Range;

use crate::{
    film::{Film, colors::NOTHING, crop::Crop, size::Size},
    parallel::Pool,
    tracer::{camera::Camera, world::World},
};

/// What a picture shows of one geometry, by the rays through the centers of its pixels.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Seen {
    /// The index of the geometry in the world: its number in the layer of ids.
    pub id: usize,
    /// In how many pixels it is seen.
    pub pixels: u64,
    /// The least rectangle with all of them, in pixels from the top left of the whole picture: its
    /// first column and row, its width and height.
    pub bounds: [u32; 4],
    /// The smallest distance along a ray at which it is seen.
    pub nearest: f64,
    /// The largest one.
    pub farthest: f64,
}

impl Seen {
    /// Adds what is seen of the same geometry elsewhere.
    fn merge(&mut self, other: &Self) {
        let ([x, y, width, height], [left, top, across, down]) = (self.bounds, other.bounds);
        let (right, bottom) = ((x + width).max(left + across), (y + height).max(top + down));
        let (left, top) = (x.min(left), y.min(top));
        self.pixels += other.pixels;
        self.bounds = [left, top, right - left, bottom - top];
        self.nearest = self.nearest.min(other.nearest);
        self.farthest = self.farthest.max(other.farthest);
    }
}

/// Sums up what the bands of a picture show, which come from the top.
#[derive(Clone, Debug)]
pub(crate) struct Tally<'a> {
    camera: &'a Camera,
    world: &'a World,
    size: Size,
    /// The column of the picture that bands begin in.
    left: u32,
    /// The row of the picture that the next band begins in.
    top: u32,
    /// For each geometry its place in `seen`, or [`NOTHING`].
    places: Vec<u32>,
    seen: Vec<Seen>,
}

impl<'a> Tally<'a> {
    /// Of a part of a picture of a size.
    pub(crate) fn new(camera: &'a Camera, world: &'a World, size: Size, crop: Crop) -> Self {
        Self {
            camera,
            world,
            size,
            left: crop.column(),
            top: crop.row(),
            places: vec![NOTHING; world.geometries().len()],
            seen: Vec::new(),
        }
    }

    /// Adds a band.
    pub(crate) fn add(&mut self, film: &Film, pool: &Pool) {
        let rows = pool.map(0..film.height(), |row| self.row(film, row));
        rows.iter().flatten().for_each(|seen| self.merge(seen));
        self.top += film.height() as u32;
    }

    /// What is seen in a row of a band, run by run of the same geometry.
    fn row(&self, film: &Film, row: usize) -> Vec<Seen> {
        let mut column = self.left;
        let mut runs = Vec::new();
        for (piece, indices) in film.row(row) {
            for same in indices.chunk_by(|one, other| one == other) {
                let columns = column..column + same.len() as u32;
                column = columns.end;
                let center = same.first().map_or(NOTHING, |index| piece.center(*index));
                runs.extend(self.run(center, columns, self.top + row as u32));
            }
        }
        runs
    }

    /// What is seen of a geometry in some columns of a row that show nothing else.
    fn run(&self, index: u32, columns: Range<u32>, row: u32) -> Option<Seen> {
        let shape = self.world.geometries().get(index as usize)?.shape();
        let (width, height) = (self.size.width(), self.size.height());
        let y = f64::from(height) - 1.0 - f64::from(row);
        let ray = |column: u32| self.camera.ray_for(width, height, column.into(), y);
        let depths = columns
            .clone()
            .filter_map(|column| shape.intersect(&ray(column), f64::INFINITY));
        let (nearest, farthest) = depths
            .fold((f64::INFINITY, 0.0_f64), |(nearest, farthest), t| {
                (nearest.min(t), farthest.max(t))
            });
        Some(Seen {
            id: index as usize,
            pixels: columns.len() as u64,
            bounds: [columns.start, row, columns.len() as u32, 1],
            nearest,
            farthest,
        })
    }

    fn merge(&mut self, seen: &Seen) {
        let Some(place) = self.places.get_mut(seen.id) else {
            return;
        };
        match self.seen.get_mut(*place as usize) {
            Some(known) => known.merge(seen),
            None => {
                *place = self.seen.len() as u32;
                self.seen.push(seen.clone());
            }
        }
    }

    /// All geometries that are seen, in the order of the world.
    pub(crate) fn finish(mut self) -> Vec<Seen> {
        self.seen.sort_unstable_by_key(|seen| seen.id);
        self.seen
    }
}
