//! Generates a scene as values, writes and reads it with `ron` and `serde_json`, and renders it.
//!
//! ```text
//! cargo run --example generate -- spiral.png
//! ```

use std::{env, error::Error, path::PathBuf, sync::Arc};

use strahl::{
    Document, Scene, Syntax,
    scene::format::{
        CameraModel, ColorModel, PerspectiveModel, Rare, SceneModel,
        geometry::{GeometryModel, PlaneModel, SphereModel},
        light::{HeadlightLightModel, LightModel},
        material::{MaterialModel, PhongModel},
    },
};

/// Returns a material with a highlight.
fn shiny(color: ColorModel) -> MaterialModel {
    MaterialModel::Phong(PhongModel {
        diffuse: Some(color),
        texture: None,
        specular: None,
        exponent: Some(60.0),
        reflection: None,
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let camera = PerspectiveModel {
        eye: [0.0, 3.0, 8.0],
        gaze: None,
        look_at: Some([0.0, 0.5, 0.0]),
        up: None,
        fov: 45.0,
        aperture: None,
        focus: None,
        focus_at: None,
    };
    let floor = PlaneModel {
        point: [0.0, -1.0, 0.0],
        normal: [0.0, 1.0, 0.0],
        color: Some(ColorModel::Channels([0.2, 0.2, 0.25])),
        texture: None,
        material: None,
        transform: None,
        name: None,
    };
    let balls = (0..60_u8).map(|index| {
        let turn = f64::from(index) / 10.0;
        GeometryModel::Sphere(SphereModel {
            center: [
                3.0 * libm::cos(turn),
                turn / 3.0 - 1.0,
                3.0 * libm::sin(turn),
            ],
            radius: 0.25,
            color: None,
            material: Some(Arc::new(shiny(ColorModel::Hex([255, 4 * index, 40])))),
            rare: Rare::default(),
            name: None,
        })
    });
    let scene = SceneModel {
        version: Some(1),
        camera: Some(CameraModel::Perspective(camera)),
        background: Some(ColorModel::Hex([16, 16, 32])),
        lights: Some(vec![LightModel::Headlight(HeadlightLightModel::default())]),
        geometries: [GeometryModel::Plane(Box::new(floor))]
            .into_iter()
            .chain(balls)
            .collect(),
        ..SceneModel::default()
    };

    // The crates `ron` and `serde_json` write and read the types directly.
    let json = serde_json::to_string(&scene)?;
    assert_eq!(serde_json::from_str::<SceneModel>(&json)?, scene);
    let ron = ron::to_string(&scene)?;
    assert_eq!(ron::from_str::<SceneModel>(&ron)?, scene);

    // Written in the canonical format, it is a file like any other.
    let text = scene.to_text(Syntax::Ron);
    print!("{text}");
    let document = Document::from_text("spiral", text, Syntax::Ron);
    for fault in document.diagnostics() {
        eprintln!("{}: {}", fault.path, fault.message);
    }
    let default = || env::temp_dir().join("spiral.png");
    let path = env::args_os().nth(1).map_or_else(default, PathBuf::from);
    Scene::try_from(document)?.save(&path)?;
    eprintln!("{}", path.display());
    Ok(())
}
