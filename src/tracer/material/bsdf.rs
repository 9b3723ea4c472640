//! The scattering of light at a point of a surface: the lobes of its material around a normal.
//!
//! All directions are in a frame whose third axis is the normal on the side of the viewer.

use std::f64::consts::PI;

use glam::DVec3;

use crate::tracer::{
    color::Color,
    material::{
        lobes::{Layered, Lobes},
        microfacet::{LEAST_COSINE, Microfacets, mirrored, schlick},
    },
    radiance::Radiance,
    sampling::{UnitPair, cosine_density, cosine_weighted},
    vector::unit,
};

/// The lobes of a surface that scatter light to the viewer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bsdf {
    v: DVec3,
    /// The part of light that is scattered evenly to all sides.
    diffuse: Radiance,
    /// The coat above that, if there is one: the part that gets through it, from each direction, counts.
    coat: Option<ClearCoat>,
    /// Light that is reflected by tiny mirrors.
    gloss: Option<TinyMirrors>,
    /// The part that is reflected as by a mirror.
    mirror: Radiance,
    /// The probabilities of the mirror and of the tiny ones.
    chances: [f64; 2],
}

/// The upper side of a diffuse surface, which reflects this part of light that arrives along the normal.
#[derive(Clone, Copy, Debug)]
struct ClearCoat {
    facets: Microfacets,
    f0: f64,
}

/// The reflection of tiny mirrors.
#[derive(Clone, Copy, Debug)]
struct TinyMirrors {
    facets: Microfacets,
    fresnel: Reflectance,
}

/// The part of light that a tiny mirror reflects.
#[derive(Clone, Copy, Debug)]
enum Reflectance {
    /// The same at each angle.
    Constant(Radiance),
    /// The sum of two layers: the part along the normal and a factor of each.
    Layers([[Radiance; 2]; 2]),
}

/// The light that lobes scatter from one direction to the viewer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scattering {
    /// The value of the diffuse lobe, times the cosine of the direction.
    pub(crate) diffuse: Radiance,
    /// The same of all lobes.
    pub(crate) all: Radiance,
    /// The density with which [`Bsdf::sample`] chooses the direction.
    pub(crate) density: f64,
}

/// The direction in which a path goes on.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Onto {
    /// A direction, and whether the diffuse lobe chose it.
    Direction(DVec3, bool),
    /// The mirrored direction, with the factor of its light.
    Mirror(Radiance),
}

impl Scattering {
    /// None.
    pub(crate) const NONE: Self = Self {
        diffuse: Radiance::BLACK,
        all: Radiance::BLACK,
        density: 0.0,
    };

    /// Returns the part of the light that the diffuse lobe scatters, by channel; 0 where there is none.
    pub(crate) fn diffuse_share(&self) -> Radiance {
        let channels = self.diffuse.channels.into_iter().zip(self.all.channels);
        let mut share = Radiance::BLACK;
        for (share, (diffuse, all)) in share.channels.iter_mut().zip(channels) {
            *share = if all > 0.0 { diffuse / all } else { 0.0 };
        }
        share
    }
}

impl ClearCoat {
    /// Returns the part of light from a direction that gets through.
    fn passes(&self, cosine: f64) -> f64 {
        1.0 - reflected(self.f0, self.facets.parts(cosine))
    }
}

impl Reflectance {
    /// Returns the part that is reflected at an angle with this cosine.
    fn at(&self, cosine: f64) -> Radiance {
        match self {
            Self::Constant(part) => *part,
            Self::Layers(layers) => {
                let f = schlick(cosine);
                let of = |[f0, factor]: [Radiance; 2]| (f0 + (Radiance::WHITE - f0) * f) * factor;
                of(layers[0]) + of(layers[1])
            }
        }
    }
}

/// Returns the part of light that microfacets reflect, with what they lose to each other given back (E.
/// Turquin, Practical multiple scattering compensation for microfacet models, 2019).
fn reflected(f0: f64, [a, b]: [f64; 2]) -> f64 {
    (f0 * a + b) * compensation(f0, a + b)
}

