//! Measures building a tree over spheres or the triangles of a mesh, and tracing single rays through it:
//! `cargo bench --bench bvh`.
//!
//! Strahl and Embree both run on one thread; Embree takes part if `EMBREE_RAYS` names the program
//! built from `benches/peers/embree_rays.cpp`:
//!
//! ```text
//! g++ -O3 -march=native -o /tmp/embree_rays benches/peers/embree_rays.cpp -lembree3
//! EMBREE_RAYS=/tmp/embree_rays cargo bench --bench bvh
//! ```
//!
//! Each figure is the median of alternating runs, in CPU seconds. Some rays of each set are
//! compared with the plain loop.

mod common;

use std::{
    env,
    error::Error,
    fs::File,
    hint::black_box,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
    process::Command,
    sync::Arc,
};

use common::{Density, HEIGHT, WIDTH, balls, now_on_core, perspective};
use strahl::{Bvh, Color, Geometry, Ray, Shape, Sphere, Vec3, World, shape::Mesh};

const COUNTS: [usize; 2] = [100_000, 1_000_000];
const RAYS: usize = 500_000;
const RUNS: usize = 7;
/// Number of rays of a set that are compared with the plain loop.
const CHECKED: usize = 20;

fn main() -> Result<(), Box<dyn Error>> {
    let runs = env::var("RUNS").ok().and_then(|runs| runs.parse().ok());
    let runs = runs.unwrap_or(RUNS);
    let peer = env::var_os("EMBREE_RAYS").map(PathBuf::from);
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("rays");
    println!(
        "{:<32} {:>12} {:>12} {:>7}",
        "one thread", "strahl", "embree", "ratio"
    );
    for count in COUNTS {
        let spheres = Density::ALL.map(|density| {
            let world = move || world(count, density);
            (
                format!("{count} {}", density.name()),
                Box::new(world) as Make,
            )
        });
        let of_mesh = move || mesh(count);
        let mesh = (format!("{count} triangles"), Box::new(of_mesh) as Make);
        for (name, make) in spheres.into_iter().chain([mesh]) {
            let sets = [random(), coherent()];
            let world = make();
            check(&Arc::new(make()), &world, &sets);
            if peer.is_some() {
                write(&file, &world, &sets)?;
            }
            let (mut ours, mut theirs) = (Vec::new(), Vec::new());
            for _ in 0..runs {
                // A mesh keeps its tree.
                ours.push(measure(&Arc::new(make()), &sets)?);
                if let Some(peer) = &peer {
                    theirs.push(measure_peer(peer, &file)?);
                }
            }
            let what = |what| format!("{name}, {what}");
            let (ours, theirs) = (medians(&ours), medians(&theirs));
            row(&what("build"), "ms", &ours, &theirs, 0);
            row(&what("random rays"), "M/s", &ours, &theirs, 1);
            row(&what("coherent rays"), "M/s", &ours, &theirs, 2);
        }
    }
    Ok(())
}

/// Returns only spheres: Embree has no infinite planes.
fn world(count: usize, density: Density) -> World {
    let spheres = balls(count, density).map(|ball| {
        let sphere = Sphere::new(ball.center.into(), ball.radius).expect("a sphere");
        Geometry::new(sphere, Color::WHITE)
    });
    World::new(spheres.collect(), Color::BLACK)
}

/// Makes a world that shares nothing with another.
type Make = Box<dyn Fn() -> World>;

