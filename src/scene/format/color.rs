//! A color in a scene file.

use std::fmt;

use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{SeqAccess, Unexpected, Visitor},
};

use crate::{
    scene::format::numbers::{Triple, elements},
    tracer::color::Color,
};

/// A color: three numbers in 0..1, or a string `"#rrggbb"` or `"#rgb"`.
#[derive(Clone, Debug, PartialEq)]
pub enum ColorModel {
    /// Red, green and blue.
    Channels(Triple),
    /// `#rrggbb` or `#rgb`, as bytes.
    Hex([u8; 3]),
    /// A string that is not a color; validation reports it at its place.
    Invalid(Box<str>),
}

impl ColorModel {
    pub(crate) const BLACK: Self = Self::Hex([0; 3]);
    pub(crate) const WHITE: Self = Self::Hex([255; 3]);

    /// Builds the color; black for an invalid string, which validation has rejected.
    #[inline]
    pub(crate) fn build(&self) -> Color {
        match self {
            Self::Channels([r, g, b]) => Color::new(*r, *g, *b),
            Self::Hex(bytes) => {
                let [r, g, b] = bytes.map(|byte| f64::from(byte) / 255.0);
                Color::new(r, g, b)
            }
            Self::Invalid(_) => Color::BLACK,
        }
    }

    /// Converts the color to channels and returns them.
    pub(crate) fn channels(&mut self) -> Option<&mut Triple> {
        if !matches!(self, Self::Channels(_)) {
            let color = self.build();
            *self = Self::Channels([color.r(), color.g(), color.b()]);
        }
        match self {
            Self::Channels(channels) => Some(channels),
            Self::Hex(_) | Self::Invalid(_) => None,
        }
    }

    /// Parses `#rrggbb` or `#rgb`, in either case.
    pub(crate) fn parse(text: &str) -> Self {
        Color::parse_hex(text).map_or_else(|| Self::Invalid(text.into()), Self::Hex)
    }
}

/// Builds a color; white, if it is not given.
pub(crate) fn or_white(color: Option<&ColorModel>) -> Color {
    color.map_or(Color::WHITE, ColorModel::build)
}

impl Serialize for ColorModel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Channels(channels) => channels.serialize(serializer),
            Self::Hex([r, g, b]) => serializer.collect_str(&format_args!("#{r:02x}{g:02x}{b:02x}")),
            Self::Invalid(text) => serializer.serialize_str(text),
        }
    }
}

impl<'de> Deserialize<'de> for ColorModel {
    #[inline]
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ColorVisitor;

        impl<'de> Visitor<'de> for ColorVisitor {
            type Value = ColorModel;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a color: three numbers in 0..1 or a string `#rrggbb`")
            }

            fn visit_str<E>(self, text: &str) -> Result<ColorModel, E> {
                Ok(ColorModel::parse(text))
            }

            // By default serde would treat a character as a string.
            fn visit_char<E: serde::de::Error>(self, letter: char) -> Result<ColorModel, E> {
                Err(E::invalid_type(Unexpected::Char(letter), &self))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<ColorModel, A::Error> {
                elements(seq, &self).map(ColorModel::Channels)
            }
        }

        deserializer.deserialize_any(ColorVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_read_from_hex() {
        assert_eq!(ColorModel::parse("#ff8000"), ColorModel::Hex([255, 128, 0]));
        assert_eq!(
            ColorModel::parse("#FfA07a"),
            ColorModel::Hex([255, 160, 122])
        );
        assert_eq!(ColorModel::parse("#f0a"), ColorModel::Hex([255, 0, 170]));
        for text in [
            "",
            "#",
            "red",
            "ff8000",
            "#ff80",
            "#ff800000",
            "#+f8000",
            "#ggg",
            "#é1",
        ] {
            assert_eq!(ColorModel::parse(text), ColorModel::Invalid(text.into()));
        }
    }

    #[test]
    fn hex_colors_are_their_bytes() {
        for byte in 0..=255 {
            assert_eq!(ColorModel::Hex([byte; 3]).build().to_rgb8(), [byte; 3]);
        }
    }
}
