//! A hash of everything a picture shows, to check if two pictures come from the same scene.

use std::{
    mem,
    ops::Range,
    sync::{Arc, OnceLock},
};

use glam::DVec3;
use sha2::{Digest, Sha256};

use crate::{
    film::Outlines,
    scene::origins::Origins,
    tracer::{
        camera::{Camera, basis::Basis},
        color::Color,
        geometry::Geometry,
        light::{
            Light,
            transport::{PathOptions, PixelFilter, Transport},
        },
        material::{
            Material,
            binding::{MaterialBinding, VertexColors},
            parameters::Parameter,
        },
        tone::{Tone, ToneMapping},
        world::{Lighting, World},
    },
};

/// Hashes everything a picture depends on, number by number.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fingerprint {
    hash: Sha256,
    /// Bytes that are not hashed yet: hashing larger pieces is faster.
    bytes: Vec<u8>,
}

/// Minimum number of bytes to hash at once.
const PIECE: usize = 1 << 12;

/// The hash of a world. Frames share the hashes of those runs of geometries in which nothing changes.
#[derive(Clone, Debug)]
pub(crate) struct WorldHash {
    whole: OnceLock<String>,
    runs: Vec<Arc<OnceLock<String>>>,
}

/// The number of geometries in a run.
const RUN: usize = if cfg!(test) { 2 } else { 1 << 10 };

impl WorldHash {
    /// Prepares the hash of a world, which is computed on first use.
    pub(crate) fn new(world: &World) -> Self {
        let runs = world.geometries().len().div_ceil(RUN);
        Self {
            whole: OnceLock::new(),
            runs: (0..runs).map(|_| Arc::default()).collect(),
        }
    }

    /// Prepares the hash of a world in which other geometries stand in these places.
    pub(crate) fn replaced(&self, places: impl Iterator<Item = Range<usize>>) -> Self {
        let mut runs = self.runs.clone();
        for place in places.filter(|place| !place.is_empty()) {
            for run in &mut runs[place.start / RUN..=(place.end - 1) / RUN] {
                *run = Arc::default();
            }
        }
        Self {
            whole: OnceLock::new(),
            runs,
        }
    }

    /// Returns the hash of a world, the one that it was prepared for.
    pub(crate) fn of(&self, world: &World) -> &str {
        self.whole.get_or_init(|| {
            let mut fingerprint = Fingerprint::default();
            let (geometries, background, backdrop, lighting) = world.parts();
            fingerprint.color(background);
            if let Some(backdrop) = backdrop {
                fingerprint.text(backdrop.kind());
                backdrop.each_number(|number| fingerprint.number(number));
            }
            for (run, geometries) in self.runs.iter().zip(geometries.chunks(RUN)) {
                fingerprint.text(run.get_or_init(|| {
                    let mut fingerprint = Fingerprint::default();
                    for geometry in geometries {
                        fingerprint.geometry(geometry);
                    }
                    fingerprint.digits()
                }));
            }
            if let Some(Lighting {
                lights,
                max_depth,
                transport,
            }) = lighting
            {
                fingerprint.text("lit");
                fingerprint.number(f64::from(*max_depth));
                fingerprint.transport(transport);
                lights.iter().for_each(|light| fingerprint.light(light));
            }
            fingerprint.digits()
        })
    }
}

impl Fingerprint {
    /// Adds a string, such as an option.
    pub(crate) fn text(&mut self, text: &str) {
        self.push(&(text.len() as u64).to_le_bytes());
        self.push(text.as_bytes());
    }

    pub(crate) fn camera(&mut self, camera: &Camera) {
        let (kind, number, basis) = match camera {
            Camera::Perspective(camera) => {
                let (basis, half_angle, lens) = camera.parts();
                if let Some(lens) = lens {
                    self.text("lens");
                    self.number(lens.aperture());
                    self.number(lens.focus());
                }
                ("perspective", half_angle, basis)
            }
            Camera::Orthographic(camera) => {
                let (basis, scale, stretch) = camera.parts();
                let kind = if stretch { "stretched" } else { "orthographic" };
                (kind, scale, basis)
            }
        };
        self.text(kind);
        self.number(number);
        // `u`, `v` and `w` are derived from `gaze` and `up`.
        let Basis {
            eye,
            gaze: _,
            up: _,
            u,
            v,
            w,
        } = basis;
        for vector in [eye, u, v, w] {
            self.vector(vector);
        }
    }

    /// Adds the names of geometries, also those in parts and groups, from which layers have theirs.
    pub(crate) fn names(&mut self, origins: &Origins) {
        for (geometry, name) in origins.names() {
            self.text(&geometry.to_string());
            self.text(name);
        }
        for (kind, geometry, indices, list) in origins.lists() {
            self.text(&format!("{kind} {geometry} {indices:?}"));
            self.names(list);
        }
    }

