//! The conversion of a band of a picture to the rows of a file.

use std::{
    borrow::Cow,
    ops::Range,
    sync::{Mutex, PoisonError},
};

use crate::{
    film::{
        Film, Run,
        colors::NOTHING,
        light::LightRun,
        resolve::{PixelColor, Resolved},
    },
    image_file::pixel::Sample,
    integrator::{
        batch::{Cache, LocateRow, Places, SampleRow},
        encode::Encode,
    },
    parallel::Pool,
    render::{
        hits::Rays,
        layers::{
            layout::Layout,
            number::{Light, Number, Quantity},
        },
    },
    simd::{LANES, isa::Isa},
    tracer::{color::Color, geometry::Geometry, radiance::Radiance, tone::Tone, world::World},
};

/// A converter from bands to the rows of a file.
pub(crate) struct Painter<'a> {
    pub(crate) world: &'a World,
    /// The rays through the centers of the pixels of the file, if it has the places of their hits.
    pub(crate) rays: Option<Rays<'a>>,
    /// The tone of a lit picture.
    pub(crate) tone: Tone,
    /// The color where nothing is hit; `None` if the background is transparent.
    pub(crate) background: Option<Color>,
    pub(crate) layout: &'a Layout,
    /// The Cryptomatte number of each geometry for [`Quantity::Matte`], if needed.
    pub(crate) mattes: &'a [f32],
    pub(crate) isa: Isa,
    /// Memory of threads.
    pub(crate) known: Mutex<Vec<Cache>>,
}

/// A run of pixels, and what their numbers depend on.
struct Painted<'a> {
    painter: &'a Painter<'a>,
    run: Run<'a>,
    /// The pixels by what they show, if any number depends on that.
    spans: Vec<Span<'a>>,
    /// The places of the hits, eight at a time, if any number depends on them.
    places: Vec<Places>,
}

/// Neighbors that show the same.
struct Span<'a> {
    pixels: Range<usize>,
    number: u32,
    /// The color as display values, if needed.
    color: Color,
    shown: Cow<'a, Resolved>,
}

