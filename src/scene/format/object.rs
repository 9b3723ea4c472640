//! The declaration of a thing of the format, from which its struct, its reading, its defaults, its
//! values that change over time and its part of the schema follow.
//!
//! ```text
//! object! {
//!     /// A cone of light from a point.
//!     #[schemars(inline)]
//!     pub struct SpotLightModel = "Spot" {
//!         /// The position.
//!         position: Point,
//!         /// The part of the half angle over which the light fades.
//!         blend: Fraction = 0.15,
//!         /// The name.
//!         name: Name?,
//!     }
//! }
//! ```
//!
//! Behind a `|` stand the names that other programs, or the course, give a field: who writes one is told
//! the name. A field is required, or optional with a default, or optional without one (`?`); `?= value` is
//! for a field without a default that a track begins with a value. Behind the name of a field
//! stands its [`Kind`], which determines its type; `Kind(Type)` has another type, and `Thing(Type)`
//! has fields of its own, and `Choice(Type)` and `Other(Type)` are for what no number can set.
//!
//! [`Kind`]: crate::scene::format::field::Kind

/// Defines an object of the format.
macro_rules! object {
    ($(#[$meta:meta])* pub struct $model:ident = $name:literal { $($fields:tt)* }) => {
        $crate::scene::format::object::object! {
            @fields [$(#[$meta])* $model $name] [] $($fields)*
        }
    };

    // One field after another, with a list of those before it.
    (@fields $head:tt [$($done:tt)*]
        $(#[$meta:meta])* $field:ident $(as $rename:literal)? $(| $other:ident)*:
        $kind:ident $({ $most:expr })? $(($type:ty))? = $default:expr, $($rest:tt)*
    ) => {
        $crate::scene::format::object::object! {
            @fields $head [$($done)* {
                [$(#[$meta])* #[serde($(rename = $rename,)? skip_serializing_if = "Option::is_none")]]
                $field [$($rename)?] [$($other)*] optional $kind [$($most)?] [$($type)?] [$default] [$default]
            }] $($rest)*
        }
    };
    (@fields $head:tt [$($done:tt)*]
        $(#[$meta:meta])* $field:ident $(as $rename:literal)? $(| $other:ident)*:
        $kind:ident $({ $most:expr })? $(($type:ty))? ?= $first:expr, $($rest:tt)*
    ) => {
        $crate::scene::format::object::object! {
            @fields $head [$($done)* {
                [$(#[$meta])* #[serde($(rename = $rename,)? skip_serializing_if = "Option::is_none")]]
                $field [$($rename)?] [$($other)*] optional $kind [$($most)?] [$($type)?] [$first] []
            }] $($rest)*
        }
    };
    (@fields $head:tt [$($done:tt)*]
        $(#[$meta:meta])* $field:ident $(as $rename:literal)? $(| $other:ident)*:
        $kind:ident $({ $most:expr })? $(($type:ty))? ?, $($rest:tt)*
    ) => {
        $crate::scene::format::object::object! {
            @fields $head [$($done)* {
                [$(#[$meta])* #[serde($(rename = $rename,)? skip_serializing_if = "Option::is_none")]]
                $field [$($rename)?] [$($other)*] optional $kind [$($most)?] [$($type)?] [] []
            }] $($rest)*
        }
    };
    (@fields $head:tt [$($done:tt)*]
        $(#[$meta:meta])* $field:ident $(as $rename:literal)? $(| $other:ident)*:
        $kind:ident $({ $most:expr })? $(($type:ty))?, $($rest:tt)*
    ) => {
        $crate::scene::format::object::object! {
            @fields $head [$($done)* {
                [$(#[$meta])* $(#[serde(rename = $rename)])?]
                $field [$($rename)?] [$($other)*] required $kind [$($most)?] [$($type)?] [] []
            }] $($rest)*
        }
    };

    (@fields [$(#[$meta:meta])* $model:ident $name:literal] [$({
        [$($attributes:tt)*]
        $field:ident [$($rename:literal)?] $others:tt $given:ident $kind:ident [$($most:expr)?] $type:tt
        [$($first:expr)?] [$($default:expr)?]
    })*]) => {
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(rename = $name, deny_unknown_fields)]
        #[schemars(transform = $crate::scene::format::field::rules::<Self>)]
        $(#[$meta])*
        pub struct $model {
            $(
                $($attributes)*
                pub $field: $crate::scene::format::object::object!(@given $given $kind $type),
            )*
        }

        impl $crate::scene::format::field::Fields for $model {
            const FIELDS: &'static [$crate::scene::format::field::Field] = &[$(
                $crate::scene::format::object::object!(
                    @field $field [$($rename)?] $others $kind [$($most)?] [$($default)?] [$($first)?] $type
                ),
            )*];

            #[inline]
            #[allow(unused_mut, unused_variables, reason = "all fields may be fixed")]
            fn each<'m>(
                &'m self,
                mut see: impl FnMut(
                    $crate::scene::format::field::Field,
                    $crate::scene::format::field::Value<'m>,
                ),
            ) {
                $($crate::scene::format::object::object!(@each self see $field $kind {
                    $crate::scene::format::object::object!(
                        @field $field [] $others $kind [$($most)?] [$($default)?] [$($first)?] $type
                    )
                });)*
            }
        }

        impl $crate::scene::format::thing::Thing for $model {
            fn of_type() -> $crate::scene::format::thing::Type {
                $crate::scene::format::thing::Type::Object(
                    <Self as $crate::scene::format::field::Fields>::FIELDS,
                )
            }

            fn fields(&self) -> &'static [$crate::scene::format::field::Field] {
                <Self as $crate::scene::format::field::Fields>::FIELDS
            }

            #[allow(unused_variables, reason = "all fields may be fixed")]
            fn has(&self, field: &str) -> bool {
                $($crate::scene::format::object::object!(@has self field $field $kind $($first)?);)*
                false
            }

            #[allow(unused_variables, reason = "all fields may be fixed")]
            fn slot(&mut self, field: &str) -> Option<$crate::scene::format::field::Slot<'_>> {
                $($crate::scene::format::object::object!(@slot self field $field $kind $($first)?);)*
                None
            }

            #[allow(unused_variables, reason = "nothing may be inside")]
            fn things(
                &self,
                see: $crate::scene::format::thing::See,
            ) -> std::ops::ControlFlow<()> {
                $($crate::scene::format::object::object!(@inside self see $field $kind);)*
                std::ops::ControlFlow::Continue(())
            }
        }

        impl $model {
            $($(
                /// Returns the value, or its default.
                #[allow(dead_code, reason = "not all defaults are asked for")]
                pub(crate) fn $field(
                    &self,
                ) -> $crate::scene::format::object::object!(@given required $kind $type) {
                    self.$field.clone().unwrap_or_else(|| $default)
                }
            )?)*
        }
    };

    (@field $field:ident [$($rename:literal)?] [$($other:ident)*] $kind:ident [$($most:expr)?] [$($default:expr)?] $first:tt $type:tt) => {
        $crate::scene::format::field::Field {
            name: $crate::scene::format::object::object!(@name $field $($rename)?),
            others: &[$(stringify!($other)),*],
            kind: $crate::scene::format::object::object!(@kind $kind $($most)?),
            default: $crate::scene::format::object::object!(@default $($default)?),
            has_start: $crate::scene::format::object::object!(@has_start $first),
            thing: $crate::scene::format::object::object!(@thing $kind $type),
        }
    };

    (@name $field:ident) => { stringify!($field) };
    (@name $field:ident $rename:literal) => { $rename };

    (@default) => { None };
    (@default $default:expr) => { Some(|| serde_json::json!($default)) };

    (@has_start []) => { false };
    (@has_start [$first:expr]) => { true };

    (@thing Thing [$type:ty]) => { Some(<$type as $crate::scene::format::thing::Thing>::of_type) };
    (@thing $kind:ident $type:tt) => { None };

    (@kind Thing) => { $crate::scene::format::field::Kind::Fixed };
    (@kind Flag) => { $crate::scene::format::field::Kind::Fixed };
    (@kind Choice) => { $crate::scene::format::field::Kind::Fixed };
    (@kind Other) => { $crate::scene::format::field::Kind::Fixed };
    (@kind Count $most:expr) => { $crate::scene::format::field::Kind::Count { most: $most } };
    (@kind $kind:ident) => { $crate::scene::format::field::Kind::$kind };

    (@each $self:ident $see:ident $field:ident Thing $of:block) => {};
    (@each $self:ident $see:ident $field:ident Flag $of:block) => {};
    (@each $self:ident $see:ident $field:ident Name $of:block) => {};
    (@each $self:ident $see:ident $field:ident Choice $of:block) => {};
    (@each $self:ident $see:ident $field:ident Other $of:block) => {};
    (@each $self:ident $see:ident $field:ident $kind:ident $of:block) => {
        if let Some(value) = $crate::scene::format::field::Held::value(&$self.$field) {
            $see(const { $of }, value);
        }
    };

    (@has $self:ident $name:ident $field:ident Thing $($first:expr)?) => {};
    (@has $self:ident $name:ident $field:ident Flag $($first:expr)?) => {};
    (@has $self:ident $name:ident $field:ident Name $($first:expr)?) => {};
    (@has $self:ident $name:ident $field:ident Choice $($first:expr)?) => {};
    (@has $self:ident $name:ident $field:ident Other $($first:expr)?) => {};
    (@has $self:ident $name:ident $field:ident Count $($first:expr)?) => {};
    (@has $self:ident $name:ident $field:ident Depth $($first:expr)?) => {};
    (@has $self:ident $name:ident $field:ident $kind:ident $($first:expr)?) => {
        if $name == stringify!($field) {
            $(let _ = || $first; return true;)?
            #[allow(unreachable_code, reason = "a field with a default")]
            return $crate::scene::format::field::Held::value(&$self.$field).is_some();
        }
    };

    (@slot $self:ident $name:ident $field:ident Thing $($first:expr)?) => {};
    (@slot $self:ident $name:ident $field:ident Flag $($first:expr)?) => {};
    (@slot $self:ident $name:ident $field:ident Name $($first:expr)?) => {};
    (@slot $self:ident $name:ident $field:ident Choice $($first:expr)?) => {};
    (@slot $self:ident $name:ident $field:ident Other $($first:expr)?) => {};
    (@slot $self:ident $name:ident $field:ident Count $($first:expr)?) => {};
    (@slot $self:ident $name:ident $field:ident Depth $($first:expr)?) => {};
    (@slot $self:ident $name:ident $field:ident $kind:ident $($first:expr)?) => {
        if $name == stringify!($field) {
            $($self.$field.get_or_insert_with(|| $first);)?
            return $crate::scene::format::field::Held::slot(&mut $self.$field);
        }
    };

    (@inside $self:ident $see:ident $field:ident Thing) => {
        if $crate::scene::format::thing::Thing::is_given(&$self.$field) {
            $see($crate::diagnostic::path::Step::Field(stringify!($field).into()), &$self.$field)?;
        }
    };
    (@inside $self:ident $see:ident $field:ident $kind:ident) => {};

    (@given required $kind:ident [$type:ty]) => { $type };
    (@given required Point []) => { $crate::scene::format::field::Triple };
    (@given required Direction []) => { $crate::scene::format::field::Triple };
    (@given required Way []) => { $crate::scene::format::field::Triple };
    (@given required Interval []) => { $crate::scene::format::field::Interval };
    (@given required Scale []) => { $crate::scene::format::transform::ScaleModel };
    (@given required Color []) => { $crate::scene::format::color::ColorModel };
    (@given required Count []) => { u32 };
    (@given required Depth []) => { u32 };
    (@given required Flag []) => { bool };
    (@given required Name []) => { $crate::scene::format::field::Name };
    (@given required $kind:ident []) => { f64 };
    (@given optional $kind:ident $type:tt) => {
        Option<$crate::scene::format::object::object!(@given required $kind $type)>
    };
}

pub(crate) use object;
