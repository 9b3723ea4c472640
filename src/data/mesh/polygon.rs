//! Faces with more than three corners as triangles.
//!
//! A fan around the first corner is right for every convex face and for many others. The rest are
//! clipped: G. H. Meisters, Polygons have ears (1975). After a cut, only the two neighbors of the ear
//! can become ears, so the number of tests is bounded by the corners times those that turn inward.

use std::collections::VecDeque;

use glam::{DVec2, DVec3};

use crate::{parallel::Cancel, tracer::vector::is_direction};

/// The fan of a face around its first corner.
pub(super) struct Fan {
    /// The sum of the normals of its triangles, each as long as twice their area: that of Newell.
    normal: DVec3,
    /// False if a triangle is turned away from the others.
    pub(super) is_right: bool,
    /// False if the corners are not in a plane: they lie between two planes whose distance is more
    /// than a part of the distance of two corners.
    pub(super) is_flat: bool,
}

/// What is likely rounding: the part of the area that may be turned away.
const ROUNDING: f64 = 1e-6;

/// How thick a flat face may be: a square with a fold of five degrees.
const FLAT: f64 = 0.02;

/// How thick a face of four corners may be: a square with a fold of 35 degrees. Those of curved surfaces
/// are never quite flat.
const BENT: f64 = 0.15;

/// How thick it may be without a closer look.
const SURELY: f64 = 0.149;

/// Returns true for four corners whose fan is right and flat and has no triangle without area: most
/// that are, and only those.
#[inline(always)]
pub(super) fn is_plain([a, b, c, d]: [DVec3; 4]) -> bool {
    let (middle, end) = (c - a, d - a);
    let start = b - a;
    let [first, second] = [start.cross(middle), middle.cross(end)];
    let normal = first + second;
    // The others are in a plane that is parallel to the normal.
    let height = start.dot(second);
    let most = SURELY * SURELY * normal.dot(normal) * middle.dot(middle);
    first.dot(second) > 0.0 && height * height < most && is_direction(first) && is_direction(second)
}

impl Fan {
    /// Returns the fan of at least three corners, unless they have no area.
    #[inline]
    pub(super) fn of(corners: &[DVec3]) -> Option<Self> {
        let (first, rest) = corners.split_first()?;
        let normals = rest
            .windows(2)
            .map(|edge| (edge[0] - *first).cross(edge[1] - *first));
        let normal = normals.clone().sum::<DVec3>();
        if !is_direction(normal) {
            return None;
        }
        let square = normal.dot(normal);
        let away = -ROUNDING * square;
        let is_right = normals.fold(true, |all, each| all & (each.dot(normal) >= away));
        let (mut low, mut high, mut size) = (0.0_f64, 0.0_f64, 0.0_f64);
        for corner in rest {
            let to = *corner - *first;
            let height = to.dot(normal);
            (low, high) = (low.min(height), high.max(height));
            size = size.max(to.dot(to));
        }
        let height = high - low;
        let thickness = if is_right && corners.len() == 4 {
            BENT
        } else {
            FLAT
        };
        Some(Self {
            normal,
            is_right,
            is_flat: height * height <= thickness * thickness * square * size,
        })
    }

    /// Returns the corners as seen against the normal, counterclockwise.
    pub(super) fn project(&self, corners: &[DVec3]) -> Vec<DVec2> {
        let first = corners.first().copied().unwrap_or_default();
        let n = self.normal;
        // The coordinates of a plane along two axes are exact, others nearly.
        let [u, v, w] = match n.abs() {
            size if size.x >= size.max_element() => [1, 2, 0],
            size if size.y >= size.max_element() => [2, 0, 1],
            _ => [0, 1, 2],
        };
        let [along_u, along_v] = [n[u] / n[w], n[v] / n[w]];
        let point = |corner: &DVec3| {
            let to = *corner - first;
            let (x, y) = (to[u] - along_u * to[w], to[v] - along_v * to[w]);
            match n[w] > 0.0 {
                true => DVec2::new(x, y),
                false => DVec2::new(y, x),
            }
        };
        corners.iter().map(point).collect()
    }
}

