"""The shapes of light.py: where rays cross them, for many rays at once, and the equations of their faces.

The faces of a shape have numbers, those of shapes.py. `ends(o, d, on)` returns the t of the crossings in
their order and the numbers of their faces: a row for each crossing, NaN where there is none. `on` has a row
for each face: whether the rays start on it, so that its equation is 0 there. Of a solid, each ray enters at
even rows and leaves at odd ones.
"""

import math

import numpy as np

import evaluate
import meshes
import shapes
import solids
from evaluate import optional, variant

# The part of a number by which it may be wrong: 16 roundings.
EPSILON = 2.0**-48


def dots(a, b):
    return np.sum(a * b, axis=-1)


def units(a):
    return a / np.linalg.norm(a, axis=-1, keepdims=True)


# ---------------------------------------------------------------------------------------------
# Faces
# ---------------------------------------------------------------------------------------------


class Face:
    """The equation f = 0 of a face.

    `equation(p)` returns f and its gradient G, which points outward, at points in the space of the shape.
    `edges(p)` are the distances from its edges, positive inside, and the directions into the face.
    """

    def __init__(self, size, equation, edges=lambda p: [], center=None):
        self.size, self.equation, self.edges, self.center = size, equation, edges, center
        self.maps, self.back, self.moved = [], np.eye(3), np.zeros(3)
        self.is_cut, self.smooth, self.light = False, None, None

    def placed(self, matrix):
        """Maps the face by a matrix after those before."""
        back, shift = np.array(evaluate.inverse(matrix)), np.array([row[3] for row in matrix])
        self.maps.insert(0, (back, shift))
        self.back, self.moved = self.back @ back, self.moved + np.abs(shift)

    def local(self, p):
        for back, shift in self.maps:
            p = (p - shift) @ back.T
        return p

    def gradient(self, p):
        """Returns N, the gradient in the world."""
        gradient = self.mapped(self.equation(self.local(p))[1])
        return -gradient if self.is_cut else gradient

    def mapped(self, gradient):
        """Returns a gradient in the world. A product of matrices would choose the signs of zeros by itself."""
        for back, _ in reversed(self.maps):
            x, y, z = (gradient[:, axis, None] * row for axis, row in enumerate(back))
            gradient = x + y + z
        return gradient

    def normal(self, p, d):
        """Returns the unit normal that light sees."""
        flat = units(self.gradient(p))
        if self.smooth is None:
            return flat
        # It is turned to the side of the face before it is mapped.
        mean, inner = self.smooth(self.local(p)), d @ self.back.T
        turned = mean - (1.0 + 2.0**-10) * (dots(mean, inner) / dots(inner, inner))[:, None] * inner
        mean, turned = self.mapped(mean), self.mapped(turned)
        is_right = (dots(mean, d) < 0.0) == (dots(flat, d) < 0.0)
        return units(np.where(is_right[:, None], mean, turned))

    def distance(self, p):
        f, gradient = self.equation(self.local(p))
        return np.abs(f) / np.linalg.norm(gradient @ self.back, axis=-1)

    def errors(self, p):
        """Returns how far the coordinates of points may be off in the space of the shape."""
        of_mapping = (np.abs(p) + self.moved) @ np.abs(self.back).T if self.maps else 0.0
        return EPSILON * (np.abs(self.local(p)) + self.size + of_mapping)

    def slack(self, p, r):
        """Returns τ, by which the extent is widened."""
        return r * (np.linalg.norm(self.back) if self.maps else 1.0) + self.errors(p).sum(axis=-1)

    def touches(self, p, r, o):
        """Returns which points lie on the face, each of which a ray from o found up to r."""
        f, gradient = self.equation(self.local(p))
        bound = r * np.linalg.norm(gradient @ self.back, axis=-1)
        bound = bound + dots(np.abs(gradient), self.errors(p))
        if self.center is not None:
            q = self.local(o) - self.center
            bound = bound + 2.0**-50 * dots(q, q)
        near = np.abs(f) <= bound
        rows = np.flatnonzero(near)
        if len(rows):
            for distance, _ in self.edges(self.local(p[rows])):
                near[rows] &= distance >= -self.slack(p[rows], r[rows])
        return near


def flat(a, n, edges=lambda p: []):
    n = units(np.array(n, float))
    return Face(np.abs(a), lambda p: ((p - a) @ n, np.broadcast_to(n, p.shape)), edges)


