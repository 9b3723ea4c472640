//! The part of an explanation that is about light: samples, rays, lights, materials, tone mapping.

use std::fmt::{self, Write as _};

use serde::{Serialize, Serializer, ser::SerializeMap};
use strahl::{
    Radiance, Scene,
    render::{
        ExplainedPixel, ExplainedSample, LightParts, RayEnd, Shading, ShiningLight, Term,
        ToneMapping, TracedRay,
    },
};

use super::{OriginTerms, serialize_terms, shown, vector};

/// The light of a pixel.
pub(super) struct LightTerms<'a> {
    pub(super) scene: &'a Scene,
    pub(super) pixel: ExplainedPixel,
}

/// A part of an explanation.
pub(super) trait ExplainedStep {
    /// Adds its entries in data.
    fn data<M: SerializeMap>(&self, scene: &Scene, map: &mut M) -> Result<(), M::Error>;

    /// Writes it for people, after two spaces for each of `indent`.
    fn text(&self, scene: &Scene, out: &mut String, indent: usize) -> fmt::Result;
}

/// A part in data, with the scene that names its geometries.
pub(super) struct Of<'a, T>(pub(super) &'a Scene, pub(super) &'a T);

impl<T: ExplainedStep> Serialize for Of<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        self.1.data(self.0, &mut map)?;
        map.end()
    }
}

pub(super) fn all<'a, T: ExplainedStep>(scene: &'a Scene, parts: &'a [T]) -> Vec<Of<'a, T>> {
    parts.iter().map(|part| Of(scene, part)).collect()
}

impl Serialize for LightTerms<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Of(self.scene, &self.pixel).serialize(serializer)
    }
}

impl fmt::Display for LightTerms<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = String::new();
        self.pixel.text(self.scene, &mut text, 0)?;
        out.write_str(&text)
    }
}

/// Terms in data, by name.
struct Terms<'a>(&'a [Term]);

impl Serialize for Terms<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        serialize_terms(self.0, &mut map)?;
        map.end()
    }
}

pub(super) fn write_terms(terms: &[Term], out: &mut String, indent: usize) -> fmt::Result {
    let pad = "  ".repeat(indent);
    terms
        .iter()
        .try_for_each(|term| writeln!(out, "{pad}{} = {}", term.symbol, shown(&term.numbers)))
}

pub(super) fn rgb(light: Radiance) -> [f64; 3] {
    [light.r(), light.g(), light.b()]
}

/// Returns the parts of light, by name.
fn named(parts: &LightParts) -> impl Iterator<Item = (&'static str, [f64; 3])> {
    LightParts::NAMES.into_iter().zip(parts.all().map(rgb))
}

fn sum(parts: &LightParts) -> String {
    let parts = named(parts).map(|(name, light)| format!("{name} {}", vector(light)));
    parts.collect::<Vec<_>>().join(" + ")
}

fn serialize_parts<M: SerializeMap>(parts: &LightParts, map: &mut M) -> Result<(), M::Error> {
    named(parts).try_for_each(|(name, light)| map.serialize_entry(name, &light))
}

/// Says what a sample sees.
fn seen(scene: &Scene, hit: Option<usize>, background: &str) -> String {
    let name = |id| OriginTerms::new(scene, id).to_string();
    hit.map_or_else(|| background.to_owned(), name)
}

impl ExplainedStep for ExplainedPixel {
    fn data<M: SerializeMap>(&self, scene: &Scene, map: &mut M) -> Result<(), M::Error> {
        let light = self.parts.sum();
        map.serialize_entry("samples", &all(scene, &self.samples))?;
        if let Some(paths) = &self.paths {
            map.serialize_entry("paths", &Of(scene, paths))?;
        }
        serialize_parts(&self.parts, map)?;
        map.serialize_entry("light", &rgb(light))?;
        if let Some(tone) = self.tone {
            let exposed = tone.expose(light);
            map.serialize_entry("exposure", &tone.exposure())?;
            map.serialize_entry("exposed", &rgb(exposed))?;
            map.serialize_entry("tone_mapping", name(tone.mapping()))?;
            map.serialize_entry("mapped", &rgb(tone.map(exposed)))?;
        }
        Ok(())
    }

