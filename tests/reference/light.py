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
import surfaces
from contact import NONE, Faces, fresnel, listed
from evaluate import optional, variant
from surfaces import dots, units

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


# ---------------------------------------------------------------------------------------------
# Materials
# ---------------------------------------------------------------------------------------------


# The roughness of the materials that have one, if it is not given.
ROUGHNESS = {"Metal": 0.2, "Plastic": 0.3, "Principled": 0.5, "Glass": 0.0}


class Material:
    """A material with all fields that any has, so that rows of a table can be gathered."""

    def __init__(self, kind, fields):
        first = "diffuse" if kind == "Phong" else "color"
        self.kind = kind
        # Described as in the file; light.py shows none.
        self.texture = fields.get("texture")
        self.first = optional(fields, first, "#ffffff")
        self.color = lin(self.first)
        self.specular = lin(optional(fields, "specular", "#808080"))
        self.exponent = float(optional(fields, "exponent", 32.0))
        self.reflection = lin(optional(fields, "reflection", "#000000"))
        self.ior = float(optional(fields, "ior", 1.5))
        self.intensity = float(optional(fields, "intensity", 1.0))
        self.roughness = float(optional(fields, "roughness", ROUGHNESS.get(kind, 0.0)))
        self.metallic = float(optional(fields, "metallic", 1.0 if kind == "Metal" else 0.0))


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
    if fields.get("texture") is not None:
        values["texture"] = fields["texture"]
    return Material(kind, values)


# ---------------------------------------------------------------------------------------------
# Light
# ---------------------------------------------------------------------------------------------


