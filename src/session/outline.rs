//! The outline of a geometry over a picture.

use std::ops::Range;

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        self,
        pixel::{Pixel, Sample},
    },
    pipeline::{Scene, options::RenderOptions},
};

/// Red, green, blue and alpha of the pixels inside of the edge and outside of it: one of the two is
/// visible on any color.
const INSIDE: [u8; 4] = [255, 255, 255, 255];
const OUTSIDE: [u8; 4] = [255, 0, 110, 255];
const CLEAR: [u8; 4] = [0; 4];

/// Returns a PNG file, transparent except for the edge of these geometries; `None` if no pixel
/// shows them. They are given by their indices in the world.
pub(super) fn outline(
    scene: &Scene,
    size: Size,
    geometries: &Range<usize>,
    options: &RenderOptions,
) -> Result<Option<Vec<u8>>, Error> {
    let mask = scene.mask(geometries, options)?;
    if !mask.contains(&true) {
        return Ok(None);
    }
    let width = size.width() as usize;
    let mut file = Vec::new();
    image_file::to_png(&mut file, size, Pixel::Rgba(Sample::U8), |sink| {
        (0..size.height() as usize).try_for_each(|y| {
            let row: Vec<_> = (0..width).map(|x| color(&mask, width, x, y)).collect();
            sink(row.as_flattened())
        })
    })?;
    Ok(Some(file))
}

/// Returns the color of a pixel: none, unless one of its neighbors is on the other side of the
/// edge.
fn color(mask: &[bool], width: usize, x: usize, y: usize) -> [u8; 4] {
    let at = |x: Option<usize>, y: Option<usize>| {
        let (x, y) = (x?, y?);
        (x < width).then(|| mask.get(y * width + x).copied())?
    };
    let here = at(Some(x), Some(y)).unwrap_or_default();
    let rows = [y.checked_sub(1), Some(y), Some(y + 1)];
    let columns = [x.checked_sub(1), Some(x), Some(x + 1)];
    let mut around = rows
        .into_iter()
        .flat_map(|y| columns.into_iter().filter_map(move |x| at(x, y)));
    match around.any(|other| other != here) {
        true if here => INSIDE,
        true => OUTSIDE,
        false => CLEAR,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_of_the_edge_are_drawn() {
        // A square of two pixels in the corner of a picture of four.
        let mask: Vec<bool> = (0..16).map(|at| at % 4 < 2 && at / 4 < 2).collect();
        let row = |y| (0..4).map(|x| color(&mask, 4, x, y)).collect::<Vec<_>>();
        assert_eq!(row(0), [CLEAR, INSIDE, OUTSIDE, CLEAR]);
        assert_eq!(row(1), [INSIDE, INSIDE, OUTSIDE, CLEAR]);
        assert_eq!(row(2), [OUTSIDE, OUTSIDE, OUTSIDE, CLEAR]);
        assert_eq!(row(3), [CLEAR; 4]);
    }
}