    fn text(&self, scene: &Scene, out: &mut String, indent: usize) -> fmt::Result {
        let count = self.samples.len();
        if count > 1 {
            writeln!(out, "\nsamples, from the top left")?;
            for (number, sample) in self.samples.iter().enumerate() {
                let seen = seen(scene, sample.hit, "background");
                let ink = sample.outlined_by.map_or("", |_| ", inked");
                writeln!(out, "  {number} sees {seen}{ink}: {}", sum(&sample.parts))?;
            }
        }
        // The one in the middle; data holds them all.
        let side = count.isqrt();
        let middle = side / 2 * side + side / 2;
        if let Some(sample) = self.samples.get(middle)
            && (sample.steps.is_some() || sample.outlined_by.is_some())
        {
            writeln!(out, "\nlight of sample {middle}")?;
            sample.text(scene, out, indent + 1)?;
        }
        if let Some(paths) = &self.paths {
            paths.text(scene, out, indent)?;
        }
        writeln!(out, "\nlight of the pixel, the mean of {}", self.count)?;
        for (name, light) in named(&self.parts) {
            writeln!(out, "  {name:<12} {}", vector(light))?;
        }
        let (light, names) = (self.parts.sum(), LightParts::NAMES.join(" + "));
        writeln!(out, "  L            {}, {names}", vector(rgb(light)))?;
        if let Some(tone) = self.tone {
            let (exposed, exposure) = (tone.expose(light), tone.exposure());
            let shown = vector(rgb(exposed));
            writeln!(out, "  exposed      {shown}, L · 2^{exposure:?}")?;
            let (mapped, by) = (vector(rgb(tone.map(exposed))), name(tone.mapping()));
            writeln!(out, "  mapped       {mapped}, by {by}")?;
        }
        Ok(())
    }
}

fn name(mapping: ToneMapping) -> &'static str {
    match mapping {
        ToneMapping::Clip => "Clip",
        ToneMapping::Neutral => "Neutral",
    }
}

impl ExplainedStep for ExplainedSample {
    fn data<M: SerializeMap>(&self, scene: &Scene, map: &mut M) -> Result<(), M::Error> {
        let origin = |hit: Option<usize>| hit.map(|id| OriginTerms::new(scene, id));
        let inked_by = self.outlined_by.map(|([right, up], hit)| Neighbor {
            right,
            up,
            hit: origin(hit),
        });
        map.serialize_entry("origin", &self.ray.origin().to_array())?;
        map.serialize_entry("direction", &self.ray.direction().to_array())?;
        map.serialize_entry("hit", &origin(self.hit))?;
        map.serialize_entry("inked_by", &inked_by)?;
        serialize_parts(&self.parts, map)?;
        let steps = self.steps.as_ref();
        steps.map_or(Ok(()), |ray| map.serialize_entry("steps", &Of(scene, ray)))
    }

    fn text(&self, scene: &Scene, out: &mut String, indent: usize) -> fmt::Result {
        if let Some(ray) = &self.steps {
            ray.text(scene, out, indent)?;
        }
        if let Some(([right, up], hit)) = self.outlined_by {
            let seen = seen(scene, hit, "the background");
            writeln!(
                out,
                "  inked by the sample {right} to the right and {up} up, which sees {seen}"
            )?;
            let color = vector(rgb(self.parts.sum()));
            writeln!(out, "  its light is the outlines' {color}")?;
        }
        Ok(())
    }
}

/// The sample that inks another.
#[derive(Serialize)]
struct Neighbor<'a> {
    right: i64,
    up: i64,
    hit: Option<OriginTerms<'a>>,
}

impl ExplainedStep for TracedRay {
    fn data<M: SerializeMap>(&self, scene: &Scene, map: &mut M) -> Result<(), M::Error> {
        map.serialize_entry("depth", &self.depth)?;
        if let Some(own) = self.own {
            let id = scene.world().id_of(own.geometry, own.face);
            map.serialize_entry("leaves", &OriginTerms::new(scene, id))?;
        }
        map.serialize_entry("origin", &self.ray.origin().to_array())?;
        map.serialize_entry("direction", &self.ray.direction().to_array())?;
        map.serialize_entry("factor", &rgb(self.factor))?;
        let end = match self.end {
            RayEnd::Background => "background",
            RayEnd::Faint => "faint",
            RayEnd::TooDeep => "too-deep",
            RayEnd::Surface(_) => "surface",
        };
        map.serialize_entry("end", end)?;
        if let RayEnd::Surface(surface) = &self.end {
            map.serialize_entry("surface", &Of(scene, &**surface))?;
        }
        serialize_parts(&self.parts, map)
    }

