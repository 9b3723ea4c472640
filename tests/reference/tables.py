"""An independent reader of the tables of scenes: CSV, NPY, NPZ, the vertices of PLY, and XYZ."""

import ast
import csv
import math
import os
import re
import struct
import zipfile

# The shape of a row, and the columns of its points.
KINDS = {"Spheres": ("Sphere", "x y z".split()), "Cylinders": ("Cylinder", "x1 y1 z1 x2 y2 z2".split())}


def names_of(points, width):
    """Returns the names of the columns of an array of this width."""
    more = {0: "", 1: "radius", 3: "r g b", 4: "radius r g b"}
    return points + more[width - len(points)].split()


PLY_TYPES = {
    "char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f",
    "double": "d", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i",
    "uint32": "I", "float32": "f", "float64": "d",
}  # fmt: skip


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


# ParaView's names of coordinates.
POINTS = {"points:0": "x", "points:1": "y", "points:2": "z"}
SIZES = {"x", "y", "z", "x1", "y1", "z1", "x2", "y2", "z2", "radius", "scale"}


def usual_name(name):
    """Returns the name of a coordinate or a size without capitals and units; others stay as they are."""
    bare = re.split(r"[\[(]", name)[0].strip().lower()
    bare = POINTS.get(bare, bare)
    return bare if bare in SIZES else name


def cells(line):
    """Returns the cells of a line with commas, tabs or blanks between them."""
    if "," in line or ";" in line:
        return [cell.strip() for cell in next(csv.reader([line], skipinitialspace=True))]
    if "\t" in line:
        return [cell.strip().strip('"') for cell in line.split("\t")]
    return [cell.strip('"') for cell in re.sub(r" +(?=[\[(])", "", line).split()]


def is_number(text):
    return isinstance(number(text), float)


def read_csv(path, columns, _points):
    with open(path, encoding="utf-8-sig", newline=None) as file:
        lines = [line for line in file.read().split("\n") if line.strip()]
    if lines[0].lower().startswith("sep="):
        lines = lines[1:]
    comments = []
    while lines and re.match(r"\s*(//|#)", lines[0]) and not (columns and re.match("#[0-9a-fA-F]{3,6}\\b", lines[0])):
        comments.append(re.sub(r"^\s*(//|#)\s*", "", lines.pop(0)))
    has_row = any(map(is_number, cells(lines[0])))
    if columns:
        lines = lines if has_row else lines[1:]
    elif has_row:
        columns = [usual_name(name) for name in cells(comments[-1])]
    else:
        columns = [usual_name(name) for name in cells(lines.pop(0))]
    for line in lines:
        yield {name: number(text) for name, text in zip(columns, cells(line)) if text != ""}


NPY_TYPES = {"f2": "e", "f4": "f", "f8": "d", "i4": "i", "u1": "B"}


def read_npy(path, columns, points):
    with open(path, "rb") as file:
        return list(rows_of_npy(file.read(), columns, points))


def read_npz(path, columns, points):
    """Returns the rows of the array with two dimensions, and columns of one."""
    rows, more = None, {}
    with zipfile.ZipFile(path) as file:
        for name in file.namelist():
            found = list(rows_of_npy(file.read(name), columns, points, name[: -len(".npy")]))
            if rows is None or len(found[0]) > 1:
                rows = found
            else:
                more[name] = found
    for column in more.values():
        rows = [row | values for row, values in zip(rows, column)]
    return rows


def rows_of_npy(data, columns, points, array=None):
    wide = data[6] > 1
    (count,) = struct.unpack_from("<I" if wide else "<H", data, 8)
    start = (12 if wide else 10) + count
    header = ast.literal_eval(data[start - count : start].decode())
    if isinstance(header["descr"], list):
        kinds = [kind[0] + NPY_TYPES[kind[1:]] for _, kind in header["descr"]]
        size = sum(struct.calcsize(kind) for kind in kinds)
        for row in range(header["shape"][0]):
            at, values = start + row * size, {}
            for (name, _), kind in zip(header["descr"], kinds):
                (values[name],) = struct.unpack_from(kind.replace("|", "<"), data, at)
                at += struct.calcsize(kind.replace("|", "<"))
            yield values
        return
    rows, *wide = header["shape"]
    width = wide[0] if wide else 1
    order, size = header["descr"][0], header["descr"][1:]
    numbers = struct.unpack(f"{order}{rows * width}{NPY_TYPES[size]}", data[start:])
    names = columns or (names_of(points, width) if wide else [array])
    for row in range(rows):
        at = row if header["fortran_order"] else row * width
        step = rows if header["fortran_order"] else 1
        yield {name: numbers[at + step * index] for index, name in enumerate(names)}


class Values:
    """Reads the values of a PLY file in sequence."""

    def __init__(self, encoding, body):
        self.words = iter(body.split()) if encoding == "ascii" else None
        self.order = ">" if encoding.endswith("big_endian") else "<"
        self.body, self.at = body, 0

    def next(self, kind):
        code = PLY_TYPES[kind]
        if self.words is not None:
            word = next(self.words)
            # A float has 32 bits in text files as well.
            return struct.unpack(code, struct.pack(code, float(word) if code in "fd" else int(word)))[0]
        (value,) = struct.unpack_from(self.order + code, self.body, self.at)
        self.at += struct.calcsize(self.order + code)
        return value


def read_ply(path, _columns, _points):
    return (row for element, row in rows_of_ply(path) if element == "vertex")