def round_edge(center, radius):
    def edges(p):
        q = p - center
        away = np.linalg.norm(q, axis=-1)
        return [(radius - away, -q / away[:, None])]

    return edges


def straight_edges(corners, n):
    """Returns the edges of a polygon, counterclockwise around its normal."""
    inward = [units(np.cross(n, b - a)) for a, b in zip(corners, corners[1:] + corners[:1])]

    def edges(p):
        return [((p - a) @ m, np.broadcast_to(m, p.shape)) for a, m in zip(corners, inward)]

    return edges


def ball(center, radius):
    def equation(p):
        q = p - center
        return dots(q, q) - radius * radius, 2.0 * q

    return Face(np.abs(center) + radius, equation)


def mantle(a, b, radius, slope, is_endless=False):
    tall = np.linalg.norm(b - a)
    w = (b - a) / tall

    def equation(p):
        height = (p - a) @ w
        across = p - a - height[:, None] * w
        away = np.linalg.norm(across, axis=-1)
        # At the tip of a cone, there is no way across.
        outward = across / np.maximum(away, 1e-300)[:, None]
        return away - (radius + slope * height), outward - slope * w

    def edges(p):
        height = (p - a) @ w
        return [(height, np.broadcast_to(w, p.shape)), (tall - height, np.broadcast_to(-w, p.shape))]

    return Face(np.abs(a) + np.abs(b) + radius, equation, (lambda p: []) if is_endless else edges)


def box_face(low, high, axis, is_high):
    n = np.eye(3)[axis] * (1.0 if is_high else -1.0)

    def edges(p):
        others = [other for other in range(3) if other != axis]
        below = [(p[:, other] - low[other], np.eye(3)[other]) for other in others]
        return below + [(high[other] - p[:, other], -np.eye(3)[other]) for other in others]

    return flat(high if is_high else low, n, edges)


def ellipsoid(center, axes):
    squared = (axes * axes).sum(axis=1)

    def equation(p):
        along = (p - center) @ axes.T / squared
        return dots(along, along) - 1.0, 2.0 * (along / squared) @ axes

    return Face(np.abs(center) + np.abs(axes).sum(axis=0), equation)


def torus(center, axis, radius, tube):
    w = units(axis)

    def equation(p):
        q = p - center
        across = q - (q @ w)[:, None] * w
        from_ring = q - radius * units(across)
        away = np.linalg.norm(from_ring, axis=-1)
        return away - tube, from_ring / away[:, None]

    return Face(np.abs(center) + radius + tube, equation)


def faces_of(name, fields):
    """Returns the faces of a shape in the order of their numbers."""

    def place(field):
        return np.array(fields[field], float)

    if name == "Sphere":
        face = ball(place("center"), fields["radius"])
        face.center = place("center")
        return [face]
    if name == "Plane":
        return [flat(place("point"), fields["normal"])]
    if name == "Disc":
        edge = round_edge(place("center"), fields["radius"])
        return [flat(place("center"), fields["normal"], edge)]
    if name in ("Rectangle", "Triangle"):
        if name == "Rectangle":
            a, u, v = place("corner"), place("edge_u"), place("edge_v")
            corners = [a, a + u, a + u + v, a + v]
        else:
            corners = [place(corner) for corner in "abc"]
        n = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        return [flat(corners[0], n, straight_edges(corners, n))]
    if name == "Box":
        low, high = place("min"), place("max")
        return [box_face(low, high, axis, is_high) for axis in range(3) for is_high in (False, True)]
    if name == "Ellipsoid":
        return [ellipsoid(place("center"), place("axes"))]
    if name == "Torus":
        return [torus(place("center"), place("axis"), fields["radius"], fields["tube_radius"])]
    a, b, radius = place("from"), place("to"), fields["radius"]
    if name == "Capsule":
        return [mantle(a, b, radius, 0.0, is_endless=True), ball(a, radius), ball(b, radius)]
    top = radius if name == "Cylinder" else optional(fields, "top_radius", 0.0)
    side = mantle(a, b, radius, (top - radius) / np.linalg.norm(b - a))
    caps = [flat(a, -(b - a), round_edge(a, radius)), flat(b, b - a, round_edge(b, top))]
    return [side] if fields.get("capped") is False else [side, *caps]


# ---------------------------------------------------------------------------------------------
# Shapes
# ---------------------------------------------------------------------------------------------


def positive(t):
    """Returns t, infinity where there is no hit."""
    return np.where((t > 0.0) & (t < math.inf), t, math.inf)