impl Painter<'_> {
    /// Returns the bytes of each row of a band whose first row is the row `top` of the file.
    pub(crate) fn rows(&self, film: &Film, top: usize, pool: &Pool) -> Vec<Vec<u8>> {
        let rows = 0..film.height();
        pool.map(rows, |row| self.row(film, row, top + row))
    }

    fn row(&self, film: &Film, row: usize, line: usize) -> Vec<u8> {
        let width = film.width();
        let mut bytes = vec![0; width * self.layout.pixel().bytes()];
        let mut column = 0;
        for run in film.row(row) {
            let end = column + run.pixels.len();
            let painted = Painted {
                painter: self,
                spans: self.spans(&run),
                places: self.places(&run, column..end, line),
                run,
            };
            let mut rest = &mut bytes[..];
            for numbers in &self.layout.parts {
                let size = numbers.iter().map(|number| number.sample.bytes()).sum();
                let (part, others) = rest.split_at_mut(width * size);
                painted.write(numbers, &mut part[column * size..end * size], size);
                rest = others;
            }
            column = end;
        }
        bytes
    }

    /// Returns the pixels of a run by what they show.
    fn spans<'a>(&self, run: &Run<'a>) -> Vec<Span<'a>> {
        if run.light.is_some() && !self.layout.has_mattes() {
            return Vec::new();
        }
        let needs_light = self
            .layout
            .needs(|quantity| matches!(quantity, Quantity::Light(..) | Quantity::Premultiplied(_)));
        let needs_display = self
            .layout
            .needs(|quantity| matches!(quantity, Quantity::Display(..)));
        let mut end = 0;
        let equal = run.pixels.chunk_by(|one, other| one == other);
        let spans = equal.map(|pixels| {
            let (start, number) = (end, pixels[0]);
            end += pixels.len();
            let shown = match run.resolved(number) {
                Some(resolved) => Cow::Borrowed(resolved),
                None => Cow::Owned(self.flat(number, needs_light)),
            };
            Span {
                pixels: start..end,
                number,
                color: match needs_display {
                    true => shown.color.color(),
                    false => Color::BLACK,
                },
                shown,
            }
        });
        spans.collect()
    }

    /// Returns the values of a pixel that shows only one geometry, or nothing.
    fn flat(&self, index: u32, needs_light: bool) -> Resolved {
        let geometry = self.world.with_id(index as usize);
        let behind = self.background.unwrap_or(Color::BLACK);
        let color = geometry.map_or(behind, Geometry::color);
        Resolved {
            light: if needs_light {
                color.to_linear()
            } else {
                Radiance::BLACK
            },
            color: PixelColor::Display(color),
            coverage: f64::from(u8::from(geometry.is_some())),
            ranks: Vec::new(),
        }
    }

    /// Returns the places of the hits of center rays, if the file has them.
    fn places(&self, run: &Run, columns: Range<usize>, line: usize) -> Vec<Places> {
        let Some(rays) = &self.rays else {
            return Vec::new();
        };
        let mut places = vec![Places::default(); columns.len().div_ceil(LANES)];
        let all = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let known = all().pop();
        let mut known = known.unwrap_or_else(|| Cache::new(self.world));
        let [x, y, z] = &rays.columns;
        self.isa.run(LocateRow {
            world: self.world,
            row: SampleRow {
                camera: rays.camera,
                columns: [x, y, z].map(|axis| &axis[columns.clone()]),
                row: rays.rows[line],
                ids: run.ids,
                t: run.t,
            },
            known: &mut known,
            places: &mut places,
        });
        all().push(known);
        places
    }

    /// Returns a quantity that all pixels of a span have.
    fn value(&self, span: &Span, quantity: Quantity) -> f64 {
        let Resolved {
            light, coverage, ..
        } = *span.shown;
        match quantity {
            Quantity::Display(_, channel) => {
                [span.color.r(), span.color.g(), span.color.b()][channel]
            }
            Quantity::Light(..) if coverage == 0.0 => 0.0,
            Quantity::Light(_, channel) => light.channels[channel] / coverage,
            Quantity::Premultiplied(channel) => light.channels[channel],
            Quantity::Matte(rank) => self.matte(span, rank).0.into(),
            Quantity::MatteCoverage(rank) => self.matte(span, rank).1,
            // Alpha and coverage; all others differ within a span.
            _ => coverage,
        }
    }

    /// Returns the Cryptomatte number of a geometry, and the part of a pixel that it covers.
    fn matte(&self, span: &Span, rank: usize) -> (f32, f64) {
        let seen = match &span.shown {
            Cow::Borrowed(resolved) => resolved.ranks.get(rank).copied(),
            Cow::Owned(_) => (rank == 0).then_some((span.number, 1.0)),
        };
        let (index, part) = seen.unwrap_or((NOTHING, 0.0));
        match self.mattes.get(index as usize) {
            Some(matte) => (*matte, part),
            None => (0.0, 0.0),
        }
    }
}

