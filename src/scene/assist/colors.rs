//! The colors of a text.

use std::ops::Range;

use super::spot::Finder;
use crate::{
    scene::{
        assist::completion::ColorPlace,
        format::{animation::CHANGING, color::ColorModel, field::FieldKind},
    },
    text::syntax::{self, NodeId, NodeKind, Syntax, Tree},
    tracer::color::Color,
};

/// Returns the first colors in a range of a text, at most this many, in its order.
pub(crate) fn colors(
    text: &str,
    tree: &Tree,
    within: &Range<usize>,
    most: usize,
) -> Vec<ColorPlace> {
    let finder = Finder { text, tree };
    let mut found = Vec::new();
    // A struct comes before the strings in it, of which there are fewer than this.
    const AHEAD: usize = 100;
    let enough = most.saturating_add(AHEAD);
    for id in tree.ids() {
        if found.len() > enough {
            break;
        }
        let node = tree.node(id);
        let range = node.range();
        if range.end < within.start || range.start > within.end {
            continue;
        }
        match node.kind() {
            NodeKind::String => {
                let color = of_string(text.get(range.clone()).unwrap_or_default());
                found.extend(color.map(|color| ColorPlace {
                    range,
                    color,
                    is_string: true,
                }));
            }
            NodeKind::Struct | NodeKind::Map => {
                let values = tree.fields(id).filter_map(|(key, value)| {
                    // Names are only looked up in front of three numbers.
                    let color = of_numbers(&finder, value)?;
                    let is_color = is_color(&finder.name(key));
                    is_color.then(|| ColorPlace {
                        range: tree.node(value).range(),
                        color,
                        is_string: false,
                    })
                });
                found.extend(values);
            }
            _ => {}
        }
    }
    found.sort_by_key(|place| place.range.start);
    found.truncate(most);
    found
}

/// Returns the ways to write a color, with 8 bits for each channel: a string, and three numbers.
pub(crate) fn texts(color: Color, syntax: Syntax) -> [String; 2] {
    let bytes = color.to_rgb8();
    let [r, g, b] = bytes;
    // Three decimals tell 256 values apart.
    let numbers = bytes.map(|byte| {
        let number = format!("{:.3}", f64::from(byte) / 255.0);
        let short = number.trim_end_matches('0').trim_end_matches('.');
        short.to_owned()
    });
    let numbers = syntax.tuple(&numbers.join(", "));
    [format!("\"#{r:02x}{g:02x}{b:02x}\""), numbers]
}

/// Returns the color that a string is, quotes included.
pub(super) fn of_string(token: &str) -> Option<Color> {
    let hex = token.strip_prefix('"')?.strip_suffix('"')?;
    match ColorModel::parse(hex.strip_prefix('#').map(|_| hex)?) {
        color @ ColorModel::Hex(_) => Some(color.build()),
        _ => None,
    }
}

fn of_numbers(finder: &Finder, id: NodeId) -> Option<Color> {
    let kind = finder.tree.node(id).kind();
    if !matches!(kind, NodeKind::Tuple | NodeKind::List) {
        return None;
    }
    let mut numbers = finder.tree.children(id).map(|item| {
        let token = finder.text.get(finder.tree.node(item).range())?;
        syntax::float(token, finder.tree.syntax()).ok()
    });
    let (r, g, b) = (numbers.next()??, numbers.next()??, numbers.next()??);
    let is_finite = [r, g, b].iter().all(|number| number.is_finite());
    (numbers.next().is_none() && is_finite).then(|| Color::new(r, g, b))
}

/// Returns true for the name of a field that is a color.
fn is_color(name: &str) -> bool {
    let mut fields = CHANGING.iter().flat_map(|(_, fields)| fields);
    fields.any(|field| field.kind == FieldKind::Color && field.name == name)
}
