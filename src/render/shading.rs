//! Pictures whose samples are shaded one by one: lit ones, and those with outlines.

use std::ops::Range;

use glam::DVec3;

use crate::{
    accel::{
        raster::first_hits::{FirstHits, Take, Work, cut},
        shadow::{Casters, Casting, Points, Toward},
    },
    diagnostic::error::Error,
    film::{
        Centers, Film, Lit, LitPixel, Outlines, Piece, Wanted, colors::NOTHING, crop::Crop,
        samples::Samples, size::Size,
    },
    integrator::{
        batch::{Facing, Row, ShadeRow},
        direct::{Direct, Path, Queries, Shaded, Shadow, Shadows},
    },
    render::{
        hits::{Hits, Rays},
        ink::Ink,
    },
    simd::Isa,
    tracer::{
        camera::Camera,
        radiance::Radiance,
        world::{Lighting, World},
    },
};

/// The smallest and the largest number of samples whose hits are in memory at once, unless a row has
/// more. With many geometries, which are sorted anew each time, they are more.
const CHUNK: [u64; 2] = [1 << 18, 1 << 21];
/// The number of rows of pixels that a thread shades at once.
const ROWS: u32 = 4;
/// The number of such groups of rows that are shaded ahead of the consumer.
const AHEAD: usize = 64;
/// The number of shadow rays that a thread traces at once.
const TOGETHER: usize = 1 << 10;

/// A picture whose samples are shaded one by one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shading<'a, Q> {
    pub(crate) camera: &'a Camera,
    pub(crate) world: &'a World,
    pub(crate) queries: &'a Q,
    pub(crate) size: Size,
    pub(crate) samples: Samples,
    pub(crate) outlines: Option<Outlines>,
    pub(crate) isa: Isa,
}

/// The sums of a pixel's samples.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    direct: Radiance,
    specular: Radiance,
    albedo: Radiance,
    hits: u32,
}

