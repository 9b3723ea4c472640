//! What a line crosses, by equations written for clearness.

use strahl::{
    Vec3,
    shape::{Operation, Transform},
};

/// A point at which a line crosses a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub(crate) t: f64,
    /// The normal, outward if there is an inside, of any length.
    pub(crate) n: Vec3,
    /// The number of a triangle in a mesh.
    pub(crate) part: u64,
}

/// A part of a line inside of a solid.
pub(crate) type Span = [Crossing; 2];

/// A line: an origin and a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) o: Vec3,
    pub(crate) d: Vec3,
}

/// A solid is not thinner than this part of the numbers of its ends, nor is a gap in it.
pub(crate) const SLIVER: f64 = 1e-13;

impl Line {
    pub(crate) fn at(&self, t: f64) -> Vec3 {
        self.o + t * self.d
    }
}

/// The whole line.
pub(crate) const ALL: Span = [
    Crossing {
        t: f64::NEG_INFINITY,
        n: Vec3::X,
        part: 0,
    },
    Crossing {
        t: f64::INFINITY,
        n: Vec3::X,
        part: 0,
    },
];

pub(crate) fn pairs(ends: Vec<Crossing>) -> Vec<Span> {
    ends.chunks_exact(2)
        .map(|pair| [pair[0], pair[1]])
        .collect()
}

/// Returns the rows of the inverse of a transform's linear part, and its shift.
pub(crate) fn inverse(by: &Transform) -> ([Vec3; 3], Vec3) {
    let rows = by.rows();
    let [x, y, z] = [0, 1, 2].map(|axis| Vec3::from(rows.map(|row| row[axis])));
    let determinant = x.dot(y.cross(z));
    let inverse = [y.cross(z), z.cross(x), x.cross(y)].map(|row| row / determinant);
    (inverse, Vec3::from(rows.map(|row| row[3])))
}

/// Returns a normal after a transform.
pub(crate) fn normal_after(by: &Transform, n: Vec3) -> Vec3 {
    let ([x, y, z], _) = inverse(by);
    (x * n.x + y * n.y) + z * n.z
}

/// Returns what a shape has on a line that is mapped back, with the normals mapped.
pub(crate) fn back(
    by: &Transform,
    line: &Line,
    of: impl Fn(&Line) -> Vec<Crossing>,
) -> Vec<Crossing> {
    let (inverse, shift) = inverse(by);
    let linear = |v: Vec3| Vec3::from(inverse.map(|row| row.dot(v)));
    let line = Line {
        o: linear(line.o - shift),
        d: linear(line.d),
    };
    let found = of(&line).into_iter();
    found
        .map(|at| Crossing {
            n: normal_after(by, at.n),
            ..at
        })
        .collect()
}

pub(crate) fn plane(line: &Line, a: Vec3, n: Vec3) -> Option<Crossing> {
    let t = (a - line.o).dot(n) / line.d.dot(n);
    t.is_finite().then_some(Crossing { t, n, part: 0 })
}

/// Returns the crossing with a triangle: with its plane, where the line passes all edges on the same side.
/// Two triangles that share an edge find the same numbers for it, so that no line passes between them.
pub(crate) fn triangle(line: &Line, [a, b, c]: &[Vec3; 3], part: u64) -> Option<Crossing> {
    let n = (b - a).cross(c - a);
    let at = plane(line, *a, n)?;
    let side = |from: &Vec3, to: &Vec3| (from - line.o).cross(to - line.o).dot(line.d);
    let sides = [side(a, b), side(b, c), side(c, a)];
    let is_inside = sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0);
    is_inside.then_some(Crossing { part, ..at })
}

pub(crate) fn span([from, to]: [f64; 2], n: [Vec3; 2]) -> Span {
    let end = |t: f64, n: Vec3| Crossing { t, n, part: 0 };
    [end(from, n[0]), end(to, n[1])]
}

/// Returns the part between two planes.
pub(crate) fn slab(line: &Line, [low, high]: [f64; 2], n: Vec3) -> Option<Span> {
    let (o, d) = (line.o.dot(n), line.d.dot(n));
    if d == 0.0 {
        return (low < o && o < high).then_some(ALL);
    }
    let t = [(low - o) / d, (high - o) / d];
    Some(match d > 0.0 {
        true => span(t, [-n, n]),
        false => span([t[1], t[0]], [n, -n]),
    })
}

