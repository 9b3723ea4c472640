//! The faces of shapes as targets of rays: an estimate of what they take of the view from a point, points on
//! them, and the density of these.

use std::f64::consts::PI;

use glam::DVec3;

use crate::tracer::{
    sampling::{LocalFrame, UnitPair, circle, disc},
    shape::{Shape, axis::Axis},
    transform::Transform,
    vector::{is_direction, unit},
};

/// The part of the weight of a flat face that does not depend on its angle.
pub(crate) const AT_ANY_ANGLE: f64 = 0.1;
/// The part by which the axes of a transform may differ from those of a rotation with one scale.
const ROUNDING: f64 = 1e-9;

/// A face that rays are aimed at.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Target {
    /// A ball.
    Ball { center: DVec3, radius: f64 },
    /// A flat face.
    Flat(FlatTarget),
    /// The side of a cylinder or a cone: around a line, with the radii of its ends.
    Side {
        from: DVec3,
        to: DVec3,
        radii: [f64; 2],
    },
    /// A capsule.
    Capsule { from: DVec3, to: DVec3, radius: f64 },
}

/// A flat face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatTarget {
    pub(crate) form: FlatForm,
    /// The corner or the center.
    pub(crate) origin: DVec3,
    /// The edges at the corner, or two radii.
    pub(crate) edges: [DVec3; 2],
    pub(crate) middle: DVec3,
    /// The unit normal.
    pub(crate) normal: DVec3,
    pub(crate) area: f64,
}

/// The form of a flat face.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FlatForm {
    Disc,
    Parallelogram,
    Triangle,
}

/// A direction to a target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AimedAt {
    /// The unit vector.
    pub(crate) l: DVec3,
    pub(crate) distance: f64,
    /// The density of the direction.
    pub(crate) density: f64,
}

/// Directions around an axis, evenly distributed up to an angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConeOfDirections {
    axis: DVec3,
    /// The square of the sine of the angle, which is at most a quarter turn.
    sin_squared: f64,
}

impl ConeOfDirections {
    /// Creates the directions around a unit vector.
    pub(crate) const fn new(axis: DVec3, sin_squared: f64) -> Self {
        Self { axis, sin_squared }
    }

    /// Returns the directions to a ball; `None` from inside.
    pub(crate) fn of_ball(point: DVec3, center: DVec3, radius: f64) -> Option<Self> {
        let to_center = center - point;
        let sin_squared = radius * radius / to_center.dot(to_center);
        let is_outside = is_direction(to_center) && sin_squared < 1.0;
        is_outside.then(|| Self::new(unit(to_center), sin_squared))
    }

    /// The axis.
    pub(crate) const fn axis(&self) -> DVec3 {
        self.axis
    }

    pub(crate) const fn sin_squared(&self) -> f64 {
        self.sin_squared
    }

    /// Returns true if a unit vector lies within the angle.
    pub(crate) fn holds(&self, l: DVec3) -> bool {
        let across = l.cross(self.axis);
        l.dot(self.axis) > 0.0 && across.dot(across) <= self.sin_squared
    }

    /// Returns a direction.
    pub(crate) fn sample(&self, [u, v]: UnitPair) -> DVec3 {
        // 1 - cos, without cancellation.
        let below = u * self.sin_squared / (1.0 + (1.0 - self.sin_squared).sqrt());
        let radius = (below * (2.0 - below)).sqrt();
        let [cosine, sine] = circle(v);
        let local = DVec3::new(radius * cosine, radius * sine, 1.0 - below);
        LocalFrame::new(self.axis).outward(local)
    }

    /// Returns the density of all directions.
    pub(crate) fn density(&self) -> f64 {
        (1.0 + (1.0 - self.sin_squared).sqrt()) / (2.0 * PI * self.sin_squared)
    }
}