impl<Q: Queries + Sync> Shading<'_, Q> {
    /// Shades a part of the picture and passes it on in bands, from the top.
    pub(crate) fn draw(&self, crop: Crop, work: Work, take: Take) -> Result<(), Error> {
        let side = self.samples.side();
        let in_row = crop.columns().len() as u64 * u64::from(side * side);
        let geometries = self.world.geometries().len() as u64;
        let chunk = (geometries * 32).clamp(CHUNK[0], CHUNK[1]);
        let rows = (chunk / in_row).max(1).min(crop.rows().len() as u64) as u32;
        let rows = rows.next_multiple_of(ROWS);
        cut(crop.rows(), rows).try_for_each(|rows| self.draw_rows(crop.columns(), rows, work, take))
    }

    fn draw_rows(
        &self,
        columns: Range<u32>,
        rows: Range<u32>,
        work: Work,
        take: Take,
    ) -> Result<(), Error> {
        let side = self.samples.side();
        let margin = self.outlines.map_or(0, |outlines| outlines.margin());
        let fine = |range: &Range<u32>, most: u32| {
            let end = range.end.saturating_add(margin).min(most);
            range.start.saturating_sub(margin) * side..end * side
        };
        let search =
            |samples| FirstHits::of_samples(self.camera, self.world, self.size, samples, self.isa);
        let hits = Hits::new(
            &search(self.samples),
            fine(&columns, self.size.width()),
            fine(&rows, self.size.height()),
            work,
        )?;
        let needs_centers = work.centers != Centers::Unneeded && self.samples != Samples::ONE;
        let centers = needs_centers
            .then(|| Hits::new(&search(Samples::ONE), columns.clone(), rows.clone(), work))
            .transpose()?;
        let rays = Rays::new(self.camera, self.size, self.samples, &hits);
        let ink = self.outlines.map(|outlines| {
            work.watch
                .time(|| Ink::new(outlines, self.world, &hits, &rays, side))
        });
        let part = Part {
            shading: self,
            shadows: self.shadows(&hits, &rays, work),
            rays,
            ink,
            centers: centers.as_ref().unwrap_or(&hits),
            hits: &hits,
            columns: &columns,
            work,
        };
        let shade = |rows: Range<u32>| {
            work.cancel.check()?;
            let piece = work.watch.time(|| part.piece(rows));
            if let Some(progress) = work.progress {
                progress(piece.pixels() as u64);
            }
            Ok(piece)
        };
        work.pool.in_order(cut(rows, ROWS), AHEAD, shade, |piece| {
            let mut film = Film::default();
            film.push(piece?);
            take(film)
        })
    }

    /// Returns the linear first color of a geometry; black for nothing.
    fn albedo(&self, id: u32) -> Radiance {
        let geometry = self.world.geometries().get(id as usize);
        geometry.map_or(Radiance::BLACK, |geometry| geometry.color().to_linear())
    }

    /// Returns, for each light, its shadow on each sample; nothing for one that casts none.
    fn shadows(&self, hits: &Hits, rays: &Rays, work: Work) -> Vec<Vec<Shadow>> {
        let Some(lighting) = self.world.lighting() else {
            return Vec::new();
        };
        let count = hits.ids.len();
        let counts = || {
            let lights = lighting.lights.iter();
            lights.map(|light| if light.shadows() { count } else { 0 })
        };
        let mut shadows: Vec<_> = counts().map(|count| vec![Shadow::Lit; count]).collect();
        if counts().all(|count| count == 0) {
            return shadows;
        }
        let mut points = [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![0.0; count]);
        let mut own: Vec<_> = counts().map(|count| vec![NOTHING; count]).collect();
        self.face(lighting, hits, rays, &mut points, &mut own, work);
        let at = points.each_ref().map(Vec::as_slice);
        for ((light, own), shadows) in lighting.lights.iter().zip(&mut own).zip(&mut shadows) {
            if let Some(toward) = Toward::of(light) {
                self.cast(toward, at, own, shadows, work);
            }
        }
        shadows
    }

    /// Fills the points of all hits and, for each light that casts shadows, the geometries that face
    /// it.
    fn face(
        &self,
        lighting: &Lighting,
        hits: &Hits,
        rays: &Rays,
        points: &mut [Vec<f64>; 3],
        own: &mut [Vec<u32>],
        work: Work,
    ) {
        let width = hits.columns.len();
        let mut points = points.each_mut().map(|points| points.chunks_mut(width));
        let mut own: Vec<_> = own.iter_mut().map(|own| own.chunks_mut(width)).collect();
        let rows: Vec<_> = (0..hits.rows.len())
            .map(|row| {
                let points = points
                    .each_mut()
                    .map(|rows| rows.next().unwrap_or_default());
                let own = own.iter_mut().map(|rows| rows.next().unwrap_or_default());
                (row, points, own.collect::<Vec<_>>())
            })
            .collect();
        work.pool.map(rows, |(row, points, own)| {
            work.watch.time(|| {
                self.isa.run(Facing {
                    world: self.world,
                    lighting,
                    row: row_of(hits, rays, row, 0..width),
                    points,
                    own,
                });
            });
        });
    }

    /// Sets the shadows of a light on points.
    fn cast(
        &self,
        toward: Toward,
        at: [&[f64]; 3],
        own: &mut [u32],
        shadows: &mut [Shadow],
        work: Work,
    ) {
        let mut open = Vec::new();
        for (casters, shadow) in [
            (Casters::Opaque, Shadow::Dark),
            (Casters::Glass, Shadow::Glass),
        ] {
            let found = work.watch.time(|| {
                let casting = Casting::new(self.world, casters, toward, work.pool)?;
                Some(casting.cast(Points { at, own }, work.pool, self.isa))
            });
            for part in found.iter().flatten() {
                for place in &part.dark {
                    shadows[*place as usize] = shadow;
                    own[*place as usize] = NOTHING;
                }
            }
            for part in found.into_iter().flatten() {
                for place in part.open {
                    let own = &mut own[place as usize];
                    if *own != NOTHING {
                        open.push((place as usize, *own));
                        *own = NOTHING;
                    }
                }
            }
        }
        if open.is_empty() {
            return;
        }
        work.watch.time(|| self.queries.prepare());
        let found = work.pool.map(open.chunks(TOGETHER), |open| {
            work.watch.time(|| {
                let shadow = |(place, own): &(usize, u32)| {
                    let point = DVec3::from(at.map(|axis| axis[*place]));
                    self.shadow(toward, point, *own)
                };
                open.iter().map(shadow).collect::<Vec<_>>()
            })
        });
        for ((place, _), shadow) in open.into_iter().zip(found.into_iter().flatten()) {
            shadows[place] = shadow;
        }
    }

    /// Returns the shadow on a point of a geometry, found by its ray alone.
    fn shadow(&self, toward: Toward, point: DVec3, own: u32) -> Shadow {
        let (ray, t_max) = (toward.ray(point), toward.t_max());
        match self.queries.transmission(&ray, t_max, own as usize) {
            Radiance::BLACK => Shadow::Dark,
            Radiance::WHITE => Shadow::Lit,
            _ => Shadow::Glass,
        }
    }
}

