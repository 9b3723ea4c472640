#!/usr/bin/env python3
"""Evaluates the scene format's equations pixel by pixel, and compares the result with a picture.

This shares nothing with the renderer: it is plain Python on IEEE doubles, with one rounding per
operation, in the order of the format's description. It is slow and simple.

    evaluate.py tests/golden              every flat scene below a folder with the .png of the same stem
    evaluate.py scene.ron --picture a.png one scene with a picture of any name
    evaluate.py scene.ron --write a.ppm   only writes the result of the equations
"""

import argparse
import json
import math
import os
import re
import struct
import sys
import zlib
from concurrent.futures import ProcessPoolExecutor

import meshes
import tables
from tangent import tan

# ---------------------------------------------------------------------------------------------
# IEEE arithmetic where Python raises an exception instead
# ---------------------------------------------------------------------------------------------


def divide(a, b):
    """a / b, with the infinities and NaN of IEEE 754 for b = 0."""
    if b != 0.0:
        return a / b
    if a == 0.0 or math.isnan(a):
        return math.nan
    return math.copysign(math.inf, a) * math.copysign(1.0, b)


def root(a):
    """Returns the square root, NaN below 0."""
    return math.nan if a < 0.0 else math.sqrt(a)


# ---------------------------------------------------------------------------------------------
# Vectors are tuples of three floats
# ---------------------------------------------------------------------------------------------


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def subtract(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scaled(a, factor):
    return (a[0] * factor, a[1] * factor, a[2] * factor)


def negated(a):
    return (-a[0], -a[1], -a[2])


def dot(a, b):
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]


def cross(a, b):
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def length(a):
    return root(dot(a, a))


def unit(a):
    """a / |a|, three divisions."""
    by = length(a)
    return (divide(a[0], by), divide(a[1], by), divide(a[2], by))


# ---------------------------------------------------------------------------------------------
# Scene files
# ---------------------------------------------------------------------------------------------


class Named(dict):
    """The fields of a variant, with its name."""

    name = ""


class Tuple(list):
    """The values of a variant without names of fields."""

    name = ""


TOKEN = re.compile(
    r"""(?P<space>\s+|//[^\n]*|/\*.*?\*/)
      | (?P<string>"(?:[^"\\]|\\.)*")
      | (?P<number>[-+]?(?:\d[\d_]*(?:\.[\d_]*)?|\.\d[\d_]*)(?:[eE][-+]?\d+)?)
      | (?P<word>[A-Za-z_]\w*)
      | (?P<mark>[()\[\]{}:,])""",
    re.VERBOSE | re.DOTALL,
)


class Ron:
    """A reader of the RON that scenes need; the renderer checks the syntax."""

    def __init__(self, text):
        self.tokens = []
        at = 0
        while at < len(text):
            match = TOKEN.match(text, at)
            if match is None:
                raise ValueError(f"not RON: {text[at : at + 20]!r}")
            if match.lastgroup != "space":
                self.tokens.append((match.lastgroup, match.group()))
            at = match.end()
        self.tokens.append(("end", ""))
        self.at = 0

    def next(self):
        self.at += 1
        return self.tokens[self.at - 1]

    def peek(self, ahead=0):
        return self.tokens[min(self.at + ahead, len(self.tokens) - 1)][1]

    def expect(self, mark):
        kind, text = self.next()
        if text != mark:
            raise ValueError(f"{mark!r} was expected, not {text!r}")

    def value(self):
        kind, text = self.next()
        if kind == "number":
            return float(text.replace("_", ""))
        if kind == "string":
            return json.loads(text)
        if text in ("true", "false"):
            return text == "true"
        if text == "None":
            return None
        if kind == "word" and self.peek() != "(":
            return text
        if kind == "word":
            self.expect("(")
            if text == "Some":
                value = self.value()
                if self.peek() == ",":
                    self.next()
                self.expect(")")
                return value
            fields = self.bracket()
            named = Named(fields) if isinstance(fields, dict) else Tuple(fields)
            named.name = text
            return named
        if text == "[":
            return self.sequence("]")
        if text == "(":
            return self.bracket()
        if text == "{":
            return self.fields("}")
        raise ValueError(f"{text!r} where a value belongs")

    def sequence(self, end):
        values = []
        while self.peek() != end:
            values.append(self.value())
            if self.peek() != end:
                self.expect(",")
        self.expect(end)
        return values

    def bracket(self):
        """Reads the content after an opening bracket: the fields of a struct, or a tuple."""
        if self.peek() == ")" or self.peek(1) == ":":
            return self.fields(")")
        return self.sequence(")")

    def fields(self, end):
        """Reads the fields of a struct, or the values of a map by their names."""
        fields = Named()
        while self.peek() != end:
            name = self.next()[1].strip('"')
            self.expect(":")
            fields[name] = self.value()
            if self.peek() != end:
                self.expect(",")
        self.expect(end)
        return fields


