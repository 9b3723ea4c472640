//! The simplest types that serde can read the format into: the baseline for reading.

use std::{fs, path::Path};

use serde::Deserialize;

/// Reads a file with `ron` or `serde_json`, without checks.
pub fn read(path: &Path) -> Scene {
    let text = fs::read_to_string(path).expect("a text");
    match path.extension() {
        Some(ending) if ending == "ron" => ron::from_str(&text).expect("a scene"),
        _ => serde_json::from_str(&text).expect("a scene"),
    }
}

/// A scene.
#[derive(Deserialize)]
pub struct Scene {
    pub camera: Camera,
    pub geometries: Vec<Geometry>,
}

/// A camera.
#[derive(Deserialize)]
pub enum Camera {
    Perspective {
        eye: [f64; 3],
        gaze: [f64; 3],
        fov: f64,
    },
    Orthographic {
        eye: [f64; 3],
        gaze: [f64; 3],
        scale: f64,
    },
}

/// A geometry.
#[derive(Deserialize)]
pub enum Geometry {
    Plane {
        point: [f64; 3],
        normal: [f64; 3],
        color: [f64; 3],
    },
    Sphere {
        center: [f64; 3],
        radius: f64,
        color: [f64; 3],
    },
}
