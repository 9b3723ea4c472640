//! The properties of a PLY file that are read: places, radii, colors and values.

use crate::{
    data::{
        fault::Fault,
        ply::header::{Element, Property, Type},
        table::{
            layout::{COLORS, Columns, Scalar, VALUE},
            request::Request,
            select::{self, Known, Names},
        },
    },
    text::nearest::quote,
};

/// The properties of a vertex that is a sphere.
pub(crate) const KNOWN: Known = known(Some("radius"), COLOR);

/// The channels of the color of a vertex.
const COLOR: [Option<&str>; 3] = [Some("red"), Some("green"), Some("blue")];

/// The same as old programs name them.
const DIFFUSE: [Option<&str>; 3] = [
    Some("diffuse_red"),
    Some("diffuse_green"),
    Some("diffuse_blue"),
];

/// The names of one number with all channels, as the Point Cloud Library writes them.
const PACKED: [&str; 2] = ["rgb", "rgba"];

/// The names of the texture coordinates of a vertex.
const UV: [[&str; 2]; 3] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];

/// The properties of the color of an element, if it has one.
#[derive(Clone, Copy)]
enum ColorOf {
    Channels([Option<&'static str>; 3]),
    Packed(usize),
}

impl ColorOf {
    fn new(element: &Element) -> Self {
        let has = |name: &str| element.properties.iter().any(|each| each.name == name);
        let packed = |property: &Property| {
            let is_number = matches!(
                property.kind,
                Type::Scalar(Scalar::F32 | Scalar::I32 | Scalar::U32)
            );
            is_number && PACKED.contains(&property.name.as_str())
        };
        let is_any = |names: [Option<&str>; 3]| names.into_iter().flatten().any(has);
        match element.properties.iter().position(packed) {
            _ if is_any(COLOR) => Self::Channels(COLOR),
            _ if is_any(DIFFUSE) => Self::Channels(DIFFUSE),
            Some(index) => Self::Packed(index),
            None => Self::Channels(COLOR),
        }
    }
}

/// Returns the properties of a vertex with or without a radius and a color.
const fn known(radius: Option<&'static str>, color: [Option<&'static str>; 3]) -> Known {
    let [red, green, blue] = color;
    Known {
        columns: [
            Some("x"),
            Some("y"),
            Some("z"),
            None,
            None,
            None,
            radius,
            red,
            green,
            blue,
        ],
        hex: None,
        columns_word: "properties",
        missing: "the element `vertex` has no property",
        rotation: &[],
    }
}

/// A property that is read: its index, its type and the divisor of its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Selected {
    pub(crate) index: usize,
    pub(crate) scalar: Scalar,
    pub(crate) divisor: f64,
    /// The first bit of a channel, if one number has all of them, or a byte with a sign.
    pub(crate) shift: Option<u32>,
}

impl Selected {
    const fn new(index: usize, scalar: Scalar) -> Self {
        Self {
            index,
            scalar,
            divisor: 1.0,
            shift: None,
        }
    }

    /// Selects the property with a name, if it is a number.
    fn named(element: &Element, name: &str) -> Option<Self> {
        let mut properties = element.properties.iter().enumerate();
        let (index, property) = properties.find(|(_, property)| property.name == name)?;
        match property.kind {
            Type::Scalar(scalar) => Some(Self::new(index, scalar)),
            Type::List { .. } => None,
        }
    }

    /// Returns the number that a value of the property stands for.
    #[inline(always)]
    pub(crate) fn number(&self, value: f64) -> f64 {
        match self.shift {
            None => value / self.divisor,
            Some(shift) => {
                let bits = match self.scalar {
                    Scalar::F32 => (value as f32).to_bits(),
                    _ => value as i64 as u32,
                };
                f64::from((bits >> shift) & 0xff) / self.divisor
            }
        }
    }
}

/// The properties that are read.
pub(crate) struct Selection {
    pub(crate) columns: Columns<Option<Selected>>,
    pub(crate) names: Names,
}

impl Selection {
    /// Selects the properties of spheres.
    pub(crate) fn of_spheres(vertex: &Element, request: &Request) -> Result<Self, Fault> {
        Self::new(vertex, Some("radius"), true, request)
    }