def variant(value):
    """Returns the name and the fields of a camera or a geometry, from RON or JSON."""
    if hasattr(value, "name"):
        return value.name, value
    ((name, fields),) = value.items()
    return name, fields


def read_scene(path):
    """Reads a scene file as a tree: every number is a float, every row of a table a geometry, and
    the geometries of a group or a part stand in its place, those of a part with materials instead
    of their names."""
    scene = read_tree(path)
    scene["geometries"] = read_list(scene, scene["geometries"], path)
    return scene


def read_list(scene, listed, path):
    """The geometries of a list, those of groups, tables and parts in their places, each placed by the
    transforms around it."""
    geometries = []
    for geometry in listed:
        lit = len(optional(scene, "lights", []))
        _, fields = variant(geometry)
        matrix = transform(optional(fields, "transform", {}))
        geometries += (placed(inner, matrix) for inner in read_inner(scene, geometry, path))
        lights = optional(scene, "lights", [])
        lights[lit:] = [placed_light(light, matrix) for light in lights[lit:]]
    return geometries


def read_inner(scene, geometry, path):
    """What stands in the place of a geometry, before its transform."""
    import solids

    name, fields = variant(geometry)
    folder = os.path.dirname(path)
    if name in tables.KINDS:
        return tables.geometries(name, fields, folder)
    if name == "Mesh" and "file" in fields:
        return [{name: meshes.read(fields, folder)}]
    if name == "Group":
        return read_list(scene, fields["geometries"], path)
    if name == "Instances":
        lit = optional(scene, "lights", [])
        inner = read_list(scene, [named_geometry(scene["geometries"], fields["of"])], path)
        scene["lights"] = lit
        return [placed(each, matrix) for matrix in matrices_of(fields, folder) for each in inner]
    if name == "Part":
        part = read_scene(os.path.join(folder, fields["file"]))
        named = optional(part, "materials", {})
        if optional(fields, "lights", False) and part.get("lights") is not None:
            scene["lights"] = optional(scene, "lights", []) + part["lights"]
        return [with_material(inner, named) for inner in part["geometries"]]
    return [solids.with_places(geometry) if name in solids.COMBINED else geometry]


def named_geometry(listed, wanted):
    """Returns the geometry with a name, in a list or the groups in it."""
    for geometry in listed:
        name, fields = variant(geometry)
        if fields.get("name") == wanted:
            return geometry
        found = named_geometry(fields["geometries"], wanted) if name == "Group" else None
        if found is not None:
            return found
    return None


def matrices_of(fields, folder):
    """Returns the matrix of each copy."""
    if fields.get("transforms") is not None:
        return [transform(written) for written in fields["transforms"]]
    matrices = []
    for row in tables.rows(fields, folder, "x y z".split(), "x y z scale".split()):
        moved = {"translate": (row["x"], row["y"], row["z"]), "scale": row.get("scale", 1.0)}
        if "angle" in row:
            axis = tuple(row.get(name, up) for name, up in zip(AXIS, (0.0, 1.0, 0.0)))
            moved["rotate"] = {"axis": axis, "angle": row["angle"]}
        matrices.append(transform(moved))
    return matrices


AXIS = ("axis_x", "axis_y", "axis_z")

# A matrix is three rows of four numbers, the last of which is the shift.


def transform(fields):
    """Returns the matrix of a transform."""
    if fields.get("matrix") is not None:
        return tuple(tuple(row) for row in fields["matrix"])
    columns = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    rotate = optional(fields, "rotate", None)
    if rotate is not None:
        axis, angle = unit(vector(rotate["axis"])), rotate["angle"] * (math.pi / 180.0)
        # The sine of Python may differ from that of libm in its last bit.
        sin, cos = math.sin(angle), math.cos(angle)
        columns = [
            add(
                add(scaled(column, cos), scaled(cross(axis, column), sin)),
                scaled(axis, dot(axis, column) * (1.0 - cos)),
            )
            for column in columns
        ]
    scale = optional(fields, "scale", 1.0)
    factors = scale if isinstance(scale, (list, tuple)) else (scale, scale, scale)
    columns = [scaled(column, factor) for column, factor in zip(columns, factors)]
    columns.append(vector(optional(fields, "translate", (0.0, 0.0, 0.0))))
    return tuple(tuple(column[row] for column in columns) for row in range(3))