impl FlatTarget {
    /// Creates a face; `None` if it has no area.
    fn of(form: FlatForm, origin: DVec3, edges: [DVec3; 2]) -> Option<Target> {
        let [e, f] = edges;
        let across = e.cross(f);
        let of_edges = is_direction(across).then(|| across.length())?;
        let (middle, area) = match form {
            FlatForm::Disc => (origin, PI * of_edges),
            FlatForm::Parallelogram => (origin + (e + f) / 2.0, of_edges),
            FlatForm::Triangle => (origin + (e + f) / 3.0, of_edges / 2.0),
        };
        Some(Target::Flat(Self {
            form,
            origin,
            edges,
            middle,
            normal: unit(across),
            area,
        }))
    }

    fn at(&self, [u, v]: UnitPair) -> DVec3 {
        let [e, f] = self.edges;
        let [x, y] = match self.form {
            FlatForm::Disc => disc([u, v]),
            FlatForm::Parallelogram => [u, v],
            FlatForm::Triangle => {
                let root = u.sqrt();
                [1.0 - root, v * root]
            }
        };
        self.origin + x * e + y * f
    }
}

impl Target {
    /// Returns a point in its middle.
    pub(crate) fn middle(&self) -> DVec3 {
        match self {
            Self::Ball { center, .. } => *center,
            Self::Flat(flat) => flat.middle,
            Self::Side { from, to, .. } | Self::Capsule { from, to, .. } => (*from + *to) / 2.0,
        }
    }

    /// Returns the unit normal, if it is flat.
    pub(crate) fn normal(&self) -> Option<DVec3> {
        match self {
            Self::Flat(flat) => Some(flat.normal),
            Self::Ball { .. } | Self::Side { .. } | Self::Capsule { .. } => None,
        }
    }

    /// Returns an estimate of the irradiance at a point from light 1 of the face.
    pub(crate) fn weight(&self, point: DVec3) -> f64 {
        match self {
            Self::Ball { center, radius } => {
                let cone = ConeOfDirections::of_ball(point, *center, *radius);
                cone.map_or(0.0, |cone| PI * cone.sin_squared())
            }
            Self::Flat(flat) => {
                let (to, area) = (flat.middle - point, flat.area);
                let cosine = match is_direction(to) {
                    true => flat.normal.dot(to).abs() / to.length(),
                    false => 1.0,
                };
                let seen = AT_ANY_ANGLE + (1.0 - AT_ANY_ANGLE) * cosine;
                area * seen / to.length_squared().max(area)
            }
            Self::Side { .. } | Self::Capsule { .. } => {
                let area = self.area();
                area / (self.middle() - point).length_squared().max(area)
            }
        }
    }

    /// Returns the irradiance from light 1 of the face at a distance of 1, as if it were small and seen head-on.
    pub(crate) fn power(&self) -> f64 {
        match self {
            Self::Ball { radius, .. } => PI * (radius * radius),
            Self::Flat(_) | Self::Side { .. } | Self::Capsule { .. } => self.area(),
        }
    }

    fn area(&self) -> f64 {
        match *self {
            Self::Ball { radius, .. } => 4.0 * PI * (radius * radius),
            Self::Flat(flat) => flat.area,
            Self::Side { from, to, radii } => {
                let [low, high] = radii;
                let (length, growth) = ((to - from).length(), high - low);
                PI * (low + high) * (length * length + growth * growth).sqrt()
            }
            Self::Capsule { from, to, radius } => {
                2.0 * PI * radius * ((to - from).length() + 2.0 * radius)
            }
        }
    }

    /// Returns a direction to it from a point; `None` if there is none, as from inside of a ball.
    pub(crate) fn sample(&self, point: DVec3, pair: UnitPair) -> Option<AimedAt> {
        if let Self::Ball { center, radius } = self {
            let cone = ConeOfDirections::of_ball(point, *center, *radius)?;
            let l = cone.sample(pair);
            return Some(AimedAt {
                l,
                distance: to_ball((*center - point, *radius), l),
                density: cone.density(),
            });
        }
        let (at, normal) = self.at(pair);
        let to = at - point;
        let l = is_direction(to).then(|| unit(to))?;
        let density = self.density_at(to, l, normal);
        (density > 0.0 && density.is_finite()).then(|| AimedAt {
            l,
            distance: to.length(),
            density,
        })
    }