impl Painted<'_> {
    /// Writes the numbers of a layer of each pixel, which are `size` bytes together.
    fn write(&self, numbers: &[Number], bytes: &mut [u8], size: usize) {
        let (mut start, mut rest) = (0, numbers);
        if let (Some(lit), [first, _, _, others @ ..]) = (&self.run.light, numbers)
            && let Quantity::Display(light, _) = first.quantity
        {
            let is_wide = first.sample == Sample::U16;
            self.encode(lit, light, (is_wide, numbers.len()), bytes);
            (start, rest) = (3 * first.sample.bytes(), others);
        }
        for number in rest {
            let Some(values) = self.values(number.quantity) else {
                return self.repeat(numbers, bytes, size);
            };
            number.write(&values, &mut bytes[start..], size);
            start += number.sample.bytes();
        }
    }

    /// Writes numbers that the pixels of a span share.
    fn repeat(&self, numbers: &[Number], bytes: &mut [u8], size: usize) {
        for span in &self.spans {
            let bytes = &mut bytes[span.pixels.start * size..span.pixels.end * size];
            let mut start = 0;
            for number in numbers {
                let value = self.painter.value(span, number.quantity);
                number.write(&[value], &mut bytes[start..], size);
                start += number.sample.bytes();
            }
            let mut end = size;
            while end < bytes.len() {
                let more = end.min(bytes.len() - end);
                bytes.copy_within(..more, end);
                end += more;
            }
        }
    }

    /// Writes a light of a lit picture as display values, the first three of the integers of each pixel.
    fn encode(
        &self,
        lit: &LightRun,
        light: Light,
        (is_wide, channels): (bool, usize),
        bytes: &mut [u8],
    ) {
        let mut planes = [0, 1, 2].map(|channel| lit_channel(lit, light, channel));
        if light == Light::All && !lit.behind.is_empty() {
            for plane in &mut planes {
                for (light, behind) in plane.to_mut().iter_mut().zip(lit.behind) {
                    *light = match *behind < 1.0 {
                        true => *light / (1.0 - behind),
                        false => 0.0,
                    };
                }
            }
        }
        self.painter.isa.run(Encode {
            tone: match light {
                Light::Albedo => Tone::default(),
                _ => self.painter.tone,
            },
            light: planes.each_ref().map(|plane| &**plane),
            is_wide,
            channels,
            bytes,
        });
    }

    /// Returns a quantity of each pixel; `None` if all pixels of a span have the same.
    fn values(&self, quantity: Quantity) -> Option<Cow<'_, [f64]>> {
        let run = &self.run;
        Some(match (quantity, &run.light) {
            (Quantity::Depth, _) => run.t.into(),
            (Quantity::Z, _) => self.of_places(|eight| eight.z),
            (Quantity::Position(axis), _) => self.of_places(|eight| eight.point[axis]),
            (Quantity::Normal(axis), _) => self.of_places(|eight| eight.normal[axis]),
            (Quantity::Id, _) => run.ids.iter().map(|id| f64::from(*id)).collect(),
            (Quantity::Light(Light::All, channel), Some(lit)) => {
                let mut light = self.premultiplied(lit, channel);
                for (place, light) in light.iter_mut().enumerate() {
                    *light = match lit.alpha(place) {
                        0.0 => 0.0,
                        alpha => *light / alpha,
                    };
                }
                light.into()
            }
            (Quantity::Light(light, channel), Some(lit)) => {
                self.exposed(lit, light, channel).into()
            }
            (Quantity::Premultiplied(channel), Some(lit)) => {
                self.premultiplied(lit, channel).into()
            }
            (Quantity::Alpha, Some(lit)) => {
                let places = 0..lit.coverage.len();
                places.map(|place| lit.alpha(place)).collect()
            }
            (Quantity::Coverage, Some(lit)) => lit.coverage.into(),
            (Quantity::Samples, Some(lit)) => lit.samples.into(),
            (Quantity::Display(..) | Quantity::Matte(_) | Quantity::MatteCoverage(_), _)
            | (_, None) => return None,
        })
    }

    /// Returns a number of the place of each hit.
    fn of_places(&self, number: impl Fn(&Places) -> [f64; LANES]) -> Cow<'_, [f64]> {
        let numbers = self.places.iter().flat_map(number);
        numbers.take(self.run.pixels.len()).collect()
    }

    /// Returns a channel of a light of a lit picture.
    fn exposed(&self, lit: &LightRun, light: Light, channel: usize) -> Vec<f64> {
        let factor = match light {
            Light::Albedo => 1.0,
            _ => self.painter.tone.factor(),
        };
        let light = lit_channel(lit, light, channel);
        light.iter().map(|light| light * factor).collect()
    }

    /// Returns a channel of all light of a lit picture, which is less where the background shows if that
    /// is transparent.
    fn premultiplied(&self, lit: &LightRun, channel: usize) -> Vec<f64> {
        let mut light = self.exposed(lit, Light::All, channel);
        if self.painter.background.is_none() {
            for (light, coverage) in light.iter_mut().zip(lit.coverage) {
                *light *= coverage;
            }
        }
        light
    }
}

/// Returns a channel of a light of pixels, before exposure.
fn lit_channel<'a>(lit: &LightRun<'a>, light: Light, channel: usize) -> Cow<'a, [f64]> {
    let planes = lit.parts.map(|part| part[channel]);
    let planes = match light {
        Light::All => &planes[..],
        Light::Part(part) => &planes[part..=part],
        Light::Albedo => &[lit.albedo[channel]],
        Light::Error => &[lit.error[channel]],
    };
    let mut planes = planes.iter().filter(|plane| !plane.is_empty());
    let Some(first) = planes.next() else {
        return vec![0.0; lit.coverage.len()].into();
    };
    let mut sum: Cow<[f64]> = (*first).into();
    for plane in planes {
        for (sum, light) in sum.to_mut().iter_mut().zip(*plane) {
            *sum += light;
        }
    }
    sum
}
