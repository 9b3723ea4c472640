//! The layout of a file: from layers and a format to the numbers of each pixel.

use crate::{
    diagnostic::error::Error,
    film::Centers,
    image_file::{
        Content, ImageFormat, cryptomatte,
        pixel::{Array, Channel, Pixel, Sample},
    },
    render::layers::{
        Layer,
        number::{Light, MATTES, Number, Quantity, Range},
    },
    tracer::{srgb::quantize, world::World},
};

/// The name of the Cryptomatte layer, from which compositors read the geometry of each pixel.
pub(crate) const MATTE: &str = "CryptoObject";

/// The options for writing layers.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Settings {
    /// The number of bits per number.
    pub(crate) bits: Option<u8>,
    /// True if the file has alpha instead of the background.
    pub(crate) is_transparent: bool,
    /// The depths that become 0 and the largest integer.
    pub(crate) depth_range: Option<(f64, f64)>,
}

/// The layout of a file.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    shape: Shape,
    /// The numbers of a pixel, by part. A row has all pixels of the first part, then those of the
    /// second, and so on; within a part, the numbers of a pixel are adjacent.
    pub(super) parts: Vec<Vec<Number>>,
    /// True if the layers include color.
    pub(crate) is_color: bool,
}

#[derive(Clone, Debug)]
enum Shape {
    Single(Pixel<'static>),
    Indexed(Vec<[u8; 3]>),
    Channels(Vec<Channel>),
    Arrays(Vec<Array>),
}

impl Layout {
    /// Creates the layout of layers of a world in a file format.
    pub(crate) fn new(
        format: ImageFormat,
        layers: &[Layer],
        settings: Settings,
        world: &World,
    ) -> Result<Self, Error> {
        let of_paths = |layer: &&Layer| matches!(layer, Layer::Error | Layer::Samples);
        if let Some(layer) = layers.iter().find(of_paths)
            && world.paths().is_none()
        {
            return refuse(format!(
                "the layer {layer} is for lit scenes with `lighting: Path()`; the light of other \
                 pictures has no noise"
            ));
        }
        let is_color = layers.contains(&Layer::Color);
        let (shape, parts) = match format.content() {
            Content::Channels => channels(layers, settings)?,
            Content::Arrays => {
                let mut arrays = Vec::new();
                let mut parts = Vec::new();
                for layer in layers {
                    let (pixel, numbers) = single(format, *layer, settings, world)?;
                    let name = layer.name().to_owned();
                    arrays.push(Array { name, pixel });
                    parts.push(numbers);
                }
                (Shape::Arrays(arrays), parts)
            }
            _ => {
                let [layer] = layers else {
                    let name = format.name();
                    let several = ImageFormat::list(ImageFormat::has_layers);
                    return refuse(format!(
                        "a {name} file holds one layer; {several} files hold several"
                    ));
                };
                let (pixel, numbers) = single(format, *layer, settings, world)?;
                let is_indexed =
                    format.has_palette() && pixel == Pixel::Gray(Sample::U8) && *layer == Layer::Id;
                let shape = if is_indexed {
                    Shape::Indexed(id_colors(world.ids()))
                } else {
                    Shape::Single(pixel)
                };
                (shape, vec![numbers])
            }
        };
        Ok(Self {
            shape,
            parts,
            is_color,
        })
    }

    /// Returns the pixel type of the file.
    pub(crate) fn pixel(&self) -> Pixel<'_> {
        match &self.shape {
            Shape::Single(pixel) => *pixel,
            Shape::Indexed(palette) => Pixel::Indexed(palette),
            Shape::Channels(channels) => Pixel::Channels(channels),
            Shape::Arrays(arrays) => Pixel::Arrays(arrays),
        }
    }

    /// Returns true if any number has a matching quantity.
    pub(super) fn needs(&self, is_it: impl Fn(Quantity) -> bool) -> bool {
        let mut numbers = self.parts.iter().flatten();
        numbers.any(|number| is_it(number.quantity))
    }

    /// Returns the data of center rays that the layers need.
    pub(crate) fn centers(&self) -> Centers {
        if self.has_places() || self.needs(|quantity| quantity == Quantity::Depth) {
            Centers::Hits
        } else if self.needs(|quantity| quantity == Quantity::Id) {
            Centers::Ids
        } else {
            Centers::Unneeded
        }
    }

    /// Returns true if the file has more of the hits of center rays than their ids and t.
    pub(crate) fn has_places(&self) -> bool {
        use Quantity::{Normal, Position, Z};
        self.needs(|quantity| matches!(quantity, Z | Position(_) | Normal(_)))
    }

    /// Returns true if the file has parts of the light, or more about it.
    pub(crate) fn has_parts(&self) -> bool {
        self.needs(|quantity| match quantity {
            Quantity::Light(light, _) | Quantity::Display(light, _) => light != Light::All,
            Quantity::Samples => true,
            _ => false,
        })
    }

