#!/usr/bin/env python3
"""Compares several samples per pixel, and every layer, with the equations.

    layers.py target/release/strahl scenes/gallery.ron … --size 60x40 --samples 16

Each scene is rendered with all layers into an .npz file, whole and in crops, with one thread and with
several. Numbers must be equal to the last bit, except those computed with a power, which differs
between mathematical libraries: light must be equal to 1e-14, and bytes unless the light is that
close to the next byte.
"""

import argparse
import io
import math
import os
import subprocess
import sys
import tempfile
import zipfile

import evaluate
from evaluate import add, dot, negated, scaled, subtract, unit, vector

LAYERS = "color,depth,z,position,normal,id,coverage"
TYPES = {"<f8": ("d", 8), "<f4": ("f", 4), "<u4": ("I", 4), "|u1": ("B", 1)}


def arrays(data):
    """Returns the arrays of an .npz file: shape and numbers."""
    found = {}
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        if archive.testzip() is not None:
            raise ValueError("a wrong checksum")
        for name in archive.namelist():
            content = archive.read(name)
            length = int.from_bytes(content[8:10], "little")
            header = eval(content[10 : 10 + length], {})
            code, size = TYPES[header["descr"]]
            values = memoryview(content[10 + length :]).cast(code).tolist()
            if header["fortran_order"] or math.prod(header["shape"]) != len(values):
                raise ValueError(f"{name}: {header}")
            found[name.removesuffix(".npy")] = header["shape"], values
    return found


def display_values(color):
    if isinstance(color, str):
        return tuple(byte / 255.0 for byte in evaluate.color_bytes(color))
    return tuple(min(max(channel, 0.0), 1.0) for channel in color)


def to_light(c):
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4


def from_light(l):
    return 12.92 * l if l <= 0.0031308 else 1.055 * l ** (1 / 2.4) - 0.055


class World:
    def __init__(self, scene):
        self.background = display_values(evaluate.optional(scene, "background", (0.0, 0.0, 0.0)))
        self.geometries = []
        for geometry in scene["geometries"]:
            name, fields = evaluate.variant(geometry)
            color = display_values(fields["color"])
            self.geometries.append((name, fields, evaluate.shape_of(name, fields), color))

    def nearest(self, o, d):
        """Returns the index and the t of a ray's hit."""
        found, nearest = None, math.inf
        for index, (_, _, hit, _) in enumerate(self.geometries):
            t = hit(o, d)
            if t is not None and t < nearest:
                found, nearest = index, t
        return found, nearest

    def color(self, index):
        return self.background if index is None else self.geometries[index][3]

    def normal(self, index, o, d, t):
        name, fields, hit, _ = self.geometries[index]
        if hasattr(hit, "normal"):
            return hit.normal(o, d, t)
        if name in ("Plane", "Disc"):
            return unit(vector(fields["normal"]))
        return unit(add(subtract(o, vector(fields["center"])), scaled(d, t)))


def expected(scene, size, samples, transparent):
    """Returns every layer as a list of numbers; color both as light and as display values."""
    width, height = size
    n = math.isqrt(samples)
    ray = evaluate.camera_rays(scene["camera"], float(width), float(height))
    eye, _, _, w, _, _ = evaluate.basis(evaluate.variant(scene["camera"])[1])
    world = World(scene)
    layers = {name: [] for name in LAYERS.split(",")}
    for row in range(height):
        y = float(height - 1 - row)
        for column in range(width):
            x = float(column)
            seen = []
            for j in range(n):
                for i in range(n):
                    at = x + (i + 0.5) / n - 0.5, y + (j + 0.5) / n - 0.5
                    seen.append(world.nearest(*ray(*at))[0])
            hits = [index for index in seen if index is not None]
            shown = [world.color(index) for index in (hits if transparent else seen)]
            if not shown:
                color = (0.0, 0.0, 0.0)
            elif all(one == shown[0] for one in shown):
                color = shown[0]
            else:
                light = [0.0, 0.0, 0.0]
                for one in shown:
                    light = [a + to_light(c) for a, c in zip(light, one)]
                color = tuple(from_light(a / len(shown)) for a in light)
            layers["color"].append(color + (len(hits) / samples,) if transparent else color)
            layers["coverage"].append(len(hits) / samples)
            o, d = ray(x, y)
            index, t = world.nearest(o, d)
            if index is None:
                point = normal = (0.0, 0.0, 0.0)
                z = math.inf
            else:
                point = add(o, scaled(d, t))
                normal = world.normal(index, o, d, t)
                z = dot(subtract(point, eye), negated(w))
            layers["depth"].append(t)
            layers["z"].append(z)
            layers["position"] += point
            layers["normal"] += normal
            layers["id"].append(0 if index is None else index + 1)
    return layers


def is_byte_of(byte, c):
    value = c * 255.0 + 0.5
    return byte == math.floor(value) or abs(value - round(value)) < 1e-9


def differences(name, wanted, shape, found):
    if name == "color":
        wanted = [channel for color in wanted for channel in color]
        right = [is_byte_of(byte, channel) for byte, channel in zip(found, wanted, strict=True)]
    else:
        right = [a == b for a, b in zip(found, wanted, strict=True)]
    wrong = [place for place, is_right in enumerate(right) if not is_right]
    if wrong:
        place = wrong[0]
        yield (
            f"{name}: {len(wrong)} of {len(found)} numbers differ, the first at {place}: "
            f"{found[place]!r}, the equations give {wanted[place]!r}; shape {shape}"
        )


def check(program, path, size, samples):
    width, height = size
    scene = evaluate.read_scene(path)
    lines = []

    def draw(*options):
        command = [program, "render", path, "-q", "-o", "-", "--image-format", "npz"]
        command += ["--size", f"{width}x{height}", "--samples", str(samples), "--layers", LAYERS]
        return arrays(subprocess.run(command + list(options), check=True, stdout=-1).stdout)

    for options in [(), ("--transparent",)]:
        whole = draw(*options)
        wanted = expected(scene, size, samples, bool(options))
        for name, (shape, found) in whole.items():
            lines += differences(name, wanted[name], shape, found)
        if draw("--threads", "1", *options) != whole or draw("--threads", "7", *options) != whole:
            lines.append("the number of threads makes a difference")
        left, top, across, down = width // 3, height // 4, width // 2, height // 2
        part = draw("--crop", f"{left},{top},{across},{down}", *options)
        for name, (shape, found) in part.items():
            channels = len(found) // (across * down)
            rows = (
                whole[name][1][channels * (row * width + left) :][: channels * across]
                for row in range(top, top + down)
            )
            if found != [number for row in rows for number in row]:
                lines.append(f"{name}: a part is not that of the whole")
    mixed = sum(0.0 < part < 1.0 for part in wanted["coverage"])
    return mixed, lines


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--size", default="60x40")
    parser.add_argument("--samples", type=int, default=16)
    options = parser.parse_args()
    size = tuple(int(side) for side in options.size.split("x"))
    failed = 0
    for path in options.scenes:
        mixed, lines = check(os.path.abspath(options.program), path, size, options.samples)
        print(f"{'differs' if lines else 'equal  '} {path}, {mixed} pixels partly covered")
        for line in lines:
            print(f"        {line}")
        failed += bool(lines)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
