//! The geometry that each pixel of a picture sees.

use std::{iter, mem, ops::Range};

use crate::{
    accel::{
        bvh::build::Builder,
        kept::Kept,
        raster::{
            binned::Binned,
            footprint::Region,
            grouping::TILE,
            planes::NumberedPlane,
            samples::DrawSamples,
            tile::Draw,
            view::{Grid, RasterView},
        },
    },
    diagnostic::error::Error,
    film::{Centers, Film, Piece, Wanted, resolve::Resolver, samples::Samples, size::Size},
    parallel::{Cancel, OnProgress, Pool, timings::SharedWatch},
    simd::isa::Isa,
    tracer::{camera::Camera, world::World},
};

/// Number of tiles that a thread draws per task, in one tile row and at one sample per pixel.
const STRETCH: u32 = 128;
/// Number of stretches that are drawn ahead of the consumer: 16 megabytes at one sample per pixel.
const AHEAD: usize = 128;

/// A search for the geometry that each pixel of a picture sees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FirstHits<'a> {
    view: RasterView<'a>,
    world: &'a World,
    isa: Isa,
}

/// The resources and callbacks of a search.
#[derive(Clone, Copy)]
pub(crate) struct Work<'a> {
    pub(crate) pool: &'a Pool,
    pub(crate) cancel: &'a Cancel,
    pub(crate) progress: Option<&'a OnProgress>,
    pub(crate) watch: &'a SharedWatch<'a>,
    /// What frames share; `None` for a picture alone.
    pub(crate) kept: Option<&'a Kept>,
    /// The colors of pixels whose samples see several things.
    pub(crate) resolver: Resolver<'a>,
    /// The data of center rays that the film keeps.
    pub(crate) centers: Centers,
    /// The light of shaded pixels that the film keeps.
    pub(crate) wanted: Wanted,
}

impl<'a> Work<'a> {
    /// Returns the resources for building trees.
    pub(crate) const fn builder(&self, isa: Isa) -> Builder<'a> {
        Builder {
            isa,
            pool: self.pool,
            cancel: Some(self.cancel),
        }
    }
}

/// A consumer of bands.
pub(crate) type Take<'a> = &'a mut dyn FnMut(Film) -> Result<(), Error>;

/// A region whose shapes are binned.
struct Prepared {
    bins: Binned,
    grid: Grid,
    planes: Vec<NumberedPlane>,
}

/// Rows of a rectangle of the picture that are prepared.
pub(crate) struct Slab {
    /// Regions that lie side by side.
    regions: Vec<Prepared>,
    rows: Range<u32>,
}

impl Slab {
    /// Returns the rows of the tiles that hold some rows.
    pub(crate) fn around(&self, rows: Range<u32>) -> Range<u32> {
        let place = |row: u32| row - self.rows.start;
        let start = self.rows.start + place(rows.start) / TILE * TILE;
        let end = self.rows.start + place(rows.end).next_multiple_of(TILE);
        start..end.min(self.rows.end)
    }
}

/// Divides a rectangle into regions that are narrow enough.
fn strips(columns: Range<u32>, rows: Range<u32>) -> impl Iterator<Item = Region> {
    cut(columns, Region::MAX_SIDE).map(move |columns| Region {
        column: columns.start,
        row: rows.start,
        width: columns.end - columns.start,
        height: rows.end - rows.start,
    })
}

impl<'a> FirstHits<'a> {
    pub(crate) fn new(
        camera: &'a Camera,
        world: &'a World,
        size: Size,
        samples: Samples,
        isa: Isa,
    ) -> Self {
        Self {
            view: RasterView::new(camera, size, samples),
            world,
            isa,
        }
    }

    /// Creates a search for the geometry that each sample of a picture sees: the rows and columns
    /// are those of the samples.
    pub(crate) fn of_samples(
        camera: &'a Camera,
        world: &'a World,
        size: Size,
        samples: Samples,
        isa: Isa,
    ) -> Self {
        Self {
            view: RasterView::fine(camera, size, samples),
            world,
            isa,
        }
    }

    /// Draws a rectangle of the picture and passes it on in bands of at most [`TILE`] rows, from
    /// the top. It is prepared at once if memory allows, else in parts.
    pub(crate) fn draw(
        &self,
        columns: Range<u32>,
        rows: Range<u32>,
        work: Work,
        take: Take,
    ) -> Result<(), Error> {
        work.cancel.check()?;
        if let Some(slab) = self.prepare_rows(columns.clone(), rows.clone(), work) {
            return self.draw_slab(&slab, rows, work, take);
        }
        if rows.end - rows.start > TILE {
            let middle = rows.start + ((rows.end - rows.start) / 2).next_multiple_of(TILE);
            self.draw(columns.clone(), rows.start..middle, work, take)?;
            return self.draw(columns, middle..rows.end, work, take);
        }
        let mut film = Film::default();
        for strip in strips(columns, rows) {
            self.draw_narrow(strip, work, &mut film)?;
        }
        take(film)
    }

    /// Prepares a rectangle of the picture; `None` if it is too high, or would take too much memory
    /// at once.
    pub(crate) fn prepare_rows(
        &self,
        columns: Range<u32>,
        rows: Range<u32>,
        work: Work,
    ) -> Option<Slab> {
        if rows.end - rows.start > Region::MAX_SIDE {
            return None;
        }
        let regions = strips(columns, rows.clone()).map(|strip| self.prepare(strip, work));
        let regions = regions.collect::<Option<_>>()?;
        Some(Slab { regions, rows })
    }