    fn text(&self, scene: &Scene, out: &mut String, indent: usize) -> fmt::Result {
        let pad = "  ".repeat(indent);
        let own = self
            .own
            .map(|own| scene.world().id_of(own.geometry, own.face));
        let leaves = own.map_or_else(String::new, |id| {
            format!(", leaves {}", OriginTerms::new(scene, id))
        });
        writeln!(out, "{pad}ray of depth {}{leaves}", self.depth)?;
        writeln!(out, "{pad}  o = {}", vector(self.ray.origin().into()))?;
        writeln!(out, "{pad}  d = {}", vector(self.ray.direction().into()))?;
        writeln!(out, "{pad}  factor = {}", vector(rgb(self.factor)))?;
        let why = match &self.end {
            RayEnd::Surface(surface) => {
                surface.text(scene, out, indent + 1)?;
                return writeln!(out, "{pad}  brings {}", sum(&self.parts));
            }
            RayEnd::Faint => {
                "not traced: even the brightest light would change the pixel by less than 2^-12; black"
            }
            RayEnd::TooDeep => "not traced: deeper than max_depth; it brings the background",
            RayEnd::Background => "hits nothing: it brings the background",
        };
        writeln!(out, "{pad}  {why}\n{pad}  brings {}", sum(&self.parts))
    }
}

impl ExplainedStep for Shading {
    fn data<M: SerializeMap>(&self, scene: &Scene, map: &mut M) -> Result<(), M::Error> {
        map.serialize_entry("hit", &OriginTerms::new(scene, self.id))?;
        map.serialize_entry("t", &self.t)?;
        map.serialize_entry("point", &self.point.to_array())?;
        map.serialize_entry("n", &self.n.to_array())?;
        map.serialize_entry("v", &self.v.to_array())?;
        map.serialize_entry("material", self.material)?;
        map.serialize_entry("equation", self.equation)?;
        map.serialize_entry("lights", &all(scene, &self.lights))?;
        map.serialize_entry("terms", &Terms(&self.terms))?;
        map.serialize_entry("onward", &all(scene, &self.onward))
    }

    fn text(&self, scene: &Scene, out: &mut String, indent: usize) -> fmt::Result {
        let pad = "  ".repeat(indent);
        let hit = OriginTerms::new(scene, self.id);
        writeln!(out, "{pad}hits {hit} at t = {:?}", self.t)?;
        writeln!(out, "{pad}  point = {}", vector(self.point.into()))?;
        writeln!(out, "{pad}  n = {}", vector(self.n.into()))?;
        writeln!(out, "{pad}  v = {}", vector(self.v.into()))?;
        for light in &self.lights {
            light.text(scene, out, indent + 1)?;
        }
        let (material, equation) = (self.material, self.equation);
        writeln!(out, "{pad}  material {material}, L = {equation}")?;
        write_terms(&self.terms, out, indent + 2)?;
        let mut onward = self.onward.iter();
        onward.try_for_each(|ray| ray.text(scene, out, indent + 2))
    }
}

impl ExplainedStep for ShiningLight {
    fn data<M: SerializeMap>(&self, scene: &Scene, map: &mut M) -> Result<(), M::Error> {
        map.serialize_entry("index", &self.index)?;
        map.serialize_entry("kind", self.kind)?;
        map.serialize_entry("terms", &Terms(&self.terms))?;
        map.serialize_entry("crossings", &crossings(scene, &self.crossings))?;
        self.dark
            .map_or(Ok(()), |why| map.serialize_entry("dark", why))
    }

    fn text(&self, scene: &Scene, out: &mut String, indent: usize) -> fmt::Result {
        let pad = "  ".repeat(indent);
        writeln!(out, "{pad}light [{}] {}", self.index, self.kind)?;
        write_terms(&self.terms, out, indent + 1)?;
        write_crossings(scene, &self.crossings, out, indent + 1)?;
        self.dark
            .map_or(Ok(()), |why| writeln!(out, "{pad}  dark: {why}"))
    }
}

/// A geometry in the way of a light.
#[derive(Serialize)]
pub(super) struct Crossing<'a> {
    geometry: OriginTerms<'a>,
    t: f64,
    factor: [f64; 3],
}

/// Returns the geometries in the way of a light, in data.
pub(super) fn crossings<'a>(scene: &'a Scene, all: &[(usize, f64, Radiance)]) -> Vec<Crossing<'a>> {
    let crossing = |&(id, t, factor): &(usize, f64, Radiance)| Crossing {
        geometry: OriginTerms::new(scene, id),
        t,
        factor: rgb(factor),
    };
    all.iter().map(crossing).collect()
}

/// Writes the geometries in the way of a light for people.
pub(super) fn write_crossings(
    scene: &Scene,
    all: &[(usize, f64, Radiance)],
    out: &mut String,
    indent: usize,
) -> fmt::Result {
    let pad = "  ".repeat(indent);
    all.iter().try_for_each(|&(id, t, factor)| {
        let (geometry, factor) = (OriginTerms::new(scene, id), vector(rgb(factor)));
        writeln!(
            out,
            "{pad}in its way: {geometry} at t = {t:?}, factor {factor}"
        )
    })
}
