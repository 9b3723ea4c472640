//! Values between keys, compared with numbers from other formulas.

use std::collections::HashMap;

use glam::DVec3;

use super::curve::{color, direction, number, point, scale};
use crate::{
    scene::{
        format::{
            animation::{
                Interpolation::{self, Linear, Smooth, Step},
                Key,
            },
            camera::CameraModel,
            color::ColorModel,
            field::{Field, FieldKind},
            fit::ProjectionModel,
            geometry::GeometryModel,
            light::LightModel,
            material::MaterialModel,
            numbers::{
                ScaleModel::{Axes, Uniform},
                Triple,
            },
            scene::Model,
        },
        schema::schema,
    },
    tracer::random::{Rng, cases},
};

fn keys<T: Clone>(keys: &[(f64, T, Interpolation)]) -> Vec<Key<T>> {
    let keys = keys.iter().cloned();
    let keys = keys.map(|(time, value, step)| Key {
        time,
        value,
        step: Some(step),
    });
    keys.collect()
}

#[track_caller]
fn near(found: Option<f64>, expected: f64) {
    let found = found.unwrap();
    assert!((found - expected).abs() < 1e-12, "{found} and {expected}");
}

#[test]
fn a_value_is_constant_before_the_first_key_and_after_the_last() {
    let keys = keys(&[(1.0, 5.0, Step), (2.0, 7.0, Linear)]);
    for (time, expected) in [(0.0, 5.0), (1.0, 5.0), (1.25, 5.5), (2.0, 7.0), (9.0, 7.0)] {
        assert_eq!(number(&keys, time), Some(expected));
    }
    assert_eq!(number(&[], 1.0), None);
}

#[test]
fn a_step_holds_until_its_time() {
    let keys = keys(&[(0.0, 5.0, Linear), (2.0, 7.0, Step), (3.0, 8.0, Linear)]);
    for (time, expected) in [(1.999, 5.0), (2.0, 7.0), (2.5, 7.5)] {
        assert_eq!(number(&keys, time), Some(expected));
    }
}

#[test]
fn linear_is_the_default() {
    let key = |time, value| Key {
        time,
        value,
        step: None,
    };
    let keys = [key(0.0, [0.0, 0.0, 8.0]), key(4.0, [4.0, -8.0, 8.0])];
    assert_eq!(point(&keys, 1.0), Some([1.0, -2.0, 8.0]));
}

// The slopes are those of scipy's PchipInterpolator, but 0 at both ends: at 1 they are 9/(5/1 +
// 4/0.5) = 9/13, at 3 the value has reached its maximum. Between keys the Hermite bases weight
// values and slopes.
#[test]
fn smooth_is_the_monotone_cubic() {
    let keys = keys(&[
        (0.0, 0.0, Smooth),
        (1.0, 1.0, Smooth),
        (3.0, 2.0, Smooth),
        (4.0, 2.0, Smooth),
        (6.0, 1.0, Smooth),
    ]);
    let hermite = |s: f64, h: f64, [from, to]: [f64; 2], [start, end]: [f64; 2]| {
        let (s2, s3) = (s * s, s * s * s);
        from * (2.0 * s3 - 3.0 * s2 + 1.0)
            + to * (3.0 * s2 - 2.0 * s3)
            + h * (start * (s3 - 2.0 * s2 + s) + end * (s3 - s2))
    };
    for s in [0.125, 0.3, 0.5, 0.9] {
        let slope = 9.0 / 13.0;
        near(number(&keys, s), hermite(s, 1.0, [0.0, 1.0], [0.0, slope]));
        near(
            number(&keys, 1.0 + 2.0 * s),
            hermite(s, 2.0, [1.0, 2.0], [slope, 0.0]),
        );
        assert_eq!(number(&keys, 3.0 + s), Some(2.0));
        near(
            number(&keys, 4.0 + 2.0 * s),
            hermite(s, 2.0, [2.0, 1.0], [0.0, 0.0]),
        );
    }
    near(number(&keys, 2.0), 1.5 + 0.25 * 9.0 / 13.0);
}

#[test]
fn a_step_next_to_a_curve_has_zero_slope() {
    let keys = keys(&[(0.0, 0.0, Step), (1.0, 1.0, Step), (2.0, 2.0, Smooth)]);
    near(number(&keys, 1.25), 1.0 + 0.15625);
}

