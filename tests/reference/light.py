#!/usr/bin/env python3
"""Evaluates lit scenes, antialiasing and outlines, and compares the result with pictures.

    light.py tests/golden                every scene below a folder with the .png of the same stem
    light.py scene.ron --picture a.png   one scene with a picture of any name
    light.py scene.ron --write a.ppm     only writes the result of the equations

This shares nothing with the renderer: it follows the text of the scene format, for all rays of a
depth at once, with numpy. Sums and products are not in the order of the renderer, and powers differ
between mathematical libraries. So a picture is right if all but 0.1 % of its pixels are at most
one level off.
"""

import argparse
import math
import os
import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np

import evaluate
import meshes
import shapes
import solids
from evaluate import optional, variant

# A ray that brings less than this to the picture, even from the brightest light, is black.
FAINT = 2.0**-12
# A shadow ray to a point ends before the surface that the light lies on.
BEFORE_LIGHT = 1.0 - 2.0**-32
# The share of pixels that may be more than one level off.
TOLERATED = 0.001


def display(color):
    """Returns a color as display values in 0..1."""
    if isinstance(color, str):
        return np.array([byte / 255.0 for byte in evaluate.color_bytes(color)])
    return np.clip(np.array(color, float), 0.0, 1.0)


def lin(color):
    c = display(color)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def inverse(light):
    safe = np.maximum(light, 0.0031308)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * safe ** (1.0 / 2.4) - 0.055)


def dots(a, b):
    return np.sum(a * b, axis=-1)


def units(a):
    return a / np.linalg.norm(a, axis=-1, keepdims=True)


# ---------------------------------------------------------------------------------------------
# Geometries: `roots` are the t of all crossings, the near one first
# ---------------------------------------------------------------------------------------------


class Ball:
    is_pane = False

    def __init__(self, fields):
        self.center = np.array(fields["center"], float)
        self.radius = float(fields["radius"])

    def roots(self, o, d, own):
        oc = o - self.center
        a, b = dots(d, d), 2.0 * dots(oc, d)
        # On the surface that a ray leaves, the constant term is 0.
        c = np.where(own, 0.0, dots(oc, oc) - self.radius * self.radius)
        s = np.sqrt(b * b - 4.0 * a * c)
        near = np.where(own, np.nan, (-b - s) / (2.0 * a))
        far = np.where(own, -b / a, (-b + s) / (2.0 * a))
        return [positive(near), positive(far)]

    def normal(self, p, d):
        return units(p - self.center)

    def planes(self):
        return []

    def same(self, other):
        return (
            isinstance(other, Ball)
            and self.radius == other.radius
            and np.array_equal(self.center, other.center)
        )


class Flat:
    """A plane, or a disc if it has a radius."""

    is_pane = True

    def __init__(self, fields):
        self.point = np.array(fields["center"] if "center" in fields else fields["point"], float)
        self.long_normal = np.array(fields["normal"], float)
        self.radius = float(fields.get("radius", math.inf))

    def roots(self, o, d, own):
        below = dots(d, self.long_normal)
        t = dots(self.point - o, self.long_normal) / below
        p = o + t[:, None] * d
        inside = dots(p - self.point, p - self.point) <= self.radius * self.radius
        return [positive(np.where((below != 0.0) & inside & ~own, t, np.nan))]

    def normal(self, p, d):
        return np.broadcast_to(units(self.long_normal), p.shape)

    def planes(self):
        return [(self.point, units(self.long_normal))]

    def same(self, other):
        return (
            isinstance(other, Flat)
            and not np.any(np.cross(self.long_normal, other.long_normal))
            and dots(self.point - other.point, self.long_normal) == 0.0
        )


def positive(t):
    """Returns t, infinity where there is no hit."""
    return np.where((t > 0.0) & (t < math.inf), t, math.inf)


class Patch(Flat):
    """A rectangle or a triangle."""

    def __init__(self, name, fields):
        self.span, normal = shapes.SOLIDS[name](fields)
        corner = fields["corner"] if name == "Rectangle" else fields["a"]
        self.point = np.array(corner, float)
        edges = ("edge_u", "edge_v") if name == "Rectangle" else ("b", "c")
        u, v = (np.array(fields[edge], float) for edge in edges)
        shift = 0.0 if name == "Rectangle" else self.point
        self.long_normal = np.cross(u - shift, v - shift)

    def roots(self, o, d, own):
        t = np.full(len(o), np.nan)
        for row in np.flatnonzero(~own):
            span = self.span(tuple(map(float, o[row])), tuple(map(float, d[row])))
            t[row] = span[0][0] if span else np.nan
        return [positive(t)]


