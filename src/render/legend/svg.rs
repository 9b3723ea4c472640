//! A legend as SVG.

use std::fmt::Write;

use super::{Layout, Legend, MISSING};
use crate::{diagnostic::error::Error, tracer::color::Color};

impl Legend {
    /// Returns the legend as an SVG file. Its gradient has the colors of the map as stops, between
    /// which display values are interpolated as in a scene.
    ///
    /// # Errors
    ///
    /// A size without room for the text and the bar.
    pub fn svg(&self) -> Result<String, Error> {
        let layout = self.layout()?;
        let mut svg = String::new();
        // Writing to a string does not fail.
        let _ = self.write(&layout, &mut svg);
        Ok(svg)
    }

    fn write(&self, layout: &Layout, svg: &mut String) -> std::fmt::Result {
        let (width, height) = (layout.size.width(), layout.size.height());
        let (text, gap, margin) = (layout.text, layout.gap(), layout.margin());
        let [left, top, wide, high] = layout.bar;
        writeln!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"{}\">",
            text * 7 / 8
        )?;
        let end = if self.is_horizontal {
            "x2=\"1\" y2=\"0\""
        } else {
            "x2=\"0\" y2=\"0\""
        };
        let start = if self.is_horizontal {
            "x1=\"0\" y1=\"0\""
        } else {
            "x1=\"0\" y1=\"1\""
        };
        writeln!(svg, "<linearGradient id=\"map\" {start} {end}>")?;
        let colors = self.map.colors();
        let last = (colors.len() - 1).max(1) as f64;
        for (index, color) in colors.iter().enumerate() {
            let offset = index as f64 / last;
            let color = hex(*color);
            writeln!(svg, "<stop offset=\"{offset}\" stop-color=\"{color}\"/>")?;
        }
        writeln!(svg, "</linearGradient>")?;
        writeln!(
            svg,
            "<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"
        )?;
        // Letters stand on a line at four fifths of their height.
        let base = |top: u32| top + text * 4 / 5;
        if !self.label.is_empty() {
            let label = escaped(&self.label);
            writeln!(
                svg,
                "<text x=\"{margin}\" y=\"{}\">{label}</text>",
                base(margin)
            )?;
        }
        writeln!(
            svg,
            "<rect x=\"{left}\" y=\"{top}\" width=\"{wide}\" height=\"{high}\" fill=\"url(#map)\" \
             stroke=\"#000000\"/>"
        )?;
        for (place, label) in &layout.ticks {
            if self.is_horizontal {
                let (x, y) = (f64::from(left) + place, top + high);
                let end = y + gap / 2;
                writeln!(svg, "<path d=\"M{x} {y}V{end}\" stroke=\"#000000\"/>")?;
                let y = base(end);
                writeln!(
                    svg,
                    "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{label}</text>"
                )?;
            } else {
                let (x, y) = (left + wide, f64::from(top + high) - place);
                let end = x + gap / 2;
                writeln!(svg, "<path d=\"M{x} {y}H{end}\" stroke=\"#000000\"/>")?;
                let (x, y) = (x + gap, y + f64::from(base(0)) - f64::from(text) / 2.0);
                writeln!(svg, "<text x=\"{x}\" y=\"{y}\">{label}</text>")?;
            }
        }
        if let Some(([x, y, side], color)) = layout.missing {
            let color = hex(color);
            writeln!(
                svg,
                "<rect x=\"{x}\" y=\"{y}\" width=\"{side}\" height=\"{side}\" fill=\"{color}\" \
                 stroke=\"#000000\"/>"
            )?;
            let (x, y) = (x + side + gap, base(y));
            writeln!(svg, "<text x=\"{x}\" y=\"{y}\">{MISSING}</text>")?;
        }
        writeln!(svg, "</svg>")
    }
}

fn hex(color: Color) -> String {
    let [r, g, b] = color.to_rgb8();
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Replaces the characters that have a meaning in XML.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;")
}
