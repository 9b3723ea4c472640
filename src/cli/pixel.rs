//! `strahl pixel`: how the color of one pixel is computed.

mod hit;
mod light;
mod path;

use std::fmt;

use serde::{Serialize, Serializer, ser::SerializeMap};
use strahl::{
    Camera, Color, Error, Hit, Ray, Scene, Shape, Size,
    light::Transport,
    parallel::Cancel,
    render::{Term, Working},
    scene::Origin,
    shape::FaceId,
    text::Stamp,
};

use self::{
    hit::{Columns, CornerTerms},
    light::LightTerms,
};
use super::{
    camera::{CameraTerms, vector},
    cameras::CameraArgs,
    failure::Failure,
    frame::FrameArgs,
    output::OutputFormat,
    report::{InParts, write_names},
    scene::InputArgs,
};

/// The number of geometries up to which all are listed, even those that the ray misses.
const FEW: usize = 32;

/// Explain one pixel: basis, ray, every term and t, the hit, the color
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    frame: FrameArgs,
    /// The pixel in the coordinates of the camera equations: x from the left, y upwards from the
    /// BOTTOM row, both from 0. Row r of the image file, from its top, is y = height - 1 - r
    #[arg(value_name = "X,Y", value_parser = pixel)]
    pixel: (u32, u32),
    /// Count Y from the top row, like image viewers and `strahl diff`
    #[arg(long)]
    from_top: bool,
    /// Size of the picture in pixels, instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Tell the path of this sample, from 0, step by step, where light follows paths
    #[arg(long, value_name = "J")]
    sample: Option<u32>,
    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "human")]
    output_format: OutputFormat,
}

fn pixel(text: &str) -> Result<(u32, u32), String> {
    let pixel = text.split_once(',').and_then(|(x, y)| {
        let number = |text: &str| text.trim().parse().ok();
        Some((number(x)?, number(y)?))
    });
    pixel.ok_or_else(|| "a pixel is written X,Y, such as 320,240".to_owned())
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let document = args.input.read(0, false)?;
    let scene = args.frame.of(args.camera.of(Scene::try_from(document)?)?)?;
    let size = args.size.unwrap_or(scene.size());
    let (x, y) = args.pixel;
    if x >= size.width() || y >= size.height() {
        return Err(Failure::usage(format!(
            "the pixel {x},{y} is outside the picture, whose pixels are 0,0 to {},{}",
            size.width() - 1,
            size.height() - 1
        )));
    }
    let y = match args.from_top {
        true => size.height() - 1 - y,
        false => y,
    };
    let camera = scene.camera_for(size)?;
    let (frame, never) = (args.frame.number(), Cancel::new());
    let transport = scene.world().lighting().map(|lighting| lighting.transport);
    if args.sample.is_some() && !matches!(transport, Some(Transport::Path(_))) {
        return Err(Failure::usage(
            "--sample is for scenes whose light follows paths: those with `lighting: Path()`"
                .to_owned(),
        ));
    }
    let pixel = ((x, y), args.sample);
    let explanation = Explanation::new(&scene, &camera, frame, size, pixel, &never)?;
    super::output::print_as(args.output_format, Stamp::Pixel, &explanation)
}

/// The explanation of a pixel.
#[derive(Serialize)]
pub(super) struct Explanation<'a> {
    #[serde(flatten)]
    size: Size,
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<u32>,
    x: u32,
    y: u32,
    row_from_top: u32,
    camera: CameraTerms,
    ray: RayTerms,
    geometries: Vec<GeometryTerms<'a>>,
    hit: Option<HitTerms<'a>>,
    /// What a ray sees that hits nothing.
    #[serde(skip)]
    behind: &'static str,
    /// The light of the pixel, unless it shows the color of its hit.
    #[serde(skip_serializing_if = "Option::is_none")]
    light: Option<LightTerms<'a>>,
    color: [f64; 3],
    byte: [u8; 3],
}

#[derive(Serialize)]
struct RayTerms {
    origin: [f64; 3],
    direction: [f64; 3],
}

/// The place of a geometry in the scene.
#[derive(Clone, Serialize)]
struct OriginTerms<'a> {
    /// The index in the list of geometries.
    index: usize,
    /// The index in the list of each group.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    in_groups: Vec<usize>,
    /// The row, if a table is at that index.
    #[serde(skip_serializing_if = "Option::is_none")]
    row: Option<usize>,
    /// The index of the copy, if there are instances at that index.
    #[serde(skip_serializing_if = "Option::is_none")]
    instance: Option<usize>,
    /// The name in the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<&'a str>,
    /// The names of the groups that hold it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    groups: Vec<&'a str>,
    #[serde(skip_serializing_if = "InParts::is_empty")]
    parts: InParts<'a>,
}