    /// Returns the density of the direction from a point to one on the face, where it has this normal.
    pub(crate) fn density(&self, point: DVec3, at: DVec3, normal: DVec3) -> f64 {
        match self {
            Self::Ball { center, radius } => {
                let cone = ConeOfDirections::of_ball(point, *center, *radius);
                cone.map_or(0.0, |cone| cone.density())
            }
            Self::Flat(flat) => self.density_at(at - point, unit(at - point), flat.normal),
            Self::Side { .. } | Self::Capsule { .. } => {
                self.density_at(at - point, unit(at - point), normal)
            }
        }
    }

    /// The same for points evenly distributed by area.
    fn density_at(&self, to: DVec3, l: DVec3, normal: DVec3) -> f64 {
        to.dot(to) / (self.area() * l.dot(normal).abs())
    }

    /// Returns a point, evenly distributed by area, and the unit normal there.
    fn at(&self, [u, v]: UnitPair) -> (DVec3, DVec3) {
        let around = |w: DVec3, v| {
            let [cosine, sine] = circle(v);
            LocalFrame::new(w).outward(DVec3::new(cosine, sine, 0.0))
        };
        match *self {
            Self::Flat(flat) => (flat.at([u, v]), flat.normal),
            Self::Ball { center, radius } => {
                let normal = on_ball([u, v], DVec3::Z);
                (center + radius * normal, normal)
            }
            Self::Side { from, to, radii } => {
                let [low, high] = radii;
                let (along, growth) = (to - from, high - low);
                let radius = (low * low + u * (high * high - low * low)).sqrt();
                let height = u * (low + high) / (low + radius);
                let out = around(unit(along), v);
                let slope = growth / along.length();
                let normal = unit(out - slope * unit(along));
                (from + height * along + radius * out, normal)
            }
            Self::Capsule { from, to, radius } => {
                let along = to - from;
                let side = along.length() / (along.length() + 2.0 * radius);
                if u < side {
                    let out = around(unit(along), v);
                    return (from + u / side * along + radius * out, out);
                }
                let normal = on_ball([(u - side) / (1.0 - side), v], unit(along));
                let end = if normal.dot(along) > 0.0 { to } else { from };
                (end + radius * normal, normal)
            }
        }
    }

    /// Returns the face under a transform, if it is one of these kinds again.
    fn placed(&self, transform: &Transform) -> Option<Self> {
        let scale = || {
            let axes = DVec3::AXES.map(|axis| transform.direction(axis));
            let [x, y, z] = axes;
            let scale = x.length();
            let is_even = |axis: DVec3| (axis.length() - scale).abs() <= ROUNDING * scale;
            let are_square =
                |one: DVec3, other: DVec3| one.dot(other).abs() <= ROUNDING * scale * scale;
            let is_similar = axes.into_iter().all(is_even)
                && are_square(x, y)
                && are_square(y, z)
                && are_square(z, x);
            is_similar.then_some(scale)
        };
        let point = |point| transform.point(point);
        Some(match *self {
            Self::Flat(flat) => {
                let edges = flat.edges.map(|edge| transform.direction(edge));
                return FlatTarget::of(flat.form, point(flat.origin), edges);
            }
            Self::Ball { center, radius } => Self::Ball {
                center: point(center),
                radius: radius * scale()?,
            },
            Self::Side { from, to, radii } => {
                let scale = scale()?;
                Self::Side {
                    from: point(from),
                    to: point(to),
                    radii: radii.map(|radius| radius * scale),
                }
            }
            Self::Capsule { from, to, radius } => Self::Capsule {
                from: point(from),
                to: point(to),
                radius: radius * scale()?,
            },
        })
    }
}

