//! The scenes of the benches as files: for Strahl and for other programs.
//!
//! Every text file contains the same digits: the shortest that round-trip.

#![allow(
    dead_code,
    unreachable_pub,
    clippy::allow_attributes,
    reason = "each bench uses a part"
)]

use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use strahl::Camera;

use crate::common::{
    Ball, Density, EYE, FOV, HEIGHT, LIGHT, PLANES, SCALE, WIDTH, balls, orthographic, perspective,
};

/// A camera of the benches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    Perspective,
    Orthographic,
    /// The perspective camera, with a light.
    Lit,
}

impl View {
    pub const ALL: [Self; 3] = [Self::Perspective, Self::Orthographic, Self::Lit];
    /// The views without light.
    pub const FLAT: [Self; 2] = [Self::Perspective, Self::Orthographic];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Perspective => "perspective",
            Self::Orthographic => "orthographic",
            Self::Lit => "lit",
        }
    }

    /// Returns a color for programs whose colors are bytes as shown, or light if there is a light.
    fn linear(self, color: [f64; 3]) -> [f64; 3] {
        let to_light = |c: f64| {
            if c <= 0.04045 {
                c / 12.92
            } else {
                libm::pow((c + 0.055) / 1.055, 2.4)
            }
        };
        match self {
            Self::Perspective | Self::Orthographic => color,
            Self::Lit => color.map(to_light),
        }
    }
}

/// A scene of the benches.
#[derive(Clone, Copy, Debug)]
pub struct Bench {
    pub count: usize,
    pub density: Density,
    pub view: View,
}

type Writer = BufWriter<fs::File>;

/// Writes a scene.
type WriteScene = fn(&Bench, &mut Writer) -> io::Result<()>;

/// The formats: the extension of each and the function that writes it.
pub const FORMATS: [(&str, WriteScene); 7] = [
    ("json", json),
    ("ron", ron),
    ("table.ron", table),
    ("npy", npy),
    ("pov", povray),
    ("dat", tachyon),
    ("h", header),
];

impl Bench {
    /// Returns the camera of the scene.
    pub fn camera(&self) -> Camera {
        match self.view {
            View::Perspective | View::Lit => perspective(),
            View::Orthographic => orthographic(),
        }
    }

    /// Writes the scene into a folder in one format.
    pub fn write(&self, folder: &Path, ending: &str) -> io::Result<PathBuf> {
        let write = FORMATS.iter().find(|(of, _)| *of == ending);
        let (_, write) = write.ok_or(io::ErrorKind::Unsupported)?;
        fs::create_dir_all(folder)?;
        let path = folder.join(self.file(ending));
        let mut out = BufWriter::with_capacity(1 << 20, fs::File::create(&path)?);
        write(self, &mut out)?;
        out.flush()?;
        Ok(path)
    }

    fn balls(&self) -> impl Iterator<Item = Ball> {
        balls(self.count, self.density)
    }

    /// Returns the file name; files of spheres alone do not depend on the camera.
    fn file(&self, ending: &str) -> String {
        let (count, density) = (self.count, self.density.name());
        match ending {
            "h" => "view.h".to_owned(),
            "npy" => format!("{count}-{density}.npy"),
            _ => format!("{count}-{density}-{}.{ending}", self.view.name()),
        }
    }
}

/// Joins numbers with a separator.
fn joined(numbers: impl IntoIterator<Item = f64>, between: &str) -> String {
    let texts: Vec<String> = numbers.into_iter().map(|it| it.to_string()).collect();
    texts.join(between)
}

fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    joined(numbers, ", ")
}

fn words(numbers: impl IntoIterator<Item = f64>) -> String {
    joined(numbers, " ")
}