class Facet(Patch):
    """A triangle of a mesh; of a smooth one, with the normals of its corners."""

    is_pane = False

    def __init__(self, fields):
        super().__init__("Triangle", fields)
        self.corners = [np.array(fields[corner], float) for corner in "abc"]
        self.smooth = None
        self.mesh, self.face = None, None

    def weights(self, p):
        """The shares of the corners, from the areas between the point and two of them each."""
        a, b, c = self.corners
        sides = [(b - p, c - p), (c - p, a - p), (a - p, b - p)]
        areas = [dots(np.cross(u, v), self.long_normal)[:, None] for u, v in sides]
        return [area / sum(areas) for area in areas]

    def light(self, p):
        """Returns the linear first colors at some points, from those of the vertices."""
        weights = np.concatenate(self.weights(p), axis=1)
        return lin([meshes.color(self.mesh, self.face, each) for each in weights])

    def normal(self, p, d):
        flat = super().normal(p, d)
        if self.smooth is None:
            return flat
        mean = sum(share * n for share, n in zip(self.weights(p), self.smooth))
        along = (dots(mean, d) / dots(d, d))[:, None] * d
        turned = mean - (1.0 + 2.0**-10) * along
        is_right = (dots(mean, d) < 0.0) == (dots(flat, d) < 0.0)
        return units(np.where(is_right[:, None], mean, turned))


def facets(fields):
    corners = [dict(zip("abc", face)) for face in shapes.faces_of(fields)]
    has_area = [shapes.refusal("Triangle", each) is None for each in corners]
    made = [Facet(each) for each, has in zip(corners, has_area) if has]
    numbers = [face for face, has in zip(fields["triangles"], has_area) if has]
    if "of_vertices" in fields:
        for facet, face in zip(made, numbers):
            facet.mesh, facet.face = fields, face
    if fields.get("smooth"):
        sums = np.zeros((len(fields["vertices"]), 3))
        for facet, face in zip(made, numbers):
            for corner in set(face):
                sums[int(corner)] += facet.long_normal
        for facet, face in zip(made, numbers):
            facet.smooth = [units(sums[int(corner)]) for corner in face]
    return made


class Solid:
    """A shape with an inside, or an open one. It knows its faces by the place of a point."""

    is_pane = False

    def __init__(self, name, fields):
        others = ("color", "material", "name", "placed")
        self.name = name
        self.fields = {field: fields[field] for field in fields if field not in others}
        self.span, _ = shapes.SOLIDS[name](fields)
        self.is_open = fields.get("capped") is False

    def roots(self, o, d, own):
        both = np.full((4, len(o)), np.nan)
        for row in range(len(o)):
            span = self.span(tuple(map(float, o[row])), tuple(map(float, d[row])))
            if span:
                both[: len(span), row] = [math.nan if at is None else at[0] for at in span]
        # A ray leaves from the end that is nearest to its start: it does not meet that one again,
        # nor the other one of a convex shape unless it comes out there.
        far = np.nan_to_num(np.abs(both), nan=math.inf)
        left = far.argmin(axis=0)
        both[left[own], np.flatnonzero(own)] = np.nan
        if not self.is_open and self.name != "Torus":
            both[0, own] = np.nan
        return [positive(t) for t in both]

    def normal(self, p, d):
        return units(np.array([self.normal_at(point) for point in p]).reshape(-1, 3))

    def normal_at(self, p):
        fields = {k: np.array(v, float) for k, v in self.fields.items() if isinstance(v, (list, tuple))}
        if self.name == "Box":
            below, above = np.abs(p - fields["min"]), np.abs(p - fields["max"])
            axis = np.minimum(below, above).argmin()
            return (1.0 if above[axis] < below[axis] else -1.0) * np.eye(3)[axis]
        if self.name == "Ellipsoid":
            axes = fields["axes"]
            squared = (axes * axes).sum(axis=1)
            along = (axes @ (p - fields["center"])) / squared
            return (along / squared) @ axes
        if self.name == "Torus":
            w, q = units(fields["axis"]), p - fields["center"]
            across = q - (q @ w) * w
            return q - self.fields["radius"] * units(across)
        along = fields["to"] - fields["from"]
        tall = math.sqrt(along @ along)
        w = along / tall
        q = p - fields["from"]
        height = q @ w
        across = q - height * w
        if self.name == "Capsule":
            return q if height < 0.0 else (p - fields["to"] if height > tall else across)
        radius = self.fields["radius"]
        slope = 0.0
        if self.name == "Cone":
            slope = (optional(self.fields, "top_radius", 0.0) - radius) / tall
        away = math.sqrt(across @ across)
        beside = abs(away - (radius + slope * height)) / math.hypot(1.0, slope)
        if not self.is_open and min(abs(height), abs(height - tall)) < beside:
            return -w if abs(height) < abs(height - tall) else w
        return across / away - slope * w

    def planes(self):
        """Returns a point and the unit normal of each flat face."""
        if self.name == "Box":
            corners = (np.array(self.fields[corner], float) for corner in ("min", "max"))
            return [(corner, axis) for corner in corners for axis in np.eye(3)]
        if self.name in ("Cylinder", "Cone") and not self.is_open:
            ends = [np.array(self.fields[end], float) for end in ("from", "to")]
            return [(end, units(ends[1] - ends[0])) for end in ends]
        return []

    def same(self, other):
        return isinstance(other, Solid) and (self.name, self.fields) == (other.name, other.fields)


