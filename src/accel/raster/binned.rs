//! The shapes of a region, in bins of which frames share one.

use std::sync::Arc;

use crate::accel::{
    bvh::build::Builder,
    index::index_shapes,
    kept::{WorldOfFrame, built},
    raster::{
        bins::{Bins, Layout, TileRow},
        footprint::Region,
        view::RasterView,
    },
};

/// The shapes of a region, in bins of which frames share one.
pub(super) struct Binned {
    bins: Vec<Arc<Bins>>,
    pub(super) region: Region,
    pub(super) layout: Layout,
}

impl Binned {
    /// Bins all geometries that a region sees; `None` as [`Bins::new`].
    pub(super) fn new(
        view: &RasterView,
        world: WorldOfFrame,
        region: Region,
        builder: Builder<'_>,
    ) -> Option<Self> {
        let key = view.key(region);
        let bins = built(
            world,
            |kept| &kept.bins,
            key,
            builder.cancel,
            |runs, _| {
                let bins = Bins::new(view, world.0, runs, region, builder)?;
                index_shapes(bins.seen(world.0), builder);
                Some(bins)
            },
        )?;
        Some(Self {
            bins,
            region,
            layout: Layout::new(world.0.geometries().len()),
        })
    }

    /// Returns the geometries that are planes, in ascending order.
    pub(super) fn planes(&self) -> Vec<u32> {
        let planes = self.bins.iter().flat_map(|bins| &bins.planes);
        let mut planes: Vec<_> = planes.copied().collect();
        planes.sort_unstable();
        planes
    }

    /// Prepares a later row of tiles; see [`Bins::look_ahead`].
    pub(super) fn look_ahead(&self, down: u32) {
        self.bins.iter().for_each(|bins| bins.look_ahead(down));
    }

    /// Returns a row of tiles, counted from the top of the region.
    pub(super) fn row(&self, down: u32) -> TileRows<'_> {
        TileRows(self.bins.iter().map(|bins| bins.row(down)).collect())
    }
}

/// A row of tiles in all bins.
pub(super) struct TileRows<'a>(Vec<TileRow<'a>>);

impl TileRows<'_> {
    /// Sets `entries` to those of a tile, counted from the left of the region.
    pub(super) fn read(&self, across: u32, entries: &mut Vec<u64>) {
        entries.clear();
        let rows = self.0.iter();
        rows.for_each(|row| entries.extend_from_slice(row.entries(across)));
    }
}