fn json(bench: &Bench, out: &mut Writer) -> io::Result<()> {
    let eye = list(EYE.to_array());
    let camera = match bench.view {
        View::Perspective | View::Lit => {
            format!(r#""Perspective": {{"eye": [{eye}], "gaze": [0, 0, -1], "fov": {FOV}}}"#)
        }
        View::Orthographic => {
            format!(r#""Orthographic": {{"eye": [{eye}], "gaze": [0, 0, -1], "scale": {SCALE}}}"#)
        }
    };
    let lights = match bench.view {
        View::Perspective | View::Orthographic => String::new(),
        View::Lit => {
            let position = list(LIGHT.to_array());
            format!(
                r#""lights": [{{"Point": {{"position": [{position}], "falloff": "Constant"}}}}], "#
            )
        }
    };
    writeln!(
        out,
        r#"{{"image": {{"width": {WIDTH}, "height": {HEIGHT}}}, "camera": {{{camera}}}, {lights}"geometries": ["#
    )?;
    for (index, [point, normal, color]) in PLANES.into_iter().enumerate() {
        let comma = if index == 0 { "" } else { ",\n" };
        let (point, normal, color) = (list(point), list(normal), list(color));
        write!(
            out,
            r#"{comma}{{"Plane": {{"point": [{point}], "normal": [{normal}], "color": [{color}]}}}}"#
        )?;
    }
    for Ball {
        center,
        radius,
        color,
    } in bench.balls()
    {
        let (center, color) = (list(center), list(color));
        write!(
            out,
            ",\n{{\"Sphere\": {{\"center\": [{center}], \"radius\": {radius}, \"color\": [{color}]}}}}"
        )?;
    }
    writeln!(out, "\n]}}")
}

fn ron(bench: &Bench, out: &mut Writer) -> io::Result<()> {
    ron_head(bench, out)?;
    for Ball {
        center,
        radius,
        color,
    } in bench.balls()
    {
        let (center, color) = (list(center), list(color));
        writeln!(
            out,
            "Sphere(center: ({center}), radius: {radius}, color: ({color})),"
        )?;
    }
    writeln!(out, "])")
}

/// Writes the scene whose spheres are in the table next to it.
fn table(bench: &Bench, out: &mut Writer) -> io::Result<()> {
    ron_head(bench, out)?;
    writeln!(out, "Spheres(file: \"{}\"),\n])", bench.file("npy"))
}

fn ron_head(bench: &Bench, out: &mut Writer) -> io::Result<()> {
    let eye = list(EYE.to_array());
    let camera = match bench.view {
        View::Perspective | View::Lit => {
            format!("Perspective(eye: ({eye}), gaze: (0, 0, -1), fov: {FOV})")
        }
        View::Orthographic => {
            format!("Orthographic(eye: ({eye}), gaze: (0, 0, -1), scale: {SCALE})")
        }
    };
    let lights = match bench.view {
        View::Perspective | View::Orthographic => String::new(),
        View::Lit => {
            let position = list(LIGHT.to_array());
            format!("lights: [Point(position: ({position}), falloff: Constant)], ")
        }
    };
    writeln!(
        out,
        "(image: (width: {WIDTH}, height: {HEIGHT}), camera: {camera}, {lights}geometries: ["
    )?;
    for [point, normal, color] in PLANES {
        let (point, normal, color) = (list(point), list(normal), list(color));
        writeln!(
            out,
            "Plane(point: ({point}), normal: ({normal}), color: ({color})),"
        )?;
    }
    Ok(())
}

/// Writes NumPy's format, version 1.0: an array of f64 with a row for each sphere, x y z radius r g
/// b.
fn npy(bench: &Bench, out: &mut Writer) -> io::Result<()> {
    let shape = format!(
        "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, 7), }}",
        bench.count
    );
    // The header ends with a line feed at a multiple of 64 bytes.
    let length = (10 + shape.len() + 1).next_multiple_of(64) - 10;
    out.write_all(b"\x93NUMPY\x01\x00")?;
    out.write_all(&(length as u16).to_le_bytes())?;
    writeln!(out, "{shape:<width$}", width = length - 1)?;
    for Ball {
        center: [x, y, z],
        radius,
        color: [r, g, b],
    } in bench.balls()
    {
        for number in [x, y, z, radius, r, g, b] {
            out.write_all(&number.to_le_bytes())?;
        }
    }
    Ok(())
}

/// Writes the cameras and planes as C++ constants.
fn header(_: &Bench, out: &mut Writer) -> io::Result<()> {
    writeln!(out, "// Written by benches/peers/scenes.rs.\n#pragma once")?;
    writeln!(out, "constexpr int WIDTH = {WIDTH}, HEIGHT = {HEIGHT};")?;
    writeln!(
        out,
        "constexpr double EYE[3] = {{{}}};",
        list(EYE.to_array())
    )?;
    writeln!(out, "constexpr double FOV = {FOV}, SCALE = {SCALE};")?;
    let light = list(LIGHT.to_array());
    writeln!(out, "constexpr double LIGHT[3] = {{{light}}};")?;
    writeln!(out, "// Point, normal, color; the cameras look along -z.")?;
    let planes = PLANES.map(|plane| {
        format!(
            "{{{}}}",
            plane.map(|it| format!("{{{}}}", list(it))).join(", ")
        )
    });
    writeln!(
        out,
        "constexpr double PLANES[{}][3][3] = {{{}}};",
        planes.len(),
        planes.join(", ")
    )
}

/// Returns the height of the view at distance 1, or of the orthographic view.
fn view_height(view: View) -> f64 {
    match view {
        View::Perspective | View::Lit => {
            2.0 * libm::tan((FOV / 2.0) * (std::f64::consts::PI / 180.0))
        }
        // Strahl's spans from the center of the top row to that of the bottom row.
        View::Orthographic => SCALE * f64::from(HEIGHT) / f64::from(HEIGHT - 1),
    }
}

fn povray(bench: &Bench, out: &mut Writer) -> io::Result<()> {
    let (kind, height) = match bench.view {
        View::Perspective | View::Lit => ("perspective", view_height(bench.view)),
        View::Orthographic => ("orthographic", view_height(bench.view)),
    };
    let width = height * f64::from(WIDTH) / f64::from(HEIGHT);
    let eye = list(EYE.to_array());
    writeln!(out, "#version 3.7;\nglobal_settings {{ assumed_gamma 1 }}")?;
    if bench.view == View::Lit {
        writeln!(out, "#default {{ finish {{ ambient 0 diffuse 1 }} }}")?;
        let position = list(LIGHT.to_array());
        writeln!(out, "light_source {{ <{position}> rgb 1 }}")?;
    } else {
        // Flat colors: the pigment alone, without light.
        writeln!(out, "#default {{ finish {{ ambient 1 diffuse 0 }} }}")?;
    }
    writeln!(
        out,
        "camera {{ {kind} location <{eye}> direction <0, 0, -1> up <0, {height}, 0> right <{width}, 0, 0> }}"
    )?;
    for [point, normal, color] in PLANES {
        let distance: f64 = point.iter().zip(normal).map(|(p, n)| p * n).sum();
        let (normal, color) = (list(normal), list(bench.view.linear(color)));
        writeln!(
            out,
            "plane {{ <{normal}>, {distance} pigment {{ rgb <{color}> }} }}"
        )?;
    }
    for Ball {
        center,
        radius,
        color,
    } in bench.balls()
    {
        let (center, color) = (list(center), list(bench.view.linear(color)));
        writeln!(
            out,
            "sphere {{ <{center}>, {radius} pigment {{ rgb <{color}> }} }}"
        )?;
    }
    Ok(())
}

/// The world is left-handed: z is mirrored.
fn tachyon(bench: &Bench, out: &mut Writer) -> io::Result<()> {
    let kind = match bench.view {
        View::Perspective | View::Lit => "PERSPECTIVE",
        View::Orthographic => "ORTHOGRAPHIC",
    };
    // At zoom 1 the view is 1 high.
    let height = view_height(bench.view);
    let zoom = 1.0 / height;
    // The rays pass through the lower left corners of the pixels: the view moves by half a pixel.
    let half = height / f64::from(HEIGHT) / 2.0;
    let mirrored = |[x, y, z]: [f64; 3]| words([x, y, -z]);
    let (eye, frustum) = match bench.view {
        View::Perspective | View::Lit => {
            let (right, top) = (
                height / 2.0 * f64::from(WIDTH) / f64::from(HEIGHT),
                height / 2.0,
            );
            let sides = [-right - half, right - half, -top - half, top - half];
            (EYE.to_array(), format!("FRUSTUM {}", words(sides)))
        }
        View::Orthographic => ([EYE.x - half, EYE.y - half, EYE.z], String::new()),
    };
    let eye = mirrored(eye);
    writeln!(out, "BEGIN_SCENE\nRESOLUTION {WIDTH} {HEIGHT}")?;
    writeln!(
        out,
        "CAMERA PROJECTION {kind} ZOOM {zoom} ASPECTRATIO 1 ANTIALIASING 0 RAYDEPTH 1\n\
         CENTER {eye} VIEWDIR 0 0 1 UPDIR 0 1 0 {frustum} END_CAMERA"
    )?;
    let finish = if bench.view == View::Lit {
        let position = mirrored(LIGHT.to_array());
        writeln!(out, "LIGHT CENTER {position} RAD 0 COLOR 1 1 1")?;
        "AMBIENT 0 DIFFUSE 1"
    } else {
        "AMBIENT 1 DIFFUSE 0"
    };
    let texture = |color: [f64; 3]| {
        let color = words(bench.view.linear(color));
        format!("TEXTURE {finish} SPECULAR 0 OPACITY 1 COLOR {color} TEXFUNC 0")
    };
    for [point, normal, color] in PLANES {
        let (point, normal, texture) = (mirrored(point), mirrored(normal), texture(color));
        writeln!(out, "PLANE CENTER {point} NORMAL {normal} {texture}")?;
    }
    for Ball {
        center,
        radius,
        color,
    } in bench.balls()
    {
        let (center, texture) = (mirrored(center), texture(color));
        writeln!(out, "SPHERE CENTER {center} RAD {radius} {texture}")?;
    }
    writeln!(out, "END_SCENE")
}