#[derive(Serialize)]
struct GeometryTerms<'a> {
    #[serde(flatten)]
    origin: OriginTerms<'a>,
    /// The color; where it depends on the point, that of its own hit if there is one.
    color: [f64; 3],
    /// The value that determines the color.
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<ValueTerms<'a>>,
    #[serde(flatten)]
    terms: Terms<'a>,
    /// The smallest t with 0 < t < ∞.
    t: Option<f64>,
}

/// The step from a value to a color.
#[derive(Serialize)]
struct ValueTerms<'a> {
    column: &'a str,
    /// `None` for NaN: the color is that of missing values.
    value: Option<f64>,
    range: Option<[f64; 2]>,
    /// The place of the value in the range, clamped to 0..=1; `None` for NaN.
    position: Option<f64>,
}

impl<'a> ValueTerms<'a> {
    /// Returns the terms of a geometry: those of a mesh depend on its hit.
    fn of_hit(scene: &'a Scene, index: usize, hit: Option<&Hit<'a>>) -> Option<Self> {
        let of_mesh = || hit?.interpolation()?.value();
        let (value, scale) = scene.value(index).or_else(of_mesh)?;
        Some(Self {
            column: &scale.column,
            value: (!value.is_nan()).then_some(value),
            range: scale.range,
            position: scale.position(value),
        })
    }
}

impl fmt::Display for ValueTerms<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{:?} = ", self.column)?;
        match (self.value, self.position) {
            (Some(value), Some(position)) => {
                write!(out, "{value:?}")?;
                if let Some([low, high]) = self.range {
                    write!(out, " of {low:?} to {high:?}")?;
                }
                write!(out, ", at {position:?} of the map")
            }
            _ => write!(out, "NaN, the color of missing values"),
        }
    }
}

/// The terms of a shape's equation for a ray. They are only computed when they are printed.
struct Terms<'a> {
    shape: &'a Shape,
    ray: Ray,
}

impl Terms<'_> {
    fn kind(&self) -> String {
        let (first, rest) = self.shape.kind().split_at(1);
        first.to_uppercase() + rest
    }

    fn working(&self) -> Working {
        self.shape.working(&self.ray)
    }
}

impl Serialize for Terms<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let working = self.working();
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("kind", &self.kind())?;
        if let Some(form) = &working.form {
            map.serialize_entry("form", form)?;
        }
        let lines = working.lines.iter().flatten();
        serialize_terms(working.parts.iter().chain(lines), &mut map)?;
        if let Some(name) = working.name {
            map.serialize_entry(name, &working.solutions.as_ref().ok())?;
        }
        map.end()
    }
}

/// Adds terms to data, by name: each is a number or a vector.
fn serialize_terms<'a, M: SerializeMap>(
    terms: impl IntoIterator<Item = &'a Term>,
    map: &mut M,
) -> Result<(), M::Error> {
    let mut terms = terms.into_iter();
    terms.try_for_each(|Term { name, numbers, .. }| match &numbers[..] {
        [number] => map.serialize_entry(name, number),
        numbers => map.serialize_entry(name, numbers),
    })
}

#[derive(Serialize)]
struct HitTerms<'a> {
    #[serde(flatten)]
    origin: OriginTerms<'a>,
    t: f64,
    point: [f64; 3],
    normal: [f64; 3],
    front_face: bool,
    /// The value that determines the color of the geometry.
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<ValueTerms<'a>>,
    /// The cells of the row of a table.
    #[serde(flatten)]
    columns: Columns,
    /// The number of the face, of a shape with several.
    #[serde(skip_serializing_if = "Option::is_none")]
    face: Option<u64>,
    /// The other faces that the point lies on.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    also_on: Vec<FaceTerms<'a>>,
    /// The name of the triangle's group in the file of a mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh_group: Option<&'a str>,
    /// The colors or values of the corners of a mesh's triangle, if they determine the color.
    #[serde(skip_serializing_if = "Option::is_none")]
    corners: Option<CornerTerms>,
}

/// A face of a geometry.
#[derive(Serialize)]
struct FaceTerms<'a> {
    #[serde(flatten)]
    origin: OriginTerms<'a>,
    /// Its number, of a shape with several.
    #[serde(skip_serializing_if = "Option::is_none")]
    face: Option<u64>,
}

