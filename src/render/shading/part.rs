//! Rows of a picture whose hits are known.

use std::{mem, ops::Range, sync::PoisonError};

use super::{
    Shading, State,
    sums::{Scratch, Sums},
};
use crate::{
    accel::raster::first_hits::Work,
    film::{
        Centers, Lit, LitPixel, Piece, Wanted, colors::NOTHING, parts::LightParts, samples::Samples,
    },
    integrator::{
        Integrate, Integrator,
        batch::{Encode, HitRow, SampleRow, ShadeRow},
        direct::{Queries, Shaded},
        queue::{Lanes, Seen},
    },
    render::{
        hits::{Hits, Rays},
        outlines::{OutlineMask, WhichNeighbor},
    },
    tracer::{
        radiance::Radiance,
        shape::face::{Crossing, FaceId},
        tone::Tone,
    },
};

/// The rows of a picture whose hits are known.
pub(super) struct HitRows<'a, Q> {
    pub(super) shading: &'a Shading<'a, Q>,
    pub(super) state: &'a State<'a>,
    pub(super) hits: &'a Hits,
    pub(super) rays: &'a Rays<'a>,
    pub(super) mask: Option<OutlineMask<'a>>,
    /// The hits of the rays through the centers of pixels.
    pub(super) centers: &'a Hits,
    pub(super) columns: &'a Range<u32>,
    pub(super) work: Work<'a>,
}

