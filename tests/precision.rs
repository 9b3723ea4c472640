//! Lit and shadowed points, beside an evaluation with twice as many digits: on spheres that lie on a
//! plane, at any scale and from far away, no point is dark or lit by a rounding error.

use std::ops::{Add, Div, Mul, Neg, Sub};

use strahl::{
    Color, Geometry, Lighting, PerspectiveCamera, Plane, Radiance, Ray, Sphere, Vec3, World,
    light::{Directional, Falloff, Light, Point},
};

/// A number of about 106 bits: the sum of two f64, the second less than half a unit in the last
/// place of the first (Dekker, 1971).
#[derive(Clone, Copy, Debug)]
struct Double(f64, f64);

impl Double {
    const fn of(x: f64) -> Self {
        Self(x, 0.0)
    }

    /// Returns a + b, exactly.
    fn sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        let part = sum - a;
        Self(sum, (a - (sum - part)) + (b - part))
    }

    /// Returns a·b, exactly.
    fn product(a: f64, b: f64) -> Self {
        let split = |x: f64| {
            let large = 134_217_729.0 * x;
            let high = large - (large - x);
            (high, x - high)
        };
        let (product, (a, c), (b, d)) = (a * b, split(a), split(b));
        Self(product, ((a * b - product) + a * d + c * b) + c * d)
    }

    fn sqrt(self) -> Self {
        if self.0 <= 0.0 {
            return Self::of(0.0);
        }
        let root = Self::of(self.0.sqrt());
        root + (self - root * root) / (root + root)
    }

    fn is_positive(self) -> bool {
        self.0 > 0.0
    }
}

impl Add for Double {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, low) = (Self::sum(self.0, other.0), Self::sum(self.1, other.1));
        let sum = Self::sum(high.0, high.1 + low.0);
        Self::sum(sum.0, sum.1 + low.1)
    }
}

impl Neg for Double {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Sub for Double {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.0, other.0);
        Self::sum(product.0, product.1 + (self.0 * other.1 + self.1 * other.0))
    }
}

impl Div for Double {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = Self::of(self.0 / other.0);
        let rest = self - other * first;
        let second = Self::of(rest.0 / other.0);
        let rest = rest - other * second;
        first + second + Self::of(rest.0 / other.0)
    }
}

/// A vector of such numbers.
#[derive(Clone, Copy, Debug)]
struct Vector([Double; 3]);

impl Vector {
    fn of(v: Vec3) -> Self {
        Self(v.to_array().map(Double::of))
    }

    fn with(self, other: Self, of: impl Fn(Double, Double) -> Double) -> Self {
        Self(std::array::from_fn(|axis| of(self.0[axis], other.0[axis])))
    }

    fn times(self, factor: Double) -> Self {
        Self(self.0.map(|x| x * factor))
    }

    fn dot(self, other: Self) -> Double {
        let [x, y, z] = self.with(other, Mul::mul).0;
        x + y + z
    }

    fn length(self) -> Double {
        self.dot(self).sqrt()
    }
}

impl Add for Vector {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.with(other, Add::add)
    }
}

impl Sub for Vector {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.with(other, Sub::sub)
    }
}

/// A sphere by center and radius, else the plane y = 0.
type Shape = Option<(Vec3, f64)>;

/// Returns the t at which a ray meets a shape, in order.
fn crossings(shape: Shape, o: Vector, d: Vector) -> Vec<Double> {
    let Some((center, radius)) = shape else {
        return vec![-o.0[1] / d.0[1]];
    };
    let oc = o - Vector::of(center);
    let (a, b) = (d.dot(d), d.dot(oc));
    let c = oc.dot(oc) - Double::product(radius, radius);
    let discriminant = b * b - a * c;
    if !discriminant.is_positive() {
        return Vec::new();
    }
    let root = discriminant.sqrt();
    vec![(-b - root) / a, (-b + root) / a]
}

/// The end of shadow rays.
#[derive(Clone, Copy, Debug)]
enum Toward {
    Point(Vec3),
    Direction(Vec3),
}

impl Toward {
    fn light(self) -> Light {
        match self {
            Self::Point(position) => {
                let point = Point::new(position, Color::WHITE, 1.0, Falloff::Constant, true);
                point.unwrap().into()
            }
            Self::Direction(direction) => {
                let parallel = Directional::new(-direction, Color::WHITE, 1.0, true);
                parallel.unwrap().into()
            }
        }
    }
}

