//! A picture of the surroundings.

use std::{f64::consts::PI, sync::Arc};

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    radiance::Radiance,
    sampling::{UnitPair, circle},
    texels::{TexelWrap, Texels},
    vector::{direction, finite, unit},
};

/// A picture of all directions, and how likely paths aim at each of its pixels: a column for each angle around
/// the zenith, a row for each angle from it.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyPicture {
    texels: Texels,
    /// The sums of the weights of the pixels up to each one: of their light times their solid angle.
    sums: Arc<Vec<f64>>,
    /// The cosines of the angles at which rows begin and end.
    heights: Arc<[f64]>,
}

/// A picture around a zenith.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SkyView {
    picture: SkyPicture,
    axes: SkyAxes,
}

/// The directions of a picture around a zenith: unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SkyAxes {
    right: DVec3,
    pub(super) up: DVec3,
    /// To the middle of the picture.
    front: DVec3,
}

/// The parts that neighbors have of the mean of what is blended between centers.
const AROUND: [f64; 3] = [1.0 / 8.0, 6.0 / 8.0, 1.0 / 8.0];

impl SkyPicture {
    /// Creates a picture whose first row is the zenith.
    ///
    /// # Errors
    ///
    /// Returns an error if it is black, or if the sums do not fit into memory.
    pub fn new(texels: Texels) -> Result<Self, GeometryError> {
        let built = Self::until(texels, || false);
        built.unwrap_or(Err(GeometryError::BlackPicture))
    }

    /// The same until cancelled, which is asked for each row.
    pub(crate) fn until(
        texels: Texels,
        is_cancelled: impl Fn() -> bool,
    ) -> Option<Result<Self, GeometryError>> {
        let (width, height) = (texels.width(), texels.height());
        let heights: Arc<[f64]> = (0..=height)
            .map(|row| libm::cos(PI * f64::from(row) / f64::from(height)))
            .collect();
        let brightest = |column: u32, row: u32| texels.at(column, row).max_channel();
        let mut sums = Vec::new();
        let reserved = sums.try_reserve_exact(width as usize * height as usize);
        if reserved.is_err() {
            return Some(Err(GeometryError::PictureMemory { width, height }));
        }
        let mut sum = 0.0;
        // The mean over three rows, of each column.
        let mut means = vec![0.0; width as usize];
        for row in 0..height {
            if is_cancelled() {
                return None;
            }
            let rows = [row.saturating_sub(1), row, (row + 1).min(height - 1)];
            for (column, mean) in (0..width).zip(&mut means) {
                let weighted = rows.iter().zip(AROUND);
                *mean = weighted.fold(0.0, |sum, (row, part)| sum + brightest(column, *row) * part);
            }
            for column in 0..width as usize {
                let last = means.len() - 1;
                let columns = [
                    column.checked_sub(1).unwrap_or(last),
                    column,
                    if column == last { 0 } else { column + 1 },
                ];
                let weighted = columns.iter().zip(AROUND);
                let mean = weighted.fold(0.0, |sum, (column, part)| sum + means[*column] * part);
                sum += mean * solid_angle(&heights, width, row as usize);
                sums.push(sum);
            }
        }
        if sum <= 0.0 {
            return Some(Err(GeometryError::BlackPicture));
        }
        Some(Ok(Self {
            texels,
            sums: Arc::new(sums),
            heights,
        }))
    }

    /// The sum of all weights.
    fn total(&self) -> f64 {
        self.sums[self.sums.len() - 1]
    }

    /// Returns the sum of the weights before a pixel, and its weight.
    fn weight(&self, pixel: usize) -> [f64; 2] {
        let before = pixel.checked_sub(1).map_or(0.0, |last| self.sums[last]);
        [before, self.sums[pixel] - before]
    }

    /// Returns the density of the directions to a pixel.
    fn density_at(&self, pixel: usize) -> f64 {
        let [_, weight] = self.weight(pixel);
        let width = self.texels.width();
        let row = pixel / width as usize;
        weight / (self.total() * solid_angle(&self.heights, width, row))
    }
}