class Shape:
    """A shape with faces. A thin one has no inside; of these, glass panes do not bend light."""

    def __init__(self, name, fields):
        self.faces = faces_of(name, fields)
        self.is_pane = name in ("Plane", "Disc", "Rectangle", "Triangle")
        self.is_thin = self.is_pane or fields.get("capped") is False

    def is_inside(self, o, d, on, is_behind):
        """Returns which rays are inside right behind their origins, or right before."""
        t, _ = self.ends(o, d, on)
        enter, leave = t[::2], t[1::2]
        behind = (enter <= 0.0) & (0.0 < leave)
        before = (enter < 0.0) & (0.0 <= leave)
        return np.where(is_behind, behind, before).any(axis=0)


class Ball(Shape):
    def __init__(self, fields):
        super().__init__("Sphere", fields)
        self.center = np.array(fields["center"], float)
        self.radius = float(fields["radius"])

    def ends(self, o, d, on):
        oc = o - self.center
        a, b = dots(d, d), 2.0 * dots(oc, d)
        s = np.sqrt(b * b - 4.0 * a * (dots(oc, oc) - self.radius * self.radius))
        far = -b / a
        t = [np.where(on[0], np.minimum(far, 0.0), (-b - s) / (2.0 * a))]
        t.append(np.where(on[0], np.maximum(far, 0.0), (-b + s) / (2.0 * a)))
        return np.array(t), np.zeros((2, len(o)), int)


class Flat(Shape):
    """A plane, or a disc if it has a radius."""

    def __init__(self, fields):
        super().__init__("Disc" if "radius" in fields else "Plane", fields)
        self.point = np.array(fields["center"] if "center" in fields else fields["point"], float)
        self.long_normal = np.array(fields["normal"], float)
        self.radius = float(fields.get("radius", math.inf))

    def ends(self, o, d, on):
        t = np.where(on[0], 0.0, self.crossing(o, d))
        p = o + t[:, None] * d
        inside = dots(p - self.point, p - self.point) <= self.radius * self.radius
        return np.where(inside, t, math.nan)[None], np.zeros((1, len(o)), int)

    def crossing(self, o, d):
        below = dots(d, self.long_normal)
        return np.where(below == 0.0, math.nan, dots(self.point - o, self.long_normal) / below)


class Half(Flat):
    """The half of space behind a plane, as a part of a solid."""

    def __init__(self, fields):
        super().__init__(fields)
        self.is_pane = self.is_thin = False

    def ends(self, o, d, on):
        up = dots(d, self.long_normal)
        t = np.where(on[0], 0.0, self.crossing(o, d))
        never = (up == 0.0) & ~on[0] & (dots(self.point - o, self.long_normal) < 0.0)
        enter = np.where(up < 0.0, t, np.where(never, math.nan, -math.inf))
        leave = np.where(up > 0.0, t, np.where(never, math.nan, math.inf))
        return np.array([enter, leave]), np.zeros((2, len(o)), int)


class Solid(Shape):
    """A shape that shapes.py knows."""

    def __init__(self, name, fields):
        super().__init__(name, fields)
        self.span, _ = shapes.SOLIDS[name](fields)

    def ends(self, o, d, on):
        t, number = np.full((4, len(o)), math.nan), np.zeros((4, len(o)), int)
        starts = on.any(axis=0)
        for row, (origin, direction) in enumerate(zip(o.tolist(), d.tolist())):
            own = np.flatnonzero(on[:, row]).tolist() if starts[row] else ()
            for at, end in enumerate(self.span(origin, direction, own) or ()):
                if end is not None:
                    t[at, row], number[at, row] = end
        return t, number


class Placed(Shape):
    """A shape that is mapped by a matrix."""

    def __init__(self, matrix, inner):
        self.inner, self.faces = inner, inner.faces
        self.is_pane, self.is_thin = inner.is_pane, inner.is_thin
        self.shift = np.array([row[3] for row in matrix])
        self.back = np.array(evaluate.inverse(matrix))
        for face in self.faces:
            face.placed(matrix)

    def ends(self, o, d, on):
        return self.inner.ends((o - self.shift) @ self.back.T, d @ self.back.T, on)


