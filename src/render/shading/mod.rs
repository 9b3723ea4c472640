//! Pictures whose samples are shaded one by one: lit ones, and those with outlines.

mod part;
pub(super) mod paths;
pub(crate) mod picture_sums;
mod pixel_sums;
mod sums;

use std::{
    ops::Range,
    sync::{Mutex, PoisonError},
};

use self::{
    part::HitRows, paths::PicturePaths, picture_sums::PictureSums, pixel_sums::PixelSums,
    sums::Scratch,
};
use crate::{
    accel::{
        raster::{
            first_hits::{FirstHits, Slab, Take, Work, cut},
            grouping::TILE,
        },
        shadow::{Shadows, casters::Toward},
    },
    diagnostic::error::Error,
    film::{
        Centers, Film, Outlines,
        crop::Crop,
        samples::{SampleCount, Samples},
        size::Size,
    },
    image_file::check_memory,
    integrator::{Integrator, direct::Queries, path::PathTracer},
    parallel::Cancel,
    render::{
        hits::{Hits, Rays},
        outlines::OutlineMask,
    },
    simd::isa::Isa,
    tracer::{camera::Camera, tone::Tone, world::World},
};

/// The number of samples whose hits are in memory at once, for each thread. Tests use less.
const CHUNK: u64 = if cfg!(test) { 16 } else { 1 << 15 };
/// The largest number of samples of a row of pixels that is shaded at once. Tests use less.
const LONG: u64 = if cfg!(test) { 64 } else { 1 << 20 };
/// The number of rows of pixels that a thread shades at once.
const ROWS: u32 = 4;
/// The number of such groups of rows that are shaded ahead of the consumer.
const AHEAD: usize = 64;

/// A picture whose samples are shaded one by one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shading<'a, Q> {
    pub(crate) camera: &'a Camera,
    pub(crate) world: &'a World,
    pub(crate) queries: &'a Q,
    pub(crate) size: Size,
    pub(crate) samples: Samples,
    /// The number of paths of a pixel, if it is not that of the world.
    pub(crate) paths: Option<SampleCount>,
    /// The sums of the paths that are known already.
    pub(crate) known: Option<&'a PictureSums>,
    pub(crate) outlines: Option<Outlines>,
    pub(crate) tone: Tone,
    pub(crate) isa: Isa,
}

/// What all parts of a picture share.
struct State<'a, Q> {
    integrator: Integrator<'a, Q>,
    /// The number of samples of a pixel.
    count: u32,
    /// The side of the blocks of pixels that are traced together.
    block: u32,
    /// The search for the hits of samples.
    search: &'a FirstHits<'a>,
    /// The shadows of each light, unless it casts none.
    shadows: &'a [Option<Shadows<'a>>],
    /// Memory of threads.
    scratch: Mutex<Vec<Scratch>>,
    /// Memory of hits.
    spare: Mutex<Vec<Hits>>,
}