/// Twice the area of a triangle; below 0 if it is clockwise.
#[inline]
fn area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

/// A corner of what is left of a polygon.
struct Corner {
    at: DVec2,
    before: usize,
    after: usize,
    is_cut: bool,
    /// True if it does not turn left, so that it may lie inside of an ear.
    is_reflex: bool,
}

/// What may be cut off; each includes those before.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Ear {
    /// A triangle that touches no other corner.
    Free,
    /// One without area.
    Flat,
    /// One that has other corners only on its edges.
    Touched,
    /// One with other corners inside, as there are if edges cross.
    Convex,
    /// Any.
    Any,
}

/// A polygon that is cut into triangles.
pub(super) struct Polygon {
    corners: Vec<Corner>,
    /// The corners that were reflex at first.
    reflex: Vec<usize>,
    /// Twice the area.
    area: f64,
    /// Areas up to this are 0.
    small: f64,
}

impl Polygon {
    /// Creates a polygon from its corners, the first at the origin, counterclockwise.
    pub(super) fn new(points: &[DVec2]) -> Self {
        let count = points.len();
        let corner = |(index, at): (usize, &DVec2)| Corner {
            at: *at,
            before: (index + count - 1) % count,
            after: (index + 1) % count,
            is_cut: false,
            is_reflex: false,
        };
        let edges = points.iter().zip(points.iter().skip(1));
        let area = edges.map(|(a, b)| a.perp_dot(*b)).sum::<f64>();
        let mut polygon = Self {
            corners: points.iter().enumerate().map(corner).collect(),
            reflex: Vec::new(),
            area,
            small: area * 1e-12,
        };
        (0..count).for_each(|index| polygon.turn(index));
        let is_reflex = |index: &usize| polygon.corners[*index].is_reflex;
        polygon.reflex = (0..count).filter(is_reflex).collect();
        polygon
    }

    /// The number of tests that cutting may need, but for a small factor.
    pub(super) const fn work(&self) -> u64 {
        self.corners.len() as u64 * (1 + self.reflex.len() as u64)
    }

    /// Cuts the polygon into triangles, two less than its corners; `None` if they overlap, because
    /// edges cross, or once cancelled.
    pub(super) fn cut(mut self, cancel: Option<&Cancel>) -> Option<Vec<[usize; 3]>> {
        let mut left = self.corners.len();
        let mut triangles = Vec::with_capacity(left);
        let mut painted = 0.0;
        for ear in [Ear::Free, Ear::Flat, Ear::Touched, Ear::Convex, Ear::Any] {
            let corners = 0..self.corners.len();
            let mut queue: VecDeque<_> = corners.filter(|tip| !self.corners[*tip].is_cut).collect();
            while left >= 3
                && let Some(tip) = queue.pop_front()
            {
                if cancel.is_some_and(Cancel::is_cancelled) {
                    return None;
                }
                let Corner { before, after, .. } = self.corners[tip];
                let is_last = left == 3;
                if self.corners[tip].is_cut || !(is_last || self.is_ear(tip, ear)) {
                    continue;
                }
                painted += area(self.around(tip)).abs();
                triangles.push([before, tip, after]);
                self.remove(tip);
                left -= 1;
                queue.extend([before, after]);
            }
        }
        (painted <= self.area * (1.0 + ROUNDING)).then_some(triangles)
    }

    /// Returns a corner between its neighbors.
    fn around(&self, tip: usize) -> [DVec2; 3] {
        let Corner { before, after, .. } = self.corners[tip];
        [before, tip, after].map(|index| self.corners[index].at)
    }

