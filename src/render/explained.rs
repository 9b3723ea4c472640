//! The samples of a pixel, one by one, for readers who want to check them by hand.

use std::{
    iter,
    ops::{Add, Range},
};

use crate::{
    diagnostic::error::Error,
    film::{
        Outlines,
        colors::NOTHING,
        parts::LightParts,
        resolve::{PixelColor, Resolver},
        samples::Samples,
        size::Size,
    },
    integrator::{
        Integrator,
        direct::Shaded,
        explain::{TracedRay, explain},
        path::{
            PathTracer,
            explain::{ExplainedPath, explain_paths},
        },
    },
    parallel::Cancel,
    render::{
        hits::{Hits, Rays},
        outlines::OutlineMask,
        shading::paths::PicturePaths,
    },
    tracer::{
        camera::Camera, color::Color, hit::Hit, radiance::Radiance, ray::Ray, tone::Tone,
        world::World,
    },
};

/// What a pixel is computed from.
pub(crate) struct PixelSource<'a> {
    pub(crate) camera: &'a Camera,
    pub(crate) world: &'a World,
    pub(crate) size: Size,
    pub(crate) samples: Samples,
    pub(crate) outlines: Option<Outlines>,
    pub(crate) tone: Tone,
    /// True if the light of the samples is added up; otherwise, a pixel shows the color of a
    /// geometry, or a mean of some.
    pub(crate) is_shaded: bool,
    /// The number of the sample whose path is asked for.
    pub(crate) sample: Option<u32>,
    pub(crate) cancel: &'a Cancel,
}

/// A pixel and its samples.
#[derive(Clone, Debug)]
pub struct ExplainedPixel {
    /// The samples, from the top left; none where light follows paths, which are too many.
    pub samples: Vec<ExplainedSample>,
    /// The number of its samples.
    pub count: u32,
    /// The mean of their light.
    pub parts: LightParts,
    /// Its paths, where light follows some.
    pub paths: Option<ExplainedPaths>,
    /// From light to display values; `None` in a flat picture, which has no exposure and no tone
    /// mapping.
    pub tone: Option<Tone>,
    /// The color of the pixel.
    pub color: Color,
}

/// The paths of a pixel.
#[derive(Clone, Debug, Default)]
pub struct ExplainedPaths {
    /// The standard error of the mean of their light.
    pub error: Radiance,
    /// The part of the mean that paths bring at each depth, before `clamp`.
    pub by_depth: Vec<Radiance>,
    /// The brightest, with the number of their sample.
    pub brightest: Vec<(u32, Radiance)>,
    /// The path that is asked for.
    pub path: Option<ExplainedPath>,
}

/// A sample of a pixel.
#[derive(Clone, Debug)]
pub struct ExplainedSample {
    /// The camera's ray.
    pub ray: Ray,
    /// The index of the geometry that it hits.
    pub hit: Option<usize>,
    /// The steps of the light of the ray, in a lit world.
    pub steps: Option<TracedRay>,
    /// The neighbor that outlines the sample: its distance in samples, to the right and upwards, and
    /// the geometry that it sees.
    pub outlined_by: Option<([i64; 2], Option<usize>)>,
    /// Its light; the color of the line, as direct light, if it is outlined.
    pub parts: LightParts,
}

impl ExplainedPaths {
    /// The number of the brightest paths.
    const BRIGHTEST: usize = 5;

    /// Adds one of a number of paths.
    fn add(&mut self, path: &ExplainedPath, count: u32) {
        for segment in &path.segments {
            let depth = segment.depth as usize;
            for light in &segment.adds {
                if self.by_depth.len() <= depth {
                    self.by_depth.resize(depth + 1, Radiance::BLACK);
                }
                self.by_depth[depth] = self.by_depth[depth] + *light / f64::from(count);
            }
        }
        let is_darker =
            |(_, light): &(u32, Radiance)| light.max_channel() >= path.light.max_channel();
        let place = self.brightest.partition_point(is_darker);
        self.brightest.insert(place, (path.sample, path.light));
        self.brightest.truncate(Self::BRIGHTEST);
    }
}

