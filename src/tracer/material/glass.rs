//! A surface that reflects and refracts.

use crate::tracer::{
    color::Color,
    error::GeometryError,
    material::{
        lobes::Lobes,
        microfacet::{Microfacets, rough},
        parameters::{Number, parameters},
    },
    vector::in_range,
};

/// The limits of an index of refraction.
pub(crate) const INDICES: [f64; 2] = [0.25, 4.0];

parameters! {
    /// A surface between air and glass.
    pub struct Glass {
        /// The color of refracted light.
        color: Color,
        /// The index of refraction.
        ior: Number,
        ; facets: Microfacets
    }
}

/// The reflection and refraction of light at a surface of glass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel {
    /// The part of the light that is reflected, F.
    pub reflected: f64,
    /// The index of refraction behind the surface, relative to that before it.
    pub eta: f64,
    /// The cosine of the angle of the refracted ray, 0 for total reflection.
    pub cos_refracted: f64,
}

impl Glass {
    /// Creates glass: refracted light is multiplied by `color` at each surface.
    ///
    /// # Errors
    ///
    /// Returns an error if the index of refraction, `ior`, lies outside of 0.25..=4.
    pub fn new(color: Color, ior: f64) -> Result<Self, GeometryError> {
        let ior = in_range(ior, "ior", INDICES)?;
        let facets = Microfacets::new(0.0);
        Ok(Self { color, ior, facets })
    }

    /// Gives the glass a roughness, which it has where light follows paths: 0 for a smooth surface.
    ///
    /// # Errors
    ///
    /// Returns an error if the roughness is neither 0 nor in 0.01..=1.
    pub fn with_roughness(self, roughness: f64) -> Result<Self, GeometryError> {
        let facets = Microfacets::new(rough(roughness)?);
        Ok(Self { facets, ..self })
    }

    /// The roughness.
    pub fn roughness(&self) -> f64 {
        self.facets.roughness()
    }

    /// The distribution of its normals.
    pub(crate) const fn facets(&self) -> &Microfacets {
        &self.facets
    }

    /// Returns the reflection and refraction of a ray that meets the surface at an angle with this
    /// cosine, from outside or from inside.
    pub fn fresnel(&self, cosine: f64, from_outside: bool) -> Fresnel {
        Fresnel::new(
            cosine,
            if from_outside {
                self.ior
            } else {
                1.0 / self.ior
            },
        )
    }
}

impl Fresnel {
    /// Returns the reflection and refraction of a ray that meets a surface at an angle with this cosine,
    /// given the index behind it relative to that before it.
    ///
    /// Snell's law gives the refracted ray; Fresnel's equations, for unpolarized light, the
    /// reflected part (Born and Wolf, "Principles of Optics", section 1.5).
    pub(crate) fn new(cosine: f64, eta: f64) -> Self {
        let squared = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
        // Also if the cosine is slightly above 1, squared is.
        if squared <= 0.0 {
            return Self {
                reflected: 1.0,
                eta,
                cos_refracted: 0.0,
            };
        }
        let cos_refracted = squared.sqrt();
        let perpendicular = (cosine - eta * cos_refracted) / (cosine + eta * cos_refracted);
        let parallel = (eta * cosine - cos_refracted) / (eta * cosine + cos_refracted);
        Self {
            reflected: (perpendicular * perpendicular + parallel * parallel) / 2.0,
            eta,
            cos_refracted,
        }
    }
}

pub(super) const EQUATION: &str = "F · L(mirror) + (1-F)·lin(color) · L(refracted)";

pub(super) const fn lobes(glass: &Glass) -> Lobes<'_> {
    Lobes {
        interface: Some(glass),
        ..Lobes::NONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glass() -> Glass {
        Glass::new(Color::WHITE, 1.5).unwrap()
    }

    // 4 % of the light is reflected where it meets a window head-on.
    #[test]
    fn a_window_reflects_a_twenty_fifth() {
        let head_on = glass().fresnel(1.0, true);
        assert!((head_on.reflected - 0.04).abs() < 1e-15);
        assert!((glass().fresnel(1.0, false).reflected - 0.04).abs() < 1e-15);
        assert_eq!(glass().fresnel(0.0, true).reflected, 1.0, "grazing");
    }

    #[test]
    fn from_inside_all_is_reflected_beyond_the_critical_angle() {
        // sin θ = 1/1.5
        let critical = (1.0 - 1.0 / 2.25_f64).sqrt();
        assert_eq!(glass().fresnel(critical - 1e-9, false).reflected, 1.0);
        assert!(glass().fresnel(critical + 1e-6, false).reflected < 1.0);
    }

    // tan θ = 1.5: the parallel part is not reflected.
    #[test]
    fn at_brewsters_angle_one_polarization_is_left() {
        let cosine = 1.0 / (1.0 + 2.25_f64).sqrt();
        let found = glass().fresnel(cosine, true);
        let perpendicular = (2.25 - 1.0_f64) / (2.25 + 1.0);
        assert!((found.reflected - perpendicular * perpendicular / 2.0).abs() < 1e-15);
    }
}
