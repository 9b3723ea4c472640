//! Comparison of two pictures: the figures, for people and for programs.

use std::{fmt::Write as _, path::Path};

use serde::Serialize;
use strahl::{
    Size,
    compare::{Comparison, LayerComparison, Picture},
    text::sanitize,
};

use super::{limits::Limits, row::Verdict};

/// The result for two pictures.
#[derive(Serialize)]
pub(super) struct Report {
    a: Side,
    b: Side,
    /// The limits that were exceeded, or `equal` or `size`.
    pub(super) failed: Vec<&'static str>,
    /// The figures, for pictures of the same size.
    found: Option<Measures>,
}

#[derive(Serialize)]
struct Side {
    file: String,
    #[serde(flatten)]
    size: Size,
}

impl Side {
    fn new(path: &Path, picture: &Picture) -> Self {
        Self {
            file: path.to_string_lossy().into_owned(),
            size: picture.size(),
        }
    }
}

/// The figures. Numbers that are not finite become null.
#[derive(Serialize)]
struct Measures {
    equal: bool,
    values: &'static str,
    pixels: u64,
    #[serde(flatten)]
    all: Comparison,
}

impl Measures {
    fn new(found: Comparison) -> Self {
        Self {
            equal: found.is_equal(),
            values: if found.is_linear { "linear" } else { "display" },
            pixels: found.size.pixels(),
            all: found,
        }
    }

    fn write(&self, text: &mut String) {
        let Self { pixels, all, .. } = self;
        let percent = all.different as f64 / *pixels as f64 * 100.0;
        let share = if all.different > 0 && percent < 0.01 {
            "less than 0.01 %".to_owned()
        } else {
            format!("{percent:.2} %")
        };
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "{name:<11} {value}");
        };
        for layer in &all.layers {
            line(&format!("layer {}", sanitize(&layer.name)), about(layer));
        }
        if !all.has_colors {
            return;
        }
        line("values", format!("{}, 0 to 255", self.values));
        line(
            "different",
            format!("{} of {pixels} pixels, {share}", all.different),
        );
        if all.not_finite > 0 {
            line("not finite", format!("{} of these", all.not_finite));
        }
        if let Some([column, row]) = all.first {
            line(
                "first",
                format!("{column},{row} (column and row from the top left)"),
            );
        }
        if let Some([x, y, width, height]) = all.bounds {
            line(
                "within",
                format!("{x},{y},{width},{height} (X,Y,W,H from the top left)"),
            );
        }
        line("largest", amount(all.max_delta));
        line("mean", amount(all.mean_delta));
        line("PSNR", format!("{} dB", amount(all.psnr)));
        line("SSIM", amount(all.ssim));
        line("FLIP", amount(all.flip));
    }
}

fn about(layer: &LayerComparison) -> String {
    if !layer.in_both {
        return "missing in one picture, or of another shape".to_owned();
    }
    let most = amount(layer.max_delta);
    format!("{} pixels differ, largest {most}", layer.different)
}

/// Returns a number in a form for people.
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
        found: Option<Comparison>,
        limits: &Limits,
    ) -> Self {
        Self {
            a: Side::new(a_path, a),
            b: Side::new(b_path, b),
            failed: match &found {
                Some(found) => limits.broken(found),
                None => vec!["size"],
            },
            found: found.map(Measures::new),
        }
    }

    pub(super) fn kind(&self) -> Verdict {
        match &self.found {
            Some(found) if self.failed.is_empty() && found.equal => Verdict::Equal,
            Some(_) if self.failed.is_empty() => Verdict::WithinLimits,
            _ => Verdict::Different,
        }
    }

    fn sizes(&self) -> [String; 2] {
        [&self.a, &self.b].map(|side| side.size.to_string())
    }

    /// Returns the limits that were exceeded, as options.
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

    /// Returns the most important figures on one line.
    pub(super) fn line(&self) -> String {
        let Some(found) = &self.found else {
            let [a, b] = self.sizes();
            return format!("the sizes differ: {a} and {b}");
        };
        let (pixels, found) = (found.pixels, &found.all);
        let colors = found.has_colors.then(|| {
            format!(
                "{} of {pixels} pixels, largest {}, mean {:.3}, SSIM {:.4}, FLIP {:.4}",
                found.different,
                amount(found.max_delta),
                found.mean_delta,
                found.ssim,
                found.flip
            )
        });
        let layers = found.layers.iter().filter(|layer| !layer.is_equal());
        let layers =
            layers.map(|layer| format!("layer {}: {}", sanitize(&layer.name), about(layer)));
        let parts: Vec<_> = colors.into_iter().chain(layers).collect();
        parts.join(", ") + &self.beyond()
    }

    /// Returns all figures, for people.
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
