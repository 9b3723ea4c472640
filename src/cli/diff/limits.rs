//! Limits on the differences between pictures.

use std::ops::Range;

use strahl::compare::{Comparison, LayerComparison};

/// The limits on the differences between pictures.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct Limits {
    /// Maximum number of different pixels
    #[arg(long, value_name = "N")]
    max_different: Option<u64>,
    /// Maximum difference of a channel, in 8-bit steps: 255 is black against white
    #[arg(long, value_name = "STEPS", value_parser = at_least_0)]
    max_delta: Option<f64>,
    /// Maximum difference of a number in a layer, such as a depth, in its own unit
    #[arg(long, value_name = "AMOUNT", value_parser = at_least_0)]
    max_layer_delta: Option<f64>,
    /// Minimum peak signal-to-noise ratio, in decibels
    #[arg(long, value_name = "DB", value_parser = at_least_0)]
    min_psnr: Option<f64>,
    /// Minimum mean structural similarity, from 0 to 1
    #[arg(long, value_name = "SSIM", value_parser = part_of_1)]
    min_ssim: Option<f64>,
    /// Maximum mean FLIP error, from 0 to 1
    #[arg(long, value_name = "FLIP", value_parser = part_of_1)]
    max_flip: Option<f64>,
}

fn at_least_0(text: &str) -> Result<f64, &'static str> {
    number(text, 0.0..f64::INFINITY).ok_or("expected a number of 0 or more")
}

fn part_of_1(text: &str) -> Result<f64, &'static str> {
    number(text, 0.0..1.0_f64.next_up()).ok_or("expected a number from 0 to 1")
}

fn number(text: &str, range: Range<f64>) -> Option<f64> {
    text.parse().ok().filter(|number| range.contains(number))
}

impl Limits {
    /// Returns the names of the limits that the pictures exceed; without any limit, `equal` if they
    /// differ. Layers without a limit must be equal.
    pub(super) fn broken(&self, found: &Comparison) -> Vec<&'static str> {
        let delta = self.max_layer_delta;
        let limits = [
            (
                "max_different",
                self.max_different.map(|most| most_different(found) <= most),
            ),
            (
                "max_delta",
                self.max_delta.map(|most| found.max_delta <= most),
            ),
            ("min_psnr", self.min_psnr.map(|least| least <= found.psnr)),
            ("min_ssim", self.min_ssim.map(|least| least <= found.ssim)),
            ("max_flip", self.max_flip.map(|most| found.flip <= most)),
        ];
        let layers = |keeps: &dyn Fn(&LayerComparison) -> bool| found.layers.iter().all(keeps);
        let rest = if delta.is_none() && limits.iter().all(|(_, kept)| kept.is_none()) {
            [("equal", Some(found.is_equal())), ("", None)]
        } else if delta.is_none() && self.max_different.is_none() {
            [
                ("layers", Some(layers(&LayerComparison::is_equal))),
                ("", None),
            ]
        } else {
            let kept = delta.map(|most| layers(&|layer| layer.max_delta <= most));
            [
                ("layers", Some(layers(&|layer| layer.in_both))),
                ("max_layer_delta", kept),
            ]
        };
        let all = limits.into_iter().chain(rest);
        let broken = all.filter(|(_, kept)| *kept == Some(false));
        broken.map(|(name, _)| name).collect()
    }
}

/// Returns the number of pixels that differ in their colors, or in the layer where most differ, if
/// that is larger.
fn most_different(found: &Comparison) -> u64 {
    let layers = found.layers.iter().map(|layer| layer.different);
    layers.fold(found.different, u64::max)
}
