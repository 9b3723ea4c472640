//! Away from contact, nothing changes: not one bit of the light of pixels from near and far.

use strahl::{PerspectiveCamera, Ray, Vec3, World};

use crate::{
    form::Form,
    media::{CLEAR, Scene, Stuff, WATER},
    shadow::{Lamp, count},
    support::{Rng, Tally, cases, lit_by, white},
};

/// Returns forms that do not touch each other: in cells of a grid.
fn scene(rng: &mut Rng) -> Vec<Form> {
    let mut forms = Vec::new();
    for number in 0..27_u8 {
        let cell = Vec3::from([number % 3, number / 3 % 3, number / 9].map(f64::from));
        let middle = 0.6 * (cell - 1.0) + 0.05 * rng.vector();
        let size = rng.between(0.08, 0.22);
        let axis = size * rng.direction();
        forms.push(match rng.below(5) {
            0 | 1 => Form::Ball(middle, size),
            2 => Form::Cuboid(middle - 0.6 * size, middle + 0.6 * size),
            3 => Form::Cylinder(middle - 0.7 * axis, middle + 0.7 * axis, 0.6 * size),
            _ => Form::Capsule(middle - 0.5 * axis, middle + 0.5 * axis, 0.5 * size),
        });
    }
    forms
}

/// Returns a checksum (Fowler, Noll and Vo's FNV-1a) of the light of a picture.
fn checksum(world: &World, distance: f64) -> u64 {
    let (width, height) = (200, 120);
    let eye = distance * Vec3::new(0.36, 0.48, 0.8);
    let half_angle = libm::atan(1.0 / distance);
    let camera = PerspectiveCamera::new(eye, -eye, Vec3::Y, half_angle).unwrap();
    let mut sum = 0xcbf2_9ce4_8422_2325_u64;
    for y in 0..height {
        for x in 0..width {
            let ray = camera.ray_for(width, height, x.into(), y.into());
            for byte in world.radiance(&ray).r().to_bits().to_le_bytes() {
                sum = (sum ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
            }
        }
    }
    sum
}

/// The checksums are those of the rule that a ray leaves only the face that was hit.
#[test]
fn pixels_away_from_contact_keep_every_bit() {
    let mut rng = Rng(0x5eed_00a1);
    let forms = scene(&mut rng);
    let world = lit_by(&white(&forms), Lamp::Sun(Vec3::new(0.3, 1.0, 0.5)).light());
    let found = [30.0, 1e3, 1e5, 1e6].map(|radii| checksum(&world, radii));
    let expected = [
        0xc745_3221_b5a4_779c,
        0x7155_c20e_8083_7629,
        0x1693_6277_b5bb_0be9,
        0x5e22_3c4e_9a84_3f2e,
    ];
    assert_eq!(found, expected, "{found:#x?}");
}

/// Returns rays through the scene.
fn rays(rng: &mut Rng, count: usize) -> Vec<Ray> {
    let ray = |_| {
        let o = 5.0 * rng.direction();
        Ray::new(o, rng.vector() - o)
    };
    (0..count).map(ray).collect()
}

/// The evaluations of these tests are right where nothing touches, whatever the rule of contact.
#[test]
fn the_evaluations_agree_with_the_library() {
    let mut shadows = Tally::new("shadows away from contact");
    let mut glass = Tally::new("glass away from contact");
    let mut rng = Rng(0x5eed_00a2);
    for _ in 0..cases(40) {
        let forms = scene(&mut rng);
        let l = rng.direction();
        let seen = rays(&mut rng, 60);
        count(&mut shadows, &forms, Lamp::Sun(l), seen);
        let stuff = |number: usize| match number % 3 {
            0 => CLEAR,
            1 => WATER,
            _ => Stuff::Matte(0.7),
        };
        let items = forms.into_iter().enumerate();
        let items = items.map(|(number, form)| (form, stuff(number)));
        let scene = Scene {
            sun: Some(l),
            max_depth: 3,
            ..Scene::new(items.collect())
        };
        let seen = rays(&mut rng, 20);
        scene.count(&mut glass, &seen, &scene, 1e-6);
    }
    shadows.none();
    glass.none();
}