impl<Q: Queries + Sync> HitRows<'_, Q> {
    /// Shades some rows of pixels.
    pub(super) fn piece(&self, rows: Range<u32>) -> Piece {
        let geometries = self.shading.world.ids();
        let mut piece = Piece::new(self.columns.len() as u32, rows.len() as u32, geometries);
        if self.work.resolver.ranks {
            self.rank(&rows, &mut piece);
        }
        piece.light(self.light(rows.clone()));
        if self.work.centers != Centers::Unneeded {
            let (ids, t) = piece.hits_mut(self.shading.samples, self.work.centers);
            let (first, width) = (self.columns.start, self.columns.len());
            let start = |row| self.centers.place(first, row);
            for (ids, row) in ids.into_iter().zip(rows.clone()) {
                ids.copy_from_slice(&self.centers.ids[start(row)..][..width]);
            }
            for (t, row) in t.into_iter().zip(rows.clone()) {
                t.copy_from_slice(&self.centers.t[start(row)..][..width]);
            }
        }
        piece
    }

    /// Returns the light of some rows of pixels.
    fn light(&self, rows: Range<u32>) -> Lit {
        let all = || {
            let scratch = &self.state.scratch;
            scratch.lock().unwrap_or_else(PoisonError::into_inner)
        };
        let known = all().pop();
        let mut scratch = known.unwrap_or_else(|| Scratch::new(self.shading.world));
        let count = rows.len() * self.columns.len();
        let lit = match self.work.wanted {
            Wanted::Bytes(tone) => {
                let mut bytes = vec![[0; 3]; count];
                for (row, bytes) in rows.zip(bytes.chunks_mut(self.columns.len())) {
                    self.add_up(row, &mut scratch);
                    self.bytes(&mut scratch.sums, tone, bytes);
                }
                Lit::Bytes(bytes)
            }
            Wanted::Hits | Wanted::Light | Wanted::Parts => {
                let mut light = Vec::with_capacity(count);
                for row in rows {
                    self.add_up(row, &mut scratch);
                    light.extend((0..self.columns.len()).map(|at| self.pixel(&scratch.sums, at)));
                }
                Lit::Light(light)
            }
        };
        all().push(scratch);
        lit
    }

    /// Sets the geometries that the samples of each pixel see.
    fn rank(&self, rows: &Range<u32>, piece: &mut Piece) {
        let side = self.shading.samples.side();
        let first = self.shading.world.ids() as u32;
        for (pixel, number) in piece.rows_mut().into_iter().flatten().zip(first..) {
            *pixel = number;
        }
        let mut seen = Vec::new();
        for row in rows.clone() {
            for column in self.columns.clone() {
                for row in (row * side..(row + 1) * side).rev() {
                    let place = self.hits.place(column * side, row);
                    seen.extend_from_slice(&self.hits.ids[place..place + side as usize]);
                }
            }
        }
        let count = self.shading.samples.count() as usize;
        piece.resolve(self.work.resolver.resolve(&seen, count));
    }

    /// Returns a pixel from the sums of its samples.
    fn pixel(&self, sums: &Sums, place: usize) -> LitPixel {
        let count = f64::from(self.shading.samples.count());
        let hits = f64::from(sums.hits[place]);
        LitPixel {
            parts: self.mean(sums, place),
            albedo: sums
                .albedo
                .get(place)
                .map_or(Radiance::BLACK, |sum| *sum / count),
            coverage: hits / count,
            behind: self.behind(sums, place),
        }
    }

    /// Returns the part of a transparent background that shows in the hits of a pixel.
    fn behind(&self, sums: &Sums, place: usize) -> f64 {
        match sums.behind[place] {
            0.0 => 0.0,
            sum => (sum / f64::from(sums.hits[place])).min(1.0),
        }
    }

    /// Returns the mean of the samples of a pixel that show something.
    fn mean(&self, sums: &Sums, place: usize) -> LightParts {
        let shown = match self.work.resolver.is_transparent {
            true => sums.hits[place],
            false => self.shading.samples.count(),
        };
        let sum = sums.light.parts(place);
        match shown > 1 {
            true => sum.map(|sum| sum / f64::from(shown)),
            false => sum,
        }
    }

    /// Sets the bytes of a row of pixels.
    fn bytes(&self, sums: &mut Sums, tone: Tone, bytes: &mut [[u8; 3]]) {
        let is_transparent = self.work.resolver.is_transparent;
        if sums.light.others.iter().all(Vec::is_empty) && !is_transparent {
            if self.shading.samples != Samples::ONE {
                let count = f64::from(self.shading.samples.count());
                let sums = sums.light.first.iter_mut().flatten();
                sums.for_each(|sum| *sum /= count);
            }
        } else {
            for place in 0..bytes.len() {
                let light = self.mean(sums, place).sum();
                sums.light.set(place, Shaded::direct(light));
            }
        }
        let light = sums.light.first.each_ref().map(Vec::as_slice);
        self.shading.isa.run(Encode { tone, light, bytes });
    }

    /// Sums up the samples of a row of pixels.
    fn add_up(&self, row: u32, scratch: &mut Scratch) {
        let (side, width) = (self.shading.samples.side(), self.columns.len());
        scratch.sums.clear(width, self.shading.samples);
        // From the bottom, as the samples of a pixel are numbered.
        for row in (row * side..(row + 1) * side).rev() {
            self.shade(row, scratch);
            let first = self.hits.place(self.columns.start * side, row);
            let samples = first..first + width * side as usize;
            self.add(&self.hits.ids[samples.clone()], scratch);
            if self.work.wanted == Wanted::Parts {
                self.add_albedo(row, samples, &mut scratch.sums.albedo);
            }
        }
    }

    /// Adds the linear first colors of a row of samples, at these places, to the sums of its pixels.
    fn add_albedo(&self, row: u32, samples: Range<usize>, sums: &mut Vec<Radiance>) {
        let side = self.shading.samples.side() as usize;
        sums.resize(self.columns.len(), Radiance::BLACK);
        let line = (row - self.hits.rows.start) as usize;
        let left = self.columns.start as usize * side - self.hits.columns.start as usize;
        let mut samples = samples.enumerate().map(|(column, place)| {
            let geometry = self.shading.world.with_id(self.hits.ids[place] as usize);
            geometry.map_or(Radiance::BLACK, |geometry| {
                let ray = || self.rays.ray(left + column, line);
                geometry.color_at(ray, self.hits.t[place]).to_linear()
            })
        });
        for sum in sums {
            let samples = samples.by_ref().take(side);
            *sum = samples.fold(*sum, |sum, albedo| sum + albedo);
        }
    }

    /// Adds a row of samples, which hit these geometries, to the sums of its pixels.
    fn add(&self, ids: &[u32], scratch: &mut Scratch) {
        let side = self.shading.samples.side() as usize;
        let Scratch { samples, sums, .. } = scratch;
        let is_transparent = self.work.resolver.is_transparent;
        let wants_bytes = matches!(self.work.wanted, Wanted::Bytes(_));
        if is_transparent || !wants_bytes {
            for (sum, ids) in sums.hits.iter_mut().zip(ids.chunks_exact(side)) {
                *sum += ids.iter().map(|id| u32::from(*id != NOTHING)).sum::<u32>();
            }
        }
        if is_transparent {
            for (place, _) in ids.iter().enumerate().filter(|(_, id)| **id == NOTHING) {
                samples.set(place, Shaded::default());
            }
            for (sum, behind) in sums.behind.iter_mut().zip(samples.behind.chunks(side)) {
                *sum = behind.iter().fold(*sum, |sum, behind| sum + behind);
            }
        }
        if side == 1 {
            // The only samples are the sums.
            mem::swap(&mut sums.light.first, &mut samples.first);
        } else {
            for (sums, samples) in sums.light.first.iter_mut().zip(&samples.first) {
                match side {
                    2 => add_rows(sums, samples.as_chunks::<2>().0),
                    3 => add_rows(sums, samples.as_chunks::<3>().0),
                    4 => add_rows(sums, samples.as_chunks::<4>().0),
                    _ => add_rows(sums, samples.chunks_exact(side)),
                }
            }
        }
        for (sums_of_part, samples) in sums.light.others.iter_mut().zip(&samples.others) {
            if samples.is_empty() {
                continue;
            }
            sums_of_part.resize(sums.hits.len(), Radiance::BLACK);
            for (sum, samples) in sums_of_part.iter_mut().zip(samples.chunks_exact(side)) {
                *sum = samples.iter().fold(*sum, |sum, sample| sum + *sample);
            }
        }
    }

    /// Finds the light of a row of samples.
    fn shade(&self, row: u32, scratch: &mut Scratch) {
        let Scratch {
            known,
            others,
            queue,
            samples,
            lines,
            ..
        } = scratch;
        let shading = self.shading;
        let world = shading.world;
        let side = shading.samples.side();
        let columns = self.columns.start * side..self.columns.end * side;
        let first = self.hits.place(columns.start, row);
        let left = (columns.start - self.hits.columns.start) as usize;
        let line = (row - self.hits.rows.start) as usize;
        samples.begin(columns.len());
        others.clear();
        let [r, g, b] = &mut samples.first;
        shading.isa.run(ShadeRow {
            world,
            shadows: self.state.shadows,
            queries: shading.queries,
            row: HitRow::Samples(row_of(
                self.hits,
                self.rays,
                line,
                left..left + columns.len(),
            )),
            known,
            light: [r, g, b],
            others,
        });
        let integrator = Integrator::new(
            world,
            shading.queries,
            shading.tone,
            self.work.resolver.is_transparent,
        );
        let seen = others.each().map(|(place, shadows)| {
            let ray = self.rays.ray(left + place, line);
            let (id, t) = (self.hits.ids[first + place], self.hits.t[first + place]);
            let geometry = world.index_of(id as usize);
            let Crossing { t, face } = world.geometries()[geometry].crossing_at(&ray, t);
            let id = FaceId { geometry, face };
            Seen {
                place,
                ray,
                t,
                id,
                shadows,
            }
        });
        let lanes = Lanes {
            isa: shading.isa,
            shadows: self.state.shadows,
            known,
        };
        integrator.shade(seen, (queue, lanes), |place, shaded| {
            samples.set(place, shaded)
        });
        if let Some(mask) = &self.mask {
            // What is cancelled meanwhile is dropped.
            mask.find(row, columns, WhichNeighbor::Any, self.work.cancel, lines);
            let found = lines.found.iter().enumerate();
            for (place, _) in found.filter(|(_, found)| found.is_some()) {
                samples.set(place, Shaded::direct(mask.color()));
            }
        }
    }
}

/// Adds the samples of each pixel to its sum, one after the other.
#[inline(always)]
fn add_rows(sums: &mut [f64], samples: impl IntoIterator<Item: AsRef<[f64]>>) {
    for (sum, samples) in sums.iter_mut().zip(samples) {
        *sum = samples
            .as_ref()
            .iter()
            .fold(*sum, |sum, sample| sum + sample);
    }
}

/// Returns a part of a row of samples.
fn row_of<'a>(hits: &'a Hits, rays: &'a Rays, row: usize, columns: Range<usize>) -> SampleRow<'a> {
    let first = row * hits.columns.len();
    let places = first + columns.start..first + columns.end;
    let [x, y, z] = &rays.columns;
    SampleRow {
        camera: rays.camera,
        columns: [x, y, z].map(|axis| &axis[columns.clone()]),
        row: rays.rows[row],
        ids: &hits.ids[places.clone()],
        t: &hits.t[places],
    }
}