class Placed:
    """A shape that is mapped by a matrix."""

    def __init__(self, matrix, inner):
        self.matrix, self.inner, self.is_pane = matrix, inner, inner.is_pane
        self.shift = np.array([row[3] for row in matrix])
        self.back = np.array(evaluate.inverse(matrix))

    def roots(self, o, d, own):
        return self.inner.roots((o - self.shift) @ self.back.T, d @ self.back.T, own)

    def normal(self, p, d):
        normal = self.inner.normal((p - self.shift) @ self.back.T, d @ self.back.T)
        return units(normal @ self.back)

    def planes(self):
        return []

    def same(self, other):
        is_placed = isinstance(other, Placed) and self.matrix == other.matrix
        return is_placed and self.inner.same(other.inner)


class Whole:
    """A solid that is put together from others: its parts, and the ends of the lines inside."""

    def __init__(self, name, fields):
        # The shape of each part, whether it is cut away, and the fields of its color.
        self.parts = []
        self.numbers = self.numbered(name, fields, False, {})
        self.intervals = solids.intervals_of(*self.numbers)
        self.last = None

    def numbered(self, name, fields, is_cut, around):
        """Returns a solid whose parts have numbers from 1 in place of colors."""
        own = {key: fields[key] for key in ("color", "material") if fields.get(key) is not None} or around
        bare = {key: fields[key] for key in fields if key not in ("color", "material")}
        if name not in solids.COMBINED:
            self.parts.append((shape_of(name, bare), is_cut, own))
            return name, bare | {"color": len(self.parts)}

        def operand(value, is_cut):
            return dict([self.numbered(*variant(value), is_cut, own)])

        if name != "Difference":
            return name, bare | {"of": [operand(each, is_cut) for each in fields["of"]]}
        of = operand(fields["of"], is_cut)
        return name, bare | {"of": of, "minus": [operand(each, not is_cut) for each in fields["minus"]]}

    def ends(self, o, d):
        """Returns the t at which each ray may cross each part where the whole ends, at most four."""
        if self.last is None or self.last[0] is not o or self.last[1] is not d:
            found = np.full((len(self.parts), 4, len(o)), np.nan)
            for row in range(len(o)):
                spans = self.intervals(tuple(map(float, o[row])), tuple(map(float, d[row])), None)
                for t, number in (end for span in spans for end in span):
                    of_part = found[number - 1, :, row]
                    of_part[np.isnan(of_part).argmax()] = t
            self.last = o, d, found
        return self.last[2]


class Piece:
    """A part of a solid that is put together, where the whole ends."""

    is_pane = False

    def __init__(self, whole, number):
        self.whole, self.number = whole, number
        self.part, self.is_cut, _ = whole.parts[number]

    def roots(self, o, d, own):
        return [at_start(positive(t), own) for t in self.whole.ends(o, d)[self.number]]

    def normal(self, p, d):
        normal = self.part.normal(p, d)
        return -normal if self.is_cut else normal

    def planes(self):
        return self.part.planes()

    def same(self, other):
        return self.touches(other) and self.number == other.number

    def touches(self, other):
        """Returns true if both belong to the same solid, or to equal ones."""
        return isinstance(other, Piece) and self.whole.numbers == other.whole.numbers


