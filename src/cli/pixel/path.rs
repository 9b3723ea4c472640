//! The part of an explanation that is about paths.

use std::fmt::{self, Write as _};

use serde::{Serialize, ser::SerializeMap};
use strahl::{
    Radiance, Scene,
    render::{EmittedBy, EmitterChance, ExplainedPath, ExplainedPaths, PathSegment, Term},
};

use super::{
    OriginTerms,
    light::{ExplainedStep, Of, all, crossings, rgb, write_crossings, write_terms},
    vector,
};

/// Returns an emitter, for people.
fn named(scene: &Scene, emitter: EmittedBy) -> String {
    match emitter {
        EmittedBy::Light(index) => format!("light [{index}]"),
        EmittedBy::Face(face) => {
            let id = scene.world().id_of(face.geometry, face.face);
            OriginTerms::new(scene, id).to_string()
        }
    }
}

/// Returns the weight and the probability of an emitter, for people.
fn odds(of: EmitterChance) -> String {
    format!("W = {:?}, P = {:?}", of.weight, of.probability)
}

/// An emitter with its weight and its probability, in data.
#[derive(Serialize)]
struct EmitterTerms<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    light: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    geometry: Option<OriginTerms<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    face: Option<u64>,
    weight: f64,
    probability: f64,
}

impl<'a> EmitterTerms<'a> {
    fn new(scene: &'a Scene, of: EmitterChance) -> Self {
        let (light, face) = match of.emitter {
            EmittedBy::Light(index) => (Some(index), None),
            EmittedBy::Face(face) => (None, Some(face)),
        };
        let id = face.map(|face| scene.world().id_of(face.geometry, face.face));
        Self {
            light,
            geometry: id.map(|id| OriginTerms::new(scene, id)),
            face: face.map(|face| face.face),
            weight: of.weight,
            probability: of.probability,
        }
    }
}

/// A term in data.
#[derive(Serialize)]
struct NamedTerm<'a> {
    name: &'a str,
    numbers: &'a [f64],
}

fn sum(lights: &[Radiance]) -> Radiance {
    lights
        .iter()
        .fold(Radiance::BLACK, |sum, light| sum + *light)
}

impl ExplainedStep for ExplainedPaths {
    fn data<M: SerializeMap>(&self, scene: &Scene, map: &mut M) -> Result<(), M::Error> {
        let by_depth: Vec<_> = self.by_depth.iter().map(|light| rgb(*light)).collect();
        let brightest = self.brightest.iter();
        let brightest: Vec<_> = brightest
            .map(|(sample, light)| (sample, rgb(*light)))
            .collect();
        map.serialize_entry("error", &rgb(self.error))?;
        map.serialize_entry("by_depth", &by_depth)?;
        map.serialize_entry("brightest", &brightest)?;
        match &self.path {
            Some(path) => map.serialize_entry("path", &Of(scene, path)),
            None => Ok(()),
        }
    }

    fn text(&self, scene: &Scene, out: &mut String, indent: usize) -> fmt::Result {
        if let Some(path) = &self.path {
            writeln!(out, "\npath of sample {}", path.sample)?;
            return path.text(scene, out, indent + 1);
        }
        writeln!(out, "\npaths, whose light is brought at depth")?;
        for (depth, light) in self.by_depth.iter().enumerate() {
            writeln!(out, "  {depth:<12} {}", vector(rgb(*light)))?;
        }
        writeln!(out, "\nbrightest samples; --sample tells the path of one")?;
        for (sample, light) in &self.brightest {
            writeln!(out, "  {sample:<12} {}", vector(rgb(*light)))?;
        }
        writeln!(out, "\nstandard error  {}", vector(rgb(self.error)))
    }
}

impl ExplainedStep for ExplainedPath {
    fn data<M: SerializeMap>(&self, scene: &Scene, map: &mut M) -> Result<(), M::Error> {
        map.serialize_entry("sample", &self.sample)?;
        map.serialize_entry("place", &self.pairs[0])?;
        map.serialize_entry("lens", &self.pairs[1])?;
        map.serialize_entry("rays", &all(scene, &self.segments))?;
        map.serialize_entry("light", &rgb(self.light))
    }

