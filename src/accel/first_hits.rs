//! What every pixel of a picture sees.

use std::{iter, ops::Range};

use crate::{
    accel::{
        bins::{Bins, TILE},
        footprint::Region,
        planes::NumberedPlane,
        tile::Draw,
        view::{Grid, View},
    },
    error::Error,
    film::Size,
    parallel::{Cancel, OnProgress, Pool},
    simd::Isa,
    tracer::{camera::Camera, world::World},
};

/// How many columns of a row of tiles a thread draws before it looks for other work.
const STRETCH: usize = 32 * TILE as usize;

/// Finds, for each pixel of a picture, the geometry that it sees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FirstHits<'a> {
    view: View<'a>,
    world: &'a World,
    isa: Isa,
}

/// How and for whom work is done.
#[derive(Clone, Copy)]
pub(crate) struct Work<'a> {
    pub(crate) pool: &'a Pool,
    pub(crate) cancel: &'a Cancel,
    pub(crate) progress: Option<&'a OnProgress>,
}

/// Some rows of a picture, of which it is known which sphere may be seen where.
pub(crate) struct Slab {
    top: u32,
    strips: Vec<Strip>,
}

/// Some columns of a slab.
struct Strip {
    region: Region,
    /// `None` if that would take too much memory at once.
    prepared: Option<Prepared>,
}

struct Prepared {
    bins: Bins,
    grid: Grid,
    planes: Vec<NumberedPlane>,
}

impl<'a> FirstHits<'a> {
    pub(crate) fn new(camera: &'a Camera, world: &'a World, size: Size, isa: Isa) -> Self {
        Self {
            view: View::new(camera, size),
            world,
            isa,
        }
    }

    /// Prepares some rows of the picture, from the top: at most [`Region::MAX_SIDE`] of them.
    pub(crate) fn slab(&self, rows: Range<u32>, pool: &Pool) -> Slab {
        let width = self.view.size.width();
        let lefts = (0..width).step_by(Region::MAX_SIDE as usize);
        let strips = lefts.map(|left| {
            let region = Region {
                column: left,
                row: rows.start,
                width: (width - left).min(Region::MAX_SIDE),
                height: rows.end - rows.start,
            };
            Strip {
                region,
                prepared: self.prepare(region, pool),
            }
        });
        Slab {
            top: rows.start,
            strips: strips.collect(),
        }
    }

    /// Draws some rows of a slab, the first of which is a multiple of [`TILE`] below its top:
    /// for each pixel the index of the geometry that it sees.
    pub(crate) fn draw(
        &self,
        slab: &Slab,
        rows: Range<u32>,
        indices: &mut [u32],
        work: Work,
    ) -> Result<(), Error> {
        let mut rest: Vec<&mut [u32]> = indices
            .chunks_mut(self.view.size.width() as usize)
            .collect();
        for strip in &slab.strips {
            let pixels = take_columns(&mut rest, strip.region.width as usize);
            match &strip.prepared {
                Some(prepared) => {
                    let down = (rows.start - slab.top) / TILE;
                    self.draw_prepared(prepared, down, pixels, work)?;
                }
                None => {
                    let region = Region {
                        row: rows.start,
                        height: rows.end - rows.start,
                        ..strip.region
                    };
                    self.draw_region(region, pixels, work)?;
                }
            }
        }
        Ok(())
    }

    fn prepare(&self, region: Region, pool: &Pool) -> Option<Prepared> {
        let bins = Bins::new(&self.view, self.world, region, pool, self.isa)?;
        let eye = self.view.camera.eye();
        let geometries = self.world.geometries();
        let planes = bins
            .planes
            .iter()
            .filter_map(|index| NumberedPlane::new(*index, geometries.get(*index as usize)?, eye));
        Some(Prepared {
            planes: planes.collect(),
            grid: self.view.grid(region),
            bins,
        })
    }

    /// Draws a region in as many pieces as memory asks for.
    pub(super) fn draw_region(
        &self,
        region: Region,
        mut pixels: Vec<&mut [u32]>,
        work: Work,
    ) -> Result<(), Error> {
        if let Some(prepared) = self.prepare(region, work.pool) {
            return self.draw_prepared(&prepared, 0, pixels, work);
        }
        let half = |side: u32| (side / 2).next_multiple_of(TILE).min(side);
        let (mut first, mut second) = (region, region);
        let others = if region.width >= region.height {
            first.width = half(region.width);
            second.column += first.width;
            second.width -= first.width;
            let mut others = pixels;
            pixels = take_columns(&mut others, first.width as usize);
            others
        } else {
            first.height = half(region.height);
            second.row += first.height;
            second.height -= first.height;
            pixels.split_off(first.height as usize)
        };
        self.draw_region(first, pixels, work)?;
        self.draw_region(second, others, work)
    }

    /// Draws rows of tiles from the one that is `down` from the top of what is prepared.
    fn draw_prepared(
        &self,
        prepared: &Prepared,
        down: u32,
        pixels: Vec<&mut [u32]>,
        work: Work,
    ) -> Result<(), Error> {
        let mut stretches = Vec::new();
        let mut rows = pixels.into_iter().peekable();
        for down in down.. {
            if rows.peek().is_none() {
                break;
            }
            let mut rest: Vec<_> = rows.by_ref().take(TILE as usize).collect();
            let tiles = (0..).step_by(STRETCH / TILE as usize);
            let stretch = iter::from_fn(|| {
                let stretch = take_columns(&mut rest, STRETCH);
                (!stretch[0].is_empty()).then_some(stretch)
            });
            stretches.extend(tiles.zip(stretch).map(|(first, rows)| (down, first, rows)));
        }
        work.pool
            .fill(&mut stretches, 1, work.cancel, |_, stretch| {
                for (down, first, rows) in stretch {
                    let pixels = rows.iter().map(|row| row.len()).sum::<usize>();
                    let tiles = rows[0].len().div_ceil(TILE as usize) as u32;
                    self.isa.run(Draw {
                        view: &self.view,
                        world: self.world,
                        planes: &prepared.planes,
                        grid: &prepared.grid,
                        bins: &prepared.bins,
                        down: *down,
                        across: *first..*first + tiles,
                        rows,
                    });
                    if let Some(progress) = work.progress {
                        progress(pixels as u64);
                    }
                }
            })
    }
}

/// Takes so many columns off the left of some rows; fewer if there are not as many.
fn take_columns<'f>(rows: &mut [&'f mut [u32]], columns: usize) -> Vec<&'f mut [u32]> {
    let take = |row: &mut &'f mut [u32]| {
        let row_length = row.len();
        let (left, right) = std::mem::take(row).split_at_mut(columns.min(row_length));
        *row = right;
        left
    };
    rows.iter_mut().map(take).collect()
}