/// Returns the shape that a ray sees and whether the light reaches that point; `None` if it sees
/// nothing, or if an f64 cannot tell.
///
/// The ends of the error: D²u/(r·cos θ) is what the discriminant of the quadratic equation loses from
/// the distance D, u being 2⁻⁵³ and θ the angle between the ray and the normal. Everything else is
/// a small multiple of Du.
fn is_lit(shapes: &[Shape], toward: Toward, ray: &Ray, distance: f64) -> Option<(usize, bool)> {
    let (o, d) = (Vector::of(ray.origin()), Vector::of(ray.direction()));
    let mut seen: Option<(usize, Double)> = None;
    for (index, shape) in shapes.iter().enumerate() {
        let ahead = crossings(*shape, o, d);
        if let Some(t) = ahead.into_iter().find(|t| t.is_positive())
            && seen.is_none_or(|(_, nearest)| (nearest - t).is_positive())
        {
            seen = Some((index, t));
        }
    }
    let (index, t) = seen?;
    let point = o + d.times(t);
    let (normal, radius) = match shapes[index] {
        Some((center, radius)) => {
            let outward = point - Vector::of(center);
            (outward.times(Double::of(1.0) / outward.length()), radius)
        }
        None => (Vector::of(Vec3::Y), distance),
    };
    let cos = normal.dot(d).0.abs();
    let error = 16.0 * f64::EPSILON * distance * (distance / radius).max(1.0) / cos;
    let (to_light, end) = match toward {
        Toward::Point(light) => (Vector::of(light) - point, 1.0),
        Toward::Direction(direction) => (Vector::of(direction), f64::INFINITY),
    };
    let length = to_light.length().0;
    let facing = normal.dot(to_light).0 / length;
    if facing.abs() * radius < 2.0 * error {
        return None;
    }
    let mut lit = facing > 0.0;
    let others = shapes
        .iter()
        .enumerate()
        .filter(|(other, _)| *other != index);
    for (_, shape) in others {
        let ahead = |t: &Double| t.is_positive() && t.0 < end;
        lit &= !crossings(*shape, point, to_light).iter().any(ahead);
        let near = match shape {
            // How far the ray passes from the surface.
            Some((center, radius)) => {
                let oc = point - Vector::of(*center);
                let along = Double::of(to_light.dot(oc).0 / (length * length));
                (oc - to_light.times(along)).length().0 - radius
            }
            None => point.0[1].0,
        };
        // A ray that leaves the plane is not near it.
        if near.abs() < 2.0 * error {
            return None;
        }
    }
    Some((index, lit))
}

/// The shapes of a scene of size 1.
fn scenes() -> [Vec<Shape>; 2] {
    let ball = |x: f64, y: f64, z: f64, radius: f64| Some((Vec3::new(x, y, z), radius));
    [
        vec![None, ball(0.0, 1.0, 0.0, 1.0)],
        vec![
            None,
            ball(0.0, 1.0, 0.0, 1.0),
            ball(1.6, 0.3, 0.4, 0.7),
            ball(0.0, 2.5, 0.0, 0.5),
            ball(-1.2, 0.25, 0.9, 0.25),
        ],
    ]
}

#[test]
fn no_point_is_dark_or_lit_by_a_rounding_error() {
    const SIDE: u32 = 80;
    let lights = [
        Toward::Point(Vec3::new(3.0, 4.0, 2.0)),
        Toward::Point(Vec3::new(4.0, 0.4, 1.0)),
        Toward::Direction(Vec3::new(1.0, 2.0, 0.5)),
        Toward::Direction(Vec3::new(1.0, 0.05, 0.3)),
    ];
    for scale in [1e-3, 1.0, 1e3, 1e6] {
        for away in [30.0, 1e3, 1e5, 1e6] {
            let (mut lit, mut dark, mut skipped) = (0, 0, 0);
            for (shapes, toward) in scenes().iter().flat_map(|shapes| {
                let each = move |toward| (shapes, toward);
                lights.into_iter().map(each)
            }) {
                let scaled = |shape: &Shape| shape.map(|(c, r)| (c * scale, r * scale));
                let shapes: Vec<_> = shapes.iter().map(scaled).collect();
                let toward = match toward {
                    Toward::Point(light) => Toward::Point(light * scale),
                    parallel => parallel,
                };
                let geometry = |shape: &Shape| match shape {
                    Some((center, radius)) => {
                        Geometry::new(Sphere::new(*center, *radius).unwrap(), Color::WHITE)
                    }
                    None => Geometry::new(Plane::new(Vec3::ZERO, Vec3::Y).unwrap(), Color::WHITE),
                };
                let world = World::new(shapes.iter().map(geometry).collect(), Color::BLACK);
                let world = world.lit(Lighting::new(vec![toward.light()]));
                let from = Vec3::new(0.3, 0.5, 0.8);
                let distance = away * scale;
                let eye = from * (distance / from.length());
                let camera = PerspectiveCamera::new(eye, -from, Vec3::Y, 2.5 / away).unwrap();
                for place in 0..SIDE * SIDE {
                    let (x, y) = (f64::from(place % SIDE), f64::from(place / SIDE));
                    let ray = camera.ray_for(SIDE, SIDE, x, y);
                    let Some((index, is_lit)) = is_lit(&shapes, toward, &ray, distance) else {
                        skipped += 1;
                        continue;
                    };
                    let found = world.hit(&ray).map(|(index, _)| index);
                    assert_eq!(found, Some(index), "{shapes:?} from {away} radii: {ray:?}");
                    let light = world.radiance(&ray);
                    assert_eq!(
                        light != Radiance::BLACK,
                        is_lit,
                        "{toward:?} on {shapes:?} from {away} radii: {ray:?} sees {light:?}"
                    );
                    lit += u32::from(is_lit);
                    dark += u32::from(!is_lit);
                }
            }
            let all = lit + dark + skipped;
            assert!(lit * 4 > all && dark * 8 > all, "{lit} lit, {dark} dark");
            assert!(
                skipped * 20 < all,
                "{skipped} of {all} skipped from {away} radii at scale {scale}"
            );
        }
    }
}
