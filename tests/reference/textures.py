"""Textures: the light of a material's colors at places on shapes, as docs/light.md defines them."""

import math
import os

import numpy as np

from evaluate import optional, variant
from light import lin
from pairs import frame, inward
from surfaces import dots, units

UP, FRONT = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0])


def read_pfm(path):
    """Returns the light of a PFM file of colors, with its first row at the top."""
    with open(path, "rb") as file:
        kind, size, scale = (file.readline().decode() for _ in range(3))
        width, height = map(int, size.split())
        assert kind.strip() == "PF" and float(scale) < 0.0
        return np.frombuffer(file.read(), "<f4").reshape(height, width, 3)[::-1].astype(float)


def vector(values):
    return np.array(values, float)


def around_ball(q, right, up, front):
    """Returns the longitudes and latitudes of vectors, 1/2 to the front."""
    around = np.arctan2(q @ right, q @ front)
    return 0.5 + around / (2.0 * np.pi), 1.0 - np.arccos(np.clip(units(q) @ up, -1.0, 1.0)) / np.pi


def in_edges(q, e, f):
    """Returns the coordinates of vectors in the plane of two edges."""
    n = np.cross(e, f)
    return np.cross(q, f) @ n / (n @ n), np.cross(e, q) @ n / (n @ n)


def natural(name, fields, face, p):
    """Returns the coordinates that a shape has of its own."""
    if name == "Plane":
        x, y, z = np.abs(vector(fields["normal"])) / math.sqrt(vector(fields["normal"]) @ vector(fields["normal"]))
        axes = (0, 2) if y >= x and y >= z else (1, 2) if x >= z else (0, 1)
        return p[:, axes[0]], p[:, axes[1]]
    if name == "Sphere":
        return around_ball(p - vector(fields["center"]), np.array([1.0, 0.0, 0.0]), UP, FRONT)
    if name == "Rectangle":
        return in_edges(p - vector(fields["corner"]), vector(fields["edge_u"]), vector(fields["edge_v"]))
    if name == "Triangle":
        a, b, c = (vector(fields[corner]) for corner in "abc")
        return in_edges(p - a, b - a, c - a)
    if name == "Disc":
        local = inward(frame(units(vector(fields["normal"]))), p - vector(fields["center"]))
        return tuple(local[:, axis] / (2.0 * float(fields["radius"])) + 0.5 for axis in range(2))
    low, high = vector(fields["min"]), vector(fields["max"])
    x, y, z = ((p - low) / (high - low)).T
    # To the right and upwards, as seen from outside.
    return [(z, y), (1.0 - z, y), (x, z), (x, 1.0 - z), (1.0 - x, y), (x, y)][face]


def mapped(described, shape, face, p):
    name, fields = variant(described or {"Natural": {}})
    if name == "Natural":
        return natural(*shape, face, p)
    if name == "Planar":
        q = p - vector(fields["origin"])
        return tuple(q @ axis / (axis @ axis) for axis in (vector(fields["u"]), vector(fields["v"])))
    up, front = units(vector(optional(fields, "up", UP))), units(vector(optional(fields, "front", FRONT)))
    front = units(front - front @ up * up)
    return around_ball(p - vector(fields["center"]), np.cross(front, up), up, front)


def picture(fields, s, t):
    """Returns the light of a picture: t grows upwards from its lower border."""
    texels = fields["texels"]
    height, width, _ = texels.shape
    repeats = optional(fields, "wrap", "Repeat") in ("Repeat", ["Repeat"])

    def at(column, row):
        if repeats:
            return texels[row % height, column % width]
        return texels[np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)]

    x, y = s * width, (1.0 - t) * height
    if optional(fields, "interpolation", "Bilinear") == "Nearest":
        return at(np.floor(x).astype(int), np.floor(y).astype(int))
    x, y = x - 0.5, y - 0.5
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    across, down = (x - left)[:, None], (y - top)[:, None]
    above, below = ((1.0 - across) * at(left, row) + across * at(left + 1, row) for row in (top, top + 1))
    return (1.0 - down) * above + down * below


def light(described, shape, face, p):
    """Returns the light of a texture at points of a face of a shape, its name and fields, before it is placed."""
    name, fields = variant(described)
    s, t = mapped(fields.get("mapping"), shape, face, p)
    if name == "Image":
        return picture(fields, s, t)
    size = float(optional(fields, "size", 1.0))
    is_even = (np.floor(s / size) + np.floor(t / size)) % 2.0 == 0.0
    even, odd = lin(optional(fields, "even", "#ffffff")), lin(optional(fields, "odd", "#404040"))
    return np.where(is_even[:, None], even, odd)


def read(described, folder):
    """Reads the picture of a texture or a backdrop, if it is one."""
    _, fields = variant(described)
    if "file" in fields:
        fields["texels"] = read_pfm(os.path.join(folder, fields["file"]))
