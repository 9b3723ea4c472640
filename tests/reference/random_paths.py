#!/usr/bin/env python3
"""Renders random scenes under light by paths with the program, and compares each with paths.py.

    random_paths.py PROGRAM [--count 200] [--seed 1] [--keep FOLDER]

Scenes have all lights and materials, and all options of `Path`. Compared are layers in f64: `direct` and
`specular`, which are the light of a pixel, `albedo` and `coverage`. Scenes that differ are kept.
"""

import argparse
import glob
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

import paths
import shapes
from random_lit import LitScenes, parts_of

MATERIALS = "Matte Matte Phong Mirror Glass Glass Flat Emissive Metal Plastic Principled".split()
LIGHTS = "Ambient Headlight Directional Directional Point Point Spot Spot Environment Environment".split()
TEXTURED = "Matte Flat Phong Metal Plastic Principled Mirror".split()
NATURAL = "Sphere Plane Rectangle Triangle Disc Box".split()
LAMPS = "Sphere Disc Rectangle Triangle Box Cylinder Cone Capsule Mesh Plane Torus".split()


class PathScenes(LitScenes):
    """A generator of scenes under light by paths, deterministic for a seed. Pictures that they name are written into
    a folder."""

    def __init__(self, seed, folder):
        super().__init__(seed)
        self.seed, self.folder = seed, folder

    def roughness(self):
        smooth, even = 10.0 ** self.random.uniform(-1.5, 0.0), self.random.uniform(0.1, 1.0)
        return self.random.choice((0.0, 1.0, 0.01, smooth, even))

    def material(self):
        kind = self.random.choice(MATERIALS)
        if kind in ("Phong", "Flat"):
            found = super().material()
            while kind not in found:
                found = super().material()
            return found
        fields = {"color": self.unit_color()}
        if kind == "Matte" and self.chance(0.3):
            fields["color"] = self.random.choice(("#000000", "#ffffff", [0.9, 0.97, 0.93]))
        if kind in ("Metal", "Plastic", "Principled") and self.chance(0.8):
            fields["roughness"] = self.roughness()
        if kind == "Principled" and self.chance(0.8):
            fields["metallic"] = self.random.choice((0.0, 1.0, self.random.random()))
        if kind in ("Plastic", "Principled") and self.chance(0.5):
            fields["ior"] = self.random.choice((1.333, 1.0, self.random.uniform(0.25, 4.0)))
        if kind == "Glass":
            fields["ior"] = self.random.choice((1.5, 1.333, 1.0, 0.7, self.random.uniform(0.25, 4.0)))
            if self.chance(0.4):
                fields["roughness"] = self.roughness()
            if self.chance(0.2):
                del fields["color"]
        if kind == "Emissive" and self.chance(0.8):
            fields["intensity"] = self.random.choice((0.0, self.random.uniform(0.0, 8.0)))
        return {kind: fields}

    def light(self, geometries):
        kind = self.random.choice(LIGHTS)
        if kind == "Environment":
            fields = {"intensity": self.random.uniform(0.1, 1.5)}
            if self.chance(0.3):
                fields["image"] = self.picture()
                if self.chance(0.5):
                    fields["rotation"] = self.random.uniform(-400.0, 400.0)
                if self.chance(0.5):
                    fields["up"] = self.unit_direction()
            elif self.chance(0.5):
                fields["sky"] = {end: self.unit_color() for end in ("zenith", "horizon", "ground")}
                if self.chance(0.7):
                    fields["up"] = self.unit_direction()
            else:
                fields["color"] = self.unit_color()
            if self.chance(0.3):
                fields["visible"] = self.chance(0.2)
            return {kind: fields}
        # A light of a size that lies in a plane turns with the last bit of a point on it.
        has_size = self.chance(0.6)
        found = {}
        while kind not in found:
            found = super().light([] if has_size else geometries)
        fields = found[kind]
        if kind == "Directional" and has_size:
            fields["angle"] = self.random.choice((0.53, 90.0, self.random.uniform(0.0, 90.0)))
        if kind in ("Point", "Spot") and has_size:
            fields["radius"] = self.random.choice((0.05, 1.0, self.random.uniform(0.0, 3.0)))
        return found

    def lights(self, geometries):
        """Returns some lights, of which one at most is an environment."""
        lights = [self.light(geometries) for _ in range(self.random.randint(0, 4))]
        first = [at for at, light in enumerate(lights) if "Environment" in light][1:]
        return [light for at, light in enumerate(lights) if at not in first]

    def picture(self, name="light", powers=(-2.0, 1.5)):
        """Returns the path of a picture, which is written, with powers of 10 as light."""
        width, height = self.random.randint(1, 9), self.random.randint(1, 6)
        path = os.path.join(self.folder, f"{self.seed}-{name}.pfm")
        light = [10.0 ** self.random.uniform(*powers) for _ in range(3 * width * height)]
        with open(path, "wb") as file:
            file.write(b"PF\n%d %d\n-1.0\n" % (width, height))
            file.write(np.array(light, "<f4").tobytes())
        return os.path.basename(path)

    def around_all(self):
        """Returns a color or a backdrop, as fields of a scene."""
        if self.chance(0.7):
            return {"background": self.unit_color()}
        if self.chance(0.5):
            fields = {end: self.unit_color() for end in ("zenith", "horizon", "ground")}
        else:
            fields = {"file": self.picture("backdrop")}
            if self.chance(0.5):
                fields["rotation"] = self.random.uniform(-400.0, 400.0)
        if self.chance(0.5):
            fields["up"] = self.unit_direction()
        return {"backdrop": {"Image" if "file" in fields else "Sky": fields}}

    def texture(self, is_natural):
        """Returns a texture; only some shapes have coordinates that textures.py knows."""
        if self.chance(0.5):
            texture = {"Image": {"file": self.picture(f"texture-{self.random.randrange(1000)}", (-2.0, 0.0))}}
        else:
            texture = {"Checker": {"size": self.random.uniform(0.05, 0.5)}}
            for end in ("even", "odd"):
                if self.chance(0.6):
                    texture["Checker"][end] = self.unit_color()
        ((_, fields),) = texture.items()
        if "file" in fields:
            fields["interpolation"] = self.random.choice(("Bilinear", "Nearest"))
            fields["wrap"] = self.random.choice(("Repeat", "Clamp"))
        kind = self.random.choice(("Natural", "Natural", "Planar", "Spherical") if is_natural else ("Planar", "Spherical"))
        place = [self.random.uniform(-1.0, 1.0) for _ in range(3)]
        if kind == "Planar":
            axes = {axis: [self.random.uniform(-1.0, 1.0) for _ in range(3)] for axis in "uv"}
            fields["mapping"] = {"Planar": {"origin": place} | axes}
        if kind == "Spherical":
            fields["mapping"] = {"Spherical": {"center": place}}
            if self.chance(0.5):
                fields["mapping"]["Spherical"] |= {"up": self.unit_direction(), "front": [0.6, 0.1, 0.8]}
        return texture

    def give_textures(self, geometries):
        for geometry in geometries:
            ((name, fields),) = geometry.items()
            ((kind, material),) = fields["material"].items()
            is_solid = name in ("Union", "Intersection", "Difference")
            if kind in TEXTURED and not is_solid and self.chance(0.3):
                texture = self.texture(name in NATURAL)
                if kind == "Matte" and len(fields) % 2 == 0:
                    # Beside the color.
                    del fields["material"]
                    fields |= {**material, "texture": texture}
                else:
                    material["texture"] = texture

    def options(self):
        options = {"samples": self.random.randint(1, 7)}
        if self.chance(0.6):
            options["max_depth"] = self.random.choice((0, 1, 2, 3, 4, 6, 12))
        if self.chance(0.25):
            options["diffuse_depth"] = self.random.choice((0, 1, 2))
        if self.chance(0.5):
            options["caustics"] = self.chance(0.2)
        if self.chance(0.2):
            options["clamp"] = 10.0 ** self.random.uniform(-2.0, 1.0)
        if self.chance(0.2):
            options["filter"] = {"Gaussian": {"sigma": self.random.uniform(0.2, 2.0)}}
        if self.chance(0.5):
            options["seed"] = self.random.choice((1, 7, 2**32 - 1, self.random.randrange(2**32)))
        return options

    def lamp(self):
        """Returns a geometry that shines."""
        name = self.random.choice(LAMPS)
        place = [self.random.uniform(-2.5, 2.5) for _ in range(3)]
        if name == "Sphere":
            fields = {"center": place, "radius": self.random.uniform(0.1, 0.8)}
        elif name in ("Disc", "Plane"):
            fields = {"point" if name == "Plane" else "center": place, "normal": self.unit_direction()}
            if name == "Disc":
                fields["radius"] = self.random.uniform(0.2, 1.5)
        else:
            name, fields = self.valid(lambda: self.shape(0.4), name)
        fields["material"] = {"Emissive": {"color": self.unit_color(), "intensity": self.random.uniform(1.0, 10.0)}}
        return {name: fields}

    def valid(self, make, wanted=None):
        kind, fields = make()
        while kind in ("Sphere", "Disc", "Plane") or (wanted and kind != wanted) or shapes_refuse(kind, fields):
            kind, fields = make()
        fields = {key: value for key, value in fields.items() if key != "color"}
        return kind, fields

    def room(self):
        """Returns a floor, walls and some shapes on it, which do not touch."""
        geometries = [{"Plane": {"point": [0, -1, 0], "normal": [0, 1, 0]}}]
        if self.chance(0.5):
            geometries.append({"Plane": {"point": [0, 0, -3], "normal": [0, 0, 1]}})
        if self.chance(0.3):
            geometries.append({"Sphere": {"center": [0, 0, 0], "radius": 9}})
        for _ in range(self.random.randint(1, 4)):
            radius = self.random.uniform(0.2, 0.9)
            x, z = (self.random.uniform(-2.0, 2.0) for _ in range(2))
            geometries.append({"Sphere": {"center": [x, radius - 0.99, z], "radius": radius}})
        if self.chance(0.4):
            side = self.random.uniform(0.5, 2.0)
            corner = [self.random.uniform(-2.0, 1.0) for _ in range(3)]
            geometries.append({"Rectangle": {"corner": corner, "edge_u": [side, 0, 0.3], "edge_v": [0.1, side, 0]}})
        for geometry in geometries:
            ((_, fields),) = geometry.items()
            fields["material"] = self.material()
        return geometries

    def scattered(self):
        """Returns shapes of all kinds anywhere."""
        geometries = []
        for _ in range(self.random.randint(1, 6)):
            place = [self.random.uniform(-2, 2) for _ in range(3)]
            kind = self.random.choice(["Sphere", "Sphere", "Disc", "Plane", "Other", "Other", "Solid"])
            if kind in ("Other", "Solid"):
                kind, fields = self.valid(lambda: (self.shape if kind == "Other" else self.solid)(0.7))
            else:
                fields = {"point" if kind == "Plane" else "center": place}
                if kind != "Plane":
                    fields["radius"] = self.random.uniform(0.2, 2.0)
                if kind != "Sphere":
                    fields["normal"] = self.unit_direction()
            fields["material"] = self.material()
            if kind == "Mesh" and self.chance(0.5):
                fields["smooth"] = True
            if self.chance(0.15):
                fields["transform"] = self.transform(0.5)
            geometries.append({kind: fields})
        return geometries

    def touched(self):
        """Returns geometries of which half touch others. All that is opaque looks alike: which of two faces that
        coincide is seen is left to rounding."""
        opaque = self.material()
        while "Emissive" in opaque or "Glass" in opaque:
            opaque = self.material()
        geometries, _ = self.touching()
        for geometry in geometries:
            ((_, fields),) = geometry.items()
            if "Glass" not in fields["material"]:
                fields["material"] = opaque
            elif self.chance(0.15):
                fields["material"]["Glass"]["roughness"] = self.random.choice((0.2, 0.5))
        return geometries

    def joined(self):
        """Returns blocks of glass that share faces, of equal indices or not, on a floor or above it."""
        index, low = self.random.choice((1.5, 1.33, 2.0)), self.random.choice((-1.0, -0.8))
        heights = [low + self.random.choice((1.0, 1.0, 0.6)) for _ in range(2)]
        blocks = [
            {"Box": {"min": [-1, low, -0.6], "max": [0, heights[0], 0.6]}},
            {"Box": {"min": [0, low, -0.6], "max": [1, heights[1], 0.6]}},
            {"Cylinder": {"from": [-0.5, heights[0], 0], "to": [-0.5, heights[0] + 0.7, 0], "radius": 0.4}},
        ]
        blocks = self.random.sample(blocks, self.random.choice((2, 3)))
        for block in blocks:
            ((_, fields),) = block.items()
            glass = {"color": self.random.choice(("#ffffff", "#e0f0ff", self.unit_color()))}
            glass["ior"] = index if self.chance(0.6) else self.random.choice((1.0, 1.2, 1.7))
            if self.chance(0.2):
                glass["roughness"] = self.random.choice((0.1, 0.5))
            fields["material"] = {"Glass": glass}
        floor = {"Plane": {"point": [0, -1, 0], "normal": [0, 1, 0], "color": self.unit_color()}}
        return blocks + [floor]

    def turn(self):
        """Returns a transform: one that keeps balls round, or any."""
        turned = {"rotate": {"axis": self.unit_direction(), "angle": self.random.uniform(0.0, 360.0)}}
        turned["scale"] = self.random.choice((1.0, 0.5, 1.3))
        turned["translate"] = [self.random.uniform(-1.0, 1.0) for _ in range(3)]
        return turned if self.chance(0.6) else self.transform(0.5)

    def moved(self, geometries):
        """Returns geometries of which some are in a group, or copied."""
        at = self.random.randint(0, len(geometries))
        kept, inside = geometries[:at], geometries[at:]
        if inside and self.chance(0.5):
            ((_, fields),) = inside[0].items()
            fields["name"] = "first"
            kept.append({"Instances": {"of": "first", "transforms": [self.turn(), self.turn()]}})
        return kept + [{"Group": {"geometries": inside, "transform": self.turn()}}] if inside else kept

    def scene(self):
        make = self.random.choice((self.room, self.room, self.scattered, self.touched, self.joined))
        geometries = make()
        if make in (self.room, self.scattered):
            self.give_textures(geometries)
        for _ in range(self.random.choice((0, 0, 1, 1, 2, 3))):
            geometries.append(self.lamp())
        # So many that they are in a tree.
        for _ in range(self.random.choice((0, 0, 0, 0, 0, 0, 0, 40))):
            place = [self.random.uniform(-3.0, 3.0) for _ in range(3)]
            glow = {"color": self.unit_color(), "intensity": self.random.uniform(1.0, 30.0)}
            ball = {"center": place, "radius": self.random.uniform(0.02, 0.2), "material": {"Emissive": glow}}
            geometries.append({"Sphere": ball})
        around = self.around(geometries)
        image = {"width": self.random.randint(6, 14), "height": self.random.randint(5, 11)}
        scene = {"image": image, "camera": around["camera"]} | self.around_all()
        ((camera, fields),) = scene["camera"].items()
        if camera == "Perspective" and self.chance(0.3):
            fields["aperture"] = self.random.uniform(0.01, 0.5)
            if "look_at" not in fields or self.chance(0.5):
                fields["focus"] = self.random.uniform(1.0, 9.0)
        scene["lighting"] = {"Path": self.options()}
        scene["lights"] = self.lights(geometries)
        if make in (self.room, self.scattered) and self.chance(0.3):
            # A material of a name, for one geometry or more.
            scene["materials"] = {"named": self.material()}
            for geometry in self.random.sample(geometries, self.random.randint(0, len(geometries))):
                ((_, fields),) = geometry.items()
                if "Emissive" not in fields.get("material", "Emissive"):
                    fields["material"] = {"Named": "named"}
        scene["geometries"] = self.moved(geometries) if self.chance(0.2) else geometries
        return scene


