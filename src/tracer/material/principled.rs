//! A surface between metal and plastic.

use crate::tracer::{
    color::Color,
    error::GeometryError,
    material::{
        glass::INDICES,
        lobes::{Layered, Lobes},
        microfacet::{Microfacets, rough},
        parameters::{Number, parameters},
    },
    vector::in_range,
};

parameters! {
    /// A surface of metal, or of a coat above a diffuse one, or a mixture of both (as in glTF 2.0, appendix
    /// B).
    pub struct Principled {
        /// The color: that of the metal, and of the surface below the coat.
        color: Color,
        /// The part that is metal.
        metallic: Number,
        /// The roughness: 0 for a mirror.
        roughness: Number,
        /// The index of refraction of the coat.
        ior: Number,
        ; facets: Microfacets
    }
}

impl Principled {
    /// Creates a surface of which a part is metal, and the rest a coat with an index of refraction above a
    /// diffuse surface.
    ///
    /// # Errors
    ///
    /// Returns an error if `metallic` lies outside of 0..=1, `ior` outside of 0.25..=4, or if `roughness` is
    /// neither 0 nor in 0.01..=1.
    pub fn new(
        color: Color,
        metallic: f64,
        roughness: f64,
        ior: f64,
    ) -> Result<Self, GeometryError> {
        Ok(Self {
            color,
            metallic: in_range(metallic, "metallic", [0.0, 1.0])?,
            roughness: rough(roughness)?,
            ior: in_range(ior, "ior", INDICES)?,
            facets: Microfacets::new(roughness),
        })
    }
}

pub(super) const EQUATION: &str = "Σ π·f·I + A · L(mirror)";

pub(super) const fn lobes(principled: &Principled) -> Lobes<'_> {
    Lobes {
        layered: Some(Layered {
            color: principled.color,
            metallic: principled.metallic,
            ior: principled.ior,
            facets: principled.facets,
        }),
        ..Lobes::NONE
    }
}