def at_start(t, own):
    """Returns t without what a ray meets where it starts."""
    return np.where(own & (t < 1e-9), math.inf, t)


def pieces(name, fields):
    """Returns the parts of a solid that is put together from others, each with the fields of its color."""
    whole = Whole(name, {key: fields[key] for key in fields if key != "placed"})
    for number, (_, _, surface) in enumerate(whole.parts):
        piece = Piece(whole, number)
        yield (Placed(fields["placed"], piece) if "placed" in fields else piece), surface


def touch(one, other):
    """Returns true if a solid has a face in the plane of another shape's, or belongs to the same."""
    while isinstance(one, Placed) and isinstance(other, Placed) and one.matrix == other.matrix:
        one, other = one.inner, other.inner
    if isinstance(one, Piece) and one.touches(other):
        return True
    if not any(isinstance(shape, (Solid, Piece)) for shape in (one, other)):
        return False
    return any(
        np.allclose(np.cross(n, m), 0.0) and abs(dots(p - q, m)) < 1e-12
        for p, n in one.planes()
        for q, m in other.planes()
    )


SHAPES = {"Sphere": Ball, "Plane": Flat, "Disc": Flat}


def shape_of(name, fields):
    if "placed" in fields:
        bare = {key: fields[key] for key in fields if key != "placed"}
        return Placed(fields["placed"], shape_of(name, bare))
    if name in SHAPES:
        return SHAPES[name](fields)
    return (Patch if name in ("Rectangle", "Triangle") else Solid)(name, fields)


# ---------------------------------------------------------------------------------------------
# Materials
# ---------------------------------------------------------------------------------------------


class Material:
    """A material with all fields that any has, so that rows of a table can be gathered."""

    def __init__(self, kind, fields):
        first = "diffuse" if kind == "Phong" else "color"
        self.kind = kind
        self.first = optional(fields, first, "#ffffff")
        self.color = lin(self.first)
        self.specular = lin(optional(fields, "specular", "#808080"))
        self.exponent = float(optional(fields, "exponent", 32.0))
        self.reflection = lin(optional(fields, "reflection", "#000000"))
        self.ior = float(optional(fields, "ior", 1.5))
        self.intensity = float(optional(fields, "intensity", 1.0))


def material_of(fields, named):
    """Returns the material of a geometry's or a table's row's fields."""
    kind, values = "Matte", {}
    if fields.get("material") is not None:
        kind, values = variant(fields["material"])
        if kind == "Named":
            name = values if isinstance(values, str) else values[0]
            kind, values = variant(named[name])
        values = dict(values)
    if fields.get("color") is not None:
        values["diffuse" if kind == "Phong" else "color"] = fields["color"]
    return Material(kind, values)


def fresnel(cos_i, ratio):
    """Returns the unpolarized Fresnel factor and the cosine inside; ratio is n outside / n inside."""
    sin2 = ratio**2 * (1.0 - cos_i**2)
    cos_t = np.sqrt(np.maximum(0.0, 1.0 - sin2))
    rs = (ratio * cos_i - cos_t) / (ratio * cos_i + cos_t)
    rp = (cos_i - ratio * cos_t) / (cos_i + ratio * cos_t)
    return np.where(sin2 >= 1.0, 1.0, (rs**2 + rp**2) / 2.0), cos_t


# ---------------------------------------------------------------------------------------------
# Light
# ---------------------------------------------------------------------------------------------


