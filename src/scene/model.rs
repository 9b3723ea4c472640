//! The format as plain serde types: what a file may say, and nothing about what it means.
//!
//! Every name here is a name of the format; every doc comment is a sentence of its manual.

use std::{borrow::Cow, fmt};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{Error as _, SeqAccess, Unexpected, Visitor},
};

use crate::{
    diagnostic::Code,
    film::samples::Samples,
    scene::{animation::model::AnimationModel, cameras::CamerasModel},
};

/// A point or a direction: x, y and z.
pub(crate) type Triple = [f64; 3];

/// What a geometry is called. Few are: a box in a box takes the least memory where there is none.
pub(crate) type Name = Box<Box<str>>;

/// A scene: what is seen, from where, and how large the picture is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub(crate) struct Model {
    /// Where the schema of this file lies, for editors. JSON only.
    #[serde(rename = "$schema", skip_serializing_if = "Option::is_none")]
    pub(crate) schema: Option<String>,
    /// The version of the format: 1, which is also meant where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("enum" = [1, null], "default" = 1))]
    pub(crate) version: Option<u32>,
    /// The size of the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) image: Option<ImageModel>,
    /// Where the scene is seen from; required where there are no `cameras`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) camera: Option<CameraModel>,
    /// More cameras, each by its name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cameras: Option<CamerasModel>,
    /// The color where no geometry is seen; black is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = [0, 0, 0]))]
    pub(crate) background: Option<ColorModel>,
    /// Everything that can be seen; at equal distance the first is in front.
    pub(crate) geometries: Vec<GeometryModel>,
    /// What changes over time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) animation: Option<Box<AnimationModel>>,
    /// Codes of warnings that this file does not want.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) allow: Option<Vec<WarningName>>,
}

impl Model {
    /// Every camera, with its name if it is one of `cameras`.
    pub(crate) fn all_cameras(&self) -> impl Iterator<Item = (Option<&str>, &CameraModel)> {
        let camera = self.camera.iter().map(|camera| (None, camera));
        let cameras = self.cameras.iter().flat_map(|cameras| &cameras.0);
        camera.chain(cameras.map(|(name, camera)| (Some(&**name), camera)))
    }
}

/// The size of the picture, in pixels.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Image", deny_unknown_fields)]
pub(crate) struct ImageModel {
    /// The number of columns, 1 to 1,000,000; 640 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 640))]
    pub(crate) width: Option<u32>,
    /// The number of rows, 1 to 1,000,000; 480 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 480))]
    pub(crate) height: Option<u32>,
    /// How many samples each pixel has, a square of 1 to 64: 1, 4, 9, 16, … 4096; 1 is the default.
    /// They lie in a regular grid, and the pixel is their mean in linear light.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("enum" = Samples::all().map(Some).chain([None]).collect::<Vec<_>>(), "default" = 1))]
    pub(crate) samples: Option<u32>,
}

impl ImageModel {
    pub(crate) const DEFAULT_WIDTH: u32 = 640;
    pub(crate) const DEFAULT_HEIGHT: u32 = 480;

    /// The width and height with the defaults in the place of what is not given.
    pub(crate) fn sides(&self) -> (u32, u32) {
        (
            self.width.unwrap_or(Self::DEFAULT_WIDTH),
            self.height.unwrap_or(Self::DEFAULT_HEIGHT),
        )
    }
}

/// Where the scene is seen from, and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Camera", deny_unknown_fields)]
pub(crate) enum CameraModel {
    /// A pinhole camera: all rays start at the eye.
    Perspective {
        /// The point that the scene is seen from.
        eye: Triple,
        /// The direction of view; this or `look_at`.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("not" = {"const": [0, 0, 0]}))]
        gaze: Option<Triple>,
        /// The point that is seen in the middle of the picture; this or `gaze`.
        #[serde(skip_serializing_if = "Option::is_none")]
        look_at: Option<Triple>,
        /// The direction that is up in the picture; (0, 1, 0) is the default.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("not" = {"const": [0, 0, 0]}, "default" = [0, 1, 0]))]
        up: Option<Triple>,
        /// The full vertical angle of view in degrees, above 0 and below 180: 2α of the camera
        /// equation.
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
        fov: f64,
    },
    /// A camera of parallel rays: what is far is as large as what is near.
    Orthographic {
        /// The point that is the middle of the picture, where the rays start.
        eye: Triple,
        /// The direction of view; this or `look_at`.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("not" = {"const": [0, 0, 0]}))]
        gaze: Option<Triple>,
        /// The point that is seen in the middle of the picture; this or `gaze`.
        #[serde(skip_serializing_if = "Option::is_none")]
        look_at: Option<Triple>,
        /// The direction that is up in the picture; (0, 1, 0) is the default.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("not" = {"const": [0, 0, 0]}, "default" = [0, 1, 0]))]
        up: Option<Triple>,
        /// What the height of the picture spans, in units of the scene, above 0: s of the
        /// camera equation, from the center of the bottom row to that of the top row.
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: f64,
        /// Whether the scale spans the width as well, so that pixels are not square; false is
        /// the default.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("default" = false))]
        stretch: Option<bool>,
    },
}