impl PixelSource<'_> {
    /// Explains a pixel, counted from the top left, by plain loops.
    ///
    /// # Errors
    ///
    /// Outlines that are too wide for a picture.
    pub(crate) fn explain(&self, column: u32, row: u32) -> Result<ExplainedPixel, Error> {
        if let Some(outlines) = &self.outlines {
            OutlineMask::check(outlines, self.samples)?;
        }
        let integrator = Integrator::new(self.world, self.world, self.tone, false);
        if let Integrator::Path(paths) = &integrator {
            return Ok(self.by_paths(paths, [column, row]));
        }
        let side = self.samples.side();
        let margin = self.outlines.map_or(0, |outlines| outlines.margin());
        let fine = |at: u32, most: u32| {
            at.saturating_sub(margin) * side..(at + 1).saturating_add(margin).min(most) * side
        };
        let (columns, rows) = (
            fine(column, self.size.width()),
            fine(row, self.size.height()),
        );
        let mut hits = Hits {
            columns,
            rows,
            ids: Vec::new(),
            t: Vec::new(),
        };
        let rays = Rays::new(
            self.camera,
            self.size,
            self.samples,
            [&hits.columns, &hits.rows],
        );
        for row in 0..hits.rows.len() {
            for column in 0..hits.columns.len() {
                let hit = self.world.hit(&rays.ray(column, row));
                let id = |(index, hit): (usize, Hit)| self.world.id_of(index, hit.face) as u32;
                hits.ids.push(hit.map_or(NOTHING, id));
                hits.t.push(hit.map_or(f64::INFINITY, |(_, hit)| hit.t));
            }
        }
        let mask = self
            .outlines
            .map(|outlines| OutlineMask::new(outlines, self.world, &hits, &rays, side));
        let of_pixel = |at: u32| -> Range<u32> { at * side..(at + 1) * side };
        let places =
            of_pixel(row).flat_map(|row| of_pixel(column).map(move |column| (column, row)));
        let samples: Vec<_> = places
            .map(|place| self.sample(&hits, &rays, mask.as_ref(), place))
            .collect();
        let from_bottom = || samples.chunks(side as usize).rev().flatten();
        let sum = from_bottom().map(|sample| sample.parts);
        let sum = sum.fold(LightParts::default(), LightParts::add);
        let parts = sum.map(|sum| sum / f64::from(self.samples.count()));
        let seen = from_bottom().map(|sample| sample.hit.map_or(NOTHING, |id| id as u32));
        let resolved = || {
            let seen: Vec<_> = seen.collect();
            let mut pixel = Resolver::new(self.world).resolve(&seen, iter::once(seen.len()));
            pixel.next().map(|pixel| pixel.color)
        };
        let resolved = (!self.is_shaded).then(resolved).flatten();
        Ok(ExplainedPixel {
            color: resolved.map_or(self.tone.color(parts.sum()), PixelColor::color),
            tone: self.world.lighting().map(|_| self.tone),
            parts,
            count: self.samples.count(),
            paths: None,
            samples,
        })
    }

    /// Returns the mean of the paths of a pixel without its lines.
    fn by_paths(&self, paths: &PathTracer<World>, [column, row]: [u32; 2]) -> ExplainedPixel {
        let picture = PicturePaths {
            paths,
            camera: self.camera,
            size: self.size,
            exposure: self.tone.factor(),
            count: paths.samples(),
            has_albedo: false,
            cancel: self.cancel,
        };
        let traced = picture.trace(&(column..column + 1, row..row + 1), None);
        let pixel = traced.and_then(|traced| traced.first().copied());
        let pixel = pixel.unwrap_or_default();
        let parts = pixel.light.parts.map(|sum| sum / f64::from(pixel.count));
        let place = [column, self.size.height() - 1 - row];
        let (camera, world) = ((self.camera, self.size), (self.world, self.cancel));
        let mut all = ExplainedPaths {
            error: pixel.error(),
            ..ExplainedPaths::default()
        };
        explain_paths(world, camera, place, 0..pixel.count, |path| {
            all.add(&path, pixel.count);
        });
        if let Some(sample) = self.sample {
            let samples = sample..sample.saturating_add(1);
            explain_paths(world, camera, place, samples, |path| all.path = Some(path));
        }
        ExplainedPixel {
            paths: Some(all),
            samples: Vec::new(),
            count: pixel.count,
            parts,
            tone: Some(self.tone),
            color: self.tone.color(parts.sum()),
        }
    }

    fn sample(
        &self,
        hits: &Hits,
        rays: &Rays,
        mask: Option<&OutlineMask>,
        (column, row): (u32, u32),
    ) -> ExplainedSample {
        let index = |id: u32| (id != NOTHING).then_some(id as usize);
        let ray = rays.ray(
            (column - hits.columns.start) as usize,
            (row - hits.rows.start) as usize,
        );
        let hit = index(hits.ids[hits.place(column, row)]);
        let steps = explain(self.world, &ray, self.tone);
        let outlined_by = mask.and_then(|mask| {
            let ([x, y], id) = mask.outlined_by(column, row)?;
            Some((mask.color(), ([x, -y], index(id))))
        });
        let flat = || self.world.flat_light(&ray);
        let parts = match (&outlined_by, &steps) {
            (Some((color, _)), _) => Shaded::direct(*color).parts,
            (None, Some(steps)) => steps.parts,
            (None, None) => Shaded::direct(flat()).parts,
        };
        ExplainedSample {
            ray,
            hit,
            steps,
            outlined_by: outlined_by.map(|(_, by)| by),
            parts,
        }
    }
}