    fn remove(&mut self, tip: usize) {
        let Corner { before, after, .. } = self.corners[tip];
        self.corners[tip].is_cut = true;
        self.corners[before].after = after;
        self.corners[after].before = before;
        self.turn(before);
        self.turn(after);
    }

    /// Notes whether a corner turns left.
    fn turn(&mut self, index: usize) {
        self.corners[index].is_reflex = area(self.around(index)) <= self.small;
    }

    fn is_ear(&self, tip: usize, ear: Ear) -> bool {
        let triangle = self.around(tip);
        let size = area(triangle);
        if ear == Ear::Any || size.abs() <= self.small {
            return ear >= Ear::Flat;
        }
        if size < 0.0 || ear == Ear::Convex {
            return size > 0.0;
        }
        let Corner { before, after, .. } = self.corners[tip];
        let mut others = self.reflex.iter().filter(|index| {
            let corner = &self.corners[**index];
            corner.is_reflex && !corner.is_cut && ![before, tip, after].contains(index)
        });
        !others.any(|index| self.is_in(*index, triangle, ear))
    }

    /// Returns true if a corner is in the way of an ear.
    fn is_in(&self, index: usize, [a, b, c]: [DVec2; 3], ear: Ear) -> bool {
        let at = self.corners[index].at;
        // A way to a hole and back has its ends twice.
        if at == a || at == c {
            return false;
        }
        if at == b {
            let Corner { before, after, .. } = self.corners[index];
            let to = [before, after].map(|next| self.corners[next].at);
            return to
                .into_iter()
                .any(|to| area([a, b, to]) > 0.0 && area([b, c, to]) > 0.0);
        }
        let least = if ear < Ear::Touched {
            -self.small
        } else {
            self.small
        };
        [[a, b], [b, c], [c, a]]
            .into_iter()
            .all(|[from, to]| area([from, to, at]) >= least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::random::{Rng, cases};

    /// Turns points of a plane into space.
    fn turned(points: &[[f64; 2]], rng: &mut Rng) -> Vec<DVec3> {
        let (u, v, shift) = (rng.vector(), rng.vector(), rng.vector() * 10.0);
        let point = |[x, y]: &[f64; 2]| *x * u + *y * v + shift;
        points.iter().map(point).collect()
    }

    fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
        let point = |[x, y]: &[f64; 2]| DVec3::new(*x, *y, 0.0);
        points.iter().map(point).collect()
    }

    /// Cuts a polygon; returns its triangles after a check of their areas: each is counterclockwise,
    /// and their sum is that of the polygon.
    fn cut(corners: &[DVec3]) -> Vec<[usize; 3]> {
        let fan = Fan::of(corners).unwrap();
        let points = fan.project(corners);
        let polygon = Polygon::new(&points);
        let whole = polygon.area;
        let triangles = polygon.cut(None).expect("no edges cross");
        assert_eq!(triangles.len(), corners.len() - 2);
        let areas = triangles.iter().map(|each| area(each.map(|at| points[at])));
        assert!(areas.clone().all(|area| area >= -1e-9 * whole));
        assert!((areas.sum::<f64>() - whole).abs() <= 1e-9 * whole);
        triangles
    }

    const L: [[f64; 2]; 6] = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];

    /// A square with a square hole, which is reached from its first corner.
    const FRAME: [[f64; 2]; 10] = [
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [1.0, 1.0],
    ];

    #[test]
    fn a_fan_is_wrong_where_it_leaves_the_face() {
        for first in 0..6 {
            let mut corners = flat(&L);
            corners.rotate_left(first);
            let fan = Fan::of(&corners).unwrap();
            // Only the inner corner and the one across from it see all of the others.
            assert_eq!(fan.is_right, first == 0 || first == 3, "{first}");
            assert!(fan.is_flat);
            cut(&corners);
            corners.reverse();
            cut(&corners);
        }
        cut(&flat(&FRAME));
    }

