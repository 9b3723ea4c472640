//! The samples of a picture that its outlines cover.

mod amid;
mod neighbor;
mod runs;

use std::{f64::consts::PI, ops::Range};

use glam::DVec3;

use crate::{
    diagnostic::error::{Error, ErrorKind},
    film::{Outlines, colors::NOTHING, samples::Samples},
    parallel::Cancel,
    render::{
        hits::{Hits, Rays},
        outlines::{
            amid::{Common, amid},
            neighbor::{NearestSamples, Neighbor, PIECE},
            runs::{Run, Runs},
        },
    },
    tracer::{radiance::Radiance, ray::Ray, world::World},
};

/// The largest width of lines in samples. The time of a sample grows with its square within one geometry.
const WIDEST: f64 = 640.0;

/// The outlines of the samples of a rectangle.
pub(super) struct OutlineMask<'a> {
    outlines: Outlines,
    world: &'a World,
    hits: &'a Hits,
    rays: &'a Rays<'a>,
    /// The rows of samples.
    runs: Runs,
    /// The rows from a sample to those of its neighbors, the nearest first, and how many columns these lie apart at
    /// most.
    near: Vec<(isize, usize)>,
    /// The width of the lines in samples.
    reach: f64,
    /// The unit normal of each hit, if creases are drawn.
    normals: Vec<DVec3>,
    /// The cosine of the angle of a crease.
    crease: f64,
    /// For each pixel of the rectangle, true if no line is near; empty if none lies within one geometry.
    amid: Vec<bool>,
    /// The number of samples per side of a pixel.
    side: u32,
}

/// Which neighbor of a sample is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WhichNeighbor {
    /// Any that outlines it.
    Any,
    /// The first that does.
    First,
}