/// Something that can be seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Geometry", deny_unknown_fields)]
pub(crate) enum GeometryModel {
    /// An infinite plane, seen from both sides.
    Plane {
        /// A point of the plane.
        point: Triple,
        /// The direction that the plane is perpendicular to, of any length.
        #[schemars(extend("not" = {"const": [0, 0, 0]}))]
        // Planes are few: boxed, so that no geometry needs more memory than a sphere.
        normal: Box<Triple>,
        /// The color.
        color: ColorModel,
        /// What the geometry is called: a name that no other geometry of the scene has.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minLength" = 1))]
        name: Option<Name>,
    },
    /// A sphere.
    Sphere {
        /// The center.
        center: Triple,
        /// The radius, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
        /// The color.
        color: ColorModel,
        /// What the geometry is called: a name that no other geometry of the scene has.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minLength" = 1))]
        name: Option<Name>,
    },
    /// Many spheres from a table, a file beside the scene: one in each row.
    Spheres {
        /// The table: a path from the folder of the scene to a file .csv, .npy or .ply, with `/`
        /// between its parts.
        #[schemars(regex(pattern = r"\.([cC][sS][vV]|[nN][pP][yY]|[pP][lL][yY])$"))]
        file: Box<str>,
        /// The radius of rows that have none, above 0; required where the table has none.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Option<f64>,
        /// The color of rows that have none; required where the table has none.
        #[serde(skip_serializing_if = "Option::is_none")]
        color: Option<ColorModel>,
        /// What the table is called: a name that no other geometry of the scene has.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minLength" = 1))]
        name: Option<Name>,
    },
}

impl CameraModel {
    /// The name of the variant.
    pub(crate) const fn variant(&self) -> &'static str {
        match self {
            Self::Perspective { .. } => "Perspective",
            Self::Orthographic { .. } => "Orthographic",
        }
    }
}

impl GeometryModel {
    /// The name of the variant.
    pub(crate) const fn variant(&self) -> &'static str {
        match self {
            Self::Plane { .. } => "Plane",
            Self::Sphere { .. } => "Sphere",
            Self::Spheres { .. } => "Spheres",
        }
    }

    /// What the scene calls it.
    pub(crate) fn name(&self) -> Option<&str> {
        let (Self::Plane { name, .. } | Self::Sphere { name, .. } | Self::Spheres { name, .. }) =
            self;
        name.as_ref().map(|name| &***name)
    }
}

/// A color: three numbers in 0..1, or a string `"#rrggbb"` or `"#rgb"`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ColorModel {
    /// Red, green and blue.
    Channels(Triple),
    /// `#rrggbb` or `#rgb`, as bytes.
    Hex([u8; 3]),
    /// A string that is no color; validation reports it at its place.
    Invalid(Box<str>),
}

impl ColorModel {
    /// Reads `#rrggbb` or `#rgb`, in either case.
    pub(crate) fn parse(text: &str) -> Self {
        Self::parse_hex(text).map_or_else(|| Self::Invalid(text.into()), Self::Hex)
    }

    fn parse_hex(text: &str) -> Option<[u8; 3]> {
        let digits = text.strip_prefix('#')?;
        if !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return None;
        }
        let number = u32::from_str_radix(digits, 16).ok()?;
        let [_, r, g, b] = match digits.len() {
            6 => number.to_be_bytes(),
            // #rgb is #rrggbb with every digit twice.
            3 => {
                let [high, low] = [(number >> 8) & 15, number & 0xff];
                [0, high, low >> 4, low & 15].map(|digit| (digit * 17) as u8)
            }
            _ => return None,
        };
        Some([r, g, b])
    }
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

            // What serde makes of a character by default: a string.
            fn visit_char<E: serde::de::Error>(self, letter: char) -> Result<ColorModel, E> {
                Err(E::invalid_type(Unexpected::Char(letter), &self))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<ColorModel, A::Error> {
                let mut channels = Triple::default();
                for (index, channel) in channels.iter_mut().enumerate() {
                    *channel = seq
                        .next_element()?
                        .ok_or_else(|| A::Error::invalid_length(index, &self))?;
                }
                Ok(ColorModel::Channels(channels))
            }
        }

        deserializer.deserialize_any(ColorVisitor)
    }
}

impl JsonSchema for ColorModel {
    fn schema_name() -> Cow<'static, str> {
        "Color".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let channels = generator.subschema_for::<Triple>();
        json_schema!({
            "description": "Three numbers in 0..1 (red, green, blue; display values, sRGB), or a \
                            string \"#rrggbb\" or \"#rgb\".",
            "anyOf": [
                channels,
                {"type": "string", "pattern": "^#([0-9A-Fa-f]{3}|[0-9A-Fa-f]{6})$"},
            ],
            "examples": ["#ff8000", [1, 0.5, 0]],
        })
    }
}

/// The code of a warning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum WarningName {
    /// A code whose own severity is a warning.
    Known(Code),
    /// Any other string; validation reports it at its place.
    Unknown(Box<str>),
}

impl Serialize for WarningName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(match self {
            Self::Known(code) => code.name(),
            Self::Unknown(name) => name,
        })
    }
}

impl<'de> Deserialize<'de> for WarningName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = Box::<str>::deserialize(deserializer)?;
        let mut warnings = Code::WARNINGS.iter().copied();
        let known = warnings.find(|code| code.name() == &*name);
        Ok(known.map_or(Self::Unknown(name), Self::Known))
    }
}

impl JsonSchema for WarningName {
    fn schema_name() -> Cow<'static, str> {
        "Warning".into()
    }

    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        let names: Vec<_> = Code::WARNINGS.iter().map(|code| code.name()).collect();
        json_schema!({
            "description": "The code of a warning.",
            "enum": names,
        })
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

    // A million spheres stay below 80 MB.
    #[test]
    fn geometries_are_small() {
        assert!(size_of::<GeometryModel>() <= 80);
    }
}