class Combined(Shape):
    """A solid that is put together from others. Its faces are those of its parts."""

    is_pane = is_thin = False

    def __init__(self, name, fields):
        self.faces, self.parts, self.surfaces = [], [], []
        self.tree = self.node(name, fields, False, {})

    def node(self, name, fields, is_cut, around):
        """Returns the number of a part, or how nodes are put together."""
        own = {key: fields[key] for key in ("color", "material") if fields.get(key) is not None} or around
        if name in solids.COMBINED:
            operands = [variant(operand) for operand in solids.operands_of(name, fields)]
            cuts = [is_cut != (name == "Difference" and at > 0) for at in range(len(operands))]
            return solids.KEEPS[name], [self.node(*o, cut, own) for o, cut in zip(operands, cuts)]
        part = shape_of("Half" if name == "Plane" else name, fields)
        for face in part.faces:
            face.is_cut = is_cut
        self.parts.append((part, len(self.faces)))
        self.faces += part.faces
        self.surfaces += [own] * len(part.faces)
        return len(self.parts) - 1

    def ends(self, o, d, on):
        of_parts = []
        for part, first in self.parts:
            t, number = part.ends(o, d, on[first : first + len(part.faces)])
            of_parts.append((t.T.tolist(), (number + first).T.tolist()))
        shape = 4 * len(self.parts), len(o)
        t, number = np.full(shape, math.nan), np.zeros(shape, int)
        for row in range(len(o)):
            ends = [end for pair in intervals(self.tree, of_parts, row) for end in pair]
            for at, end in enumerate(ends):
                t[at, row], number[at, row] = end
        return t, number


def intervals(node, of_parts, row):
    """Returns the intervals of a ray inside a node of a tree."""
    if isinstance(node, int):
        ends = list(zip(*(values[row] for values in of_parts[node])))
        return [pair for pair in zip(ends[::2], ends[1::2]) if pair[0][0] < pair[1][0]]
    keep, operands = node
    found, *others = (intervals(operand, of_parts, row) for operand in operands)
    for other in others:
        found = solids.merged(found, other, keep)
    return found


SHAPES = {"Sphere": Ball, "Plane": Flat, "Disc": Flat, "Half": Half}


def shape_of(name, fields):
    if "placed" in fields:
        bare = {key: fields[key] for key in fields if key != "placed"}
        return Placed(fields["placed"], shape_of(name, bare))
    if name in solids.COMBINED:
        return Combined(name, fields)
    return SHAPES[name](fields) if name in SHAPES else Solid(name, fields)


def triangles_of(fields):
    """Returns the shapes of the triangles of a mesh."""
    corners = [dict(zip("abc", face)) for face in shapes.faces_of(fields)]
    has_area = [shapes.refusal("Triangle", each) is None for each in corners]
    numbers = [face for face, has in zip(fields["triangles"], has_area) if has]
    corners = [each for each, has in zip(corners, has_area) if has]
    made = [Solid("Triangle", each) for each in corners]
    points = [[np.array(each[corner], float) for corner in "abc"] for each in corners]
    normals = np.zeros((len(fields["vertices"]), 3))
    for face, (a, b, c) in zip(numbers, points):
        for corner in set(face):
            normals[int(corner)] += np.cross(b - a, c - a)
    for shape, face, at in zip(made, numbers, points):
        shape.is_pane = False
        if "of_vertices" in fields:
            shape.faces[0].light = vertex_colors(fields, face, at)
        if fields.get("smooth"):
            shape.faces[0].smooth = mean_of(at, [units(normals[int(corner)]) for corner in face])
        if "placed" in fields:
            yield Placed(fields["placed"], shape)
        else:
            yield shape


def weights(corners, p):
    """The shares of the corners, from the areas between the point and two of them each."""
    a, b, c = corners
    sides = [(b - p, c - p), (c - p, a - p), (a - p, b - p)]
    areas = [dots(np.cross(u, v), np.cross(b - a, c - a))[:, None] for u, v in sides]
    return [area / sum(areas) for area in areas]


def mean_of(corners, values):
    return lambda p: sum(share * value for share, value in zip(weights(corners, p), values))


def vertex_colors(fields, face, corners):
    """Returns the display colors at points, from those of the vertices."""

    def colors(p):
        shares = np.concatenate(weights(corners, p), axis=1)
        return [meshes.color(fields, face, each) for each in shares]

    return colors


def colors_of(shape, fields):
    """Returns the fields with the color or the material of each face of a geometry's shape."""
    while isinstance(shape, Placed):
        shape = shape.inner
    return shape.surfaces if isinstance(shape, Combined) else [fields] * len(shape.faces)