fn compensation(f0: f64, all: f64) -> f64 {
    1.0 + f0 * (1.0 - all) / all
}

/// Applies a function to each channel.
fn each(light: Radiance, of: impl Fn(f64) -> f64) -> Radiance {
    Radiance {
        channels: light.channels.map(of),
    }
}

/// The colors of lobes in linear light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LobeColors {
    /// That of light which is emitted.
    pub(crate) emission: Radiance,
    diffuse: Radiance,
    mirror: Radiance,
    /// The color of metal and of what lies below a coat, or else that of a highlight.
    gloss: Radiance,
}

impl LobeColors {
    pub(crate) fn new(lobes: &Lobes) -> Self {
        let linear = |color: Option<Color>| color.map_or(Radiance::BLACK, Color::to_linear);
        let highlight = lobes.highlight.map(|highlight| highlight.color);
        let layered = lobes.layered.map(|layered| layered.color);
        Self {
            emission: lobes.emission.map_or(Radiance::BLACK, |it| it.radiance()),
            diffuse: linear(lobes.diffuse),
            mirror: linear(lobes.mirror),
            gloss: linear(layered.or(highlight)),
        }
    }
}

impl Bsdf {
    /// Creates the scattering of lobes to a viewer, given their colors.
    pub(crate) fn new(lobes: &Lobes, colors: &LobeColors, v: DVec3) -> Self {
        let v = DVec3::new(v.x, v.y, v.z.max(LEAST_COSINE));
        let plain = Self {
            v,
            diffuse: colors.diffuse,
            coat: None,
            gloss: None,
            mirror: colors.mirror,
            chances: [0.0; 2],
        };
        let bsdf = match (lobes.layered, lobes.highlight) {
            (Some(layered), _) => plain.layered(layered, colors.gloss),
            (None, Some(highlight)) => plain.phong(highlight.exponent, colors.gloss),
            (None, None) => plain,
        };
        bsdf.with_chances()
    }

    /// Returns the factor of the cosine in the light that lobes scatter, if they only do so evenly to all sides.
    pub(crate) fn evenly(lobes: &Lobes, colors: &LobeColors) -> Option<Radiance> {
        let diffuse = Lobes {
            diffuse: lobes.diffuse,
            ..Lobes::NONE
        };
        let is_it = *lobes == diffuse && colors.diffuse != Radiance::BLACK;
        is_it.then(|| colors.diffuse / PI)
    }

    /// Adds metal, and a coat above a diffuse surface.
    fn layered(self, of: Layered, color: Radiance) -> Self {
        let Layered {
            metallic,
            ior,
            facets,
            ..
        } = of;
        let ratio = (ior - 1.0) / (ior + 1.0);
        let f0 = ratio * ratio;
        let cosine = self.v.z;
        let [a, b] = facets.parts(cosine);
        let layer = |f0: Radiance, part: f64| [f0, each(f0, |f0| part * compensation(f0, a + b))];
        let layers = [
            layer(Radiance::WHITE * f0, 1.0 - metallic),
            layer(color, metallic),
        ];
        let fresnel = Reflectance::Layers(layers);
        let coat = ClearCoat { facets, f0 };
        let through = coat.passes(cosine) / (1.0 - reflected(f0, facets.mean_parts()));
        let diffuse = color * (1.0 - metallic);
        let (gloss, mirror) = match facets.is_smooth() {
            true => (None, fresnel.at(cosine)),
            false => (Some(TinyMirrors { facets, fresnel }), Radiance::BLACK),
        };
        Self {
            diffuse: diffuse * through,
            coat: Some(coat),
            gloss,
            mirror,
            ..self
        }
    }