/// Creates a track of random keys, rarely evenly spaced.
fn track(rng: &mut Rng) -> Vec<Key<f64>> {
    let mut time = 0.0;
    let count = 1 + rng.below(7);
    let mut keys = Vec::new();
    for _ in 0..count {
        let value = rng.signed();
        keys.push(Key {
            time,
            value: rng.one(&[0.0, 1.0, value, 1e300 * value]),
            step: Some(rng.one(&[Step, Linear, Smooth, Smooth])),
        });
        time += rng.magnitude(-6.0, 3.0);
    }
    keys
}

#[test]
fn nothing_overshoots_and_keys_are_exact() {
    let mut rng = Rng(0x51_7cc1);
    for _ in 0..cases(2_000) {
        let keys = track(&mut rng);
        for pair in keys.windows(2) {
            let [from, to] = pair else { continue };
            assert_eq!(number(&keys, from.time), Some(from.value));
            assert_eq!(number(&keys, to.time), Some(to.value));
            let sign = (to.value - from.value).signum();
            let mut last = from.value;
            for part in 1..32 {
                let time = from.time + (to.time - from.time) * f64::from(part) / 32.0;
                let value = number(&keys, time).unwrap();
                // Rounding may reverse the last bits of a curve.
                let slack = 1e-14 * (from.value.abs() + to.value.abs());
                assert!((value - last) * sign >= -slack, "{keys:?} at {time}");
                assert!(value >= from.value.min(to.value) && value <= from.value.max(to.value));
                last = value;
            }
        }
    }
}

#[test]
fn a_scale_is_one_number_between_two_and_three_otherwise() {
    let keys = keys(&[
        (0.0, Uniform(1.0), Linear),
        (1.0, Uniform(2.0), Linear),
        (2.0, Axes([4.0, 2.0, -2.0]), Linear),
        (3.0, Axes([4.0, 4.0, 2.0]), Smooth),
    ]);
    assert_eq!(scale(&keys, 0.5), Some(Uniform(1.5)));
    assert_eq!(scale(&keys, 1.0), Some(Uniform(2.0)));
    assert_eq!(scale(&keys, 1.5), Some(Axes([3.0, 2.0, 0.0])));
    assert_eq!(scale(&keys, 9.0), Some(Axes([4.0, 4.0, 2.0])));
}

#[test]
fn directions_turn_at_constant_speed() {
    let turns = keys(&[
        (0.0, [0.0, 0.0, -2.0], Linear),
        (3.0, [0.5, 0.0, 0.0], Linear),
    ]);
    for third in 0..3 {
        let angle = f64::from(third) * std::f64::consts::FRAC_PI_6;
        let found = DVec3::from(direction(&turns, f64::from(third)).unwrap());
        let expected = DVec3::new(libm::sin(angle), 0.0, -libm::cos(angle));
        let length = if third == 0 { 2.0 } else { 1.0 };
        assert!((found - expected * length).length() < 1e-15, "{found}");
    }
    assert_eq!(direction(&turns, 3.0), Some([0.5, 0.0, 0.0]));
}

#[test]
fn directions_of_any_angle_stay_unit_vectors_between_the_two() {
    let mut rng = Rng(99);
    for _ in 0..cases(2_000) {
        let from = rng.vector();
        let to = from + rng.vector() * rng.magnitude(-18.0, 1.0);
        let part = (rng.signed() + 1.0) / 2.0;
        for step in [Linear, Smooth] {
            let keys = keys(&[(0.0, Triple::from(from), Linear), (1.0, to.into(), step)]);
            let found = DVec3::from(direction(&keys, part).unwrap());
            if found == from {
                continue;
            }
            assert!((found.length() - 1.0).abs() < 1e-15, "{found}");
            if step == Linear {
                // Both angles, by a different formula than the turn uses.
                let angle = |a: DVec3, b: DVec3| libm::atan2(a.cross(b).length(), a.dot(b));
                let (gone, whole) = (angle(from, found), angle(from, to));
                assert!((gone - part * whole).abs() < 1e-15 * 20.0, "{from} to {to}");
            }
        }
    }
}