    #[test]
    fn convex_faces_are_fans() {
        let mut rng = Rng(0x3e54_f11e_0000_0003);
        for _ in 0..cases(500) {
            let count = 3 + rng.below(12);
            let mut angles: Vec<f64> = (0..count).map(|_| rng.signed().abs() * 6.2).collect();
            angles.sort_by(f64::total_cmp);
            let points = angles
                .iter()
                .map(|angle| [libm::cos(*angle), libm::sin(*angle)]);
            let mut points: Vec<_> = points.collect();
            // Corners between two others on a line.
            for at in (1..points.len()).rev() {
                if rng.below(3) == 0 {
                    let middle = [0, 1].map(|axis| (points[at - 1][axis] + points[at][axis]) / 2.0);
                    points.insert(at, middle);
                }
            }
            if let Some(fan) = Fan::of(&turned(&points, &mut rng)) {
                assert!(fan.is_right && fan.is_flat, "{points:?}");
            }
        }
    }

    #[test]
    fn triangles_fill_a_polygon() {
        let mut rng = Rng(0x3e54_f11e_0000_0004);
        for round in 0..cases(500) {
            let count = 4 + rng.below(40);
            let turns = |index: usize| index as f64 / count as f64 * std::f64::consts::TAU;
            let star = (0..count).map(|index| {
                let radius = 0.05 + rng.signed().abs();
                [
                    radius * libm::cos(turns(index)),
                    radius * libm::sin(turns(index)),
                ]
            });
            let star: Vec<_> = star.collect();
            let arm = |width: f64| {
                let point = move |index: usize| {
                    let radius = 1.0 + 0.2 * index as f64 + width;
                    [
                        radius * libm::cos(0.5 * index as f64),
                        radius * libm::sin(0.5 * index as f64),
                    ]
                };
                (0..count).map(point)
            };
            let spiral: Vec<_> = arm(0.0).chain(arm(0.8).rev()).collect();
            let teeth =
                (0..count).map(|index| [index as f64, (index % 2) as f64 * rng.signed().abs()]);
            let mut comb: Vec<_> = teeth.collect();
            comb.extend([[count as f64, -1.0], [0.0, -1.0]]);
            for points in [star, spiral, comb, FRAME.to_vec()] {
                let mut corners = match round % 2 {
                    0 => flat(&points),
                    _ => turned(&points, &mut rng),
                };
                let first = rng.below(corners.len());
                corners.rotate_left(first);
                cut(&corners);
            }
        }
    }

    #[test]
    fn crossing_edges_are_found() {
        let star = (0..5).map(|index| {
            let angle = f64::from(index) * 0.4 * std::f64::consts::TAU;
            [libm::cos(angle), libm::sin(angle)]
        });
        let bow = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]];
        for points in [star.collect(), bow.to_vec()] {
            let corners = flat(&points);
            let fan = Fan::of(&corners).unwrap();
            assert!(!fan.is_right);
            assert_eq!(Polygon::new(&fan.project(&corners)).cut(None), None);
        }
    }

    #[test]
    fn a_fold_is_not_flat() {
        let folded = |height: f64| {
            [
                DVec3::ZERO,
                DVec3::X,
                DVec3::new(1.0, 1.0, height),
                DVec3::Y,
            ]
        };
        let pentagon = |height: f64| {
            let [a, b, c, d] = folded(height);
            [a, b, c, DVec3::new(0.5, 1.0, height / 2.0), d]
        };
        for (height, is_flat) in [(0.0, true), (0.4, true), (0.5, false)] {
            let fan = Fan::of(&folded(height)).unwrap();
            assert_eq!((fan.is_flat, fan.is_right), (is_flat, true), "{height}");
        }
        for (height, is_flat) in [(0.0, true), (0.03, true), (0.1, false)] {
            let fan = Fan::of(&pentagon(height)).unwrap();
            assert_eq!((fan.is_flat, fan.is_right), (is_flat, true), "{height}");
        }
    }
}
