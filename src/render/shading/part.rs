//! Rows of a picture whose hits are known.

use std::{iter, mem, ops::Range, sync::PoisonError};

use super::{
    Shading, State,
    pixel_sums::PixelSums,
    sums::{RowLight, Scratch, Sums},
};
use crate::{
    accel::raster::first_hits::Work,
    film::{Centers, Lit, Piece, Wanted, colors::NOTHING, light::LightPlanes},
    integrator::{
        Integrate, Integrator,
        batch::{HitRow, SampleRow, ShadeRow},
        direct::{Queries, Shaded},
        encode::Encode,
        queue::{Lanes, Seen},
    },
    render::{
        hits::{Hits, Rays},
        outlines::{OutlineMask, WhichNeighbor},
    },
    tracer::{
        geometry::Geometry,
        radiance::Radiance,
        shape::face::{Crossing, FaceId},
        tone::Tone,
    },
};

/// The rows of a picture whose hits are known.
pub(super) struct HitRows<'a, Q> {
    pub(super) shading: &'a Shading<'a, Q>,
    pub(super) state: &'a State<'a, Q>,
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
        let needs_ranks = self.work.resolver.ranks;
        let mut seen = Vec::new();
        // With one sample, the hit of the center is all that a pixel sees.
        let only_centers = match &self.state.integrator {
            Integrator::Path(paths) => {
                let area = (self.columns.clone(), rows.clone());
                let known = self.shading.known;
                let Some(traced) = self.paths(paths).trace(&area, known) else {
                    return piece;
                };
                piece.light(self.light(rows.clone(), &traced));
                if needs_ranks {
                    self.see_by_paths(paths, &rows, &traced, &mut seen);
                    let counts = traced.iter().map(|sums| sums.count as usize);
                    self.rank(&seen, counts, &mut piece);
                }
                false
            }
            Integrator::Flat(_) | Integrator::Direct(_) => {
                piece.light(self.light(rows.clone(), &[]));
                if needs_ranks && self.state.count != 1 {
                    self.see(&rows, &mut seen);
                    let counts = iter::repeat_n(self.state.count as usize, piece.pixels());
                    self.rank(&seen, counts, &mut piece);
                }
                self.state.count == 1
            }
        };
        if self.work.centers != Centers::Unneeded {
            let (ids, t) = piece.hits_mut(only_centers, self.work.centers);
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

    /// Returns the light of some rows of pixels, of which these are the sums if light follows paths.
    fn light(&self, rows: Range<u32>, traced: &[PixelSums]) -> Lit {
        let all = || {
            let scratch = &self.state.scratch;
            scratch.lock().unwrap_or_else(PoisonError::into_inner)
        };
        let known = all().pop();
        let mut scratch = known.unwrap_or_else(|| Scratch::new(self.shading.world));
        let mut traced = traced.chunks(self.columns.len());
        let mut add_up = |row, scratch: &mut Scratch| {
            self.add_up(row, traced.next().unwrap_or_default(), scratch);
        };
        let lit = match self.work.wanted {
            Wanted::Bytes(tone) => {
                let mut bytes = vec![[0; 3]; rows.len() * self.columns.len()];
                for (row, bytes) in rows.zip(bytes.chunks_mut(self.columns.len())) {
                    add_up(row, &mut scratch);
                    self.bytes(&mut scratch.sums, tone, bytes);
                }
                Lit::Bytes(bytes)
            }
            Wanted::Hits | Wanted::Light | Wanted::Parts => {
                let mut light = LightPlanes::default();
                for row in rows {
                    add_up(row, &mut scratch);
                    self.append(&scratch.sums, &mut light);
                }
                Lit::Light(light.into())
            }
        };
        all().push(scratch);
        lit
    }

    /// Sets the geometries that the samples of each pixel see, of which there are this many.
    fn rank(&self, seen: &[u32], counts: impl Iterator<Item = usize>, piece: &mut Piece) {
        let first = self.shading.world.ids() as u32;
        for (pixel, number) in piece.rows_mut().into_iter().flatten().zip(first..) {
            *pixel = number;
        }
        piece.resolve(self.work.resolver.resolve(seen, counts));
    }

    /// Adds the geometries that the samples of some rows of pixels see.
    fn see(&self, rows: &Range<u32>, seen: &mut Vec<u32>) {
        let side = self.shading.samples.side();
        for row in rows.clone() {
            for column in self.columns.clone() {
                for row in (row * side..(row + 1) * side).rev() {
                    let place = self.hits.place(column * side, row);
                    seen.extend_from_slice(&self.hits.ids[place..place + side as usize]);
                }
            }
        }
    }

    /// Appends the means of the samples of a row of pixels, of those that show something.
    fn append(&self, sums: &Sums, to: &mut LightPlanes) {
        let row = to.coverage.len()..to.coverage.len() + sums.hits.len();
        let (mut all, mut hits) = (&[][..], Vec::new());
        if self.state.count != 1 {
            all = &sums.counts;
            // A sum of no samples is 0.
            hits.extend(sums.hits.iter().map(|hits| f64::from((*hits).max(1))));
        }
        let shown = match self.work.resolver.is_transparent {
            true => &hits,
            false => all,
        };
        let parts = to.parts.as_flattened_mut().iter_mut();
        for (to, sums) in parts.zip(sums.light.parts.as_flattened()) {
            append(to, &row, sums, shown);
        }
        for (to, sums) in to.albedo.iter_mut().zip(&sums.albedo) {
            append(to, &row, sums, all);
        }
        for (to, error) in to.error.iter_mut().zip(&sums.error) {
            to.extend_from_slice(error);
        }
        if !sums.error[0].is_empty() {
            to.samples.extend_from_slice(&sums.counts);
        }
        append(&mut to.behind, &row, &sums.light.behind, &hits);
        for behind in to.behind.iter_mut().skip(row.start) {
            *behind = behind.min(1.0);
        }
        let coverage = sums.hits.iter().zip(&sums.counts);
        to.coverage
            .extend(coverage.map(|(hits, count)| f64::from(*hits) / count));
    }

    /// Sets the bytes of a row of pixels.
    fn bytes(&self, sums: &mut Sums, tone: Tone, bytes: &mut [[u8; 3]]) {
        let parts = &mut sums.light.parts;
        if self.state.count != 1 {
            for part in parts.as_flattened_mut() {
                for (sum, count) in part.iter_mut().zip(&sums.counts) {
                    *sum /= count;
                }
            }
        }
        let [first, others @ ..] = parts;
        for other in others {
            for (sum, other) in first.iter_mut().flatten().zip(other.iter().flatten()) {
                *sum += other;
            }
        }
        self.shading.isa.run(Encode {
            tone,
            light: first.each_ref().map(Vec::as_slice),
            is_wide: false,
            channels: 3,
            bytes: bytes.as_flattened_mut(),
        });
    }

    /// Sums up the samples of a row of pixels, which are traced already if light follows paths.
    fn add_up(&self, row: u32, traced: &[PixelSums], scratch: &mut Scratch) {
        let (side, width) = (self.shading.samples.side(), self.columns.len());
        scratch.sums.clear(width, self.state.count);
        match &self.state.integrator {
            Integrator::Path(_) => return self.take_traced(row, traced, scratch),
            Integrator::Flat(_) | Integrator::Direct(_) => {}
        }
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
    fn add_albedo(&self, row: u32, samples: Range<usize>, sums: &mut [Vec<f64>; 3]) {
        let side = self.shading.samples.side() as usize;
        sums.iter_mut()
            .for_each(|sums| sums.resize(self.columns.len(), 0.0));
        let line = (row - self.hits.rows.start) as usize;
        let left = self.columns.start as usize * side - self.hits.columns.start as usize;
        // Neighbors mostly show the same geometry.
        let (mut last, mut known) = (NOTHING, None);
        for (column, place) in samples.enumerate() {
            let (id, t) = (self.hits.ids[place], self.hits.t[place]);
            let geometry = self.shading.world.with_id(id as usize);
            if id != last {
                let material = geometry.and_then(Geometry::only_material);
                let of_all = material.map(|material| material.color().to_linear());
                (last, known) = (id, of_all);
            }
            let light = match (known, geometry) {
                (Some(light), _) => light,
                (None, None) => Radiance::BLACK,
                (None, Some(geometry)) => {
                    let ray = || self.rays.ray(left + column, line);
                    geometry.color_at(ray, t).to_linear()
                }
            };
            for (sums, channel) in sums.iter_mut().zip(light.channels) {
                sums[column / side] += channel;
            }
        }
    }

    /// Adds a row of samples, which hit these geometries, to the sums of its pixels.
    fn add(&self, ids: &[u32], scratch: &mut Scratch) {
        let side = self.shading.samples.side() as usize;
        let Scratch { samples, sums, .. } = scratch;
        if !matches!(self.work.wanted, Wanted::Bytes(_)) {
            for (sum, ids) in sums.hits.iter_mut().zip(ids.chunks_exact(side)) {
                *sum += ids.iter().map(|id| u32::from(*id != NOTHING)).sum::<u32>();
            }
        }
        if self.work.resolver.is_transparent {
            for (place, _) in ids.iter().enumerate().filter(|(_, id)| **id == NOTHING) {
                samples.set(place, Shaded::default());
            }
        }
        if side == 1 {
            // The only samples are the sums.
            mem::swap(&mut sums.light, samples);
            return;
        }
        let RowLight { parts, behind } = &mut sums.light;
        let planes = parts.as_flattened_mut().iter_mut().chain([behind]);
        let samples = samples.parts.as_flattened().iter().chain([&samples.behind]);
        for (sums, samples) in planes.zip(samples) {
            if samples.is_empty() {
                continue;
            }
            sums.resize(self.columns.len(), 0.0);
            match side {
                2 => add_rows(sums, samples.as_chunks::<2>().0),
                3 => add_rows(sums, samples.as_chunks::<3>().0),
                4 => add_rows(sums, samples.as_chunks::<4>().0),
                _ => add_rows(sums, samples.chunks_exact(side)),
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
        let [r, g, b] = &mut samples.parts[0];
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
        self.state
            .integrator
            .shade(seen, (queue, lanes), |place, shaded| {
                samples.set(place, shaded)
            });
        if world.backdrop().is_some() && !self.work.resolver.is_transparent {
            let ids = self.hits.ids[first..first + columns.len()].iter();
            for (place, _) in ids.enumerate().filter(|(_, id)| **id == NOTHING) {
                let ray = self.rays.ray(left + place, line);
                samples.set(place, Shaded::direct(world.behind(&ray)));
            }
        }
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

/// Appends a row of sums to a plane, divided by the numbers of their samples, which are 1 if there are none.
/// The plane is empty if no row has any sums, and 0 in a row that has none.
#[inline(never)]
fn append(plane: &mut Vec<f64>, row: &Range<usize>, sums: &[f64], counts: &[f64]) {
    if plane.is_empty() && sums.is_empty() {
        return;
    }
    plane.resize(row.start, 0.0);
    plane.extend_from_slice(sums);
    for (mean, count) in plane[row.start..].iter_mut().zip(counts) {
        *mean /= count;
    }
    plane.resize(row.end, 0.0);
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