impl<'a> Explanation<'a> {
    /// Explains a pixel, and one of its paths; `y` counts from the bottom.
    pub(super) fn new(
        scene: &'a Scene,
        camera: &Camera,
        frame: Option<u32>,
        size: Size,
        ((x, y), sample): ((u32, u32), Option<u32>),
        cancel: &Cancel,
    ) -> Result<Self, Error> {
        let (width, height) = (size.width(), size.height());
        let ray = camera.ray_for(width, height, f64::from(x), f64::from(y));
        let world = scene.world();
        let hit = world.hit(&ray);
        let light = scene.explain(size, (x, y), sample, cancel)?;
        let light = light.map(|pixel| LightTerms { scene, pixel });
        let flat = hit.map_or(world.background(), |(_, hit)| hit.color());
        let color = light.as_ref().map_or(flat, |light| light.pixel.color);
        let geometries = world.geometries().iter().enumerate();
        Ok(Self {
            size,
            frame,
            x,
            y,
            row_from_top: height - 1 - y,
            camera: CameraTerms::new(camera),
            ray: RayTerms {
                origin: ray.origin().into(),
                direction: ray.direction().into(),
            },
            geometries: geometries
                .map(|(index, geometry)| {
                    let shape = geometry.shape();
                    let hit = geometry.hit(&ray);
                    let color = hit.map_or(geometry.color(), |hit| hit.color());
                    let face = hit.map_or(0, |hit| hit.face);
                    let id = world.id_of(index, face);
                    let origin = OriginTerms::new(scene, id);
                    GeometryTerms {
                        origin: match hit {
                            Some(_) => origin,
                            None => origin.of_all_copies(),
                        },
                        color: channels(color),
                        value: ValueTerms::of_hit(scene, id, hit.as_ref()),
                        terms: Terms { shape, ray },
                        t: shape.intersect(&ray, f64::INFINITY),
                    }
                })
                .collect(),
            hit: hit.map(|(index, hit)| HitTerms {
                origin: OriginTerms::new(scene, world.id_of(index, hit.face)),
                t: hit.t,
                point: hit.point.into(),
                normal: hit.normal.into(),
                front_face: hit.front_face,
                value: ValueTerms::of_hit(scene, world.id_of(index, hit.face), Some(&hit)),
                columns: Columns::new(scene, world.id_of(index, hit.face), &hit, cancel),
                corners: hit.interpolation().as_ref().map(CornerTerms::new),
                face: hit.face_of_shape(),
                also_on: also_on(scene, &ray, index, &hit),
                mesh_group: hit.mesh_group().map(|group| group.name.as_str()),
            }),
            behind: world.backdrop().map_or("background", |_| "backdrop"),
            light,
            color: channels(color),
            byte: color.to_rgb8(),
        })
    }
}

impl fmt::Display for Explanation<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            size,
            x,
            y,
            row_from_top,
            frame,
            ..
        } = self;
        let frame = frame.map_or_else(String::new, |frame| format!(" at frame {frame}"));
        writeln!(
            out,
            "pixel ({x}, {y}) of {size}{frame}, counted from the bottom left: \
             column {x}, row {row_from_top} from the top of the image file"
        )?;
        write!(out, "\ncamera, {}", self.camera)?;
        writeln!(out, "\nray")?;
        writeln!(out, "  origin o     {}", vector(self.ray.origin))?;
        writeln!(out, "  direction d  {}", vector(self.ray.direction))?;

        writeln!(out, "\ngeometries")?;
        let few = self.geometries.len() <= FEW;
        let shown = self
            .geometries
            .iter()
            .filter(|terms| few || terms.t.is_some());
        let mut hidden = self.geometries.len();
        for terms in shown {
            write!(out, "{terms}")?;
            hidden -= 1;
        }
        if hidden > 0 {
            writeln!(
                out,
                "  and {hidden} more that the ray misses (--output-format json lists them)"
            )?;
        }

        writeln!(out, "\nhit")?;
        match &self.hit {
            None => writeln!(out, "  nothing: the ray sees the {}", self.behind)?,
            Some(hit) => {
                writeln!(out, "  {} at t = {:?}, the smallest", hit.origin, hit.t)?;
                writeln!(out, "  point        {}", vector(hit.point))?;
                writeln!(out, "  normal       {}", vector(hit.normal))?;
                let side = if hit.front_face { "front" } else { "back" };
                writeln!(out, "  seen from    the {side}")?;
                write!(out, "{}", hit.columns)?;
                if let Some(value) = &hit.value {
                    writeln!(out, "  color by     {value}")?;
                }
                if let Some(face) = hit.face {
                    write!(out, "  face         {face}")?;
                    match hit.mesh_group {
                        Some(name) => writeln!(out, ", of the group {name:?}")?,
                        None => writeln!(out)?,
                    }
                }
                for other in hit.also_on.iter().take(FEW) {
                    writeln!(out, "  also on      {other}")?;
                }
                if let Some(more @ 1..) = hit.also_on.len().checked_sub(FEW) {
                    writeln!(out, "  and {more} more faces")?;
                }
                if let Some(corners) = &hit.corners {
                    write!(out, "{corners}")?;
                }
            }
        }
        if let Some(light) = &self.light {
            light.fmt(out)?;
        }
        let [r, g, b] = self.byte;
        writeln!(out, "\ncolor          {}", vector(self.color))?;
        writeln!(
            out,
            "bytes          ({r}, {g}, {b}), each floor(c * 255 + 0.5)"
        )
    }
}

