//! The part of an explanation that is about light: samples, rays, lights, materials, tone mapping.

use std::fmt::{self, Write as _};

use serde::{Serialize, Serializer, ser::SerializeMap};
use strahl::{
    Color, Radiance, Ray, Scene,
    render::{
        ExplainedPixel, ExplainedSample, LightParts, RayEnd, Shading, ShiningLight, Term, Tone,
        ToneMapping, TracedRay,
    },
};

use super::{OriginTerms, shown, vector};

/// The light of a pixel.
#[derive(Serialize)]
pub(super) struct LightTerms<'a> {
    samples: Vec<SampleTerms<'a>>,
    /// The mean of the samples.
    #[serde(flatten)]
    parts: LightPartTerms,
    light: [f64; 3],
    /// `None` in a flat picture.
    #[serde(flatten)]
    tone: Option<ToneTerms>,
    #[serde(skip)]
    pub(super) color: Color,
}

/// The exposure and the tone mapping of a pixel.
#[derive(Serialize)]
struct ToneTerms {
    exposure: f64,
    exposed: [f64; 3],
    tone_mapping: &'static str,
    mapped: [f64; 3],
}

#[derive(Serialize)]
struct SampleTerms<'a> {
    origin: [f64; 3],
    direction: [f64; 3],
    hit: Option<OriginTerms<'a>>,
    inked_by: Option<NeighborTerms<'a>>,
    #[serde(flatten)]
    parts: LightPartTerms,
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<RaySteps<'a>>,
}

/// The sample that inks another.
#[derive(Serialize)]
struct NeighborTerms<'a> {
    right: i64,
    up: i64,
    hit: Option<OriginTerms<'a>>,
}

#[derive(Serialize)]
struct RaySteps<'a> {
    depth: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    leaves: Option<OriginTerms<'a>>,
    origin: [f64; 3],
    direction: [f64; 3],
    factor: [f64; 3],
    end: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    surface: Option<SurfaceSteps<'a>>,
    #[serde(flatten)]
    parts: LightPartTerms,
}

#[derive(Serialize)]
struct SurfaceSteps<'a> {
    hit: OriginTerms<'a>,
    t: f64,
    point: [f64; 3],
    n: [f64; 3],
    v: [f64; 3],
    material: &'static str,
    equation: &'static str,
    lights: Vec<LightSteps<'a>>,
    terms: Terms,
    onward: Vec<RaySteps<'a>>,
}

#[derive(Serialize)]
struct LightSteps<'a> {
    index: usize,
    kind: &'static str,
    terms: Terms,
    crossings: Vec<Crossing<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dark: Option<&'static str>,
}

#[derive(Serialize)]
struct Crossing<'a> {
    geometry: OriginTerms<'a>,
    t: f64,
    factor: [f64; 3],
}

/// The parts of light, in data by name.
struct LightPartTerms(LightParts);

impl LightPartTerms {
    fn named(&self) -> impl Iterator<Item = (&'static str, [f64; 3])> {
        LightParts::NAMES.into_iter().zip(self.0.all().map(rgb))
    }
}

impl Serialize for LightPartTerms {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.named())
    }
}

impl fmt::Display for LightPartTerms {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = self
            .named()
            .map(|(name, light)| format!("{name} {}", vector(light)));
        out.write_str(&parts.collect::<Vec<_>>().join(" + "))
    }
}

/// Terms, in data by name.
struct Terms(Vec<Term>);

impl Serialize for Terms {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for Term { name, numbers, .. } in &self.0 {
            match &numbers[..] {
                [number] => map.serialize_entry(name, number)?,
                numbers => map.serialize_entry(name, numbers)?,
            }
        }
        map.end()
    }
}

fn rgb(light: Radiance) -> [f64; 3] {
    [light.r(), light.g(), light.b()]
}

impl<'a> LightTerms<'a> {
    pub(super) fn new(scene: &'a Scene, pixel: ExplainedPixel) -> Self {
        let light = pixel.parts.sum();
        let samples = pixel.samples.into_iter();
        Self {
            samples: samples
                .map(|sample| SampleTerms::new(scene, sample))
                .collect(),
            parts: LightPartTerms(pixel.parts),
            light: rgb(light),
            tone: pixel.tone.map(|tone| ToneTerms::new(tone, light)),
            color: pixel.color,
        }
    }
}