def product(outer, inner):
    """Returns the matrix that applies `inner` first."""
    columns = [tuple(row[column] for row in inner) for column in range(4)]
    rows = []
    for row in outer:
        linear = [dot(row[:3], column) for column in columns]
        rows.append((*linear[:3], linear[3] + row[3]))
    return tuple(rows)


def inverse(matrix):
    """Returns the rows of the inverse of the part of a matrix without the shift."""
    a, b, c = (row[:3] for row in matrix)
    adjugate = (cross(b, c), cross(c, a), cross(a, b))
    determinant = dot(a, adjugate[0])
    return tuple(tuple(divide(column[row], determinant) for column in adjugate) for row in range(3))


def times(rows, v):
    return tuple(dot(row[:3], v) for row in rows)


def placed(geometry, matrix):
    """Returns a geometry that is mapped by a matrix after its own."""
    name, fields = variant(geometry)
    bare = {key: fields[key] for key in fields if key not in ("placed", "transform")}
    if "placed" in fields:
        matrix = product(matrix, fields["placed"])
    if matrix == ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0)):
        return {name: bare}
    return {name: bare | {"placed": matrix}}


def placed_light(light, matrix):
    name, fields = variant(light)
    shift = tuple(row[3] for row in matrix)
    moved = dict(fields)
    for field in ("position", "look_at"):
        if fields.get(field) is not None:
            moved[field] = add(times(matrix, vector(fields[field])), shift)
    if fields.get("direction") is not None:
        moved["direction"] = times(matrix, vector(fields["direction"]))
    return {name: moved}


def with_material(geometry, named):
    """Returns a geometry with its material in place of the name, as another file does not know it."""
    name, fields = variant(geometry)
    if fields.get("material") is None:
        return geometry
    kind, values = variant(fields["material"])
    if kind != "Named":
        return geometry
    return {name: {**fields, "material": named[values if isinstance(values, str) else values[0]]}}


def read_tree(path):
    with open(path, encoding="utf-8-sig") as file:
        text = file.read()
    if path.endswith(".json"):
        # -0 is an integer in Python, and would lose its sign.
        return json.loads(text, parse_int=float)
    reader = Ron(text)
    scene = reader.value()
    if reader.next()[0] != "end":
        raise ValueError("text after the scene")
    return scene


def color_bytes(color):
    """Returns a color as three bytes: #rgb, #rrggbb, or three numbers that are clamped to 0..1."""
    if isinstance(color, str):
        digits = color[1:]
        if len(digits) == 3:
            digits = "".join(digit + digit for digit in digits)
        color = [int(digits[i : i + 2], 16) / 255.0 for i in (0, 2, 4)]
    clamped = (min(max(channel, 0.0), 1.0) for channel in color)
    return bytes(math.floor(channel * 255.0 + 0.5) for channel in clamped)


def optional(fields, name, default):
    value = fields.get(name)
    return default if value is None else value


def vector(values):
    x, y, z = values
    return (x, y, z)


# ---------------------------------------------------------------------------------------------
# The equations
# ---------------------------------------------------------------------------------------------


def basis(fields):
    """Returns eye, u, v and w of a camera, and its up."""
    e = vector(fields["eye"])
    if fields.get("gaze") is not None:
        g = vector(fields["gaze"])
    else:
        g = subtract(vector(fields["look_at"]), e)
    t = vector(optional(fields, "up", (0.0, 1.0, 0.0)))
    w = unit(negated(g))
    u = unit(cross(t, w))
    v = cross(w, u)
    return e, u, v, w, t, g


def camera_rays(camera, width, height):
    """Returns a function from pixel (x, y), with row y = 0 at the bottom, to origin and direction."""
    name, fields = variant(camera)
    e, u, v, w, _, _ = basis(fields)
    middle_x = (width - 1.0) / 2.0
    middle_y = (height - 1.0) / 2.0
    if name == "Orthographic":
        s = fields["scale"]
        tall = height - 1.0 if height > 1.0 else 1.0
        wide = tall
        if optional(fields, "stretch", False):
            wide = width - 1.0 if width > 1.0 else 1.0
        d = negated(w)

        def ray(x, y):
            across = scaled(u, s * ((x - middle_x) / wide))
            upwards = scaled(v, s * ((y - middle_y) / tall))
            return add(add(e, across), upwards), d

    elif name == "Perspective":
        alpha = (fields["fov"] / 2.0) * (math.pi / 180.0)
        forward = scaled(negated(w), divide(height / 2.0, tan(alpha)))

        def ray(x, y):
            r = add(add(forward, scaled(u, x - middle_x)), scaled(v, y - middle_y))
            return e, unit(r)

    else:
        raise ValueError(f"a camera {name}")
    return ray


