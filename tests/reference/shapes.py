"""The equations of shapes with several faces, with one rounding per operation, for evaluate.py.

Each function takes the fields of a geometry and returns a function from a ray's origin and direction
to the span of the ray inside: (t, face) where it enters and where it comes out. An open shape has two
points of its side, which may be missing. A ray that starts on some faces says so by `on`: their equations
are 0 at its origin, whatever rounding makes of them.
"""

import math

from evaluate import add, cross, divide, dot, length, negated, optional, root, scaled, subtract, unit
from evaluate import vector

import meshes

WHOLE = ((-math.inf, 0), (math.inf, 0))


def both(one, other):
    """Returns the part of a line in two spans."""
    if one is None or other is None:
        return None
    enter = one[0] if other[0][0] <= one[0][0] else other[0]
    leave = one[1] if other[1][0] >= one[1][0] else other[1]
    return (enter, leave) if enter[0] <= leave[0] else None


def between(low, high, up, faces, on=()):
    """Returns the span between two planes."""
    low, high = (0.0 if face in on else end for end, face in zip((low, high), faces))
    if up == 0.0:
        return WHOLE if low <= 0.0 <= high else None
    ends = (low / up, faces[0]), (high / up, faces[1])
    return ends if up > 0.0 else ends[::-1]


def ordered(one, other, face):
    return ((one, face), (other, face)) if one <= other else ((other, face), (one, face))


def rounded(q, d, r, face, on=()):
    """Returns the span of |q + t·d| <= r."""
    a_, h = dot(d, d), dot(q, d)
    if face in on:
        return WHOLE if a_ == 0.0 else ordered(0.0, -2.0 * h / a_, face)
    m = subtract(q, scaled(d, divide(h, a_)))
    discriminant = r * r - dot(m, m)
    c = dot(q, q) - r * r
    if a_ == 0.0:
        return WHOLE if c <= 0.0 else None
    if not discriminant >= 0.0:
        return None
    k = -(h + math.copysign(root(a_ * discriminant), h))
    return ordered(0.0, 0.0, face) if k == 0.0 else ordered(k / a_, divide(c, k), face)


class Axis:
    def __init__(self, fields):
        self.a, self.b = vector(fields["from"]), vector(fields["to"])
        self.along = subtract(self.b, self.a)
        self.w = unit(self.along)

    def across(self, v):
        return subtract(v, scaled(self.w, dot(v, self.w)))

    def span(self, o, d, on=()):
        low, high = (dot(subtract(end, o), self.w) for end in (self.a, self.b))
        return between(low, high, dot(d, self.w), (1, 2), on)


def cut(side, ends, capped):
    """Returns what the ends leave of a side."""
    if side is None or ends is None:
        return None
    if capped:
        return both(side, ends)
    return tuple(at if ends[0][0] <= at[0] <= ends[1][0] else None for at in side)


def cylinder(fields):
    axis, r = Axis(fields), fields["radius"]
    capped = optional(fields, "capped", True)

    def span(o, d, on=()):
        q = axis.across(subtract(o, axis.a))
        return cut(rounded(q, axis.across(d), r, 0, on), axis.span(o, d, on), capped)

    def normal(face, o, d, t):
        if face:
            return unit(axis.along if face == 2 else negated(axis.along))
        q = axis.across(subtract(o, axis.a))
        return unit(add(q, scaled(axis.across(d), t)))

    return span, normal


def cone(fields):
    axis, r = Axis(fields), fields["radius"]
    slope = (optional(fields, "top_radius", 0.0) - r) / length(axis.along)
    capped = optional(fields, "capped", True)

    def nappe(o, d, on):
        w = axis.w
        m = 0.0 if on else divide(dot(subtract(axis.a, o), d), dot(d, d))
        q = add(subtract(o, axis.a), scaled(d, m))
        height, rise = dot(q, w), dot(d, w)
        p, e = subtract(q, scaled(w, height)), subtract(d, scaled(w, rise))
        radius, growth = r + slope * height, slope * rise
        v, x = subtract(scaled(e, radius), scaled(p, growth)), cross(e, p)
        a_ = dot(e, e) - growth * growth
        h = dot(p, e) - radius * growth
        c = dot(p, p) - radius * radius
        discriminant = dot(v, v) - dot(x, x)
        if on:
            c, discriminant = 0.0, h * h
        if a_ == 0.0:
            if h == 0.0:
                return WHOLE if c <= 0.0 else None
            at = (m - c / (2.0 * h), 0)
            return (WHOLE[0], at) if h > 0.0 else (at, WHOLE[1])
        if discriminant < 0.0 and a_ > 0.0:
            return None
        k = -(h + math.copysign(root(max(discriminant, 0.0)), h))
        one, other = (0.0, 0.0) if k == 0.0 else (k / a_, c / k)
        low, high = (m + min(one, other), 0), (m + max(one, other), 0)
        if a_ > 0.0:
            return low, high
        if on:
            low = high = (0.0, 0)
        return (high, WHOLE[1]) if growth > 0.0 else (WHOLE[0], low)

    def span(o, d, on=()):
        return cut(nappe(o, d, 0 in on), axis.span(o, d, on), capped)

    def normal(face, o, d, t):
        if face:
            return unit(axis.along if face == 2 else negated(axis.along))
        q = axis.across(subtract(o, axis.a))
        across = add(q, scaled(axis.across(d), t))
        return unit(subtract(unit(across), scaled(axis.w, slope)))

    return span, normal


