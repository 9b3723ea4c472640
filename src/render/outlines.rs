//! The samples of a picture that its outlines cover.

mod amid;
mod runs;

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    diagnostic::error::{Error, ErrorKind},
    film::{Outlines, colors::NOTHING, samples::Samples},
    render::{
        hits::{Hits, Rays},
        outlines::{
            amid::{Common, amid},
            runs::Runs,
        },
    },
    tracer::{radiance::Radiance, ray::Ray, world::World},
};

/// The distance in samples up to which all neighbors are compared one by one, even if only those of
/// other geometries matter. Tests use less.
const NEAR: f64 = if cfg!(test) { 2.0 } else { 16.0 };

/// The largest width of lines in samples. The time and the memory of a sample grow with its square.
const WIDEST: f64 = 640.0;

/// The outlines of the samples of a rectangle.
pub(super) struct OutlineMask<'a> {
    outlines: Outlines,
    world: &'a World,
    hits: &'a Hits,
    rays: &'a Rays<'a>,
    /// The columns and rows from a sample to those that are compared one by one, without itself, the
    /// nearest first; at equal distances from the top left.
    near: Vec<[i64; 2]>,
    /// The rows of samples, if only those of other geometries matter and some are farther away.
    runs: Option<Runs>,
    /// The width of the lines in samples.
    reach: f64,
    /// The unit normal of each hit, if creases are drawn.
    normals: Vec<DVec3>,
    /// The cosine of the angle of a crease.
    crease: f64,
    /// For each pixel of the rectangle, true if no line is near.
    amid: Vec<bool>,
    /// The number of samples per side of a pixel.
    side: u32,
}

impl<'a> OutlineMask<'a> {
    /// Rejects lines that are very many samples wide, which would take any time.
    pub(super) fn check(outlines: &Outlines, samples: Samples) -> Result<(), Error> {
        let width = outlines.width * f64::from(samples.side());
        if width <= WIDEST {
            return Ok(());
        }
        let message = format!(
            "outlines {width} samples wide would take too long, the maximum is {WIDEST}: lower \
             `width` or `samples`"
        );
        Err(Error::new(ErrorKind::Unavailable, message))
    }

    /// Returns the number of bytes that the outlines of a rectangle of samples take, with the hits
    /// of the samples.
    pub(super) fn bytes(outlines: &Outlines, samples: u64, side: u32) -> u64 {
        let normal = match outlines.creases {
            Some(_) => size_of::<DVec3>(),
            None => 0,
        };
        let of_sample = size_of::<u32>() + size_of::<f64>() + normal;
        let of_pixel = 2 * size_of::<Option<Common>>() + size_of::<bool>();
        let pixels = samples / u64::from(side).pow(2);
        // The list grows by doubling.
        let near = 2 * (2 * near(outlines, side).ceil() as u64).pow(2);
        (samples * of_sample as u64)
            .saturating_add(pixels * of_pixel as u64)
            .saturating_add(Runs::bytes(samples))
            .saturating_add(near * size_of::<[i64; 2]>() as u64)
    }

    pub(super) fn new(
        outlines: Outlines,
        world: &'a World,
        hits: &'a Hits,
        rays: &'a Rays<'a>,
        side: u32,
    ) -> Self {
        let reach = outlines.width * f64::from(side);
        let limit = near(&outlines, side);
        let most = limit.ceil() as i64;
        let squares = (-most..=most).flat_map(|y| (-most..=most).map(move |x| [x, y]));
        let is_near = |[x, y]: &[i64; 2]| {
            let squared = (x * x + y * y) as f64;
            squared > 0.0 && squared < limit * limit
        };
        let mut near: Vec<_> = squares.filter(is_near).collect();
        near.sort_by_key(|[x, y]| x * x + y * y);
        let normals = match outlines.creases {
            Some(_) => hits.map(rays, |ray, id, t| normal(world, &ray, id, t)),
            None => Vec::new(),
        };
        let crease = libm::cos(outlines.creases.unwrap_or(0.0) * (PI / 180.0));
        Self {
            near,
            runs: (limit < reach).then(|| Runs::new(&hits.ids, hits.columns.len())),
            reach,
            amid: amid(hits, &normals, side, &outlines, crease),
            normals,
            crease,
            outlines,
            world,
            hits,
            rays,
            side,
        }
    }

    /// Returns the light of a sample on a line.
    pub(super) fn color(&self) -> Radiance {
        self.outlines.color.to_linear()
    }

    /// Returns true if a sample, counted from the top left of the picture, is outlined.
    pub(super) fn covers(&self, column: u32, row: u32) -> bool {
        self.outlined_by(column, row).is_some()
    }

    /// Returns the neighbor that outlines a sample: the columns and rows to it, and the geometry that it
    /// sees.
    pub(super) fn outlined_by(&self, column: u32, row: u32) -> Option<([i64; 2], u32)> {
        let place = self.hits.place(column, row);
        if self.hits.ids[place] == NOTHING || self.is_amid(place) {
            return None;
        }
        let (columns, rows) = (&self.hits.columns, &self.hits.rows);
        let mut met = Vec::new();
        let near = self.near.iter().find_map(|near| {
            let column = u32::try_from(i64::from(column) + near[0]).ok()?;
            let row = u32::try_from(i64::from(row) + near[1]).ok()?;
            let is_inside = columns.contains(&column) && rows.contains(&row);
            let other = is_inside.then(|| self.hits.place(column, row))?;
            self.reaches(place, other, *near, &mut met)
        });
        near.or_else(|| self.outlined_from_afar(place, self.runs.as_ref()?, met))
    }

