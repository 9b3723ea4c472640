//! The declaration of a thing of the format, from which its struct, its reading, its defaults, its
//! values that change over time and its description follow.
//!
//! ```text
//! object! {
//!     /// A cone of light from a point.
//!     pub struct SpotLightModel = "Spot" {
//!         /// The position.
//!         position: Point,
//!         /// The part of the half angle over which the light fades.
//!         blend: Fraction = 0.15,
//!         /// The name.
//!         name: Name?,
//!     } one of direction, look_at
//! }
//! ```
//!
//! Behind a `|` stand the names that other programs, or the course, give a field: who writes one is told
//! the name; behind a `!` those whose values are not those of the field. A field is required, or optional with a default, or optional without one (`?`); `?= value` is
//! for a field without a default that a track begins with a value. Behind the name of a field
//! stands its [`Kind`], which determines its type; `Kind(Rust type)` has another one. `Thing(…)` has
//! fields of its own, and `Choice(…)` is one of several words. `Text(…)`, `File { endings }(…)` and
//! `Other { type }(…)` are for what no number can set.
//!
//! Behind the fields stand those of which exactly one, at most one or any is given, with a `+` between two that
//! may be given together; `not solid` is for a geometry that is none.
//!
//! `rare` stands before an optional field that few things have. Where there may be millions of a thing,
//! `rare in SphereRest` behind its fields keeps these fields in a box, a struct of this name.
//!
//! [`Kind`]: crate::scene::format::field::FieldKind

/// Returns the docs in the attributes of an item.
macro_rules! docs {
    ($([$($meta:tt)*])*) => {
        concat!($($crate::scene::format::object::docs!(@line $($meta)*)),*).trim_ascii()
    };
    (@line doc = $line:literal) => { $line };
    (@line $($other:tt)*) => { "" };
}

