//! Rows of a picture whose light follows paths.

use std::ops::Range;

use super::{
    part::HitRows,
    picture_sums::{PictureSums, PixelArea},
    pixel_sums::PixelSums,
    sums::Scratch,
};
use crate::{
    film::{Wanted, colors::NOTHING, size::Size},
    integrator::{
        direct::{Queries, Shaded},
        path::PathTracer,
    },
    parallel::Cancel,
    render::outlines::{RowLines, WhichNeighbor},
    tracer::{camera::Camera, shape::face::FaceId},
};

/// The number of paths of a pixel after which it is asked whether the work is cancelled.
const UNASKED: u32 = 1 << 10;
/// The side of the blocks of pixels that have the same number of samples if their noise has a limit.
const BLOCK: u32 = 8;
/// The number of samples after which a block may end, as it may after twice as many, and so on.
const FIRST_END: u32 = 64;

/// The paths of the pixels of a picture.
#[derive(Clone, Copy)]
pub(crate) struct PicturePaths<'a, Q> {
    pub(crate) paths: &'a PathTracer<'a, Q>,
    pub(crate) camera: &'a Camera,
    pub(crate) size: Size,
    /// The exposure, as a factor.
    pub(crate) exposure: f64,
    /// The largest number of samples of a pixel.
    pub(crate) count: u32,
    /// True if the sums of first colors are wanted.
    pub(crate) has_albedo: bool,
    pub(crate) cancel: &'a Cancel,
}

impl<Q: Queries> PicturePaths<'_, Q> {
    /// The side of the blocks of pixels that are traced together, counted from the bottom left.
    pub(super) fn block_side(&self) -> u32 {
        self.paths.noise().map_or(1, |_| BLOCK)
    }

    /// Returns the block of a pixel: the part of it that is in the picture.
    fn block_of(&self, [column, row]: [u32; 2]) -> PixelArea {
        let (side, height) = (self.block_side(), self.size.height());
        let left = column - column % side;
        let y = height - 1 - row;
        let bottom = y - y % side;
        let right = (left + side).min(self.size.width());
        let top = (bottom + side).min(height);
        (left..right, height - top..height - bottom)
    }

    /// Returns the columns and rows of all blocks that some pixels are in.
    pub(super) fn blocks_of(&self, (columns, rows): &PixelArea) -> PixelArea {
        let first = self.block_of([columns.start, rows.start]);
        let last = self.block_of([columns.end - 1, rows.end - 1]);
        (first.0.start..last.0.end, first.1.start..last.1.end)
    }

    /// Returns the row after those of the blocks in a row of pixels.
    pub(super) fn end_of_blocks(&self, row: u32) -> u32 {
        self.block_of([0, row]).1.end
    }

    /// Returns the sums of some pixels, row by row, beginning with those that are known; `None` if the work is
    /// cancelled.
    ///
    /// All blocks that they are in are traced, so that they do not depend on the part of the picture.
    pub(crate) fn trace(
        &self,
        area: &PixelArea,
        known: Option<&PictureSums>,
    ) -> Option<Vec<PixelSums>> {
        let mut sums = PictureSums::within(self.blocks_of(area), known);
        let columns = sums.columns().clone();
        for (rows, pixels) in sums.parts(|row| self.end_of_blocks(row)) {
            self.add_rows(&columns, &rows, pixels)?;
        }
        let rows = area.1.clone().filter_map(|row| sums.row(row, &area.0));
        Some(rows.flatten().copied().collect())
    }

    /// Adds samples to the pixels of a row of blocks, as many as they lack; `None` if the work is cancelled.
    pub(super) fn add_rows(
        &self,
        columns: &Range<u32>,
        rows: &Range<u32>,
        pixels: &mut [PixelSums],
    ) -> Option<()> {
        let mut block = Vec::new();
        let mut column = columns.start;
        while column < columns.end {
            let area = self.block_of([column, rows.start]);
            let first = (column - columns.start) as usize;
            let in_row = first..first + area.0.len();
            block.clear();
            for line in pixels.chunks(columns.len()) {
                block.extend_from_slice(&line[in_row.clone()]);
            }
            let added = self.add_block(&area, &mut block);
            let lines = pixels.chunks_mut(columns.len());
            for (line, block) in lines.zip(block.chunks(area.0.len())) {
                line[in_row.clone()].copy_from_slice(block);
            }
            added?;
            column = area.0.end;
        }
        Some(())
    }

    /// Adds samples to the pixels of a block, as many as they lack; `None` if the work is cancelled.
    fn add_block(&self, (columns, rows): &PixelArea, block: &mut [PixelSums]) -> Option<()> {
        loop {
            let counts = block.iter().map(|sums| sums.count);
            let (least, most) = counts.fold((u32::MAX, 0), |(least, most), count| {
                (least.min(count), most.max(count))
            });
            if least >= self.count || (least == most && self.is_done(block)) {
                return Some(());
            }
            let to = match self.paths.noise() {
                Some(_) => FIRST_END.max((least + 1).next_power_of_two()),
                None => self.count,
            };
            let pixels = rows
                .clone()
                .flat_map(|row| columns.clone().map(move |column| [column, row]));
            for (sums, pixel) in block.iter_mut().zip(pixels) {
                self.add_pixel(pixel, sums, to.min(self.count))?;
            }
        }
    }

    /// Returns true if the pixels of a block, which have the same number of samples, need no more.
    fn is_done(&self, block: &[PixelSums]) -> bool {
        let Some((noise, first)) = self.paths.noise().zip(block.first()) else {
            return false;
        };
        let sum = || {
            block
                .iter()
                .map(|sums| sums.noise(self.exposure))
                .sum::<f64>()
        };
        let may_end = first.count >= FIRST_END && first.count.is_power_of_two();
        may_end && sum() / block.len() as f64 <= noise * noise
    }

    /// Adds samples to a pixel until it has this many; `None` if the work is cancelled.
    fn add_pixel(&self, [column, row]: [u32; 2], sums: &mut PixelSums, to: u32) -> Option<()> {
        let pixel = [column, self.size.height() - 1 - row];
        let first = sums.count;
        for first in (first..to).step_by(UNASKED as usize) {
            if self.cancel.is_cancelled() {
                return None;
            }
            let numbers = first..to.min(first + UNASKED);
            let camera = (self.camera, self.size);
            self.paths.each_sample(camera, pixel, numbers, |sample| {
                sums.add(sample, self.has_albedo);
            });
        }
        Some(())
    }

    /// Adds the ids of the geometries that the samples of a pixel hit first.
    fn see(&self, [column, row]: [u32; 2], count: u32, seen: &mut Vec<u32>) {
        let pixel = [column, self.size.height() - 1 - row];
        let id = |FaceId { geometry, face }| self.paths.world().id_of(geometry, face) as u32;
        seen.extend((0..count).map(|sample| {
            let first = self.paths.first_of((self.camera, self.size), pixel, sample);
            first.map_or(NOTHING, id)
        }));
    }
}

