//! A picture as light.

use std::sync::Arc;

use crate::tracer::{error::GeometryError, radiance::Radiance};

/// A picture of linear light, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Texels {
    width: u32,
    height: u32,
    light: Arc<Vec<[f32; 3]>>,
    /// The largest channel of all pixels.
    brightest: f32,
}

/// The continuation of a picture beyond its border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TexelWrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The pixels at its border.
    Clamp,
}

impl Texels {
    /// Creates a picture from the linear light of red, green and blue of each pixel.
    ///
    /// # Errors
    ///
    /// Returns an error if there is no pixel, if their number is not `width` · `height`, or if light is below
    /// 0, infinite or NaN.
    pub fn new(width: u32, height: u32, light: Vec<[f32; 3]>) -> Result<Self, GeometryError> {
        let (found, expected) = (light.len() as u64, u64::from(width) * u64::from(height));
        if found != expected || found == 0 {
            return Err(GeometryError::TexelCount {
                width,
                height,
                found,
            });
        }
        let is_wrong = |channel: &f32| !(*channel >= 0.0 && channel.is_finite());
        let all = light.as_flattened();
        if let Some(place) = all.iter().position(is_wrong) {
            let pixel = (place / 3) as u64;
            return Err(GeometryError::Texel {
                column: (pixel % u64::from(width)) as u32,
                row: (pixel / u64::from(width)) as u32,
                value: all[place].into(),
            });
        }
        Ok(Self {
            width,
            height,
            brightest: all.iter().copied().fold(0.0, f32::max),
            light: Arc::new(light),
        })
    }

    /// The number of pixels in a row.
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// The number of rows.
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// The largest channel of all pixels.
    pub(crate) const fn brightest(&self) -> f64 {
        self.brightest as f64
    }

    /// Returns the light of a pixel, counted from the top left.
    pub(crate) fn at(&self, column: u32, row: u32) -> Radiance {
        let [r, g, b] = self.light[self.place(column, row)];
        Radiance::new(r.into(), g.into(), b.into())
    }

    fn place(&self, column: u32, row: u32) -> usize {
        row as usize * self.width as usize + column as usize
    }

    /// Returns the light at a place in pixels from the top left, which blends between the centers of four.
    pub(crate) fn blended(&self, [x, y]: [f64; 2], wraps: [TexelWrap; 2]) -> Radiance {
        let ([left, right], across) = between(x);
        let columns = [left, right].map(|column| wraps[0].within(column, self.width));
        let ([above, below], down) = between(y);
        let rows = [above, below].map(|row| wraps[1].within(row, self.height));
        let [above, below] = rows.map(|row| {
            let [one, other] = columns.map(|column| self.at(column, row));
            one + (other - one) * across
        });
        above + (below - above) * down
    }

    /// Returns the light of the pixel at a place from the top left.
    pub(crate) fn nearest(&self, [x, y]: [f64; 2], wrap: TexelWrap) -> Radiance {
        let column = wrap.within(x.floor(), self.width);
        self.at(column, wrap.within(y.floor(), self.height))
    }

    /// Returns all numbers.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let light = Arc::clone(&self.light);
        let channels = (0..light.len()).flat_map(move |pixel| light[pixel].map(f64::from));
        [self.width, self.height]
            .map(f64::from)
            .into_iter()
            .chain(channels)
    }
}

impl TexelWrap {
    /// Returns the pixel that stands for a whole number of one.
    fn within(self, number: f64, count: u32) -> u32 {
        let count = f64::from(count);
        let within = match self {
            Self::Repeat => number.rem_euclid(count),
            Self::Clamp => number,
        };
        // What is so far away that it has no place is at an end.
        within.clamp(0.0, count - 1.0) as u32
    }
}

/// Returns the numbers of the pixels whose centers a place lies between, and its part of the way from the
/// first to the second.
fn between(at: f64) -> ([f64; 2], f64) {
    let at = at - 0.5;
    let first = at.floor();
    ([first, first + 1.0], at - first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texels() -> Texels {
        let light = (0..6).map(|place| [place as f32, 0.5, 1.0]).collect();
        Texels::new(3, 2, light).unwrap()
    }

    #[test]
    fn places_blend_between_centers() {
        let wraps = [TexelWrap::Repeat, TexelWrap::Clamp];
        let red = |x, y| texels().blended([x, y], wraps).channels[0];
        assert_eq!(red(0.5, 0.5), 0.0);
        assert_eq!(red(2.5, 1.5), 5.0);
        assert_eq!(red(1.0, 0.5), 0.5);
        assert_eq!(red(1.0, 1.0), 2.0);
        // Columns go around, rows end.
        assert_eq!(red(0.0, 0.5), 1.0);
        assert_eq!(red(3.0, 0.5), 1.0);
        assert_eq!(red(0.5, -3.0), 0.0);
        assert_eq!(red(0.5, 9.0), 3.0);
        let red = |x, y, wrap| texels().nearest([x, y], wrap).channels[0];
        assert_eq!(red(2.9, 0.1, TexelWrap::Clamp), 2.0);
        assert_eq!(red(3.1, -0.1, TexelWrap::Repeat), 3.0);
        assert_eq!(red(3.1, -0.1, TexelWrap::Clamp), 2.0);
    }

    #[test]
    fn light_is_finite_and_not_below_0() {
        for wrong in [-1.0, f32::NAN, f32::INFINITY] {
            let mut light = vec![[0.0; 3]; 6];
            light[4][1] = wrong;
            let error = Texels::new(3, 2, light).unwrap_err();
            assert!(
                matches!(
                    error,
                    GeometryError::Texel {
                        column: 1,
                        row: 1,
                        ..
                    }
                ),
                "{error}"
            );
        }
        assert!(Texels::new(3, 2, vec![[0.0; 3]; 5]).is_err());
        assert!(Texels::new(0, 2, Vec::new()).is_err());
    }
}