impl ToneTerms {
    fn new(tone: Tone, light: Radiance) -> Self {
        let exposed = tone.expose(light);
        Self {
            exposure: tone.exposure(),
            exposed: rgb(exposed),
            tone_mapping: match tone.mapping() {
                ToneMapping::Clip => "Clip",
                ToneMapping::Neutral => "Neutral",
            },
            mapped: rgb(tone.map(exposed)),
        }
    }
}

impl<'a> SampleTerms<'a> {
    /// Returns true if its light is more than the color of a geometry.
    fn has_steps(&self) -> bool {
        self.steps.is_some() || self.inked_by.is_some()
    }

    fn new(scene: &'a Scene, sample: ExplainedSample) -> Self {
        let origin = |id| OriginTerms::new(scene, id);
        let inked_by = sample.outlined_by.map(|([right, up], hit)| NeighborTerms {
            right,
            up,
            hit: hit.map(origin),
        });
        Self {
            origin: sample.ray.origin().into(),
            direction: sample.ray.direction().into(),
            hit: sample.hit.map(origin),
            inked_by,
            parts: LightPartTerms(sample.parts),
            steps: sample.steps.map(|ray| RaySteps::new(scene, ray)),
        }
    }
}

impl<'a> RaySteps<'a> {
    fn new(scene: &'a Scene, traced: TracedRay) -> Self {
        let ray: Ray = traced.ray;
        let (end, surface) = match traced.end {
            RayEnd::Background => ("background", None),
            RayEnd::Faint => ("faint", None),
            RayEnd::TooDeep => ("too-deep", None),
            RayEnd::Surface(surface) => ("surface", Some(SurfaceSteps::new(scene, *surface))),
        };
        Self {
            depth: traced.depth,
            leaves: traced.own.map(|own| {
                let id = scene.world().id_of(own.geometry, own.face);
                OriginTerms::new(scene, id)
            }),
            origin: ray.origin().into(),
            direction: ray.direction().into(),
            factor: rgb(traced.factor),
            end,
            surface,
            parts: LightPartTerms(traced.parts),
        }
    }
}

impl<'a> SurfaceSteps<'a> {
    fn new(scene: &'a Scene, surface: Shading) -> Self {
        let lights = surface.lights.into_iter();
        let onward = surface.onward.into_iter();
        Self {
            hit: OriginTerms::new(scene, surface.id),
            t: surface.t,
            point: surface.point.into(),
            n: surface.n.into(),
            v: surface.v.into(),
            material: surface.material,
            equation: surface.equation,
            lights: lights.map(|light| LightSteps::new(scene, light)).collect(),
            terms: Terms(surface.terms),
            onward: onward.map(|ray| RaySteps::new(scene, ray)).collect(),
        }
    }
}

impl<'a> LightSteps<'a> {
    fn new(scene: &'a Scene, light: ShiningLight) -> Self {
        let crossings = light.crossings.into_iter();
        Self {
            index: light.index,
            kind: light.kind,
            terms: Terms(light.terms),
            crossings: crossings
                .map(|(id, t, factor)| Crossing {
                    geometry: OriginTerms::new(scene, id),
                    t,
                    factor: rgb(factor),
                })
                .collect(),
            dark: light.dark,
        }
    }
}

impl fmt::Display for LightTerms<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.samples.len();
        if count > 1 {
            writeln!(out, "\nsamples, from the top left")?;
            for (number, sample) in self.samples.iter().enumerate() {
                let seen = sample.hit.as_ref();
                let seen = seen.map_or_else(|| "background".to_owned(), ToString::to_string);
                let ink = if sample.inked_by.is_some() {
                    ", inked"
                } else {
                    ""
                };
                writeln!(out, "  {number} sees {seen}{ink}: {}", sample.parts)?;
            }
        }
        // The one in the middle; data holds them all.
        let side = count.isqrt();
        let middle = side / 2 * side + side / 2;
        let sample = self.samples.get(middle);
        if let Some(sample) = sample.filter(|sample| sample.has_steps()) {
            writeln!(out, "\nlight of sample {middle}")?;
            sample.fmt(out)?;
        }
        writeln!(out, "\nlight of the pixel, the mean of {count}")?;
        for (name, light) in self.parts.named() {
            writeln!(out, "  {name:<12} {}", vector(light))?;
        }
        let (light, sum) = (vector(self.light), LightParts::NAMES.join(" + "));
        writeln!(out, "  L            {light}, {sum}")?;
        self.tone.as_ref().map_or(Ok(()), |tone| tone.fmt(out))
    }
}

