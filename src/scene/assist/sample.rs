//! Types in a few words, and values of a type as text.

use crate::{
    scene::{
        format::{
            field::{Field, FieldKind},
            thing::{Needs, Type, Variant},
        },
        schema::{bounds, whole},
    },
    text::syntax::Syntax,
};

/// The samples of the points of an object, in its order.
const POINTS: [[i8; 3]; 3] = [[0, 0, 0], [1, 1, 1], [1, 0, 0]];
/// That of a direction.
const SIGHT: [[i8; 3]; 1] = [[0, 0, -1]];
/// Those of several.
const EDGES: [[i8; 3]; 2] = [[1, 0, 0], [0, 1, 0]];
/// That of a list of three directions.
const AXES: [[i8; 3]; 3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/// Returns a type in a few words.
pub(super) fn words(of_type: Type) -> String {
    let bounded = |what: &str, range| {
        let bounds = bounds(range).into_iter();
        let bounds = bounds
            .map(|(_, words, bound)| format!(", {words} {}", bound.as_f64().unwrap_or_default()));
        what.to_owned() + &bounds.collect::<String>()
    };
    match of_type {
        Type::Flag => "true or false".to_owned(),
        Type::Value(FieldKind::Color) => "color".to_owned(),
        Type::Value(FieldKind::Scale) => String::new(),
        Type::Value(FieldKind::Interval) => "2 numbers".to_owned(),
        Type::Value(kind) if kind.is_vector() => "3 numbers".to_owned(),
        Type::Value(kind) => {
            let what = if kind.is_number() {
                "number"
            } else {
                "integer"
            };
            kind.range()
                .map_or_else(|| what.to_owned(), |range| bounded(what, range))
        }
        Type::Whole(_) => "integer, at least 0".to_owned(),
        Type::Tuple(_, count) => format!("{count} numbers"),
        Type::Matrix => "3 numbers".to_owned(),
        Type::List(..) => "list".to_owned(),
        Type::OneOf(_) => {
            let names: Vec<_> = of_type.variants().iter().map(|one| one.name).collect();
            match names.len() {
                0..=6 => names.join(" | "),
                _ => "one of several".to_owned(),
            }
        }
        _ if of_type.is_text() => "string".to_owned(),
        _ => String::new(),
    }
}

/// Returns the type of a field and its default in a few words.
pub(super) fn words_of_field(field: &Field) -> String {
    let words = words((field.of_type)());
    let words = match field.default {
        None => words,
        Some(default) => format!("{words}, default {}", whole(default())),
    };
    match field.is_required {
        true => format!("{words}, required"),
        false => words,
    }
}

/// Returns the fields of an object by their names, those that are needed first; true for these, which
/// are the required ones, and the first of several of which one is.
pub(super) fn fields(of_type: Type) -> Vec<(bool, &'static Field)> {
    let Type::Object(object, is_operand) = of_type else {
        return Vec::new();
    };
    let is_first = |name: &str| {
        let mut sets = object.sets.iter();
        sets.any(|set| match set.needs {
            Needs::One => !is_operand && set.first() == Some(name),
            Needs::AtMostOne => false,
            Needs::Any => set.first() == Some(name),
        })
    };
    let fields = object.fields.iter();
    let fields = fields.map(|field| (field.is_required || is_first(field.name), field));
    let mut fields: Vec<_> = fields.collect();
    fields.sort_by_key(|(is_needed, field)| (!is_needed, !field.is_required, field.name));
    fields
}

/// Returns a value of a type as text, with all that is required.
pub(super) fn sample(of_type: Type, syntax: Syntax) -> String {
    let tuple = |parts: &[String]| syntax.tuple(&parts.join(", "));
    let vector = |vector: [i8; 3]| tuple(&vector.map(|number| number.to_string()));
    match of_type {
        Type::Flag => "true".to_owned(),
        Type::Value(FieldKind::Color) => "\"#808080\"".to_owned(),
        Type::Value(FieldKind::Interval) => tuple(&["0".to_owned(), "0".to_owned()]),
        Type::Value(kind) if kind.is_vector() => vector([0; 3]),
        Type::Value(_) | Type::Whole(_) => "1".to_owned(),
        Type::Tuple(..) | Type::Matrix => format!("[{}]", AXES.map(vector).join(", ")),
        Type::List(item, 1..) => format!("[{}]", sample(item(), syntax)),
        Type::List(..) => "[]".to_owned(),
        Type::Object(..) => object(of_type, vector, syntax),
        Type::OneOf(_) => {
            let variants = of_type.variants();
            let first = variants.first();
            first.map_or_else(String::new, |first| sample_of(of_type, first, syntax))
        }
        _ => "\"\"".to_owned(),
    }
}

fn object(of_type: Type, vector: impl Fn([i8; 3]) -> String, syntax: Syntax) -> String {
    let mut needed = fields(of_type);
    needed.retain(|(is_needed, _)| *is_needed);
    // Those that are always required come first, in the order of the manual.
    let place = |field: &Field| of_type.fields().position(|other| other.name == field.name);
    needed.sort_by_key(|(_, field)| (!field.is_required, place(field)));
    let is_direction = |kind| kind == FieldKind::Direction || kind == FieldKind::Edge;
    let directions = needed.iter().filter(|(_, field)| is_direction(field.kind));
    // Not a box without a size, nor edges along one line.
    let directions = if directions.count() > 1 {
        &EDGES[..]
    } else {
        &SIGHT
    };
    let (mut directions, mut points) = (directions.iter(), POINTS.iter());
    let fields = needed.iter().map(|(_, field)| {
        let point = match field.kind {
            kind if is_direction(kind) => directions.next(),
            FieldKind::Point => points.next(),
            _ => None,
        };
        let value = match point {
            Some(point) => vector(*point),
            None => sample((field.of_type)(), syntax),
        };
        syntax.key(field.name) + &value
    });
    syntax.object(&fields.collect::<Vec<_>>().join(", "))
}

/// Returns a variant of a type as text, with all that is required.
pub(super) fn sample_of(of_type: Type, variant: &Variant, syntax: Syntax) -> String {
    let name = variant.name;
    match (of_type.content(variant), syntax) {
        (None, _) => syntax.word(name),
        // An object has brackets of its own.
        (Some(content @ Type::Object(..)), Syntax::Ron) => {
            name.to_owned() + &sample(content, syntax)
        }
        (Some(content), _) => syntax.holding(name, &sample(content, syntax)),
    }
}