class World:
    def __init__(self, scene):
        named = optional(scene, "materials", {})
        self.shapes, self.materials, owners = [], [], []
        for number, geometry in enumerate(scene["geometries"]):
            name, fields = variant(geometry)
            if name in solids.COMBINED:
                parts = list(pieces(name, fields))
            elif name == "Mesh":
                place = (lambda facet: Placed(fields["placed"], facet)) if "placed" in fields else lambda facet: facet
                parts = [(place(facet), fields) for facet in facets(fields)]
            else:
                parts = [(shape_of(name, fields), fields)]
            self.shapes += [shape for shape, _ in parts]
            self.materials += [material_of(surface, named) for _, surface in parts]
            owners += [number] * len(parts)
        # The geometry of each shape; the last one is that of no shape.
        self.owners = np.array([*owners, -1])
        self.same = np.array(
            [[a.same(b) for b in self.shapes] + [False] for a in self.shapes]
            + [[False] * (len(self.shapes) + 1)]
        )
        # A face of a solid may lie in the plane of another shape, where a ray starts at both.
        self.touch = np.zeros_like(self.same)
        for own, a in enumerate(self.shapes):
            for index, b in enumerate(self.shapes):
                self.touch[own, index] = own != index and touch(a, b)
        self.background = lin(optional(scene, "background", (0.0, 0.0, 0.0)))
        self.is_lit = scene.get("lights") is not None
        self.lights = [variant(light) for light in scene.get("lights") or []]
        lighting = scene.get("lighting")
        self.max_depth = optional(variant(lighting)[1], "max_depth", 8.0) if lighting else 8.0
        intensities = [material.intensity for material in self.materials if material.kind == "Emissive"]
        intensities += [float(optional(fields, "intensity", 0.2 if name == "Ambient" else 1.0)) for name, fields in self.lights]
        exposure = float(optional(optional(scene, "image", {}), "exposure", 0.0))
        self.brightest = max([1.0, *intensities]) * 2.0**exposure

    def roots(self, index, o, d, own):
        roots = self.shapes[index].roots(o, d, self.same[own, index])
        return [at_start(t, self.touch[own, index]) for t in roots]

    def hit(self, o, d, own):
        """Returns the index and the t of the nearest hits; index -1 where nothing is hit."""
        nearest = np.full(len(o), math.inf)
        found = np.full(len(o), -1)
        for index in range(len(self.shapes)):
            for t in self.roots(index, o, d, own):
                nearer = t < nearest
                nearest[nearer] = t[nearer]
                found[nearer] = index
        return found, nearest

    def normals(self, found, p, d):
        n = np.zeros_like(p)
        for index in np.unique(found[found >= 0]):
            rows = found == index
            n[rows] = self.shapes[index].normal(p[rows], d[rows])
        return n

    def transmission(self, p, d, own, limit):
        """Returns the part of the light that arrives at p from p + d, for each channel."""
        part = np.ones((len(p), 3))
        for index, material in enumerate(self.materials):
            for t in self.roots(index, p, d, own):
                between = t < limit
                if material.kind != "Glass":
                    part[between] = 0.0
                elif between.any():
                    at = p[between] + t[between, None] * d[between]
                    f = self.crossing(index, at, d[between])
                    part[between] *= (1.0 - f)[:, None] * material.color
        return part

    def crossing(self, index, at, d):
        """Returns the Fresnel factor where a straight line crosses glass, as from outside."""
        cos = dots(units(d), self.shapes[index].normal(at, d))
        return fresnel(np.abs(cos), 1.0 / self.materials[index].ior)[0]

    def incident(self, light, p, n, v, own):
        """Returns I without n·l, and l; l is None for light from everywhere."""
        name, fields = light
        intensity = float(optional(fields, "intensity", 0.2 if name == "Ambient" else 1.0))
        power = intensity * lin(optional(fields, "color", "#ffffff"))
        arriving = np.broadcast_to(power, p.shape)
        if name == "Ambient":
            return arriving, None
        if name == "Headlight":
            return arriving, v
        if name == "Directional":
            d = np.broadcast_to(-np.array(fields["direction"], float), p.shape)
            limit = math.inf
        else:
            d = np.array(fields["position"], float) - p
            limit = BEFORE_LIGHT
            if optional_name(fields, "falloff", "InverseSquare") == "InverseSquare":
                arriving = arriving / dots(d, d)[:, None]
        l = units(d)
        if name == "Spot":
            arriving = arriving * cone(fields, l)[:, None]
        if optional(fields, "shadows", True):
            # A surface that faces away is unlit anyway.
            facing = dots(n, l) > 0.0
            part = np.zeros_like(p)
            part[facing] = self.transmission(p[facing], d[facing], own[facing], limit)
            arriving = arriving * part
        return arriving, l

    def radiance(self, o, d, own, weight, depth):
        """Returns the light that arrives at o from the direction d, 0 for rays of little weight."""
        light = np.zeros_like(o)
        bright = weight.max(axis=-1) * self.brightest >= FAINT
        if depth > self.max_depth:
            light[bright] = self.background
        elif bright.any():
            rays = (o[bright], d[bright], own[bright])
            found, t = self.hit(*rays)
            light[bright] = self.seen(rays[0], rays[1], found, t, weight[bright], depth)
        return light

    def seen(self, o, d, found, t, weight, depth):
        light = np.tile(self.background, (len(o), 1))
        for kind in sorted({material.kind for material in self.materials}):
            indices = [i for i, material in enumerate(self.materials) if material.kind == kind]
            rows = np.isin(found, indices)
            if rows.any():
                p = o[rows] + t[rows, None] * d[rows]
                shade = getattr(self, kind.lower())
                light[rows] = shade(p, d[rows], found[rows], weight[rows], depth)
        return light

    def gather(self, name, found):
        return np.array([getattr(material, name) for material in self.materials])[found]

    def first(self, found, p):
        """Returns the first color of each hit."""
        colors = self.gather("color", found)
        for index in np.unique(found):
            shape = self.shapes[index]
            if getattr(shape, "mesh", None) is not None:
                rows = found == index
                colors[rows] = shape.light(p[rows])
        return colors

    def facing(self, p, d, found):
        """Returns the direction to the viewer, and the normal on that side."""
        v = -units(d)
        n = self.normals(found, p, d)
        return v, np.where(dots(n, d)[:, None] > 0.0, -n, n)

    def mirrored(self, p, d, n, found, factor, weight, depth):
        turned = d - 2.0 * dots(d, n)[:, None] * n
        return factor * self.radiance(p, turned, found, weight * factor, depth + 1)

    def flat(self, p, d, found, weight, depth):
        return self.first(found, p)

    def emissive(self, p, d, found, weight, depth):
        return self.first(found, p) * self.gather("intensity", found)[:, None]

    def matte(self, p, d, found, weight, depth):
        v, n = self.facing(p, d, found)
        total = np.zeros_like(p)
        for light in self.lights:
            arriving, l = self.incident(light, p, n, v, found)
            total += arriving if l is None else arriving * np.maximum(0.0, dots(n, l))[:, None]
        return self.first(found, p) * total

    def phong(self, p, d, found, weight, depth):
        v, n = self.facing(p, d, found)
        diffuse = self.matte(p, d, found, weight, depth)
        highlights = np.zeros_like(p)
        for light in self.lights:
            arriving, l = self.incident(light, p, n, v, found)
            if l is None:
                continue
            cos = dots(n, l)
            r = 2.0 * cos[:, None] * n - l
            lobe = np.maximum(0.0, dots(r, v)) ** self.gather("exponent", found)
            highlights += arriving * np.where(cos > 0.0, lobe, 0.0)[:, None]
        reflection = self.gather("reflection", found)
        return (
            diffuse
            + self.gather("specular", found) * highlights
            + self.mirrored(p, d, n, found, reflection, weight, depth)
        )

    def mirror(self, p, d, found, weight, depth):
        _, n = self.facing(p, d, found)
        return self.mirrored(p, d, n, found, self.gather("color", found), weight, depth)

    def glass(self, p, d, found, weight, depth):
        v, n = self.facing(p, d, found)
        is_pane = np.array([shape.is_pane for shape in self.shapes])[found]
        inside = ~is_pane & (dots(self.normals(found, p, d), d) > 0.0)
        ior = self.gather("ior", found)
        ratio = np.where(inside, ior, 1.0 / ior)
        cos_i = dots(n, v)
        f, cos_t = fresnel(cos_i, ratio)
        bent = ratio[:, None] * -v + (ratio * cos_i - cos_t)[:, None] * n
        through = np.where(is_pane[:, None], d, bent)
        passing = (1.0 - f)[:, None] * self.gather("color", found)
        return self.mirrored(p, d, n, found, f[:, None], weight, depth) + passing * self.radiance(
            p, through, found, weight * passing, depth + 1
        )


