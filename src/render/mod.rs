//! Rendering: the view of a camera into a world, and the layers of a picture.

pub(crate) mod explained;
pub(crate) mod hits;
pub(crate) mod layers;
mod legend;
mod outlines;
pub(crate) mod ray_tracer;
pub(crate) mod shading;
#[cfg(test)]
mod tests;
pub(crate) mod visibility;

pub use crate::tracer::{
    colormap::Colormap,
    tone::{Tone, ToneMapping},
};
pub use layers::Layer;
pub use legend::Legend;
pub use shading::picture_sums::PictureSums;
pub use visibility::Seen;

#[doc(hidden)]
pub use self::explained::{ExplainedPaths, ExplainedPixel, ExplainedSample};
pub use crate::simd::isa::Isa;
#[doc(hidden)]
pub use crate::{
    film::parts::LightParts,
    integrator::explain::{RayEnd, Shading, ShiningLight, TracedRay, explain},
    integrator::path::{
        emitters::{EmittedBy, EmitterChance},
        explain::{ExplainedPath, PathSegment},
    },
    tracer::shape::working::{Term, Working},
};