/// Returns the distance of a ball along a unit vector, given the vector to its center and its radius.
pub(crate) fn to_ball((to, radius): (DVec3, f64), l: DVec3) -> f64 {
    let along = to.dot(l);
    let across = to - along * l;
    along - (radius * radius - across.dot(across)).max(0.0).sqrt()
}

/// Returns a unit vector, evenly distributed, by its height above an axis.
pub(crate) fn on_ball([u, v]: UnitPair, axis: DVec3) -> DVec3 {
    let z = 1.0 - 2.0 * u;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let [cosine, sine] = circle(v);
    LocalFrame::new(axis).outward(DVec3::new(radius * cosine, radius * sine, z))
}

impl Shape {
    /// Calls `see` with each face, or with all of a capsule, that rays can be aimed at: the number of the
    /// first face, their count, and the target.
    pub(crate) fn each_target(&self, see: &mut dyn FnMut(u64, u64, Target)) {
        let one = |face, target: Option<Target>, see: &mut dyn FnMut(u64, u64, Target)| {
            target.into_iter().for_each(|target| see(face, 1, target));
        };
        let disc = |center, normal: DVec3, radius: f64| {
            let frame = LocalFrame::new(normal);
            let edges = [DVec3::X, DVec3::Y].map(|axis| frame.outward(axis) * radius);
            FlatTarget::of(FlatForm::Disc, center, edges)
        };
        let round =
            |axis: &Axis, radii: [f64; 2], capped, see: &mut dyn FnMut(u64, u64, Target)| {
                let (from, to) = (axis.from, axis.to);
                see(0, 1, Target::Side { from, to, radii });
                let ends = [(1, from, radii[0]), (2, to, radii[1])];
                for (face, center, radius) in ends.into_iter().filter(|_| capped) {
                    one(face, disc(center, axis.w, radius), see);
                }
            };
        match self {
            Self::Sphere(sphere) => {
                let (center, radius) = (sphere.center(), sphere.radius());
                see(0, 1, Target::Ball { center, radius });
            }
            Self::Disc(it) => one(0, disc(it.center(), it.unit_normal(), it.radius()), see),
            Self::Rectangle(it) => {
                let edges = it.edges();
                one(
                    0,
                    FlatTarget::of(FlatForm::Parallelogram, it.corner(), edges),
                    see,
                );
            }
            Self::Triangle(it) => {
                let [a, b, c] = it.corners();
                one(
                    0,
                    FlatTarget::of(FlatForm::Triangle, a, [b - a, c - a]),
                    see,
                );
            }
            Self::Mesh(mesh) => {
                for face in 0..mesh.triangles().len() as u64 {
                    if let Some([a, b, c]) = mesh.corners(face) {
                        one(
                            face,
                            FlatTarget::of(FlatForm::Triangle, a, [b - a, c - a]),
                            see,
                        );
                    }
                }
            }
            Self::Cuboid(it) => {
                let size = it.max() - it.min();
                for face in 0..6 {
                    let axis = face / 2;
                    let up = DVec3::AXES[axis] * size[axis] * (face % 2) as f64;
                    let edges = [1, 2].map(|next| {
                        let axis = (axis + next) % 3;
                        DVec3::AXES[axis] * size[axis]
                    });
                    let form = FlatForm::Parallelogram;
                    one(face as u64, FlatTarget::of(form, it.min() + up, edges), see);
                }
            }
            Self::Cylinder(it) => round(it.axis(), [it.radius(); 2], it.capped(), see),
            Self::Cone(it) => round(it.axis(), [it.radius(), it.top_radius()], it.capped(), see),
            Self::Capsule(it) => {
                let (from, to, radius) = (it.from(), it.to(), it.radius());
                see(0, 3, Target::Capsule { from, to, radius });
            }
            Self::Placed(placed) => {
                placed.shape().each_target(&mut |first, count, target| {
                    if let Some(target) = target.placed(placed.transform()) {
                        see(first, count, target);
                    }
                });
            }
            Self::Instances(copies) => {
                let mut before = 0;
                for copy in 0..copies.len() {
                    let transform = copies.transform(copy);
                    for shape in copies.shapes() {
                        shape.each_target(&mut |first, count, target| {
                            let placed = transform.as_ref().and_then(|it| target.placed(it));
                            if let Some(target) = placed {
                                see(before + first, count, target);
                            }
                        });
                        before += shape.face_count();
                    }
                }
            }
            Self::Plane(_) | Self::Ellipsoid(_) | Self::Torus(_) | Self::Solid(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::{
        random::Rng,
        ray::Ray,
        shape::{
            capsule::Capsule, cone::Cone, cuboid::Cuboid, cylinder::Cylinder, disc::Disc,
            face::Leaving, rectangle::Rectangle, sphere::Sphere, triangle::Triangle,
        },
    };

    fn shapes() -> Vec<Shape> {
        let v = DVec3::new;
        let (a, b) = (v(0.2, -0.1, 0.0), v(0.9, 0.7, 0.3));
        vec![
            Sphere::new(a, 0.7).unwrap().into(),
            Disc::new(a, b, 0.8).unwrap().into(),
            Rectangle::new(a, v(1.0, 0.2, 0.0), v(0.0, 0.5, 1.0))
                .unwrap()
                .into(),
            Triangle::new(a, b, v(-0.5, 0.4, 0.9)).unwrap().into(),
            Cuboid::new(v(-0.3, -0.4, -0.5), v(0.6, 0.1, 0.2))
                .unwrap()
                .into(),
            Cylinder::new(a, b, 0.3, true).unwrap().into(),
            Cylinder::new(a, b, 0.3, false).unwrap().into(),
            Cone::new(a, b, 0.5, 0.0, true).unwrap().into(),
            Cone::new(a, b, 0.5, 0.2, false).unwrap().into(),
            Capsule::new(a, b, 0.3).unwrap().into(),
        ]
    }

    // Directions to points that are not hidden by the shape have the density that a hit there has. The
    // mean of 1/density over them is the solid angle, which plain directions give as well.
    #[test]
    fn targets_have_the_solid_angle_of_their_shape() {
        for shape in shapes() {
            let eye = DVec3::new(0.5, 1.4, 2.0);
            let mut random = Rng(77);
            let mut number = || (random.signed() + 1.0) / 2.0;
            let count = 40_000;
            let mut by_targets = 0.0;
            shape.each_target(&mut |first, faces, target| {
                for _ in 0..count {
                    let Some(aim) = target.sample(eye, [number(), number()]) else {
                        continue;
                    };
                    let ray = Ray::new(eye, aim.l);
                    let met = shape.meet(&ray, Leaving::NOTHING, 1e9);
                    let Some(met) = met.filter(|met| (first..first + faces).contains(&met.face))
                    else {
                        continue;
                    };
                    if (met.t - aim.distance).abs() < 1e-6 {
                        let normal = shape.normal_at(&ray, met);
                        let density = target.density(eye, ray.at(met.t), normal);
                        assert!((density / aim.density - 1.0).abs() < 1e-4, "{shape:?}");
                        by_targets += 1.0 / aim.density / f64::from(count);
                    }
                }
            });
            let hits = (0..400_000).filter(|_| {
                let l = on_ball([number(), number()], DVec3::Z);
                shape.intersect(&Ray::new(eye, l), f64::INFINITY).is_some()
            });
            let hits = hits.count() as f64;
            let plain = hits / 400_000.0 * 4.0 * PI;
            let apart = (by_targets / plain - 1.0).abs();
            assert!(apart < 4.0 / hits.sqrt(), "{by_targets} {plain} {shape:?}");
        }
    }
}