def optional_name(fields, name, default):
    """Returns the name of a variant without fields."""
    value = optional(fields, name, default)
    return value if isinstance(value, str) else variant(value)[0]


def cone(fields, l):
    position = np.array(fields["position"], float)
    if fields.get("look_at") is not None:
        axis = np.array(fields["look_at"], float) - position
    else:
        axis = np.array(fields["direction"], float)
    cos = dots(-l, units(axis))
    outer = math.radians(float(fields["angle"])) / 2.0
    inner = outer * (1.0 - float(optional(fields, "blend", 0.15)))
    if inner == outer:
        return np.where(cos >= math.cos(outer), 1.0, 0.0)
    s = np.clip((cos - math.cos(outer)) / (math.cos(inner) - math.cos(outer)), 0.0, 1.0)
    return s * s * (3.0 - 2.0 * s)


# ---------------------------------------------------------------------------------------------
# Pictures
# ---------------------------------------------------------------------------------------------


class Grid:
    """The camera's rays through all samples: row 0 is the bottom of the picture."""

    def __init__(self, scene):
        self.width, self.height = evaluate.size_of(scene)
        self.side = math.isqrt(int(optional(optional(scene, "image", {}), "samples", 1.0)))
        ray = evaluate.camera_rays(scene["camera"], float(self.width), float(self.height))
        rays = [ray(x, y) for y in self.places(self.height) for x in self.places(self.width)]
        self.o = np.array([o for o, _ in rays])
        self.d = np.array([d for _, d in rays])
        self.shape = (self.height * self.side, self.width * self.side)

    def places(self, count):
        for pixel in range(count):
            for sample in range(self.side):
                yield pixel + (sample + 0.5) / self.side - 0.5

    def mean(self, samples):
        """Returns the mean of the samples of each pixel, the top row first."""
        blocks = samples.reshape(self.height, self.side, self.width, self.side, 3)
        return blocks.mean(axis=(1, 3))[::-1]


