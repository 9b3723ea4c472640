//! Mirrored rays from points that are moved a little towards the viewer.

use strahl::{Hit, Ray, Vec3};

use crate::{
    form::Form,
    line::{Crossing, Line},
    shadow::{Lamp, line, scale},
    support::unit,
};

/// What a form does with light. Colors are gray, in linear light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Finish {
    pub(crate) diffuse: f64,
    pub(crate) specular: f64,
    pub(crate) exponent: f64,
    pub(crate) mirror: f64,
}

/// A scene of opaque forms.
#[derive(Debug)]
pub(crate) struct Bounces<'a> {
    pub(crate) items: &'a [(Form, Finish)],
    pub(crate) background: f64,
    pub(crate) lamp: Lamp,
    pub(crate) max_depth: u32,
}

/// The light of a pixel below which a ray is not traced.
const LEAST: f64 = 1.0 / 4096.0;

/// A place that a ray leaves.
#[derive(Clone, Copy)]
struct Place {
    point: Vec3,
    /// The normal on the side of the viewer.
    n: Vec3,
    /// The face that is left: the item, the part, and its own normal.
    own: Option<(usize, Crossing)>,
}

impl Bounces<'_> {
    /// Returns the light of a ray whose first hit is known, unless it depends on how far the point is
    /// moved.
    pub(crate) fn light(&self, ray: &Ray, (index, hit): (usize, &Hit)) -> Option<f64> {
        let n = if hit.front_face {
            hit.normal
        } else {
            -hit.normal
        };
        let found = [1e-11, 1e-10].map(|part| {
            let back = unit(ray.direction()) * (part * scale(ray, hit.t));
            let place = Place {
                point: hit.point - back,
                n,
                own: None,
            };
            self.shade(index, place, line(ray).d, (0, 1.0))
        });
        let is_sure = (found[0] - found[1]).abs() < 1e-7;
        is_sure.then_some(found[0])
    }

    fn follow(&self, line: Line, own: Option<(usize, Crossing)>, next: (u32, f64)) -> f64 {
        let (depth, factor) = next;
        if factor < LEAST {
            return 0.0;
        }
        if depth > self.max_depth {
            return self.background;
        }
        let first = self.met(&line, own, f64::INFINITY);
        let Some((item, at)) = first else {
            return self.background;
        };
        let place = Place {
            point: line.at(at.t),
            n: unit(at.n) * -at.n.dot(line.d).signum(),
            own: Some((item, at)),
        };
        self.shade(item, place, line.d, next)
    }

    /// Returns the first crossing behind a face that is left.
    fn met(
        &self,
        line: &Line,
        own: Option<(usize, Crossing)>,
        t_max: f64,
    ) -> Option<(usize, Crossing)> {
        let mut first: Option<(usize, Crossing)> = None;
        for (item, (form, _)) in self.items.iter().enumerate() {
            for at in form.crossings(line) {
                let is_own = own.is_some_and(|(own, left)| {
                    own == item && left.part == at.part && at.t.abs() * line.d.length() < 1e-12
                        || own == item && left.n == at.n
                });
                let is_first = first.is_none_or(|(_, first)| at.t < first.t);
                if at.t > 0.0 && at.t < t_max && !is_own && is_first {
                    first = Some((item, at));
                }
            }
        }
        first
    }

    fn shade(&self, item: usize, place: Place, d: Vec3, (depth, factor): (u32, f64)) -> f64 {
        let Finish {
            diffuse,
            specular,
            exponent,
            mirror,
        } = self.items[item].1;
        let Place { point, n, own } = place;
        let (to_light, t_max) = self.lamp.from(point);
        let l = unit(to_light);
        let line = Line {
            o: point,
            d: to_light,
        };
        let mut light = 0.0;
        if n.dot(l) > 0.0 && self.met(&line, own, t_max).is_none() {
            let r = 2.0 * n.dot(l) * n - l;
            let highlight = libm::pow(r.dot(-unit(d)).max(0.0), exponent);
            light += diffuse * n.dot(l) + specular * highlight;
        }
        if mirror > 0.0 {
            let line = Line {
                o: point,
                d: d - 2.0 * d.dot(n) * n,
            };
            light += mirror * self.follow(line, own, (depth + 1, factor * mirror));
        }
        light
    }
}
