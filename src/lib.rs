//! Strahl renders scenes that are data, exactly.
//!
//! A scene is a RON or JSON file with a camera, a background and geometries. [`Scene`] reads
//! it, rejects it if it has errors, and renders it to a picture that has the same bytes on every
//! machine.
//!
//! ```
//! use strahl::{Scene, Syntax};
//!
//! let scene = Scene::from_text(
//!     r##"(
//!         image: (width: 64, height: 48),
//!         camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
//!         geometries: [Sphere(center: (0, 0, -3), radius: 0.5, color: "#ff0000")],
//!     )"##,
//!     Syntax::Ron,
//! )?;
//! let image = scene.render()?;
//! assert_eq!(image.pixel(32, 24), Some([255, 0, 0]));
//! # let folder = std::env::temp_dir().join(format!("strahl-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder).ok();
//! # let path = folder.join("red.png");
//! # let path = path.as_path();
//! # if false {
//! let path = "red.png";
//! # }
//! image.save(path)?;
//! # std::fs::remove_dir_all(&folder).ok();
//! # Ok::<(), strahl::Error>(())
//! ```
//!
//! The parts can be used on their own: [`Ray`], [`Camera`], [`Geometry`] and [`World`] follow the
//! textbook's formulas, and [`RayTracer`] renders what a camera sees of a world.
//!
//! More specialized items are in modules by topic: [`film`] and [`render`] for parts and layers of
//! a picture, [`image_file`] for formats and movies, [`scene`] and [`text`] for scene files as
//! text, [`diagnostic`] and [`report`] for errors in them, [`compare`] for comparing two pictures,
//! and [`jobs`] and [`parallel`] for many pictures.

#![deny(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::panic,
        clippy::print_stderr,
        clippy::print_stdout,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

#[forbid(unsafe_code)]
mod accel;
#[forbid(unsafe_code)]
pub mod compare;
#[forbid(unsafe_code)]
mod data;
#[forbid(unsafe_code)]
pub mod diagnostic;
#[forbid(unsafe_code)]
pub mod film;
#[forbid(unsafe_code)]
pub mod image_file;
#[forbid(unsafe_code)]
mod integrator;
#[forbid(unsafe_code)]
pub mod jobs;
#[forbid(unsafe_code)]
pub mod parallel;
#[forbid(unsafe_code)]
mod pipeline;
#[forbid(unsafe_code)]
pub mod render;
#[forbid(unsafe_code)]
pub mod report;
#[forbid(unsafe_code)]
pub mod scene;
#[forbid(unsafe_code)]
pub mod session;
mod simd;
#[forbid(unsafe_code)]
pub mod text;
#[forbid(unsafe_code)]
mod tracer;

pub use glam::DVec3 as Vec3;

#[doc(inline)]
pub use crate::{
    accel::bvh::Bvh,
    diagnostic::{
        Diagnostic,
        error::{Error, ErrorKind},
    },
    film::{Image, size::Size},
    image_file::ImageFormat,
    pipeline::{Scene, animation::Animation, options::RenderOptions},
    render::ray_tracer::RayTracer,
    scene::{document::Document, options::ReadOptions},
    text::syntax::Syntax,
    tracer::{
        camera::{Camera, orthographic::OrthographicCamera, perspective::PerspectiveCamera},
        color::Color,
        error::GeometryError,
        geometry::Geometry,
        hit::Hit,
        light, material,
        radiance::Radiance,
        ray::Ray,
        shape::{
            self, Shape,
            plane::Plane,
            sphere::{Quadratic, Sphere},
        },
        world::{Lighting, World},
    },
};

/// The examples of the README compile.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