pub(crate) fn half_space(line: &Line, a: Vec3, n: Vec3) -> Option<Span> {
    let d = line.d.dot(n);
    let height = (line.o - a).dot(n);
    if d == 0.0 {
        return (height < 0.0).then_some(ALL);
    }
    let end = Crossing {
        t: -height / d,
        n,
        part: 0,
    };
    Some(match d > 0.0 {
        true => [ALL[0], end],
        false => [end, ALL[1]],
    })
}

/// Returns the part in a ball, by the point of the line that is nearest to the center.
pub(crate) fn ball(line: &Line, c: Vec3, r: f64) -> Option<Span> {
    let length = line.d.length();
    let u = line.d / length;
    let q = line.o - c;
    let middle = -q.dot(u);
    let away = q + middle * u;
    let half = (r - away.length()) * (r + away.length());
    let half = (half > 0.0).then(|| half.sqrt())?;
    let ends = [middle - half, middle + half];
    Some(span(
        ends.map(|s| s / length),
        ends.map(|s| away + (s - middle) * u),
    ))
}

/// Returns the part in an infinite cylinder.
pub(crate) fn mantle(line: &Line, a: Vec3, axis: Vec3, r: f64) -> Option<Span> {
    let axis = axis / axis.length();
    let across = |v: Vec3| v - v.dot(axis) * axis;
    let (q, d) = (across(line.o - a), across(line.d));
    if d.length_squared() == 0.0 {
        return (q.length() < r).then_some(ALL);
    }
    ball(&Line { o: q, d }, Vec3::ZERO, r)
}

/// Returns the part in two convex solids.
pub(crate) fn both(a: Option<Span>, b: Option<Span>) -> Option<Span> {
    let (a, b) = (a?, b?);
    let from = if a[0].t > b[0].t { a[0] } else { b[0] };
    let to = if a[1].t < b[1].t { a[1] } else { b[1] };
    (from.t < to.t).then_some([from, to])
}

/// Returns the parts of a line in a combination of solids.
pub(crate) fn combined(line: &Line, operation: Operation, of: &[Vec<Span>]) -> Vec<Span> {
    let mut ends: Vec<(Crossing, bool)> = Vec::new();
    for (number, spans) in of.iter().enumerate() {
        let is_cut = operation == Operation::Difference && number > 0;
        ends.extend(spans.iter().flatten().map(|end| (*end, is_cut)));
    }
    ends.sort_by(|(a, _), (b, _)| a.t.total_cmp(&b.t));
    let holds = |t: f64| {
        let mut inside = of
            .iter()
            .map(|spans| spans.iter().any(|[from, to]| from.t < t && t < to.t));
        match operation {
            Operation::Union => inside.any(|inside| inside),
            Operation::Intersection => inside.all(|inside| inside),
            Operation::Difference => inside.next() == Some(true) && !inside.any(|inside| inside),
        }
    };
    let length = line.d.length();
    let is_near = |from: f64, to: f64| {
        let size = line.o.length() + (to * length).abs();
        from == to || size.is_finite() && (to - from) * length <= SLIVER * size
    };
    // The ends of parts that are longer than slivers.
    let mut groups: Vec<Vec<(Crossing, bool)>> = Vec::new();
    for end in ends {
        match groups.last_mut() {
            Some(group) if is_near(group[0].0.t, end.0.t) => group.push(end),
            _ => groups.push(vec![end]),
        }
    }
    let mut spans = Vec::new();
    let mut start: Option<Crossing> = None;
    for (number, group) in groups.iter().enumerate() {
        let here = group[0].0.t;
        let next = groups
            .get(number + 1)
            .map_or(f64::INFINITY, |next| next[0].0.t);
        let middle = match (here.is_finite(), next.is_finite()) {
            (true, true) => (here + next) / 2.0,
            (true, false) => here + 1.0 + here.abs(),
            (false, _) => next - 1.0 - next.abs(),
        };
        let (crossing, is_cut) = group[0];
        let n = if is_cut { -crossing.n } else { crossing.n };
        let crossing = Crossing { n, ..crossing };
        match (start, holds(middle)) {
            (None, true) => start = Some(crossing),
            (Some(from), false) => {
                spans.push([from, crossing]);
                start = None;
            }
            _ => {}
        }
    }
    if let Some(from) = start {
        spans.push([from, ALL[1]]);
    }
    spans
}