impl<Q: Queries + Sync> HitRows<'_, Q> {
    /// Returns the paths of the picture.
    pub(super) fn paths<'p>(&'p self, paths: &'p PathTracer<'p, Q>) -> PicturePaths<'p, Q> {
        let wanted = self.work.wanted;
        self.shading
            .paths(paths, wanted == Wanted::Parts, self.work.cancel)
    }

    /// Adds the geometries that the samples of some rows of pixels hit first.
    pub(super) fn see_by_paths(
        &self,
        paths: &PathTracer<Q>,
        rows: &Range<u32>,
        traced: &[PixelSums],
        seen: &mut Vec<u32>,
    ) {
        let paths = self.paths(paths);
        let pixels = rows
            .clone()
            .flat_map(|row| self.columns.clone().map(move |column| [column, row]));
        for (pixel, sums) in pixels.zip(traced) {
            if self.work.cancel.is_cancelled() {
                // What is cancelled is dropped, whatever it shows.
                seen.extend((0..sums.count).map(|_| NOTHING));
                continue;
            }
            paths.see(pixel, sums.count, seen);
        }
    }

    /// Takes over the sums of a row of pixels, with its lines.
    pub(super) fn take_traced(&self, row: u32, traced: &[PixelSums], scratch: &mut Scratch) {
        let Scratch { sums, lines, .. } = scratch;
        let inked = self.inked(row, lines);
        for (place, pixel) in traced.iter().enumerate() {
            let (mut light, count) = (pixel.light, f64::from(pixel.count));
            let mut error = pixel.error();
            if let Some((mask, inked)) = self.mask.as_ref().zip(inked.get(place)) {
                let ink = Shaded::direct(mask.color() * (inked * count));
                let parts = light.parts.map(|part| part * (1.0 - inked));
                light = Shaded { parts, ..light } + ink;
                error = error * (1.0 - inked);
            }
            sums.light.set(place, light);
            sums.hits[place] = pixel.hits;
            sums.counts[place] = count;
            if self.work.wanted == Wanted::Parts {
                push(&mut sums.albedo, pixel.albedo.channels);
                push(&mut sums.error, error.channels);
            }
        }
    }

    /// Returns the part of each pixel of a row that lines cover; nothing if there are no lines.
    fn inked(&self, row: u32, lines: &mut RowLines) -> Vec<f64> {
        let Some(mask) = &self.mask else {
            return Vec::new();
        };
        let side = self.shading.samples.side();
        let columns = self.columns.start * side..self.columns.end * side;
        let mut inked = vec![0.0; self.columns.len()];
        for row in row * side..(row + 1) * side {
            let cancel = self.work.cancel;
            mask.find(row, columns.clone(), WhichNeighbor::Any, cancel, lines);
            for (inked, found) in inked.iter_mut().zip(lines.found.chunks(side as usize)) {
                *inked += found.iter().flatten().count() as f64;
            }
        }
        let count = f64::from(self.shading.samples.count());
        inked.iter_mut().for_each(|inked| *inked /= count);
        inked
    }
}

fn push(planes: &mut [Vec<f64>; 3], channels: [f64; 3]) {
    for (plane, channel) in planes.iter_mut().zip(channels) {
        plane.push(channel);
    }
}
