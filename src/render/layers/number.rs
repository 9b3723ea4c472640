//! One number of a pixel: its quantity, and how it is written.

use half::f16;

use crate::{
    film::{colors::NOTHING, parts::LightParts},
    image_file::pixel::Sample,
    tracer::{color::Color, hit::Hit, radiance::Radiance, srgb::quantize, tone::Tone},
};

/// The quantity of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Quantity {
    /// Red, green or blue as a display value; in a partly transparent pixel, of the opaque part.
    Display(Light, usize),
    /// The same channel as linear light.
    Light(Light, usize),
    /// The linear light of the whole pixel, which is less if part of it is transparent.
    Premultiplied(usize),
    /// The part of the pixel that hides the background.
    Alpha,
    /// The fraction of the pixel where something is hit.
    Coverage,
    Depth,
    Z,
    Position(usize),
    Normal(usize),
    Id,
    /// The Cryptomatte number of a geometry, by rank: 0 covers most of the pixel.
    Matte(usize),
    /// The fraction of the pixel that this geometry covers.
    MatteCoverage(usize),
}

/// A kind of light of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Light {
    /// All that the pixel shows.
    All,
    /// A part of that, by its place among [`LightParts::NAMES`].
    Part(usize),
    /// The first color of the material.
    Albedo,
}

/// The conversion of a quantity to an integer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Range {
    /// From 0 to 1.
    Unit,
    /// From -1 to 1.
    Signed,
    /// From one depth to another; depths outside are clamped.
    Depth(f64, f64),
    /// Unchanged.
    Same,
    /// The id plus 1; nothing is 0.
    FromOne,
}

/// A number in each pixel of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number {
    pub(super) quantity: Quantity,
    pub(super) sample: Sample,
    pub(super) range: Range,
}

/// All data of a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot<'a> {
    pub(super) color: Color,
    pub(super) light: Radiance,
    /// The parts of the light, if they are requested.
    pub(super) parts: Parts,
    pub(super) alpha: f64,
    pub(super) coverage: f64,
    /// The geometry that the center ray hits.
    pub(super) id: u32,
    /// The t of this hit; infinite for none.
    pub(super) t: f64,
    /// The hit, and its distance along the view axis.
    pub(super) hit: Option<(Hit<'a>, f64)>,
    /// The Cryptomatte numbers of geometries and their coverage, largest first.
    pub(super) mattes: [(f32, f64); MATTES],
}

/// The parts of a pixel's light.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Parts {
    pub(super) light: LightParts,
    pub(super) albedo: Radiance,
    pub(super) tone: Tone,
}

/// The number of geometries per pixel in Cryptomatte layers.
pub(super) const MATTES: usize = 6;

impl Spot<'_> {
    fn quantity(&self, quantity: Quantity) -> f64 {
        let hit = self.hit.as_ref();
        match quantity {
            Quantity::Display(light, channel) => {
                let color = match light {
                    Light::All => self.color,
                    Light::Part(part) => self.parts.tone.color(self.parts.light.all()[part]),
                    Light::Albedo => Color::from_linear(self.parts.albedo),
                };
                [color.r(), color.g(), color.b()][channel]
            }
            Quantity::Light(light, channel) => {
                let light = match light {
                    Light::All if self.alpha == 0.0 => Radiance::BLACK,
                    Light::All => self.light / self.alpha,
                    Light::Part(part) => self.parts.tone.expose(self.parts.light.all()[part]),
                    Light::Albedo => self.parts.albedo,
                };
                light.channels[channel]
            }
            Quantity::Premultiplied(channel) => self.light.channels[channel],
            Quantity::Alpha => self.alpha,
            Quantity::Coverage => self.coverage,
            Quantity::Depth => self.t,
            Quantity::Z => hit.map_or(f64::INFINITY, |(_, z)| *z),
            Quantity::Position(axis) => hit.map_or(0.0, |(hit, _)| hit.point[axis]),
            Quantity::Normal(axis) => hit.map_or(0.0, |(hit, _)| hit.normal[axis]),
            Quantity::Id => self.id.into(),
            Quantity::Matte(rank) => self.mattes[rank].0.into(),
            Quantity::MatteCoverage(rank) => self.mattes[rank].1,
        }
    }
}

impl Number {
    /// Writes this number of a pixel, in native byte order.
    pub(super) fn write(&self, spot: &Spot, out: &mut Vec<u8>) {
        let value = spot.quantity(self.quantity);
        let integer = |most: u32| -> u32 {
            let part = match self.range {
                Range::Unit => value,
                Range::Signed => (value + 1.0) / 2.0,
                Range::Depth(near, far) => (value - near) / (far - near),
                Range::Same => return value as u32,
                Range::FromOne if spot.id == NOTHING => return 0,
                Range::FromOne => return spot.id + 1,
            };
            quantize(part, most)
        };
        match self.sample {
            Sample::U8 => out.push(integer(u8::MAX.into()) as u8),
            Sample::U16 => out.extend((integer(u16::MAX.into()) as u16).to_ne_bytes()),
            Sample::U32 => out.extend(integer(u32::MAX).to_ne_bytes()),
            Sample::F16 => out.extend(f16::from_f64(value).to_ne_bytes()),
            Sample::F32 => out.extend((value as f32).to_ne_bytes()),
            Sample::F64 => out.extend(value.to_ne_bytes()),
        }
    }
}
