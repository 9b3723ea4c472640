//! Strahl renders scenes that are data, exactly.
//!
//! A scene is a RON or JSON file: a camera, a background, planes and spheres. [`Scene`] reads
//! it, refuses what is wrong with it, and turns it into a picture that has the same bytes on
//! every machine.
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
//! The parts of it can be used on their own: [`Ray`], [`Camera`], [`Geometry`] and [`World`]
//! are the textbook's formulas, and [`RayTracer`] draws what a camera sees of a world.

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
mod batch;
#[forbid(unsafe_code)]
mod colors;
#[forbid(unsafe_code)]
mod compare;
#[forbid(unsafe_code)]
mod config;
#[forbid(unsafe_code)]
mod diagnostic;
#[forbid(unsafe_code)]
mod error;
#[forbid(unsafe_code)]
mod explain;
#[forbid(unsafe_code)]
mod film;
#[forbid(unsafe_code)]
mod fingerprint;
#[forbid(unsafe_code)]
mod image_file;
#[forbid(unsafe_code)]
mod layers;
#[forbid(unsafe_code)]
mod levels;
#[forbid(unsafe_code)]
mod literal;
#[forbid(unsafe_code)]
mod movie;
#[forbid(unsafe_code)]
mod output;
#[forbid(unsafe_code)]
mod parallel;
#[forbid(unsafe_code)]
mod pipeline;
#[forbid(unsafe_code)]
mod plain;
#[forbid(unsafe_code)]
#[cfg(test)]
mod random;
#[forbid(unsafe_code)]
mod render;
#[forbid(unsafe_code)]
pub mod report;
#[forbid(unsafe_code)]
mod scene;
#[forbid(unsafe_code)]
mod seen;
#[forbid(unsafe_code)]
mod shard;
mod simd;
#[forbid(unsafe_code)]
mod srgb;
#[forbid(unsafe_code)]
mod stamp;
#[forbid(unsafe_code)]
mod target;
#[forbid(unsafe_code)]
mod text;
#[forbid(unsafe_code)]
mod timings;
#[forbid(unsafe_code)]
mod tracer;

pub use glam::DVec3 as Vec3;

#[doc(hidden)]
pub use crate::{
    simd::Isa,
    tracer::shape::working::{Term, Working},
};

pub use crate::{
    accel::bvh::Bvh,
    batch::{
        Checked, check_files,
        search::{SceneFile, find_scenes, no_scene},
    },
    compare::{
        CompareOptions, Comparison, layers::LayerComparison, limit::PictureOptions,
        picture::Picture,
    },
    config::{Config, Configs},
    diagnostic::{Code, Diagnostic, Label, Severity, UnknownCode},
    error::{Error, ErrorKind},
    explain::describe,
    film::{
        Image,
        crop::Crop,
        samples::{Samples, SamplesError},
        size::{Size, SizeError},
    },
    image_file::{Compression, ImageFormat, Palette},
    layers::{Layer, UnknownLayer},
    levels::Levels,
    movie::{FrameSink, MovieFormat, Reel},
    parallel::{Cancel, check_memory, in_order},
    pipeline::{Scene, animation::Animation, options::RenderOptions},
    render::RayTracer,
    scene::{
        convert::{Converted, LostComments},
        document::Document,
        new::new_scene,
        options::ReadOptions,
        origin::{Origin, TableRows},
        schema::{SCHEMA_URL, schema},
        set::{FieldLookup, Setting, SettingError},
    },
    seen::Seen,
    shard::{Shard, ShardError},
    stamp::{Stamp, Stamped},
    target::write_file,
    text::{
        lines::{Lines, Position},
        syntax::Syntax,
        visible::visible as sanitize,
    },
    timings::{Stage, Timings},
    tracer::{
        camera::{Camera, orthographic::OrthographicCamera, perspective::PerspectiveCamera},
        color::Color,
        error::GeometryError,
        geometry::Geometry,
        hit::Hit,
        ray::Ray,
        shape::{
            Shape,
            plane::Plane,
            sphere::{Quadratic, Sphere},
        },
        world::World,
    },
};

/// The examples of the README compile.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
