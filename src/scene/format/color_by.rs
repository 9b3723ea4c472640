//! Colors by the values of a column, in a scene file.

use crate::{
    scene::format::{
        color::ColorModel, field::FieldKind, object::object, thing::Type, variants::words,
    },
    tracer::colormap::{Colormap, scale::ColorScale},
};

object! {
    /// Colors by the values of a column.
    pub struct ColorByModel = "ColorBy" {
        /// The name of the column; its values are numbers.
        column: Text(Box<str>),
        /// The values of the first and the last color of the map; values outside are clamped. The
        /// smallest and the largest value of the column are the default.
        range: Interval?,
        /// The colors; `Viridis` is the default.
        map: Choice(ColormapModel) = ColormapModel::Viridis,
        /// The color of rows without a value: NaN, or an empty cell; `"#ff00ff"` is the default.
        missing: Color = ColorModel::Hex([0xff, 0, 0xff]),
    }
}

words! {
    /// The colors of values. Between two colors, display values are interpolated.
    #[derive(Default)]
    pub enum ColormapModel = "Colormap" {
        /// Dark blue, green, yellow; even steps for the eye.
        #[default]
        Viridis,
        /// Dark blue to yellow; the same to most people with a color vision deficiency.
        Cividis,
        /// Black, red, light yellow.
        Inferno,
        /// A rainbow: dark blue, green, dark red.
        Turbo,
        /// Blue, light gray, red; for values with a middle.
        Coolwarm,
        /// Black to white.
        Gray,
        /// These colors at equal steps; at least two.
        Colors(Vec<ColorModel>): Type::List(|| Type::Value(FieldKind::Color), 2),
    }
}

impl ColorByModel {
    /// The colors of values, whose smallest and largest are `data`.
    pub(crate) fn build(&self, data: Option<[f64; 2]>) -> ColorScale {
        let map = self.map.as_ref().map(ColormapModel::build);
        ColorScale {
            column: self.column.clone(),
            range: self.range.or(data),
            map: map.unwrap_or_else(Colormap::viridis),
            missing: self.missing().build(),
        }
    }
}

impl ColormapModel {
    fn build(&self) -> Colormap {
        match self {
            Self::Viridis => Colormap::viridis(),
            Self::Cividis => Colormap::cividis(),
            Self::Inferno => Colormap::inferno(),
            Self::Turbo => Colormap::turbo(),
            Self::Coolwarm => Colormap::coolwarm(),
            Self::Gray => Colormap::gray(),
            Self::Colors(colors) => {
                let colors: Vec<_> = colors.iter().map(ColorModel::build).collect();
                // Validation has rejected an empty list.
                Colormap::new(colors).unwrap_or_else(Colormap::gray)
            }
        }
    }
}