    /// Adds what turns the light of a picture into colors. Without lights and lines there is nothing
    /// of that kind.
    pub(crate) fn develop(&mut self, tone: Option<Tone>, outlines: Option<&Outlines>) {
        if let Some(tone) = tone {
            self.text(match tone.mapping() {
                ToneMapping::Clip => "clip",
                ToneMapping::Neutral => "neutral",
            });
            self.number(tone.exposure());
        }
        if let Some(Outlines {
            width,
            color,
            depth,
            creases,
        }) = outlines
        {
            self.text("outlines");
            self.number(*width);
            self.color(*color);
            // No number is below 0.
            self.number(depth.unwrap_or(-1.0));
            self.number(creases.unwrap_or(-1.0));
        }
    }

    /// Adds the options of paths but for their number, which is one of the picture; direct lighting has none.
    fn transport(&mut self, transport: &Transport) {
        let PathOptions {
            samples: _,
            diffuse_depth,
            caustics,
            clamp,
            noise,
            seed,
            filter,
        } = match transport {
            Transport::Direct => return,
            Transport::Path(options) => *options,
        };
        self.text("path");
        // No number is below 0.
        self.numbers([
            diffuse_depth.map_or(-1.0, f64::from),
            f64::from(u8::from(caustics)),
            clamp.unwrap_or(-1.0),
        ]);
        self.number(noise.unwrap_or(-1.0));
        self.number(seed.into());
        if let PixelFilter::Gaussian(sigma) = filter {
            self.text("gaussian");
            self.number(sigma);
        }
    }

    fn light(&mut self, light: &Light) {
        self.text(light.kind());
        self.color(light.glow().color());
        self.number(light.glow().intensity());
        light.each_number(|number| self.number(number));
    }

    fn geometry(&mut self, geometry: &Geometry) {
        let (shape, binding) = geometry.parts();
        self.text(shape.kind());
        shape.each_number(|number| self.number(number));
        if let Some(copies) = shape.copies() {
            copies.shapes().for_each(|shape| self.text(shape.kind()));
        }
        self.binding(binding);
    }

    fn binding(&mut self, binding: &MaterialBinding) {
        match binding {
            MaterialBinding::Plain(_) => {}
            MaterialBinding::ByFace(_) => self.text("faces"),
            MaterialBinding::ByVertex(materials) => self.vertices(materials.vertices()),
            MaterialBinding::Textured(textured) => {
                self.text("texture");
                textured.each_number(|number| self.number(number));
            }
            MaterialBinding::ByShape(all) => {
                self.text("shapes");
                return all.bindings().iter().for_each(|one| self.binding(one));
            }
        }
        binding.all().for_each(|material| self.material(material));
    }

    fn vertices(&mut self, vertices: &VertexColors) {
        match vertices {
            VertexColors::Colors(colors) => {
                self.text("colors");
                let channels = colors.iter().map(|color| [color.r(), color.g(), color.b()]);
                channels.for_each(|channels| self.numbers(channels));
            }
            VertexColors::OfTriangles(colors) => {
                self.text("colors of triangles");
                colors.iter().for_each(|color| self.color(*color));
            }
            VertexColors::Values(values, scale) => {
                self.text("values");
                values.iter().for_each(|value| self.number(*value));
                let range = scale.range.unwrap_or_default();
                range.into_iter().for_each(|end| self.number(end));
                let colors = scale.map.colors().iter();
                colors.for_each(|color| self.color(*color));
                self.color(scale.missing);
            }
        }
    }

    fn material(&mut self, material: &Material) {
        // Nothing but its color is known of a material that is one alone.
        if *material != Material::from(material.color()) {
            self.text(material.kind());
            let mut is_first = true;
            material.each_parameter(|parameter| match parameter {
                Parameter::Color(..) if mem::take(&mut is_first) => {}
                Parameter::Color(_, color) => self.color(color),
                Parameter::Number(_, number) => self.number(number),
            });
        }
        if let Some(glass) = material.glass().filter(|glass| glass.roughness() > 0.0) {
            self.number(glass.roughness());
        }
        self.color(material.color());
    }

    fn color(&mut self, color: Color) {
        self.numbers([color.r(), color.g(), color.b()]);
    }

    fn vector(&mut self, vector: DVec3) {
        self.numbers(vector.to_array());
    }

    fn numbers(&mut self, numbers: [f64; 3]) {
        numbers.into_iter().for_each(|number| self.number(number));
    }

    fn number(&mut self, number: f64) {
        self.push(&number.to_le_bytes());
    }

    fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
        if self.bytes.len() >= PIECE {
            self.hash.update(&self.bytes);
            self.bytes.clear();
        }
    }

    /// Returns the SHA-256 of everything added, in hexadecimal digits.
    pub(crate) fn digits(mut self) -> String {
        self.hash.update(&self.bytes);
        let bytes = self.hash.finalize();
        bytes.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}