    /// Returns the neighbor if it outlines a sample.
    fn reaches(
        &self,
        place: usize,
        other: usize,
        near: [i64; 2],
        met: &mut Vec<u32>,
    ) -> Option<([i64; 2], u32)> {
        let share = self.share(place, other, met);
        if share == 0.0 {
            return None;
        }
        // Distances count from halfway between the two samples.
        let reach = 0.5 + (self.reach - 0.5) * share;
        let is_near = (near[0] * near[0] + near[1] * near[1]) as f64 <= reach * reach;
        is_near.then(|| (near, self.hits.ids[other]))
    }

    /// Returns the first neighbor that outlines a sample among the nearest of each geometry that is not in
    /// `met`, in the order of `near`. Rows are searched from near to far.
    fn outlined_from_afar(
        &self,
        place: usize,
        runs: &Runs,
        mut met: Vec<u32>,
    ) -> Option<([i64; 2], u32)> {
        let width = self.hits.columns.len();
        let (row, column) = (place / width, place % width);
        let own = self.hits.ids[place];
        // The squared distance, rows and columns to the nearest sample of each geometry so far.
        let mut waiting: Vec<([i64; 3], u32)> = Vec::new();
        for apart in 0..=self.reach.ceil() as i64 {
            let both = [-apart, apart];
            for y in both.into_iter().take(if apart == 0 { 1 } else { 2 }) {
                let Ok(row) = usize::try_from(row as i64 + y) else {
                    continue;
                };
                runs.around(row, column, |x, id| {
                    let key = [x * x + y * y, y, x];
                    let is_near = (key[0] as f64) < self.reach * self.reach;
                    if is_near && id != own && !met.contains(&id) {
                        match waiting.iter_mut().find(|(_, known)| *known == id) {
                            Some((known, _)) => *known = key.min(*known),
                            None => waiting.push((key, id)),
                        }
                    }
                    is_near
                });
            }
            // No farther row has a sample before these.
            let is_next = |(key, _): &&([i64; 3], u32)| key[0] < (apart + 1).pow(2);
            while let Some(next) = waiting.iter().filter(is_next).min().copied() {
                waiting.retain(|other| *other != next);
                let ([_, y, x], _) = next;
                let other = (row as i64 + y) as usize * width + (column as i64 + x) as usize;
                if let Some(found) = self.reaches(place, other, [x, y], &mut met) {
                    return Some(found);
                }
            }
        }
        None
    }

    /// Returns the part of the line between two samples that lies on the first one's side; those of
    /// both are 1 together. No line is 0, and so is a geometry that is in `met`.
    fn share(&self, one: usize, other: usize, met: &mut Vec<u32>) -> f64 {
        let Hits { ids, t, .. } = self.hits;
        let [own, id] = [one, other].map(|place| ids[place]);
        if id == NOTHING {
            return 1.0;
        }
        if id == own {
            let is_behind = |one: usize, other: usize| {
                let depth = self.outlines.depth;
                depth.is_some_and(|depth| t[other] > t[one] + depth)
            };
            let is_crease = || {
                self.outlines.creases.is_some()
                    && self.normals[one].dot(self.normals[other]) < self.crease
            };
            return match (is_behind(one, other), is_behind(other, one)) {
                (true, _) => 1.0,
                (_, true) => 0.0,
                _ if is_crease() => self.share_of_seam(one, other),
                _ => 0.0,
            };
        }
        if met.contains(&id) {
            return 0.0;
        }
        met.push(id);
        let goes_on = |id: u32, place: usize| self.world.meets(id as usize, &self.ray(place));
        match (goes_on(own, other), goes_on(id, one)) {
            (false, true) => 1.0,
            (true, false) => 0.0,
            _ => self.share_of_seam(one, other),
        }
    }

    /// Returns the share of a sample where neither of two surfaces hides the other: more on the one
    /// that turns away, so that the line goes on in that where it ends in front of the other.
    fn share_of_seam(&self, one: usize, other: usize) -> f64 {
        let [own, others] = [one, other].map(|place| {
            let ray = self.ray(place);
            let n = match self.normals.get(place) {
                Some(normal) => *normal,
                None => normal(self.world, &ray, self.hits.ids[place], self.hits.t[place]),
            };
            let d = ray.direction();
            (n.dot(d) / d.length()).abs()
        });
        match own + others {
            0.0 => 0.5,
            sum => others / sum,
        }
    }

    /// Returns true if no line is near the pixel of a sample.
    fn is_amid(&self, place: usize) -> bool {
        let (width, side) = (self.hits.columns.len(), self.side as usize);
        let (row, column) = (place / width / side, place % width / side);
        self.amid[row * (width / side) + column]
    }

    /// Returns the ray of the sample at a place.
    fn ray(&self, place: usize) -> Ray {
        let width = self.hits.columns.len();
        self.rays.ray(place % width, place / width)
    }
}

/// Returns the distance in samples up to which all neighbors are compared.
fn near(outlines: &Outlines, side: u32) -> f64 {
    let reach = outlines.width * f64::from(side);
    match outlines.depth.or(outlines.creases) {
        Some(_) => reach,
        None => reach.min(NEAR),
    }
}

/// Returns the unit normal where a ray hits a geometry.
fn normal(world: &World, ray: &Ray, id: u32, t: f64) -> DVec3 {
    let geometry = world.with_id(id as usize);
    geometry.map_or(DVec3::ZERO, |geometry| {
        let crossing = geometry.crossing_at(ray, t);
        geometry.shape().normal_at(ray, crossing)
    })
}
