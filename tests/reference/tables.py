"""An independent reader of the tables of scenes: CSV, NPY and the vertices of PLY."""

import ast
import csv
import os
import struct

NAMES = {3: "x y z", 4: "x y z radius", 6: "x y z r g b", 7: "x y z radius r g b"}

PLY_TYPES = {
    "char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f",
    "double": "d", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i",
    "uint32": "I", "float32": "f", "float64": "d",
}  # fmt: skip


def read_csv(path):
    with open(path, encoding="utf-8-sig", newline="") as file:
        for row in csv.DictReader(file, skipinitialspace=True):
            yield {
                name: text if name == "color" else float(text)
                for name, text in row.items()
                if text != ""
            }


def read_npy(path):
    with open(path, "rb") as file:
        data = file.read()
    wide = data[6] > 1
    (count,) = struct.unpack_from("<I" if wide else "<H", data, 8)
    start = (12 if wide else 10) + count
    header = ast.literal_eval(data[start - count : start].decode())
    rows, columns = header["shape"]
    order, size = header["descr"][0], header["descr"][1:]
    numbers = struct.unpack(f"{order}{rows * columns}{ {'f4': 'f', 'f8': 'd'}[size]}", data[start:])
    names = NAMES[columns].split()
    for row in range(rows):
        at = row if header["fortran_order"] else row * columns
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


def read_ply(path):
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
                    for _ in range(values.next(kind[1])):
                        values.next(kind[2])
                    continue
                value = values.next(kind[0])
                if name in ("red", "green", "blue"):
                    row[name[0]] = value / 255.0 if PLY_TYPES[kind[0]] == "B" else value
                else:
                    row[name] = value
            if element == "vertex":
                yield row


READERS = {".csv": read_csv, ".npy": read_npy, ".ply": read_ply}


def spheres(fields, folder):
    """Returns the fields of a sphere for each row of a table."""
    path = os.path.join(folder, fields["file"])
    for row in READERS[os.path.splitext(path)[1].lower()](path):
        color = row.get("color", fields.get("color"))
        if "r" in row:
            color = (row["r"], row["g"], row["b"])
        radius = row.get("radius", fields.get("radius"))
        yield {
            "center": (row["x"], row["y"], row["z"]),
            "radius": radius,
            "color": color,
            "material": fields.get("material"),
        }
