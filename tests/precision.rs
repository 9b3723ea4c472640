//! Lit and shadowed points, beside an evaluation with twice as many digits: on spheres that lie on a
//! plane, at any scale and from far away, no point is dark or lit by a rounding error.

use std::ops::{Add, Div, Mul, Neg, Sub};

use strahl::{
    Color, Geometry, Lighting, PerspectiveCamera, Plane, Radiance, Ray, Sphere, Vec3, World,
    light::{Directional, Falloff, Light, Point},
    shape::{Shape as AnyShape, Torus},
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

/// A torus with exact numbers, and the bound of its documentation for a ray from `o`.
struct ExactTorus {
    center: Vector,
    axis: Vector,
    radius: f64,
    tube: Double,
    bound: f64,
}

impl ExactTorus {
    fn new(torus: &Torus, o: Vec3) -> Self {
        let axis = Vector::of(torus.axis());
        Self {
            center: Vector::of(torus.center()),
            axis: axis.times(Double::of(1.0) / axis.length()),
            radius: torus.radius(),
            tube: Double::of(torus.tube_radius()),
            bound: 64.0 * f64::EPSILON * (torus.radius() + (o - torus.center()).length()),
        }
    }

    /// Returns the distance of a point from the surface: below 0 inside.
    fn distance(&self, point: Vector) -> f64 {
        let q = point - self.center;
        let height = q.dot(self.axis);
        let away = (q - self.axis.times(height)).length() - Double::of(self.radius);
        ((away * away + height * height).sqrt() - self.tube).0
    }

    /// Returns the number of crossings of a line with a tube that is thicker by an amount, by Sturm's
    /// theorem.
    fn count(&self, o: Vector, d: Vector, thicker: f64) -> usize {
        let (one, two, four) = (Double::of(1.0), Double::of(2.0), Double::of(4.0));
        let unit = one / Double::of(self.radius);
        let q = (o - self.center).times(unit);
        let u = d.times(one / d.length());
        let p = q - u.times(q.dot(u));
        let (k, h, g) = (p.dot(p), p.dot(self.axis), u.dot(self.axis));
        let tube = (self.tube + Double::of(thicker)) * unit;
        let outer = k + one - tube * tube;
        let quartic = [
            outer * outer - four * (k - h * h),
            two * four * h * g,
            two * outer - four * (one - g * g),
            Double::of(0.0),
            one,
        ];
        let factors = [1.0, 2.0, 3.0, 4.0].map(Double::of);
        let slope = quartic[1..].iter().zip(factors);
        let slope = slope.map(|(one, factor)| *one * factor);
        let mut chain = vec![quartic.to_vec(), slope.collect()];
        while let [.., first, second] = &*chain {
            let next = negative_rest(first.clone(), second);
            if next.is_empty() {
                break;
            }
            chain.push(next);
        }
        let changes = |is_low: bool| {
            let sign = |of: &Vec<Double>| {
                of[of.len() - 1].is_positive() ^ (is_low && of.len().is_multiple_of(2))
            };
            chain
                .windows(2)
                .filter(|two| sign(&two[0]) != sign(&two[1]))
                .count()
        };
        changes(true) - changes(false)
    }
}

/// Returns the rest of a division of polynomials, with the other sign.
fn negative_rest(mut rest: Vec<Double>, by: &[Double]) -> Vec<Double> {
    while rest.len() >= by.len() {
        let shift = rest.len() - by.len();
        let factor = rest[rest.len() - 1] / by[by.len() - 1];
        for (at, x) in by.iter().enumerate() {
            rest[shift + at] = rest[shift + at] - factor * *x;
        }
        rest.pop();
    }
    while rest.last().is_some_and(|last| last.0 == 0.0) {
        rest.pop();
    }
    rest.into_iter().map(Neg::neg).collect()
}

/// Numbers between -1 and 1, always the same.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        // Xorshift (Marsaglia, 2003).
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 * f64::EPSILON - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }

    fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[((self.next() + 1.0) / 2.0 * of.len() as f64) as usize]
    }

    fn power(&mut self, low: f64, high: f64) -> f64 {
        libm::pow(10.0, low + (high - low) * (self.next() + 1.0) / 2.0)
    }
}

#[test]
fn a_torus_is_crossed_where_it_is_and_as_often() {
    let mut random = Numbers(0x70_7275);
    let (mut worst, mut counts, mut close) = (0.0, [0; 5], 0);
    const RAYS: usize = 100_000;
    for _ in 0..RAYS {
        let size = [random.power(-6.0, 6.0), random.power(-100.0, 100.0)];
        let radius = random.one(&[1.0, 1.0, size[0], size[1]]);
        let any = (random.next() + 1.0) / 2.0;
        let near_1 = 1.0 - random.power(-9.0, -1.0);
        let thin = random.power(-9.0, -1.0);
        let ratio = random.one(&[0.25, any, any, near_1, thin]);
        let any_axis = random.vector();
        let axis = random.one(&[Vec3::Y, Vec3::Z, any_axis, any_axis]);
        let center = random.vector() * random.one(&[0.0, 0.0, 1.0, 100.0]) * radius;
        let torus = Torus::new(center, axis, radius, ratio * radius).unwrap();
        // A point on the surface, one beside it, and a way along it.
        let (across, beside) = torus.axis().any_orthonormal_pair();
        let turn = |angle: f64, x: Vec3, y: Vec3| x * libm::cos(angle) + y * libm::sin(angle);
        let out = turn(4.0 * random.next(), across, beside);
        let angle = 4.0 * random.next() * random.one(&[0.0, 1.0, 1.0]);
        let normal = turn(angle, out, torus.axis());
        let nudge = random.power(-14.0, 0.0) * random.next();
        let point = center + (out + normal * ratio * (1.0 + nudge)) * radius;
        let tangent = normal.cross(random.vector());
        let inside = center + random.vector() * 1.2 * radius;
        let away = radius * random.power(-2.0, 6.0);
        let (origin, to) = match random.one(&[0, 1, 2, 3, 4]) {
            0 => (inside, point),
            1 => (center + random.vector() * away, point),
            2 => (point + tangent * away, point),
            3 => (
                center + torus.axis() * away,
                center + random.vector() * radius * 1e-3,
            ),
            _ => (center + out * away, center - out * radius),
        };
        let direction = (to - origin) * random.one(&[1.0, 1.0 / away, 1e3 / away]);
        if direction.dot(direction).is_subnormal() || direction == Vec3::ZERO {
            continue;
        }
        let ray = Ray::new(origin, direction);
        let exact = ExactTorus::new(&torus, origin);
        let (o, d) = (Vector::of(origin), Vector::of(direction));
        let found = AnyShape::from(torus).working(&ray).solutions;
        let found = found.unwrap_or_default();
        for t in &found {
            let distance = exact.distance(o + d.times(Double::of(*t))).abs();
            worst = f64::max(worst, distance / exact.bound);
            assert!(
                distance <= exact.bound,
                "{distance:e} {torus:?} {ray:?} {t}"
            );
        }
        let around = [-1.0, 0.0, 1.0].map(|side| exact.count(o, d, side * exact.bound));
        let [count, ..] = around;
        if around == [count; 3] && exact.bound < 0.1 * torus.tube_radius() {
            assert_eq!(found.len(), count, "{torus:?} {ray:?} {found:?}");
            counts[count] += 1;
        } else {
            close += 1;
        }
    }
    println!("{worst} of the bound; {counts:?}; {close} too close");
    assert!(counts.iter().sum::<usize>() > RAYS / 2);
}
