//! Limits on the differences between pictures.

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

fn at_least_0(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "expected a number of 0 or more".to_owned())
}

fn part_of_1(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (0.0..=1.0).contains(number));
    number.ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

impl Limits {
    /// Returns the name of each limit that was given, and true if the pictures meet it.
    fn check(&self, found: &Comparison) -> Vec<(&'static str, bool)> {
        let most = |name, most: Option<f64>, found: f64| most.map(|most| (name, found <= most));
        let least = |name, least: Option<f64>, found| least.map(|least| (name, least <= found));
        let different = self.max_different;
        let limits = [
            different.map(|most| ("max_different", most_different(found) <= most)),
            most("max_delta", self.max_delta, found.max_delta),
            least("min_psnr", self.min_psnr, found.psnr),
            least("min_ssim", self.min_ssim, found.ssim),
            most("max_flip", self.max_flip, found.flip),
        ];
        limits.into_iter().flatten().collect()
    }

    /// Returns the same for layers. Layers without a limit must be equal.
    fn check_layers(&self, found: &Comparison) -> Vec<(&'static str, bool)> {
        let all = |keeps: &dyn Fn(&LayerComparison) -> bool| found.layers.iter().all(keeps);
        if let (None, None) = (self.max_different, self.max_layer_delta) {
            return vec![("layers", all(&LayerComparison::is_equal))];
        }
        let delta = self.max_layer_delta;
        let delta = delta.map(|most| ("max_layer_delta", all(&|layer| layer.max_delta <= most)));
        let limits = [Some(("layers", all(&|layer| layer.in_both))), delta];
        limits.into_iter().flatten().collect()
    }

    /// Returns the names of the limits that the pictures exceed; without any limit, `equal` if they
    /// differ.
    pub(super) fn broken(&self, found: &Comparison) -> Vec<&'static str> {
        let mut checked = self.check(found);
        if checked.is_empty() && self.max_layer_delta.is_none() {
            checked.push(("equal", found.is_equal()));
        } else {
            checked.extend(self.check_layers(found));
        }
        let broken = checked.into_iter().filter(|(_, kept)| !kept);
        broken.map(|(name, _)| name).collect()
    }
}

/// Returns the number of pixels that differ in their colors, or in the layer where most differ, if
/// that is larger.
fn most_different(found: &Comparison) -> u64 {
    let layers = found.layers.iter().map(|layer| layer.different);
    layers.fold(found.different, u64::max)
}
