//! The lights and materials of a scene.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};

use serde::Serialize;
use strahl::{
    Scene,
    light::{Light, Transport},
    material::Material,
};

use crate::cli::camera::vector;

/// The lights of a lit scene.
#[derive(Serialize)]
pub(super) struct LightingTerms {
    transport: &'static str,
    max_depth: u32,
    lights: Vec<LightTerms>,
}

#[derive(Serialize)]
struct LightTerms {
    kind: &'static str,
    name: Option<String>,
    color: [f64; 3],
    intensity: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    radius: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    angle: Option<f64>,
    shadows: bool,
}

impl LightingTerms {
    /// Returns the lights of a scene, whose names are these, in order; `None` for a flat scene.
    pub(super) fn new(scene: &Scene, names: Vec<Option<String>>) -> Option<Self> {
        let lighting = scene.world().lighting()?;
        let lights = lighting.lights.iter().zip(names).map(|(light, name)| {
            let (glow, shadows) = (light.glow(), light.shadows());
            let color = glow.color();
            let [radius, angle] = match light {
                Light::Point(point) => [Some(point.radius()), None],
                Light::Spot(spot) => [Some(spot.radius()), None],
                Light::Directional(directional) => [None, Some(directional.angle())],
                _ => [None; 2],
            };
            let given = |size: Option<f64>| size.filter(|size| *size > 0.0);
            LightTerms {
                kind: light.kind(),
                name,
                color: [color.r(), color.g(), color.b()],
                intensity: glow.intensity(),
                radius: given(radius),
                angle: given(angle),
                shadows,
            }
        });
        Some(Self {
            transport: match lighting.transport {
                Transport::Direct => "direct",
                Transport::Path(_) => "path",
            },
            max_depth: lighting.max_depth,
            lights: lights.collect(),
        })
    }
}

/// The number of geometries of each kind of material.
#[derive(Serialize)]
#[serde(transparent)]
pub(super) struct Materials(BTreeMap<&'static str, usize>);

impl Materials {
    /// Counts the materials of a scene, those of a geometry once each.
    pub(super) fn of(scene: &Scene) -> Self {
        let mut counts = BTreeMap::new();
        for geometry in scene.world().geometries() {
            let kinds = geometry.materials().map(Material::kind);
            for kind in kinds.collect::<BTreeSet<_>>() {
                *counts.entry(kind).or_default() += 1;
            }
        }
        Self(counts)
    }
}

impl fmt::Display for LightingTerms {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            transport,
            max_depth,
            lights,
        } = self;
        write!(out, "lights         {}, depth {max_depth}", lights.len())?;
        writeln!(
            out,
            "{}",
            if *transport == "path" {
                ", by paths"
            } else {
                ""
            }
        )?;
        for (index, light) in lights.iter().enumerate() {
            write!(out, "  lights[{index}]")?;
            if let Some(name) = &light.name {
                write!(out, " {name:?}")?;
            }
            let color = vector(light.color);
            write!(
                out,
                ": {}, color {color}, intensity {:?}",
                light.kind, light.intensity
            )?;
            if let Some(radius) = light.radius {
                write!(out, ", radius {radius:?}")?;
            }
            if let Some(angle) = light.angle {
                write!(out, ", angle {angle:?}")?;
            }
            writeln!(out, "{}", if light.shadows { ", shadows" } else { "" })?;
        }
        Ok(())
    }
}

impl fmt::Display for Materials {
    /// Nothing for colors alone, which are matte.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.keys().all(|kind| *kind == "matte") {
            return Ok(());
        }
        let counts = self.0.iter().map(|(kind, count)| format!("{count} {kind}"));
        let counts: Vec<_> = counts.collect();
        writeln!(out, "materials      {}", counts.join(", "))
    }
}
