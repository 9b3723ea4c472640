//! `nothing-visible` on random scenes: never reported if a pixel shows a geometry, and nearly
//! always if none does.

#[path = "../src/tracer/random.rs"]
mod random;

use std::f64::consts::PI;

use glam::DVec3;
use random::{Rng, cases};
use strahl::{Document, RenderOptions, Scene, Syntax, diagnostic::Code};

#[test]
fn a_scene_that_shows_a_geometry_is_never_warned_about() {
    let mut random = Rng(7);
    let (mut warned, mut blank, mut shown) = (0, 0, 0);
    for case in 0..cases(20_000) {
        let text = scene(&mut random);
        let document = Document::from_text("<text>", &text, Syntax::Ron);
        if document.has_errors() {
            continue;
        }
        let mut codes = document.diagnostics().iter().map(|fault| fault.code);
        let is_warned = codes.any(|code| code == Code::NothingVisible);
        let scene = Scene::try_from(document).unwrap();
        let options = RenderOptions::new().threads(1);
        let is_shown = !scene.seen(&options).unwrap().is_empty();
        assert!(!(is_warned && is_shown), "case {case}:\n{text}");
        warned += u32::from(is_warned);
        blank += u32::from(!is_shown);
        shown += u32::from(is_shown);
    }
    let counts = format!("{shown} show something, {warned} of {blank} others have the warning");
    assert!(shown * 5 > blank && blank * 5 > shown, "{counts}");
    assert!(warned * 5 > blank, "{counts}");
}

/// A small picture of a geometry that is usually at the edge of the view, inside or outside by as
/// much as its radius or as little as the last bits; the numbers are of all magnitudes.
fn scene(random: &mut Rng) -> String {
    let unit = match random.below(4) {
        0 => random.magnitude(-160.0, 160.0),
        1 => random.magnitude(-6.0, 6.0),
        _ => 1.0,
    };
    let (width, height) = (1 + random.below(9), 1 + random.below(9));
    let ratio = width as f64 / height as f64;
    let eye = unit * random.vector() * random.one(&[0.0, 1.0, 1e3, 1e9]);
    let gaze = unit_vector(random.vector());
    let right = unit_vector(gaze.cross(DVec3::Y));
    let up = right.cross(gaze);
    // Half the height of the view at a distance.
    let is_perspective = random.below(2) == 0;
    let fov = random.one(&[
        90.0,
        60.0,
        10.0,
        1e-3,
        1e-9,
        1e-13,
        170.0,
        179.99999,
        179.9999999999,
    ]);
    let half = if is_perspective {
        libm::tan(fov / 360.0 * PI)
    } else {
        fov
    };
    let distance = unit * random.magnitude(-3.0, 9.0) * random.one(&[1.0, 1.0, 1.0, -1.0]);
    let reach = if is_perspective {
        half * distance.abs()
    } else {
        half * unit
    };
    let radius = distance.abs().min(reach * 4.0) * random.magnitude(-12.0, 0.5);
    let near = |random: &mut Rng| 1.0 + random.signed() * random.magnitude(-16.0, 0.5);
    let edge = random.one(&[-1.0, 0.0, 1.0]) * reach * ratio;
    let across = edge * near(random) + edge.signum() * radius * near(random);
    let along = random.one(&[-1.0, 0.0, 0.0, 1.0]) * (reach + radius * near(random));
    let center = eye + distance * gaze + across * right + along * up;
    let camera = if is_perspective {
        format!(
            "Perspective(eye: {}, gaze: {}, fov: {fov:?})",
            triple(eye),
            triple(gaze)
        )
    } else {
        let scale = 2.0 * half * unit;
        format!(
            "Orthographic(eye: {}, gaze: {}, scale: {scale:e})",
            triple(eye),
            triple(gaze)
        )
    };
    let geometry = if random.below(6) == 0 {
        let normal = triple({
            let other = random.vector();
            random.one(&[gaze, up, right, other])
        });
        format!(
            "Plane(point: {}, normal: {normal}, color: \"#f00\")",
            triple(center)
        )
    } else {
        format!(
            "Sphere(center: {}, radius: {radius:e}, color: \"#f00\")",
            triple(center)
        )
    };
    format!(
        "(\n    image: (width: {width}, height: {height}),\n    camera: {camera},\n    \
         geometries: [{geometry}],\n)"
    )
}

fn unit_vector(vector: DVec3) -> DVec3 {
    vector / vector.length()
}

fn triple(vector: DVec3) -> String {
    format!("({:e}, {:e}, {:e})", vector.x, vector.y, vector.z)
}
