//! Measures building a tree over spheres or the triangles of a mesh, and tracing single rays through it:
//! `cargo bench --bench bvh`, or for some of the rows `cargo bench --bench bvh -- '1000000 triangles'`.
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
//! compared with the plain loop. The rays of the whole picture are those of the camera in our fastest
//! way, which is not this tree alone, beside the fastest of Embree's: one ray at a time, or packets of
//! 4, 8 or 16 that are squares of pixels.

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
use strahl::{Bvh, Color, Geometry, Ray, RayTracer, Shape, Sphere, Vec3, World, shape::Mesh};

const COUNTS: [usize; 2] = [100_000, 1_000_000];
const RAYS: usize = 500_000;
const PIXELS: usize = WIDTH as usize * HEIGHT as usize;
const RUNS: usize = 7;
/// Number of rays of a set that are compared with the plain loop.
const CHECKED: usize = 20;

fn main() -> Result<(), Box<dyn Error>> {
    let runs = env::var("RUNS").ok().and_then(|runs| runs.parse().ok());
    let runs = runs.unwrap_or(RUNS);
    let wanted: Vec<String> = env::args().skip(1).filter(|it| it != "--bench").collect();
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
            if !wanted.is_empty() && !wanted.contains(&name) {
                continue;
            }
            let sets = [random(), coherent()];
            let world = make();
            check(&Arc::new(make()), &world, &sets);
            if peer.is_some() {
                let [random, coherent] = &sets;
                write(&file, &world, &[random, coherent, &picture()])?;
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
            row(&what("build"), 0, &ours, &theirs, 0);
            row(&what("random rays"), RAYS, &ours, &theirs, 1);
            row(&what("coherent rays"), RAYS, &ours, &theirs, 2);
            row(&what("picture"), PIXELS, &ours, &theirs, 3);
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

/// Returns the rays of the camera in blocks of 4 × 4 pixels: 4 after one another are a square, 8 are
/// two beside each other.
fn picture() -> Vec<Ray> {
    let camera = perspective();
    let blocks = (0..HEIGHT / 4).flat_map(|y| (0..WIDTH / 4).map(move |x| (4 * x, 4 * y)));
    let pixels = blocks.flat_map(|(x, y)| {
        (0..16).map(move |i| (x + (i >> 1 & 2) + (i & 1), y + (i >> 2 & 2) + (i >> 1 & 1)))
    });
    pixels
        .map(|(x, y)| camera.ray_for(WIDTH, HEIGHT, f64::from(x), f64::from(y)))
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

/// Returns the seconds of the build, of each set of rays, and of the picture.
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
    let camera = perspective();
    let tracer = RayTracer::new(&camera, world, WIDTH, HEIGHT)?;
    let trace = tracer.tracing(1)?;
    let start = now_on_core();
    trace()?;
    seconds.push(now_on_core() - start);
    Ok(seconds)
}

fn measure_peer(peer: &Path, file: &Path) -> Result<Vec<f64>, Box<dyn Error>> {
    let output = Command::new(peer).arg(file).output()?;
    let text = String::from_utf8(output.stdout)?;
    let mut seconds = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let figures = line.split(' ').take(4).map(str::parse);
        let figures: Vec<f64> = figures.collect::<Result<_, _>>()?;
        // The picture is the last set.
        let of = if number == 3 {
            &figures[..]
        } else {
            &figures[..1]
        };
        seconds.push(of.iter().copied().fold(f64::INFINITY, f64::min));
    }
    Ok(seconds)
}

/// Writes spheres and rays in the format of the Embree program.
fn write(file: &Path, world: &World, sets: &[&Vec<Ray>]) -> Result<(), Box<dyn Error>> {
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
        for ray in *set {
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
fn row(what: &str, rays: usize, ours: &[f64], theirs: &[f64], at: usize) {
    let figure = |seconds: &f64| match rays {
        0 => seconds * 1e3,
        _ => rays as f64 / seconds / 1e6,
    };
    let unit = if rays == 0 { "ms" } else { "M/s" };
    let text = |figure: f64| format!("{figure:.2} {unit}");
    let (our, their) = (figure(&ours[at]), theirs.get(at).map(figure));
    println!(
        "{what:<32} {:>12} {:>12} {:>7}",
        text(our),
        their.map_or_else(|| "-".into(), text),
        their.map_or_else(|| "-".into(), |their| format!("{:.2}", our / their)),
    );
}