    /// Returns true if the file lists the geometries that cover a pixel, with their coverage.
    pub(crate) fn has_mattes(&self) -> bool {
        self.needs(|quantity| matches!(quantity, Quantity::Matte(_)))
    }
}

fn refuse<T>(message: String) -> Result<T, Error> {
    Err(Error::refused(message))
}

/// Returns true if the format stores layers at full precision.
fn is_exact(format: ImageFormat) -> bool {
    matches!(format.content(), Content::Array | Content::Arrays)
}

/// Returns the pixel type of a single layer, and its numbers.
fn single(
    format: ImageFormat,
    layer: Layer,
    settings: Settings,
    world: &World,
) -> Result<(Pixel<'static>, Vec<Number>), Error> {
    // Formats that hold numbers of any size and sign.
    let as_it_is =
        || ImageFormat::list(|other| other.content() != Content::Integers && other.has_signs());
    if !format.has_signs() && matches!(layer, Layer::Position | Layer::Normal) {
        return refuse(format!(
            "{} files cannot hold negative numbers, which {layer} has; {} files hold it as it is",
            format.name(),
            as_it_is()
        ));
    }
    if format.content() == Content::Integers && layer == Layer::Samples {
        return refuse(format!(
            "{} files cannot hold the layer samples, whose numbers may be large; {} files hold it",
            format.name(),
            as_it_is()
        ));
    }
    let sample = sample(format, layer, settings.bits, world)?;
    let range = match (layer, settings.depth_range) {
        (
            Layer::Color
            | Layer::Coverage
            | Layer::Direct
            | Layer::Specular
            | Layer::Albedo
            | Layer::Error,
            _,
        ) => Range::Unit,
        (Layer::Position | Layer::Samples, _) => Range::Same,
        (Layer::Normal, _) => Range::Signed,
        (Layer::Id, _) => Range::FromOne,
        (Layer::Depth | Layer::Z, _) if is_float(sample) => Range::Same,
        (Layer::Depth | Layer::Z, Some((near, far))) => Range::Depth(near, far),
        (Layer::Depth | Layer::Z, None) => {
            return refuse(format!(
                "{layer} as integers needs --depth-range NEAR,FAR, the depths that become 0 and \
                 the largest integer; {} files hold it as it is",
                as_it_is()
            ));
        }
    };
    let numbers = quantities(layer, sample, settings.is_transparent);
    let numbers = numbers.into_iter().map(|quantity| Number {
        quantity,
        sample,
        range,
    });
    let numbers: Vec<_> = numbers.collect();
    let pixel = match numbers.len() {
        1 => Pixel::Gray(sample),
        3 => Pixel::Rgb(sample),
        _ => Pixel::Rgba(sample),
    };
    Ok((pixel, numbers))
}

const fn is_float(sample: Sample) -> bool {
    matches!(sample, Sample::F16 | Sample::F32 | Sample::F64)
}

/// Returns the sample type of a single layer.
fn sample(
    format: ImageFormat,
    layer: Layer,
    bits: Option<u8>,
    world: &World,
) -> Result<Sample, Error> {
    let is_array = is_exact(format);
    let exact = if is_array { Sample::F64 } else { Sample::F32 };
    let default = match (layer, format.content()) {
        (Layer::Id, _) => return id_sample(format, world.ids()),
        (Layer::Position, _) => return Ok(exact),
        (Layer::Samples, _) if is_array => return Ok(Sample::U32),
        (Layer::Coverage, Content::Integers | Content::Either) => Sample::U8,
        (layer, content) if layer.light().is_some() => match content {
            Content::Floats => Sample::F32,
            // The light of a lit picture has no largest value.
            Content::Array | Content::Arrays if layer == Layer::Color => match world.lighting() {
                Some(_) => Sample::F32,
                None => Sample::U8,
            },
            Content::Array | Content::Arrays => exact,
            Content::Integers | Content::Either | Content::Channels => Sample::U8,
        },
        (_, Content::Integers) => Sample::U16,
        _ => exact,
    };
    Ok(match bits {
        None => default,
        // In arrays, bits apply only to colors; all other layers stay exact.
        Some(_) if is_array && layer != Layer::Color => default,
        Some(8) => Sample::U8,
        Some(16) => Sample::U16,
        Some(_) => Sample::F32,
    })
}

/// Returns the smallest type of the format that holds the ids of this many geometries.
fn id_sample(format: ImageFormat, geometries: usize) -> Result<Sample, Error> {
    Ok(match geometries {
        _ if is_exact(format) => Sample::U32,
        ..=0xff if format.has_palette() => Sample::U8,
        ..=0xffff => Sample::U16,
        _ => {
            let name = format.name();
            let more =
                ImageFormat::list(|other| is_exact(other) || other.content() == Content::Channels);
            return refuse(format!(
                "{geometries} geometries are too many for the ids of a {name} file, which end at \
                 65535; {more} files hold more"
            ));
        }
    })
}