/// Defines an object of the format.
macro_rules! object {
    (
        $(#[$($meta:tt)*])* pub struct $model:ident = $name:literal { $($fields:tt)* }
        $(one of $one:ident $(+ $with:ident)? $(, $other:ident)+)?
        $(at most one of $some:ident $(+ $beside:ident)?, $else:ident)?
        $(any of $any:ident, $all:ident)?
        $(not $solid:ident)?
        $(rare in $rest:ident)?
    ) => {
        $crate::scene::format::object::object! {
            @fields [$([$($meta)*])*] $model $name [
                $(One [[$one $($with)?] $([$other])+],)?
                $(AtMostOne [[$some $($beside)?] [$else]],)?
                $(Any [[$any] [$all]],)?
                ; $($solid)?; $($rest)?
            ] [] $($fields)*
        }
    };

    // One field after another, with a list of those before it.
    (@fields $docs:tt $model:ident $name:literal $sets:tt [$($done:tt)*]
        $(#[$($meta:tt)*])* rare $field:ident $(| $other:ident)*:
        $kind:ident $({ $of:expr })? $(($type:ty))? ?, $($rest:tt)*
    ) => {
        $crate::scene::format::object::object! {
            @fields $docs $model $name $sets [$($done)* {
                [$([$($meta)*])*] [[serde(skip_serializing_if = "Option::is_none")]]
                $field [] [$($other)*;] rare $kind [$($of)?] [$($type)?] [] []
            }] $($rest)*
        }
    };
    (@fields $docs:tt $model:ident $name:literal $sets:tt [$($done:tt)*]
        $(#[$($meta:tt)*])* $field:ident $(as $rename:literal)? $(| $other:ident)* $(! $unlike:ident)*:
        $kind:ident $({ $of:expr })? $(($type:ty))? = $default:expr, $($rest:tt)*
    ) => {
        $crate::scene::format::object::object! {
            @fields $docs $model $name $sets [$($done)* {
                [$([$($meta)*])*] [[serde($(rename = $rename,)? skip_serializing_if = "Option::is_none")]]
                $field [$($rename)?] [$($other)*; $($unlike)*] optional $kind [$($of)?] [$($type)?] [$default] [$default]
            }] $($rest)*
        }
    };
    (@fields $docs:tt $model:ident $name:literal $sets:tt [$($done:tt)*]
        $(#[$($meta:tt)*])* $field:ident $(as $rename:literal)? $(| $other:ident)* $(! $unlike:ident)*:
        $kind:ident $({ $of:expr })? $(($type:ty))? ? $(= $first:expr)?, $($rest:tt)*
    ) => {
        $crate::scene::format::object::object! {
            @fields $docs $model $name $sets [$($done)* {
                [$([$($meta)*])*] [[serde($(rename = $rename,)? skip_serializing_if = "Option::is_none")]]
                $field [$($rename)?] [$($other)*; $($unlike)*] optional $kind [$($of)?] [$($type)?] [$($first)?] []
            }] $($rest)*
        }
    };
    (@fields $docs:tt $model:ident $name:literal $sets:tt [$($done:tt)*]
        $(#[$($meta:tt)*])* $field:ident $(as $rename:literal)? $(| $other:ident)* $(! $unlike:ident)*:
        $kind:ident $({ $of:expr })? $(($type:ty))?, $($rest:tt)*
    ) => {
        $crate::scene::format::object::object! {
            @fields $docs $model $name $sets [$($done)* {
                [$([$($meta)*])*] [$([serde(rename = $rename)])?]
                $field [$($rename)?] [$($other)*; $($unlike)*] required $kind [$($of)?] [$($type)?] [] []
            }] $($rest)*
        }
    };

    (@fields [$([$($meta:tt)*])*] $model:ident $name:literal
        [$($needs:ident [$([$($one:ident)+])+],)*; $($solid:ident)?; $($rest:ident)?]
        [$({
            [$([$($doc:tt)*])*] [$([$($serde:tt)*])?]
            $field:ident [$($rename:literal)?] [$($other:ident)*; $($unlike:ident)*] $given:ident $kind:ident $of:tt $type:tt
            [$($first:expr)?] [$($default:expr)?]
        })*]
    ) => {
        $crate::scene::format::object::object! {
            @struct [$($rest)?] [$([$($meta)*])*] $model $name
            $({ $given $field [$([$($doc)*])*] [$([$($serde)*])?] $kind $type })*
        }

        const _: () = {
            use $crate::scene::format::{field, object, thing};

            impl $model {
                /// Fields that are given in place of each other.
                const SETS: &'static [thing::Set] = &[$(thing::Set {
                    fields: &[$(&[$(stringify!($one)),+]),+],
                    needs: thing::Needs::$needs,
                }),*];

                /// All fields.
                pub(crate) const FIELDS: &'static [field::Field] = &[$(
                    field::Field {
                        name: object::object!(@name $field $($rename)?),
                        docs: object::docs!($([$($doc)*])*),
                        others: &[$(stringify!($other)),*],
                        unlike: &[$(stringify!($unlike)),*],
                        kind: object::object!(@kind $kind $of),
                        is_required: object::object!(@is_required $given),
                        default: object::object!(@default $($default)?),
                        has_start: object::object!(@has_start $($first)?),
                        of_type: || object::object!(@type $kind $of $type),
                    },
                )*];
            }

            impl thing::Thing for $model {
                fn of_type() -> thing::Type {
                    static OBJECT: thing::Object = thing::Object {
                        name: $name,
                        docs: object::docs!($([$($meta)*])*),
                        fields: $model::FIELDS,
                        sets: $model::SETS,
                        is_solid: object::object!(@is_solid $($solid)?),
                    };
                    thing::Type::Object(&OBJECT, false)
                }

                fn fields(&self) -> &'static [field::Field] {
                    Self::FIELDS
                }

                fn sets(&self) -> Vec<(&'static thing::Set, thing::GivenFields)> {
                    let given: [thing::GivenFields; Self::SETS.len()] = [$(vec![$(
                        None$(.or(self.$one.as_ref().map(|_| stringify!($one))))+
                    ),+]),*];
                    Self::SETS.iter().zip(given).collect()
                }

                #[inline]
                #[allow(unused_mut, unused_variables, reason = "all fields may be fixed")]
                fn each<'m>(
                    &'m self,
                    mut see: impl FnMut(&'static field::Field, field::Value<'m>),
                ) {
                    $(object::object!(@if $kind {
                        if let Some(value) = field::Held::value(&self.$field) {
                            see(const { &Self::FIELDS[At::$field as usize] }, value);
                        }
                    });)*
                }

                fn has(&self, name: &str) -> bool {
                    let is_it = |field: &field::Field| field.name == name && field.kind.changes();
                    let mut has = Self::FIELDS.iter().any(|field| field.has_start && is_it(field));
                    self.each(|field, _| has |= is_it(field));
                    has
                }

                #[allow(unused_variables, reason = "all fields may be fixed")]
                fn slot(&mut self, name: &str) -> Option<field::Slot<'_>> {
                    $(object::object!(@if $kind {
                        if name == stringify!($field) && object::object!(@kind $kind $of).changes() {
                            $(self.$field.get_or_insert_with(|| $first);)?
                            return field::Held::slot(&mut self.$field);
                        }
                    });)*
                    None
                }

                #[allow(unused_variables, reason = "nothing may be inside")]
                fn things<'m>(&'m self, see: thing::See<'_, 'm>) -> std::ops::ControlFlow<()> {
                    $(object::object!(@if_thing $kind {
                        if thing::Thing::is_given(&self.$field) {
                            let step = stringify!($field).into();
                            see($crate::diagnostic::path::Step::Field(step), &self.$field)?;
                        }
                    });)*
                    std::ops::ControlFlow::Continue(())
                }

                fn enter<F: thing::Follow>(
                    &mut self,
                    step: &$crate::diagnostic::path::Step,
                    follow: F,
                ) -> Result<F::Out, F> {
                    match step.name() {
                        $(Some(object::object!(@name $field $($rename)?)) => object::object!(
                            @if_thing $kind { Ok(follow.thing(&mut self.$field)) } {
                                Ok(follow.value(&mut self.$field))
                            }
                        ),)*
                        _ => Err(follow),
                    }
                }
            }

            /// The places of the fields.
            #[allow(non_camel_case_types, dead_code, reason = "they have the names of the fields")]
            enum At { $($field),* }
        };

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

    // The struct, in one piece.
    (@struct [] [$([$($meta:tt)*])*] $model:ident $name:literal
        $({ $given:ident $field:ident [$([$($doc:tt)*])*] [$([$($serde:tt)*])?] $kind:ident $type:tt })*
    ) => {
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(rename = $name, deny_unknown_fields)]
        $(#[$($meta)*])*
        pub struct $model {
            $(
                $(#[$($doc)*])*
                $(#[$($serde)*])?
                pub $field: $crate::scene::format::object::object!(@given $given $kind $type),
            )*
        }
    };

    // The struct without its rare fields, which follow in a box, one field after another.
    (@struct [$rest:ident] $docs:tt $model:ident $name:literal $($field:tt)*) => {
        $crate::scene::format::object::object! {
            @split $rest $docs $model $name [$($field)*] [] [] $($field)*
        }
    };
    (@split $rest:ident $docs:tt $model:ident $name:literal $all:tt $kept:tt [$($rare:tt)*]
        { rare $($of:tt)* } $($field:tt)*
    ) => {
        $crate::scene::format::object::object! {
            @split $rest $docs $model $name $all $kept [$($rare)* { rare $($of)* }] $($field)*
        }
    };
    (@split $rest:ident $docs:tt $model:ident $name:literal $all:tt [$($kept:tt)*] $rare:tt
        $one:tt $($field:tt)*
    ) => {
        $crate::scene::format::object::object! {
            @split $rest $docs $model $name $all [$($kept)* $one] $rare $($field)*
        }
    };
    (@split $rest:ident [$([$($meta:tt)*])*] $model:ident $name:literal
        [$({ $any_given:ident $any:ident $any_doc:tt [$([$($serde:tt)*])?] $any_kind:ident $any_type:tt })*]
        [$({ $given:ident $field:ident [$([$($doc:tt)*])*] $field_serde:tt $kind:ident $type:tt })*]
        [$({ $rare_given:ident $rare:ident [$([$($rare_doc:tt)*])*] $rare_serde:tt $rare_kind:ident $rare_type:tt })*]
    ) => {
        #[derive(Clone, Debug, PartialEq)]
        $(#[$($meta)*])*
        pub struct $model {
            $(
                $(#[$($doc)*])*
                pub $field: $crate::scene::format::object::object!(@given $given $kind $type),
            )*
            /// The fields that few have; they are read and written as if they stood here.
            pub rare: $crate::scene::format::rare::Rare<$rest>,
        }

        #[doc = concat!("The fields that few of many have: those of a [`", stringify!($model), "`].")]
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $rest {
            $(
                $(#[$($rare_doc)*])*
                pub $rare: $crate::scene::format::object::object!(@given $rare_given $rare_kind $rare_type),
            )*
        }

        impl std::ops::Deref for $model {
            type Target = $rest;

            #[inline]
            fn deref(&self) -> &$rest {
                static NONE: $rest = $rest { $($rare: None),* };
                self.rare.get().unwrap_or(&NONE)
            }
        }

        impl std::ops::DerefMut for $model {
            fn deref_mut(&mut self) -> &mut $rest {
                self.rare.get_or_insert()
            }
        }

        const _: () = {
            /// All fields, as in a file.
            #[derive(serde::Serialize, serde::Deserialize)]
            #[serde(rename = $name, deny_unknown_fields)]
            struct WholeModel {
                $(
                    $(#[$($serde)*])?
                    $any: $crate::scene::format::object::object!(@given $any_given $any_kind $any_type),
                )*
            }

            impl serde::Serialize for $model {
                fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                    WholeModel { $($any: self.$any.clone()),* }.serialize(serializer)
                }
            }

            impl<'de> serde::Deserialize<'de> for $model {
                #[inline]
                fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                    let whole = WholeModel::deserialize(deserializer)?;
                    let is_given = false $(|| whole.$rare.is_some())*;
                    let rare = is_given.then(|| $rest { $($rare: whole.$rare),* });
                    Ok(Self { $($field: whole.$field,)* rare: rare.into() })
                }
            }
        };
    };

    (@name $field:ident) => { stringify!($field) };
    (@name $field:ident $rename:literal) => { $rename };

    (@is_required required) => { true };
    (@is_required $optional:ident) => { false };

    (@is_solid) => { true };
    (@is_solid solid) => { false };

    (@default) => { None };
    (@default $default:expr) => { Some(|| serde_json::json!($default)) };

    (@has_start) => { false };
    (@has_start $first:expr) => { true };

    // The kinds of fields that hold no value of a number, a vector or a color.
    (@if Thing $then:tt $($else:block)?) => { $($else)? };
    (@if Choice $then:tt $($else:block)?) => { $($else)? };
    (@if Flag $then:tt $($else:block)?) => { $($else)? };
    (@if Name $then:tt $($else:block)?) => { $($else)? };
    (@if Text $then:tt $($else:block)?) => { $($else)? };
    (@if File $then:tt $($else:block)?) => { $($else)? };
    (@if Other $then:tt $($else:block)?) => { $($else)? };
    (@if $kind:ident $then:block $($else:block)?) => { $then };

    (@if_thing Thing $then:block $($else:block)?) => { $then };
    (@if_thing $kind:ident $then:block $($else:block)?) => { $($else)? };

    (@kind Count [$most:expr]) => { $crate::scene::format::field::FieldKind::Count { most: $most } };
    (@kind Natural [$most:expr]) => { $crate::scene::format::field::FieldKind::Natural { most: $most } };
    (@kind $kind:ident $of:tt) => {
        $crate::scene::format::object::object!(
            @if $kind { $crate::scene::format::field::FieldKind::$kind } { $crate::scene::format::field::FieldKind::Fixed }
        )
    };

    (@type Thing [] [$type:ty]) => { <$type as $crate::scene::format::thing::Thing>::of_type() };
    (@type Choice [] [$type:ty]) => { <$type>::of_type() };
    (@type Flag [] []) => { $crate::scene::format::thing::Type::Flag };
    (@type Name [] []) => { $crate::scene::format::thing::Type::Name };
    (@type Text [] $type:tt) => { $crate::scene::format::thing::Type::Text };
    (@type File [$endings:expr] $type:tt) => { $crate::scene::format::thing::Type::File($endings) };
    (@type Thing [$of:expr] $type:tt) => { $of };
    (@type Other [$of:expr] $type:tt) => { $of };
    (@type $kind:ident $of:tt $type:tt) => {
        $crate::scene::format::thing::Type::Value($crate::scene::format::object::object!(@kind $kind $of))
    };

    (@given required $kind:ident [$type:ty]) => { $type };
    (@given required Point []) => { $crate::scene::format::numbers::Triple };
    (@given required Direction []) => { $crate::scene::format::numbers::Triple };
    (@given required Edge []) => { $crate::scene::format::numbers::Triple };
    (@given required Interval []) => { $crate::scene::format::numbers::Interval };
    (@given required Scale []) => { $crate::scene::format::numbers::ScaleModel };
    (@given required Color []) => { $crate::scene::format::color::ColorModel };
    (@given required Count []) => { u32 };
    (@given required Natural []) => { u32 };
    (@given required Flag []) => { bool };
    (@given required Name []) => { $crate::scene::format::field::Name };
    (@given required $kind:ident []) => { f64 };
    (@given $optional:ident $kind:ident $type:tt) => {
        Option<$crate::scene::format::object::object!(@given required $kind $type)>
    };
}

pub(crate) use {docs, object};