/// Returns a part of a row of samples.
fn row_of<'a>(hits: &'a Hits, rays: &'a Rays, row: usize, columns: Range<usize>) -> Row<'a> {
    let first = row * hits.columns.len();
    let places = first + columns.start..first + columns.end;
    let [x, y, z] = &rays.columns;
    Row {
        camera: rays.camera,
        columns: [x, y, z].map(|axis| &axis[columns.clone()]),
        row: rays.rows[row],
        ids: &hits.ids[places.clone()],
        t: &hits.t[places],
    }
}

/// The rows of a picture whose hits are known.
struct Part<'a, Q> {
    shading: &'a Shading<'a, Q>,
    hits: &'a Hits,
    rays: Rays<'a>,
    ink: Option<Ink<'a>>,
    /// For each light, its shadow on each sample; see [`Shadows`].
    shadows: Vec<Vec<Shadow>>,
    /// The hits of the rays through the centers of pixels.
    centers: &'a Hits,
    columns: &'a Range<u32>,
    work: Work<'a>,
}

impl<Q: Queries + Sync> Part<'_, Q> {
    /// Shades some rows of pixels.
    fn piece(&self, rows: Range<u32>) -> Piece {
        let geometries = self.shading.world.geometries().len();
        let mut piece = Piece::new(self.columns.len() as u32, rows.len() as u32, geometries);
        if self.work.resolver.ranks {
            self.rank(&rows, &mut piece);
        }
        let pixels = rows.clone().flat_map(|row| self.pixels(row));
        piece.light(match self.work.wanted {
            Wanted::Bytes(tone) => {
                let bytes = pixels.map(|pixel| tone.rgb8(pixel.direct + pixel.specular));
                Lit::Bytes(bytes.collect())
            }
            Wanted::Hits | Wanted::Light | Wanted::Parts => Lit::Light(pixels.collect()),
        });
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

    /// Sets the geometries that the samples of each pixel see.
    fn rank(&self, rows: &Range<u32>, piece: &mut Piece) {
        let side = self.shading.samples.side();
        let first = self.shading.world.geometries().len() as u32;
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

    /// Shades a row of pixels.
    fn pixels(&self, row: u32) -> impl Iterator<Item = LitPixel> + use<Q> {
        let side = self.shading.samples.side();
        let mut sums = vec![Sum::default(); self.columns.len()];
        // From the bottom, as the samples of a pixel are numbered.
        for row in (row * side..(row + 1) * side).rev() {
            self.add_row(row, &mut sums);
        }
        let count = f64::from(self.shading.samples.count());
        let is_transparent = self.work.resolver.is_transparent;
        sums.into_iter().map(move |sum| {
            let hits = f64::from(sum.hits);
            let shown = if is_transparent { hits } else { count };
            let mean = |sum: Radiance| if shown > 0.0 { sum / shown } else { sum };
            LitPixel {
                direct: mean(sum.direct),
                specular: mean(sum.specular),
                albedo: sum.albedo / count,
                coverage: hits / count,
            }
        })
    }

    /// Adds the light of a row of samples to the sums of its pixels.
    fn add_row(&self, row: u32, sums: &mut [Sum]) {
        let side = self.shading.samples.side() as usize;
        let columns = self.columns.start * side as u32..self.columns.end * side as u32;
        let mut lights = self.shade_row(row, columns.clone());
        if let Some(ink) = &self.ink {
            for (place, column) in columns.clone().enumerate() {
                if ink.covers(column, row) {
                    lights.set(place, Shaded::direct(ink.color()));
                }
            }
        }
        let first = self.hits.place(columns.start, row);
        let ids = self.hits.ids[first..].chunks_exact(side);
        let is_transparent = self.work.resolver.is_transparent;
        for ((sum, ids), start) in sums.iter_mut().zip(ids).zip((0..).step_by(side)) {
            for (id, place) in ids.iter().zip(start..) {
                let is_hit = *id != NOTHING;
                sum.hits += u32::from(is_hit);
                if is_hit || !is_transparent {
                    let [r, g, b] = &lights.direct;
                    sum.direct = sum.direct + Radiance::new(r[place], g[place], b[place]);
                }
                if let Some(specular) = lights.specular.get(place) {
                    sum.specular = sum.specular + *specular;
                }
                if self.work.wanted == Wanted::Parts {
                    sum.albedo = sum.albedo + self.shading.albedo(*id);
                }
            }
        }
    }

    /// Returns the light of some columns of a row of samples.
    fn shade_row(&self, row: u32, columns: Range<u32>) -> RowLight {
        let shading = self.shading;
        let (world, lighting) = (shading.world, shading.world.lighting());
        let first = self.hits.place(columns.start, row);
        let place = |column: u32| (column - self.hits.columns.start) as usize;
        let columns = place(columns.start)..place(columns.end);
        let row = (row - self.hits.rows.start) as usize;
        let count = columns.len();
        let mut lights = RowLight {
            direct: [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![0.0; count]),
            specular: Vec::new(),
        };
        let mut others = Vec::new();
        let [r, g, b] = &mut lights.direct;
        shading.isa.run(ShadeRow {
            world,
            lighting,
            row: row_of(self.hits, &self.rays, row, columns.clone()),
            shadows: &self
                .shadows
                .iter()
                .map(|shadows| shadows.get(first..first + count).unwrap_or_default())
                .collect::<Vec<_>>(),
            has_glass: true,
            light: [r, g, b],
            others: &mut others,
        });
        let Some(lighting) = lighting else {
            return lights;
        };
        let direct = Direct::new(world, lighting, shading.queries);
        for place in others {
            let ray = self.rays.ray(columns.start + place, row);
            let shadows = Shadows {
                of: &self.shadows,
                place: first + place,
            };
            let (id, t) = (self.hits.ids[first + place], self.hits.t[first + place]);
            lights.set(
                place,
                direct.shade(Path::new(ray, Some(shadows)), id as usize, t),
            );
        }
        lights
    }
}

/// The light of a row of samples.
struct RowLight {
    /// Red, green and blue.
    direct: [Vec<f64>; 3],
    /// Empty if there is none.
    specular: Vec<Radiance>,
}

impl RowLight {
    fn set(&mut self, place: usize, shaded: Shaded) {
        for (light, channel) in self.direct.iter_mut().zip(shaded.direct.channels) {
            light[place] = channel;
        }
        if self.specular.is_empty() && shaded.specular != Radiance::BLACK {
            self.specular = vec![Radiance::BLACK; self.direct[0].len()];
        }
        if let Some(specular) = self.specular.get_mut(place) {
            *specular = shaded.specular;
        }
    }
}
