//! Rejection of options that have no effect on any output file.

use std::cell::LazyCell;

use crate::{
    diagnostic::error::Error,
    film::colors::{self, ColorTable},
    image_file::{
        ImageFormat, Palette,
        pixel::{Pixel, Sample},
    },
    pipeline::{Scene, options::RenderOptions},
    render::layers::{
        Layer,
        layout::{Layout, Settings},
    },
};

impl Scene {
    /// Rejects options without effect on any file of a picture; `files` has the layers of each
    /// file.
    pub(super) fn check_effects<'l>(
        &self,
        format: ImageFormat,
        files: impl Iterator<Item = &'l [Layer]> + Clone,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        if options.palette == Palette::Auto && format.has_palette() && self.mixes_colors() {
            let message = format!("--palette auto is for flat pictures: {MIXED}; leave it out");
            return Err(Error::refused(message));
        }
        let layouts = |settings: Settings| -> Vec<_> {
            let layouts = files.clone().map(|layers| {
                let layout = self.layout(format, layers, settings);
                layout.ok().map(|layout| format!("{layout:?}"))
            });
            layouts.collect()
        };
        let given = options.settings;
        // A setting without a valid layout says nothing about the effect.
        let is_moot = |changed: &[Settings]| {
            let changed: Vec<_> = changed.iter().map(|settings| layouts(*settings)).collect();
            (0..files.clone().count()).all(|file| {
                let mut of_file = changed
                    .iter()
                    .filter_map(|layouts| layouts.get(file)?.as_ref());
                let first = of_file.next();
                of_file.all(|other| Some(other) == first)
            })
        };
        let with_bits = |bits| Settings {
            bits: Some(bits),
            ..given
        };
        let opaque = Settings {
            is_transparent: false,
            ..given
        };
        let with_range = |depth_range| Settings {
            depth_range,
            ..given
        };
        let moot = [
            (
                given.bits.is_some() && is_moot(&[8, 16, 32].map(with_bits)),
                "bits",
                "have no choice of bits",
            ),
            (
                given.is_transparent && is_moot(&[given, opaque]),
                "transparent",
                "have no alpha",
            ),
            (
                given.depth_range.is_some()
                    && is_moot(&[given, with_range(None)])
                    && is_moot(&[given, with_range(Some((-1.0, 1.5)))]),
                "depth-range",
                "hold no depths as integers",
            ),
        ];
        match moot.iter().find(|(is_moot, ..)| *is_moot) {
            Some((_, option, why)) => {
                let names = files.flatten().map(|layer| layer.name());
                let names: Vec<_> = names.collect();
                let of = match &*names {
                    [] => String::new(),
                    names => format!(" of {}", names.join(", ")),
                };
                let format = format.name();
                let message = format!("--{option} has no effect: {format} files{of} {why}");
                Err(Error::refused(message))
            }
            None => Ok(()),
        }
    }

    /// Returns true if pixels have colors that are not those of geometries, even with one sample
    /// each.
    pub(super) fn mixes_colors(&self) -> bool {
        !self.world.is_plain() || self.outlines.is_some()
    }

    /// Returns the reason why a PNG file is not indexed although [`Palette::Auto`] is set,
    /// unless that is an error.
    pub fn unindexed(&self, options: &RenderOptions) -> Option<&'static str> {
        if options.palette != Palette::Auto || self.mixes_colors() {
            return None;
        }
        let layout = self.layout(ImageFormat::PNG, &options.layers, options.settings);
        let table = LazyCell::new(|| ColorTable::rgb8(&self.world));
        match layout {
            Ok(layout) => self.palette(&layout, options, || &table).err(),
            Err(_) => Some(PLAIN),
        }
    }

    /// Returns the palette of a PNG file, or the reason why it cannot have one.
    pub(super) fn palette<'t>(
        &self,
        layout: &Layout,
        options: &RenderOptions,
        table: impl FnOnce() -> &'t ColorTable<3>,
    ) -> Result<colors::Palette, &'static str> {
        if !(layout.is_color && layout.pixel() == Pixel::Rgb(Sample::U8)) {
            return Err(PLAIN);
        }
        if self.mixes_colors() {
            return Err(MIXED);
        }
        if options.samples.unwrap_or(self.samples()).count() != 1 {
            return Err("several samples per pixel mix its colors");
        }
        colors::Palette::of(table()).ok_or("background and geometries have more than 256 colors")
    }
}

const MIXED: &str = "light, outlines, backdrops and geometries of several materials give pixels colors of their own";
const PLAIN: &str = "only colors of 8 bits without alpha have a palette";
