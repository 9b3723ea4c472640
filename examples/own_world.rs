//! Creates a world and a camera in code, without a scene file.
//!
//! Renders a ball half sunk into a floor, prints the hit of one pixel, and writes `own_world.png`
//! into the system's temporary folder, or to the path in the first argument:
//!
//! ```text
//! cargo run --example own_world -- own_world.png
//! ```

use std::{env, error::Error, path::PathBuf};

use strahl::{Camera, Color, Geometry, PerspectiveCamera, Plane, RayTracer, Sphere, Vec3, World};

const WIDTH: u32 = 320;
const HEIGHT: u32 = 240;

fn main() -> Result<(), Box<dyn Error>> {
    // The world: a night sky as background, then the geometries.
    let mut world = World::new(Vec::new(), Color::new(0.1, 0.1, 0.25));
    let floor = Plane::new(Vec3::ZERO, Vec3::Y)?;
    world.push(Geometry::new(floor, Color::new(0.1, 0.3, 0.4)));
    let ball = Sphere::new(Vec3::new(0.0, 0.0, -4.0), 1.0)?;
    world.push(Geometry::new(ball, Color::new(0.95, 0.5, 0.3)));

    // The camera. The constructor takes half of the vertical angle, in radians.
    let eye = Vec3::new(0.0, 1.0, 0.0);
    let half_angle = std::f64::consts::FRAC_PI_8;
    let camera: Camera = PerspectiveCamera::new(eye, Vec3::NEG_Z, Vec3::Y, half_angle)?.into();

    // One ray: y counts upwards from the lower edge.
    let ray = camera.ray_for(WIDTH, HEIGHT, 160.0, 60.0);
    if let Some((index, hit)) = world.hit(&ray) {
        println!("geometry {index} at t = {}, point {}", hit.t, hit.point);
    }

    // All rays.
    let image = RayTracer::new(&camera, &world, WIDTH, HEIGHT)?.draw();
    let default = || env::temp_dir().join("own_world.png");
    let path = env::args_os().nth(1).map_or_else(default, PathBuf::from);
    image.save(path)?;
    Ok(())
}