/// Returns the quantities of a layer with this sample type.
fn quantities(layer: Layer, sample: Sample, is_transparent: bool) -> Vec<Quantity> {
    let three = |of: fn(usize) -> Quantity| (0..3).map(of).collect();
    let light = |light| {
        let channels = (0..3).map(|channel| {
            if is_float(sample) {
                Quantity::Light(light, channel)
            } else {
                Quantity::Display(light, channel)
            }
        });
        channels.collect()
    };
    match layer {
        Layer::Color => {
            let mut color: Vec<_> = if is_float(sample) && !is_transparent {
                three(Quantity::Premultiplied)
            } else {
                light(Light::All)
            };
            color.extend(is_transparent.then_some(Quantity::Alpha));
            color
        }
        Layer::Position => three(Quantity::Position),
        Layer::Normal => three(Quantity::Normal),
        Layer::Direct | Layer::Specular | Layer::Albedo | Layer::Error => {
            layer.light().map(light).unwrap_or_default()
        }
        Layer::Coverage => vec![Quantity::Coverage],
        Layer::Depth => vec![Quantity::Depth],
        Layer::Z => vec![Quantity::Z],
        Layer::Id => vec![Quantity::Id],
        Layer::Samples => vec![Quantity::Samples],
    }
}

/// The channels of a color, and of a vector.
const RGB: &[&str] = &["R", "G", "B"];
const XYZ: &[&str] = &["X", "Y", "Z"];

/// Returns all layers as channels, with the usual names for them.
fn channels(layers: &[Layer], settings: Settings) -> Result<(Shape, Vec<Vec<Number>>), Error> {
    let colors = match settings.bits {
        None | Some(32) => Sample::F32,
        Some(16) => Sample::F16,
        Some(bits) => {
            return refuse(format!(
                "exr files hold 16 or 32 bits, and --bits is {bits}"
            ));
        }
    };
    let (mut channels, mut parts) = (Vec::new(), Vec::new());
    let mut add = |name: &str, quantity, sample| {
        let name = name.to_owned();
        channels.push(Channel { name, sample });
        let range = Range::Same;
        parts.push(vec![Number {
            quantity,
            sample,
            range,
        }]);
    };
    let has_alpha = settings.is_transparent && layers.contains(&Layer::Color);
    if has_alpha {
        add("A", Quantity::Alpha, colors);
    } else if layers.contains(&Layer::Coverage) {
        add("A", Quantity::Coverage, colors);
    }
    for layer in layers {
        let own = format!("{layer}.");
        let (group, names, sample): (_, &[&str], _) = match layer {
            Layer::Color => ("", RGB, colors),
            Layer::Coverage => continue,
            Layer::Depth => ("", &["Z"], Sample::F32),
            Layer::Z => ("planar.", &["Z"], Sample::F32),
            Layer::Position => ("P.", XYZ, Sample::F32),
            Layer::Normal => ("N.", XYZ, Sample::F32),
            Layer::Id => ("", &["id"], Sample::U32),
            Layer::Samples => ("", &["samples"], Sample::U32),
            Layer::Albedo | Layer::Direct | Layer::Specular | Layer::Error => (&*own, RGB, colors),
        };
        for (name, quantity) in names.iter().zip(quantities(*layer, sample, false)) {
            add(&format!("{group}{name}"), quantity, sample);
        }
        if *layer == Layer::Id {
            let mattes = cryptomatte::channels(MATTE, MATTES / 2);
            for (place, channel) in mattes.into_iter().enumerate() {
                let quantity = match place % 2 {
                    0 => Quantity::Matte(place / 2),
                    _ => Quantity::MatteCoverage(place / 2),
                };
                add(&channel.name, quantity, channel.sample);
            }
        }
    }
    Ok((Shape::Channels(channels), parts))
}

/// Returns colors that distinguish ids: black for nothing, then hues around the circle by the
/// golden ratio.
fn id_colors(geometries: usize) -> Vec<[u8; 3]> {
    let hue = |id: usize| (id as f64 * 0.618_033_988_749_894_9).fract() * 6.0;
    let channel = |hue: f64, shift: f64| {
        let place = (hue + shift) % 6.0;
        let value = ((place - 3.0).abs() - 1.0).clamp(0.0, 1.0);
        quantize(0.25 + 0.75 * value, u8::MAX.into()) as u8
    };
    let colors = (0..geometries).map(|id| [0.0, 4.0, 2.0].map(|shift| channel(hue(id), shift)));
    std::iter::once([0; 3]).chain(colors).collect()
}