def inked(world, grid, outlines, found, t):
    """Returns which samples lie on an outline."""
    width = float(optional(outlines, "width", 1.5)) * grid.side
    depth = float(optional(outlines, "depth", math.inf))
    has_creases = outlines.get("creases") is not None
    creases = math.cos(math.radians(float(optional(outlines, "creases", 180.0))))
    normals = np.zeros_like(grid.o)
    seen = found >= 0
    o, d = grid.o[seen], grid.d[seen]
    normals[seen] = world.normals(found[seen], o + t[seen, None] * d, d)
    steep = np.abs(dots(normals, grid.d)) / np.linalg.norm(grid.d, axis=1)
    rows, columns = grid.shape
    found = world.owners[found]
    # Of each other geometry, the nearest sample that sees it counts.
    met = np.zeros((len(found), found.max() + 2), bool)
    ink = np.zeros(len(found), bool)
    reach = math.ceil(width)
    steps = range(-reach, reach + 1)
    # Row 0 is the bottom: of samples at equal distances, those above come first.
    for squared, up, across in sorted((a * a + b * b, -b, a) for a in steps for b in steps):
        up = -up
        if not 0.0 < math.sqrt(squared) < width:
            continue
        place = np.arange(len(found)).reshape(grid.shape)
        here = place[clip(rows, -up), clip(columns, -across)].reshape(-1)
        there = place[clip(rows, up), clip(columns, across)].reshape(-1)
        counts = (found[here] >= 0) & ~met[here, found[there]]
        here, there = here[counts], there[counts]
        same = found[here] == found[there]
        met[here[~same], found[there[~same]]] = True
        seam = np.nan_to_num(steep[there] / (steep[here] + steep[there]), nan=0.5)
        sharp = has_creases & (dots(normals[here], normals[there]) < creases)
        within = np.where(sharp, seam, 0.0)
        within[t[here] - t[there] > depth] = 0.0
        within[t[there] - t[here] > depth] = 1.0
        share = np.where(same, within, seam)
        apart = np.flatnonzero(~same & (found[there] >= 0))
        ends = ~meets(world, grid, found[here[apart]], there[apart])
        covers = meets(world, grid, found[there[apart]], here[apart])
        share[apart[ends & covers]] = 1.0
        share[apart[~ends & ~covers]] = 0.0
        share[found[there] < 0] = 1.0
        ink[here[math.sqrt(squared) <= 0.5 + (width - 0.5) * share]] = True
    return ink


def meets(world, grid, owners, places):
    """Returns where the ray of a sample meets a geometry, whatever lies before it."""
    met = np.zeros(len(places), bool)
    for index in range(len(world.shapes)):
        rays = np.flatnonzero(world.owners[index] == owners)
        o, d = grid.o[places[rays]], grid.d[places[rays]]
        for t in world.roots(index, o, d, np.full(len(rays), -1)):
            met[rays] |= np.isfinite(t)
    return met


