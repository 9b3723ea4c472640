//! The numbers of a camera as commands print them.

use std::fmt;

use serde::Serialize;
use strahl::{Camera, Vec3};

/// The parameters of a camera, and the values computed from them.
#[derive(Serialize)]
pub(super) struct CameraTerms {
    kind: &'static str,
    eye: [f64; 3],
    gaze: [f64; 3],
    up: [f64; 3],
    u: [f64; 3],
    v: [f64; 3],
    w: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    half_angle_radians: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scale: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stretch: Option<bool>,
}

impl CameraTerms {
    pub(super) fn new(camera: &Camera) -> Self {
        let (kind, half_angle_radians, scale, stretch) = match camera {
            Camera::Perspective(camera) => ("Perspective", Some(camera.half_angle()), None, None),
            Camera::Orthographic(camera) => (
                "Orthographic",
                None,
                Some(camera.scale()),
                Some(camera.stretch()),
            ),
        };
        Self {
            kind,
            eye: camera.eye().into(),
            gaze: camera.gaze().into(),
            up: camera.up().into(),
            u: camera.u().into(),
            v: camera.v().into(),
            w: camera.w().into(),
            half_angle_radians,
            scale,
            stretch,
        }
    }
}

/// Writes the kind of the camera, then a line for each number.
impl fmt::Display for CameraTerms {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "{}", self.kind)?;
        writeln!(out, "  eye e        {}", vector(self.eye))?;
        writeln!(out, "  gaze g       {}", vector(self.gaze))?;
        writeln!(out, "  up t         {}", vector(self.up))?;
        if let Some(half_angle) = self.half_angle_radians {
            writeln!(out, "  half angle α {half_angle:?} radians")?;
        }
        if let (Some(scale), Some(stretch)) = (self.scale, self.stretch) {
            let spans = if stretch {
                "width and height"
            } else {
                "the height"
            };
            writeln!(out, "  scale s      {scale:?}, which spans {spans}")?;
        }
        writeln!(out, "  u            {}, (t × w)/|t × w|", vector(self.u))?;
        writeln!(out, "  v            {}, w × u", vector(self.v))?;
        writeln!(out, "  w            {}, -g/|g|", vector(self.w))
    }
}

/// Returns a vector with all digits of its numbers.
pub(super) fn vector(v: [f64; 3]) -> String {
    let v = Vec3::from(v);
    format!("({:?}, {:?}, {:?})", v.x, v.y, v.z)
}