def plane(fields):
    a = vector(fields["point"])
    n = vector(fields["normal"])

    def hit(o, d):
        below = dot(d, n)
        if below == 0.0:
            return None
        t = dot(subtract(a, o), n) / below
        return t if 0.0 < t < math.inf else None

    return hit


def sphere(fields):
    c = vector(fields["center"])
    r = fields["radius"]

    def hit(o, d):
        oc = subtract(o, c)
        a_ = dot(d, d)
        b_ = dot(d, scaled(oc, 2.0))
        c_ = dot(oc, oc) - r * r
        discriminant = b_ * b_ - (4.0 * a_) * c_
        if not discriminant >= 0.0:
            return None
        s = root(discriminant)
        both = (divide(-b_ + s, 2.0 * a_), divide(-b_ - s, 2.0 * a_))
        return min((t for t in both if 0.0 < t < math.inf), default=None)

    return hit


def disc(fields):
    a = vector(fields["center"])
    r = fields["radius"]
    whole = plane({"point": a, "normal": fields["normal"]})

    def hit(o, d):
        t = whole(o, d)
        if t is None:
            return None
        from_center = subtract(add(o, scaled(d, t)), a)
        return t if dot(from_center, from_center) <= r * r else None

    return hit


SHAPES = {"Plane": plane, "Sphere": sphere, "Disc": disc}


def shape_of(name, fields):
    """Returns the function from a ray's origin and direction to the t of its hit."""
    import shapes
    import solids

    is_combined = name in solids.COMBINED
    hit = solids.combined(name, fields) if is_combined else (SHAPES | shapes.SHAPES)[name](fields)
    if "placed" not in fields:
        return hit
    back = ray_back(fields["placed"])

    def from_outside(o, d):
        return hit(*back(o, d))

    if hasattr(hit, "color"):
        color = hit.color
        from_outside.color = lambda o, d: color(*back(o, d))
    return from_outside


def ray_back(matrix):
    """Returns the function from a ray to that before a matrix maps it."""
    back = inverse(matrix)
    shift = tuple(row[3] for row in matrix)
    return lambda o, d: (times(back, subtract(o, shift)), times(back, d))


def size_of(scene):
    image = optional(scene, "image", {})
    return int(optional(image, "width", 640.0)), int(optional(image, "height", 480.0))


def evaluate(scene):
    """Returns width, height and the bytes of the picture, from the top row downwards."""
    width, height = size_of(scene)
    import fit  # it needs the vectors of this file

    camera = fit.explicit(scene["camera"], scene["geometries"], float(width), float(height))
    ray = camera_rays(camera, float(width), float(height))
    background = color_bytes(optional(scene, "background", (0.0, 0.0, 0.0)))
    world = []
    for geometry in scene["geometries"]:
        name, fields = variant(geometry)
        hit = shape_of(name, fields)
        world.append((hit, None if hasattr(hit, "color") else color_bytes(fields["color"])))

    pixels = bytearray()
    for row in range(height):
        y = float(height - 1 - row)
        for column in range(width):
            o, d = ray(float(column), y)
            nearest, color = math.inf, background
            for hit, own in world:
                t = hit(o, d)
                if t is not None and t < nearest:
                    nearest, color = t, own or color_bytes(hit.color(o, d))
            pixels += color
    return width, height, bytes(pixels)


def refusal(scene):
    """Returns the code of an error in values that the format's table requires, if any."""
    for side in size_of(scene):
        if not 1 <= side <= 1_000_000:
            return "out-of-range"

    def bad(a):
        return not 0.0 < dot(a, a) < math.inf

    name, fields = variant(scene["camera"])
    _, _, _, w, t, g = basis(fields)
    if name == "Perspective" and not 0.0 < fields["fov"] < 180.0:
        return "out-of-range"
    if name == "Orthographic" and not fields["scale"] > 0.0:
        return "out-of-range"
    if bad(g) or bad(t):
        return "zero-vector"
    if length(cross(t, w)) <= 1e-9 * length(t):
        return "parallel-vectors"
    import shapes
    import solids

    for name, fields in map(variant, solids.parts_of(scene["geometries"])):
        if name in ("Sphere", "Disc") and not fields["radius"] > 0.0:
            return "out-of-range"
        if name in ("Plane", "Disc") and bad(vector(fields["normal"])):
            return "zero-vector"
        if name not in SHAPES:
            reason = shapes.refusal(name, fields)
            if reason:
                return reason
    return None