def clip(count, by):
    """Returns the places of a row of `count` from which a step by -by stays inside."""
    return slice(max(0, by), count + min(0, by))


def neutral(c):
    """Khronos PBR Neutral."""
    x = c.min(axis=-1, keepdims=True)
    c = c - np.where(x < 0.08, x - 6.25 * x * x, 0.04)
    p = c.max(axis=-1, keepdims=True)
    over = np.maximum(p, 0.76)
    q = 1.0 - 0.0576 / (over - 0.52)
    pressed = c * (q / over)
    g = 1.0 - 1.0 / (0.15 * (over - q) + 1.0)
    return np.where(p < 0.76, c, pressed + (q - pressed) * g)


def evaluate_lit(scene):
    """Returns width, height and the bytes of the picture, from the top row downwards."""
    # Infinities and NaN are what they are in IEEE 754.
    np.seterr(all="ignore")
    world, grid, image = World(scene), Grid(scene), optional(scene, "image", {})
    nowhere = np.full(len(grid.o), -1)
    found, t = world.hit(grid.o, grid.d, nowhere)
    if world.is_lit:
        light = world.seen(grid.o, grid.d, found, t, np.ones_like(grid.o), 0)
    else:
        light = np.tile(world.background, (len(grid.o), 1))
        if world.materials:
            light[found >= 0] = world.gather("color", found[found >= 0])
    outlines = scene.get("outlines")
    if outlines is not None:
        ink = inked(world, grid, outlines, found, t)
        light[ink] = lin(optional(outlines, "color", "#000000"))
    light = grid.mean(light)
    if world.is_lit:
        light = light * 2.0 ** float(optional(image, "exposure", 0.0))
        if optional_name(image, "tone_mapping", "Clip") == "Neutral":
            light = neutral(light)
    values = inverse(np.clip(light, 0.0, 1.0))
    # A mean of equal colors is that color, and half a level must not depend on a power.
    levels = np.floor(np.round(values * 255.0, 9) + 0.5).astype(np.uint8)
    return grid.width, grid.height, levels.tobytes()


def differences(expected, found):
    """Returns the differences between two pictures as lines of text, none if they agree."""
    if expected[:2] != found[:2]:
        return [f"the picture is {found[0]}x{found[1]}, not {expected[0]}x{expected[1]}"]
    width = expected[0]
    a, b = (
        np.frombuffer(pixels, np.uint8).reshape(-1, 3).astype(int)
        for pixels in (expected[2], found[2])
    )
    off = np.abs(a - b).max(axis=1)
    wrong = np.flatnonzero(off > 1)
    if len(wrong) <= TOLERATED * len(off):
        return []
    lines = [f"{len(wrong)} of {len(off)} pixels are more than one level off"]
    for at in wrong[:5]:
        row, column = divmod(at, width)
        lines.append(
            f"  column {column}, row {row}: {tuple(map(int, b[at]))}, "
            f"the equations give {tuple(map(int, a[at]))}"
        )
    return lines


def check(path, picture):
    """Returns the number of pixels of a scene's picture, and its differences."""
    expected = evaluate_lit(evaluate.read_scene(path))
    found = evaluate.read_png(picture or os.path.splitext(path)[0] + ".png")
    return expected[0] * expected[1], differences(expected, found)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("paths", nargs="+", metavar="SCENE", help="a scene, or a folder of them")
    parser.add_argument("--picture", help="the .png to compare with; one scene only")
    parser.add_argument("--write", metavar="PPM", help="write the picture instead of comparing")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes at a time")
    options = parser.parse_args()

    paths = [scene for path in options.paths for scene in evaluate.scenes_below(path)]
    if not paths:
        parser.error("no scenes there")
    if (options.picture or options.write) and len(paths) != 1:
        parser.error("--picture and --write are for one scene")
    if options.write:
        evaluate.write_ppm(options.write, *evaluate_lit(evaluate.read_scene(paths[0])))
        return 0

    pixels, wrong = 0, 0
    with ProcessPoolExecutor(options.jobs) as pool:
        for path, (count, lines) in zip(paths, pool.map(check, paths, [options.picture] * len(paths))):
            pixels += count
            wrong += bool(lines)
            print(f"{'differs' if lines else 'equal  '} {path}", flush=True)
            for line in lines:
                print(f"        {line}")
    print(f"{len(paths)} scenes, {pixels} pixels, {wrong} scenes differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
