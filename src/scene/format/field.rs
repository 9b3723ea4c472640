//! The fields of the format's structs, as values that are checked and can change over time.

use std::fmt;

use serde_json::Value as Json;

use crate::{
    scene::format::{
        color::ColorModel,
        numbers::{Interval, ScaleModel, Triple},
        thing::Type,
    },
    tracer::{
        camera::lens::LARGEST as LARGEST_LENS,
        light::{
            source::{BRIGHTEST, LARGEST, WIDEST},
            transport::{PathOptions, PixelFilter},
        },
        material::{glass::INDICES, microfacet::LEAST_ROUGHNESS, phong::SHARPEST},
    },
};

/// The name of a geometry. Few have one: a box in a box takes the least memory where there is none.
pub type Name = Box<Box<str>>;

/// What a field of some kind holds.
#[derive(Clone, Copy)]
enum Content {
    Number,
    /// A whole number, which cannot change over time.
    Count,
    /// A point or a direction.
    Vector,
    /// One or several numbers, or a color.
    Several,
    Nothing,
}

/// Defines the kinds of fields: what each holds, and the valid range of its numbers.
macro_rules! kinds {
    ($($(#[$docs:meta])* $kind:ident $({ $of:ident: $type:ty })?: $content:ident $(in $range:expr)?,)*) => {
        /// The kind of a field, which determines its valid values.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum FieldKind {
            $($(#[$docs])* $kind $({ $of: $type })?),*
        }

        impl FieldKind {
            const fn content(self) -> Content {
                match self {
                    $(Self::$kind $({ $of: _ })? => Content::$content),*
                }
            }

            /// Returns the valid range of its numbers.
            #[inline]
            pub(crate) const fn range(self) -> Option<Range> {
                match self {
                    $(Self::$kind $({ $of })? => kinds!(@range $($range)?)),*
                }
            }
        }
    };
    (@range) => { None };
    (@range $range:expr) => { Some($range) };
}

kinds! {
    /// A finite number.
    Number: Number,
    /// A number above 0.
    Positive: Number in Range::Above(0),
    /// An angle in degrees, above 0 and below 180.
    Angle: Number in Range::Degrees(0, 180),
    /// A whole number from 1.
    Count { most: u32 }: Count in Range::From(1, most),
    /// A whole number from 0.
    Natural { most: u32 }: Count in Range::From(0, most),
    /// The intensity of a light.
    Intensity: Number in Range::Within(0.0, BRIGHTEST),
    /// The radius of a light.
    LightRadius: Number in Range::Within(0.0, LARGEST),
    /// The diameter of a lens.
    Aperture: Number in Range::Within(0.0, LARGEST_LENS),
    /// The distance of a plane of focus.
    FocalDistance: Number in Range::AboveUpTo(0, LARGEST_LENS),
    /// The angle of the disc of a light in degrees.
    LightAngle: Number in Range::Within(0.0, WIDEST),
    /// A part of a whole, in 0..=1.
    Fraction: Number in Range::Within(0.0, 1.0),
    /// The exponent of a highlight.
    Exponent: Number in Range::AboveUpTo(0, SHARPEST),
    /// The roughness of a surface: 0, or not much less than can be seen.
    Roughness: Number in Range::ZeroOr(LEAST_ROUGHNESS, 1.0),
    /// An index of refraction.
    Refraction: Number in Range::Within(INDICES[0], INDICES[1]),
    /// An exposure in stops.
    Stops: Number in Range::Within(-64.0, 64.0),
    /// The largest light of a path after its first vertex.
    Limit: Number in Range::AboveUpTo(0, PathOptions::MAX_CLAMP),
    /// The limit of the noise of a part of a picture.
    Noise: Number in Range::Within(PathOptions::NOISE[0], PathOptions::NOISE[1]),
    /// The standard deviation of a filter in pixels.
    FilterWidth: Number in Range::AboveUpTo(0, PixelFilter::WIDEST),
    /// The width of a line in pixels.
    Width: Number in Range::AboveUpTo(0, 100.0),
    /// A number of at least 0.
    Distance: Number in Range::AtLeast(0),
    /// An angle in degrees, 0 to 180.
    Turn: Number in Range::Within(0.0, 180.0),
    /// The free part of a side, on either end of it.
    Margin: Number in Range::FromToBelow(0, 0.5),
    /// A factor of all lengths, or three along x, y and z.
    Scale: Several,
    /// A point: three finite numbers.
    Point: Vector,
    /// The vector from one point to another: three finite numbers, not all 0.
    Edge: Vector,
    /// A direction: three finite numbers with a length.
    Direction: Vector,
    /// A range of numbers, from the smaller to the larger.
    Interval: Several,
    /// A color.
    Color: Several,
    /// Anything else, which no number can set and no track can change.
    Fixed: Nothing,
}

impl FieldKind {
    /// Returns true if a field of this kind is a single number.
    pub(crate) const fn is_number(self) -> bool {
        matches!(self.content(), Content::Number)
    }

    /// Returns true if a field of this kind is a point or a direction.
    pub(crate) const fn is_vector(self) -> bool {
        matches!(self.content(), Content::Vector)
    }

    /// Returns true if a field of this kind has numbers that can change alone.
    pub(crate) const fn has_elements(self) -> bool {
        matches!(self.content(), Content::Vector | Content::Several)
    }

    /// Returns true if a field of this kind can change over time.
    pub(crate) const fn changes(self) -> bool {
        !matches!(self.content(), Content::Count | Content::Nothing)
    }
}

/// The numbers that a field may have.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Range {
    /// All above this one.
    Above(u32),
    /// The angles above the first and below the second.
    Degrees(u32, u32),
    /// All from the first to the second, with both.
    From(u32, u32),
    /// The same for any numbers.
    Within(f64, f64),
    /// 0, and all from the first to the second, with both.
    ZeroOr(f64, f64),
    /// All above the first, up to the second.
    AboveUpTo(u32, f64),
    /// All from this one.
    AtLeast(u32),
    /// All from the first, below the second.
    FromToBelow(u32, f64),
}

impl Range {
    /// Returns true if a number is in the range.
    #[inline]
    pub(crate) fn holds(self, number: f64) -> bool {
        match self {
            Self::Above(least) => number > f64::from(least),
            Self::Degrees(least, most) => number > f64::from(least) && number < f64::from(most),
            Self::From(least, most) => (f64::from(least)..=f64::from(most)).contains(&number),
            Self::Within(least, most) => (least..=most).contains(&number),
            Self::ZeroOr(least, most) => number == 0.0 || (least..=most).contains(&number),
            Self::AboveUpTo(least, most) => number > f64::from(least) && number <= most,
            Self::AtLeast(least) => number >= f64::from(least),
            Self::FromToBelow(least, most) => number >= f64::from(least) && number < most,
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Above(least) => write!(f, "above {least}"),
            Self::Degrees(least, most) => write!(f, "above {least} and below {most} degrees"),
            Self::From(least, most) => write!(f, "in {least} to {most}"),
            Self::Within(least, most) => write!(f, "in {least} to {most}"),
            Self::ZeroOr(least, most) => write!(f, "0 or in {least} to {most}"),
            Self::AboveUpTo(least, most) => write!(f, "above {least} and at most {most}"),
            Self::AtLeast(least) => write!(f, "at least {least}"),
            Self::FromToBelow(least, most) => write!(f, "at least {least} and below {most}"),
        }
    }
}

/// The value of a field.
pub(crate) enum Value<'m> {
    Number(f64),
    Vector(&'m Triple),
    Interval(Interval),
    Color(&'m ColorModel),
}

/// A writable place of a value.
pub(crate) enum Slot<'m> {
    Number(&'m mut f64),
    Scale(&'m mut ScaleModel),
    Vector(&'m mut Triple),
    Interval(&'m mut Interval),
    Color(&'m mut ColorModel),
}

/// A field of a struct.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field {
    pub(crate) name: &'static str,
    pub(crate) docs: &'static str,
    /// Its names in other programs.
    pub(crate) others: &'static [&'static str],
    /// Those of which the value there is not that of the field.
    pub(crate) unlike: &'static [&'static str],
    pub(crate) kind: FieldKind,
    pub(crate) is_required: bool,
    /// Its default, if it has one.
    pub(crate) default: Option<fn() -> Json>,
    /// True if a track can begin without its being given.
    pub(crate) has_start: bool,
    pub(crate) of_type: fn() -> Type,
}

/// A field type with a value.
pub(crate) trait Held {
    /// Returns the value, if given.
    fn value(&self) -> Option<Value<'_>>;

    /// Returns its slot.
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

impl Held for u32 {
    #[inline]
    fn value(&self) -> Option<Value<'_>> {
        Some(Value::Number(f64::from(*self)))
    }

    fn slot(&mut self) -> Option<Slot<'_>> {
        None
    }
}

held! {
    f64: |number| Value::Number(*number), Slot::Number(number);
    Triple: |vector| Value::Vector(vector), Slot::Vector(vector);
    Interval: |range| Value::Interval(*range), Slot::Interval(range);
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

impl Held for ScaleModel {
    fn value(&self) -> Option<Value<'_>> {
        Some(match self {
            Self::Uniform(factor) => Value::Number(*factor),
            Self::Axes(factors) => Value::Vector(factors),
        })
    }

    fn slot(&mut self) -> Option<Slot<'_>> {
        Some(Slot::Scale(self))
    }
}