impl fmt::Display for ToneTerms {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (exposure, exposed) = (self.exposure, vector(self.exposed));
        writeln!(out, "  exposed      {exposed}, L · 2^{exposure:?}")?;
        let mapped = vector(self.mapped);
        writeln!(out, "  mapped       {mapped}, by {}", self.tone_mapping)
    }
}

impl fmt::Display for SampleTerms<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(steps) = &self.steps {
            let mut text = String::new();
            steps.write(&mut text, 1)?;
            out.write_str(&text)?;
        }
        if let Some(by) = &self.inked_by {
            let seen = by.hit.as_ref();
            let seen = seen.map_or_else(|| "the background".to_owned(), ToString::to_string);
            writeln!(
                out,
                "  inked by the sample {} to the right and {} up, which sees {seen}",
                by.right, by.up
            )?;
            writeln!(
                out,
                "  its light is the outlines' {}",
                vector(rgb(self.parts.0.sum()))
            )?;
        }
        Ok(())
    }
}

impl RaySteps<'_> {
    /// Writes the steps, indented by the depth of the ray.
    fn write(&self, out: &mut String, indent: usize) -> fmt::Result {
        let pad = "  ".repeat(indent);
        let leaves = self.leaves.as_ref();
        let leaves = leaves.map_or_else(String::new, |own| format!(", leaves {own}"));
        writeln!(out, "{pad}ray of depth {}{leaves}", self.depth)?;
        writeln!(out, "{pad}  o = {}", vector(self.origin))?;
        writeln!(out, "{pad}  d = {}", vector(self.direction))?;
        writeln!(out, "{pad}  factor = {}", vector(self.factor))?;
        match &self.surface {
            Some(surface) => surface.write(out, indent + 1)?,
            None => writeln!(
                out,
                "{pad}  {}",
                match self.end {
                    "faint" => "not traced: every channel of the factor is below 2^-12; black",
                    "too-deep" => "not traced: deeper than max_depth; it brings the background",
                    _ => "hits nothing: it brings the background",
                }
            )?,
        }
        writeln!(out, "{pad}  brings {}", self.parts)
    }
}

impl SurfaceSteps<'_> {
    fn write(&self, out: &mut String, indent: usize) -> fmt::Result {
        let pad = "  ".repeat(indent);
        writeln!(out, "{pad}hits {} at t = {:?}", self.hit, self.t)?;
        writeln!(out, "{pad}  point = {}", vector(self.point))?;
        writeln!(out, "{pad}  n = {}", vector(self.n))?;
        writeln!(out, "{pad}  v = {}", vector(self.v))?;
        for light in &self.lights {
            light.write(out, indent + 1)?;
        }
        writeln!(
            out,
            "{pad}  material {}, L = {}",
            self.material, self.equation
        )?;
        self.terms.write(out, indent + 2)?;
        self.onward
            .iter()
            .try_for_each(|ray| ray.write(out, indent + 2))
    }
}

impl LightSteps<'_> {
    fn write(&self, out: &mut String, indent: usize) -> fmt::Result {
        let pad = "  ".repeat(indent);
        writeln!(out, "{pad}light [{}] {}", self.index, self.kind)?;
        self.terms.write(out, indent + 1)?;
        for Crossing {
            geometry,
            t,
            factor,
        } in &self.crossings
        {
            let factor = vector(*factor);
            writeln!(
                out,
                "{pad}  in its way: {geometry} at t = {t:?}, factor {factor}"
            )?;
        }
        self.dark
            .map_or(Ok(()), |why| writeln!(out, "{pad}  dark: {why}"))
    }
}

impl Terms {
    fn write(&self, out: &mut String, indent: usize) -> fmt::Result {
        let pad = "  ".repeat(indent);
        self.0
            .iter()
            .try_for_each(|term| writeln!(out, "{pad}{} = {}", term.symbol, shown(&term.numbers)))
    }
}