/// Returns a mesh of about this many triangles: a bumpy torus that fills the cube of the spheres.
fn mesh(count: usize) -> World {
    let along = (count as f64 / 8.0).sqrt() as usize;
    let across = 4 * along;
    let [low, high] =
        balls(1000, Density::Dense).fold([Vec3::MAX, Vec3::MIN], |[low, high], ball| {
            let center = Vec3::from(ball.center);
            [low.min(center), high.max(center)]
        });
    let (middle, size) = ((low + high) * 0.5, (high - low) / 3.0);
    let turn = |at: usize, of: usize| libm::sincos(at as f64 / of as f64 * std::f64::consts::TAU);
    let vertex = |(i, j): (usize, usize)| {
        let ((sin, cos), (up, out)) = (turn(i, across), turn(j, along));
        let radius = 0.4 + 0.02 * turn(20 * i, across).0 * turn(5 * j, along).0;
        let out = 1.0 + radius * out;
        middle + size * Vec3::new(cos * out, sin * out, radius * up)
    };
    let places = || (0..across).flat_map(|i| (0..along).map(move |j| (i, j)));
    let number = |i: usize, j: usize| (i % across * along + j % along) as u32;
    let square = |(i, j): (usize, usize)| {
        let [a, b] = [number(i, j), number(i + 1, j)];
        let [c, d] = [number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let (vertices, triangles) = (places().map(vertex), places().flat_map(square));
    let mesh = Mesh::new(vertices.collect(), triangles.collect()).expect("a mesh");
    World::new(vec![Geometry::new(mesh, Color::WHITE)], Color::BLACK)
}

/// Returns rays between random points of the cube.
fn random() -> Vec<Ray> {
    // A seed that no spheres use.
    let points: Vec<Vec3> = balls(2 * RAYS + 1, Density::Dense)
        .map(|ball| ball.center.into())
        .collect();
    let direction = |to: Vec3| to / to.length();
    points
        .chunks_exact(2)
        .map(|pair| Ray::new(pair[0], direction(pair[1])))
        .collect()
}

/// Returns the rays of a camera, row by row.
fn coherent() -> Vec<Ray> {
    let camera = perspective();
    let pixels = u64::from(WIDTH) * u64::from(HEIGHT);
    let first = (pixels - RAYS as u64) / 2;
    (first..first + RAYS as u64)
        .map(|pixel| {
            let (x, y) = (pixel % u64::from(WIDTH), pixel / u64::from(WIDTH));
            camera.ray_for(WIDTH, HEIGHT, x as f64, y as f64)
        })
        .collect()
}

fn check(world: &Arc<World>, plain: &World, sets: &[Vec<Ray>]) {
    let bvh = Bvh::new(world.clone());
    for set in sets {
        for ray in set.iter().step_by(set.len() / CHECKED) {
            assert_eq!(bvh.nearest(ray, f64::INFINITY), plain.hit(ray), "{ray:?}");
        }
    }
}

/// Returns the seconds of the build, then those of each set of rays.
fn measure(world: &Arc<World>, sets: &[Vec<Ray>]) -> Result<Vec<f64>, Box<dyn Error>> {
    let start = now_on_core();
    let bvh = Bvh::with_threads(world.clone(), 1)?;
    let mut seconds = vec![now_on_core() - start];
    for set in sets {
        let start = now_on_core();
        for ray in set {
            black_box(bvh.nearest(ray, f64::INFINITY));
        }
        seconds.push(now_on_core() - start);
    }
    Ok(seconds)
}

fn measure_peer(peer: &Path, file: &Path) -> Result<Vec<f64>, Box<dyn Error>> {
    let output = Command::new(peer).arg(file).output()?;
    let text = String::from_utf8(output.stdout)?;
    let seconds = text
        .lines()
        .map(|line| line.split(' ').next().unwrap_or(line).parse());
    Ok(seconds.collect::<Result<_, _>>()?)
}

/// Writes spheres and rays in the format of the Embree program.
fn write(file: &Path, world: &World, sets: &[Vec<Ray>]) -> Result<(), Box<dyn Error>> {
    let mut to = BufWriter::new(File::create(file)?);
    let spheres = || {
        world
            .geometries()
            .iter()
            .filter_map(|geometry| match geometry.shape() {
                Shape::Sphere(sphere) => Some(sphere),
                _ => None,
            })
    };
    to.write_all(&(spheres().count() as u32).to_ne_bytes())?;
    for sphere in spheres() {
        numbers(&mut to, sphere.center())?;
        to.write_all(&(sphere.radius() as f32).to_ne_bytes())?;
    }
    let mesh = world
        .geometries()
        .iter()
        .find_map(|geometry| match geometry.shape() {
            Shape::Mesh(mesh) => Some(mesh),
            _ => None,
        });
    let vertices = mesh.map_or(&[] as &[Vec3], |mesh| mesh.vertices());
    let triangles = mesh.map_or(&[] as &[[u32; 3]], |mesh| mesh.triangles());
    to.write_all(&(vertices.len() as u32).to_ne_bytes())?;
    for vertex in vertices {
        numbers(&mut to, *vertex)?;
    }
    to.write_all(&(triangles.len() as u32).to_ne_bytes())?;
    for corner in triangles.iter().flatten() {
        to.write_all(&corner.to_ne_bytes())?;
    }
    for set in sets {
        to.write_all(&(set.len() as u32).to_ne_bytes())?;
        for ray in set {
            numbers(&mut to, ray.origin())?;
            numbers(&mut to, ray.direction())?;
        }
    }
    to.flush()?;
    Ok(())
}

fn numbers(to: &mut impl Write, of: Vec3) -> std::io::Result<()> {
    let mut each = of.to_array().into_iter();
    each.try_for_each(|x| to.write_all(&(x as f32).to_ne_bytes()))
}

fn medians(runs: &[Vec<f64>]) -> Vec<f64> {
    let figures = runs.first().map_or(0, Vec::len);
    let median = |at| {
        let mut figures: Vec<f64> = runs.iter().map(|run| run[at]).collect();
        figures.sort_by(f64::total_cmp);
        figures[figures.len() / 2]
    };
    (0..figures).map(median).collect()
}

/// Prints a build in milliseconds and as a ratio of times, rays in millions per second and as a
/// ratio of rates.
fn row(what: &str, unit: &str, ours: &[f64], theirs: &[f64], at: usize) {
    let figure = |seconds: &f64| match unit {
        "ms" => seconds * 1e3,
        _ => RAYS as f64 / seconds / 1e6,
    };
    let text = |figure: f64| format!("{figure:.2} {unit}");
    let (our, their) = (figure(&ours[at]), theirs.get(at).map(figure));
    println!(
        "{what:<32} {:>12} {:>12} {:>7}",
        text(our),
        their.map_or_else(|| "-".into(), text),
        their.map_or_else(|| "-".into(), |their| format!("{:.2}", our / their)),
    );
}
