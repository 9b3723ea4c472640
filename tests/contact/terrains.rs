//! Terrains: pixels on the vertices and edges of a mesh of heights.
//!
//! On a vertex, a point has the shadow of one just before it on the arriving ray.

use strahl::{Ray, Vec3};

use crate::{
    form::Form,
    shadow::{Lamp, count},
    support::{Rng, Tally, cases},
};

/// The number of squares along each side.
const SIDE: u32 = 12;

/// Returns a mesh of heights, with steps of 0.1, and its corners.
fn terrain(rng: &mut Rng, is_smooth: bool) -> (Form, Vec<Vec3>) {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..=SIDE {
        for j in 0..=SIDE {
            let [x, z] = [i, j].map(|step| f64::from(step) * 0.1 - 0.6);
            vertices.push([x, 0.08 * rng.signed(), z]);
            if i < SIDE && j < SIDE {
                let (a, next) = ((SIDE + 1) * i + j, SIDE + 1);
                triangles.extend([[a, a + 1, a + next], [a + 1, a + 1 + next, a + next]]);
            }
        }
    }
    let mesh = Form::mesh(&vertices, &triangles);
    let corners = vertices.into_iter().map(Vec3::from_array).collect();
    (if is_smooth { mesh.smooth() } else { mesh }, corners)
}

/// Returns rays to corners, and to points between those beside each other.
fn rays(rng: &mut Rng, corners: &[Vec3], count: usize) -> Vec<Ray> {
    let next = SIDE as usize + 1;
    let eye = 2.0 * rng.direction();
    let eye = Vec3::new(eye.x, 0.4 + eye.y.abs(), eye.z);
    let see = |_| {
        let [i, j] = [(); 2].map(|()| 1 + rng.below(SIDE as usize - 1));
        let here = next * i + j;
        let other = rng.one(&[here + 1, here + next, here + next - 1]);
        let part = rng.one(&[0.0, 0.0, 0.5, rng_part(here)]);
        let to = corners[here] + part * (corners[other] - corners[here]);
        match rng.below(3) {
            // From above, as an orthographic camera sees.
            0 => Ray::new(Vec3::new(to.x, 2.0, to.z), Vec3::NEG_Y),
            _ => Ray::new(eye, to - eye),
        }
    };
    (0..count).map(see).collect()
}

fn rng_part(number: usize) -> f64 {
    0.05 + 0.9 * (number as f64 * 0.618).fract()
}

#[test]
fn pixels_on_vertices_and_edges() {
    let mut tally = Tally::new("terrains");
    let mut rng = Rng(0x5eed_0021);
    let whole = cases(4574);
    while tally.rays() + 10 < whole {
        let is_smooth = rng.below(3) == 0;
        let (form, corners) = terrain(&mut rng, is_smooth);
        let height = rng.one(&[0.1, 0.3, 1.0]);
        let lamp = match rng.below(4) {
            0 => Lamp::At(corners[rng.below(corners.len())] + Vec3::Y * height),
            _ => Lamp::Sun(Vec3::new(rng.signed(), height, rng.signed())),
        };
        let rays = rays(&mut rng, &corners, 60);
        let before = tally.wrong();
        count(&mut tally, &[form], lamp, rays);
        tally.note(if is_smooth { "smooth" } else { "flat" }, before);
    }
    tally.at_most_of(4574, [0, 14]);
}
