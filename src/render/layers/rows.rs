//! The conversion of a band of a picture to the rows of a file.

use std::{array, ptr};

use crate::{
    film::{
        Film, LitPixel,
        colors::NOTHING,
        resolve::{PixelColor, Resolved},
        size::Size,
    },
    parallel::Pool,
    render::layers::{
        layout::Layout,
        number::{MATTES, Parts, Quantity, Spot},
    },
    tracer::{
        camera::Camera, color::Color, geometry::Geometry, hit::Hit, radiance::Radiance, tone::Tone,
        world::World,
    },
};

/// A converter from bands to the rows of a file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Painter<'a> {
    pub(crate) camera: &'a Camera,
    pub(crate) world: &'a World,
    /// The size of the whole picture.
    pub(crate) size: Size,
    /// The tone of a lit picture.
    pub(crate) tone: Tone,
    /// The color where nothing is hit; `None` if the background is transparent.
    pub(crate) background: Option<Color>,
    pub(crate) layout: &'a Layout,
    /// The Cryptomatte number of each geometry for [`Quantity::Matte`], if needed.
    pub(crate) mattes: &'a [f32],
}

impl Painter<'_> {
    /// Returns the bytes of each row of a band. `left` and `top` are the column and row of its top
    /// left pixel in the picture.
    pub(crate) fn rows(&self, film: &Film, left: u32, top: u32, pool: &Pool) -> Vec<Vec<u8>> {
        let rows = 0..film.height();
        pool.map(rows, |row| self.row(film, left, top, row))
    }

    fn row(&self, film: &Film, left: u32, top: u32, row: usize) -> Vec<u8> {
        let columns = &self.layout.parts;
        let mut bytes: Vec<Vec<u8>> = columns.iter().map(|_| Vec::new()).collect();
        let y = f64::from(self.size.height()) - 1.0 - f64::from(top + row as u32);
        let needs_place = self.layout.needs(|quantity| {
            use Quantity::{Normal, Position, Z};
            matches!(quantity, Z | Position(_) | Normal(_))
        });
        let needs_light = self
            .layout
            .needs(|quantity| matches!(quantity, Quantity::Light(..) | Quantity::Premultiplied(_)));
        let needs_display = self
            .layout
            .needs(|quantity| matches!(quantity, Quantity::Display(..)));
        let mut column = left;
        // Neighbors mostly show the same geometry.
        let mut flat = (NOTHING, self.flat(NOTHING, needs_light));
        for run in film.row(row) {
            // Neighbors that show the same geometry have equal numbers, except for the position of
            // the hit.
            let is_flat = run.t.is_empty() && ptr::eq(run.pixels, run.ids);
            let is_alike = |one: usize, other: usize| {
                if !run.light.is_empty() {
                    return false;
                }
                let is_same_hit = || {
                    run.ids[one] == run.ids[other]
                        && run.t.get(one) == run.t.get(other)
                        && (!needs_place || run.ids[one] == NOTHING)
                };
                run.pixels[one] == run.pixels[other] && (is_flat || is_same_hit())
            };
            let mut place = 0;
            while place < run.pixels.len() {
                let others = place + 1..run.pixels.len();
                let same = 1 + others.take_while(|other| is_alike(place, *other)).count();
                let (number, id) = (run.pixels[place], run.ids[place]);
                let resolved = run.resolved(number);
                let shown = resolved.unwrap_or_else(|| {
                    if flat.0 != number {
                        flat = (number, self.flat(number, needs_light));
                    }
                    &flat.1
                });
                let t = run.t.get(place).copied().unwrap_or(f64::INFINITY);
                let pixel = run.light.get(place);
                let lit = pixel.map(|pixel| self.lit(pixel, needs_display));
                let color = || match needs_display {
                    true => shown.color.color(),
                    false => Color::BLACK,
                };
                let (color, light, parts) =
                    lit.unwrap_or_else(|| (color(), shown.light, Parts::default()));
                let coverage = pixel.map_or(shown.coverage, |pixel| pixel.coverage);
                let spot = Spot {
                    color,
                    light,
                    parts,
                    alpha: pixel.map_or(coverage, LitPixel::alpha),
                    coverage,
                    id,
                    t,
                    hit: needs_place.then(|| self.hit(id, t, column, y)).flatten(),
                    mattes: self.mattes(number, resolved),
                };
                for (numbers, bytes) in columns.iter().zip(&mut bytes) {
                    let start = bytes.len();
                    numbers.iter().for_each(|number| number.write(&spot, bytes));
                    repeat(bytes, start, same);
                }
                column += same as u32;
                place += same;
            }
        }
        bytes.concat()
    }

    /// Returns the color, the light and the parts of a pixel of a lit picture.
    fn lit(&self, lit: &LitPixel, needs_display: bool) -> (Color, Radiance, Parts) {
        let LitPixel {
            parts,
            albedo,
            coverage,
            behind,
        } = *lit;
        let light = parts.sum();
        let color = if needs_display && behind < 1.0 {
            self.tone.color(light / (1.0 - behind))
        } else {
            Color::BLACK
        };
        let exposed = self.tone.expose(light);
        let whole = match self.background {
            Some(_) => exposed,
            None => exposed * coverage,
        };
        let parts = Parts {
            light: parts,
            albedo,
            tone: self.tone,
        };
        (color, whole, parts)
    }

    /// Returns the values of a pixel that shows only one geometry, or nothing.
    fn flat(&self, index: u32, needs_light: bool) -> Resolved {
        let geometry = self.world.with_id(index as usize);
        let behind = self.background.unwrap_or(Color::BLACK);
        let color = geometry.map_or(behind, Geometry::color);
        Resolved {
            light: if needs_light {
                color.to_linear()
            } else {
                Radiance::BLACK
            },
            color: PixelColor::Display(color),
            coverage: f64::from(u8::from(geometry.is_some())),
            ranks: Vec::new(),
        }
    }

    /// Returns the hit of a center ray at `t`, and its distance along the view axis.
    fn hit(&self, id: u32, t: f64, column: u32, y: f64) -> Option<(Hit<'_>, f64)> {
        let geometry = self.world.with_id(id as usize)?;
        let (width, height) = (self.size.width(), self.size.height());
        let ray = self.camera.ray_for(width, height, column.into(), y);
        let hit = geometry.hit_at(&ray, geometry.crossing_at(&ray, t));
        let z = (hit.point - self.camera.eye()).dot(-self.camera.w());
        Some((hit, z))
    }

    fn mattes(&self, index: u32, resolved: Option<&Resolved>) -> [(f32, f64); MATTES] {
        let matte = |index: u32| self.mattes.get(index as usize).copied();
        let Some(resolved) = resolved else {
            let whole = matte(index).map_or((0.0, 0.0), |matte| (matte, 1.0));
            return array::from_fn(|rank| if rank == 0 { whole } else { (0.0, 0.0) });
        };
        array::from_fn(|rank| match resolved.ranks.get(rank) {
            Some((index, part)) if *index != NOTHING => (matte(*index).unwrap_or(0.0), *part),
            _ => (0.0, 0.0),
        })
    }
}

/// Repeats the bytes from `start` on, so that they occur `times` times in total.
fn repeat(bytes: &mut Vec<u8>, start: usize, times: usize) {
    let end = start + (bytes.len() - start) * times;
    while bytes.len() < end {
        let more = (bytes.len() - start).min(end - bytes.len());
        bytes.extend_from_within(start..start + more);
    }
}