def shapes_refuse(kind, fields):
    """Returns true if the format refuses a shape, or a part of it."""
    return any(shapes.refusal(*part) for part in parts_of({kind: fields}))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the strahl to test")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", metavar="FOLDER", help="where scenes that differ go")
    options = parser.parse_args()
    keep = options.keep or tempfile.mkdtemp(prefix="strahl-")
    os.makedirs(keep, exist_ok=True)

    pixels = wrong = failed = 0
    most = 0.0
    for number in range(options.count):
        seed = options.seed * 1_000_000 + number
        path, layers = (os.path.join(keep, f"{seed}{ending}") for ending in (".json", ".npz"))
        with open(path, "w", encoding="utf-8") as file:
            json.dump(PathScenes(seed, keep).scene(), file)
        command = [options.program, "render", "-q", "--threads", "1", path, "-o", layers]
        command += ["--layers", ",".join(paths.LAYERS)]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            failed += 1
            print(path, f"exit status {result.returncode}", result.stderr, sep="\n")
            continue
        _, _, off = paths.check(path, layers)
        is_right = off <= paths.TOLERANCE
        count = int((~is_right).sum())
        pixels, wrong = pixels + off.size, wrong + count
        most = max(most, off[is_right].max(initial=0.0))
        if count:
            print(f"{path}: {count} of {off.size} pixels differ, the most by {np.nanmax(off):.2g}", flush=True)
        else:
            for used in (path, layers, *glob.glob(os.path.join(keep, f"{seed}-*.pfm"))):
                os.remove(used)
    print(f"{options.count} scenes, {pixels} pixels, {wrong} differ; the others by {most:.1g} at most")
    return 1 if failed or wrong > paths.TOLERATED * pixels else 0


if __name__ == "__main__":
    sys.exit(main())