class World:
    def __init__(self, scene, bias):
        named = optional(scene, "materials", {})
        parts, bodies, materials, owners = [], [], [], []
        for number, geometry in enumerate(scene["geometries"]):
            name, fields = variant(geometry)
            if name == "Mesh":
                made = list(surfaces.triangles_of(fields))
            else:
                made = [surfaces.shape_of(name, fields)]
            for shape in made:
                own = surfaces.colors_of(shape, fields)
                materials += [material_of(each, named) for each in own]
                owners += [number] * len(own)
            parts += made
            bodies += [number] * len(made)
        self.faces, self.materials = Faces(parts, materials, bodies, bias), materials
        # The geometry of each face; the last one is that of no face.
        self.owners = np.array([*owners, -1])
        self.background = lin(optional(scene, "background", (0.0, 0.0, 0.0)))
        self.is_lit = scene.get("lights") is not None
        self.lights = [variant(light) for light in scene.get("lights") or []]
        lighting = scene.get("lighting")
        self.max_depth = optional(variant(lighting)[1], "max_depth", 8.0) if lighting else 8.0
        intensities = [material.intensity for material in self.materials if material.kind == "Emissive"]
        intensities += [float(optional(fields, "intensity", 0.2 if name == "Ambient" else 1.0)) for name, fields in self.lights]
        exposure = float(optional(optional(scene, "image", {}), "exposure", 0.0))
        self.brightest = max([1.0, *intensities]) * 2.0**exposure

    def unshadowed(self, light, p, v):
        """Returns the light that arrives at points if nothing is in its way, l, the way to it, and its limit.

        l is None for light from everywhere, and the way for what casts no shadow.
        """
        name, fields = light
        intensity = float(optional(fields, "intensity", 0.2 if name == "Ambient" else 1.0))
        power = intensity * lin(optional(fields, "color", "#ffffff"))
        arriving = np.broadcast_to(power, p.shape)
        if name == "Ambient":
            return arriving, None, None, 0.0
        if name == "Headlight":
            return arriving, v, None, 0.0
        if name == "Directional":
            d = np.broadcast_to(-np.array(fields["direction"], float), p.shape)
            limit = math.inf
        else:
            d = np.array(fields["position"], float) - p
            limit = BEFORE_LIGHT
            if optional_name(fields, "falloff", "InverseSquare") == "InverseSquare":
                arriving = arriving / dots(d, d)[:, None]
        # A light at p itself brings nothing.
        away = dots(d, d)[:, None] > 0.0
        l, arriving = np.where(away, units(d), v), np.where(away, arriving, 0.0)
        if name == "Spot":
            arriving = arriving * cone(fields, l)[:, None]
        return arriving, l, d if optional(fields, "shadows", True) else None, limit

    def incident(self, light, start, n, v):
        """Returns I without n·l, and l; l is None for light from everywhere."""
        arriving, l, d, limit = self.unshadowed(light, start.p, v)
        if d is not None:
            # A surface that faces away is unlit anyway.
            facing = dots(n, l) > 0.0
            part = np.zeros_like(start.p)
            part[facing] = self.faces.transmission(start[facing], d[facing], limit)
            arriving = arriving * part
        return arriving, l

    def radiance(self, start, d, weight, depth):
        """Returns the light that arrives from the direction d, 0 for rays of little weight."""
        light = np.zeros_like(d)
        bright = weight.max(axis=-1) * self.brightest >= FAINT
        if depth > self.max_depth:
            light[bright] = self.background
        elif bright.any():
            light[bright] = self.arriving(start[bright], d[bright], weight[bright], depth)
        return light

    def arriving(self, start, d, weight, depth):
        light = np.tile(self.background, (len(d), 1))
        t, arrived, sense = self.reached(start, d)
        rows = np.isfinite(t)
        if rows.any():
            light[rows] = self.seen(arrived[rows], d[rows], sense[rows], weight[rows], depth)
        return light

    def reached(self, start, d):
        """Returns the t at which rays meet something first, where they arrive, and the senses there."""
        # What a ray crosses where it starts comes before all others.
        sense = self.faces.crossed(start, d)
        here = sense.any(axis=1)
        found, t = self.faces.hit(start, d)
        t[here] = 0.0
        rows = ~here & (found >= 0)
        if not rows.any():
            return t, start, sense
        arrived = self.faces.at(start.p[rows], d[rows], t[rows], found[rows])
        of_hit = self.faces.crossed(arrived, d[rows], arrives=True)
        # An opaque face that was hit stays what is seen, and glass that lies on nothing else.
        only = ~self.faces.is_glass[arrived.own] | (arrived.contact.sum(axis=1) == 1)
        leaves = dots(self.faces.normals(arrived.own, arrived.p, d[rows]), d[rows]) > 0.0
        of_hit[only] = 0
        of_hit[only, arrived.own[only]] = np.where(leaves, -1, 1)[only]
        sense[rows] = of_hit
        return t, start.replaced(rows, arrived), sense

    def surfaces(self, start, sense):
        """Returns the kinds of surfaces where rays cross some faces, their points, and what is met of glass."""
        face, sense = listed(sense)
        opaque, *glass = self.faces.met(face, sense)
        own = np.where(opaque == NONE, start.own, opaque)
        kinds = np.array([material.kind for material in self.materials])[own]
        kinds[opaque == NONE] = "Glass"
        return kinds, start.of(own), glass

    def seen(self, start, d, sense, weight, depth):
        """Returns the light from P, where rays along d cross some faces."""
        light = np.zeros_like(d)
        kinds, start, glass = self.surfaces(start, sense)
        for kind in sorted(set(kinds)):
            rows = kinds == kind
            shade = getattr(self, kind.lower())
            more = [each[rows] for each in glass] if kind == "Glass" else []
            light[rows] = shade(start[rows], d[rows], weight[rows], depth, *more)
        return light

    def gather(self, name, found):
        return np.array([getattr(material, name) for material in self.materials])[found]

    def first(self, start):
        """Returns the first color of each hit."""
        colors = self.gather("color", start.own)
        for index in np.unique(start.own):
            face = self.faces.faces[index]
            if face.light is not None:
                rows = start.own == index
                colors[rows] = lin(face.light(face.local(start.p[rows])))
        return colors

    def facing(self, start, d):
        """Returns the direction to the viewer, and the normal on that side."""
        v = -units(d)
        n = self.faces.normals(start.own, start.p, d)
        return v, np.where(dots(n, d)[:, None] > 0.0, -n, n)

    def mirrored(self, start, d, n, factor, weight, depth):
        turned = d - 2.0 * dots(d, n)[:, None] * n
        return factor * self.radiance(start, turned, weight * factor, depth + 1)

    def flat(self, start, d, weight, depth):
        return self.first(start)

    def emissive(self, start, d, weight, depth):
        return self.first(start) * self.gather("intensity", start.own)[:, None]

    def matte(self, start, d, weight, depth):
        v, n = self.facing(start, d)
        total = np.zeros_like(d)
        for light in self.lights:
            arriving, l = self.incident(light, start, n, v)
            total += arriving if l is None else arriving * np.maximum(0.0, dots(n, l))[:, None]
        return self.first(start) * total

    def phong(self, start, d, weight, depth):
        v, n = self.facing(start, d)
        diffuse = self.matte(start, d, weight, depth)
        highlights = np.zeros_like(d)
        for light in self.lights:
            arriving, l = self.incident(light, start, n, v)
            if l is None:
                continue
            cos = dots(n, l)
            r = 2.0 * cos[:, None] * n - l
            lobe = np.maximum(0.0, dots(r, v)) ** self.gather("exponent", start.own)
            highlights += arriving * np.where(cos > 0.0, lobe, 0.0)[:, None]
        reflection = self.gather("reflection", start.own)
        return (
            diffuse
            + self.gather("specular", start.own) * highlights
            + self.mirrored(start, d, n, reflection, weight, depth)
        )

    def mirror(self, start, d, weight, depth):
        _, n = self.facing(start, d)
        return self.mirrored(start, d, n, self.gather("color", start.own), weight, depth)

    def interface(self, start, left, entered, changed, pane):
        """Returns where rays go straight on, where panes are, the factors of what comes through, the refractive
        indices before relative to those behind, and the points as those of the faces that count."""
        n1, n2 = self.faces.indices(left), self.faces.indices(entered)
        is_pane = (changed == NONE) & (pane != NONE)
        # An edge that is only grazed, and a joint of equal glass, are no surfaces.
        is_joint = np.maximum(left, entered) != NONE
        straight = (changed == NONE) & ~is_pane | is_joint & (n1 == n2)
        tint = self.faces.tint(left) * self.faces.tint(entered)
        tint[is_pane] = self.faces.tint(pane)[is_pane]
        own, face = start.own, np.where(is_pane, pane, np.where(straight, start.own, changed))
        stays = np.where(own < 0, False, self.faces.body_of[own] == self.faces.body_of[face])
        start = start.of(np.where(stays & is_pane, own, face))
        ratio = np.where(is_pane, 1.0 / self.faces.ior[start.own], n1 / n2)
        return straight, is_pane, tint, ratio, start

    def glass(self, start, d, weight, depth, *met):
        light = np.zeros_like(d)
        straight, is_pane, tint, ratio, start = self.interface(start, *met)
        if straight.any():
            rest = (start[straight].through(d[straight]), d[straight], weight[straight] * tint[straight])
            light[straight] = tint[straight] * self.radiance(*rest, depth)
        rows = np.flatnonzero(~straight)
        if not len(rows):
            return light
        is_pane, tint, ratio, start = is_pane[rows], tint[rows], ratio[rows], start[rows]
        d, weight = d[rows], weight[rows]
        v, n = self.facing(start, d)
        cos_i = dots(n, v)
        f, cos_t = fresnel(cos_i, ratio)
        bent = ratio[:, None] * -v + (ratio * cos_i - cos_t)[:, None] * n
        through = np.where(is_pane[:, None], d, bent)
        passing = (1.0 - f)[:, None] * tint
        reflected = self.mirrored(start, d, n, f[:, None], weight, depth)
        refracted = self.radiance(start.through(d), through, weight * passing, depth + 1)
        light[rows] = reflected + passing * refracted
        return light


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
    normals[seen] = world.faces.normals(found[seen], o + t[seen, None] * d, d)
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
    owner_of = world.owners[world.faces.first[:-1]]
    for index, owner in enumerate(owner_of):
        rays = np.flatnonzero(owner == owners)
        start = world.faces.nowhere(grid.o[places[rays]])
        t, _, _ = world.faces.ends(index, start, grid.d[places[rays]])
        met[rays] |= np.isfinite(t).any(axis=0)
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


def evaluate_lit(scene, bias=0.0, aside=0.0):
    """Returns width, height and the bytes of the picture, from the top row downwards.

    `bias` is that of `Faces`, and the directions of all rays of the camera are changed by `aside`.
    """
    # Infinities and NaN are what they are in IEEE 754.
    np.seterr(all="ignore")
    world, grid, image = World(scene, bias), Grid(scene), optional(scene, "image", {})
    grid.d = grid.d + aside
    start = world.faces.nowhere(grid.o)
    found, t = world.faces.hit(start, grid.d)
    if world.is_lit:
        light = world.arriving(start, grid.d, np.ones_like(grid.o), 0)
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