/// Returns the other faces that the point of a hit lies on.
fn also_on<'a>(scene: &'a Scene, ray: &Ray, index: usize, hit: &Hit) -> Vec<FaceTerms<'a>> {
    let world = scene.world();
    let own = FaceId {
        geometry: index,
        face: hit.face,
    };
    let others = world.faces_at(ray, index, hit).into_iter();
    let terms = |FaceId { geometry, face }: FaceId| FaceTerms {
        origin: OriginTerms::new(scene, world.id_of(geometry, face)),
        face: world.geometries()[geometry].face_of_shape(face),
    };
    others.filter(|face| *face != own).map(terms).collect()
}

impl fmt::Display for FaceTerms<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let face = self.face.map(|face| format!(", face {face}"));
        write!(out, "{}{}", self.origin, face.unwrap_or_default())
    }
}

impl<'a> OriginTerms<'a> {
    /// Returns the terms of the list of the copies, if it is one of some.
    fn of_all_copies(self) -> Self {
        Self {
            instance: None,
            ..self
        }
    }

    fn new(scene: &'a Scene, index: usize) -> Self {
        let Origin {
            geometry,
            in_groups,
            row,
            instance,
        } = scene.origin(index);
        Self {
            index: geometry,
            in_groups,
            row,
            instance,
            name: scene.name(index),
            groups: scene.groups(index),
            parts: InParts::new(scene, index),
        }
    }
}

impl fmt::Display for OriginTerms<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}]", self.index)?;
        for index in &self.in_groups {
            write!(f, ".geometries[{index}]")?;
        }
        if let Some(row) = self.row {
            write!(f, " row {row}")?;
        }
        if let Some(instance) = self.instance {
            write!(f, " instance {instance}")?;
        }
        write_names(f, self.name, &self.groups)?;
        self.parts.fmt(f)
    }
}

impl fmt::Display for GeometryTerms<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let working = self.terms.working();
        write!(out, "  {} {}", self.origin, self.terms.kind())?;
        if let Some(form) = &working.form {
            write!(out, ", {form}")?;
        }
        for Term {
            symbol, numbers, ..
        } in &working.parts
        {
            write!(out, ", {symbol} {}", shown(numbers))?;
        }
        writeln!(out)?;
        for line in &working.lines {
            let terms: Vec<_> = line
                .iter()
                .map(|term| format!("{} = {}", term.symbol, shown(&term.numbers)))
                .collect();
            writeln!(out, "      {}", terms.join(", "))?;
        }
        match &working.solutions {
            Err(why) => writeln!(out, "      no t: {why}")?,
            Ok(found) => {
                let found: Vec<_> = found.iter().map(|t| format!("{t:?}")).collect();
                writeln!(out, "      t = {}", found.join(" and "))?;
            }
        }
        match self.t {
            Some(t) => writeln!(out, "      hit at t = {t:?}"),
            None => writeln!(out, "      missed: no t with 0 < t < ∞"),
        }
    }
}

/// Returns a number, or a vector, with all of its digits.
fn shown(numbers: &[f64]) -> String {
    match *numbers {
        [number] => format!("{number:?}"),
        [x, y, z] => vector([x, y, z]),
        _ => String::new(),
    }
}

fn channels(color: Color) -> [f64; 3] {
    [color.r(), color.g(), color.b()]
}
