//! The lobes of a surface: the ways in which it sends light.

use crate::tracer::{
    color::Color,
    material::{emissive::Emissive, glass::Glass, microfacet::Microfacets},
};

/// The lobes of a surface. The light that it sends is the sum of theirs.
///
/// Integrators ask for these and never for the kind of material, and name every lobe, so that the
/// compiler lists them if there is a new one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lobes<'m> {
    /// Light that the surface sends whatever arrives.
    pub(crate) emission: Option<Emissive>,
    /// The factor of light that is scattered evenly to all sides (Lambert).
    pub(crate) diffuse: Option<Color>,
    /// Light that is scattered around the mirrored direction.
    pub(crate) highlight: Option<Highlight>,
    /// Light that metal reflects, or a coat and the diffuse surface below it.
    pub(crate) layered: Option<Layered>,
    /// The factor of light that is reflected as by a mirror.
    pub(crate) mirror: Option<Color>,
    /// The interface at which light is reflected and refracted.
    pub(crate) interface: Option<&'m Glass>,
}

/// Light that is scattered around the mirrored direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Highlight {
    pub(crate) color: Color,
    pub(crate) exponent: f64,
}

/// Metal, and a coat above a diffuse surface, side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Layered {
    /// The color of both.
    pub(crate) color: Color,
    /// The part that is metal.
    pub(crate) metallic: f64,
    /// The index of refraction of the coat.
    pub(crate) ior: f64,
    /// The normals of both.
    pub(crate) facets: Microfacets,
}

impl Lobes<'_> {
    /// No lobe: black.
    pub(crate) const NONE: Self = Self {
        emission: None,
        diffuse: None,
        highlight: None,
        layered: None,
        mirror: None,
        interface: None,
    };

    /// Creates the lobe of a surface that shows a color in any light.
    pub(crate) const fn shown(color: Color) -> Self {
        Self {
            emission: Some(Emissive::one(color)),
            ..Self::NONE
        }
    }

    /// Returns true if the surface sends rays on. A black mirror sends none.
    pub(crate) fn sends_rays(&self) -> bool {
        let is_mirror = self.mirror.is_some_and(|color| color != Color::BLACK);
        is_mirror || self.interface.is_some() || self.layered.is_some()
    }

    /// Returns true if the surface scatters the light of lights.
    pub(crate) const fn scatters(&self) -> bool {
        self.diffuse.is_some() || self.highlight.is_some() || self.layered.is_some()
    }
}

/// What some materials do with light.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LightOfMaterials {
    /// True if one of them sends rays on.
    pub(crate) sends_rays: bool,
    /// The largest intensity of one that shines.
    pub(crate) brightest: f64,
}

impl LightOfMaterials {
    pub(crate) fn new(lobes: &Lobes) -> Self {
        Self {
            sends_rays: lobes.sends_rays(),
            brightest: lobes.emission.map_or(0.0, |emission| emission.intensity()),
        }
    }

    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            sends_rays: self.sends_rays || other.sends_rays,
            brightest: self.brightest.max(other.brightest),
        }
    }
}
