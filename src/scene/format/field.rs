//! The fields of a thing of the format, as values that are checked and that change over time.

use crate::scene::format::color::ColorModel;

/// A point or a direction: x, y and z.
pub type Triple = [f64; 3];

/// The name of a geometry. Few have one: a box in a box takes the least memory where there is none.
pub type Name = Box<Box<str>>;

/// The kind of a field, which says what its values may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A number above 0.
    Positive,
    /// An angle in degrees, above 0 and below 180.
    Angle,
    /// A point: three finite numbers.
    Point,
    /// A direction: three finite numbers with a length.
    Direction,
    /// A color.
    Color,
    /// Anything else, which no number can set and no track can change.
    Fixed,
}

impl Kind {
    /// Whether a field of this kind is one number.
    pub(crate) const fn is_number(self) -> bool {
        matches!(self, Self::Positive | Self::Angle)
    }
}

/// The value of a field.
pub(crate) enum Value<'m> {
    Number(f64),
    Vector(&'m Triple),
    Color(&'m ColorModel),
}

/// The place of a value, where another one may be written.
pub(crate) enum Slot<'m> {
    Number(&'m mut f64),
    Vector(&'m mut Triple),
    Color(&'m mut ColorModel),
}

/// The name of a field, and its kind.
pub(crate) type Field = (&'static str, Kind);

/// A thing of the format that has fields.
pub(crate) trait Fields {
    /// All of its fields.
    const FIELDS: &'static [Field];

    /// Passes on every field that is given and that has a value.
    fn each<'m>(&'m self, see: impl FnMut(Field, Value<'m>));

    /// The place of a field's value; one that is optional and has a default becomes given.
    fn slot(&mut self, name: &str) -> Option<Slot<'_>>;
}

/// Implements [`Fields`] for a struct from the list of its fields: those with a kind, each with the
/// default of an optional one that has one, then those that are fixed. A field that is in neither
/// list does not compile.
macro_rules! fields {
    (@name $field:ident) => {
        stringify!($field)
    };
    (@name $field:ident $name:literal) => {
        $name
    };
    ($model:ty {
        $($field:ident: $kind:ident $(= $default:expr)?),* $(,)?
    } fixed { $($fixed:ident $(= $name:literal)?),* $(,)? }) => {
        impl $crate::scene::format::field::Fields for $model {
            const FIELDS: &'static [$crate::scene::format::field::Field] = {
                use $crate::scene::format::field::Kind;
                &[
                    $((stringify!($field), Kind::$kind),)*
                    $((fields!(@name $fixed $($name)?), Kind::Fixed),)*
                ]
            };

            #[inline]
            #[allow(unused_mut, unused_variables, reason = "all fields may be fixed")]
            fn each<'m>(
                &'m self,
                mut see: impl FnMut(
                    $crate::scene::format::field::Field,
                    $crate::scene::format::field::Value<'m>,
                ),
            ) {
                let Self { $($field,)* $($fixed: _,)* } = self;
                $(if let Some(value) = $crate::scene::format::field::Held::value($field) {
                    see((stringify!($field), $crate::scene::format::field::Kind::$kind), value);
                })*
            }

            fn slot(&mut self, name: &str) -> Option<$crate::scene::format::field::Slot<'_>> {
                let Self { $($field,)* $($fixed: _,)* } = self;
                match name {
                    $(stringify!($field) => {
                        $($field.get_or_insert_with(|| $default);)?
                        $crate::scene::format::field::Held::slot($field)
                    })*
                    _ => None,
                }
            }
        }
    };
}

/// Leads from an enum of things to the fields of the one that it is.
macro_rules! variants {
    ($model:ident { $($variant:ident($thing:ty)),* $(,)? }) => {
        impl $model {
            /// Every variant with its fields.
            pub(crate) const VARIANTS: &'static [
                (&'static str, &'static [$crate::scene::format::field::Field])
            ] = &[$((
                stringify!($variant),
                <$thing as $crate::scene::format::field::Fields>::FIELDS,
            )),*];

            /// All fields of the variant.
            pub(crate) const fn fields(&self) -> &'static [$crate::scene::format::field::Field] {
                match self {
                    $(Self::$variant(_) => {
                        <$thing as $crate::scene::format::field::Fields>::FIELDS
                    })*
                }
            }

            /// Passes on every field that is given and that has a value.
            #[inline]
            pub(crate) fn each<'m>(
                &'m self,
                see: impl FnMut(
                    $crate::scene::format::field::Field,
                    $crate::scene::format::field::Value<'m>,
                ),
            ) {
                use $crate::scene::format::field::Fields;
                match self {
                    $(Self::$variant(thing) => thing.each(see)),*
                }
            }

            /// The place of a field's value.
            pub(crate) fn slot(
                &mut self,
                name: &str,
            ) -> Option<$crate::scene::format::field::Slot<'_>> {
                use $crate::scene::format::field::Fields;
                match self {
                    $(Self::$variant(thing) => thing.slot(name)),*
                }
            }
        }
    };
}

pub(crate) use {fields, variants};

/// A type of fields that have values.
pub(crate) trait Held {
    /// The value, if it is given.
    fn value(&self) -> Option<Value<'_>>;

    /// Its place.
    fn slot(&mut self) -> Option<Slot<'_>>;
}

macro_rules! held {
    ($($type:ty: |$self:ident| $value:expr, $slot:expr;)*) => {
        $(impl Held for $type {
            #[inline]
            fn value(&self) -> Option<Value<'_>> {
                let $self = self;
                Some($value)
            }

            fn slot(&mut self) -> Option<Slot<'_>> {
                let $self = self;
                Some($slot)
            }
        })*
    };
}

held! {
    f64: |number| Value::Number(*number), Slot::Number(number);
    Triple: |vector| Value::Vector(vector), Slot::Vector(vector);
    Box<Triple>: |vector| Value::Vector(vector), Slot::Vector(vector);
    ColorModel: |color| Value::Color(color), Slot::Color(color);
}

impl<T: Held> Held for Option<T> {
    #[inline]
    fn value(&self) -> Option<Value<'_>> {
        self.as_ref().and_then(T::value)
    }

    fn slot(&mut self) -> Option<Slot<'_>> {
        self.as_mut().and_then(T::slot)
    }
}