impl SkyAxes {
    /// Creates the directions of a picture around a zenith, turned about it by degrees: counterclockwise as seen
    /// from there.
    pub(crate) fn turned(up: DVec3, rotation: f64) -> Result<Self, GeometryError> {
        let up = unit(direction(finite(up, "up")?, "up")?);
        if !rotation.is_finite() {
            return Err(GeometryError::NotFinite { name: "rotation" });
        }
        let front = front_of(up);
        let [cosine, sine] = circle((rotation / 360.0).rem_euclid(1.0));
        Ok(Self::around(up, front * cosine + up.cross(front) * sine))
    }

    fn around(up: DVec3, front: DVec3) -> Self {
        Self {
            right: front.cross(up),
            up,
            front,
        }
    }

    /// Returns the same around another zenith, given how directions are mapped.
    fn placed(&self, up: DVec3, map: impl Fn(DVec3) -> DVec3) -> Self {
        let front = map(self.front);
        let front = front - front.dot(up) * up;
        let front = match front.dot(front) > 0.0 && front.is_finite() {
            true => unit(front),
            false => front_of(up),
        };
        Self::around(up, front)
    }

    /// Returns the place of a direction in a picture, in pixels from the top left.
    fn place(&self, picture: &Texels, d: DVec3) -> [f64; 2] {
        let around = libm::atan2(d.dot(self.right), d.dot(self.front));
        let down = libm::acos(d.dot(self.up).clamp(-1.0, 1.0));
        [
            (0.5 + around / (2.0 * PI)) * f64::from(picture.width()),
            down / PI * f64::from(picture.height()),
        ]
    }

    /// Returns the light of a picture from the direction of a unit vector.
    pub(crate) fn radiance(&self, picture: &Texels, d: DVec3) -> Radiance {
        let place = self.place(picture, d);
        picture.blended(place, [TexelWrap::Repeat, TexelWrap::Clamp])
    }

    /// Returns the numbers that determine it.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        [self.up, self.front]
            .into_iter()
            .flat_map(|axis| axis.to_array())
    }
}

impl SkyView {
    pub(super) const fn new(picture: SkyPicture, axes: SkyAxes) -> Self {
        Self { picture, axes }
    }

    /// Returns the same around another zenith, given how directions are mapped.
    pub(super) fn placed(&self, up: DVec3, map: impl Fn(DVec3) -> DVec3) -> Self {
        Self::new(self.picture.clone(), self.axes.placed(up, map))
    }

    /// Returns the light from the direction of a unit vector.
    pub(super) fn radiance(&self, d: DVec3) -> Radiance {
        self.axes.radiance(&self.picture.texels, d)
    }

    /// Returns the mean of the largest channel over all directions.
    pub(super) fn mean(&self) -> f64 {
        self.picture.total() / (4.0 * PI)
    }

    /// Returns a direction, more often to where the picture is bright, and its density.
    pub(super) fn sample(&self, [u, v]: UnitPair) -> (DVec3, f64) {
        let target = u * self.picture.total();
        let pixel = self.picture.sums.partition_point(|sum| *sum <= target);
        let pixel = pixel.min(self.picture.sums.len() - 1);
        let [before, weight] = self.picture.weight(pixel);
        let width = self.picture.texels.width() as usize;
        let (row, column) = (pixel / width, pixel % width);
        let [top, bottom] = [self.picture.heights[row], self.picture.heights[row + 1]];
        let height = top + (bottom - top) * ((target - before) / weight).clamp(0.0, 1.0);
        let [cosine, sine] = circle((column as f64 + v) / width as f64);
        let beside = (1.0 - height * height).max(0.0).sqrt();
        // The middle of the picture is in front, half a turn from its left.
        let SkyAxes { right, up, front } = self.axes;
        let l = height * up - beside * (sine * right + cosine * front);
        (unit(l), self.picture.density_at(pixel))
    }

    /// Returns the density of a direction.
    pub(super) fn density(&self, d: DVec3) -> f64 {
        let [x, y] = self.axes.place(&self.picture.texels, d);
        let (width, height) = (self.picture.texels.width(), self.picture.texels.height());
        let column = (x as usize).min(width as usize - 1);
        let row = (y as usize).min(height as usize - 1);
        self.picture.density_at(row * width as usize + column)
    }

    /// Returns all numbers.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        self.axes
            .front
            .to_array()
            .into_iter()
            .chain(self.picture.texels.numbers())
    }
}

