//! Two pictures: the numbers of how they differ, for people and for programs.

use std::{fmt::Write as _, path::Path};

use serde::Serialize;
use strahl::{
    compare::{Comparison, LayerComparison, Picture},
    text::sanitize,
};

use super::limits::Limits;

/// What was found of two pictures.
#[derive(Serialize)]
pub(super) struct Report {
    a: Side,
    b: Side,
    /// The limits that were not kept, or `equal` or `size`.
    pub(super) failed: Vec<&'static str>,
    /// What there is to say of pictures of one size.
    found: Option<Found>,
}

#[derive(Serialize)]
struct Side {
    file: String,
    width: u32,
    height: u32,
}

impl Side {
    fn new(path: &Path, picture: &Picture) -> Self {
        Self {
            file: path.to_string_lossy().into_owned(),
            width: picture.size().width(),
            height: picture.size().height(),
        }
    }
}

/// Numbers that are not finite become null.
#[derive(Serialize)]
struct Found {
    equal: bool,
    values: &'static str,
    pixels: u64,
    different: u64,
    not_finite: u64,
    first: Option<[u32; 2]>,
    bounds: Option<[u32; 4]>,
    max_delta: f64,
    mean_delta: f64,
    psnr: f64,
    ssim: f64,
    flip: f64,
    has_colors: bool,
    layers: Vec<Layer>,
}

#[derive(Serialize)]
struct Layer {
    name: String,
    in_both: bool,
    different: u64,
    max_delta: f64,
}

impl Layer {
    fn new(found: &LayerComparison) -> Self {
        Self {
            name: found.name.clone(),
            in_both: found.in_both,
            different: found.different,
            max_delta: found.max_delta,
        }
    }

    fn to_text(&self) -> String {
        if !self.in_both {
            return "not in both, or of another shape".to_owned();
        }
        let most = amount(self.max_delta);
        format!("{} pixels differ, largest {most}", self.different)
    }

    fn differs(&self) -> bool {
        !self.in_both || self.different > 0
    }
}

impl Found {
    fn new(found: &Comparison) -> Self {
        Self {
            equal: found.is_equal(),
            values: if found.is_linear { "linear" } else { "display" },
            pixels: found.size.pixels(),
            different: found.different,
            not_finite: found.not_finite,
            first: found.first,
            bounds: found.bounds,
            max_delta: found.max_delta,
            mean_delta: found.mean_delta,
            psnr: found.psnr,
            ssim: found.ssim,
            flip: found.flip,
            has_colors: found.has_colors,
            layers: found.layers.iter().map(Layer::new).collect(),
        }
    }

    fn write(&self, text: &mut String) {
        let percent = self.different as f64 / self.pixels as f64 * 100.0;
        let share = if self.different > 0 && percent < 0.01 {
            "less than 0.01 %".to_owned()
        } else {
            format!("{percent:.2} %")
        };
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "{name:<11} {value}");
        };
        for layer in &self.layers {
            line(&format!("layer {}", sanitize(&layer.name)), layer.to_text());
        }
        if !self.has_colors {
            return;
        }
        line("values", format!("{}, 0 to 255", self.values));
        line(
            "different",
            format!("{} of {} pixels, {share}", self.different, self.pixels),
        );
        if self.not_finite > 0 {
            line("not finite", format!("{} of these", self.not_finite));
        }
        if let Some([column, row]) = self.first {
            line(
                "first",
                format!("{column},{row} (column and row from the top left)"),
            );
        }
        if let Some([x, y, width, height]) = self.bounds {
            line(
                "within",
                format!("{x},{y},{width},{height} (X,Y,W,H from the top left)"),
            );
        }
        line("largest", amount(self.max_delta));
        line("mean", amount(self.mean_delta));
        line("PSNR", format!("{} dB", amount(self.psnr)));
        line("SSIM", amount(self.ssim));
        line("FLIP", amount(self.flip));
    }
}

/// A number for people.
fn amount(number: f64) -> String {
    if number == f64::INFINITY {
        "infinite".to_owned()
    } else if number == f64::NEG_INFINITY {
        "-infinite".to_owned()
    } else {
        number.to_string()
    }
}

impl Report {
    pub(super) fn new(
        (a_path, a): (&Path, &Picture),
        (b_path, b): (&Path, &Picture),
        found: Option<&Comparison>,
        limits: &Limits,
    ) -> Self {
        Self {
            a: Side::new(a_path, a),
            b: Side::new(b_path, b),
            failed: found.map_or_else(|| vec!["size"], |found| limits.broken(found)),
            found: found.map(Found::new),
        }
    }

    /// Whether nothing differs at all.
    pub(super) fn is_equal(&self) -> bool {
        self.found.as_ref().is_some_and(|found| found.equal)
    }

    fn sizes(&self) -> [String; 2] {
        [&self.a, &self.b].map(|side| format!("{}x{}", side.width, side.height))
    }

    /// The limits that were not kept, as options.
    fn beyond(&self) -> String {
        match &*self.failed {
            [] => ", within the limits".to_owned(),
            ["equal" | "size" | "layers"] => String::new(),
            failed => {
                let names = failed.iter();
                let names = names.map(|name| match *name {
                    "layers" => "equal layers".to_owned(),
                    name => format!("--{}", name.replace('_', "-")),
                });
                let names: Vec<_> = names.collect();
                format!(", beyond {}", names.join(", "))
            }
        }
    }

    /// The most telling numbers in one line.
    pub(super) fn line(&self) -> String {
        let Some(found) = &self.found else {
            let [a, b] = self.sizes();
            return format!("the sizes differ: {a} and {b}");
        };
        let colors = found.has_colors.then(|| {
            format!(
                "{} of {} pixels, largest {}, mean {:.3}, SSIM {:.4}, FLIP {:.4}",
                found.different,
                found.pixels,
                amount(found.max_delta),
                found.mean_delta,
                found.ssim,
                found.flip
            )
        });
        let layers = found.layers.iter().filter(|layer| layer.differs());
        let layers =
            layers.map(|layer| format!("layer {}: {}", sanitize(&layer.name), layer.to_text()));
        let parts: Vec<_> = colors.into_iter().chain(layers).collect();
        parts.join(", ") + &self.beyond()
    }

    /// Everything, for people.
    pub(super) fn to_text(&self) -> String {
        let mut text = String::new();
        let [a, b] = self.sizes();
        let Some(found) = &self.found else {
            return format!(
                "size        {a} and {b}\n\nthe sizes differ, so nothing else is compared\n"
            );
        };
        let _ = writeln!(text, "size        {a}");
        found.write(&mut text);
        let verdict = if found.equal {
            "equal".to_owned()
        } else {
            format!("different{}", self.beyond())
        };
        let _ = writeln!(text, "\n{verdict}");
        text
    }
}