    /// Selects the properties of the corners of triangles: their colors if these are wanted, and the
    /// property whose values determine the colors.
    pub(crate) fn of_corners(
        vertex: &Element,
        has_colors: bool,
        value: Option<&str>,
    ) -> Result<Self, Fault> {
        let request = Request {
            value,
            ..Request::default()
        };
        Self::new(vertex, None, has_colors, &request)
    }

    /// Selects the color of a face, if it has one.
    pub(crate) fn of_face(face: &Element) -> Option<[Selected; 3]> {
        let [red, green, blue] = match ColorOf::new(face) {
            ColorOf::Packed(index) => return packed(face, index),
            ColorOf::Channels(names) => names.map(|name| Selected::named(face, name?)),
        };
        Some([red?, green?, blue?].map(channel))
    }

    /// Selects the texture coordinates of a vertex, if it has some.
    pub(crate) fn of_uv(vertex: &Element) -> Option<[Selected; 2]> {
        UV.into_iter().find_map(|names| {
            let [u, v] = names.map(|name| Selected::named(vertex, name));
            Some([u?, v?])
        })
    }

    fn new(
        vertex: &Element,
        radius: Option<&'static str>,
        has_colors: bool,
        request: &Request,
    ) -> Result<Self, Fault> {
        let color = ColorOf::new(vertex);
        let known = &match color {
            ColorOf::Channels(names) if has_colors => known(radius, names),
            _ => known(radius, [None; 3]),
        };
        let names: Vec<_> = vertex
            .properties
            .iter()
            .map(|each| each.name.as_str())
            .collect();
        let selection = select::Selection::new(&names, known, request)?;
        let mut columns = [None; _];
        for (at, (column, place)) in columns.iter_mut().zip(selection.places).enumerate() {
            let property = place.and_then(|index| Some((index, vertex.properties.get(index)?)));
            let Some((index, property)) = property else {
                continue;
            };
            let Type::Scalar(scalar) = property.kind else {
                let name = quote(&property.name);
                let message = format!("the property {name} is a list, expected a number");
                let fault = Fault::new(message);
                return Err(match at {
                    VALUE => fault.blame_value(&names_of_numbers(vertex)),
                    _ => fault,
                });
            };
            let selected = Selected::new(index, scalar);
            *column = Some(match COLORS.contains(&at) {
                true => channel(selected),
                false => selected,
            });
        }
        if let ColorOf::Packed(index) = color
            && has_colors
            && request.value.is_none()
            && let Some(channels) = packed(vertex, index)
        {
            let of_color = columns.iter_mut().skip(COLORS.start);
            for (column, channel) in of_color.zip(channels) {
                *column = Some(channel);
            }
        }
        // Vertices have normals, texture coordinates and more, which spheres do not need.
        let names = Names {
            unused: [].into(),
            ..selection.names
        };
        Ok(Self { columns, names })
    }

    /// The properties in the order of the columns.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Selected> {
        self.columns.iter().flatten()
    }

    /// Returns which columns there are.
    pub(crate) fn has(&self) -> Columns<bool> {
        self.columns.map(|selected| selected.is_some())
    }
}

fn names_of_numbers(vertex: &Element) -> Vec<&str> {
    let properties = vertex.properties.iter();
    let numbers = properties.filter(|property| matches!(property.kind, Type::Scalar(_)));
    numbers.map(|property| property.name.as_str()).collect()
}

/// Sets the divisor of a channel: its largest value, by its type. The other integers hold bytes, a
/// `char` those from 128 on as negative numbers.
const fn channel(selected: Selected) -> Selected {
    let divisor = match selected.scalar {
        Scalar::F16 | Scalar::F32 | Scalar::F64 => 1.0,
        Scalar::U16 => 65535.0,
        _ => 255.0,
    };
    let shift = match selected.scalar {
        Scalar::I8 => Some(0),
        _ => selected.shift,
    };
    Selected {
        divisor,
        shift,
        ..selected
    }
}

/// Returns the channels of a color in one number: red, green and blue from bit 16 on down.
fn packed(element: &Element, index: usize) -> Option<[Selected; 3]> {
    let Type::Scalar(scalar) = element.properties.get(index)?.kind else {
        return None;
    };
    Some([16, 8, 0].map(|shift| Selected {
        divisor: 255.0,
        shift: Some(shift),
        ..Selected::new(index, scalar)
    }))
}