    /// Draws the tiles of a slab that hold some of its rows, and passes them on in bands of at most
    /// [`TILE`] rows, from the top.
    pub(crate) fn draw_slab(
        &self,
        slab: &Slab,
        rows: Range<u32>,
        work: Work,
        take: Take,
    ) -> Result<(), Error> {
        let rows = slab.around(rows);
        let rows = rows.start - slab.rows.start..rows.end - slab.rows.start;
        self.draw_prepared(&slab.regions, rows, work, take)
    }

    /// Draws a part of a band, in as many pieces as the memory limit requires.
    fn draw_narrow(&self, region: Region, work: Work, film: &mut Film) -> Result<(), Error> {
        if let Some(prepared) = self.prepare(region, work) {
            return self.draw_prepared(&[prepared], 0..region.height, work, &mut |part| {
                film.extend(part);
                Ok(())
            });
        }
        let (mut left, mut right) = (region, region);
        left.width = (region.width / 2).next_multiple_of(TILE);
        right.column += left.width;
        right.width -= left.width;
        self.draw_narrow(left, work, film)?;
        self.draw_narrow(right, work, film)
    }

    /// Bins a region; `None` if that would take too much memory at once.
    fn prepare(&self, region: Region, work: Work) -> Option<Prepared> {
        work.watch.time(|| {
            let world = (self.world, work.kept);
            let bins = Binned::new(&self.view, world, region, work.builder(self.isa))?;
            let eye = self.view.camera.eye();
            let geometries = self.world.geometries();
            let plane = |index: u32| {
                let index = index as usize;
                let id = self.world.id_of(index, 0) as u32;
                NumberedPlane::new(id, geometries.get(index)?, eye)
            };
            Some(Prepared {
                planes: bins.planes().into_iter().filter_map(plane).collect(),
                grid: self.view.grid(region),
                bins,
            })
        })
    }

    /// Returns the kernel that draws some tiles of a tile row.
    fn tiles<'b>(
        &'b self,
        prepared: &'b Prepared,
        (down, across): (u32, Range<u32>),
        rows: Vec<&'b mut [u32]>,
        t: Vec<&'b mut [f64]>,
    ) -> Draw<'b> {
        Draw {
            view: &self.view,
            world: self.world,
            planes: &prepared.planes,
            grid: &prepared.grid,
            bins: &prepared.bins,
            down,
            across,
            rows,
            t,
        }
    }

    /// Draws some rows, from the top of a tile on, of regions that lie side by side.
    fn draw_prepared(
        &self,
        regions: &[Prepared],
        rows: Range<u32>,
        work: Work,
        take: Take,
    ) -> Result<(), Error> {
        let height = regions
            .first()
            .map_or(0, |region| region.bins.region.height);
        let width: usize = regions
            .iter()
            .map(|region| region.bins.region.width as usize)
            .sum();
        let samples = self.view.samples;
        let stretch = STRETCH / samples.side();
        let ahead =
            (AHEAD * STRETCH as usize / (stretch * samples.count()) as usize).clamp(4, AHEAD);
        let stretches = rows.step_by(TILE as usize).flat_map(|top| {
            regions.iter().flat_map(move |region| {
                cut(0..region.bins.region.width, stretch * TILE)
                    .map(move |columns| (region, top, columns))
            })
        });
        let draw = |(prepared, top, columns): (&Prepared, u32, Range<u32>)| {
            work.cancel.check()?;
            let geometries = self.world.ids();
            let width = columns.end - columns.start;
            let mut piece = Piece::new(width, TILE.min(height - top), geometries);
            work.watch.time(|| {
                if columns.start == 0 {
                    prepared.bins.look_ahead(top / TILE);
                }
                let across = columns.start / TILE..columns.end.div_ceil(TILE);
                let tiles = (top / TILE, across);
                if samples != Samples::ONE {
                    let mut seen = Vec::new();
                    self.isa.run(DrawSamples {
                        draw: self.tiles(prepared, tiles.clone(), piece.rows_mut(), Vec::new()),
                        seen: &mut seen,
                    });
                    let count = samples.count() as usize;
                    // Only of the pixels that see several things.
                    let counts = iter::repeat_n(count, seen.len() / count);
                    piece.resolve(work.resolver.resolve(&seen, counts));
                }
                if samples == Samples::ONE || work.centers != Centers::Unneeded {
                    let (rows, t) = piece.hits_mut(samples == Samples::ONE, work.centers);
                    self.isa.run(self.tiles(prepared, tiles, rows, t));
                }
            });
            if let Some(progress) = work.progress {
                progress.add(piece.pixels() as u64);
            }
            Ok(piece)
        };
        let mut film = Film::default();
        work.pool.in_order(stretches, ahead, draw, |piece| {
            film.push(piece?);
            if film.width() < width {
                return Ok(());
            }
            take(mem::take(&mut film))
        })
    }
}

/// Splits a range into pieces of a length; the last may be shorter.
pub(crate) fn cut(range: Range<u32>, length: u32) -> impl Iterator<Item = Range<u32>> + Clone {
    let starts = range.clone().step_by(length as usize);
    starts.map(move |start| start..(start + length).min(range.end))
}
