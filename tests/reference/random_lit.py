#!/usr/bin/env python3
"""Renders random lit scenes with the program, and compares each with light.py.

    random_lit.py PROGRAM [--count 200] [--seed 1] [--keep FOLDER]

Scenes have all lights and materials, outlines, exposure, tone mapping and samples. In half of them, half of
the geometries touch or coincide. Scenes that differ are kept.
"""

import argparse
import itertools
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

import evaluate
import light
import shapes
import solids
from random_scenes import Scenes, target_of
from touching import Touching


def parts_of(solid):
    return map(evaluate.variant, solids.parts_of([solid]))


class LitScenes(Scenes):
    """A generator of lit scenes, deterministic for a seed."""

    def unit_color(self):
        return [round(self.random.random(), 3) for _ in range(3)]

    def material(self):
        color = {"color": self.unit_color()}
        kind = self.random.choice(["Matte", "Phong", "Mirror", "Glass", "Flat", "Emissive"])
        if kind == "Phong":
            fields = {"diffuse": color["color"], "specular": self.unit_color()}
            fields["exponent"] = 10.0 ** self.random.uniform(-1.0, 3.0)
            if self.chance(0.5):
                fields["reflection"] = self.unit_color()
            return {kind: fields}
        if kind == "Glass":
            color["ior"] = self.random.choice((1.5, 1.333, 1.0, 0.7, self.random.uniform(0.25, 4.0)))
        if kind == "Emissive" and self.chance(0.5):
            color["intensity"] = self.random.uniform(0.0, 3.0)
        return {kind: color}

    def light(self, geometries):
        kind = self.random.choice(["Ambient", "Headlight", "Directional", "Point", "Point", "Spot"])
        fields = {"color": self.unit_color(), "intensity": self.random.uniform(0.1, 1.0)}
        if kind == "Directional":
            fields["direction"] = self.random.choice([self.unit_direction(), [0, -1, 0], [-1, -2, -1]])
        if kind in ("Point", "Spot"):
            fields["position"] = [self.random.uniform(-6.0, 6.0) for _ in range(3)]
            fields["intensity"] *= 20.0
            if self.chance(0.3):
                fields["falloff"] = "Constant"
                fields["intensity"] /= 20.0
            if geometries and self.chance(0.2):
                # In the middle of a geometry, or on it.
                ((_, other),) = self.random.choice(geometries).items()
                fields["position"] = list(target_of(other))
                if "radius" in other and "normal" not in other and self.chance(0.5):
                    fields["position"][1] += other["radius"]
        if kind == "Spot":
            fields["angle"] = self.random.uniform(5.0, 170.0)
            if self.chance(0.7):
                fields["blend"] = self.random.choice((0.0, 0.5, 1.0, self.random.random()))
            if self.chance(0.5):
                fields["direction"] = self.unit_direction()
            else:
                fields["look_at"] = [self.random.uniform(-1.0, 1.0) for _ in range(3)]
        if kind in ("Directional", "Point", "Spot") and self.chance(0.2):
            fields["shadows"] = False
        return {kind: fields}

    def magnitude(self):
        """Lengths of all magnitudes are left to the flat scenes."""
        return self.random.uniform(0.5, 2.0)

    def unit_direction(self):
        return [self.random.gauss(0.0, 1.0) for _ in range(3)]

    def touching(self):
        """Returns geometries of which half touch others, and where they do."""
        source = Touching(self.random)
        # Most opaque faces look alike: which of two that coincide is seen is left to rounding.
        geometries, glass, opaque = [], self.unit_color(), self.material()
        for _ in range(self.random.randint(2, 8)):
            kind, fields = source.first()
            if geometries and self.chance(0.6):
                kind, fields = source.beside(*next(iter(self.random.choice(geometries).items())))
            fields = {key: fields[key] for key in fields if key not in ("color", "material")}
            if self.chance(0.45):
                fields["material"] = opaque
            elif self.chance(0.8):
                fields["material"] = {"Glass": {"color": glass, "ior": self.random.choice((1.5, 1.5, 1.33))}}
            else:
                fields["material"] = self.material()
            geometries.append({kind: fields})
        return geometries, source

    def touching_scene(self):
        geometries, source = self.touching()
        scene = self.around(geometries)
        for field in ("samples", "exposure"):
            scene["image"].pop(field, None)
        scene["lights"] = scene["lights"][:2] + [{"Ambient": {}}, {"Directional": {"direction": source.sun()}}]
        ((_, view),) = scene["camera"].items()
        view["eye"] = [3.0 * x * source.unit for x in self.unit_direction()]
        view["eye"][1] = abs(view["eye"][1]) + 3.0 * source.unit
        if source.points and self.chance(0.5):
            # The ray in the middle meets a point where geometries touch.
            view["look_at"] = list(self.random.choice(source.points))
            for side in ("width", "height"):
                scene["image"][side] |= 1
            if self.chance(0.3):
                # The column in the middle runs along what touches there.
                view["eye"][0] = view["look_at"][0]
        if self.chance(0.1):
            # From far away, the numbers of a hit round more.
            far = 10.0 ** self.random.randint(1, 4)
            view["eye"] = [b + far * (a - b) for a, b in zip(view["eye"], view["look_at"])]
            if "fov" in view:
                view["fov"] /= far
        if self.chance(0.3):
            ((_, fields),) = geometries[0].items()
            fields["name"] = "first"
            copies = self.random.choice(([{}], [{}, {"translate": source.place()}]))
            geometries.append({"Instances": {"of": "first", "transforms": copies}})
        elif self.chance(0.4):
            matrix = source.turned()
            scene["geometries"] = [{"Group": {"geometries": geometries, "transform": {"matrix": matrix}}}]
            for at in ("eye", "look_at"):
                view[at] = [sum(a * b for a, b in zip(row, [*view[at], 1.0])) for row in matrix]
        return scene

    def scene(self):
        if self.chance(0.5):
            return self.touching_scene()
        geometries = []
        for _ in range(self.random.randint(1, 8)):
            place = [self.random.choice((-2, -1, 0, 1, 2, self.random.uniform(-2, 2))) for _ in range(3)]
            kind = self.random.choice(["Sphere", "Sphere", "Sphere", "Disc", "Plane", "Other", "Solid"])
            fields = {"point" if kind == "Plane" else "center": place}
            if kind == "Other":
                kind, fields = self.shape(0.7)
                while shapes.refusal(kind, fields):
                    kind, fields = self.shape(0.7)
                del fields["color"]
            elif kind == "Solid":
                kind, fields = self.solid(0.7)
                while any(shapes.refusal(*part) for part in parts_of({kind: fields})):
                    kind, fields = self.solid(0.7)
                del fields["color"]
            elif kind != "Sphere":
                fields["normal"] = self.random.choice([[0, 1, 0], [0, -2, 0], self.unit_direction()])
            if kind in ("Sphere", "Disc"):
                fields["radius"] = self.random.choice((0.5, 1.0, self.random.uniform(0.2, 2.0)))
            if geometries and self.chance(0.15):
                kind, fields = next(iter(self.random.choice(geometries).items()))
                fields = {key: fields[key] for key in fields if key not in ("color", "material")}
            if self.chance(0.4):
                fields["color"] = self.unit_color()
            else:
                fields["material"] = self.material()
            geometries.append({kind: fields})
        return self.around(geometries)

    def around(self, geometries):
        """Returns a scene of geometries."""
        eye = [self.random.uniform(-6.0, 6.0) for _ in range(3)]
        view = {"eye": eye, "look_at": [self.random.uniform(-1.0, 1.0) for _ in range(3)]}
        if self.chance(0.3):
            camera = {"Orthographic": view | {"scale": self.random.uniform(2.0, 8.0)}}
        else:
            camera = {"Perspective": view | {"fov": self.random.uniform(20.0, 100.0)}}
        image = {"width": self.random.randint(8, 40), "height": self.random.randint(8, 40)}
        if self.chance(0.3):
            image["samples"] = self.random.choice((4, 9))
        if self.chance(0.3):
            image["exposure"] = self.random.uniform(-3.0, 3.0)
        if self.chance(0.3):
            image["tone_mapping"] = "Neutral"
        scene = {"image": image, "camera": camera, "background": self.unit_color()}
        scene["lights"] = [self.light(geometries) for _ in range(self.random.randint(0, 4))]
        if self.chance(0.3):
            scene["lighting"] = {"Direct": {"max_depth": self.random.choice((0, 1, 3, 12))}}
        if self.chance(0.25):
            outlines = {"width": self.random.uniform(0.3, 4.0), "color": self.unit_color()}
            if self.chance(0.5):
                outlines["depth"] = self.random.uniform(0.01, 1.0)
            if self.chance(0.5):
                outlines["creases"] = self.random.uniform(1.0, 90.0)
            scene["outlines"] = outlines
        scene["geometries"] = geometries
        return scene


