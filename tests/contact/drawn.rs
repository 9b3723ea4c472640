//! Pictures of scenes in which surfaces meet have the bytes of the definition.

use strahl::{Camera, PerspectiveCamera, RayTracer, Vec3, World, render::Tone};

use crate::{
    columns, copies,
    form::Form,
    media::{CLEAR, Scene, Stuff},
    shadow::Lamp,
    stacks::ground,
    support::{Rng, lit_by, white},
    valleys::{GLOSSY, MIRROR, valleys, world},
    water::{ball, cup, pool},
};

const SIZE: (u32, u32) = (19, 41);

/// Returns the number of pixels that differ from the definition.
fn differing(world: &World, eye: Vec3) -> usize {
    let camera = PerspectiveCamera::new(eye, -eye, Vec3::Y, 0.3).unwrap();
    let camera = Camera::from(camera);
    let (width, height) = SIZE;
    let image = RayTracer::new(&camera, world, width, height)
        .unwrap()
        .draw();
    let all = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    let is_different = |(column, row): &(u32, u32)| {
        let y = f64::from(height - 1 - row);
        let ray = camera.ray_for(width, height, (*column).into(), y);
        let color = Tone::default().color(world.radiance(&ray));
        image.pixel(*column, *row) != Some(color.to_rgb8())
    };
    all.filter(is_different).count()
}

#[test]
fn pictures_have_the_bytes_of_the_definition() {
    let mut rng = Rng(0x5eed_00b1);
    let eye = Vec3::new(0.0, 2.0, 3.0);
    let mut wrong = Vec::new();
    let mut check = |name: &'static str, world: &World| {
        let count = differing(world, eye);
        if count > 0 {
            wrong.push((name, count));
        }
    };
    let matte = columns::scenes()
        .into_iter()
        .chain(copies::scenes(&mut rng));
    for (name, forms) in matte.collect::<Vec<_>>() {
        for lamp in [
            Lamp::Sun(Vec3::new(rng.signed(), 1.0, rng.signed())),
            Lamp::At(Vec3::new(0.0, 1.3, 0.1)),
        ] {
            check(name, &lit_by(&white(&forms), lamp.light()));
        }
    }
    let sun = Lamp::Sun(Vec3::new(0.5, 1.0, 0.2));
    for (name, forms) in valleys() {
        let items: Vec<_> = forms.into_iter().zip([MIRROR, GLOSSY]).collect();
        check(name, &world(&items, sun, 8));
    }
    let floor = (Form::Plane(Vec3::Y * -0.5, Vec3::Y), Stuff::Matte(0.8));
    let on_floor = Form::Cuboid(Vec3::new(-0.7, -0.5, -0.7), Vec3::new(0.6, 0.2, 0.5));
    let beside = Form::Cuboid(Vec3::new(-0.7, -0.5, 0.5), Vec3::new(0.6, 0.2, 0.9));
    let glass = [
        ("ball of water", ball()),
        ("cup", cup()),
        ("pool", pool(0.2)),
        (
            "boxes on a floor",
            vec![(on_floor, CLEAR), (beside, CLEAR), floor],
        ),
    ];
    for (name, mut items) in glass {
        items.push(ground());
        let scene = Scene {
            sun: Some(Vec3::new(0.2, 0.9, 0.6)),
            ..Scene::new(items)
        };
        check(name, &scene.world());
    }
    assert_eq!(wrong, []);
}
