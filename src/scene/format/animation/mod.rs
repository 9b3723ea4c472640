//! The animation of a scene file.

use std::{fmt, iter, marker::PhantomData, sync::LazyLock};

use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor},
    ser::SerializeTuple,
};

use crate::scene::{
    format::{
        color::ColorModel,
        field::{Field, FieldKind},
        map::{Entry, Map},
        numbers::{Interval, ScaleModel, Triple},
        object::object,
        scene::Model,
        sight::UP,
        thing::Type,
        variants::words,
    },
    path,
};

object! {
    /// The changes over time: frame n, from 0, shows the scene at n / fps seconds.
    pub struct AnimationModel = "Animation" {
        /// Frames per second, above 0; 24 is the default.
        fps: Positive = 24.0,
        /// Number of frames, 1 to 1,000,000.
        frames: Count { Self::MOST_FRAMES },
        /// The tracks: the keys of each number, vector or color by its path; required where there is no
        /// `orbit`.
        tracks: Other { Type::Tracks }(TracksModel)?,
        /// A turn of all cameras about a line, at constant speed.
        orbit: Thing(OrbitModel)?,
    } any of tracks, orbit
}

impl AnimationModel {
    pub(crate) const MOST_FRAMES: u32 = 1_000_000;

    /// The tracks with their paths.
    pub(crate) fn tracks(&self) -> &[(Box<str>, Track)] {
        self.tracks.as_ref().map_or(&[], |tracks| &tracks.0)
    }
}

/// Tracks by the paths of what they change, in the order of the file.
pub type TracksModel = Map<Track>;

/// The keys of one value.
#[derive(Clone, Debug, PartialEq)]
pub enum Track {
    /// Keys of a number.
    Numbers(Vec<Key<f64>>),
    /// Keys of a scale.
    Scales(Vec<Key<ScaleModel>>),
    /// Keys of a point.
    Points(Vec<Key<Triple>>),
    /// Keys of a direction.
    Directions(Vec<Key<Triple>>),
    /// Keys of a range.
    Intervals(Vec<Key<Interval>>),
    /// Keys of a color.
    Colors(Vec<Key<ColorModel>>),
    /// Keys of a path to nothing that can change; validation reports the path.
    Unknown,
}

/// Evaluates an expression for the keys of a track, and another for a track of nothing.
macro_rules! of_keys {
    ($track:expr, $keys:ident => $value:expr, _ => $other:expr) => {
        match $track {
            Track::Numbers($keys) => $value,
            Track::Scales($keys) => $value,
            Track::Points($keys) | Track::Directions($keys) => $value,
            Track::Intervals($keys) => $value,
            Track::Colors($keys) => $value,
            Track::Unknown => $other,
        }
    };
}

pub(crate) use of_keys;

impl Track {
    /// Returns the time of each key, and how its value is reached.
    pub(crate) fn times(&self) -> Vec<(f64, Interpolation)> {
        let time = |time, step: Option<Interpolation>| (time, step.unwrap_or_default());
        of_keys!(self, keys => keys.iter().map(|key| time(key.time, key.step)).collect(), _ => Vec::new())
    }
}

/// A value at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Key<T> {
    /// The time in seconds.
    pub time: f64,
    /// The value then.
    pub value: T,
    /// The interpolation from the previous key to this one.
    pub step: Option<Interpolation>,
}

words! {
    /// How a value gets from the key before to this one; `Linear` is the default.
    #[derive(Copy, Default, Eq)]
    pub enum Interpolation = "Interpolation" {
        /// The value stays, then jumps.
        Step,
        /// Constant speed.
        #[default]
        Linear,
        /// A curve without corners that never overshoots.
        Smooth,
    }
}

/// Every field that can change over time, with the field of the scene that its path begins with.
/// Nothing in the animation itself changes.
pub(crate) static CHANGING: LazyLock<Vec<(&Field, Vec<&Field>)>> = LazyLock::new(|| {
    let roots = Model::FIELDS.iter().filter(|root| root.name != "animation");
    let all = roots.map(|root| {
        let inside = (root.of_type)().all_fields();
        let fields = iter::once(root).chain(inside);
        let mut found: Vec<&Field> = Vec::new();
        for field in fields.filter(|field| field.kind.changes()) {
            // A name occurs once.
            if found.iter().all(|other| other.name != field.name) {
                found.push(field);
            }
        }
        (root, found)
    });
    all.filter(|(_, found)| !found.is_empty()).collect()
});

/// The kind of what a path leads to, by the fields of what it begins with; `None` for one number of
/// several.
fn kind_of_path(path: &str) -> Option<Option<FieldKind>> {
    let parts = path::parts(path).ok()?;
    let first = parts.first()?.name()?;
    let Some(name) = parts.last()?.name() else {
        return Some(None);
    };
    let (_, fields) = CHANGING.iter().find(|(root, _)| root.name == first)?;
    let field = fields.iter().find(|field| field.name == name)?;
    Some(Some(field.kind))
}

impl<'de> Entry<'de> for Track {
    const WHAT: &'static str = "a map from paths to tracks";

    fn read<A: MapAccess<'de>>(path: &str, map: &mut A) -> Result<Self, A::Error> {
        match kind_of_path(path) {
            Some(None) => map.next_value().map(Self::Numbers),
            Some(Some(kind)) if kind.is_number() => map.next_value().map(Self::Numbers),
            Some(Some(FieldKind::Scale)) => map.next_value().map(Self::Scales),
            Some(Some(FieldKind::Point | FieldKind::Edge)) => map.next_value().map(Self::Points),
            Some(Some(FieldKind::Direction)) => map.next_value().map(Self::Directions),
            Some(Some(FieldKind::Interval)) => map.next_value().map(Self::Intervals),
            Some(Some(FieldKind::Color)) => map.next_value().map(Self::Colors),
            Some(Some(_)) | None => map.next_value().map(|IgnoredAny| Self::Unknown),
        }
    }
}

impl Serialize for Track {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        of_keys!(self, keys => keys.serialize(serializer), _ => serializer.collect_seq([(); 0]))
    }
}

impl<T: Serialize> Serialize for Key<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(2 + usize::from(self.step.is_some()))?;
        tuple.serialize_element(&self.time)?;
        tuple.serialize_element(&self.value)?;
        if let Some(step) = &self.step {
            tuple.serialize_element(step)?;
        }
        tuple.end()
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Key<T> {
    // The only tuple struct of the format, which is how a reader recognizes that it may lack its
    // last element.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple_struct("Key", 3, KeyVisitor(PhantomData))
    }
}

struct KeyVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for KeyVisitor<T> {
    type Value = Key<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a key: seconds, a value and optionally `Step`, `Linear` or `Smooth`")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Key<T>, A::Error> {
        let short = |length| A::Error::invalid_length(length, &self);
        Ok(Key {
            time: seq.next_element()?.ok_or_else(|| short(0))?,
            value: seq.next_element()?.ok_or_else(|| short(1))?,
            step: seq.next_element()?,
        })
    }
}

object! {
    /// A turn of all cameras about a line, at constant speed: what they look at stays in its place in
    /// the picture, and a movie that repeats goes on without a jump.
    pub struct OrbitModel = "Orbit" {
        /// A point on the line, such as the one that the cameras look at.
        around: Point,
        /// The direction of the line; (0, 1, 0) is the default.
        axis: Direction = UP,
        /// The number of full turns in all frames; 1 is the default. Seen from where the axis points,
        /// the cameras go counterclockwise, and clockwise where the number is negative.
        turns: Number = 1.0,
    }
}