def check(path, picture):
    """Returns the number of pixels of a scene's picture, and its differences.

    Rounding chooses among faces at equal distances, and whether a ray through a corner of an outline hits.
    So the first and the last of equal faces are right too, and what rays beside that of a pixel see.
    """
    scene, found = evaluate.read_scene(path), evaluate.read_png(picture)
    lines = light.differences(light.evaluate_lit(scene), found)
    if lines:
        off = 2.0**-40
        asides = [off * np.array(corner) for corner in itertools.product((-1.0, 1.0), repeat=3)]
        varied = [(0.0, 0.0), (-off, 0.0), (off, 0.0)] + [(0.0, aside) for aside in asides]
        expected = [light.evaluate_lit(scene, *each) for each in varied]
        values = np.array([np.frombuffer(bytes_, np.uint8).reshape(-1, 3) for _, _, bytes_ in expected])
        off = np.abs(values.astype(int) - np.frombuffer(found[2], np.uint8).reshape(-1, 3)).max(axis=2)
        best = values[off.argmin(axis=0), np.arange(values.shape[1])]
        lines = light.differences((*expected[0][:2], best.tobytes()), found)
    return found[0] * found[1], lines


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program", help="the strahl to test")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", metavar="FOLDER", help="where scenes that differ go")
    options = parser.parse_args()
    keep = options.keep or tempfile.mkdtemp(prefix="strahl-")
    os.makedirs(keep, exist_ok=True)

    pixels = wrong = 0
    for number in range(options.count):
        seed = options.seed * 1_000_000 + number
        path = os.path.join(keep, f"{seed}.json")
        picture = os.path.join(keep, f"{seed}.png")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(LitScenes(seed).scene(), file)
        command = [options.program, "render", "-q", path, "-o", picture]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode == 0:
            count, lines = check(path, picture)
            pixels += count
        else:
            lines = [f"exit status {result.returncode}", result.stderr]
        if lines:
            wrong += 1
            print(path, *lines, sep="\n")
        else:
            os.remove(path)
            os.remove(picture)
    if not options.keep and not wrong:
        os.rmdir(keep)
    print(f"{options.count} scenes, {pixels} pixels, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
