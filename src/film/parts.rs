//! The parts of the light of a ray or a pixel. Layers and explanations have their names.

use std::ops::Add;

use crate::tracer::radiance::Radiance;

/// Defines the parts.
macro_rules! parts {
    ($($(#[$doc:meta])* $part:ident,)*) => {
        /// Light by its parts, of which it is the sum.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct LightParts {
            $($(#[$doc])* pub $part: Radiance,)*
        }

        impl LightParts {
            /// The names of the parts.
            pub const NAMES: [&'static str; [$(stringify!($part)),*].len()] =
                [$(stringify!($part)),*];

            /// Creates light from its parts, in the order of their names.
            pub(crate) const fn new([$($part),*]: [Radiance; Self::NAMES.len()]) -> Self {
                Self { $($part),* }
            }

            /// Returns the parts, in the order of their names.
            pub const fn all(self) -> [Radiance; Self::NAMES.len()] {
                [$(self.$part),*]
            }
        }

        impl Add for LightParts {
            type Output = Self;

            /// Adds part by part.
            #[inline]
            fn add(self, other: Self) -> Self {
                Self { $($part: self.$part + other.$part),* }
            }
        }
    };
}

parts! {
    /// What surfaces scatter and send themselves, and the background.
    direct,
    /// What surfaces reflect and let through.
    specular,
}

impl LightParts {
    /// Returns all light.
    #[inline]
    pub fn sum(self) -> Radiance {
        let all = self.all().into_iter();
        all.reduce(Radiance::add).unwrap_or_default()
    }

    /// Returns the same with each part mapped.
    pub(crate) fn map(self, map: impl FnMut(Radiance) -> Radiance) -> Self {
        Self::new(self.all().map(map))
    }
}
