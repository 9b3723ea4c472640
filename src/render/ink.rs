//! The samples of a picture that its outlines cover.

use std::{f64::consts::PI, ops::Range};

use glam::DVec3;

use crate::{
    film::{Outlines, colors::NOTHING},
    render::hits::{Hits, Rays},
    tracer::{radiance::Radiance, ray::Ray, world::World},
};

/// The outlines of the samples of a rectangle.
pub(super) struct Ink<'a> {
    outlines: Outlines,
    world: &'a World,
    hits: &'a Hits,
    rays: &'a Rays<'a>,
    /// The columns and rows from a sample to those that are nearer than the width, without itself,
    /// the nearest first; at equal distances from the top left.
    near: Vec<[i64; 2]>,
    /// The width of the lines in samples.
    reach: f64,
    /// The unit normal of each hit, if creases are drawn.
    normals: Vec<DVec3>,
    /// The cosine of the angle of a crease.
    crease: f64,
    /// The geometry that all samples of a pixel hit, by pixels of the rectangle; `None` if they
    /// differ. Empty if lines within one geometry are drawn.
    uniform: Vec<Option<u32>>,
    /// The number of samples per side of a pixel.
    side: u32,
}

impl<'a> Ink<'a> {
    /// Returns the number of bytes that the outlines of a rectangle of samples take, with the hits
    /// of the samples.
    pub(super) fn bytes(outlines: &Outlines, samples: u64, side: u32) -> u64 {
        let normal = match outlines.creases {
            Some(_) => size_of::<DVec3>(),
            None => 0,
        };
        let of_sample = size_of::<u32>() + size_of::<f64>() + normal;
        let reach = (outlines.width * f64::from(side)).ceil() as u64;
        // The list grows by doubling.
        let near = 2 * (2 * reach).pow(2) * size_of::<[i64; 2]>() as u64;
        (samples * of_sample as u64).saturating_add(near)
    }

    pub(super) fn new(
        outlines: Outlines,
        world: &'a World,
        hits: &'a Hits,
        rays: &'a Rays<'a>,
        side: u32,
    ) -> Self {
        let reach = outlines.width * f64::from(side);
        let most = reach.ceil() as i64;
        let squares = (-most..=most).flat_map(|y| (-most..=most).map(move |x| [x, y]));
        let is_near = |[x, y]: &[i64; 2]| {
            let squared = (x * x + y * y) as f64;
            squared > 0.0 && squared < reach * reach
        };
        let mut near: Vec<_> = squares.filter(is_near).collect();
        near.sort_by_key(|[x, y]| x * x + y * y);
        let normals = match outlines.creases {
            Some(_) => hits.map(rays, |ray, id, t| normal(world, &ray, id, t)),
            None => Vec::new(),
        };
        let is_simple = outlines.creases.is_none() && outlines.depth.is_none();
        Self {
            near,
            reach,
            normals,
            crease: libm::cos(outlines.creases.unwrap_or(0.0) * (PI / 180.0)),
            uniform: if is_simple {
                hits.uniform(side)
            } else {
                Vec::new()
            },
            outlines,
            world,
            hits,
            rays,
            side,
        }
    }

    /// Returns the light of an inked sample.
    pub(super) fn color(&self) -> Radiance {
        self.outlines.color.to_linear()
    }

    /// Returns true if a sample, counted from the top left of the picture, is inked.
    pub(super) fn covers(&self, column: u32, row: u32) -> bool {
        self.inked_by(column, row).is_some()
    }

    /// Returns the neighbor that inks a sample: the columns and rows to it, and the geometry that it
    /// sees.
    pub(super) fn inked_by(&self, column: u32, row: u32) -> Option<([i64; 2], u32)> {
        let place = self.hits.place(column, row);
        if self.hits.ids[place] == NOTHING || self.is_amid_one(column, row) {
            return None;
        }
        let (columns, rows) = (&self.hits.columns, &self.hits.rows);
        let mut met = Vec::new();
        self.near.iter().find_map(|near| {
            let column = u32::try_from(i64::from(column) + near[0]).ok()?;
            let row = u32::try_from(i64::from(row) + near[1]).ok()?;
            let is_inside = columns.contains(&column) && rows.contains(&row);
            let other = is_inside.then(|| self.hits.place(column, row))?;
            // Distances count from halfway between the two samples.
            let reach = 0.5 + (self.reach - 0.5) * self.share(place, other, &mut met);
            let is_near = (near[0] * near[0] + near[1] * near[1]) as f64 <= reach * reach;
            is_near.then(|| (*near, self.hits.ids[other]))
        })
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

    /// Returns the ray of the sample at a place.
    fn ray(&self, place: usize) -> Ray {
        let width = self.hits.columns.len();
        self.rays.ray(place % width, place / width)
    }

    /// Returns true if all samples of the pixels around a sample hit the same geometry.
    fn is_amid_one(&self, column: u32, row: u32) -> bool {
        if self.uniform.is_empty() {
            return false;
        }
        let (columns, rows) = (&self.hits.columns, &self.hits.rows);
        let margin = self.outlines.margin();
        let around = |place: u32, range: &Range<u32>| {
            let (place, end) = (
                (place - range.start) / self.side,
                range.len() as u32 / self.side,
            );
            place.saturating_sub(margin)..(place + margin + 1).min(end)
        };
        let width = columns.len() / self.side as usize;
        let mut rows = around(row, rows);
        let across = around(column, columns);
        let across = across.start as usize..across.end as usize;
        let own = Some(self.hits.ids[self.hits.place(column, row)]);
        rows.all(|row| {
            let row = &self.uniform[row as usize * width..][..width];
            row[across.clone()].iter().all(|id| *id == own)
        })
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
