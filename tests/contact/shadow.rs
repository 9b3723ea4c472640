//! The shadows of points that are moved a little towards the viewer, so that they lie on no face.

use strahl::{Hit, Ray, Vec3, World, light::Light};

use crate::{
    form::Form,
    line::Line,
    support::{Tally, example, lit_by, sun, unit, white},
};

/// By which parts of the numbers of a ray its end is moved: far more than they are rounded by.
const PARTS: [f64; 2] = [1e-12, 1e-11];

/// A light with shadows, of intensity 1.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Lamp {
    /// The direction to it.
    Sun(Vec3),
    /// Its position; it does not become weaker by distance.
    At(Vec3),
}

impl Lamp {
    /// Returns the direction to it, and the part of the way that may be in shadow.
    pub(crate) fn from(self, point: Vec3) -> (Vec3, f64) {
        match self {
            Self::Sun(l) => (l, f64::INFINITY),
            Self::At(position) => (position - point, 1.0 - 1e-8),
        }
    }

    pub(crate) fn light(self) -> Light {
        use strahl::{Color, light::Falloff, light::Point};
        match self {
            Self::Sun(l) => sun(-l),
            Self::At(position) => Point::new(position, Color::WHITE, 1.0, Falloff::Constant, true)
                .unwrap()
                .into(),
        }
    }
}

/// Returns the largest number that a ray to `t` has.
pub(crate) fn scale(ray: &Ray, t: f64) -> f64 {
    (ray.origin().abs() + (t * ray.direction()).abs()).max_element()
}

/// Returns true if something lies on the way to a light; `None` where that depends on how far the point
/// is moved.
fn is_shadowed(forms: &[Form], ray: &Ray, (index, hit): (usize, &Hit), lamp: Lamp) -> Option<bool> {
    let back = -unit(ray.direction()) * scale(ray, hit.t);
    // Of a smooth mesh, what lies in the plane of the face itself never shadows.
    let own = forms[index].is_smooth();
    let own = own.then(|| unit(forms[index].normal_of(hit.face)));
    let found = PARTS.map(|part| {
        let o = hit.point + part * back;
        let (d, t_max) = lamp.from(o);
        forms.iter().enumerate().any(|(number, form)| {
            form.crossings(&Line { o, d }).iter().any(|at| {
                let is_own = number == index
                    && own.is_some_and(|own| {
                        let is_parallel = own.cross(unit(at.n)).length() < 1e-6;
                        let is_near = at.t * d.length() < 1e-6 * scale(ray, hit.t);
                        at.part == hit.face || is_parallel && is_near
                    });
                at.t > 0.0 && at.t < t_max && !is_own
            })
        })
    });
    (found[0] == found[1]).then_some(found[0])
}

pub(crate) const fn line(ray: &Ray) -> Line {
    Line {
        o: ray.origin(),
        d: ray.direction(),
    }
}

/// Returns the light of a ray that hits a white surface, where that is known.
pub(crate) fn white_light(
    forms: &[Form],
    ray: &Ray,
    (index, hit): (usize, &Hit),
    lamp: Lamp,
) -> Option<f64> {
    let n = if hit.front_face {
        hit.normal
    } else {
        -hit.normal
    };
    let (l, _) = lamp.from(hit.point);
    let cosine = n.dot(unit(l));
    // The direction of a lamp on the point itself is one of rounding errors.
    if l.length() <= 1e-12 * scale(ray, hit.t) {
        return None;
    }
    if cosine <= 1e-13 {
        return Some(0.0);
    }
    let is_shadowed = is_shadowed(forms, ray, (index, hit), lamp)?;
    Some(if is_shadowed { 0.0 } else { cosine })
}

/// Counts the rays that see white forms in a light.
pub(crate) fn count(
    tally: &mut Tally,
    forms: &[Form],
    lamp: Lamp,
    rays: impl IntoIterator<Item = Ray>,
) {
    let world = lit_by(&white(forms), lamp.light());
    for ray in rays {
        count_ray(tally, forms, (&world, lamp), &ray);
    }
}

/// Counts one ray, if it hits something.
pub(crate) fn count_ray(
    tally: &mut Tally,
    forms: &[Form],
    (world, lamp): (&World, Lamp),
    ray: &Ray,
) {
    let Some((index, hit)) = world.hit(ray) else {
        return;
    };
    let right = white_light(forms, ray, (index, &hit), lamp);
    let found = world.radiance(ray).r();
    tally.count([found, 1e-9], right, || {
        let of = format!("{lamp:?} hits {index}.{}", hit.face);
        example(forms, ray, of)
    });
}