def rows_of_ply(path):
    """Returns the name of the element and the values of each row."""
    with open(path, "rb") as file:
        data = file.read()
    header, body = data.split(b"end_header", 1)
    body = body.split(b"\n", 1)[1]
    elements, encoding = [], ""
    for words in (line.split() for line in header.decode().splitlines()):
        if words[:1] == ["format"]:
            encoding = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[-1], words[1:-1]))
    values = Values(encoding, body)
    for element, count, properties in elements:
        for _ in range(count):
            row = {}
            for name, kind in properties:
                if kind[0] == "list":
                    length = int(values.next(kind[1]))
                    row[name] = [int(values.next(kind[2])) for _ in range(length)]
                    continue
                value = values.next(kind[0])
                if name in ("red", "green", "blue"):
                    row[name[0]] = value / 255.0 if PLY_TYPES[kind[0]] == "B" else value
                else:
                    row[name] = value
            yield element, row


# Radii and colors of a few elements, as in the tables of Alvarez and of Jmol.
ELEMENTS = {
    "H": (1.2, "#ffffff"), "C": (1.77, "#909090"), "N": (1.66, "#3050f8"), "O": (1.5, "#ff0d0d"),
}  # fmt: skip


# What stands for a kind that is not an element.
NEUTRAL = (1.0, "#808080")


def read_xyz(path, columns, points):
    with open(path, encoding="utf-8") as file:
        count, comment, *lines = file.read().splitlines()
    if len(count.split()) != 1:
        words = re.split(r"[\s,]+", count.strip())
        columns = columns or (points + ["_"] * (len(words) - 3) if all(map(is_number, words)) else None)
        yield from read_csv(path, columns, points)
        return
    named = re.search(r"""properties=(["']?)([^\s"']+)""", comment, re.IGNORECASE)
    parts = (named[2] if named else "species:S:1:pos:R:3").split(":")
    places, width = {}, 0
    for name, _, size in zip(parts[::3], parts[1::3], map(int, parts[2::3])):
        places[name.lower()] = (width, size)
        width += size
    for line in lines[: int(count)]:
        words = line.split()
        found = {name: words[at : at + size] for name, (at, size) in places.items()}
        kind = (found.get("species") or found.get("z") or found["type"])[0]
        radius, color = ELEMENTS.get(kind, NEUTRAL)
        row = dict(zip("xyz", map(float, found["pos"])), radius=radius, color=color)
        if "radius" in found:
            row["radius"] = float(found["radius"][0])
        if "color" in found:
            row["color"] = tuple(map(float, found["color"]))
        yield row | {f"column{at + 5}": float(word) for at, word in enumerate(words[4:]) if not named}


READERS = {
    ".csv": read_csv, ".npy": read_npy, ".npz": read_npz, ".ply": read_ply, ".xyz": read_xyz,
}  # fmt: skip


def channels(color):
    if isinstance(color, str):
        digits = color[1:]
        if len(digits) == 3:
            digits = "".join(digit * 2 for digit in digits)
        return tuple(int(digits[at : at + 2], 16) / 255.0 for at in (0, 2, 4))
    return tuple(min(max(channel, 0.0), 1.0) for channel in color)


def colors_of(name):
    """Returns the colors of a map. Those with a table are matplotlib's, as bytes."""
    if isinstance(name, dict):
        return [channels(color) for color in name["Colors"]]
    if not isinstance(name, str):
        return [channels(color) for color in name[0]]
    if name == "Gray":
        return [(0.0, 0.0, 0.0), (1.0, 1.0, 1.0)]
    from matplotlib import colormaps

    if name == "Coolwarm":
        data = colormaps["coolwarm"]._segmentdata
        table = [[data[channel][at][1] for channel in ("red", "green", "blue")] for at in range(33)]
    else:
        table = colormaps[name.lower()].colors
    return [tuple(math.floor(channel * 255 + 0.5) / 255.0 for channel in row) for row in table]


def by_value(by, rows):
    """Returns the color of each row."""
    values = [row.get(by["column"], math.nan) for row in rows]
    return map(scale(by, values), values)


def scale(by, values):
    """Returns the function from a value to its color."""
    finite = [value for value in values if math.isfinite(value)]
    low, high = by.get("range") or (min(finite), max(finite))
    colors = colors_of(by.get("map") or "Viridis")

    def color(value):
        if math.isnan(value):
            return by.get("missing") or "#ff00ff"
        t = 0.5 if low == high else (value - low) / (high - low)
        s = min(max(t, 0.0), 1.0) * (len(colors) - 1)
        first = min(int(s), len(colors) - 2)
        f = s - first
        a, b = colors[first], colors[first + 1]
        return a if f == 0.0 or a == b else tuple(p * (1.0 - f) + q * f for p, q in zip(a, b))

    return color


def rows(fields, folder, points, columns=None):
    """Returns the rows of a table, by the names of its columns."""
    path = os.path.join(folder, fields["file"])
    columns = fields.get("columns") or (columns if path.endswith(".npy") else None)
    return list(READERS[os.path.splitext(path)[1].lower()](path, columns, points))


def geometries(name, fields, folder):
    """Returns the sphere or cylinder of each row of a table."""
    shape, points = KINDS[name]
    found = rows(fields, folder, points)
    by = fields.get("color_by")
    colors = list(by_value(by, found)) if by else [None] * len(found)
    is_xyz = fields["file"].endswith(".xyz") and found and "color" in found[0]
    for row, of_value in zip(found, colors):
        if is_xyz:
            row = row | {name: fields[name] for name in ("radius", "color") if name in fields}
        color = row.get("color", fields.get("color"))
        if "r" in row:
            color = (row["r"], row["g"], row["b"])
        color = of_value or color
        ends = [tuple(row[name] for name in points[at : at + 3]) for at in range(0, len(points), 3)]
        yield {
            shape: {
                **dict(zip(("center",) if shape == "Sphere" else ("from", "to"), ends)),
                "radius": row.get("radius", fields.get("radius")),
                "capped": fields.get("capped"),
                "color": color,
                "material": fields.get("material"),
            }
        }
