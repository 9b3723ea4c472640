//! The declaration of a value that is one of several: of objects, each with its name, or of words.
//!
//! ```text
//! variants! {
//!     /// A light.
//!     pub enum LightModel = "Light" {
//!         /// Light from a point in all directions.
//!         Point(PointLightModel) | PointLight,
//!     }
//! }
//! ```
//!
//! Behind a `|` stand the names that other programs give a variant. `= "Light" for of_each` also defines
//! a macro of this name, which evaluates an expression for the object of each variant.

/// Defines an enum of objects, which forwards everything to its current variant.
macro_rules! variants {
    (
        $(#[$($meta:tt)*])* pub enum $model:ident = $name:literal $(for $each:ident)? {
            $($(#[$($doc:tt)*])* $variant:ident($thing:ty) $(| $other:ident)*),* $(,)?
        }
    ) => {
        $(#[$($meta)*])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(rename = $name, deny_unknown_fields)]
        pub enum $model {
            $($(#[$($doc)*])* $variant($thing)),*
        }

        const _: () = {
            use $crate::scene::format::{field, object, thing};

            impl $model {
                /// All variants with their fields.
                pub(crate) const VARIANTS: &'static [thing::Variant] = &[$(
                    thing::Variant {
                        name: stringify!($variant),
                        docs: object::docs!($([$($doc)*])*),
                        others: &[$(stringify!($other)),*],
                        content: Some(<$thing as thing::Thing>::of_type),
                    },
                )*];
            }

            impl thing::Thing for $model {
                fn of_type() -> thing::Type {
                    static ONE_OF: thing::OneOf = thing::OneOf {
                        name: $name,
                        docs: object::docs!($([$($meta)*])*),
                        variants: $model::VARIANTS,
                        are_operands: false,
                    };
                    thing::Type::OneOf(&ONE_OF)
                }

                fn inner(&self) -> Option<&dyn thing::Thing> {
                    match self {
                        $(Self::$variant(thing) => Some(thing)),*
                    }
                }

                fn inner_mut(&mut self) -> Option<&mut dyn thing::Thing> {
                    match self {
                        $(Self::$variant(thing) => Some(thing)),*
                    }
                }

                #[inline]
                fn each<'m>(&'m self, see: impl FnMut(&'static field::Field, field::Value<'m>)) {
                    match self {
                        $(Self::$variant(thing) => thing.each(see)),*
                    }
                }

                fn variant(&self) -> Option<&'static str> {
                    match self {
                        $(Self::$variant(_) => Some(stringify!($variant))),*
                    }
                }

                fn enter<F: thing::Follow>(
                    &mut self,
                    step: &$crate::diagnostic::path::Step,
                    follow: F,
                ) -> Result<F::Out, F> {
                    match self {
                        $(Self::$variant(thing) => thing.enter(step, follow)),*
                    }
                }
            }
        };

        $crate::scene::format::variants::variants! {
            @each ($) [$($each)?] $model $($variant)*
        }
    };
    (@each ($d:tt) [] $($model:tt)*) => {};
    (@each ($d:tt) [$each:ident] $model:ident $($variant:ident)*) => {
        /// Evaluates an expression for the object of each variant.
        macro_rules! $each {
            ($d one:expr, $d object:ident => $d value:expr) => {
                match $d one { $($model::$variant($d object) => $d value),* }
            };
        }
    };
}

/// Defines an enum of words, of which one may have content of the given type.
macro_rules! words {
    (
        $(#[$($meta:tt)*])* pub enum $model:ident = $name:literal {
            $($(#[$($doc:tt)*])* $variant:ident $(($content:ty): $of:expr)?),* $(,)?
        }
    ) => {
        $(#[$($meta)*])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(rename = $name, deny_unknown_fields)]
        pub enum $model {
            $($(#[$($doc)*])* $variant $(($content))?),*
        }

        impl $model {
            /// Returns the type.
            pub(crate) fn of_type() -> $crate::scene::format::thing::Type {
                use $crate::scene::format::{object, thing};

                static ONE_OF: thing::OneOf = thing::OneOf {
                    name: $name,
                    docs: object::docs!($([$($meta)*])*),
                    variants: &[$(
                        thing::Variant {
                            name: stringify!($variant),
                            docs: object::docs!($([$($doc)*])*),
                            others: &[],
                            content: $crate::scene::format::variants::words!(@content $($of)?),
                        },
                    )*],
                    are_operands: false,
                };
                thing::Type::OneOf(&ONE_OF)
            }
        }
    };
    (@content) => { None };
    (@content $of:expr) => { Some(|| $of) };
}

pub(crate) use {variants, words};
