//! A rough surface between two media: tiny mirrors that reflect and refract (B. Walter and others,
//! Microfacet models for refraction through rough surfaces, 2007).
//!
//! All vectors are in a frame whose third axis is the normal on the side of the viewer, `v`.

use std::{
    collections::BTreeMap,
    sync::{Mutex, OnceLock, PoisonError},
};

use glam::DVec3;

use crate::tracer::{
    material::{
        bsdf::Scattering,
        glass::Fresnel,
        microfacet::{LEAST_COSINE, Microfacets, NODES, each_midpoint, mirrored, node, place_of},
    },
    radiance::Radiance,
    sampling::UnitPair,
    vector::{is_direction, unit},
};

/// A rough surface as a viewer sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoughGlass {
    v: DVec3,
    facets: Microfacets,
    /// The index of refraction behind the surface, relative to that before it.
    eta: f64,
    /// The factor of light that comes through.
    color: Radiance,
    /// True for a pane, through which light goes as it is reflected, but to the other side.
    is_pane: bool,
    /// The part of light that the tiny mirrors send to the viewer, without what they send to each other.
    part: f64,
}

impl RoughGlass {
    /// Creates a surface of which light comes to a viewer.
    pub(crate) fn new(
        v: DVec3,
        facets: Microfacets,
        (eta, color): (f64, Radiance),
        is_pane: bool,
    ) -> Self {
        let v = DVec3::new(v.x, v.y, v.z.max(LEAST_COSINE));
        let part = match is_pane {
            true => facets.parts(v.z).into_iter().sum(),
            false => sent(&facets, eta, v.z),
        };
        Self {
            v,
            facets,
            eta,
            color,
            is_pane,
            part,
        }
    }

    /// Returns the light that comes from a direction.
    pub(crate) fn from(&self, l: DVec3) -> Scattering {
        let is_reflected = l.z > 0.0;
        let on_side = match self.is_pane {
            true => DVec3::new(l.x, l.y, l.z.abs()),
            false => l,
        };
        let sum = match on_side.z > 0.0 {
            true => self.v + on_side,
            false => self.v + self.eta * l,
        };
        if l.z == 0.0 || !is_direction(sum) {
            return Scattering::NONE;
        }
        let h = match unit(sum) {
            h if h.z < 0.0 => -h,
            h => h,
        };
        let (to_v, to_l) = (self.v.dot(h), on_side.dot(h));
        let is_possible = to_v > 0.0 && (to_l > 0.0) == (on_side.z > 0.0);
        if !is_possible {
            return Scattering::NONE;
        }
        let reflected = Fresnel::new(to_v, self.eta).reflected;
        let (chance, color) = match is_reflected {
            true => (reflected, Radiance::WHITE),
            false => (1.0 - reflected, self.color),
        };
        let stretch = match on_side.z > 0.0 {
            true => 1.0 / (4.0 * to_v),
            false => {
                let sum = to_v + self.eta * to_l;
                self.eta * self.eta * to_l.abs() / (sum * sum)
            }
        };
        let density = self.facets.density(self.v, h) * chance * stretch;
        let weight = self.facets.seen_again(self.v.z, l.z.abs()) / self.part;
        Scattering {
            diffuse: Radiance::BLACK,
            all: color * (density * weight),
            density,
        }
    }

    /// Chooses reflection or refraction by a number and a direction by a pair; `None` if that leads to the
    /// wrong side.
    pub(crate) fn sample(&self, u: f64, pair: UnitPair) -> Option<DVec3> {
        let h = self.facets.sample(self.v, pair);
        let fresnel = Fresnel::new(self.v.dot(h), self.eta);
        if u < fresnel.reflected {
            let l = mirrored(self.v, h);
            return (l.z > 0.0).then_some(l);
        }
        let l = match self.is_pane {
            true => {
                let l = mirrored(self.v, h);
                DVec3::new(l.x, l.y, -l.z)
            }
            false => refracted(self.v, h, &fresnel),
        };
        (l.z < 0.0).then_some(l)
    }
}

/// Returns the direction in which a tiny mirror refracts.
fn refracted(v: DVec3, h: DVec3, fresnel: &Fresnel) -> DVec3 {
    -v / fresnel.eta + (v.dot(h) / fresnel.eta - fresnel.cos_refracted) * h
}

/// Returns the part of light that tiny mirrors reflect and refract to a viewer, from a table for each
/// distribution and index, which is kept.
fn sent(facets: &Microfacets, eta: f64, cosine: f64) -> f64 {
    type Table = OnceLock<[f64; NODES]>;
    static ALL: Mutex<BTreeMap<[u64; 2], &'static Table>> = Mutex::new(BTreeMap::new());
    let table = {
        let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
        let new = || -> &'static Table { Box::leak(Box::new(OnceLock::new())) };
        let key = [facets.alpha().to_bits(), eta.to_bits()];
        *all.entry(key).or_insert_with(new)
    };
    let of = |place| quadrature(facets, eta, node(place));
    let nodes = table.get_or_init(|| std::array::from_fn(of));
    let (place, part) = place_of(cosine);
    nodes[place] + (nodes[place + 1] - nodes[place]) * part
}

fn quadrature(facets: &Microfacets, eta: f64, cosine: f64) -> f64 {
    let v = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let mut sum = 0.0;
    each_midpoint(|pair, weight| {
        let h = facets.sample(v, pair);
        let fresnel = Fresnel::new(v.dot(h), eta);
        let seen = |z: f64| match z > 0.0 {
            true => facets.seen_again(v.z, z),
            false => 0.0,
        };
        let (up, down) = (mirrored(v, h), refracted(v, h, &fresnel));
        let reflected = fresnel.reflected;
        sum += weight * (reflected * seen(up.z) + (1.0 - reflected) * seen(-down.z));
    });
    sum
}
