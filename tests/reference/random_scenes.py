#!/usr/bin/env python3
"""Renders random scenes with the program, and compares every pixel with evaluate.py.

    random_scenes.py PROGRAM [--count 300] [--seed 1] [--keep FOLDER]

If the program rejects a scene, the format must reject it as well. Scenes that differ are kept.
"""

import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile

import evaluate

AXES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
DIAGONALS = [(1, 1, 0), (1, 0, -1), (0, -1, -1), (1, 1, 1), (-1, 2, -3), (3, 4, 0)]


class Scenes:
    """A generator of scenes, deterministic for a seed."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.has_solids = self.chance(0.3)
        self.has_transforms = self.chance(0.2)

    def chance(self, p):
        return self.random.random() < p

    def magnitude(self):
        return 10.0 ** self.random.uniform(-12.0, 12.0)

    def number(self):
        """Returns a coordinate: often a round one, so that geometries align, touch and coincide."""
        kind = self.random.randrange(10)
        if kind < 5:
            return float(self.random.randint(-4, 4))
        if kind < 7:
            return self.random.randint(-8, 8) / 2.0
        if kind < 9:
            return self.random.uniform(-5.0, 5.0)
        return self.random.choice((-1.0, 1.0)) * self.magnitude()

    def point(self, scale):
        return [self.number() * scale for _ in range(3)]

    def direction(self):
        kind = self.random.randrange(8)
        if kind < 3:
            direction = self.random.choice(AXES)
        elif kind < 5:
            direction = self.random.choice(DIAGONALS)
        elif kind < 7:
            direction = [self.random.gauss(0.0, 1.0) for _ in range(3)]
        else:
            direction = [self.number() for _ in range(3)]
        by = 1.0
        if self.chance(0.3):
            by = self.magnitude()
        elif self.chance(0.03):
            by = 10.0 ** self.random.uniform(-165.0, 155.0)
        return [x * by for x in direction]

    def color(self):
        if self.chance(0.3):
            return "#" + "".join(
                self.random.choice("0123456789abcdefABCDEF")
                for _ in range(self.random.choice((3, 6)))
            )
        if self.chance(0.3):
            return [(self.random.randint(0, 255) + 0.5) / 255.0 for _ in range(3)]
        return [self.random.uniform(-0.1, 1.1) for _ in range(3)]

    def camera(self, scale, targets):
        fields = {"eye": self.point(scale)}
        if targets and self.chance(0.1):
            fields["eye"] = list(self.random.choice(targets))
        if self.chance(0.15):
            far = 10.0 ** self.random.uniform(2.0, 10.0)
            fields["eye"] = [x * far for x in fields["eye"]]
        if targets and self.chance(0.75):
            fields["look_at"] = list(self.random.choice(targets))
        else:
            fields["gaze"] = self.direction()
        if self.chance(0.6):
            fields["up"] = self.direction()
        if self.chance(0.35):
            fields["scale"] = self.random.choice((1.0, 3.0, 8.0, self.magnitude())) * scale
            if self.chance(0.5):
                fields["stretch"] = self.chance(0.5)
            return {"Orthographic": fields}
        kind = self.random.randrange(10)
        if kind < 7:
            fields["fov"] = self.random.choice((30.0, 60.0, 90.0, self.random.uniform(1.0, 179.0)))
        elif kind == 7:
            fields["fov"] = 10.0 ** self.random.uniform(-12.0, 0.0)
        elif kind == 8:
            fields["fov"] = 180.0 - 10.0 ** self.random.uniform(-13.0, 0.0)
        else:
            fields["fov"] = self.random.choice((1e-310, 1e-160, 1e-100, 179.99999999999997))
        return {"Perspective": fields}

    def aim(self, camera, geometries):
        """Points the camera at a sphere or a disc so that its outline crosses the picture."""
        spheres = [
            fields for g in geometries for name, fields in g.items() if name in ("Sphere", "Disc")
        ]
        if not spheres:
            return
        sphere = self.random.choice(spheres)
        ((name, fields),) = camera.items()
        fields.pop("gaze", None)
        fields["look_at"] = list(sphere["center"])
        wide = sphere["radius"] * self.random.choice((1.0, 2.0, self.random.uniform(1.0, 8.0)))
        if name == "Orthographic":
            fields["scale"] = wide
        else:
            away = math.dist(fields["eye"], sphere["center"])
            fov = math.degrees(2.0 * math.atan(wide / away)) if away > wide else 60.0
            fields["fov"] = max(fov, 1e-300)

    def geometries(self, scale):
        geometries = []
        for _ in range(self.random.choice((0, 1, 1, 2, 2, 3, 4, 6))):
            again = geometries and self.chance(0.25)
            if again:
                # The same sphere again, or one that touches it.
                ((name, fields),) = self.random.choice(geometries).items()
                fields = dict(fields, color=self.color())
                if name == "Sphere" and self.chance(0.5):
                    axis = self.random.choice(AXES)
                    c, r = fields["center"], fields["radius"]
                    if self.chance(0.5):
                        fields["center"] = [x + 2.0 * r * a for x, a in zip(c, axis)]
                    else:
                        name = "Plane"
                        point = [x + r * a for x, a in zip(c, axis)]
                        fields = {"point": point, "normal": axis, "color": self.color()}
                elif name == "Cylinder" and self.chance(0.5):
                    # The next one in a row, or its cap.
                    a, b = fields["from"], fields["to"]
                    along = [y - x for x, y in zip(a, b)]
                    if self.chance(0.5):
                        fields["from"] = b
                        fields["to"] = [y + x for x, y in zip(along, b)]
                    else:
                        name = "Disc"
                        radius = fields["radius"] * self.random.choice((1.0, 0.5))
                        fields = {"center": b, "normal": along, "radius": radius, "color": self.color()}
                elif name == "Box" and self.chance(0.5):
                    # The next one, which shares a face.
                    axis = self.random.randrange(3)
                    wide = fields["max"][axis] - fields["min"][axis]
                    for corner in ("min", "max"):
                        moved = list(fields[corner])
                        moved[axis] += wide
                        fields[corner] = moved
                elif name in ("Plane", "Disc") and self.chance(0.5):
                    fields["normal"] = [-2.0 * x for x in fields["normal"]]
            elif self.chance(0.5):
                name, fields = self.solid(scale) if self.has_solids else self.shape(scale)
            elif self.chance(0.65):
                name = "Sphere"
                radius = self.random.choice((0.5, 1.0, 2.0, self.random.uniform(0.1, 5.0)))
                radius *= self.magnitude() if self.chance(0.1) else scale
                fields = {"center": self.point(scale), "radius": radius, "color": self.color()}
                if self.chance(0.4):
                    name = "Disc"
                    fields["normal"] = self.direction()
            else:
                name = "Plane"
                fields = {
                    "point": self.point(scale),
                    "normal": self.direction(),
                    "color": self.color(),
                }
            if self.has_transforms and self.chance(0.3):
                fields["transform"] = self.transform(scale)
            geometries.append({name: fields})
        return geometries

    def length(self, scale):
        length = self.random.choice((0.5, 1.0, 2.0, self.random.uniform(0.1, 5.0)))
        return length * (self.magnitude() if self.chance(0.05) else scale)

    def shape(self, scale):
        """Returns a shape that is neither a sphere nor flat and round."""
        color = {"color": self.color()}
        kinds = ["Rectangle", "Triangle", "Box", "Cylinder", "Cone", "Capsule", "Ellipsoid", "Torus", "Mesh"]
        name = self.random.choice(kinds)
        if name == "Triangle":
            return name, {corner: self.point(scale) for corner in "abc"} | color
        if name == "Mesh":
            count = self.random.randint(3, 7)
            last = count if self.chance(0.03) else count - 1
            triangle = lambda: [self.random.randint(0, last) for _ in range(3)]
            vertices = [self.point(scale) for _ in range(count)]
            triangles = [triangle() for _ in range(self.random.randint(1, 9))]
            return name, {"vertices": vertices, "triangles": triangles} | color
        if name == "Rectangle":
            edges = {edge: self.point(scale) for edge in ("edge_u", "edge_v")}
            return name, {"corner": self.point(scale)} | edges | color
        if name == "Box":
            low = self.point(scale)
            high = [x + self.length(scale) for x in low]
            if self.chance(0.03):
                low, high = high, low
            return name, {"min": low, "max": high} | color
        if name == "Ellipsoid":
            # Turned by Pythagorean triples, so that the axes are perpendicular to the last bit.
            c, s = self.random.choice(((1.0, 0.0), (0.6, 0.8), (-5.0 / 13.0, 12.0 / 13.0)))
            axes = [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]
            axes = [[x * length for x in axis] for axis in axes for length in [self.length(scale)]]
            return name, {"center": self.point(scale), "axes": axes} | color
        if name == "Torus":
            radius = self.length(scale)
            tube = radius * self.random.choice((0.1, 0.5, 0.9, 1.0 + 0.5 * self.chance(0.5)))
            place = {"center": self.point(scale), "axis": self.direction()}
            return name, place | {"radius": radius, "tube_radius": tube} | color
        fields = {"from": self.point(scale), "to": self.point(scale), "radius": self.length(scale)}
        if name == "Cone" and self.chance(0.5):
            fields["top_radius"] = self.random.choice((0.0, fields["radius"], self.length(scale)))
        if name != "Capsule" and self.chance(0.3):
            fields["capped"] = self.chance(0.2)
        return name, fields | color

    def solid(self, scale, depth=0):
        """Returns a solid that is put together from others."""
        name = self.random.choice(("Union", "Intersection", "Difference"))

        def operand():
            if depth < 2 and self.chance(0.2):
                kind, fields = self.solid(scale, depth + 1)
            elif self.chance(0.4):
                kind, fields = "Sphere", {"center": self.point(scale), "radius": self.length(scale)}
            elif self.chance(0.2):
                kind, fields = "Plane", {"point": self.point(scale), "normal": self.direction()}
            else:
                kind, fields = self.shape(scale)
                while kind in ("Rectangle", "Triangle", "Mesh"):
                    kind, fields = self.shape(scale)
                fields.pop("capped", None)
            fields.pop("color", None)
            if self.chance(0.2):
                fields["transform"] = self.transform(scale)
            if self.chance(0.1):
                kind, fields = "Group", {"geometries": [{kind: fields}], "transform": self.transform(scale)}
                return {kind: fields}
            return {kind: fields | ({"color": self.color()} if self.chance(0.5) else {})}

        operands = [operand() for _ in range(self.random.randint(1, 4))]
        if self.chance(0.2):
            operands.append(operands[0])
        if name == "Difference":
            fields = {"of": operands[0], "minus": operands[1:] or [operand()]}
        else:
            fields = {"of": operands}
        return name, fields | {"color": self.color()}

    def transform(self, scale):
        """Returns a transform that mirrors, turns by a quarter, stretches and moves."""
        factors = [self.random.choice((1.0, -1.0, 2.0, 0.5)) for _ in range(3)]
        # Rows of a matrix, as the sine of Python may differ in its last bit.
        rows = [[factor if row == column else 0.0 for column in range(3)] for row, factor in enumerate(factors)]
        self.random.shuffle(rows)
        moved = {"matrix": [row + [shift] for row, shift in zip(rows, self.point(scale))]}
        return self.random.choice((moved, {"translate": self.point(scale)}, {"scale": factors}))

    def scene(self):
        scale = self.random.choice((1.0, 1.0, 1e9, 1e-9, self.magnitude()))
        geometries = self.geometries(scale)
        targets = [target_of(fields) for g in geometries for fields in g.values()]
        camera = self.camera(scale, targets)
        if self.chance(0.6):
            self.aim(camera, geometries)
        return {
            "image": {
                "width": self.random.choice((1, 2, self.random.randint(1, 40))),
                "height": self.random.choice((1, 2, *[self.random.randint(1, 40)] * 4)),
            },
            "camera": camera,
            "background": self.color(),
            "geometries": geometries,
        }


def target_of(fields):
    """Returns a point of a geometry, or close to it."""
    target = next(iter(fields.values()))
    while isinstance(target, dict) or not isinstance(target[0], (int, float)):
        target = next(iter(target.values())) if isinstance(target, dict) else target[0]
    return target


LISTS = ("geometries", "axes", "vertices", "triangles", "minus")


def is_list_of_solids(field, value):
    return field == "of" and isinstance(value, list)


def ron(value):
    """Returns a scene, or a part of one, as RON."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, (list, tuple)):
        return "(" + ", ".join(map(ron, value)) + ")"
    if isinstance(value, dict):
        ((name, fields), *others) = value.items()
        if name[0].isupper() and not others:
            return name + ron(fields)
        items = (
            f"{k}: [{', '.join(map(ron, v))}]" if k in LISTS or is_list_of_solids(k, v) else f"{k}: {ron(v)}"
            for k, v in value.items()
        )
        return "(" + ", ".join(items) + ")"
    return repr(value)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program", help="the strahl to test")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", metavar="FOLDER", help="where scenes that differ go")
    options = parser.parse_args()
    keep = options.keep or tempfile.mkdtemp(prefix="strahl-")
    os.makedirs(keep, exist_ok=True)

    drawn = refused = pixels = varied = wrong = 0
    for number in range(options.count):
        seed = options.seed * 1_000_000 + number
        scene = Scenes(seed).scene()
        syntax = ("json", "ron")[number % 2]
        path = os.path.join(keep, f"{seed}.{syntax}")
        picture = os.path.join(keep, f"{seed}.png")
        with open(path, "w", encoding="utf-8") as file:
            file.write(json.dumps(scene) if syntax == "json" else ron(scene))
        result = subprocess.run(
            [options.program, "render", "-q", path, "-o", picture],
            capture_output=True,
            text=True,
            check=False,
        )
        reason = evaluate.refusal(evaluate.read_scene(path))
        lines = []
        if result.returncode == 0 and reason is None:
            drawn += 1
            expected = evaluate.evaluate(evaluate.read_scene(path))
            lines = evaluate.differences(expected, evaluate.read_png(picture))
            pixels += expected[0] * expected[1]
            body = expected[2]
            varied += body != body[:3] * (len(body) // 3)
        elif result.returncode == 1 and reason is not None and f"[{reason}]" in result.stderr:
            refused += 1
        else:
            lines = [f"exit status {result.returncode}, the format says {reason}", result.stderr]
        if lines:
            wrong += 1
            print(path, *lines, sep="\n")
        else:
            for done in (path, picture):
                if os.path.exists(done):
                    os.remove(done)
    if not options.keep and not wrong:
        os.rmdir(keep)
    print(
        f"{drawn} scenes, {pixels} pixels ({varied} scenes of more than one color), "
        f"{refused} refused, {wrong} wrong"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