    /// Adds a highlight as tiny mirrors: as wide as that of Phong and with its peak, as long as no light
    /// is added.
    fn phong(self, exponent: f64, color: Radiance) -> Self {
        let squared: f64 = 2.0 / (4.0 * exponent + 2.0);
        let facets = Microfacets::of_alpha(squared.min(1.0).sqrt());
        let f0 = each(color, |part| (4.0 * squared * part).min(1.0));
        let sum = (self.diffuse + f0 + self.mirror).max_channel().max(1.0);
        let fresnel = Reflectance::Constant(f0 / sum);
        Self {
            diffuse: self.diffuse / sum,
            gloss: Some(TinyMirrors { facets, fresnel }),
            mirror: self.mirror / sum,
            ..self
        }
    }

    /// Sets the probabilities of the lobes, in proportion to the light that they reflect.
    fn with_chances(self) -> Self {
        let [mirror, gloss, diffuse] = [
            self.mirror.mean(),
            self.glossy_part().mean(),
            self.diffuse_part().mean(),
        ];
        let sum = mirror + gloss + diffuse;
        let chances = match sum > 0.0 {
            true => [mirror / sum, gloss / sum],
            false => [0.0; 2],
        };
        Self { chances, ..self }
    }

    /// Returns the part of light that the tiny mirrors reflect to the viewer.
    fn glossy_part(&self) -> Radiance {
        let Some(TinyMirrors { facets, fresnel }) = self.gloss else {
            return Radiance::BLACK;
        };
        let [a, b] = facets.parts(self.v.z);
        match fresnel {
            Reflectance::Constant(part) => part * (a + b),
            Reflectance::Layers(layers) => {
                let of = |[f0, factor]: [Radiance; 2]| each(f0, |f0| f0 * a + b) * factor;
                of(layers[0]) + of(layers[1])
            }
        }
    }

    /// Returns the part of light that the diffuse lobe scatters to the viewer.
    pub(crate) fn diffuse_part(&self) -> Radiance {
        match &self.coat {
            None => self.diffuse,
            Some(coat) => {
                let mean = reflected(coat.f0, coat.facets.mean_parts());
                self.diffuse * (1.0 - mean)
            }
        }
    }

    /// Returns the part of light that is reflected, as by a mirror or around the mirrored direction.
    pub(crate) fn reflected_part(&self) -> Radiance {
        self.mirror + self.glossy_part()
    }

    /// Returns true if a mirror is all that there is.
    pub(crate) fn is_mirror(&self) -> bool {
        self.diffuse == Radiance::BLACK && self.gloss.is_none()
    }

    /// The part that is reflected as by a mirror.
    pub(crate) const fn mirror(&self) -> Radiance {
        self.mirror
    }

    /// Returns the light that comes from a direction.
    pub(crate) fn from(&self, l: DVec3) -> Scattering {
        if l.z <= 0.0 {
            return Scattering::NONE;
        }
        let [_, of_gloss] = self.chances;
        let through = self.coat.map_or(1.0, |coat| coat.passes(l.z));
        let diffuse = self.diffuse / PI * through * l.z;
        let of_diffuse = (1.0 - self.chances[0] - of_gloss).max(0.0);
        let density = of_diffuse * cosine_density(l.z);
        let Some(TinyMirrors { facets, fresnel }) = &self.gloss else {
            return Scattering {
                diffuse,
                all: diffuse,
                density,
            };
        };
        let h = unit(self.v + l);
        let cosine = self.v.dot(h);
        let glossy = fresnel.at(cosine) * facets.reflection(self.v, l, h);
        Scattering {
            diffuse,
            all: glossy + diffuse,
            density: of_gloss * (facets.density(self.v, h) / (4.0 * cosine)) + density,
        }
    }

    /// Chooses a lobe by a number and a direction by a pair.
    pub(crate) fn sample(&self, u: f64, pair: UnitPair) -> Onto {
        let [of_mirror, of_gloss] = self.chances;
        match &self.gloss {
            _ if u < of_mirror => Onto::Mirror(self.mirror / of_mirror),
            Some(gloss) if u < of_mirror + of_gloss => {
                let h = gloss.facets.sample(self.v, pair);
                Onto::Direction(mirrored(self.v, h), false)
            }
            _ => Onto::Direction(cosine_weighted(pair), true),
        }
    }
}
