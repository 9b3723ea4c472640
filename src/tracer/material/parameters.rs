//! The parameters of a material, defined once.

use crate::tracer::color::Color;

/// A parameter of a material: its name and its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Parameter {
    Color(&'static str, Color),
    Number(&'static str, f64),
}

/// The parameters of a material. The first is a color.
pub(super) trait Parameters {
    fn first(&self) -> Color;

    fn with_first(&self, first: Color) -> Self;

    /// Calls `see` with each parameter.
    fn each(&self, see: impl FnMut(Parameter));
}

impl Parameters for Color {
    fn first(&self) -> Color {
        *self
    }

    fn with_first(&self, first: Color) -> Self {
        first
    }

    fn each(&self, mut see: impl FnMut(Parameter)) {
        see(Parameter::Color("color", *self));
    }
}

/// Defines a material of several parameters, and of what derives from all but the first, behind a `;`.
macro_rules! parameters {
    ($(#[$doc:meta])* pub struct $material:ident {
        $(#[$about:meta])* $first:ident: Color,
        $($(#[$what:meta])* $field:ident: $kind:ident,)*
        $(; $derived:ident: $of:ty)?
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $material {
            $first: Color,
            $($field: $kind,)*
            $($derived: $of)?
        }

        impl $material {
            $(#[$about])*
            pub const fn $first(&self) -> Color {
                self.$first
            }

            $($(#[$what])*
            pub const fn $field(&self) -> $kind {
                self.$field
            })*
        }

        impl $crate::tracer::material::parameters::Parameters for $material {
            fn first(&self) -> Color {
                self.$first
            }

            fn with_first(&self, $first: Color) -> Self {
                Self { $first, ..*self }
            }

            fn each(&self, mut see: impl FnMut($crate::tracer::material::parameters::Parameter)) {
                use $crate::tracer::material::parameters::Parameter;
                see(Parameter::Color(stringify!($first), self.$first));
                $(see(Parameter::$kind(stringify!($field), self.$field));)*
            }
        }
    };
}

pub(super) use parameters;

/// The type of a [`Parameter::Number`].
pub(crate) type Number = f64;
