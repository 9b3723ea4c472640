//! Rows of a picture whose light follows paths.

use super::{part::HitRows, sums::Sums};
use crate::{
    film::{Wanted, colors::NOTHING},
    integrator::{
        direct::{Queries, Shaded},
        path::PathTracer,
    },
    render::outlines::{RowLines, WhichNeighbor},
    tracer::{radiance::Radiance, shape::face::FaceId},
};

/// The number of paths of a pixel after which it is asked whether the work is cancelled.
const UNASKED: u32 = 1 << 10;

impl<Q: Queries + Sync> HitRows<'_, Q> {
    /// Sums up the samples of a row of pixels, and adds the geometry that each sees to `seen` if that is
    /// wanted. What is cancelled meanwhile is dropped.
    pub(super) fn add_paths(
        &self,
        paths: &PathTracer<Q>,
        row: u32,
        (sums, lines): (&mut Sums, &mut RowLines),
        seen: &mut Vec<u32>,
    ) {
        let inked = self.inked(row, lines);
        for (place, column) in self.columns.clone().enumerate() {
            let Some(mut sum) = self.add_pixel(paths, [column, row], (place, sums), seen) else {
                return;
            };
            if let Some((mask, inked)) = self.mask.as_ref().zip(inked.get(place)) {
                let count = f64::from(self.state.count);
                let ink = Shaded::direct(mask.color() * (inked * count));
                let parts = sum.parts.map(|part| part * (1.0 - inked));
                sum = Shaded { parts, ..sum } + ink;
            }
            sums.light.set(place, sum);
        }
    }

    /// Returns the sum of the light of all samples of a pixel; `None` if the work is cancelled.
    fn add_pixel(
        &self,
        paths: &PathTracer<Q>,
        [column, row]: [u32; 2],
        (place, sums): (usize, &mut Sums),
        seen: &mut Vec<u32>,
    ) -> Option<Shaded> {
        let (shading, work) = (self.shading, &self.work);
        let pixel = [column, shading.size.height() - 1 - row];
        let (mut sum, mut albedo) = (Shaded::default(), Radiance::BLACK);
        for sample in 0..self.state.count {
            if sample % UNASKED == 0 && work.cancel.is_cancelled() {
                return None;
            }
            let traced = paths.sample_of((shading.camera, shading.size), pixel, sample);
            sum = sum + traced.light;
            sums.hits[place] += u32::from(traced.first.is_some());
            if let Some(color) = traced.color.filter(|_| work.wanted == Wanted::Parts) {
                albedo = albedo + color.to_linear();
            }
            if work.resolver.ranks {
                let id = |FaceId { geometry, face }| shading.world.id_of(geometry, face) as u32;
                seen.push(traced.first.map_or(NOTHING, id));
            }
        }
        if work.wanted == Wanted::Parts {
            for (sums, channel) in sums.albedo.iter_mut().zip(albedo.channels) {
                sums.push(channel);
            }
        }
        Some(sum)
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
