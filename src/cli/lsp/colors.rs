//! Color swatches, and the texts of a picked color.

use lsp_types::{
    ColorInformation, ColorPresentation, ColorPresentationParams, DocumentColorParams, TextEdit,
};
use strahl::{Color, scene::Source};

use super::{document::Snapshot, work::Result};

/// The most colors that are sent: editors show fewer.
const MOST: usize = 5000;

pub(super) fn all(
    snapshot: &Snapshot,
    _params: DocumentColorParams,
) -> Result<Vec<ColorInformation>> {
    let places = snapshot.places();
    let source = snapshot.text.source();
    let colors = source.colors(0..source.text().len(), MOST).into_iter();
    let colors = colors.map(|place| {
        // The picker has no more than these.
        let [red, green, blue] = place.color.to_rgb8().map(|byte| f32::from(byte) / 255.0);
        ColorInformation {
            range: places.range(&place.range),
            color: lsp_types::Color {
                red,
                green,
                blue,
                alpha: 1.0,
            },
        }
    });
    Ok(colors.collect())
}

pub(super) fn presentations(
    snapshot: &Snapshot,
    params: ColorPresentationParams,
) -> Result<Vec<ColorPresentation>> {
    let places = snapshot.places();
    let lsp_types::Color {
        red, green, blue, ..
    } = params.color;
    let color = Color::new(red.into(), green.into(), blue.into());
    let mut texts = Source::color_texts(color, snapshot.text.syntax());
    // The form that the text has comes first: an editor uses it.
    let old = snapshot
        .text
        .as_str()
        .get(places.offsets(params.range))
        .unwrap_or_default();
    if !old.trim_start().starts_with('"') {
        texts.reverse();
    }
    let presentations = texts.into_iter().map(|text| ColorPresentation {
        label: text.clone(),
        text_edit: Some(TextEdit::new(params.range, text)),
        additional_text_edits: None,
    });
    Ok(presentations.collect())
}