# ---------------------------------------------------------------------------------------------
# Pictures
# ---------------------------------------------------------------------------------------------


def paeth(left, above, corner):
    estimate = left + above - corner
    to_left, to_above, to_corner = (abs(estimate - x) for x in (left, above, corner))
    if to_left <= to_above and to_left <= to_corner:
        return left
    return above if to_above <= to_corner else corner


def read_png(path):
    """Returns width, height and the bytes of a PNG file of 8-bit red, green and blue."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError("not a PNG file")
    at, packed, header = 8, b"", None
    while at < len(data):
        (count,) = struct.unpack(">I", data[at : at + 4])
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + count]
        (checksum,) = struct.unpack(">I", data[at + 8 + count : at + 12 + count])
        if checksum != zlib.crc32(kind + body):
            raise ValueError(f"a wrong checksum of {kind!r}")
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + count
    width, height = header[:2]
    if header[2:] != (8, 2, 0, 0, 0):
        raise ValueError("not 8-bit red, green and blue without interlacing")
    lines = zlib.decompress(packed)
    stride = 3 * width
    if len(lines) != height * (stride + 1):
        raise ValueError("not as many pixels as the header says")
    pixels = bytearray()
    above = bytes(stride)
    for row in range(height):
        start = row * (stride + 1)
        kind = lines[start]
        line = bytearray(lines[start + 1 : start + 1 + stride])
        if kind == 2:
            line = bytearray((a + b) & 255 for a, b in zip(line, above))
        elif kind != 0:
            for i in range(stride):
                left = line[i - 3] if i >= 3 else 0
                corner = above[i - 3] if i >= 3 else 0
                if kind == 1:
                    guess = left
                elif kind == 3:
                    guess = (left + above[i]) // 2
                else:
                    guess = paeth(left, above[i], corner)
                line[i] = (line[i] + guess) & 255
        pixels += line
        above = bytes(line)
    return width, height, bytes(pixels)


def write_ppm(path, width, height, pixels):
    with open(path, "wb") as file:
        file.write(f"P6\n{width} {height}\n255\n".encode() + pixels)


def differences(expected, found):
    """Returns the differences between two pictures as lines of text."""
    if expected[:2] != found[:2]:
        return [f"the picture is {found[0]}x{found[1]}, not {expected[0]}x{expected[1]}"]
    width, _, a = expected
    b = found[2]
    if a == b:
        return []
    wrong = [i for i in range(0, len(a), 3) if a[i : i + 3] != b[i : i + 3]]
    lines = [f"{len(wrong)} of {len(a) // 3} pixels differ"]
    for i in wrong[:5]:
        row, column = divmod(i // 3, width)
        lines.append(
            f"  column {column}, row {row}: #{b[i : i + 3].hex()}, "
            f"the equations give #{a[i : i + 3].hex()}"
        )
    return lines


# ---------------------------------------------------------------------------------------------
# The program
# ---------------------------------------------------------------------------------------------


def scenes_below(path):
    if not os.path.isdir(path):
        return [path]
    found = []
    for folder, _, names in sorted(os.walk(path)):
        found += [os.path.join(folder, n) for n in sorted(names) if n.endswith((".ron", ".json"))]
    return found


def is_flat(path):
    """Returns true for scenes without what other programs here evaluate."""
    scene = read_tree(path)
    others = {"lights", "outlines", "backdrop"} & set(scene)
    return not others and '"texture"' not in json.dumps(scene)


def check(path, picture):
    """Returns the number of pixels of a scene's picture, and its differences."""
    try:
        expected = evaluate(read_scene(path))
        found = read_png(picture or os.path.splitext(path)[0] + ".png")
    except (ArithmeticError, KeyError, OSError, TypeError, ValueError) as error:
        return 0, [f"{type(error).__name__}: {error}"]
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

    paths = [scene for path in options.paths for scene in scenes_below(path) if is_flat(scene)]
    if not paths:
        parser.error("no scenes there")
    if (options.picture or options.write) and len(paths) != 1:
        parser.error("--picture and --write are for one scene")
    if options.write:
        write_ppm(options.write, *evaluate(read_scene(paths[0])))
        return 0

    pixels, wrong = 0, 0
    with ProcessPoolExecutor(options.jobs) as pool:
        results = pool.map(check, paths, [options.picture] * len(paths))
        for path, (count, lines) in zip(paths, results):
            pixels += count
            wrong += bool(lines)
            print(f"{'differs' if lines else 'equal  '} {path}", flush=True)
            for line in lines:
                print(f"        {line}")
    print(f"{len(paths)} scenes, {pixels} pixels, {wrong} scenes differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