#[test]
fn an_unchanged_direction_keeps_its_bits() {
    let keys = keys(&[
        (0.0, [0.0, 3.0, 4.0], Smooth),
        (1.0, [0.0, 3.0, 4.0], Smooth),
    ]);
    assert_eq!(direction(&keys, 0.3), Some([0.0, 3.0, 4.0]));
}

#[test]
fn colors_blend_as_light() {
    let keys = keys(&[
        (0.0, ColorModel::Hex([0, 255, 51]), Linear),
        (1.0, ColorModel::Channels([1.0, 0.0, 0.2]), Linear),
        (2.0, ColorModel::Channels([1.0, 0.0, 0.2]), Linear),
        (3.0, ColorModel::Hex([1; 3]), Step),
    ]);
    assert_eq!(color(&keys, 0.0), Some(ColorModel::Hex([0, 255, 51])));
    let Some(ColorModel::Channels([r, g, b])) = color(&keys, 0.5) else {
        panic!("a color between two others is three numbers");
    };
    // Half of the light is 188 of 255.
    let half = 1.055 * libm::pow(0.5, 1.0 / 2.4) - 0.055;
    near(Some(r), half);
    near(Some(g), half);
    assert_eq!((half * 255.0).round(), 188.0);
    assert_eq!(b, 0.2, "what stays is not touched");
    for time in [1.0, 1.5, 2.5] {
        let kept = ColorModel::Channels([1.0, 0.0, 0.2]);
        assert_eq!(color(&keys, time), Some(kept));
    }
    assert_eq!(color(&keys, 3.0), Some(ColorModel::Hex([1; 3])));
}

#[test]
fn the_fields_are_those_of_the_format() {
    let schema: serde_json::Value = serde_json::from_str(&schema()).unwrap();
    let names = |body: &serde_json::Value| -> Vec<String> {
        body["properties"]
            .as_object()
            .unwrap()
            .keys()
            .cloned()
            .collect()
    };
    let sorted = |fields: &[Field]| {
        let mut fields: Vec<_> = fields.iter().map(|field| field.name.to_owned()).collect();
        fields.sort();
        fields
    };
    assert_eq!(sorted(Model::FIELDS), names(&schema));
    let cameras = CameraModel::VARIANTS.iter().map(|of| ("Camera", of));
    let geometries = GeometryModel::VARIANTS.iter().map(|of| ("Geometry", of));
    let lights = LightModel::VARIANTS.iter().map(|of| ("Light", of));
    // A name has no fields.
    let materials = MaterialModel::VARIANTS.iter();
    let materials = materials.filter(|variant| !variant.fields().is_empty());
    let materials = materials.map(|of| ("Material", of));
    let projections = ProjectionModel::VARIANTS.iter();
    let projections = projections.filter(|variant| !variant.fields().is_empty());
    let projections = projections.map(|of| ("Projection", of));
    let all = cameras.chain(geometries).chain(lights).chain(materials);
    let all = all.chain(projections);
    for (definition, variant) in all {
        let (name, fields) = (variant.name, variant.fields());
        let variants = schema["$defs"][definition]["oneOf"].as_array().unwrap();
        let mut bodies = variants.iter().map(|all| &all["properties"][name]);
        let body = bodies.find(|body| body.is_object()).unwrap();
        assert_eq!(sorted(fields), names(body), "{name}");
    }
}

// In the schema, the first and the last name of a path determine how the keys of a track are read.
#[test]
fn fields_of_one_name_are_of_one_kind() {
    fn check(field: &'static Field, known: &mut HashMap<&str, FieldKind>, depth: usize) {
        // Keys of points and directions are alike.
        let kind = match field.kind {
            FieldKind::Direction => FieldKind::Point,
            // One is that of a cone, the other that of a disc: both are numbers.
            FieldKind::LightAngle => FieldKind::Angle,
            kind if kind.changes() => kind,
            _ => FieldKind::Fixed,
        };
        let other = *known.entry(field.name).or_insert(kind);
        assert_eq!(other, kind, "{}", field.name);
        let inside = (field.of_type)().innermost().fields();
        let inside = inside.filter(|_| depth < 5);
        inside.for_each(|field| check(field, known, depth + 1));
    }
    for root in Model::FIELDS {
        check(root, &mut HashMap::new(), 0);
    }
}