/// The lines on a row, and the memory of the search for them.
#[derive(Default)]
pub(super) struct RowLines {
    /// For each sample, the neighbor that outlines it.
    pub(super) found: Vec<Option<Neighbor>>,
    /// For each row near it, the first run that is not too far left.
    first: Vec<usize>,
    nearest: Vec<NearestSamples>,
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
        let of_pixel = match outlines.are_within() {
            true => 2 * size_of::<Option<Common>>() + size_of::<bool>(),
            false => 0,
        };
        let pixels = samples / u64::from(side).pow(2);
        (samples * of_sample as u64)
            .saturating_add(pixels * of_pixel as u64)
            .saturating_add(Runs::bytes(samples))
    }

    pub(super) fn new(
        outlines: Outlines,
        world: &'a World,
        hits: &'a Hits,
        rays: &'a Rays<'a>,
        side: u32,
    ) -> Self {
        let reach = outlines.width * f64::from(side);
        let most = reach.ceil() as isize;
        let is_near = |x: isize, y: isize| ((x * x + y * y) as f64) < reach * reach;
        let columns = |y| Some((0..=most).take_while(|x| is_near(*x, y)).last()? as usize);
        let normals = match outlines.creases {
            Some(_) => hits.map(rays, |ray, id, t| normal(world, &ray, id, t)),
            None => Vec::new(),
        };
        let crease = libm::cos(outlines.creases.unwrap_or(0.0) * (PI / 180.0));
        let amid = match outlines.are_within() {
            true => amid(hits, &normals, side, &outlines, crease),
            false => Vec::new(),
        };
        let rows = (0..=most).flat_map(|y| [-y, y].into_iter().take(if y == 0 { 1 } else { 2 }));
        Self {
            near: rows.filter_map(|y| Some((y, columns(y)?))).collect(),
            runs: Runs::new(&hits.ids, hits.columns.len()),
            reach,
            amid,
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

    /// Returns the neighbor that outlines a sample, counted from the top left of the picture: the columns and
    /// rows to it, and the geometry that it sees.
    pub(super) fn outlined_by(&self, column: u32, row: u32) -> Option<([i64; 2], u32)> {
        let mut lines = RowLines::default();
        self.find(
            row,
            column..column + 1,
            WhichNeighbor::First,
            &Cancel::new(),
            &mut lines,
        );
        let apart = lines.found[0]?.apart();
        let other = self.at(self.hits.place(column, row), apart);
        Some((apart.map(|apart| apart as i64), self.hits.ids[other]))
    }

    /// Finds the samples of a row, counted from the top left of the picture, that are outlined. Not all are
    /// found once it is cancelled.
    pub(super) fn find(
        &self,
        row: u32,
        columns: Range<u32>,
        which: WhichNeighbor,
        cancel: &Cancel,
        lines: &mut RowLines,
    ) {
        let first = self.hits.columns.start;
        let columns = (columns.start - first) as usize..(columns.end - first) as usize;
        let row = (row - self.hits.rows.start) as usize;
        lines.found.clear();
        lines.found.resize(columns.len(), None);
        lines.first.clear();
        lines.first.resize(self.near.len(), 0);
        for run in self.runs.row(row).iter().filter(|run| run.id != NOTHING) {
            let mut start = columns.start.max(run.columns().start);
            let end = columns.end.min(run.columns().end);
            while start < end && !cancel.is_cancelled() {
                let piece = start..end.min(start + PIECE);
                start = piece.end;
                let found = piece.start - columns.start..piece.end - columns.start;
                self.see_others((row, &piece, run.id), which, lines, found.clone());
                if self.outlines.are_within() {
                    self.see_own((row, &piece, run.id), which, lines, found, cancel);
                }
            }
        }
    }

    /// Compares samples side by side that see the same geometry with the nearest of each other one.
    fn see_others(
        &self,
        (row, columns, own): (usize, &Range<usize>, u32),
        which: WhichNeighbor,
        RowLines {
            found,
            first,
            nearest,
        }: &mut RowLines,
        places: Range<usize>,
    ) {
        let found = &mut found[places];
        let mut count = 0;
        for ((y, most), first) in self.near.iter().zip(first) {
            for run in self.runs_near(row, *y, *most, columns, first) {
                let near = run.near(*most, columns);
                if run.id == NOTHING && which == WhichNeighbor::Any {
                    let some = Neighbor::new([0, *y]);
                    found[near.start - columns.start..near.end - columns.start].fill(Some(some));
                } else if run.id != own {
                    let known = nearest[..count].iter().position(|known| known.id == run.id);
                    let at = known.unwrap_or_else(|| {
                        if count == nearest.len() {
                            nearest.push(NearestSamples::default());
                        }
                        nearest[count].id = run.id;
                        count += 1;
                        count - 1
                    });
                    nearest[at].note(near, run, *y, columns.start);
                }
            }
            if which == WhichNeighbor::Any && found.iter().all(Option::is_some) {
                break;
            }
        }
        let first = row * self.hits.columns.len() + columns.start;
        for nearest in &mut nearest[..count] {
            for (place, neighbor) in nearest.take() {
                let found = &mut found[place];
                if found.is_some() && which == WhichNeighbor::Any {
                    continue;
                }
                let place = first + place;
                let share = self.share(place, self.at(place, neighbor.apart()));
                if self.reaches(neighbor, share) {
                    *found = first_of(*found, neighbor);
                }
            }
        }
    }

    /// Compares samples side by side that see the same geometry with their neighbors that see it.
    fn see_own(
        &self,
        (row, columns, own): (usize, &Range<usize>, u32),
        which: WhichNeighbor,
        lines: &mut RowLines,
        places: Range<usize>,
        cancel: &Cancel,
    ) {
        let width = self.hits.columns.len();
        let RowLines { found, first, .. } = lines;
        for (column, found) in columns.clone().zip(&mut found[places]) {
            let place = row * width + column;
            let is_known = found.is_some() && which == WhichNeighbor::Any;
            // A sample with very many neighbors takes long.
            if is_known || self.is_amid(place) || cancel.is_cancelled() {
                continue;
            }
            let only = column..column + 1;
            for ((y, most), first) in self.near.iter().zip(&mut *first) {
                let runs = self.runs_near(row, *y, *most, &only, first);
                let own = runs.filter(|run| run.id == own);
                let all = column.saturating_sub(*most)..column + most + 1;
                for other in own.flat_map(|run| run.part_of(&all)) {
                    let apart = [other as isize - column as isize, *y];
                    let share = self.share_within(place, self.at(place, apart));
                    let neighbor = Neighbor::new(apart);
                    if share > 0.0 && self.reaches(neighbor, share) {
                        *found = first_of(*found, neighbor);
                    }
                }
                if found.is_some() && which == WhichNeighbor::Any {
                    break;
                }
            }
        }
    }

    /// Returns the runs of a row, counted from another one, that are near some columns. `first` is the first that
    /// is not too far left of these and all columns before.
    fn runs_near(
        &self,
        row: usize,
        y: isize,
        most: usize,
        columns: &Range<usize>,
        first: &mut usize,
    ) -> impl Iterator<Item = &Run> {
        let row = row.checked_add_signed(y);
        let runs = row.map_or(&[][..], |row| self.runs.row(row));
        let far = runs[(*first).min(runs.len())..].iter();
        *first += far
            .take_while(|run| run.columns().end + most <= columns.start)
            .count();
        let end = columns.end + most;
        let runs = runs[(*first).min(runs.len())..].iter();
        runs.take_while(move |run| run.columns().start < end)
    }

    /// Returns the place of a neighbor, from the columns and rows to it.
    fn at(&self, place: usize, [x, y]: [isize; 2]) -> usize {
        place.wrapping_add_signed(y * self.hits.columns.len() as isize + x)
    }

    /// Returns true if a neighbor outlines a sample that has this share of the line between them.
    fn reaches(&self, neighbor: Neighbor, share: f64) -> bool {
        // Distances count from halfway between the two samples.
        let reach = 0.5 + (self.reach - 0.5) * share;
        share > 0.0 && neighbor.squared() <= reach * reach
    }

    /// Returns the part of the line between samples of two geometries that lies on the first one's side; those
    /// of both are 1 together. No line is 0.
    fn share(&self, one: usize, other: usize) -> f64 {
        let [own, id] = [one, other].map(|place| self.hits.ids[place]);
        if id == NOTHING {
            return 1.0;
        }
        let goes_on = |id: u32, place: usize| self.world.meets(id as usize, &self.ray(place));
        match (goes_on(own, other), goes_on(id, one)) {
            (false, true) => 1.0,
            (true, false) => 0.0,
            _ => self.share_of_seam(one, other),
        }
    }

    /// Returns the same for two samples of one geometry.
    fn share_within(&self, one: usize, other: usize) -> f64 {
        let t = &self.hits.t;
        let is_behind = |one: usize, other: usize| {
            let depth = self.outlines.depth;
            depth.is_some_and(|depth| t[other] > t[one] + depth)
        };
        let is_crease = || {
            self.outlines.creases.is_some()
                && self.normals[one].dot(self.normals[other]) < self.crease
        };
        match (is_behind(one, other), is_behind(other, one)) {
            (true, _) => 1.0,
            (_, true) => 0.0,
            _ if is_crease() => self.share_of_seam(one, other),
            _ => 0.0,
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

/// Returns the one of two neighbors that comes first.
fn first_of(one: Option<Neighbor>, other: Neighbor) -> Option<Neighbor> {
    Some(one.map_or(other, |one| one.min(other)))
}

/// Returns the unit normal where a ray hits a geometry.
fn normal(world: &World, ray: &Ray, id: u32, t: f64) -> DVec3 {
    let geometry = world.with_id(id as usize);
    geometry.map_or(DVec3::ZERO, |geometry| {
        let crossing = geometry.crossing_at(ray, t);
        geometry.shape().normal_at(ray, crossing)
    })
}