def capsule(fields):
    axis, r = Axis(fields), fields["radius"]

    def span(o, d, on=()):
        q = axis.across(subtract(o, axis.a))
        side = cut(rounded(q, axis.across(d), r, 0, on), axis.span(o, d), False)
        balls = (rounded(subtract(o, end), d, r, face, on) for end, face in ((axis.a, 1), (axis.b, 2)))
        ends = [at for part in (side, *balls) if part for at in part if at]
        if not ends:
            return None
        return min(ends, key=lambda at: at[0]), max(ends, key=lambda at: at[0])

    def normal(face, o, d, t):
        if face == 0:
            q = axis.across(subtract(o, axis.a))
            return unit(add(q, scaled(axis.across(d), t)))
        q = subtract(o, axis.a if face == 1 else axis.b)
        return unit(add(q, scaled(d, t)))

    return span, normal


def box(fields):
    low, high = vector(fields["min"]), vector(fields["max"])

    def slab(axis, o, d, on):
        faces = (2 * axis, 2 * axis + 1)
        return between(low[axis] - o[axis], high[axis] - o[axis], d[axis], faces, on)

    def span(o, d, on=()):
        return both(both(slab(0, o, d, on), slab(1, o, d, on)), slab(2, o, d, on))

    def normal(face, o, d, t):
        return tuple((2.0 * (face % 2) - 1.0) * (axis == face // 2) for axis in range(3))

    return span, normal


def ellipsoid(fields):
    center = vector(fields["center"])
    axes = [vector(axis) for axis in fields["axes"]]

    def along(v):
        return tuple(divide(dot(v, axis), dot(axis, axis)) for axis in axes)

    def span(o, d, on=()):
        return rounded(along(subtract(o, center)), along(d), 1.0, 0, on)

    def normal(face, o, d, t):
        x, y, z = add(along(subtract(o, center)), scaled(along(d), t))
        a, b, c = (tuple(divide(k, dot(axis, axis)) for k in axis) for axis in axes)
        return unit(add(add(scaled(a, x), scaled(b, y)), scaled(c, z)))

    return span, normal


def torus(fields):
    center, w = vector(fields["center"]), unit(vector(fields["axis"]))
    ring, tube = fields["radius"], fields["tube_radius"]
    ratio = tube / ring

    def span(o, d, on=()):
        q, squared = subtract(o, center), dot(d, d)
        if not 0.0 < squared < math.inf:
            return None
        length = root(squared)
        middle = -dot(q, d) / squared
        p = tuple(x / ring for x in add(q, scaled(d, middle)))
        u = tuple(x / length for x in d)
        k, h, g = dot(p, p), dot(p, w), dot(u, w)
        if not k < 4.0:
            return None
        outer = k + 1.0 - ratio * ratio
        quartic = [1.0, 0.0, 2.0 * outer - 4.0 * (1.0 - g * g), 8.0 * h * g]
        quartic.append(outer * outer - 4.0 * (k - h * h))
        found = sorted(z.real for z in zeros(quartic) if abs(z.imag) < 1e-7)
        found = [middle + s * (ring / length) for s in found]
        if on and found:
            found[min(range(len(found)), key=lambda at: abs(found[at]))] = 0.0
        return [(t, 0) for t in found]

    def normal(face, o, d, t):
        p = add(subtract(o, center), scaled(d, t))
        across = subtract(p, scaled(w, dot(p, w)))
        return unit(subtract(p, scaled(unit(across), ring)))

    return span, normal


def zeros(polynomial):
    """Returns all zeros of a polynomial by the method of Durand and Kerner."""
    found = [(0.4 + 0.9j) ** power for power in range(len(polynomial) - 1)]
    for _ in range(200):
        most = 0.0
        for at, z in enumerate(found):
            value = 0.0
            for factor in polynomial:
                value = value * z + factor
            for other, zero in enumerate(found):
                if other != at:
                    value /= z - zero or 1e-300
            found[at] = z - value
            most = max(most, abs(value))
        if most < 1e-16:
            break
    return found


def edges(corners, o, d):
    """Returns the t at which a line meets a triangle, or None."""
    at = shares(corners, o, d)
    return None if at is None else at[0]


def shares(corners, o, d):
    """Returns the t at which a line meets a triangle and the weights of its corners, or None."""
    size = [abs(x) for x in d]
    z = max(range(3), key=lambda axis: size[axis])
    x, y = (z + 1) % 3, (z + 2) % 3
    if d[z] < 0.0:
        x, y = y, x
    if d[z] == 0.0:
        return None
    sx, sy, sz = d[x] / d[z], d[y] / d[z], 1.0 / d[z]
    moved = [subtract(corner, o) for corner in corners]
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (
        (p[x] - sx * p[z], p[y] - sy * p[z], sz * p[z]) for p in moved
    )
    u, v, w = cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax
    if min(u, v, w) < 0.0 < max(u, v, w):
        return None
    total = (u + v) + w
    if total == 0.0:
        return None
    return ((u * az + v * bz) + w * cz) / total, (u / total, v / total, w / total)


def triangle(fields):
    a, b, c = (vector(fields[name]) for name in "abc")
    n = unit(cross(subtract(b, a), subtract(c, a)))

    def span(o, d, on=()):
        t = None if on else edges((a, b, c), o, d)
        return None if t is None else ((t, 0), None)

    return span, lambda face, o, d, t: n


def faces_of(fields):
    """Returns the corners of each triangle of a mesh."""
    vertices = [vector(vertex) for vertex in fields["vertices"]]
    return [[vertices[int(corner)] for corner in corners] for corners in fields["triangles"]]


def mesh(fields):
    faces = faces_of(fields)

    def long_normal(a, b, c):
        return cross(subtract(b, a), subtract(c, a))

    def span(o, d):
        found = []
        for face, corners in enumerate(faces):
            n = long_normal(*corners)
            t = edges(corners, o, d) if 0.0 < dot(n, n) < math.inf else None
            if t is not None and not math.isnan(t):
                found.append((t, face))
        return sorted(found)

    return span, lambda face, o, d, t: unit(long_normal(*faces[face]))


def rectangle(fields):
    a, u, v = (vector(fields[name]) for name in ("corner", "edge_u", "edge_v"))
    opposite = add(add(a, u), v)
    halves = [(a, add(a, u), opposite), (a, opposite, add(a, v))]
    n = unit(cross(u, v))

    def span(o, d, on=()):
        above, down = dot(subtract(a, o), n), dot(d, n)
        if on or down == 0.0 or all(edges(half, o, d) is None for half in halves):
            return None
        return ((divide(above, down), 0), None)

    return span, lambda face, o, d, t: n


SOLIDS = {
    "Rectangle": rectangle,
    "Triangle": triangle,
    "Mesh": mesh,
    "Box": box,
    "Cylinder": cylinder,
    "Cone": cone,
    "Capsule": capsule,
    "Ellipsoid": ellipsoid,
    "Torus": torus,
}


def crossing(span, o, d):
    """Returns the first t in front of the origin, and its face."""
    for at in span(o, d) or ():
        if at is not None and 0.0 < at[0] < math.inf:
            return at
    return None


def shape(make):
    """Returns the reader of a shape for evaluate.py: its hit knows its normal."""

    def of(fields):
        span, normal = make(fields)

        def hit(o, d):
            at = crossing(span, o, d)
            return None if at is None else at[0]

        def color(o, d):
            _, face = crossing(span, o, d)
            _, weights = shares(faces_of(fields)[face], o, d)
            return meshes.color(fields, fields["triangles"][face], weights)

        hit.normal = lambda o, d, t: normal(crossing(span, o, d)[1], o, d, t)
        if "of_vertices" in fields:
            hit.color = color
        return hit

    return of


SHAPES = {name: shape(make) for name, make in SOLIDS.items()}


def refusal(name, fields):
    """Returns the code of an error in the fields of one of these shapes, if any."""

    def bad(a):
        return not 0.0 < dot(a, a) < math.inf

    if name in ("Cylinder", "Cone", "Capsule"):
        if not fields["radius"] > 0.0 or not optional(fields, "top_radius", 0.0) >= 0.0:
            return "out-of-range"
        if bad(subtract(vector(fields["to"]), vector(fields["from"]))):
            return "zero-vector"
    if name == "Box" and any(not b > a for a, b in zip(fields["min"], fields["max"])):
        return "out-of-range"
    if name == "Rectangle":
        u, v = vector(fields["edge_u"]), vector(fields["edge_v"])
        if bad(u) or bad(v):
            return "zero-vector"
        if bad(cross(u, v)):
            return "parallel-vectors"
    if name == "Triangle":
        a, b, c = (vector(fields[corner]) for corner in "abc")
        if bad(cross(subtract(b, a), subtract(c, a))):
            return "zero-vector" if a in (b, c) or b == c else "parallel-vectors"
    if name == "Mesh":
        if not fields["triangles"]:
            return "wrong-type"
        corners = [corner for corners in fields["triangles"] for corner in corners]
        if any(corner >= len(fields["vertices"]) for corner in corners):
            return "out-of-range"
    if name == "Torus":
        if not 0.0 < fields["tube_radius"] < fields["radius"]:
            return "out-of-range"
        if bad(vector(fields["axis"])):
            return "zero-vector"
    if name == "Ellipsoid":
        axes = [vector(axis) for axis in fields["axes"]]
        if any(bad(axis) for axis in axes):
            return "zero-vector"
        pairs = (axes[:2], axes[::2], axes[1:])
        if any(abs(dot(unit(a), unit(b))) > 1e-5 for a, b in pairs):
            return "out-of-range"
    return None