/// Returns the solid angle of a pixel in a row.
fn solid_angle(heights: &[f64], width: u32, row: usize) -> f64 {
    2.0 * PI / f64::from(width) * (heights[row] - heights[row + 1])
}

/// Returns the direction to the middle of a picture around a zenith, before it is turned: -z, or the nearest to
/// it at a right angle to the zenith; y where that is z, as if all were tipped over.
fn front_of(up: DVec3) -> DVec3 {
    let front = DVec3::NEG_Z + up.z * up;
    match front.dot(front) > 1e-24 {
        true => unit(front),
        false => DVec3::Y * up.z.signum(),
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::tracer::{random::Rng, shape::target::on_ball};

    fn view(up: DVec3, rotation: f64) -> SkyView {
        let mut random = Rng(9);
        let mut light = || [0; 3].map(|_| random.magnitude(-2.0, 1.0) as f32);
        let light = (0..7 * 5).map(|_| light()).collect();
        let picture = SkyPicture::new(Texels::new(7, 5, light).unwrap()).unwrap();
        SkyView::new(picture, SkyAxes::turned(up, rotation).unwrap())
    }

    #[test]
    fn the_middle_is_in_front_and_turns_about_the_zenith() {
        let middle = |up: DVec3, rotation: f64| SkyAxes::turned(up, rotation).unwrap().front;
        let near = |one: DVec3, other: DVec3| assert!((one - other).length() < 1e-15, "{one}");
        near(middle(DVec3::Y, 0.0), DVec3::NEG_Z);
        near(middle(DVec3::Y, 90.0), DVec3::NEG_X);
        near(middle(DVec3::Y, -270.0), DVec3::NEG_X);
        near(middle(DVec3::Z, 0.0), DVec3::Y);
        near(middle(DVec3::X, 0.0), DVec3::NEG_Z);
        let view = view(DVec3::Y, 0.0);
        let place = |d: DVec3| view.axes.place(&view.picture.texels, d);
        assert_eq!(place(DVec3::NEG_Z), [3.5, 2.5]);
        // What lies to the right in the picture lies to the right of one who looks to the front.
        assert!(place(unit(DVec3::new(0.1, 0.2, -1.0)))[0] > 3.5);
        assert!(place(DVec3::Y)[1] == 0.0 && place(DVec3::NEG_Y)[1] == 5.0);
    }

    #[test]
    fn directions_have_the_density_that_they_are_sampled_by() {
        let view = view(unit(DVec3::new(0.3, 1.0, 0.2)), 33.0);
        let side = 300;
        let (mut sum, mut light, mut even, mut apart) = (0.0, 0.0, 0.0, 0);
        for row in 0..side {
            for column in 0..side {
                let pair = [row, column].map(|step| (f64::from(step) + 0.5) / f64::from(side));
                let (l, density) = view.sample(pair);
                assert!((l.length() - 1.0).abs() < 1e-14);
                sum += 1.0 / density;
                light += view.radiance(l).max_channel() / density / (4.0 * PI);
                even += view.radiance(on_ball(pair, DVec3::Y)).max_channel();
                apart += i32::from((view.density(l) / density - 1.0).abs() > 1e-9);
            }
        }
        let count = f64::from(side * side);
        // On the border of a pixel, rounding decides.
        assert!(apart < side * side / 1000, "{apart}");
        assert!((sum / count / (4.0 * PI) - 1.0).abs() < 0.01);
        assert!((light / even - 1.0).abs() < 0.01, "{light} {even}");
        // Rows are narrow in real pictures; these are wide.
        assert!((view.mean() * count / even - 1.0).abs() < 0.4);
    }

    #[test]
    fn it_ends_once_cancelled() {
        let texels = Texels::new(2, 9, vec![[1.0; 3]; 18]).unwrap();
        let rows = Cell::new(0);
        let ends = SkyPicture::until(texels, || rows.replace(rows.get() + 1) == 4);
        assert!(ends.is_none() && rows.get() == 5);
    }

    #[test]
    fn a_black_picture_brings_no_light() {
        let black = Texels::new(2, 1, vec![[0.0; 3]; 2]).unwrap();
        assert!(SkyPicture::new(black).is_err());
    }
}
