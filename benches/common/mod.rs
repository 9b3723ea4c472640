//! Scenes shared by all benches: seeded random spheres in a cube, and two planes.

#![allow(
    dead_code,
    unreachable_pub,
    clippy::allow_attributes,
    reason = "each bench uses a part"
)]

pub mod bare;

use strahl::{
    Camera, Color, Geometry, Lighting, OrthographicCamera, PerspectiveCamera, Plane, Sphere, Vec3,
    World,
    light::{Falloff, Point},
};

/// The picture of every bench.
pub const WIDTH: u32 = 1920;
/// The picture of every bench.
pub const HEIGHT: u32 = 1080;
/// The numbers of spheres in the scenes of the benches.
pub const COUNTS: [usize; 5] = [2, 1000, 100_000, 1_000_000, 10_000_000];
/// The position of both cameras; they look along -z.
pub const EYE: Vec3 = Vec3::new(0.0, 0.0, 4.0);
/// The full vertical angle of the perspective camera, in degrees.
pub const FOV: f64 = 40.0;
/// The scale of the orthographic camera.
pub const SCALE: f64 = 2.2;
/// The position of the light of lit scenes.
pub const LIGHT: Vec3 = Vec3::new(2.0, 4.0, 4.0);

/// The size of the spheres relative to their spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// The mean radius is a quarter of the spacing: many spheres are hidden.
    Dense,
    /// The disks of all spheres together have half the area of a face of the cube.
    Sparse,
}

impl Density {
    pub const ALL: [Self; 2] = [Self::Dense, Self::Sparse];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Dense => "dense",
            Self::Sparse => "sparse",
        }
    }

    /// Returns the mean radius of this many spheres in a cube of side 2.
    fn radius(self, count: usize) -> f64 {
        let count = count as f64;
        match self {
            Self::Dense => 0.5 / libm::cbrt(count),
            Self::Sparse => (0.5 * 4.0 / (std::f64::consts::PI * count)).sqrt(),
        }
    }
}

/// A sphere of a bench: center, radius, color.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    pub center: [f64; 3],
    pub radius: f64,
    pub color: [f64; 3],
}

/// Returns this many spheres in the cube from -1 to 1, with radii from half to three halves of the
/// mean radius. The same call returns the same spheres.
pub fn balls(count: usize, density: Density) -> impl Iterator<Item = Ball> {
    let mut random = Random(count as u64);
    let mean = density.radius(count);
    (0..count).map(move |_| {
        let mut triple = || [random.next(), random.next(), random.next()];
        let (center, color) = (triple().map(|x| x * 2.0 - 1.0), triple());
        let radius = mean * (0.5 + random.next());
        Ball {
            center,
            radius,
            color,
        }
    })
}

/// The two planes: a floor and a wall behind. Point, normal, color.
pub const PLANES: [[[f64; 3]; 3]; 2] = [
    [[0.0, -1.2, 0.0], [0.0, 1.0, 0.0], [0.3, 0.6, 0.3]],
    [[0.0, 0.0, -2.0], [0.0, 0.0, 1.0], [0.6, 0.7, 0.8]],
];

/// Returns the two planes and this many spheres.
pub fn world(count: usize, density: Density) -> World {
    let color = |[r, g, b]: [f64; 3]| Color::new(r, g, b);
    let planes = PLANES.map(|[point, normal, of]| {
        let plane = Plane::new(point.into(), normal.into()).expect("a plane");
        Geometry::new(plane, color(of))
    });
    let spheres = balls(count, density).map(|ball| {
        let sphere = Sphere::new(ball.center.into(), ball.radius).expect("a sphere");
        Geometry::new(sphere, color(ball.color))
    });
    let mut geometries = Vec::with_capacity(count + planes.len());
    geometries.extend(planes);
    geometries.extend(spheres);
    World::new(geometries, Color::BLACK)
}

/// Returns the light of lit scenes: a point that shines equally far.
pub fn lighting(shadows: bool) -> Lighting {
    let point = Point::new(LIGHT, Color::WHITE, 1.0, Falloff::Constant, shadows);
    Lighting::new(vec![point.expect("a light").into()])
}

/// Returns the perspective camera of the benches.
pub fn perspective() -> Camera {
    let half_angle = (FOV / 2.0) * (std::f64::consts::PI / 180.0);
    let camera = PerspectiveCamera::new(EYE, Vec3::NEG_Z, Vec3::Y, half_angle);
    camera.expect("a camera").into()
}

/// Returns the orthographic camera of the benches.
pub fn orthographic() -> Camera {
    let camera = OrthographicCamera::with_square_pixels(EYE, Vec3::NEG_Z, Vec3::Y, SCALE);
    camera.expect("a camera").into()
}

/// Runs two functions alternately, this many times each, and returns the median of each.
pub fn take_turns<A, B>(
    runs: usize,
    one: impl FnMut() -> A,
    other: impl FnMut() -> B,
) -> (f64, f64) {
    medians(runs, timed(one, seconds), timed(other, seconds))
}

/// Like [`take_turns`], but in CPU time of this thread if the system reports it: a busy machine
/// does not affect it, and it excludes the work of other threads.
pub fn take_turns_on_core<A, B>(
    runs: usize,
    one: impl FnMut() -> A,
    other: impl FnMut() -> B,
) -> (f64, f64) {
    medians(
        runs,
        timed(one, seconds_on_core),
        timed(other, seconds_on_core),
    )
}

fn timed<A, F: FnMut() -> A>(mut work: F, clock: fn(&mut F) -> f64) -> impl FnMut() -> f64 {
    move || clock(&mut work)
}

fn medians(
    runs: usize,
    mut one: impl FnMut() -> f64,
    mut other: impl FnMut() -> f64,
) -> (f64, f64) {
    let (ones, others) = (0..runs).map(|_| (one(), other())).unzip();
    (median(ones), median(others))
}

fn seconds_on_core<A>(work: &mut impl FnMut() -> A) -> f64 {
    let before = now_on_core();
    let made = std::hint::black_box(work());
    let seconds = now_on_core() - before;
    // Freeing the memory is not part of the work.
    drop(made);
    seconds
}

/// Returns the CPU time of this thread in seconds; on platforms other than Unix, wall-clock time.
pub fn now_on_core() -> f64 {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
    }
    #[cfg(not(unix))]
    {
        static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
        let start = START.get_or_init(std::time::Instant::now);
        start.elapsed().as_secs_f64()
    }
}

/// Returns the median time of this many runs.
pub fn time<A>(runs: usize, mut work: impl FnMut() -> A) -> f64 {
    median((0..runs).map(|_| seconds(&mut work)).collect())
}

/// Returns the time of one run.
pub fn seconds<A>(work: &mut impl FnMut() -> A) -> f64 {
    let start = std::time::Instant::now();
    std::hint::black_box(work());
    start.elapsed().as_secs_f64()
}

/// Returns the median of times.
pub fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// The splitmix64 generator (S. Vigna).
struct Random(u64);

impl Random {
    /// Returns a number of 53 bits in 0..1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