    fn text(&self, scene: &Scene, out: &mut String, indent: usize) -> fmt::Result {
        let pad = "  ".repeat(indent);
        for (name, [u, v]) in ["in the pixel", "on the lens"].iter().zip(self.pairs) {
            writeln!(out, "{pad}numbers of the place {name} = ({u:?}, {v:?})")?;
        }
        for segment in &self.segments {
            segment.text(scene, out, indent)?;
        }
        writeln!(out, "{pad}light = {}", vector(rgb(self.light)))
    }
}

impl ExplainedStep for PathSegment {
    fn data<M: SerializeMap>(&self, scene: &Scene, map: &mut M) -> Result<(), M::Error> {
        let terms = self.terms.iter();
        let terms = terms.map(|Term { name, numbers, .. }| NamedTerm { name, numbers });
        map.serialize_entry("depth", &self.depth)?;
        map.serialize_entry("origin", &self.ray.origin().to_array())?;
        map.serialize_entry("direction", &self.ray.direction().to_array())?;
        map.serialize_entry("factor", &rgb(self.factor))?;
        if let Some(surface) = &self.surface {
            map.serialize_entry("hit", &OriginTerms::new(scene, surface.id))?;
            map.serialize_entry("t", &surface.t)?;
            map.serialize_entry("point", &surface.point.to_array())?;
            map.serialize_entry("n", &surface.n.to_array())?;
            map.serialize_entry("material", surface.material)?;
        }
        if let Some(emitter) = self.emitter {
            map.serialize_entry("emitter", &EmitterTerms::new(scene, emitter))?;
            let all = self.emitters.iter();
            let all: Vec<_> = all.map(|one| EmitterTerms::new(scene, *one)).collect();
            map.serialize_entry("emitters", &all)?;
            map.serialize_entry("crossings", &crossings(scene, &self.crossings))?;
        }
        map.serialize_entry("terms", &terms.collect::<Vec<_>>())?;
        map.serialize_entry("adds", &rgb(sum(&self.adds)))
    }

    fn text(&self, scene: &Scene, out: &mut String, indent: usize) -> fmt::Result {
        let pad = "  ".repeat(indent);
        writeln!(out, "{pad}ray of depth {}", self.depth)?;
        writeln!(out, "{pad}  o = {}", vector(self.ray.origin().into()))?;
        writeln!(out, "{pad}  d = {}", vector(self.ray.direction().into()))?;
        writeln!(out, "{pad}  β = {}", vector(rgb(self.factor)))?;
        match &self.surface {
            None => writeln!(out, "{pad}  meets nothing")?,
            Some(surface) => {
                let hit = OriginTerms::new(scene, surface.id);
                writeln!(out, "{pad}  hits {hit} at t = {:?}", surface.t)?;
                writeln!(out, "{pad}    point = {}", vector(surface.point.into()))?;
                writeln!(out, "{pad}    n = {}", vector(surface.n.into()))?;
                writeln!(out, "{pad}    v = {}", vector(surface.v.into()))?;
                writeln!(out, "{pad}    material {}", surface.material)?;
                write_terms(&surface.terms, out, indent + 3)?;
            }
        }
        if let Some(chosen) = self.emitter {
            let name = named(scene, chosen.emitter);
            writeln!(out, "{pad}    aims at {name} with {}", odds(chosen))?;
            for first in &self.emitters {
                let name = named(scene, first.emitter);
                writeln!(out, "{pad}      {name} has {}", odds(*first))?;
            }
            write_crossings(scene, &self.crossings, out, indent + 3)?;
        }
        write_terms(&self.terms, out, indent + 2)?;
        self.adds
            .iter()
            .try_for_each(|light| writeln!(out, "{pad}    adds {}", vector(rgb(*light))))
    }
}