impl<Q: Queries + Sync> Shading<'_, Q> {
    /// Shades a part of the picture and passes it on in bands, from the top.
    pub(crate) fn draw(&self, crop: Crop, work: Work, take: Take) -> Result<(), Error> {
        if let Some(outlines) = &self.outlines {
            OutlineMask::check(outlines, self.samples)?;
        }
        let integrator = work.watch.time(|| {
            let is_transparent = work.resolver.is_transparent;
            Integrator::new(self.world, self.queries, self.tone, is_transparent)
        });
        let lights = match &integrator {
            // The rays of paths are all different.
            Integrator::Path(_) => &[],
            Integrator::Flat(_) | Integrator::Direct(_) => self.world.lights(),
        };
        let shadows: Vec<_> = work.watch.time(|| {
            let world = (self.world, work.kept);
            let of = |light| Shadows::new(world, light, work.builder(self.isa));
            let lights = lights.iter().enumerate();
            let lights = lights.map(|(number, light)| Some((number, Toward::of(light)?)));
            lights.map(|light| light.map(of)).collect()
        });
        let count = match &integrator {
            Integrator::Path(paths) => {
                if self.known.is_none() {
                    work.watch.time(|| self.queries.prepare());
                }
                self.count(paths)
            }
            Integrator::Flat(_) | Integrator::Direct(_) => self.samples.count(),
        };
        let block = match &integrator {
            Integrator::Path(paths) => self.paths(paths, false, work.cancel).block_side(),
            Integrator::Flat(_) | Integrator::Direct(_) => 1,
        };
        let state = State {
            integrator,
            count,
            block,
            search: &self.search(self.samples),
            shadows: &shadows,
            scratch: Mutex::default(),
            spare: Mutex::default(),
        };
        let side = u64::from(self.samples.side());
        let chunk = CHUNK * work.pool.threads() as u64;
        let in_row = crop.columns().len() as u64 * side * side;
        let (upper, rows) = self.split_at_block(crop.rows(), block);
        let parts = [upper, rows].into_iter().filter(|rows| !rows.is_empty());
        if in_row <= LONG {
            // Hits are searched in tiles, and whole ones if memory allows.
            let tile = u64::from(TILE.div_ceil(side as u32));
            let rows = match (chunk / in_row).max(1) {
                rows if rows < tile && in_row * tile > LONG => rows,
                rows => rows.next_multiple_of(tile),
            };
            let chunk = rows.next_multiple_of(block.into());
            let chunk = chunk.min(crop.rows().len() as u64) as u32;
            return parts.into_iter().try_for_each(|rows| {
                self.draw_slab(crop.columns(), (rows, chunk), &state, work, take)
            });
        }
        let columns = (LONG / (side * side)).max(1) as u32;
        let columns = columns.next_multiple_of(block);
        parts
            .flat_map(|rows| cut(rows, block))
            .try_for_each(|rows| {
                let mut film = Film::default();
                cut(crop.columns(), columns).try_for_each(|columns| {
                    let part = (columns, rows.clone());
                    self.draw_rows(part, None, &state, work, &mut |part| {
                        film.extend(part);
                        Ok(())
                    })
                })?;
                take(film)
            })
    }

    /// Adds samples to the sums of a part of the picture in rounds: as many as `next` returns for the sums so
    /// far, until it returns none. Without sums, begins with no samples.
    pub(crate) fn add_rounds(
        &self,
        crop: Crop,
        work: Work,
        sums: Option<PictureSums>,
        mut next: impl FnMut(&PictureSums) -> Result<Option<u32>, Error>,
    ) -> Result<PictureSums, Error> {
        let is_transparent = work.resolver.is_transparent;
        let integrator = Integrator::new(self.world, self.queries, self.tone, is_transparent);
        let Integrator::Path(paths) = &integrator else {
            let message = "only light that follows paths has samples to which others are added";
            return Err(Error::refused(message));
        };
        let mut paths = self.paths(paths, true, work.cancel);
        let area = paths.blocks_of(&(crop.columns(), crop.rows()));
        let mut sums = match sums {
            Some(sums) => sums,
            None => PictureSums::new(area, self.size)?,
        };
        let (most, mut reached) = (u64::from(paths.count), sums.samples());
        while let Some(count) = next(&sums)? {
            work.watch.time(|| self.queries.prepare());
            paths.count = count;
            let columns = sums.columns().clone();
            let parts = sums.parts(|row| paths.end_of_blocks(row));
            let add = |(rows, pixels): (Range<u32>, &mut [PixelSums])| {
                // What is cancelled meanwhile is dropped.
                let _ = work.watch.time(|| paths.add_rows(&columns, &rows, pixels));
                if let Some(progress) = work.progress {
                    let at = |samples: u32| pixels.len() as u64 * u64::from(samples) / most;
                    progress.add(at(count).saturating_sub(at(reached)));
                }
            };
            let check = |()| work.cancel.check();
            work.pool.in_order(parts, AHEAD, add, check)?;
            reached = count;
        }
        Ok(sums)
    }

    /// Returns the number of paths of a pixel.
    fn count(&self, paths: &PathTracer<Q>) -> u32 {
        self.paths.map_or(paths.samples(), SampleCount::count)
    }

    /// Returns the paths of the picture.
    fn paths<'p>(
        &'p self,
        paths: &'p PathTracer<'p, Q>,
        has_albedo: bool,
        cancel: &'p Cancel,
    ) -> PicturePaths<'p, Q> {
        PicturePaths {
            paths,
            camera: self.camera,
            size: self.size,
            exposure: self.tone.factor(),
            count: self.count(paths),
            has_albedo,
            cancel,
        }
    }

    /// Returns rows up to where a block of pixels ends, and all others.
    fn split_at_block(&self, rows: Range<u32>, block: u32) -> (Range<u32>, Range<u32>) {
        let upper = (self.size.height() - rows.start) % block;
        let end = (rows.start + upper).min(rows.end);
        (rows.start..end, end..rows.end)
    }

    /// Shades rows whose hits are searched together if memory allows, in chunks.
    fn draw_slab(
        &self,
        columns: Range<u32>,
        (rows, chunk): (Range<u32>, u32),
        state: &State<Q>,
        work: Work,
        take: Take,
    ) -> Result<(), Error> {
        let [fine_columns, fine_rows] = self.samples_around(&columns, &rows);
        let slab = state.search.prepare_rows(fine_columns, fine_rows, work);
        if slab.is_none() && rows.len() as u32 > chunk {
            let middle = rows.start + (rows.len() as u32 / 2).next_multiple_of(chunk);
            let upper = (rows.start..middle, chunk);
            self.draw_slab(columns.clone(), upper, state, work, take)?;
            return self.draw_slab(columns, (middle..rows.end, chunk), state, work, take);
        }
        cut(rows, chunk).try_for_each(|rows| {
            self.draw_rows((columns.clone(), rows), slab.as_ref(), state, work, take)
        })
    }

    /// Returns the columns and rows of the samples of some pixels and of those around them that
    /// their outlines depend on.
    fn samples_around(&self, columns: &Range<u32>, rows: &Range<u32>) -> [Range<u32>; 2] {
        let side = self.samples.side();
        let margin = self.outlines.map_or(0, |outlines| outlines.margin());
        let around = |range: &Range<u32>, most: u32| {
            let end = range.end.saturating_add(margin).min(most);
            range.start.saturating_sub(margin) * side..end * side
        };
        [
            around(columns, self.size.width()),
            around(rows, self.size.height()),
        ]
    }

    fn search(&self, samples: Samples) -> FirstHits<'_> {
        FirstHits::of_samples(self.camera, self.world, self.size, samples, self.isa)
    }

    /// Shades rows, which may be a part of a slab, at once.
    fn draw_rows(
        &self,
        (columns, rows): (Range<u32>, Range<u32>),
        slab: Option<&Slab>,
        state: &State<Q>,
        work: Work,
        take: Take,
    ) -> Result<(), Error> {
        let spare = || {
            let spare = &state.spare;
            spare.lock().unwrap_or_else(PoisonError::into_inner)
        };
        let memory = || spare().pop().unwrap_or_default();
        let [fine_columns, fine_rows] = self.samples_around(&columns, &rows);
        let fine = (fine_columns, fine_rows);
        if let Some(outlines) = &self.outlines {
            // Wide lines of many samples depend on very many others.
            let samples = fine.0.len() as u64 * fine.1.len() as u64;
            let bytes = OutlineMask::bytes(outlines, samples, self.samples.side());
            check_memory(self.size, bytes)?;
        }
        let hits = Hits::new(state.search, slab, fine, work, memory())?;
        let needs_centers = work.centers != Centers::Unneeded && self.samples != Samples::ONE;
        let centers = needs_centers
            .then(|| {
                let (search, all) = (self.search(Samples::ONE), (columns.clone(), rows.clone()));
                Hits::new(&search, None, all, work, memory())
            })
            .transpose()?;
        let rays = Rays::new(
            self.camera,
            self.size,
            self.samples,
            [&hits.columns, &hits.rows],
        );
        let mask = self.outlines.map(|outlines| {
            work.watch
                .time(|| OutlineMask::new(outlines, self.world, &hits, &rays, self.samples.side()))
        });
        let mut shadows = state.shadows.iter().flatten().peekable();
        if shadows.peek().is_some() {
            let (eye, distance) = rays.reach(&hits, self.isa);
            if shadows.any(|shadows| shadows.leaves_open(eye, distance)) {
                work.watch.time(|| self.queries.prepare());
            }
        }
        let part = HitRows {
            shading: self,
            state,
            rays: &rays,
            mask,
            centers: centers.as_ref().unwrap_or(&hits),
            hits: &hits,
            columns: &columns,
            work,
        };
        let shade = |rows: Range<u32>| {
            work.cancel.check()?;
            let piece = work.watch.time(|| part.piece(rows));
            work.cancel.check()?;
            if let Some(progress) = work.progress {
                progress.add(piece.pixels() as u64);
            }
            Ok(piece)
        };
        let rows_of_piece = match state.integrator {
            Integrator::Path(_) => state.block,
            Integrator::Flat(_) | Integrator::Direct(_) => ROWS,
        };
        work.pool
            .in_order(cut(rows, rows_of_piece), AHEAD, shade, |piece| {
                let mut film = Film::default();
                film.push(piece?);
                take(film)
            })?;
        spare().extend(centers);
        spare().push(hits);
        Ok(())
    }
}
